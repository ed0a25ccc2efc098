"""Outlines from text DXF: LWPOLYLINE, POLYLINE, LINE, ARC, CIRCLE, ELLIPSE and SPLINE, joined where their ends meet.

Closed lines are contours (the largest is the outline, the others are holes), open ones are inner lines. $INSUNITS
gives the unit; without it a drawing is taken to be in millimetres. DXF has y up; the outline has y down. Blocks are
drawn where they are inserted; other entities, paper space and layers that are off or frozen are left out with an
OutlineWarning that names them.
"""

from collections import Counter
from collections.abc import Iterator
from math import cos, radians, sin
from pathlib import Path

import numpy as np
from scipy.spatial import KDTree

from sim_core.errors import FileProblem
from sim_core.mesh.dxf_lines import Entity, Tags, as_seen, entity_lines
from sim_core.mesh.left_out import visited, warn_left_out
from sim_core.reading import read_text

__all__ = ["read_dxf"]

METRES = {0: 1e-3, 1: 0.0254, 2: 0.3048, 4: 1e-3, 5: 1e-2, 6: 1.0, 10: 0.9144, 14: 0.1}
NEAR = 1e-6  # of the drawing's extent: ends this near are joined
DRAWN = ("LWPOLYLINE", "POLYLINE", "LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE")
MARKS = ("SEQEND", "VERTEX", "ENDBLK", "ATTDEF", "VIEWPORT")  # draw nothing by themselves

Line = tuple[np.ndarray, bool]


def read_dxf(path: Path) -> list[tuple[np.ndarray, bool]]:
    """The lines of a DXF file as (points (n, 2) [m], y down, closed). Raises FileProblem."""
    text = read_text(path, "an outline drawn as DXF")
    if text.startswith("AutoCAD Binary DXF"):
        raise FileProblem(f"{path}: binary DXF – save it as text (ASCII) DXF")
    lines = text.splitlines()
    try:
        pairs = [(int(lines[k]), lines[k + 1].strip()) for k in range(0, len(lines) - 1, 2)]
    except ValueError as error:
        raise FileProblem(f"{path}: not a DXF file ({error}) – give an outline drawn as text DXF") from error
    if not any(pair == (0, "SECTION") for pair in pairs):
        raise FileProblem(f"{path}: no section in it – give an outline drawn as text DXF")
    try:
        with np.errstate(all="ignore"):  # what leaves the range is told by whoever sorts the lines
            walk = _Walk(pairs)
            drawn = list(walk.lines(_entities(pairs, "ENTITIES")))
        scale = METRES.get(_unit(pairs))
    except RecursionError as error:
        raise FileProblem(f"{path}: blocks nested too deep – explode them") from error
    except (ValueError, IndexError, ZeroDivisionError, OverflowError) as error:
        raise FileProblem(f"{path}: an entity cannot be read ({error}) – draw it as polylines") from error
    if scale is None:
        raise FileProblem(f"{path}: $INSUNITS {_unit(pairs)} – draw in mm, cm, m, dm, inches, feet or yards")
    warn_left_out(path, walk.left_out)
    return [(points * (scale, -scale), closed) for points, closed in _joined(drawn)]


def _unit(pairs: list[tuple[int, str]]) -> int:
    for k, pair in enumerate(pairs[:-1]):
        if pair == (9, "$INSUNITS"):
            return int(pairs[k + 1][1])
    return 0


def _entities(pairs: list[tuple[int, str]], section: str) -> list[Entity]:
    """What a section holds, vertices of a POLYLINE folded into it."""
    found: list[Entity] = []
    inside, outline = False, None
    for k, (code, value) in enumerate(pairs):
        if code == 0:
            if value == "SECTION":
                inside = k + 1 < len(pairs) and pairs[k + 1] == (2, section)
            elif value == "ENDSEC":
                inside = False
            elif inside and value == "SEQEND":
                outline = None
            elif inside and value == "VERTEX" and outline is not None:
                outline.append((-1, ""))
            elif inside:
                found.append((value, []))
                outline = found[-1][1] if value == "POLYLINE" else None
        elif inside and found:
            found[-1][1].append((code, value))
    return found


class _Walk:
    """A way through a drawing, inserts followed into their blocks."""

    def __init__(self, pairs: list[tuple[int, str]]) -> None:
        self.blocks: dict[str, tuple[np.ndarray, list[Entity]]] = {}
        self.left_out: Counter[str] = Counter()
        self.visits = 0
        held: list[Entity] = []
        for kind, tags in _entities(pairs, "BLOCKS"):
            if kind == "BLOCK":
                held = []
                base = np.array([_number(tags, 10), _number(tags, 20)])
                self.blocks[_first(tags, 2)] = base, held
            else:
                held.append((kind, tags))
        layers = [tags for kind, tags in _entities(pairs, "TABLES") if kind == "LAYER"]
        self.dark = {
            _first(tags, 2)
            for tags in layers
            if int(_first(tags, 70, "0")) & 1 or int(_first(tags, 62, "7")) < 0
        }

    def lines(self, entities: list[Entity], within=(), layer="0") -> Iterator[Line]:
        """Lines of entities, in their own frame. within: names of the blocks around.  layer: the insert's."""
        for kind, tags in entities:
            self.visits = visited(self.visits)
            own = _first(tags, 8, "0")
            own = layer if own == "0" else own  # what a block draws on layer 0 lies on its insert's
            if kind in MARKS:
                continue
            if _first(tags, 67) == "1":
                self.left_out["in paper space"] += 1
            elif _first(tags, 60) == "1":
                self.left_out["invisible"] += 1
            elif own in self.dark:
                self.left_out[f"on layer {own}, off or frozen"] += 1
            elif kind == "INSERT":
                yield from self._inserted(tags, within, own)
            elif kind in DRAWN:
                yield from (as_seen((kind, tags), line) for line in entity_lines((kind, tags)))
            else:
                self.left_out[kind] += 1

    def _inserted(self, tags: Tags, within: tuple[str, ...], layer: str) -> Iterator[Line]:
        name = _first(tags, 2)
        if name not in self.blocks:
            self.left_out[f"INSERT of {name or 'nothing'}"] += 1
            return
        if name in within:
            raise ValueError(f"block {name[:40]} within itself")
        base, entities = self.blocks[name]
        turn = radians(_number(tags, 50))
        turned = np.array([[cos(turn), sin(turn)], [-sin(turn), cos(turn)]])  # for rows of points
        scale = np.array([_number(tags, 41, 1.0), _number(tags, 42, 1.0)])
        seen = np.array([-1.0 if _number(tags, 230, 1.0) < 0 else 1.0, 1.0])
        columns, rows = (max(1, int(_number(tags, code, 1.0))) for code in (70, 71))
        for j in range(columns):
            for i in range(rows):
                self.visits = visited(self.visits)
                place = np.array([j * _number(tags, 44), i * _number(tags, 45)])
                for points, closed in self.lines(entities, (*within, name), layer):
                    moved = ((points - base) * scale + place) @ turned
                    yield (moved + (_number(tags, 10), _number(tags, 20))) * seen, closed


def _first(tags: Tags, code: int, missing: str = "") -> str:
    return next((text for c, text in tags if c == code), missing)


def _number(tags: Tags, code: int, missing: float = 0.0) -> float:
    return float(_first(tags, code, str(missing)))


def _joined(drawn: list[tuple[np.ndarray, bool]]) -> list[tuple[np.ndarray, bool]]:
    """Open lines joined end to end where only two ends meet; what comes back to its start is closed.

    A line that hangs free at its other end does not count where it meets a joint: it is an inner line.
    """
    if not drawn or not all(np.isfinite(points).all() for points, _ in drawn):
        return drawn
    near = NEAR * float(np.ptp(np.concatenate([points for points, _ in drawn]), axis=0).max())
    found = [line for line in drawn if line[1]]
    rest = [points for points, closed in drawn if not closed and np.ptp(points, axis=0).max() > near]
    mate = _mates(rest, near)
    done: set[int] = set()
    for k in range(len(rest)):
        if k in done:
            continue
        begin = 2 * k  # ends are numbered 2 k and 2 k + 1: back to where this chain begins, or once around
        while mate[begin] >= 0 and mate[begin] ^ 1 != 2 * k:
            begin = mate[begin] ^ 1
        parts, end = [], begin
        while end >= 0 and end // 2 not in done:
            done.add(end // 2)
            part = rest[end // 2][:: -1 if end % 2 else 1]
            parts.append(part[1:] if parts else part)
            end = mate[end ^ 1]
        line = np.vstack(parts)
        closed = len(line) > 3 and bool(np.hypot(*(line[0] - line[-1])) <= near)
        found.append((line[:-1] if closed else line, closed))
    return found


def _mates(lines: list[np.ndarray], near: float) -> list[int]:
    """For both ends of each line the one other end that it meets, or -1."""
    if not lines:
        return []
    ends = np.array([line[k] for line in lines for k in (0, -1)])
    pairs = KDTree(ends).query_pairs(near, output_type="ndarray")
    meets = np.bincount(pairs.ravel(), minlength=len(ends))
    other = np.arange(len(ends)) ^ 1
    hangs = (meets > 1) & (meets[other] == 0)
    pairs = pairs[~hangs[pairs].any(axis=1)]
    meets = np.bincount(pairs.ravel(), minlength=len(ends))
    pairs = pairs[(meets[pairs] == 1).all(axis=1)]
    mate = np.full(len(ends), -1)
    mate[pairs] = pairs[:, ::-1]
    return mate.tolist()
