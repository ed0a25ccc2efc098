"""Drafts as hand weavers use them, of traditional structures: threading, tie-up and treadling written out here.

`DRAFTS` holds name -> a function that makes its WIF. They are what `bench_drafts.py --rest` brings to rest beside the
drafts of a folder: repeats of 12 to 100 ends and picks, since a cloth's repeat is often a whole towel's border.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np

__all__ = ["DRAFTS", "woven"]


def woven(threading: Sequence[int], tieup: Sequence[Iterable[int]], treadling: Sequence[int]) -> str:
    """WIF of a treadled draft: shafts by end, shafts raised by treadle, treadles by pick, all from 1."""
    rows = {
        "WIF": ["Version=1.1"],
        "WEAVING": [f"Shafts={max(threading)}", f"Treadles={len(tieup)}", "Rising Shed=true"],
        "WARP": [f"Threads={len(threading)}"],
        "WEFT": [f"Threads={len(treadling)}"],
        "THREADING": [f"{k}={shaft}" for k, shaft in enumerate(threading, 1)],
        "TIEUP": [f"{k}={','.join(map(str, sorted(shafts)))}" for k, shafts in enumerate(tieup, 1)],
        "TREADLING": [f"{k}={treadle}" for k, treadle in enumerate(treadling, 1)],
    }
    return "".join(f"[{name}]\n" + "\n".join(lines) + "\n" for name, lines in rows.items())


def planned(lift: np.ndarray) -> str:
    """WIF of a lift matrix (picks, ends): an end a shaft."""
    picks, ends = lift.shape
    rows = "".join(
        f"{k}={','.join(str(n + 1) for n in np.flatnonzero(row))}\n" for k, row in enumerate(lift, 1)
    )
    own = "".join(f"{k}={k}\n" for k in range(1, ends + 1))
    return (
        f"[WIF]\nVersion=1.1\n[WEAVING]\nShafts={ends}\nRising Shed=true\n[WARP]\nThreads={ends}\n"
        f"[WEFT]\nThreads={picks}\n[THREADING]\n{own}[LIFTPLAN]\n{rows}"
    )


def point(shafts: int) -> list[int]:
    """A point: up and down again, the ends not doubled."""
    return [*range(1, shafts + 1), *range(shafts - 1, 1, -1)]


def twill(over: int, shafts: int) -> list[list[int]]:
    """The tie-up of a twill over so many of so many shafts, a treadle each."""
    return [[(k + n) % shafts + 1 for n in range(over)] for k in range(shafts)]


def ratio_twill(*ratio: int) -> list[list[int]]:
    """A tie-up of a twill over, under, over … so many ends, as 3/2/1/2."""
    shafts = sum(ratio)
    up = np.concatenate([np.full(count, k % 2 == 0) for k, count in enumerate(ratio)])
    return [[int(n) + 1 for n in np.flatnonzero(np.roll(up, k))] for k in range(shafts)]


def overshot() -> str:
    """A rose on opposites after old coverlet drafts: pattern picks over blocks of pairs, a tabby pick after each."""
    pairs = {"A": (1, 2), "B": (2, 3), "C": (3, 4), "D": (4, 1)}
    threading: list[int] = []
    blocks = [*("ABCD" * 2), *"ADADA", *("DCBA" * 2)]
    for block in blocks:
        odd, even = sorted(pairs[block], key=lambda shaft: shaft % 2 == len(threading) % 2)
        threading += [odd, even] * 2
    tieup = [[1, 2], [2, 3], [3, 4], [1, 4], [1, 3], [2, 4]]
    treadling: list[int] = []
    for block in blocks[:12]:
        for _ in range(2):
            treadling += ["ABCD".index(block) + 1, 5 + len(treadling) // 2 % 2]
    return woven(threading[:84], tieup, treadling)


def crackle() -> str:
    """Crackle: blocks of three-end points with incidentals between them, woven as drawn in with tabby."""
    blocks = [(1, 2, 3, 2), (2, 3, 4, 3), (3, 4, 1, 4), (4, 1, 2, 1)]
    threading = [shaft for block in (0, 1, 2, 3, 2, 1) for shaft in blocks[block] * 3]
    tieup = [[1, 2], [2, 3], [3, 4], [1, 4], [1, 3], [2, 4]]
    treadling = [t for block in (0, 1, 2, 3) for k in range(4) for t in (block + 1, 5 + k % 2)]
    return woven(threading, tieup, treadling)


def summer_and_winter() -> str:
    """Summer and winter of four pattern blocks: ends 1 and 2 tie down, a tabby pick after each pattern pick."""
    order = (3, 4, 5, 6, 5, 4)
    threading = [shaft for block in order for _ in range(2) for shaft in (1, block, 2, block)]
    pattern = [[tie, *(s for s in range(3, 7) if s != block)] for block in range(3, 7) for tie in (1, 2)]
    tieup = [*pattern, [1, 2], [3, 4, 5, 6]]
    treadling = [
        t for block in order for k in range(4) for t in (2 * (block - 3) + (k + 1) // 2 % 2 + 1, 9 + k % 2)
    ]
    return woven(threading, tieup, treadling)


def huck() -> str:
    """Huck lace of five-end units in a chequer with plain weave."""
    lace, plainly = [1, 3, 1, 3, 1, 4, 2, 4, 2, 4], [1, 2] * 5
    threading = (lace + plainly) * 2
    tieup = [[1, 2], [3, 4], [1, 4], [2, 3]]
    return woven(threading, tieup, [1, 3, 1, 3, 1, 2, 4, 2, 4, 2] + [1, 2] * 5)


def swedish_lace() -> str:
    """Atwater-Bronson lace: floats of five over a plain ground, two blocks."""
    block = {"A": [1, 3, 1, 3, 1, 2], "B": [1, 4, 1, 4, 1, 2]}
    threading = [s for name in "AABBAABB" for s in block[name]]
    tieup = [[1], [2, 3, 4], [2, 3], [2, 4]]
    treadling = [2, 1, 3, 1, 3, 1] * 2 + [2, 1, 4, 1, 4, 1] * 2
    return woven(threading, tieup, treadling)


def ms_and_os() -> str:
    """M's and O's: blocks that weave plain where the others are ribbed."""
    threading = [1, 2, 3, 4] * 4 + [1, 3, 2, 4] * 4 + [1, 2, 3, 4] * 2 + [1, 3, 2, 4] * 2
    return woven(threading, [[1, 2], [3, 4], [1, 3], [2, 4]], [1, 2] * 8 + [3, 4] * 8)


def monks_belt() -> str:
    """Monk's belt: weft floats on opposites over a plain ground."""
    threading = [1, 2] * 8 + [3, 4] * 2 + [1, 2] * 2 + [3, 4] * 8
    tieup = [[1, 2], [3, 4], [1, 3], [2, 4]]
    pattern = [1] * 6 + [2] * 3 + [1] * 3 + [2] * 6
    return woven(threading, tieup, [t for k, p in enumerate(pattern) for t in (p, 3 + k % 2)])


def waffle(shafts: int = 5) -> str:
    """Waffle weave: points of long floats around a sunken middle."""
    lift = np.zeros((2 * shafts - 2, 2 * shafts - 2), bool)
    for i in range(len(lift)):
        for j in range(len(lift)):
            away = abs(i - shafts + 1) + abs(j - shafts + 1)
            lift[i, j] = away < shafts - 1 if (i + j) % 2 else away == 0 or away > shafts
    return planned(lift)


def rosepath() -> str:
    """Rosepath: a point of four shafts, woven to and fro over three twill lifts in turn."""
    return woven(point(4) * 4, [[1, 2], [2, 3], [3, 4], [1, 4]], [*([1, 2, 3, 4] * 3), *([3, 2, 1, 4] * 3)])


def shadow() -> str:
    """Shadow weave of eight shafts: a dark and a light end on opposite shafts by turns, along a point."""
    up = [s for k in point(8) for s in (k, (k + 3) % 8 + 1)]
    tieup = twill(4, 8)
    return woven(up, tieup, [t for k in point(8) for t in (k, (k + 3) % 8 + 1)])


def undulating() -> str:
    """Undulating twill: a straight draw whose ends are doubled and trebled by turns."""
    often = [1, 1, 2, 2, 3, 3, 3, 2, 2, 1, 1, 1] * 2
    shafts = [s for k, count in enumerate(often) for s in [k % 8 + 1] * count]
    return woven(shafts, ratio_twill(3, 1, 1, 3), [*range(1, 9)] * 5)


def advancing() -> str:
    """Advancing twill: runs of five shafts, each beginning one higher."""
    threading = [(k + n) % 16 + 1 for k in range(16) for n in range(5)]
    return woven(threading, ratio_twill(4, 3, 2, 1, 1, 3, 1, 1), threading)


def networked() -> str:
    """A networked twill of 24 shafts over an initial of four: a smooth curve of 72 ends put on the net."""
    line = 10 + 9 * np.sin(2 * np.pi * np.arange(72) / 72)
    threading = [int(4 * round((h - k % 4) / 4) + k % 4) % 24 + 1 for k, h in enumerate(line)]
    return woven(threading, ratio_twill(5, 3, 2, 2, 3, 4, 2, 3), [k % 24 + 1 for k in range(72)])


def block_damask() -> str:
    """Damask of two blocks in 5-end satin, ten shafts: warp-faced where the other block is weft-faced."""
    threading = [k % 5 + 1 for k in range(20)] + [k % 5 + 6 for k in range(30)]
    points = [[2 * k % 5 + 1] for k in range(5)]
    faced = [[s for s in range(1, 6) if s != point[0]] for point in points]
    tieup = [[*a, *(s + 5 for s in b)] for a, b in zip(faced, points, strict=True)]
    tieup += [[*b, *(s + 5 for s in a)] for a, b in zip(faced, points, strict=True)]
    return woven(threading, tieup, [k % 5 + 1 for k in range(25)] + [k % 5 + 6 for k in range(25)])


def turned_twill() -> str:
    """Turned twill: 1/3 against 3/1 in two blocks of unequal width, diaper."""
    threading = [k % 4 + 1 for k in range(32)] + [k % 4 + 5 for k in range(16)]
    few, many = twill(1, 4), twill(3, 4)
    tieup = [[*a, *(s + 4 for s in b)] for a, b in zip(few, many, strict=True)]
    tieup += [[*b, *(s + 4 for s in a)] for a, b in zip(few, many, strict=True)]
    return woven(threading, tieup, [k % 4 + 1 for k in range(32)] + [k % 4 + 5 for k in range(16)])


def crepe() -> str:
    """Sand crêpe: a plain weave with points added and taken away without order, no float above three."""
    rng = np.random.default_rng(1)
    lift = (np.add.outer(np.arange(48), np.arange(48)) % 2).astype(bool)
    for i, j in rng.integers(0, 48, (400, 2)):
        lift[i, j] ^= True
        near = [lift[(i + np.arange(-3, 4)) % 48, j], lift[i, (j + np.arange(-3, 4)) % 48]]
        if any(np.any(np.convolve(row, np.ones(4), "valid") % 4 == 0) for row in near):
            lift[i, j] ^= True
    return planned(lift)


def bedford_cord() -> str:
    """Bedford cord: wefts float behind one rib while they weave the next; cutting ends between them."""
    lift = np.zeros((4, 24), bool)
    for j in range(24):
        place = j % 12
        if place in (0, 6):
            lift[:, j] = [True, False, True, False]
        else:
            own = place < 6
            weaves = np.array([k // 2 % 2 == (0 if own else 1) for k in range(4)])
            lift[:, j] = np.where(weaves, (np.arange(4) + j) % 2 == 0, True)
    return planned(lift)


def honeycomb() -> str:
    """Honeycomb of hand looms: cells of plain weave, outlined by thick tabby."""
    threading = [1, 2] * 6 + [3, 4] * 6
    tieup = [[1, 3, 4], [2, 3, 4], [1, 2, 3], [1, 2, 4], [1, 3], [2, 4]]
    return woven(threading, tieup, [5, 6, *([1, 2] * 4), 5, 6, *([3, 4] * 4)])


def herringbone() -> str:
    """Broken herringbone, 2/2, the points displaced so that none floats over three."""
    up = [k % 4 + 1 for k in range(24)] + [(-k + 1) % 4 + 1 for k in range(24)]
    return woven(up, twill(2, 4), [1, 2, 3, 4] * 6)


def goose_eye() -> str:
    """Goose eye on a gradual point of eight shafts, woven as drawn in."""
    line = [*range(1, 9), *range(5, 9), *range(7, 0, -1), *range(4, 0, -1)]
    return woven(line * 2, ratio_twill(3, 2, 1, 2), line * 2)


DRAFTS: dict[str, Callable[[], str]] = {
    "basket 2/2": lambda: woven([1, 1, 2, 2] * 3, [[1], [2]], [1, 1, 2, 2] * 3),
    "herringbone": herringbone,
    "rosepath": rosepath,
    "goose eye": goose_eye,
    "undulating twill": undulating,
    "advancing twill": advancing,
    "networked twill": networked,
    "turned twill": turned_twill,
    "shadow weave": shadow,
    "sand crepe": crepe,
    "waffle": waffle,
    "huck lace": huck,
    "Bronson lace": swedish_lace,
    "M's and O's": ms_and_os,
    "monk's belt": monks_belt,
    "overshot": overshot,
    "crackle": crackle,
    "summer and winter": summer_and_winter,
    "block damask": block_damask,
    "honeycomb": honeycomb,
    "bedford cord": bedford_cord,
}
