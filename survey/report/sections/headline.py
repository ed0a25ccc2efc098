"""What stands at the head of the report, and the components' names that run through it."""

from __future__ import annotations

from html import escape

from survey.analysis import Analysis
from survey.analysis.components import proposed_modules
from survey.questionnaire import Questionnaire
from survey.report.words import Words, coefficient, whole
from survey.scores import ScoreTable

__all__ = ["component_names", "head", "key_figures"]


def head(title: str, table: ScoreTable, found: Analysis, say: Words) -> str:
    """Title, where it comes from, what one must be warned of, and the row of figures."""
    banners = ""
    if table.synthetic:
        banners += f'<p class="banner synthetic"><b>{escape(say("synthetic"))}</b></p>'
    for note in found.notes:
        if note.code in ("small_sample", "barely_enough_rows", "too_few_rows"):
            text = say.note(note)
            banners += (
                f'<p class="banner"><b>{escape(say("fragile"))}</b>{escape(text[:1].upper() + text[1:])}</p>'
            )
    subtitle = say("subtitle", source=table.source, n=whole(found.n), items=len(found.items))
    return (
        f'<header><div class="top"><span>{escape(say("title"))}</span>'
        f'<button type="button" onclick="turn()">{escape(say("switch"))}</button></div>'
        f'<h1>{escape(title)}</h1><p class="subtitle">{escape(subtitle)}</p></header>'
        f"{banners}{key_figures(found, say)}"
    )


def key_figures(found: Analysis, say: Words) -> str:
    """The row of figures that a reader wants first."""
    shown = [(whole(found.n), say("answers")), (str(len(found.factored)), say("kept_items"))]
    if found.adequacy is not None:
        shown.append((coefficient(found.adequacy.kmo), "KMO"))
    if found.components is not None:
        shown.append((str(found.components.kept), say("components_kept")))
        share = 100 * found.components.rotated.sum() / len(found.factored)
        shown.append((f"{share:.1f} %", say("explained")))
    if found.reliability is not None:
        shown.append((coefficient(found.reliability.alpha), "Cronbach α"))
    parts = [
        scale.reliability.alpha for scale in found.scales if scale.kind == "component" and scale.reliability
    ]
    if len(parts) > 1:
        span = f"{coefficient(min(parts), 2)} – {coefficient(max(parts), 2)}"
        shown.append((span, say("alpha_of_components")))
    if found.omega is not None:
        shown.append((coefficient(found.omega.omega), "McDonald ω"))
    cells = "".join(
        f"<div><b>{escape(value)}</b><span>{escape(label)}</span></div>" for value, label in shown
    )
    return f'<div class="key">{cells}</div>'


def component_names(analysis: Analysis, asked: Questionnaire | None, say: Words) -> list[str]:
    """(k,) names proposed for the components."""
    if analysis.components is None:
        return []
    module_of = {}
    if asked is not None:
        module_of = {item.id: module.id for module in asked.modules for item in asked.items_of(module)}
    proposed = proposed_modules(analysis.components, analysis.factored, module_of)
    return [
        say("factor_name", number=at + 1) if module is None else f"{at + 1} {say.module(module)}"
        for at, module in enumerate(proposed)
    ]
