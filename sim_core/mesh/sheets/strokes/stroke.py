"""What is drawn on a pattern sheet before anyone says what it is: lines with the names that stand around them."""

from collections import Counter
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.spatial import KDTree

__all__ = ["MOST_VISITED", "Drawn", "Stroke", "joined", "visited"]

NEAR = 1e-6  # of the drawing's extent: ends this near are joined
MOST_VISITED = 200_000  # elements, those of blocks and uses each time they are drawn


@dataclass(frozen=True)
class Stroke:
    """One line of a drawing.

    points: (n, 2) [m], y down; n = 1 is a mark.  closed: the first point is not repeated.  layer: the DXF layer, or
    the SVG class.  groups: names of the groups or the block around it, outermost first.  words: what its classes,
    names and layers say, lower case.  filled: an area without a line
    around it.  dashed: not drawn through.  name: its own.
    """

    points: np.ndarray
    closed: bool
    layer: str = ""
    groups: tuple[str, ...] = ()
    words: tuple[str, ...] = ()
    filled: bool = False
    dashed: bool = False
    name: str = ""


@dataclass(frozen=True)
class Drawn:
    """What a reader found: lines, what it left out (name: how often); remarks and notes as in `Sheet`."""

    strokes: list[Stroke]
    left_out: Counter[str] = field(default_factory=Counter)
    remarks: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


def joined(drawn: list[Stroke]) -> list[Stroke]:
    """Open lines of one layer and group joined end to end where only two ends meet; what comes back is closed.

    A line that hangs free at its other end does not count where it meets a joint: it is an inner line.
    """
    if not drawn or not all(np.isfinite(stroke.points).all() for stroke in drawn):
        return drawn
    near = NEAR * float(np.ptp(np.concatenate([stroke.points for stroke in drawn]), axis=0).max())
    found = [(k, stroke) for k, stroke in enumerate(drawn) if stroke.closed or len(stroke.points) == 1]
    open_ones: dict[tuple, list[int]] = {}
    for k, stroke in enumerate(drawn):
        if not stroke.closed and np.ptp(stroke.points, axis=0).max() > near:
            key = (stroke.groups, stroke.layer, stroke.words, stroke.dashed, stroke.filled)
            open_ones.setdefault(key, []).append(k)
    for places in open_ones.values():
        for first, points, closed in _chains([drawn[k].points for k in places], near):
            found.append((places[first], replace(drawn[places[first]], points=points, closed=closed)))
    return [stroke for _, stroke in sorted(found, key=lambda pair: pair[0])]


def _chains(rest: list[np.ndarray], near: float) -> list[tuple[int, np.ndarray, bool]]:
    """The chains of open lines: (its first line's number, points, whether it came back to its start)."""
    mate = _mates(rest, near)
    done: set[int] = set()
    found = []
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
        found.append((k, line[:-1] if closed else line, closed))
    return found


def _mates(lines: list[np.ndarray], near: float) -> list[int]:
    """For both ends of each line the one other end that it meets, or -1."""
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


def visited(before: int) -> int:
    """One element more; raises ValueError where a drawing multiplies itself beyond bearing."""
    if before >= MOST_VISITED:
        raise ValueError(f"it draws more than {MOST_VISITED} elements")
    return before + 1
