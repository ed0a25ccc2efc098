"""Generators beyond plain, twill and satin: ribs, derivatives of twill, irregular satin, damask from a motif."""

from collections.abc import Sequence
from math import lcm

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.draft.analysis import float_statistics
from sim_core.weave.draft.draft import Channels, Draft, check_size, plain, satin, twill

PATIENCE = 4  # rounds without fewer overlong floats after which a limit is given up; what can be kept takes about five

__all__ = [
    "basket",
    "check_limit",
    "damask",
    "diamond",
    "herringbone",
    "limit_floats",
    "satin_of_six",
    "striped",
    "weft_faced",
    "woven",
]


def weft_faced(draft: Draft) -> Draft:
    """The same weave with warp and weft exchanged: what the warp did, the weft does."""
    return Draft(f"{draft.name} weft", ~draft.lift.T)


def basket(warp: int, weft: int) -> Draft:
    """Plain weave with `weft` picks in each shed and `warp` ends side by side: ribs and hopsacks."""
    if warp < 1 or weft < 1:
        raise WeaveError(f"basket {warp}/{weft}: give at least one end and one pick")
    check_size(f"basket {warp}/{weft}", 2 * warp, 2 * weft)
    return Draft(f"basket {warp}/{weft}", np.kron(plain().lift, np.ones((weft, warp), bool)))


def herringbone(up: int, down: int, width: int) -> Draft:
    """A twill that turns back every `width` ends without a break of rhythm (pointed, the turning end not doubled)."""
    base = twill(up, down)
    if width < 2:
        raise WeaveError(f"herringbone {up}/{down}: width {width} – give at least 2 ends a stripe")
    check_size("herringbone", 2 * width)
    ends = np.concatenate([np.arange(width), width - np.arange(width)]) % base.ends
    return Draft(f"herringbone {up}/{down} {width}", base.lift[:, ends])


def diamond(up: int, down: int, width: int) -> Draft:
    """A twill pointed in both directions."""
    pointed = herringbone(up, down, width)
    picks = np.concatenate([np.arange(width), width - np.arange(width)]) % pointed.picks
    return Draft(f"diamond {up}/{down} {width}", pointed.lift[picks])


def striped(draft: Draft, warp: Sequence[Sequence[int]], weft: Sequence[Sequence[int]]) -> Draft:
    """The same weave with its ends and picks in stripes: how many yarns, which colour, in turn; empty: one colour.

    The draft grows until stripes and weave close together. Raises WeaveError where that is larger than any draft.
    """
    if not warp and not weft:
        return draft
    series = [
        np.repeat([colour for _, colour in stripes], [count for count, _ in stripes]) if stripes else None
        for stripes in (warp, weft)
    ]
    own = (draft.ends, draft.picks)
    ends, picks = (
        lcm(count, 1 if found is None else len(found)) for count, found in zip(own, series, strict=True)
    )
    check_size(f"striped {draft.name}", picks, ends)
    end_series, pick_series = (
        None if found is None else np.resize(found, count)
        for found, count in zip(series, (ends, picks), strict=True)
    )
    lift = woven(draft.lift, (picks, ends))
    return Draft(f"striped {draft.name}", lift, Channels(end_series=end_series, pick_series=pick_series))


def satin_of_six() -> Draft:
    """The irregular satin over 6 ends: no single step avoids a twill."""
    binding = np.array([0, 2, 5, 3, 1, 4])
    lift = np.ones((6, 6), bool)
    lift[np.arange(6), binding] = False
    return Draft("satin 6 irregular", lift)


def damask(
    motif: np.ndarray,
    ground: Draft | None = None,
    figure: Draft | None = None,
    *,
    longest: int = 0,
    name: str = "damask",
) -> Draft:
    """Ground weave with a figure weave where the motif is set.

    motif: (picks, ends) bool or 0/1; the weaves are tiled over it.  ground, figure: default a five-end warp satin and
    its weft face.  longest: floats of more crossings, on either face, get a binding point; 0 leaves them.
    Raises WeaveError where the limit cannot be kept (see `limit_floats`).
    """
    mask = np.array(motif)
    if mask.ndim != 2 or mask.size == 0 or mask.dtype != bool and not np.isin(mask, (0, 1)).all():
        raise WeaveError(f"{name}: the motif has shape {mask.shape} – give rows of picks by ends, 0 and 1")
    check_size(name, *mask.shape)
    ground = ground or satin(5, 2)
    figure = figure or weft_faced(ground)
    lift = np.where(mask.astype(bool), woven(figure.lift, mask.shape), woven(ground.lift, mask.shape))
    return Draft(name, limit_floats(lift, longest, name=name) if longest else lift)


def woven(repeat: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """What a repeat (picks, ends) says at each crossing, woven on over `shape`, cut off where it must be."""
    picks, ends = (np.arange(count) % own for count, own in zip(shape, repeat.shape, strict=True))
    return repeat[np.ix_(picks, ends)]


def check_limit(key: str, longest: int, drafts: Sequence[Draft]) -> None:
    """Raise WeaveError where one of the weaves floats over more crossings than `longest` by itself; 0: no limit.

    Binding such floats would make another weave of it all over the cloth, not mend the rim of a figure.
    """
    for draft in drafts:
        own = max(side.longest for side in float_statistics(draft))
        if 0 < longest < own:
            raise WeaveError(
                f"{key}: {longest} – {draft.name} itself floats over {own} crossings; give at least {own}, or 0 for no "
                "limit"
            )


def limit_floats(lift: np.ndarray, longest: int, *, name: str = "draft") -> np.ndarray:
    """Add binding points until no cyclic float, along ends or picks, on either face, exceeds `longest` crossings.

    A binding point is set where it breaks the long float and makes the shortest new float across it. Returns a new
    (picks, ends) bool array; raises WeaveError where the limit is below 1 or cannot be kept: where binding makes as
    many long floats as it breaks, for a few rounds, or has turned as many crossings as there are.
    """
    if longest < 1:
        raise WeaveError(f"{name}: a float limit of {longest} – give at least 1")
    lift = np.array(lift, bool)
    if min(lift.shape) == 1:
        raise WeaveError(f"{name}: one row cannot be bound – give at least 2 ends and picks")
    least, since, bound = np.inf, 0, 0
    while since < PATIENCE and bound < lift.size:
        found = _long_runs(lift, longest)
        if not found:
            return lift
        excess = sum(length - longest for *_, length in found)
        least, since = min(least, excess), since + 1 if excess >= least else 0
        bound += len(found)
        for axis, line, start, length in found:
            _bind(lift, axis, line, start, length, longest)
    raise WeaveError(f"{name}: floats of at most {longest} cannot be kept – allow longer ones")


def _long_runs(lift: np.ndarray, longest: int) -> list[tuple[int, int, int, int]]:
    """(axis the float runs along, line, start, length) of the overlong floats; 0 runs along an end."""
    found = []
    for axis, lines in ((0, np.ascontiguousarray(lift.T)), (1, lift)):
        count = lines.shape[1]
        begins = np.flatnonzero(lines != np.roll(lines, 1, axis=1))
        many = np.bincount(begins // count, minlength=len(lines))
        found += [(axis, int(row), 0, count) for row in np.flatnonzero(many == 0)]
        if not begins.size:
            continue
        # A float ends where the next begins, the last of a line where its first does, a lap further.
        last = np.cumsum(many[many > 0]) - 1
        lengths = np.diff(begins, append=0)
        lengths[last] = begins[np.append(0, last[:-1] + 1)] + count - begins[last]
        long = np.flatnonzero(lengths > longest)
        rows, starts = np.divmod(begins[long], count)
        told = rows.tolist(), starts.tolist(), lengths[long].tolist()
        found += [(axis, *one) for one in zip(*told, strict=True)]
    return found


def _bind(lift: np.ndarray, axis: int, line: int, start: int, length: int, longest: int) -> None:
    """Flip one crossing of a float, near its middle, where the float that arises across it is shortest."""
    lines, across = (lift.T, lift) if axis == 0 else (lift, lift.T)
    count = lines.shape[1]
    places = (start + np.arange(length)) % count
    if not (lines[line, places] == lines[line, places[0]]).all():
        return  # an earlier binding point broke it already
    best, best_cost = int(places[length // 2]), np.inf
    for offset in range(length):
        place = int(places[offset])
        new = _run_through(across[place], line)
        off_middle = abs(offset - (length - 1) / 2) / length
        cost = (100.0 * (new > longest)) * new + new + 0.9 * off_middle
        if cost < best_cost:
            best, best_cost = place, cost
    lines[line, best] = not lines[line, best]


def _run_through(row: np.ndarray, place: int) -> int:
    """Length of the cyclic run through `place` once the value there is flipped."""
    wanted, count, run = not row[place], row.size, 1
    for step in (1, -1):
        k = place + step
        while run < count and row[k % count] == wanted:
            run, k = run + 1, k + step
    return run
