"""Where an exhibit stands: the plan as a drawing on which it is moved, and the numbers that say the same."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from math import isfinite
from typing import Any

from hall_app.content.floor.footprints import Footprint, body_footprint, plan_footprints
from hall_app.content.floor.placement import STANDING
from hall_app.content.folder import Content, Exhibit
from hall_app.content.problems import Problem
from hall_app.web.platform.counter import Asking, Field, Shown, form
from hall_app.web.platform.office.collection.desk import TOML, Desk, listed_problems, refusal
from hall_app.web.platform.office.collection.keys import changes_of, fields_of, keys_of
from hall_app.web.platform.office.table import office_page

__all__ = ["Places"]

_MARGIN = 0.6  # [m] about the plan
_GRIP = 0.8  # [m], radius of what takes hold of the exhibit and of its arrow: 20 px wide on a phone


class Places:
    def __init__(self, desk: Desk) -> None:
        self._desk = desk

    def where(self, asking: Asking) -> dict[str, Any]:
        """Where it stands in its draft; reached: whether everything can be come to, null while that is found out."""
        key = self._desk.key(asking)
        place, (reached, wrong) = self._desk.table(key).get("place"), self._standing(key)
        return {
            "id": key,
            "place": _plain(place) if isinstance(place, dict) else {},
            "reached": reached,
            "problems": [one.as_json() for one in wrong],
        }

    def _standing(self, key: str) -> tuple[bool | None, list[Problem]]:
        """Whether everything is reached, as `where` tells it; what is wrong with where it stands."""
        found = self._reach(key)
        wrong = [one for one in self._desk.problems(key) if one.key.startswith(("place", "body"))]
        return None if found is None else not found, wrong + (found or [])

    def put(self, asking: Asking) -> dict[str, Any]:
        desk, key = self._desk, self._desk.key(asking)
        table = desk.table(key)
        changes = changes_of(asking.form, keys_of("place"), table)
        desk.change(asking, key, changes, tag=asking.form.get("tag"))
        self._reach(key)  # begun by now
        return {"id": key, "changed": [".".join(map(str, one.path)) for one in changes]}

    def _reach(self, key: str):
        drafts = self._desk.drafts
        if drafts.of(key) is None:
            return []
        return self._desk.examination.reach(drafts.changes(key), wait=False)

    def page(self, asking: Asking) -> Shown:
        desk, key, word = self._desk, self._desk.key(asking), asking.word
        table, content, at = desk.table(key), desk.house.content, f"/office/collection/{key}/place"
        fields = tuple(
            self._on(asking, content, one) if one.name == "place.on" else one
            for one in fields_of(asking, keys_of("place"), table)
        )
        sent = form(
            asking, "place", at, fields, word("存入草稿", "Save to the draft"),
            hidden={"tag": desk.drafts.tag(key, TOML)},
        )  # fmt: skip
        told = word(
            "拖动红色的展品，拖动箭头令它转向，或改写数字；单位为米，平面图上方是 −z。",
            "Drag the red exhibit, turn it by its arrow, or write the numbers: metres, the drawing's top is −z.",
        )
        back = f'<a href="{asking.address(f"/office/collection/{key}")}">{word("回到展品", "Back to the exhibit")}</a>'
        inside = f"""{refusal(asking, "place")}<div class="planned">
<figure>{drawing(content, key, table, asking)}<figcaption class="quiet">{told}</figcaption></figure>
<div>{self._reached(asking, key)}{sent}</div>{_neighbours(asking, content, key)}</div><p class="doors">{back}</p>"""
        title = f"{desk.title(key, asking.lang)} · {word('布置', 'Place')}"
        return office_page(asking, title, inside, path=f"collection/{key}/place", script="book/plan.js")

    def _on(self, asking: Asking, content: Content, one: Field) -> Field:
        stands = [solid for solid in content.plan.solid if solid.kind in STANDING]
        names = {solid.id: getattr(solid.label, asking.lang) if solid.label else solid.id for solid in stands}
        choices = {"": asking.word("地面", "the floor")} | names
        if one.value:
            choices.setdefault(one.value, one.value)
        return Field(one.name, one.label, "select", one.value, needed=False, choices=choices)

    def _reached(self, asking: Asking, key: str) -> str:
        """One live region whatever is known, so that the page's script can put in what became of the walk."""
        word, (reached, wrong) = asking.word, self._standing(key)
        if wrong:
            return _found("no", listed_problems(asking, wrong))
        if reached is None:
            told = word("正在步行检查全馆通路…", "Walking through the hall to see that all is reached …")
            at, look = f"collection/{key}/place", word("再看一次", "Look again")
            again = f'<a href="{asking.address(f"/office/{at}")}">{look}</a>'
            return _found("wait", f'<p class="done">{told} {again}</p>', f' data-ask="/api/office/{at}"')
        return _found(
            "yes",
            f'<p class="done">{word("每件展品都能走到。", "Every exhibit can be reached on foot.")}</p>',
        )


def _others(content: Content, key: str) -> list[Exhibit]:
    """The exhibits about it, in the order of their numbers."""
    return [one for one in content.exhibits if one.id != key]


def _neighbours(asking: Asking, content: Content, key: str) -> str:
    """What the numbers on the drawing are, each a way to where that one is placed."""
    rows = "".join(
        f'<li><a href="{asking.address(f"/office/collection/{one.id}/place")}">'
        f"{escape(getattr(one.file.title, asking.lang))}</a></li>"
        for one in _others(content, key)
    )
    return f'<ol class="neighbours">{rows}</ol>' if rows else ""


def _found(state: str, told: str, more: str = "") -> str:
    return f'<div id="reached" role="status" data-state="{state}"{more}>{told}</div>'


def drawing(content: Content, key: str, table: dict[str, Any], asking: Asking) -> str:
    """The plan as SVG; the exhibit of that key can be moved by the script."""
    xs, zs = zip(*content.plan.outline, strict=True)
    low = (min(xs) - _MARGIN, min(zs) - _MARGIN)
    size = (max(xs) + _MARGIN - low[0], max(zs) + _MARGIN - low[1])
    box = f"{low[0]:.2f} {low[1]:.2f} {size[0]:.2f} {size[1]:.2f}"
    others = "".join(
        _shape(body_footprint(one.id, one.file), "other", getattr(one.file.title, asking.lang))
        + f'<text x="{one.file.place.x:g}" y="{one.file.place.z:g}">{number}</text>'
        for number, one in enumerate(_others(content, key), start=1)
    )
    solids = "".join(_shape(one, one.kind, one.id) for one in plan_footprints(content.plan))
    start = content.hall.start
    return f"""<svg class="plan" id="plan" viewBox="{box}" role="img" aria-label="{asking.word("平面图", "Plan")}">
<polygon class="floor" points="{_points(content.plan.outline)}"/>{solids}{others}
<circle class="start" cx="{start.x:g}" cy="{start.z:g}" r="0.3"/>{_own(table)}</svg>"""


def _own(table: dict[str, Any]) -> str:
    """The exhibit itself in its own measures about its place, its front marked; about both what a finger takes."""
    place, body = _table(table.get("place")), _table(table.get("body"))
    x, z, facing = (_number(place.get(name)) for name in ("x", "z", "facing"))
    size = body.get("size")
    if isinstance(size, list) and len(size) == 2:
        width, depth = (_number(one) or 0.5 for one in size)
        shape = f'<rect x="{-width / 2:g}" y="{-depth / 2:g}" width="{width:g}" height="{depth:g}"/>'
        front = depth / 2
    else:
        front = _number(body.get("radius")) or 0.4
        shape = f'<circle r="{front:g}"/>'
    arrow = f'<path d="M -0.26 {front + 0.08:g} L 0.26 {front + 0.08:g} L 0 {front + 0.56:g} Z"/>'
    turn = f'<g id="turn"><circle class="grip" cy="{front + _GRIP:g}" r="{_GRIP:g}"/>{arrow}</g>'
    return (
        f'<g class="own" id="own" transform="translate({x:g} {z:g}) rotate({-facing:g})">'
        f'<circle class="grip" r="{_GRIP:g}"/>{shape}{turn}</g>'
    )


def _table(value: Any) -> dict[str, Any]:
    return value if isinstance(value, dict) else {}


def _shape(one: Footprint, kind: str, name: str) -> str:
    title = f"<title>{escape(name)}</title>"
    if one.round:
        x, z, radius = one.round
        return f'<circle class="{kind}" cx="{x:g}" cy="{z:g}" r="{radius:g}">{title}</circle>'
    return f'<polygon class="{kind}" points="{_points(one.polygon or ())}">{title}</polygon>'


def _points(ring: Iterable[tuple[float, float]]) -> str:
    return " ".join(f"{x:g},{z:g}" for x, z in ring)


def _number(value: Any) -> float:
    """0 for what is none: the drawing shows the exhibit in the middle, and the check says what is wrong."""
    try:
        number = float(value) if isinstance(value, int | float) and not isinstance(value, bool) else 0.0
    except OverflowError:
        return 0.0
    return number if isfinite(number) else 0.0


def _plain(table: dict[str, Any]) -> dict[str, Any]:
    """As JSON can hold it: what is neither text, truth nor number is told as TOML's reader calls it."""
    return {
        name: value if isinstance(value, str | bool) or _number(value) == value else type(value).__name__
        for name, value in table.items()
    }
