"""Where yarns float too far: the stretches of a draft that are longer than a limit, on its face and on its back."""

from __future__ import annotations

import numpy as np

from sim_core.weave.draft.factors import Factors

__all__ = ["Floats", "long_floats"]

Floats = dict[
    str, np.ndarray
]  # "warp face", "warp back", "weft face", "weft back" -> (n, 3) int: yarn, begin, end


def long_floats(factors: Factors, limit: int, picks: slice, ends: slice) -> Floats:
    """Floats over more than `limit` crossings that pass through a part of the draft, cut off at its border.

    Floats go on over the border of the draft, since it repeats. (n, 3) int a kind: number of the yarn, and from which
    crossing to before which it floats, all counted within the part.
    """
    warp = _along(factors.core.T, factors.pick, factors.end[ends], picks, limit)
    weft = _along(~factors.core, factors.end, factors.pick[picks], ends, limit)
    return {"warp face": warp[0], "warp back": warp[1], "weft face": weft[0], "weft back": weft[1]}


def _along(
    core: np.ndarray, along: np.ndarray, kinds: np.ndarray, part: slice, limit: int
) -> tuple[np.ndarray, np.ndarray]:
    """Floats on both sides of the yarns of these kinds, within the part of what they cross."""
    low, high = part.start, part.stop
    found: dict[int, tuple[np.ndarray, np.ndarray]] = {}
    made: tuple[list[np.ndarray], list[np.ndarray]] = ([], [])
    for number, kind in enumerate(kinds.tolist()):
        if kind not in found:
            found[kind] = _stretches(core[kind][along], limit, low, high)
        for side, stretches in zip(made, found[kind], strict=True):
            if len(stretches):
                side.append(np.column_stack([np.full(len(stretches), number), stretches]))
    none = np.zeros((0, 3), dtype=np.int64)
    return tuple(np.concatenate(side) if side else none for side in made)  # type: ignore[return-value]


def _stretches(side: np.ndarray, limit: int, low: int, high: int) -> tuple[np.ndarray, np.ndarray]:
    """(n, 2) begin and end of the long cyclic runs of True, and of False, within low to high, counted from low."""
    size = len(side)
    starts = np.flatnonzero(side != np.roll(side, 1))
    if not starts.size:
        whole = np.array([[0, high - low]]) if size > limit else np.zeros((0, 2), dtype=np.int64)
        return (whole, whole[:0]) if side[0] else (whole[:0], whole)
    stops = np.append(starts[1:], starts[0] + size)
    long = stops - starts > limit
    made = []
    for on_top in (True, False):
        pick = long & (side[starts] == on_top)
        begin, end = starts[pick], stops[pick]
        # what runs over the border is there at both of them
        begin, end = np.append(begin, begin - size), np.append(end, end - size)
        begin, end = np.clip(begin, low, high), np.clip(end, low, high)
        inside = end > begin
        made.append(np.column_stack([begin[inside], end[inside]]) - low)
    return made[0], made[1]
