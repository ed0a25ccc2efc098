"""Ceilings: boards on joists, laylights of paper between bars, and the floor below them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from hall_app.room.patch import Frame, Patch, box, panel, quad
from hall_app.room.structure.frame import JOIST, beams_of
from hall_app.room.structure.regions import Region, Regions

if TYPE_CHECKING:
    from hall_app.content.schema import Laylight, PlanFile

__all__ = ["ceilings_of", "floor_of"]

_TILES = 2.4  # [m] one texture of the floor: four tiles of 0.6 m
_EVERY = 0.95  # [m] between joists
_WELL = 0.16  # [m] the paper lies this far above the boards


def floor_of(plan: PlanFile, regions: Regions) -> list[Patch]:
    """Tiles on the whole floor: one chart, cut into fields whose pictures are shifted by whole tiles and turned."""
    import shapely

    rng = np.random.default_rng(7)
    low_x, low_z, high_x, high_z = regions.floor.bounds
    patches = []
    for x in np.arange(low_x, high_x - 1e-6, _TILES):
        for z in np.arange(low_z, high_z - 1e-6, _TILES):
            piece = shapely.box(x, -z - _TILES, x + _TILES, -z).intersection(_seen_from_above(regions.floor))
            turn, shift = int(rng.integers(4)), rng.integers(4, size=2) / 4
            for patch in panel((0, 0, 0), (1, 0, 0), (0, 0, -1), piece, "floor", chart="floor"):
                uv = (patch.flat - [x, -z]) / _TILES
                uv = uv @ np.array([[0, 1], [-1, 0]]) if turn % 2 else uv
                uv = uv * (1 if turn < 2 else -1) + shift
                patches.append(Patch("floor", patch.vertices, patch.faces, patch.flat, chart="floor", uv=uv))
    return patches


def _seen_from_above(shape: Any) -> Any:
    """A floor shape [x, z] in coordinates [x, −z], which face the viewer from above."""
    import shapely

    return shapely.transform(shape, lambda points: points * [1, -1])


def ceilings_of(plan: PlanFile, regions: Regions) -> list[Patch]:
    """Boards, joists and laylights over every region."""
    import shapely

    patches: list[Patch] = []
    lights = [(light, _rectangle(light)) for light in plan.laylight]
    beams = [shapely.LineString([b.start, b.end]) for b in beams_of(plan, regions)]
    for region in regions.all:
        here = [(light, shape) for light, shape in lights if region.shape.covers(shape)]
        holes = shapely.union_all([shape for _, shape in here])
        boards = region.shape.difference(holes)
        for k, part in enumerate(shapely.get_parts(region.shape)):
            x0, z0, x1, z1 = part.bounds
            patches += panel(
                (0, region.height, 0),
                (1, 0, 0),
                (0, 0, 1),
                boards.intersection(part),
                "ceiling",
                grain=int(z1 - z0 >= x1 - x0),
                chart=("ceiling", region.height, k),
            )
            patches += _joists(part, holes, beams, region.height)
        for light, shape in here:
            patches += _laylight(light, shape, region)
    return patches


def _rectangle(light: Laylight) -> Any:
    import shapely

    (x, z), (wide, deep) = light.at, light.size
    return shapely.box(x - wide / 2, z - deep / 2, x + wide / 2, z + deep / 2)


def _joists(part: Any, holes: Any, beams: list, height: float) -> list[Patch]:
    """Joists across the shorter side, left out where a beam or a laylight is."""
    import shapely

    x0, z0, x1, z1 = part.bounds
    across_x = x1 - x0 <= z1 - z0
    low, high = (z0, z1) if across_x else (x0, x1)
    count = max(1, round((high - low) / _EVERY))
    free = part.difference(holes.buffer(0.1, join_style="mitre"))
    patches = []
    for k in range(count + 1):
        at = low + (high - low) * k / count
        ends = [(x0, at), (x1, at)] if across_x else [(at, z0), (at, z1)]
        for piece in shapely.get_parts(shapely.LineString(ends).intersection(free)):
            if piece.length < 0.3 or any(_covers(beam, piece) for beam in beams):
                continue
            a, b = np.asarray(piece.coords)[[0, -1]]
            facing = 0.0 if across_x else -90.0
            frame = Frame.on_floor(a, facing, height)
            patches += box(frame, (0, -JOIST, -0.05), (piece.length, 0, 0.05), "joist", skip="top left right")
    return patches


def _covers(beam, piece) -> bool:
    """Whether a beam runs along the joist, or under most of it."""
    return beam.buffer(0.3).intersection(piece).length > 0.7 * piece.length


def _laylight(light: Laylight, shape: Any, region: Region) -> list[Patch]:
    """A well in the boards, paper above it, and a grid of bars across."""
    (x, z), (wide, deep) = light.at, light.size
    frame = Frame.on_floor((x, z), 0.0, region.height)
    hx, hz = wide / 2, deep / 2
    patches = panel(
        (0, region.height + _WELL, 0), (1, 0, 0), (0, 0, 1), shape, "laylight", chart=("laylight", x, z)
    )
    for turn, along, out in ((0, hx, hz), (90, hz, hx), (180, hx, hz), (270, hz, hx)):
        side, rim = frame.moved(turn=turn), 0.11 if turn % 180 == 0 else 0.0
        inner = [(along, 0, out), (-along, 0, out), (-along, _WELL, out), (along, _WELL, out)]
        patches.append(quad(side(inner), "joist", density=5.0))
        patches += box(
            side, (-along - rim, -0.10, out), (along + rim, 0.0, out + 0.11), "lacquer", skip="top left right"
        )
    nx, nz = max(2, round(wide / 0.8)), max(2, round(deep / 1.0))
    for k in range(1, nx):
        at = -hx + wide * k / nx
        bar = box(frame, (at - 0.025, -0.04, -hz), (at + 0.025, 0.03, hz), "joist", skip="top front back")
        patches += [replace(side, density=5.0) for side in bar]
    for k in range(1, nz):
        at = -hz + deep * k / nz
        bar = box(frame, (-hx, -0.075, at - 0.035), (hx, 0.03, at + 0.035), "joist", skip="top left right")
        patches += [replace(side, density=5.0) for side in bar]
    return patches
