"""The flat pattern of an outfit as a drawing in millimetres: panels, measures, grain, folds, named seams and ties.

One drawing for two sheets: `cutting_sheet` writes it as SVG, at true size, and as a picture.
"""

from __future__ import annotations

import string
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from sim_core.garment import Pattern
    from sim_core.garment.pattern.panels import Panel, Path, Seam, Spot, Tie

__all__ = ["Plan", "Stroke", "Words", "cutting_plan"]

Points = NDArray[np.float64]

INK, FAINT, ACCENT = "#201c1a", "#a3988a", "#9e2b25"
PAPER, CLOTH = (0.965, 0.945, 0.902), (0.94, 0.9, 0.82)  # sRGB
THIN = 1e-3  # [m] of cloth beyond the shoulder that makes it a fold
LONG = 2.5  # times as long as wide: such a panel lies along the sheet
SHAPE = 1.35  # width of the sheet over its height, about
LETTERS = 46  # a line of words is the sheet's longer side over this
SIDES = {"left": "左", "right": "右"}  # of the wearer, where a panel is cut for one alone
GAP = 5.0  # lines between panels: seams' letters, measures and names stand there
COLUMNS = 12  # entries of the legend from which it stands in two
KINDS = {"joined": ("平缝", "joined flat"), "sewn": ("缝合", "sewn"), "middle": ("中缝", "middle")}


@dataclass(frozen=True)
class Stroke:
    """A line through points (N, 2) [mm], y down; kind: outline (closed), fold, measure, grain or tie; fill: of an
    outline, #rrggbb."""

    points: Points
    kind: str
    fill: str | None = None


@dataclass(frozen=True)
class Words:
    """A line of words at (x, y) [mm], its size [mm]; latin: what a machine without Chinese letters shows instead,
    "" nothing.

    anchor: which part of it is there, start or middle; upright: whether it runs up the sheet.
    """

    x: float
    y: float
    text: str
    size: float
    latin: str | None = None
    anchor: str = "middle"
    colour: str = INK
    upright: bool = False


@dataclass(frozen=True)
class Plan:
    """A drawing: width and height [mm], strokes, words; title: Chinese and English."""

    size: tuple[float, float]
    strokes: tuple[Stroke, ...]
    words: tuple[Words, ...]
    title: tuple[str, str]


def cutting_plan(patterns: Sequence[Pattern], title: tuple[str, str]) -> Plan:
    """All panels of some patterns as they are cut: of a mirrored one a half, which is cut a second time turned over.

    title: of the sheet, Chinese and English. The warp runs along each panel's arrows.
    """
    laid = [_Laid.of(panel, pattern) for pattern in patterns for panel in _panels(pattern)]
    line = _line(laid)
    places, (width, height) = _shelves([np.ptp(one.outline, axis=0) for one in laid], GAP * line)
    strokes: list[Stroke] = []
    words = [Words(0.0, -3.2 * line, " ".join(title), 1.7 * line, title[1], "start")]
    for one, place in zip(laid, places, strict=True):
        one.shift = place - one.outline.min(0)
        strokes += one.strokes(line)
        words += one.words(line)
    below, names = height + 4.0 * line, _names()
    for pattern in patterns:
        own = {one.panel.name: one for one in laid if one.pattern is pattern}
        heading, legend = _heading(pattern), []
        for seam in pattern.seams:
            name = next(names)
            words += [own[path.panel].mark(path, name, line) for path in (seam.a, seam.b) if path]
            legend.append(_seam_words(name, seam, own))
        for (panel, place), ties in _tied(pattern).items():
            stroke, marks = own[panel].spot(place, ties, line)
            strokes.append(stroke)
            words += marks
        legend += [_tie_words(tie) for tie in pattern.ties]
        words.append(Words(0.0, below, heading[0], 1.1 * line, "", "start"))
        words.append(Words(0.0, below + 1.5 * line, heading[1], 1.1 * line, anchor="start"))
        below += 1.7 * line
        columns = 2 if len(legend) >= COLUMNS else 1
        rows = -(-len(legend) // columns)
        for number, (text, latin) in enumerate(legend):
            x, y = width / columns * (number // rows), below + 1.5 * line * (1 + number % rows)
            words.append(Words(x, y, text, 0.9 * line, latin, "start"))
        below += 1.5 * line * (rows + 2)
    return _framed(strokes, words, (width, below), title, line)


def _panels(pattern: Pattern) -> Sequence[Panel]:
    """The panels, or the only one of a pattern that is an outline."""
    from sim_core.garment.pattern.panels import Panel

    if pattern.panels:
        return pattern.panels
    ring = np.concatenate([pattern.outline, pattern.outline[:1]])
    return (Panel(pattern.name, ("start",), (ring,)),)


@dataclass
class _Laid:
    """A panel on the sheet: its outline (N, 2) [mm], turned where it is long, and where it is moved to."""

    panel: Panel
    pattern: Pattern
    turned: bool
    outline: Points
    shift: Points

    @staticmethod
    def of(panel: Panel, pattern: Pattern) -> _Laid:
        outline = 1000 * panel.outline()
        wide, long = np.ptp(outline, axis=0)
        laid = _Laid(panel, pattern, bool(long > LONG * wide), outline, np.zeros(2))
        laid.outline = laid.on_sheet(panel.outline())
        return laid

    def on_sheet(self, points: Points) -> Points:
        """Points (N, 2) [m] of the panel where they lie on the sheet [mm], as it is cut: what the right side alone has
        is the image of what its pattern draws. Of what both halves have one or the other lies there."""
        flat = 1000 * np.asarray(points, float).reshape(-1, 2)
        flat = flat * [-1.0, 1.0] if self.panel.side == "right" else flat
        if self.turned:
            twice = self.pattern.mirror and not self.panel.side
            flat = flat[:, [1, 0]] * [1.0, 1.0 if twice else -1.0]
        return flat + self.shift

    def strokes(self, line: float) -> Iterator[Stroke]:
        """Outline, shoulder fold, grain and measures."""
        ring = self.outline + self.shift
        yield Stroke(ring, "outline", _tint(self.panel.dye or self.pattern.dye or CLOTH))
        ahead, behind = self.panel.outline()[:, 1].max(), -self.panel.outline()[:, 1].min()
        if self.panel.along is None and self.pattern.panels and min(ahead, behind) > THIN:
            for a, b in _crossings(self.panel.outline(), 1, 0.0):
                yield Stroke(self.on_sheet(np.array([[a, 0.0], [b, 0.0]])), "fold")
        along = 0 if self.turned else 1
        middle = _inside(ring)
        (a, b), *_ = sorted(
            _crossings(ring, 1 - along, middle[1 - along]), key=lambda span: span[0] - span[1]
        )
        ends = np.full((2, 2), middle)
        ends[:, along] = np.array([0.75 * a + 0.25 * b, 0.25 * a + 0.75 * b])
        yield Stroke(ends, "grain")
        for tip, way in ((ends[0], 1.0), (ends[1], -1.0)):
            barb = np.full((3, 2), tip)
            barb[[0, 2], along] += 0.5 * way * line
            barb[[0, 2], 1 - along] += np.array([-0.22, 0.22]) * line
            yield Stroke(barb, "grain")
        low, high = ring.min(0), ring.max(0)
        for axis in (0, 1):
            ends = np.array([low, low])
            ends[1, axis] = high[axis]
            ends[:, 1 - axis] -= 1.4 * line
            yield Stroke(ends, "measure")
            for end in ends:
                tick = np.array([end, end])
                tick[:, 1 - axis] += np.array([-0.3, 0.3]) * line
                yield Stroke(tick, "measure")

    def words(self, line: float) -> Iterator[Words]:
        """The panel's name and its measures [mm]."""
        ring = self.outline + self.shift
        low, high = ring.min(0), ring.max(0)
        middle, size = (low + high) / 2, high - low
        told = [(self.panel.name, self.panel.name)]
        if self.panel.doubled:
            told.append(("双层 double", "double"))
        if self.panel.side:
            told.append((f"只裁{SIDES[self.panel.side]}身 {self.panel.side} only", f"{self.panel.side} only"))
        zh, en = "，".join(words[0] for words in told), ", ".join(words[1] for words in told)
        yield Words(middle[0], high[1] + 2.1 * line, zh, line, en if len(told) > 1 else None)
        across, down = (f"{value:.0f}" for value in size)
        yield Words(middle[0], low[1] - 1.7 * line, across, 0.9 * line, colour=ACCENT)
        yield Words(low[0] - 1.7 * line, middle[1], down, 0.9 * line, colour=ACCENT, upright=True)

    def mark(self, path: Path, name: str, line: float) -> Words:
        """A seam's letter beside the middle of its path."""
        from sim_core.garment.pattern.panels import arc_length, at_length

        legs = path.legs(self.panel)
        points = np.concatenate([legs[0][:1], *(leg[1:] for leg in legs)])
        half = arc_length(points)[-1] / 2
        here, ahead = self.on_sheet(at_length(points, np.array([half, half + 1e-3])))
        way = (ahead - here) / max(float(np.linalg.norm(ahead - here)), 1e-9)
        side = np.array([-way[1], way[0]])
        if _holds(self.outline + self.shift, here + 0.3 * line * side):
            side = -side  # outside, so that narrow panels stay legible
        x, y = here + 0.55 * line * side
        return Words(float(x), float(y) + 0.3 * line, name, 0.8 * line, colour=ACCENT)

    def spot(
        self, place: tuple[float, float], names: Sequence[str], line: float
    ) -> tuple[Stroke, list[Words]]:
        """A place [m] where ties are fastened, their names one under the other: inside, or beside its right edge."""
        (here,) = self.on_sheet(np.array([place]))
        turn = np.linspace(0, 2 * np.pi, 17)
        ring = here + 0.25 * line * np.column_stack([np.cos(turn), np.sin(turn)])
        outline = self.outline + self.shift
        low, high = outline.min(0), outline.max(0)
        upwards = here[1] > (low + high)[1] / 2 or here[0] > high[0] - line
        first = here[1] - line * (0.3 + 0.75 * (len(names) - 1)) if upwards else here[1] + 0.75 * line
        rows = [
            Words(here[0] + 0.4 * line, first + 0.75 * k * line, name, 0.6 * line, anchor="start")
            for k, name in enumerate(names)
        ]
        return Stroke(ring, "tie"), rows


def _line(laid: Sequence[_Laid]) -> float:
    """Height of a line of words [mm]: the sheet's longer side over so many."""
    area = sum(float(np.prod(np.ptp(one.outline, axis=0))) for one in laid)
    longest = max(float(np.ptp(one.outline, axis=0).max()) for one in laid)
    return max(longest, 1.3 * float(np.sqrt(SHAPE * area))) / LETTERS


def _shelves(sizes: Sequence[Points], gap: float) -> tuple[list[Points], tuple[float, float]]:
    """Lower corners of boxes set side by side in rows, and the size of it all."""
    area = sum(float((size + gap).prod()) for size in sizes)
    wide = max(max(float(size[0]) for size in sizes), float(np.sqrt(SHAPE * area)))
    order = sorted(range(len(sizes)), key=lambda k: -float(sizes[k][1]))
    places = [np.zeros(2) for _ in sizes]
    x = y = high = most = 0.0
    for k in order:
        if x > 0 and x + sizes[k][0] > wide:
            x, y, high = 0.0, y + high + gap, 0.0
        places[k] = np.array([x, y])
        x, high = x + float(sizes[k][0]) + gap, max(high, float(sizes[k][1]))
        most = max(most, x - gap)
    return places, (most, y + high)


def _framed(
    strokes: list[Stroke], words: list[Words], size: tuple[float, float], title: tuple[str, str], line: float
) -> Plan:
    """The drawing moved so that all of it lies on the sheet, with a margin."""
    corner = np.array([4.4 * line, 6.2 * line])
    moved = [Stroke(stroke.points + corner, stroke.kind, stroke.fill) for stroke in strokes]
    shifted = [replace(w, x=float(w.x + corner[0]), y=float(w.y + corner[1])) for w in words]
    width, height = np.array(size) + corner + 2.0 * line
    return Plan((float(width), float(height)), tuple(moved), tuple(shifted), title)


def _heading(pattern: Pattern) -> tuple[str, str]:
    """What a pattern's part of the legend is called, Chinese and English."""
    zh, en = (pattern.title.get(language, pattern.name) for language in ("zh", "en"))
    twice = pattern.mirror and any(not panel.side for panel in pattern.panels)
    half = ("，一半，翻转再裁一次", "; one half, cut a second time turned over") if twice else ("", "")
    if twice and not pattern.alike:
        half = ("，一半，除只裁一身者翻转再裁一次", f"{half[1]}, but for what one side has alone")
    return f"{zh}，毫米{half[0]}", f"{en}, millimetres{half[1]}"


def _seam_words(name: str, seam: Seam, own: dict[str, _Laid]) -> tuple[str, str]:
    """A seam by its letter: kind, panels, length [mm]."""
    zh, en = KINDS[seam.kind]
    panels = " + ".join(dict.fromkeys(path.panel for path in (seam.a, seam.b) if path))
    rest = f"{panels}, {1000 * seam.a.length(own[seam.a.panel].panel):.0f}"
    return f"{name} {zh} {en}: {rest}", f"{name} {en}: {rest}"


def _tie_words(tie: Tie) -> tuple[str, str]:
    """A tie by its name: what it draws together, length [mm]."""
    rest = f"tie {tie.name}: {_spot_words(tie.a)} + {_spot_words(tie.b)}, {1000 * tie.length:.0f}"
    return f"系带 {rest}", rest


def _tied(pattern: Pattern) -> dict[tuple[str, tuple[float, float]], list[str]]:
    """Panel and place [m] -> names of the ties fastened there, of a mirrored pattern with their side, L or R."""
    found: dict[tuple[str, tuple[float, float]], list[str]] = {}
    for tie in pattern.ties:
        for spot in (tie.a, tie.b):
            side = f" ({spot.side[0].upper()})" if spot.side else ""
            found.setdefault((spot.panel, spot.place), []).append(tie.name + side)
    return found


def _spot_words(spot: Spot) -> str:
    return f"{spot.panel} {spot.side}".strip()


def _names() -> Iterator[str]:
    """A, B, … Z, AA, AB, …"""
    yield from string.ascii_uppercase
    yield from map("".join, product(string.ascii_uppercase, repeat=2))


def _inside(ring: Points) -> Points:
    """A point (2,) well within an outline."""
    from shapely import Polygon

    point = Polygon(ring).representative_point()
    return np.array([point.x, point.y])


def _holds(ring: Points, point: Points) -> bool:
    from shapely import Point, Polygon

    return bool(Polygon(ring).contains(Point(point)))


def _crossings(ring: Points, axis: int, level: float) -> list[tuple[float, float]]:
    """From where to where, along the other axis, an outline (N, 2) is crossed at `level` of `axis`."""
    ahead = np.roll(ring, -1, axis=0)
    meets = (ring[:, axis] <= level) != (ahead[:, axis] <= level)
    a, b = ring[meets], ahead[meets]
    share = (level - a[:, axis]) / (b[:, axis] - a[:, axis])
    at = np.sort(a[:, 1 - axis] + share * (b[:, 1 - axis] - a[:, 1 - axis]))
    return [(float(low), float(high)) for low, high in at.reshape(-1, 2)]


def _tint(colour: tuple[float, float, float]) -> str:
    """The dye as a wash on paper."""
    r, g, b = (0.45 * np.array(colour) + 0.55 * np.array(PAPER)) * 255
    return f"#{int(r):02x}{int(g):02x}{int(b):02x}"
