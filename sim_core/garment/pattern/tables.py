"""Reads the panels and seams of a pattern file: measures in millimetres, curves, errors that name the key."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Annotated, Any, Literal, overload

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from sim_core.errors import OutlineError
from sim_core.garment.pattern.measures import measured
from sim_core.garment.pattern.panels import Panel, Path, Seam, Spot, Tie, check_extent
from sim_core.garment.pattern.pleats import Pleat, chords
from sim_core.mesh.outline import clean_contours

__all__ = [
    "CutProblem",
    "PanelTable",
    "SeamTable",
    "SpotTable",
    "TieTable",
    "read_cut",
    "read_dye",
    "read_measures",
    "read_spot",
]

Number = Annotated[float, Field(strict=True)]  # neither true nor "1"
Measure = Number | str
Share = Annotated[Number, Field(gt=0, lt=1)]  # of a length
CURVE_POINTS = 49  # per curved leg
EASE = 0.02  # sides of a seam may differ by this share


class CutProblem(ValueError):  # noqa: N818 - a problem of a file, told with its key
    """What is wrong under which key of the file."""

    def __init__(self, key: str, text: str) -> None:
        super().__init__(f"{key}: {text}")


class Table(BaseModel):
    model_config = ConfigDict(extra="forbid")


class PointTable(Table):
    name: str = Field(min_length=1, pattern=r"^[a-z][a-z0-9_]*$")
    at: tuple[Measure, Measure]
    curve: tuple[tuple[Measure, Measure], tuple[Measure, Measure]] | None = None


class PleatsTable(Table):
    at: Measure = Field(description="x at which the first pleat begins [mm]")
    count: int = Field(1, strict=True, ge=1, le=200, description="how many, side by side")
    depth: Measure = Field(description="of each fold [mm]: a pleat takes up twice as much cloth")
    step: Measure = Field(0.0, description="[mm] that each leaves to be seen before the next begins")
    towards: Literal["end", "begin"] = Field("end", description="where the outer folds point to, in x")
    opens: Number = Field(180.0, gt=0, le=180, description="[deg] that its creases may open to; 180: any")


class PanelTable(Table):
    name: str = Field(min_length=1, pattern=r"^[a-z][a-z0-9_]*$")
    outline: list[PointTable] = Field(min_length=3, max_length=200)
    doubled: bool = False
    along: str | None = None
    dye: str | None = Field(None, pattern=r"^#[0-9a-fA-F]{6}$")
    pleats: list[PleatsTable] = Field([], max_length=20)
    side: Literal["", "left", "right"] = Field(
        "", description="the wearer's, of a mirrored pattern that has it once"
    )


class SeamTable(Table):
    joined: tuple[str, str] | None = None
    sewn: tuple[str, str] | None = None
    middle: str | None = None
    notches: list[Share] = Field([], max_length=50)


class SpotTable(Table):
    panel: str = Field(description="panel of the pattern")
    side: Literal["", "left", "right"] = Field("", description="of the wearer, for a mirrored pattern")
    at: tuple[Measure, Measure] = Field(description="place in the panel's coordinates [mm], or expressions")


class TieTable(Table):
    name: str = Field(min_length=1, pattern=r"^[a-z][a-z0-9_]*$")
    a: SpotTable
    b: SpotTable
    length: Measure


def read_spot(
    key: str, table: SpotTable, known: Mapping[str, float], made: Mapping[str, Panel], *, mirrored: bool
) -> Spot:
    """A point of a panel; raises CutProblem naming the key."""
    if table.panel not in made:
        raise CutProblem(f"{key}.panel", f"{table.panel!r} is no panel – panels: {', '.join(made)}")
    if table.side and not mirrored:
        raise CutProblem(f"{key}.side", "only a pattern with mirror = true has sides – leave it out")
    x, y = (_told(f"{key}.at", lambda v=v: measured(v, known)) / 1000 for v in table.at)
    own = made[table.panel].side
    if table.side and own and table.side != own:
        raise CutProblem(f"{key}.side", f"{table.panel!r} is cut for the {own} alone – write {own!r}")
    outline = made[table.panel].outline()
    low, high = outline.min(0), outline.max(0)
    away = max(low[0] - x, x - high[0], low[1] - y, y - high[1])
    if away > 1e-6:
        raise CutProblem(
            f"{key}.at",
            f"{1000 * x:.0f}, {1000 * y:.0f} mm lies {1000 * away:.0f} mm outside the panel, which spans "
            f"{1000 * low[0]:.0f} to {1000 * high[0]:.0f} and {1000 * low[1]:.0f} to {1000 * high[1]:.0f}",
        )
    return Spot(table.panel, (x, y), table.side or own)


@overload
def read_dye(text: str) -> tuple[float, float, float]: ...
@overload
def read_dye(text: str | None) -> tuple[float, float, float] | None: ...
def read_dye(text: str | None) -> tuple[float, float, float] | None:
    """sRGB 0..1 of '#rrggbb'."""
    if text is None:
        return None
    r, g, b = (int(text[k : k + 2], 16) / 255 for k in (1, 3, 5))
    return r, g, b


def read_cut(
    measures: Mapping[str, Measure],
    panels: list[PanelTable],
    seams: list[SeamTable],
    ties: list[TieTable],
    *,
    mirrored: bool,
) -> tuple[tuple[Panel, ...], tuple[Seam, ...], tuple[Tie, ...]]:
    """Panels, seams and ties in metres. Raises CutProblem naming the key."""
    known = read_measures(measures)
    made: dict[str, Panel] = {}
    for table in panels:
        if table.name in made:
            raise CutProblem(f"panel.{table.name}", "is there twice – give each panel a name of its own")
        if table.side and not mirrored:
            raise CutProblem(
                f"panel.{table.name}.side", "only a pattern with mirror = true has sides – leave it out"
            )
        made[table.name] = _panel(table, known, made)
        _check_beside(made[table.name], made)
    stitched = tuple(_seam(k, table, made, mirrored) for k, table in enumerate(seams))
    _check_once(stitched, made)
    return tuple(made.values()), stitched, _ties(ties, known, made, mirrored)


def _check_beside(panel: Panel, made: Mapping[str, Panel]) -> None:
    """A band lies where the panel is that it is sewn to: on the one side alone that has that panel."""
    side = made[panel.along.panel].side if panel.along is not None else ""
    if panel.along is not None and side and panel.side != side:
        raise CutProblem(
            f"panel.{panel.name}.side",
            f"it lies along {panel.along.panel!r}, which is cut for the {side} alone – write {side!r}",
        )


def read_measures(measures: Mapping[str, Measure]) -> dict[str, float]:
    """Every measure [mm], each reckoned from those above it; raises CutProblem naming the key."""
    known: dict[str, float] = {}
    for name, value in measures.items():
        known[name] = _told(f"measures.{name}", lambda value=value: measured(value, known))
    return known


def _ties(
    tables: list[TieTable], known: Mapping[str, float], made: Mapping[str, Panel], mirrored: bool
) -> tuple[Tie, ...]:
    ties: dict[str, Tie] = {}
    for table in tables:
        key = f"tie.{table.name}"
        if table.name in ties:
            raise CutProblem(key, "is there twice – give each tie a name of its own")
        a, b = (
            read_spot(f"{key}.{end}", spot, known, made, mirrored=mirrored)
            for end, spot in (("a", table.a), ("b", table.b))
        )
        length = _told(f"{key}.length", lambda table=table: measured(table.length, known)) / 1000
        if not 0 < length <= 5:
            raise CutProblem(
                f"{key}.length", f"{1000 * length:.0f} mm – a tie is above 0 and at most 5000 mm long"
            )
        ties[table.name] = Tie(table.name, a, b, length)
    return tuple(ties.values())


def _told(key: str, do: Callable[[], Any]) -> Any:
    try:
        return do()
    except CutProblem:
        raise
    except ValueError as error:
        raise CutProblem(key, str(error)) from error


def _panel(table: PanelTable, known: Mapping[str, float], made: Mapping[str, Panel]) -> Panel:
    key = f"panel.{table.name}"

    def along(text: str) -> float:
        path = Path.read(text)
        return 1000 * path.length(_of(path, made))

    def place(point: PointTable, pair: tuple[Measure, Measure], what: str) -> np.ndarray:
        where = f"{key}.outline.{point.name}.{what}"
        return np.array([_told(where, lambda v=v: measured(v, known, along)) for v in pair]) / 1000

    names = tuple(point.name for point in table.outline)
    for name in names:
        if names.count(name) > 1:
            raise CutProblem(f"{key}.outline", f"corner {name!r} is there twice – name each corner once")
    at = [place(point, point.at, "at") for point in table.outline]
    legs = []
    for k in range(len(at)):
        following = table.outline[(k + 1) % len(at)]
        controls = [place(following, pair, "curve") for pair in following.curve or ()]
        legs.append(_leg(at[k], controls, at[(k + 1) % len(at)]))
    panel = Panel(
        table.name,
        names,
        tuple(legs),
        table.doubled,
        None
        if table.along is None
        else _told(f"{key}.along", lambda: _known(Path.read(table.along or ""), made)),
        read_dye(table.dye),
        _pleats(key, table.pleats, known),
        table.side,
    )
    try:
        check_extent(panel.outline())
        clean_contours(panel.outline(), ())
    except OutlineError as error:
        raise CutProblem(f"{key}.outline", str(error)) from error
    try:
        chords(panel.outline(), panel.pleats)
    except OutlineError as error:
        raise CutProblem(key, str(error)) from error
    return panel


def _pleats(key: str, tables: list[PleatsTable], known: Mapping[str, float]) -> tuple[Pleat, ...]:
    found: list[Pleat] = []
    for number, table in enumerate(tables, 1):
        where = f"{key}.pleats.{number}"
        at, depth, step = (
            _told(f"{where}.{name}", partial(measured, getattr(table, name), known)) / 1000
            for name in ("at", "depth", "step")
        )
        if not 0.002 <= depth <= 2.0:
            raise CutProblem(f"{where}.depth", f"{1000 * depth:.0f} mm – a fold is 2 to 2000 mm deep")
        if table.count > 1 and step < 0.002:
            raise CutProblem(f"{where}.step", f"{1000 * step:.1f} mm – pleats leave 2 mm or more to be seen")
        found += [
            Pleat(at + k * (2 * depth + step), depth, table.towards, float(np.radians(table.opens)))
            for k in range(table.count)
        ]
    found.sort(key=lambda pleat: pleat.at)
    for one, other in zip(found, found[1:], strict=False):
        if one.at + 2 * one.depth > other.at + 1e-9:
            raise CutProblem(
                f"{key}.pleats",
                f"one takes up x = {1000 * one.at:.0f} to {1000 * (one.at + 2 * one.depth):.0f} mm, the next begins "
                f"at {1000 * other.at:.0f} – let them follow one another",
            )
    return tuple(found)


def _leg(start: np.ndarray, controls: list[np.ndarray], end: np.ndarray) -> np.ndarray:
    """A straight leg, or a cubic Bezier curve in fine steps."""
    if not controls:
        return np.stack([start, end])
    t = np.linspace(0, 1, CURVE_POINTS)[:, None]
    first, second = controls
    return (1 - t) ** 3 * start + 3 * (1 - t) ** 2 * t * first + 3 * (1 - t) * t**2 * second + t**3 * end


def _of(path: Path, made: Mapping[str, Panel]) -> Panel:
    """The path's panel; ValueError where panel or corners are not known."""
    if path.panel not in made:
        raise ValueError(f"{path.panel!r} is no panel above it – panels: {', '.join(made) or 'none'}")
    panel = made[path.panel]
    for corner in (path.start, path.end):
        if corner not in panel.corners:
            raise ValueError(
                f"{corner!r} is no corner of {panel.name!r} – its corners: {', '.join(panel.corners)}"
            )
    if path.start == path.end:
        raise ValueError(f"{str(path)!r} has no length – name two corners")
    return panel


def _known(path: Path, made: Mapping[str, Panel]) -> Path:
    _of(path, made)
    return path


def _seam(number: int, table: SeamTable, made: Mapping[str, Panel], mirrored: bool) -> Seam:
    key = f"seam.{number + 1}"
    ways = {"joined": table.joined, "sewn": table.sewn, "middle": table.middle}
    given = [(kind, value) for kind, value in ways.items() if value is not None]
    if len(given) != 1:
        raise CutProblem(key, "give one of joined = [a, b], sewn = [a, b] or middle = a")
    kind, value = given[0]
    texts = [value] if kind == "middle" else list(value)
    paths = [_told(f"{key}.{kind}", lambda text=text: _known(Path.read(text), made)) for text in texts]
    if kind == "middle":
        if not mirrored:
            raise CutProblem(f"{key}.middle", "only a pattern with mirror = true has a middle")
        if table.notches:
            raise CutProblem(f"{key}.notches", "a middle meets its own image everywhere – leave them out")
        if made[paths[0].panel].side:
            raise CutProblem(
                f"{key}.middle",
                f"{paths[0].panel!r} is cut for one side alone: it has no image to meet – leave it out",
            )
        off = max(float(np.abs(leg[:, 0]).max()) for leg in paths[0].legs(made[paths[0].panel]))
        if off > 1e-6 and made[paths[0].panel].along is None:
            raise CutProblem(
                f"{key}.middle", f"{texts[0]!r} leaves x = 0 by {1000 * off:.1f} mm – lay it there"
            )
        return Seam("middle", paths[0])
    if len({made[path.panel].side for path in paths} - {""}) > 1:
        raise CutProblem(
            f"{key}.{kind}", "one panel is cut for the left, the other for the right – they never meet"
        )
    lengths = [path.length(made[path.panel]) for path in paths]
    if abs(lengths[0] - lengths[1]) > EASE * max(lengths):
        both = " and ".join(f"{1000 * length:.1f}" for length in lengths)
        raise CutProblem(f"{key}.{kind}", f"sides of {both} mm – make them equal within {EASE:.0%}")
    counts = [len(path.legs(made[path.panel])) for path in paths]
    if counts[0] != counts[1] and 1 not in counts:
        raise CutProblem(
            f"{key}.{kind}", f"{counts[0]} legs meet {counts[1]} – as many on both sides, or one"
        )
    return Seam(kind, paths[0], paths[1], tuple(table.notches))  # type: ignore[arg-type]


def _check_once(seams: tuple[Seam, ...], made: Mapping[str, Panel]) -> None:
    """In each half an edge is sewn once: what is cut for the left alone and what is for the right may share one."""
    seen: dict[tuple[str, int, str], tuple[int, int]] = {}
    for number, seam in enumerate(seams):
        sides = [path for path in (seam.a, seam.b) if path is not None]
        halves = [half for half in ("left", "right") if all(made[path.panel].is_of(half) for path in sides)]
        for side, path in enumerate(sides):
            for leg in made[path.panel].path(path.start, path.end, ahead=path.ahead):
                for half in halves:
                    if seen.setdefault((path.panel, leg, half), (number, side)) != (number, side):
                        raise CutProblem(
                            f"seam.{number + 1}", f"{str(path)!r} is sewn already – one seam a side"
                        )
