"""Yarn paths of one repeat, whatever the weave: stage A or B, laid extra wefts, leno ends that change places."""

from __future__ import annotations

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.model import Weave
from sim_core.weave.yarn import Yarn
from sim_core.weave.yarns.geometry import Strands, YarnGeometry
from sim_core.weave.yarns.leno_brocade import brocade_heights, leno_paths
from sim_core.weave.yarns.particles.cell import ParticleCell
from sim_core.weave.yarns.sections import relaxed_sections
from sim_core.weave.yarns.splines import resampled

__all__ = ["main_picks", "strands"]


def strands(weave: Weave, geometry: YarnGeometry | ParticleCell, *, per: int = 8) -> tuple[Strands, ...]:
    """Warp, weft and, where there are any, extra wefts of a relaxed cloth, their sections at rest.

    geometry: of `solve` for this weave. per: places a crossing where stage A gives heights at crossings only.
    Raises WeaveError for the geometry of another draft.
    """
    draft, main = weave.draft, main_picks(weave)
    if geometry.force.shape != (len(main), draft.ends):
        raise WeaveError(f"weave {weave.name}: the yarn geometry belongs to another draft – solve this weave")
    made = _axes(weave, geometry, main, geometry.per if isinstance(geometry, ParticleCell) else per)
    if draft.channels.order is not None and draft.channels.layer is None:
        return tuple(made)  # the ends of a leno hold each other and have no floats
    lift = draft.lift[main]
    above = [lift.T, ~lift, ~np.delete(draft.lift, main, axis=0)]
    crowded = 2 * _series(weave)
    return tuple(relaxed_sections(one, up, crowded) for one, up in zip(made, above, strict=False))


def _axes(weave: Weave, geometry: YarnGeometry | ParticleCell, main: np.ndarray, per: int) -> list[Strands]:
    """The axes of all yarns, each as wide and high everywhere as its file says."""
    draft, channels = weave.draft, weave.draft.channels
    width, height = weave.size
    if isinstance(geometry, ParticleCell):
        paths = geometry.warp_side, geometry.warp_height, geometry.weft_side, geometry.weft_height
    elif channels.order is not None and channels.layer is None:
        paths = leno_paths(weave, per)
    else:
        wz, fz = resampled(geometry.warp_height.T, per), resampled(geometry.weft_height, per)
        paths = np.zeros_like(wz), wz, np.zeros_like(fz), fz
    palettes = _palette(weave.warp_colours, weave.warp), _palette(weave.weft_colours, weave.weft)
    pick_step = height / len(main)
    picks_at = np.arange(len(main)) * pick_step
    if channels.layer is not None and channels.pick_series is not None:
        picks_at = _grouped(channels.pick_series[main]) * pick_step
    end_colour = channels.end_series if channels.end_series is not None else np.zeros(draft.ends, int)
    warp_colour = np.repeat((end_colour % len(palettes[0]))[:, None], paths[0].shape[1], axis=1)
    weft_colour = _weft_colours(weave, main, len(palettes[1]), paths[2].shape[1])

    def system(along, place, side, z, colour, palette, yarn) -> Strands:
        length, across = (height, width) if along == "warp" else (width, height)
        wide, tall = np.full(z.shape, yarn.width / 2), np.full(z.shape, yarn.height / 2)
        return Strands(along, place, side, z, colour, palette, yarn, length, across, wide, tall)

    warp_side, warp_height, weft_side, weft_height = paths
    made = [
        system("warp", _ends_at(weave), warp_side, warp_height, warp_colour, palettes[0], weave.warp),
        system("weft", picks_at, weft_side, weft_height, weft_colour, palettes[1], weave.weft),
    ]
    extra = np.setdiff1d(np.arange(draft.picks), main)
    if extra.size and weave.extra:
        place = (np.searchsorted(main, extra) - 0.5) * pick_step
        z = brocade_heights(weave, made[0], extra, place, per)
        colour = _weft_colours(weave, extra, len(palettes[1]), z.shape[1])
        made.append(system("weft", place, np.zeros_like(z), z, colour, palettes[1], weave.extra))
    return made


def _ends_at(weave: Weave) -> np.ndarray:
    """(ends,) [m] where each end lies; those of a compound unit share one place."""
    channels = weave.draft.channels
    if channels.layer is None or channels.order is None:
        return np.arange(weave.draft.ends) * weave.end_spacing
    unit = 1 + int(channels.end_series.max()) if channels.end_series is not None else 1
    own = channels.end_series if channels.end_series is not None else 0
    return (channels.order[0] + (unit - 1) / 2 + 0.2 * (own - (unit - 1) / 2)) * weave.end_spacing


def _series(weave: Weave) -> int:
    """How many yarns of a compound weave share one place; 1 of any other."""
    channels = weave.draft.channels
    if channels.layer is None:
        return 1
    return max(1 + int(s.max()) for s in (channels.end_series, channels.pick_series) if s is not None)


def main_picks(weave: Weave) -> np.ndarray:
    """Numbers of the picks that belong to the ground."""
    kind = weave.draft.channels.pick_kind
    return np.arange(weave.draft.picks) if kind is None else np.flatnonzero(kind != 2)


def _palette(colours, yarn: Yarn) -> np.ndarray:
    return np.array(colours or (yarn.colour,), float).reshape(-1, 3)


def _grouped(series: np.ndarray) -> np.ndarray:
    """Places of picks whose series lie over one another: each group of one pick a series shares a place."""
    count = int(series.max()) + 1
    group = np.arange(series.size) // count
    return (group + 0.5) * count - 0.5 + 0.2 * (series - (count - 1) / 2)


def _weft_colours(weave: Weave, rows: np.ndarray, colours: int, n: int) -> np.ndarray:
    """(rows, n) palette index of each place along the picks; a slit or an end of a region leaves one place free."""
    channels = weave.draft.channels
    if channels.region is None:
        series = (
            channels.pick_series if channels.pick_series is not None else np.zeros(weave.draft.picks, int)
        )
        return np.repeat((series[rows] % colours)[:, None], n, axis=1)
    per = n // weave.draft.ends
    crossing = ((np.arange(n) + per // 2) // per) % weave.draft.ends  # the nearest crossing
    colour = channels.region[rows][:, crossing]
    turn = colour != np.roll(colour, 1, axis=1)
    return np.where(turn, -1, np.where(colour < 0, -1, colour % colours))
