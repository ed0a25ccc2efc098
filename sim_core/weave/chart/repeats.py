"""A draft woven several times: what is drawn when a weaver wants to see how repeats meet."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.draft.algebra import Harness
from sim_core.weave.draft.factors import Factors
from sim_core.weave.files.sources import Source
from sim_core.weave.files.wif.model import Wif

__all__ = ["repeated"]

MOST_YARNS = 20_000  # ends or picks of what is drawn


def repeated(source: Source, across: int, along: int) -> Source:
    """The draft woven `across` times side by side and `along` times one after the other, with its colours.

    Raises WeaveError where that has more than 20,000 ends or picks.
    """
    factors, harness = source.factors, source.harness
    for what, count in (("ends", factors.ends * across), ("picks", factors.picks * along)):
        if count > MOST_YARNS:
            raise WeaveError(f"{count:,} {what} – draw it less often, at most {MOST_YARNS:,} {what} in all")
    woven = Harness(
        np.tile(harness.threading, (across, 1)), harness.tieup, np.tile(harness.treadling, (along, 1))
    )
    warp, weft = np.tile(source.warp_colours, across), np.tile(source.weft_colours, along)
    given = source.wif or Wif(source.name, harness, palette=source.palette.astype(int))
    return replace(
        source,
        factors=Factors(factors.core, np.tile(factors.pick, along), np.tile(factors.end, across)),
        warp_colours=warp,
        weft_colours=weft,
        wif=replace(given, harness=woven, warp_colours=warp + 1, weft_colours=weft + 1, private=None),
    )
