"""The `Wif` value: what a WIF 1.0/1.1 file says, and how it turns into a draft and back.

What WIF cannot say (series, layers, order of leno ends, regions, yarns in SI) is kept as JSON in a private section.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.draft.algebra import Harness, harness
from sim_core.weave.draft.draft import Draft, check_size
from sim_core.weave.draft.factors import Factors
from sim_core.weave.model import Weave, draft_from_dict, draft_to_dict

__all__ = ["PRIVATE", "Wif", "centimetres", "plain_title", "thread_colours", "tidy", "wif_of"]

PRIVATE = "PRIVATE HALL WEAVE"
MOST_TREADLES = 64  # beyond, the file has a lift plan instead of tie-up and treadling


@dataclass(frozen=True, eq=False)
class Wif:
    """One WIF file.

    harness: threading, tie-up, treadling; the lift follows.  plan: written as LIFTPLAN instead of tie-up + treadling.
    palette: (n, 3) int of 0 to top, colours 1 to n.  warp_colours: (ends,), weft_colours: (picks,) int >= 1.
    spacing, thickness: (warp, weft) [m] or None.  text: (key, value) of [TEXT].  notes: lines of [NOTES].
    other: (section, ((key, value), ...)) of private and unknown sections, kept as they are.
    private: the JSON of our own section, None where there is none.  remarks: what the reader had to settle.
    """

    title: str
    harness: Harness
    plan: bool = False
    palette: np.ndarray = field(default_factory=lambda: np.array([[255, 255, 255], [0, 0, 0]]))
    top: int = 255
    warp_colours: np.ndarray = field(default_factory=lambda: np.zeros(0, int))
    weft_colours: np.ndarray = field(default_factory=lambda: np.zeros(0, int))
    spacing: tuple[float | None, float | None] = (None, None)
    thickness: tuple[float | None, float | None] = (None, None)
    text: tuple[tuple[str, str], ...] = ()
    notes: tuple[str, ...] = ()
    other: tuple[tuple[str, tuple[tuple[str, str], ...]], ...] = ()
    private: dict | None = None
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        picks, ends = self.harness.treadling.shape[0], self.harness.threading.shape[0]
        for name, count in (("warp_colours", ends), ("weft_colours", picks)):
            values = np.array(getattr(self, name), int)
            object.__setattr__(self, name, values if values.size else np.full(count, 1 + (name[1] == "e")))
            if getattr(self, name).shape != (count,):
                raise WeaveError(f"wif: {name} has {values.size} entries – {count} are wanted")
            if getattr(self, name).min() < 1 or getattr(self, name).max() > len(self.palette):
                raise WeaveError(f"wif: {name} names a colour outside the palette of {len(self.palette)}")

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Wif):
            return False
        arrays = lambda w: (w.harness.threading, w.harness.tieup, w.harness.treadling, w.palette, w.warp_colours,  # noqa: E731
                            w.weft_colours)  # fmt: skip
        rest = lambda w: (w.title, w.plan, w.top, w.spacing, w.thickness, w.text, w.notes, w.other, w.private)  # noqa: E731
        return rest(self) == rest(other) and all(
            np.array_equal(a, b) for a, b in zip(arrays(self), arrays(other), strict=True)
        )

    @cached_property
    def factors(self) -> Factors:
        """The lift by its kinds of ends and picks, whatever the size; raises WeaveError as Factors.of_harness."""
        return Factors.of_harness(self.harness)

    @property
    def draft(self) -> Draft:
        """The draft; with all channels where our private section fits the lift that the harness weaves."""
        return self._value()[0]

    @property
    def weave(self) -> Weave | None:
        """The whole cloth, where our private section holds it and fits the harness; else None."""
        return self._value()[1]

    def _value(self) -> tuple[Draft, Weave | None]:
        factors = self.factors
        check_size(self.title or "draft", factors.picks, factors.ends)
        lift = factors.lift()
        if self.private:
            weave = Weave.from_dict(self.private["weave"]) if "weave" in self.private else None
            draft = weave.draft if weave else draft_from_dict(self.private.get("draft", {}))
            # else another program has changed the draft: its word counts
            if np.array_equal(draft.lift, lift):
                return draft, weave
        return Draft(self.title or "draft", lift), None


def wif_of(cloth: Weave | Draft) -> Wif:
    """A weave or draft as WIF, with everything WIF cannot say in the private section.

    Raises WeaveError where the repeat is larger than a draft may be.
    """
    weave, draft = (cloth, cloth.draft) if isinstance(cloth, Weave) else (None, cloth)
    made = harness(draft.lift)
    plan = made.tieup.shape[1] > MOST_TREADLES
    private = {"weave": weave.to_dict()} if weave else {"draft": draft_to_dict(draft)}
    value = Wif(
        plain_title(draft.name),
        _with_plan(made) if plan else made,
        plan,
        private=json.loads(json.dumps(private)),
    )
    if weave is None:
        return value
    palette, warp, weft = thread_colours(weave)
    return replace(
        value,
        palette=palette,
        warp_colours=warp,
        weft_colours=weft,
        spacing=(tidy(weave.end_spacing), tidy(weave.pick_spacing)),
        thickness=(tidy(weave.warp.width), tidy(weave.weft.width)),
    )


def thread_colours(weave: Weave) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Palette of 0 to 255, colour of every end and of every pick; of a pick in several colours, the most frequent."""
    channels, draft = weave.draft.channels, weave.draft
    sides = weave.warp_colours or (weave.warp.colour,), weave.weft_colours or (weave.weft.colour,)
    palette = np.rint(np.array([*sides[0], *sides[1]]) * 255).astype(int)
    ends = channels.end_series if channels.end_series is not None else np.zeros(draft.ends, int)
    picks = channels.pick_series if channels.pick_series is not None else np.zeros(draft.picks, int)
    if channels.region is not None:
        picks = np.array(
            [np.bincount(row[row >= 0] if (row >= 0).any() else [0]).argmax() for row in channels.region]
        )
    return palette, 1 + ends % len(sides[0]), 1 + len(sides[0]) + picks % len(sides[1])


def _with_plan(made: Harness) -> Harness:
    """The harness of a lift plan: one treadle a shaft."""
    from sim_core.weave.draft.algebra import lift_plan

    return Harness(made.threading, np.eye(len(made.tieup), dtype=bool), lift_plan(made.tieup, made.treadling))


def plain_title(text: str) -> str:
    """A title as one line of printable ASCII; the private section keeps the name itself."""
    return " ".join("".join(c if " " <= c <= "~" else "?" for c in text).split())


def tidy(metres: float) -> float:
    """What fourteen digits of centimetres can hold, so that writing and reading it is the identity."""
    return float(centimetres(metres)) / 100


def centimetres(metres: float) -> str:
    """A length in centimetres, fourteen digits without an exponent."""
    return np.format_float_positional(float(f"{metres * 100:.14g}"), trim="-")
