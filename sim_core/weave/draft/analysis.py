"""What a draft tells before anything is simulated: floats, interlacings, whether it hangs together."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from sim_core.weave.draft.draft import KINDS, Draft
from sim_core.weave.draft.factors import Factors

EXTRA = KINDS.index("extra")
Sides = tuple[np.ndarray, np.ndarray]  # counts of the floats of each length on face and back

__all__ = [
    "FloatLengths",
    "Summary",
    "craft_floats",
    "float_statistics",
    "hangs_together",
    "summary",
    "summary_of_factors",
]


@dataclass(frozen=True)
class FloatLengths:
    """Floats along one yarn system, counted in crossings: `face` and `back` hold (length, how many) pairs."""

    face: tuple[tuple[int, int], ...]
    back: tuple[tuple[int, int], ...]

    @property
    def longest(self) -> int:
        return max(length for length, _ in (*self.face, *self.back))

    @property
    def mean(self) -> float:
        both = (*self.face, *self.back)
        return sum(length * count for length, count in both) / sum(count for _, count in both)


@dataclass(frozen=True)
class Summary:
    """A draft in numbers, taken over its smallest repeat. interlacings: changes of face over all ends and picks."""

    ends: int
    picks: int
    face: str
    warp: FloatLengths
    weft: FloatLengths
    interlacings: int
    integral: bool


def summary(draft: Draft) -> Summary:
    """Smallest repeat, face class, floats, interlacings and integrity of a draft with all its channels."""
    small = draft.repeat()
    counted = _counted(Factors.of_lift(small.lift))
    return counted if _bare(draft) else replace(counted, integral=hangs_together(small))


def summary_of_factors(factors: Factors) -> Summary:
    """The same of a lift without channels, counted by its kinds of ends and picks, however large it is."""
    return _counted(factors.repeat())


def _counted(small: Factors) -> Summary:
    picks, ends = small.counts()
    ones = int(picks @ small.core.astype(np.int64) @ ends)
    rest = small.picks * small.ends - ones
    face = "warp" if ones > rest else "weft" if ones < rest else "same"
    counts = small.float_counts()
    # a yarn that changes side has as many changes as runs; one that does not, has a run as long as the repeat
    changes = sum(int(side[:-1].sum()) for sides in counts for side in sides)
    return Summary(small.ends, small.picks, face, *_floats(counts), changes, small.hangs_together())


def float_statistics(draft: Draft) -> tuple[FloatLengths, FloatLengths]:
    """Floats of the warp and of the weft. A float is a maximal cyclic run of equal entries along one yarn."""
    return _floats(Factors.of_lift(draft.lift).float_counts())


def craft_floats(draft: Draft) -> dict[str, FloatLengths | None]:
    """Floats as a weaver counts them, of "warp" and "weft", and "extra" of brocading wefts; None: no float is meant.

    Brocade: those of the ground without its extra picks, and those of extra wefts on the face between their bindings.
    Compound: of the series that shows, on the face; the other yarns lie between face and back and float nowhere. Leno
    ends cross one another: how long they lie over the picks says nothing of what holds them.
    """
    channels = draft.channels
    if channels.layer is not None:
        shown = (channels.layer == 0) & (draft.lift if channels.end_series is not None else ~draft.lift)
        if channels.end_series is not None:
            return {"warp": _where(shown.T), "weft": None}
        return {"warp": None, "weft": _where(shown)}
    if channels.order is not None:
        return {"warp": None, "weft": None}
    kinds = channels.pick_kind
    if kinds is None or not (extra := kinds == EXTRA).any():
        warp, weft = float_statistics(draft.repeat())
        return {"warp": warp, "weft": weft}
    region = np.zeros(draft.lift.shape, int) if channels.region is None else channels.region
    # Each colour has a bobbin of its own: where two meet, one float ends and another begins.
    shown = [((region == one) & ~draft.lift)[extra] for one in np.unique(region[extra]) if one >= 0]
    warp, weft = float_statistics(Draft("ground", draft.lift[~extra]).repeat())
    return {"warp": warp, "weft": weft, "extra": _where(np.concatenate(shown)) if shown else None}


def _where(shown: np.ndarray) -> FloatLengths | None:
    """Floats on the face of yarns (yarns, crossings) where they show; None where none does."""
    (face, _), _ = Factors.of_lift(shown.T).float_counts()
    pairs = tuple((int(n), int(face[n])) for n in np.flatnonzero(face))
    return FloatLengths(pairs, ()) if pairs else None


def _floats(counts: tuple[Sides, Sides]) -> tuple[FloatLengths, FloatLengths]:
    made = []
    for sides in counts:
        pairs = (tuple((int(n), int(side[n])) for n in np.flatnonzero(side)) for side in sides)
        made.append(FloatLengths(*pairs))
    return made[0], made[1]


def _bare(draft: Draft) -> bool:
    channels = draft.channels
    return channels.region is None and channels.order is None


def hangs_together(draft: Draft) -> bool:
    """Whether no part of the cloth can be lifted off the rest (Clapham 1980, Enns 1984).

    A yarn can only be lifted together with all that lies over it. So the cloth hangs together exactly if the graph
    with an arrow from each yarn to every yarn over it is strongly connected. A weft that is cut into regions is one
    yarn a region (regions of one number that touch across the border are one); two ends that change places add an
    arrow from the doup end to the one over it.
    """
    ends, lift = draft.ends, draft.lift
    weft = _pieces(draft)  # (picks, ends) number of the weft piece, -1 where there is none
    present = weft >= 0
    picks, columns = np.nonzero(present)
    node = ends + weft[picks, columns]
    over = lift[picks, columns]
    tail, head = np.where(over, node, columns), np.where(over, columns, node)
    crossings = _order_arrows(draft)
    tail, head = np.append(tail, crossings[:, 0]), np.append(head, crossings[:, 1])
    size = ends + int(weft.max()) + 1
    graph = csr_matrix((np.ones(tail.size, dtype=np.int8), (tail, head)), shape=(size, size))
    return int(connected_components(graph, connection="strong", return_labels=False)) == 1


def _pieces(draft: Draft) -> np.ndarray:
    region = draft.channels.region
    if region is None:
        return np.repeat(np.arange(draft.picks)[:, None], draft.ends, axis=1)
    pieces = np.full(region.shape, -1)
    number = 0
    for row, values in enumerate(region):
        change = values != np.roll(values, 1)
        run = np.cumsum(change) % max(int(change.sum()), 1)
        for piece in np.unique(run[values >= 0]):
            pieces[row, (run == piece) & (values >= 0)] = number
            number += 1
    return pieces


def _order_arrows(draft: Draft) -> np.ndarray:
    """(n, 2) arrows doup -> other end for every pair that changes places between two picks, across the border too."""
    order, series = draft.channels.order, draft.channels.end_series
    if order is None or series is None:
        return np.zeros((0, 2), dtype=int)
    arrows = set()
    following = np.roll(order, -1, axis=0)
    for doup in np.flatnonzero(series == 1):
        for other in np.flatnonzero(series != 1):
            for shift in (-draft.ends, 0, draft.ends):  # the neighbour repeats
                before = order[:, doup] - order[:, other] - shift
                after = following[:, doup] - following[:, other] - shift
                if (before * after < 0).any():
                    arrows.add((int(doup), int(other)))
    return np.array(sorted(arrows), dtype=int).reshape(-1, 2)
