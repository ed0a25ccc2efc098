"""Profile drafts blocked out: each block of a profile becomes a unit of a structure, as pattern or as ground.

A unit is a pair of little lifts of one size, woven where the profile is filled and where it is not. Ends that are
lifted alike in both are ties: all blocks share their shafts, which come first; the others have shafts of their own for
every block. So summer and winter takes two shafts and one a block, a turned twill four a block.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.draft.algebra import Harness, kinds_of, lift_plan, tie_up
from sim_core.weave.draft.draft import Draft
from sim_core.weave.draft.notation import draft_of_words
from sim_core.weave.files.wif.model import MOST_TREADLES, Wif
from sim_core.weave.files.wif.sections import listed

__all__ = ["STRUCTURES", "blocked_out", "unit_of"]

MOST_ENDS = 65_536  # or picks of what is blocked out
Unit = tuple[np.ndarray, np.ndarray]  # lift of pattern and of ground, (picks, ends) bool, 1 = warp on top


def _rows(*texts: str) -> np.ndarray:
    return np.array([[place == "1" for place in text] for text in texts])


# Rows are picks from the first on. Summer and winter: tabby and pattern picks in turn, threaded 1-P-2-P. Bronson lace:
# picks that pass under one end of six, tabby between, threaded 1-P-1-P-1-2. Double: two tabbies that change places.
STRUCTURES: dict[str, Unit] = {
    "summer-winter": (_rows("1010", "1000", "0101", "0010"), _rows("1010", "1101", "0101", "0111")),
    "bronson": (
        _rows("000001", "101010", "000001", "101010", "010101", "101010"),
        _rows("010101", "101010", "010101", "101010", "010101", "101010"),
    ),
    "double": (_rows("1000", "1110", "0010", "1011"), _rows("1101", "0100", "0111", "0001")),
}


def unit_of(structure: str) -> Unit:
    """The unit of a structure by name, or of a twill or satin against its other face ("twill:3/1", "satin:5/2").

    Raises WeaveError for another word.
    """
    if structure in STRUCTURES:
        return STRUCTURES[structure]
    try:
        draft = draft_of_words(structure)
    except WeaveError as error:
        raise WeaveError(
            f"{structure[:60]!r}: no such structure – give {', '.join(STRUCTURES)}, or a twill or satin such as "
            "twill:3/1 or satin:5/2"
        ) from error
    if draft.face == "same":
        raise WeaveError(
            f"{structure[:60]!r}: alike on both faces – give one that differs, such as twill:3/1"
        )
    return draft.lift, _turned(draft)


def _turned(draft: Draft) -> np.ndarray:
    """The other face of a weave, its binding points set so that blocks meet in a clean line as far as they can."""
    lift = ~draft.lift[::-1]
    shifts = [np.roll(lift, k, axis=0) for k in range(len(lift))]
    # blocks meet best where neighbours of the border oppose each other
    cost = [int((draft.lift[:, -1] == s[:, 0]).sum() + (draft.lift[:, 0] == s[:, -1]).sum()
                + (draft.lift[-1] == s[0]).sum() + (draft.lift[0] == s[-1]).sum()) for s in shifts]  # fmt: skip
    return shifts[int(np.argmin(cost))]


def blocked_out(profile: Wif, structure: str) -> Wif:
    """A profile draft, in which shafts are blocks, blocked out by a structure; as a file of a draft.

    Every end of the profile becomes as many ends as the unit has, every pick as many picks, in the same colours; in
    double weave, the ends of one layer have the colour of the profile's weft and its picks that of the warp.
    Raises WeaveError where an end of the profile is on no block or on several, or too many yarns arise.
    """
    pattern, ground = unit_of(structure)
    threading = profile.harness.threading
    wrong = np.flatnonzero(threading.sum(axis=1) != 1)
    if wrong.size:
        raise WeaveError(f"profile: ends {listed(wrong + 1)} – each end of a profile is on one block")
    plan = lift_plan(profile.harness.tieup, profile.harness.treadling)
    block = threading.argmax(axis=1)
    rows, columns = pattern.shape
    if max(len(block) * columns, len(plan) * rows) > MOST_ENDS:
        raise WeaveError(
            f"profile: blocked out it has more than {MOST_ENDS:,} ends or picks – give a part of it"
        )
    shafts, tied = _shafts(pattern, ground, threading.shape[1])
    woven = _plan(pattern, ground, plan, shafts, tied)
    tieup, treadling = _tabby_first(*tie_up(woven), (pattern == ground).all(axis=1))
    by_plan = tieup.shape[1] > MOST_TREADLES
    if by_plan:
        tieup, treadling = np.eye(woven.shape[1], dtype=bool), woven
    ends = shafts[block].ravel()
    warp, weft = _colours(profile, structure, columns, rows)
    return replace(
        profile,
        title=f"{profile.title or 'profile'}, {structure}",
        harness=Harness(np.eye(woven.shape[1], dtype=bool)[ends], tieup, treadling),
        plan=by_plan,
        warp_colours=warp,
        weft_colours=weft,
        other=(),
        private=None,
    )


def _tabby_first(
    tieup: np.ndarray, treadling: np.ndarray, tabby: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Treadles of the picks that pattern and ground have alike come first, as weavers tie them."""
    used = treadling[np.flatnonzero(np.resize(tabby, len(treadling)))].any(axis=0)
    order = np.argsort(~used, kind="stable")
    return tieup[:, order], treadling[:, order]


def _shafts(pattern: np.ndarray, ground: np.ndarray, blocks: int) -> tuple[np.ndarray, int]:
    """Shaft of every end of the unit in every block, (blocks, ends) from 0, and how many ties there are."""
    both = np.vstack([pattern, ground]).T
    ties = (pattern == ground).all(axis=0)
    shafts = np.zeros((blocks, len(ties)), dtype=int)
    kinds, kind = kinds_of(both[ties]) if ties.any() else (both[:0], np.zeros(0, int))
    shafts[:, ties] = kind
    own, which = kinds_of(both[~ties]) if not ties.all() else (both[:0], np.zeros(0, int))
    shafts[:, ~ties] = len(kinds) + len(own) * np.arange(blocks)[:, None] + which
    return shafts, len(kinds)


def _plan(
    pattern: np.ndarray, ground: np.ndarray, plan: np.ndarray, shafts: np.ndarray, tied: int
) -> np.ndarray:
    """Lift plan (picks, shafts) of the whole cloth."""
    rows = len(pattern)
    woven = np.zeros((len(plan) * rows, max(tied, int(shafts.max()) + 1)), dtype=bool)
    for block, row in enumerate(shafts):
        filled = np.repeat(plan[:, block], rows)[:, None]
        times = len(plan)
        woven[:, row] = np.where(filled, np.tile(pattern, (times, 1)), np.tile(ground, (times, 1)))
    return woven


def _colours(profile: Wif, structure: str, columns: int, rows: int) -> tuple[np.ndarray, np.ndarray]:
    warp, weft = np.repeat(profile.warp_colours, columns), np.repeat(profile.weft_colours, rows)
    if structure == "double":
        usual = np.bincount(profile.warp_colours).argmax(), np.bincount(profile.weft_colours).argmax()
        warp[1::2], weft[::2] = usual[1], usual[0]
    return warp, weft
