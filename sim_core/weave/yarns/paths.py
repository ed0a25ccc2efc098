"""Yarn paths of one repeat, whatever the weave: stage A or B, laid extra wefts, leno ends that change places."""

from __future__ import annotations

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.model import Weave
from sim_core.weave.yarn import Yarn
from sim_core.weave.yarns.geometry import Strands, YarnGeometry
from sim_core.weave.yarns.leno_brocade import brocade_heights, leno_paths
from sim_core.weave.yarns.particles.cell import ParticleCell
from sim_core.weave.yarns.splines import resampled

__all__ = ["main_picks", "strands"]

BENEATH = (
    0.9  # of a yarn's height: how much lower the hidden yarns of a compound unit lie than the one that shows
)


def strands(weave: Weave, geometry: YarnGeometry | ParticleCell, *, per: int = 8) -> tuple[Strands, ...]:
    """Warp, weft and, where there are any, extra wefts of a relaxed cloth.

    geometry: of `solve` for this weave. per: places a crossing where stage A gives heights at crossings only.
    Raises WeaveError for the geometry of another draft.
    """
    draft, channels = weave.draft, weave.draft.channels
    width, height = weave.size
    main = main_picks(weave)
    if geometry.force.shape != (len(main), draft.ends):
        raise WeaveError(f"weave {weave.name}: the yarn geometry belongs to another draft – solve this weave")
    palette_warp, palette_weft = (
        _palette(weave.warp_colours, weave.warp),
        _palette(weave.weft_colours, weave.weft),
    )
    if isinstance(geometry, ParticleCell):
        per, paths = (
            geometry.per,
            (geometry.warp_side, geometry.warp_height, geometry.weft_side, geometry.weft_height),
        )
    elif channels.order is not None and channels.layer is None:
        paths = leno_paths(weave, per)
    else:
        wz, fz = resampled(geometry.warp_height.T, per), resampled(geometry.weft_height, per)
        paths = np.zeros_like(wz), wz, np.zeros_like(fz), fz
    if channels.layer is not None:
        paths = _layered(weave, paths)
    ends_at = np.arange(draft.ends) * weave.end_spacing
    if channels.layer is not None and channels.order is not None:  # a unit's ends share one place
        unit = 1 + int(channels.end_series.max()) if channels.end_series is not None else 1
        own = channels.end_series if channels.end_series is not None else 0
        ends_at = (channels.order[0] + (unit - 1) / 2 + 0.2 * (own - (unit - 1) / 2)) * weave.end_spacing
    pick_step = height / len(main)
    picks_at = np.arange(len(main)) * pick_step
    if channels.layer is not None and channels.pick_series is not None:
        picks_at = _grouped(channels.pick_series[main]) * pick_step
    end_colour = channels.end_series if channels.end_series is not None else np.zeros(draft.ends, int)
    warp_colour = np.repeat((end_colour % len(palette_warp))[:, None], paths[0].shape[1], axis=1)
    weft_colour = _weft_colours(weave, main, len(palette_weft), paths[2].shape[1])
    made = [
        Strands("warp", ends_at, paths[0], paths[1], warp_colour, palette_warp, weave.warp, height, width),
        Strands("weft", picks_at, paths[2], paths[3], weft_colour, palette_weft, weave.weft, width, height),
    ]
    extra = np.setdiff1d(np.arange(draft.picks), main)
    if extra.size and weave.extra:
        after = np.searchsorted(main, extra) - 1
        z = brocade_heights(weave, made[0], extra, (after + 0.5) * pick_step, per)
        colour = _weft_colours(weave, extra, len(palette_weft), z.shape[1])
        place = (after + 0.5) * pick_step
        made.append(
            Strands("weft", place, np.zeros_like(z), z, colour, palette_weft, weave.extra, width, height)
        )
    return tuple(made)


def _layered(weave: Weave, paths: tuple[np.ndarray, ...]) -> tuple[np.ndarray, ...]:
    """Yarns of a compound unit that do not show lie lower by part of their height, beneath the one that shows."""
    layer, series = weave.draft.channels.layer, weave.draft.channels.end_series
    assert layer is not None
    wu, wz, fu, fz = paths
    if series is not None:
        return wu, wz - BENEATH * weave.warp.height * _eased(layer.T, wz.shape[1]), fu, fz
    return wu, wz, fu, fz - BENEATH * weave.weft.height * _eased(layer, fz.shape[1])


def _eased(values: np.ndarray, n: int) -> np.ndarray:
    """(lines, n) values at the crossings, eased from one to the next."""
    t = np.arange(n // values.shape[1]) / (n // values.shape[1])
    ease = t * t * (3 - 2 * t)
    return (values[..., None] * (1 - ease) + np.roll(values, -1, axis=1)[..., None] * ease).reshape(
        len(values), -1
    )


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
