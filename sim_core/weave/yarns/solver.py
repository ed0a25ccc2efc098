"""One call for any weave: the right way to relax it, and what the relaxed cloth weighs and measures."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.draft.draft import Draft
from sim_core.weave.model import Weave
from sim_core.weave.yarns.beams import relax
from sim_core.weave.yarns.compound import relax_compound
from sim_core.weave.yarns.geometry import FiguredGeometry, YarnGeometry
from sim_core.weave.yarns.particles.cell import MOST_STEPS, ParticleCell, relax_particles
from sim_core.weave.yarns.paths import main_picks

__all__ = ["ground_of", "solve"]

MOST_RELAXED = 1_048_576  # crossings of a repeat


def ground_of(weave: Weave) -> Weave:
    """The cloth that is relaxed: a brocade without its extra wefts; any other weave as it is."""
    main = main_picks(weave)
    if len(main) == weave.draft.picks:
        return weave
    draft = Draft(f"{weave.draft.name} ground", weave.draft.lift[main]).repeat()
    return replace(weave, draft=draft, picks_per_m=weave.picks_per_m * len(main) / weave.draft.picks, extra=None,
                   weft_colours=())  # fmt: skip


def solve(
    weave: Weave,
    *,
    particles: bool = False,
    per: int = 8,
    friction: float = 0.3,
    tolerance: float = 1e-3,
    watch: np.ndarray | None = None,
    most: int | None = None,
) -> Any:
    """Relax a weave: stage A, and stage B on it with `particles`. Returns YarnGeometry or ParticleCell over the draft,
    of a figured weave FiguredGeometry: each of its cells by itself.

    The ground of a brocade is relaxed alone. Leno and compound weaves stay at stage A (their ends cross or lie over
    one another, which the particles' grid of crossings does not hold).  watch, most: as of relax_particles.
    Raises WeaveError for more than a million crossings, a jammed sett, or yarns that do not come to rest.
    """
    if weave.numbers is not None:
        numbers = weave.numbers
        cells = tuple(
            solve(
                cell,
                particles=particles,
                per=per,
                friction=friction,
                tolerance=tolerance,
                watch=watch,
                most=most,
            )
            for cell in weave.cells
        )
        return FiguredGeometry(cells, tuple(float((numbers == k).mean()) for k in range(len(cells))))
    if weave.draft.lift.size > MOST_RELAXED:
        raise WeaveError(
            f"{weave.name}: a repeat of {weave.draft.lift.size:,} crossings – at most {MOST_RELAXED:,} are relaxed"
        )
    ground = ground_of(weave)
    channels = weave.draft.channels
    if channels.layer is not None:
        return relax_compound(weave)
    if channels.order is not None:
        return _woven_leno(weave)
    if particles:
        cell = relax_particles(ground, per=per, friction=friction, tolerance=tolerance, watch=watch,
                               most=most or MOST_STEPS)  # fmt: skip
        return _tiled_cell(cell, weave) if ground is not weave else cell
    geometry = relax(ground)
    return _tiled(geometry, weave) if ground is not weave else geometry


def _copies(shape: tuple[int, int], weave: Weave) -> tuple[int, int]:
    return len(main_picks(weave)) // shape[0], weave.draft.ends // shape[1]


def _tiled(g: YarnGeometry, weave: Weave) -> YarnGeometry:
    up, across = _copies(g.warp_height.shape, weave)
    arrays = {
        name: np.tile(getattr(g, name), (up, across)) for name in ("warp_height", "weft_height", "force")
    }
    return replace(
        g, **arrays, warp_crimp=np.tile(g.warp_crimp, across), weft_crimp=np.tile(g.weft_crimp, up)
    )


def _tiled_cell(c: ParticleCell, weave: Weave) -> ParticleCell:
    up, across = _copies(c.force.shape, weave)
    warp = {name: np.tile(getattr(c, name), (across, up)) for name in ("warp_side", "warp_height")}
    weft = {name: np.tile(getattr(c, name), (up, across)) for name in ("weft_side", "weft_height")}
    return replace(c, **warp, **weft, force=np.tile(c.force, (up, across)), warp_crimp=np.tile(c.warp_crimp, across),
                   weft_crimp=np.tile(c.weft_crimp, up))  # fmt: skip


def _woven_leno(weave: Weave) -> YarnGeometry:
    """A leno's heights at the picks, and its crimps from the whole paths."""
    from sim_core.weave.yarns.leno_brocade import leno_paths, leno_rest

    per = 16
    side, height, _, weft = leno_paths(weave, per)
    _, _, force, residual = leno_rest(weave)
    lengths = []
    for u, z, step in (
        (side, height, weave.pick_spacing / per),
        (np.zeros_like(weft), weft, weave.end_spacing / per),
    ):
        pieces = np.sqrt(step**2 + (np.roll(u, -1, 1) - u) ** 2 + (np.roll(z, -1, 1) - z) ** 2)
        lengths.append(pieces.mean(axis=1) / step - 1)
    at, ft = height[:, ::per].T, weft[:, ::per]
    gap = np.where(weave.draft.lift, 1, -1) * (at - ft) - (weave.warp.height + weave.weft.height) / 2
    complementarity = float(np.abs(force * gap).max() / max(force.max(), 1e-300))
    deepest = float(max(0.0, -gap.min()))
    return YarnGeometry(at, ft, force, lengths[0], lengths[1], residual, deepest, complementarity, 1)
