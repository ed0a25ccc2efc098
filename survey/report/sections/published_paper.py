"""The paper's own: from 25 indicators to 12 and to 10 (III.B.1–3), and what it printed beside what was computed."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from survey.demonstration import intermediate, questionnaire_id, sample_name
from survey.report.figures import flow
from survey.report.indicators import Way, evidence, way_of
from survey.report.sections.article import Article
from survey.report.tables import Table, paper_table
from survey.report.words import Words, coefficient, whole

__all__ = ["paper", "way"]


def way(article: Article) -> Iterator[str]:
    """Nothing for another questionnaire, or where not all of the twelve were asked."""
    found, say = article.found, article.say
    if article.asked is None or article.asked.id != questionnaire_id() or (seen := way_of(found)) is None:
        return
    yield article.section("section_way")
    source = say("way_synthetic" if article.table.synthetic else "way_answers", source=article.table.source,
                 n=whole(found.n))  # fmt: skip
    told = {"primary": len(seen.primary), "asked": len(seen.lanes), "final": len(seen.final)}
    yield f"<p>{escape(say('way_text', sample=sample_name(), **told))}</p>"
    kept = [pair for pair in seen.close if set(pair) <= set(seen.final)]
    if kept:
        yield f"<p>{escape(say('way_open'))}</p>"
    caption = say("way_caption", source=source)
    yield article.draw("way", caption, flow(seen, say, article.name("way"), caption))
    yield article.set(_pairs(seen, say, synthetic=article.table.synthetic), "narrow")
    yield article.set(_fates(seen, say))


def _pairs(seen: Way, say: Words, *, synthetic: bool) -> Table:
    rows = []
    for pair in seen.pairs:
        gone = [say.item(item) for item in pair.items if item not in seen.final]
        decision = say("choice_dropped", items=" / ".join(gone)) if gone else say("choice_open")
        names = " ~ ".join(map(say.item, pair.items))
        figures = (pair.printed, pair.synthetic, None if synthetic else pair.r)
        rows.append((names, *map(coefficient, figures), decision))
    head = (say("pair"), say("printed"), say("synthetic_short"), say("yours"), say("choice"))
    return Table("way-pairs", say("way_pairs_caption", sample=sample_name()), head, tuple(rows),
                 words=frozenset({4}))  # fmt: skip


def _fates(seen: Way, say: Words) -> Table:
    rows = []
    for number, (one, seen_r) in enumerate(zip(seen.primary, evidence(), strict=True), 1):
        if one.into is None:
            became, why = "–", say.either(one.why or ("", ""))
            said = say("way_nearest", item=say.item(seen_r.beside), r=coefficient(seen_r.r))
        else:
            became = say.item(one.into)
            alone = len(intermediate()[one.into]) == 1
            why = say("way_kept" if alone else "way_merged")
            said = "–" if alone else say("way_together", r=coefficient(seen_r.r))
        rows.append((f"{number} {say.either(one.name)}", became, why, said))
    head = (say("way_primary"), say("way_became"), say("way_why"), say("synthetic_short"))
    return Table("way", say("way_table_caption", sample=sample_name()), head, tuple(rows), left=4)


def paper(article: Article) -> Iterator[str]:
    """One table."""
    yield article.section("section_paper")
    yield f"<p>{escape(article.say('paper_intro'))}</p>"
    comparable = article.found if article.asked is not None and article.asked.id == "garment" else None
    yield article.set(paper_table(comparable, article.say), "paper")
