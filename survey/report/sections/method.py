"""How it was computed, and how to repeat it."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from survey.report.sections.article import Article

__all__ = ["method"]


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
