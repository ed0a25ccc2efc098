"""What stands behind the paper's tables: other analyses, what the reader must know, how to repeat it."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from survey.report.chapters import Drawing
from survey.report.sections.article import Article
from survey.report.tables import Table

__all__ = ["further", "method", "notes"]


def further(article: Article) -> Iterator[str]:
    """A section for each chapter."""
    for chapter in (make(article.say) for make in article.further):
        yield article.section(chapter.title)
        for part in chapter.parts:
            if isinstance(part, Table):
                yield article.set(part)
            elif isinstance(part, Drawing):
                yield article.draw(part.key, part.caption, part.svg(article.name(part.key)))
            else:
                yield f"<p>{escape(part)}</p>"


def notes(article: Article) -> Iterator[str]:
    """The notes as a table, or that there are none."""
    yield article.section("section_flags")
    if "notes" not in article.tables:
        yield f"<p>{escape(article.say('nothing_flagged'))}</p>"
    yield article.set(article.tables.get("notes"), "notes")


def method(article: Article) -> Iterator[str]:
    """Two paragraphs and the foot of the page."""
    say, chosen = article.say, article.found.settings
    yield article.section("section_method")
    dropped = say.items(article.found.dropped) or say("none")
    text = say(
        "method_text", method=say(f"way_{chosen.method}"), missing=say(f"way_{chosen.missing}"),
        rotation=say(f"way_{chosen.rotation}"), dropped=dropped, seed=chosen.seed,
        turned=say.items(article.found.turned.items) or say("none"),
        factors=chosen.factors if isinstance(chosen.factors, int) else say(f"way_{chosen.factors}"),
    )  # fmt: skip
    yield f"<p>{escape(text)}</p><p>{escape(say('method_script'))}</p>"
    yield f'<footer class="small">{escape(say("small_print"))}</footer>'
