"""The cloth of another program's WIF: its colours, sett and yarn sizes, on assumed silk where it says nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.draft.algebra import Harness, smallest_period
from sim_core.weave.draft.draft import Channels, Draft
from sim_core.weave.files.wif.model import Wif
from sim_core.weave.model import Weave
from sim_core.weave.yarn import Yarn
from sim_core.weave.yarns.jam import check_jam

__all__ = ["cloth_of", "cut_to_repeat"]

MOST_WHOLE = 1024  # ends or picks of a file; beyond, only its smallest repeat is relaxed


def cloth_of(wif: Wif, assumed: Weave, name: str, origin: str) -> tuple[Weave, str]:
    """The weave of a WIF without our private section, and where its yarns and sett come from.

    assumed: the same draft in yarns and sett of which `origin` tells.  Spacing is the distance of threads, thickness
    the diameter of the yarn before flattening. Where only one is given the other follows in the proportion of the
    assumed cloth; sizes that jam, as programs write them for the screen, keep the spacing and lose the thickness.
    """
    weave = _coloured(wif, assumed)
    told = [text for text, given in (("sett", wif.spacing), ("thickness", wif.thickness)) if any(given)]
    if not told:
        return weave, f"{origin}; colours of {name}"
    for thickness, note in ((wif.thickness, ""), ((None, None), "; its thickness does not fit its sett")):
        try:
            sized = _sized(weave, wif.spacing, thickness)
            check_jam(sized)
        except WeaveError:
            continue
        kept = " and ".join(t for t in told if t != "thickness" or any(thickness))
        if kept:
            return sized, f"{kept} and colours of {name}{note}; else {origin}"
    return weave, f"{origin}; colours of {name}; its sett and thickness are of no cloth"


def cut_to_repeat(wif: Wif) -> tuple[Wif, str]:
    """A warp or weft of more than 1,024 yarns cut to its smallest repeat, with its colours if they repeat as well.

    Returns the file, and what was done for whoever asks where the cloth comes from.
    """
    factors, notes, kept, colours = wif.factors, [], [], []
    for side, kind, given in (
        ("ends", factors.end, wif.warp_colours),
        ("picks", factors.pick, wif.weft_colours),
    ):
        count = period = len(kind)
        if count > MOST_WHOLE:
            period = smallest_period(list(zip(kind.tolist(), given.tolist(), strict=True)))
            if period > MOST_WHOLE:
                period = smallest_period(kind.tolist())
                if period < count:
                    given = np.full(count, np.bincount(given).argmax())
                    notes.append(f"the colours of its {side} do not repeat and were left out")
            if period < count:
                notes.append(f"cut to its repeat of {period} of {count} {side}")
        kept.append(period)
        colours.append(given[:period])
    threaded, treadled = wif.harness.threading[: kept[0]], wif.harness.treadling[: kept[1]]
    cut = replace(
        wif,
        harness=Harness(threaded, wif.harness.tieup, treadled),
        warp_colours=colours[0],
        weft_colours=colours[1],
        private=None,
    )
    return cut, "".join(f"; {note}" for note in notes)


def _sized(weave: Weave, spacing, thickness) -> Weave:
    room = weave.end_spacing / weave.warp.diameter  # of the assumed cloth, alike in warp and weft
    yarns, setts = [], []
    for yarn, apart, thick in zip((weave.warp, weave.weft), spacing, thickness, strict=True):
        diameter = thick or (apart / room if apart else yarn.diameter)
        grown = diameter / yarn.diameter
        # stiffness 0: derived again from the fibre
        yarns.append(replace(yarn, diameter=diameter, tex=yarn.tex * grown * grown, stiffness=0.0))
        setts.append(1 / (apart or room * diameter))
    return replace(weave, warp=yarns[0], weft=yarns[1], ends_per_m=setts[0], picks_per_m=setts[1])


def _coloured(wif: Wif, weave: Weave) -> Weave:
    """The weave in the file's colours: one on the yarn, several as series of ends or picks."""
    channels, sides = {}, {}
    for side, channel, colours in (
        ("warp", "end_series", wif.warp_colours),
        ("weft", "pick_series", wif.weft_colours),
    ):
        used, series = np.unique(colours, return_inverse=True)
        rgb = tuple(tuple(float(c) / wif.top for c in wif.palette[k - 1]) for k in used)
        yarn: Yarn = getattr(weave, side)
        sides[side] = replace(yarn, colour=rgb[int(np.bincount(series.ravel()).argmax())])
        if len(used) > 1:
            channels[channel], sides[f"{side}_colours"] = series.ravel(), rgb
    draft = Draft(weave.draft.name, weave.draft.lift, Channels(**channels))
    return replace(weave, draft=draft, **sides)
