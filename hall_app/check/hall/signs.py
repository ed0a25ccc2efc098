"""Signs: does each hang on a wall, where it is seen, over nothing else, and can it be read?"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from hall_app.check.hall.walls import INSIDE, Fault, Floats, body, height, measured, spot
from hall_app.content.folder import Content
from hall_app.content.problems import Problem
from hall_app.content.schema.plan import PlanFile, Sign
from hall_app.room.parts.signs import OUT, PIXELS, boards_of
from hall_app.room.structure.regions import Regions
from hall_app.room.surface import Writing, letter_size, shrunk

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

__all__ = ["sign_faults", "sign_remarks"]

HUNG = 0.10  # [m] a sign may hang before its wall
STEP = 0.2  # [m] along a sign at which its wall is looked for
THIN = 2e-3  # [m] a sign may lie in a wall by its edges, and has to hang before it between them
SLACK = 0.02  # [m] signs, walls and openings may overlap by
SAME_WAY, SAME_PLANE = 10.0, 0.15  # [degrees], [m] two signs of one wall may differ by
OPENING = 0.3  # [m] an opening's middle line may lie behind what hangs on its wall
LEGIBLE = 30.0  # [mm] letters are high that are read from a few steps away
CLEAR, SHARP = 0.9, 0.6  # of what they ask for: as large as labels and scrolls should be drawn
MARKS = frozenset(
    ("Mn", "Me", "Cc", "Cf", "Co", "Cs", "Cn")
)  # Unicode's categories of what is no letter by itself
SYMBOLS = range(0x1F000, 0x20000)  # emoji and their like, of which the hall's font has none


def sign_faults(content: Content, regions: Regions) -> Iterator[Fault]:
    """What is wrong with each sign of the plan, (key, what, remedy): one fault of its place, one of its text."""
    plan, title = content.plan, content.hall.title
    walls = [(body(wall), height(wall, plan, regions)) for wall in plan.wall]
    held = [*walls, (regions.floor.boundary, np.inf)]
    for number, sign in enumerate(plan.sign, 1):
        if fault := _misplaced(sign, held, regions) or _inside(sign, walls) or _on_opening(sign, plan):
            yield f"sign[{number}].{fault[0]}", fault[1], fault[2]
        if fault := _unread(sign, title.zh):
            yield f"sign[{number}].text", *fault
    for (number, sign), (other, before) in combinations(enumerate(plan.sign, 1), 2):
        if _over(sign, before):
            what = f"the {before.kind} hangs over sign[{number}]"
            yield f"sign[{other}].at", what, "move one of them"


def sign_remarks(content: Content) -> list[Problem]:
    """More writings than one sheet holds as large as they ask to be drawn."""
    plan = content.plan
    boards = boards_of(plan, Regions(plan), content.hall.title, content.exhibits, content.folder)
    scrolls, others = shrunk([board.writing for board in boards])
    fix = "take pictures or couplets out, or make them smaller"
    if others < CLEAR:
        what = f"more hangs in the hall than one sheet holds: labels have {others:.0%} of their pixels a side"
        return [Problem("plan.toml", "sign", what, fix)]
    if scrolls < SHARP:
        what = f"pictures are drawn with {scrolls * PIXELS['picture']:.0f} pixels per metre of {PIXELS['picture']}"
        return [Problem("plan.toml", "sign", what, fix)]
    return []


def _misplaced(
    sign: Sign, held: Sequence[tuple[BaseGeometry, float]], regions: Regions
) -> tuple[str, str, str] | None:
    """held: what a sign may hang on, and how high that is."""
    import shapely

    points = shapely.points(_across(sign))
    ceiling = regions.height_at(*(np.asarray(sign.at) + 0.05 * _front(sign)))
    if ceiling is None:
        return "at", f"the {sign.kind} hangs outside the hall ({spot(sign.at)})", INSIDE
    away = np.array([shapely.distance(shape, points) for shape, _ in held])
    far, on_its_face = away.min(0), "write a spot on the wall's face, and facing away from it"
    if (edge := max(far[0], far[-1])) > HUNG:
        return "at", f"the {sign.kind} hangs off its wall: an edge is {edge:.2f} m from any", on_its_face
    if (gap := far.max()) > HUNG:
        return (
            "at",
            f"the {sign.kind} hangs across a gap: a part of it is {gap:.2f} m from any wall",
            on_its_face,
        )
    low, top = _heights(sign)
    if top > ceiling:
        what = f"the {sign.kind} reaches up to {top:.2f} m, the ceiling is at {ceiling:g} m"
        return "height", what, "hang it lower, or make it smaller"
    tops = np.where(away <= HUNG, np.array([high for _, high in held])[:, None], 0.0).max(0)
    if top > tops.min() + SLACK:
        what = f"the {sign.kind} reaches up to {top:.2f} m, its wall to {tops.min():.2f} m"
        return "height", what, "hang it lower, or make it smaller"
    if low < 0:
        return (
            "height",
            f"the {sign.kind} reaches {-low:.2f} m below the floor",
            "hang it higher, or make it smaller",
        )
    return None


def _inside(sign: Sign, walls: Sequence[tuple[BaseGeometry, float]]) -> tuple[str, str, str] | None:
    import shapely

    drawn: Any = shapely.points(_across(sign) + OUT[sign.kind] * _front(sign))
    for shape, high in walls:
        if high <= _heights(sign)[0]:
            continue
        # Its edges may touch what stands across; between them it may not even lie in its own wall's face.
        within = [
            *shapely.contains(shape.buffer(-THIN), drawn),
            *shapely.contains(shape.buffer(THIN), drawn[1:-1]),
        ]
        if any(within):
            what = f"the {sign.kind} would be hidden inside a wall"
            return "at", what, "write a spot on the wall's face, and facing away from it"
    return None


def _on_opening(sign: Sign, plan: PlanFile) -> tuple[str, str, str] | None:
    low, top = _heights(sign)
    for opening in plan.opening:
        line = np.array([opening.start, opening.end], float)
        along, beside = measured(_across(sign), line)
        shared = min(along.max(), np.linalg.norm(line[1] - line[0])) - max(along.min(), 0.0)
        upright = min(top, opening.sill + opening.height) - max(low, opening.sill)
        if np.abs(beside).max() <= OPENING and shared > SLACK and upright > SLACK:
            return "at", f"the {sign.kind} hangs before the {opening.kind}", "move it beside, or over it"
    return None


def _over(one: Sign, other: Sign) -> bool:
    turned = (one.facing - other.facing + 180.0) % 360.0 - 180.0
    if abs(turned) > SAME_WAY:
        return False
    way, front = np.subtract(other.at, one.at), _front(one)
    beside = abs(way @ [front[1], -front[0]])
    upright = abs(one.height - other.height)
    return bool(
        abs(way @ front) < SAME_PLANE
        and beside < (one.size[0] + other.size[0]) / 2 - SLACK
        and upright < (one.size[1] + other.size[1]) / 2 - SLACK
    )


def _unread(sign: Sign, title: str) -> tuple[str, str] | None:
    if sign.kind == "picture":
        return None
    says = " ".join((sign.text or title).split())
    for letter in says:
        if unicodedata.category(letter) in MARKS or ord(letter) in SYMBOLS:
            return f"the sign {letter.encode('unicode_escape').decode()} cannot be drawn", "leave it out"
    wide, high = (round(1000 * side) for side in sign.size)
    size = letter_size(Writing(sign.kind, says, "", (wide, high)))
    if size < LEGIBLE:
        what = f"its {len(says)} letters would be {size:.0f} mm high, at least {LEGIBLE:.0f} mm can be read"
        return what, "shorten the text, or make the sign larger"
    return None


def _front(sign: Sign) -> Floats:
    angle = np.radians(sign.facing)
    return np.array([np.sin(angle), np.cos(angle)])


def _heights(sign: Sign) -> tuple[float, float]:
    """Of its lower and upper edge [m]."""
    return sign.height - sign.size[1] / 2, sign.height + sign.size[1] / 2


def _across(sign: Sign) -> Floats:
    """(N, 2) [m]: where it hangs, from its left edge to its right one, [x, z]."""
    x, z = _front(sign)
    half = sign.size[0] / 2 * np.array([z, -x])
    count = 2 + int(np.ceil(sign.size[0] / STEP))
    return np.linspace(np.asarray(sign.at) - half, np.asarray(sign.at) + half, count)
