"""Figured weaves: a motif says which of a few weaves lies where, over thousands of ends.

`Figure` is the recipe, small enough to be stored with a garment. From it and a sett come the numbers of the motif at
every crossing, the draft of the whole repeat, and the `cells`: one small draft for each number. These are what is
relaxed and drawn, since a motif of ten thousand crossings is made of a few of them.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import lru_cache
from math import lcm
from typing import Any, Literal, get_args

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.draft.draft import Channels, Draft
from sim_core.weave.draft.generators import check_limit, limit_floats, woven
from sim_core.weave.draft.motifs import Motif, Part, Recipe, cut
from sim_core.weave.draft.notation import draft_of_words
from sim_core.weave.draft.structures import (
    brocade,
    four_end_gauze,
    gauze,
    tapestry,
    warp_compound,
    weft_compound,
)

__all__ = ["Figure", "FigureKind"]

FigureKind = Literal["damask", "leno", "warp-compound", "weft-compound", "tapestry", "brocade"]
INNER = 2  # binding and inner picks of a compound weave for a row of its motif


@dataclass(frozen=True)
class Figure:
    """What is woven where. program, parameters: of the motif [mm], see `motif_of_program`.

    words: the weaves of a damask by number (0 the ground; the last one for all numbers above), the ground of a brocade.
    longest: floats of a damask that get a binding point; 0 leaves them.  series: yarns of a compound unit.
    every: of how many ends one binds the extra wefts of a brocade.  parts: of a layout, see `Part`.  areas: of a
    drawing, see `Recipe`.
    Raises WeaveError where the motif cannot be drawn, has more numbers than a compound has series, or a weave of a
    damask floats over more crossings than `longest`.
    """

    kind: FigureKind
    program: str
    parameters: tuple[tuple[str, float], ...] = ()
    words: tuple[str, ...] = ()
    longest: int = 0
    series: int = 2
    every: int = 4
    parts: tuple[Part, ...] = ()
    areas: tuple[tuple[int, str], ...] = ()

    def __post_init__(self) -> None:
        if self.kind not in get_args(FigureKind):
            raise WeaveError(f"figure: kind {self.kind!r} – one of {', '.join(get_args(FigureKind))}")
        object.__setattr__(self, "parameters", tuple((str(k), float(v)) for k, v in self.parameters))
        object.__setattr__(self, "words", tuple(self.words))
        parts = (part if isinstance(part, Part) else Part(**part) for part in self.parts)
        object.__setattr__(self, "parts", tuple(parts))
        object.__setattr__(self, "areas", tuple((int(number), str(text)) for number, text in self.areas))
        if self.kind == "damask" and len(self.words) < 2:
            raise WeaveError("figure: a damask needs two weaves – name its ground and its figure")
        if self.kind == "damask":
            check_limit("longest", self.longest, [draft_of_words(words) for words in self.words])
        colours = self.motif.colours
        if self.kind.endswith("compound") and colours > self.series:
            raise WeaveError(
                f"figure: the motif has {colours} numbers and the weave {self.series} series – give it {colours}"
            )

    @classmethod
    def of(cls, kind: FigureKind, recipe: Recipe, **rest: Any) -> Figure:
        """A recipe woven as some kind; rest: the fields that are no recipe's."""
        return cls(kind, recipe.program, recipe.parameters, parts=recipe.parts, areas=recipe.areas, **rest)

    @property
    def motif(self) -> Motif:
        """The motif as it is drawn."""
        return Recipe(self.program, self.parameters, self.parts, self.areas).motif(self.program)

    def numbers(self, ends_per_m: float, picks_per_m: float) -> np.ndarray:
        """The number at each place (picks, ends) int8 of the whole draft, the first pick lowest.

        ends_per_m, picks_per_m: all yarns of the cloth, inner and extra ones among them. The repeat gives way by a part
        of a weave, so that all of them close over its borders.
        """
        return _numbers(self, ends_per_m, picks_per_m)

    def _units(self) -> tuple[tuple[int, int], tuple[int, int]]:
        """Picks and ends that one place of the motif takes, and of how many such places the repeat is a multiple."""
        if self.kind == "damask":
            drafts = [draft_of_words(words) for words in self.words]
            return (1, 1), (lcm(*(d.picks for d in drafts)), lcm(*(d.ends for d in drafts)))
        if self.kind == "leno":
            return (4, 4), (1, 1)
        if self.kind == "warp-compound":
            return (INNER, self.series), (2, 2)
        if self.kind == "weft-compound":
            return (self.series, INNER), (2, 2)
        if self.kind == "brocade":
            ground = self._ground()
            return (2, 1), (lcm(2, ground.picks), lcm(2 * self.every, ground.ends))
        return (1, 1), (2, 2)

    def _ground(self) -> Draft:
        return draft_of_words(self.words[0] if self.words else "plain")

    def draft(self, numbers: np.ndarray, name: str) -> Draft:
        """The whole repeat as the loom weaves it; numbers: of `numbers`. Raises WeaveError as its structure does."""
        if self.kind == "damask":
            drafts = [draft_of_words(words) for words in self.words]
            lift = woven(drafts[0].lift, numbers.shape)
            for number in range(1, int(numbers.max()) + 1):
                there = numbers == number
                lift[there] = woven(drafts[min(number, len(drafts) - 1)].lift, numbers.shape)[there]
            return Draft(name, limit_floats(lift, self.longest, name=name) if self.longest else lift)
        if self.kind == "leno":
            return _figured_leno(numbers, name)
        if self.kind == "brocade":
            colours = numbers.astype(int) - 1
            return brocade(colours, ground=self._ground(), every=self.every, always=True, name=name)
        if self.kind == "tapestry":
            return tapestry(numbers, name=name)
        shares, _ = self._units()
        units = numbers[:: shares[0], :: shares[1]]
        made = warp_compound if self.kind == "warp-compound" else weft_compound
        return made(units, self.series, name=name)

    def cells(self, count: int) -> tuple[Draft, ...]:
        """A small draft that closes by itself for each number from 0 to `count` - 1."""
        (picks, ends), (rows, columns) = self._units()
        repeat = (rows, columns) if self.kind == "brocade" else (rows * picks, columns * ends)
        return tuple(
            self.draft(np.full(repeat, number, np.int8), f"{self.kind} {number}").repeat()
            for number in range(count)
        )

    def to_dict(self) -> dict[str, Any]:
        """A plain dictionary that JSON can hold and `Figure(**it)` reads back."""
        values: dict[str, Any] = asdict(self) | {"words": list(self.words)}
        for told in (values, *values["parts"]):
            told["parameters"] = [list(pair) for pair in told["parameters"]]
            told["areas"] = [list(area) for area in told["areas"]]
            if not told["areas"]:
                del told["areas"]
        if not self.parts:
            del values["parts"]
        return values


@lru_cache(maxsize=8)
def _numbers(figure: Figure, ends_per_m: float, picks_per_m: float) -> np.ndarray:
    (picks, ends), multiple = figure._units()
    found = cut(figure.motif, ends_per_m / ends, picks_per_m / picks, multiple=multiple)
    if figure.kind != "brocade":  # of which a place is a pick of the ground, with the extra one after it
        found = np.repeat(np.repeat(found, picks, 0), ends, 1)
    found.setflags(write=False)
    return found


def _figured_leno(numbers: np.ndarray, name: str) -> Draft:
    """四经绞罗 where the motif is 0, simple gauze elsewhere: 杯文罗 has its figure in pairs on a net of four."""
    there, ends = numbers > 0, np.arange(numbers.shape[1])

    def spread(draft: Draft) -> tuple[np.ndarray, np.ndarray]:
        assert draft.channels.order is not None
        moved = draft.channels.order - np.arange(draft.ends)
        return woven(draft.lift, numbers.shape), woven(moved, numbers.shape)

    (lift, moved), (own_lift, own_moved) = spread(four_end_gauze()), spread(gauze(2))
    order = np.where(there, own_moved, moved) + ends
    return Draft(name, np.where(there, own_lift, lift), Channels(end_series=ends % 2, order=order))
