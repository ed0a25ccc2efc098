"""The hall and the studio as GLBs, raised from the plan."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..content.models import Opening, PlanFile
from .furniture import PALETTE, opening, solid, wall
from .room import Part, cap, disc, drum, floor_tiles, linear, merged, prism
from .unlit import unlit_glb

__all__ = ["hall_glb", "studio_glb"]

TILE = 0.8  # [m]
BEAM_EVERY = 2.0  # [m]


def hall_glb(plan: PlanFile) -> bytes:
    """Floor, ceiling, walls and furniture of `plan` in one GLB of a few meshes."""
    outline = np.asarray(plan.outline, float)
    thickest = max((w.thickness for w in plan.wall), default=0.2)
    return unlit_glb(
        {
            "floor": floor_tiles(outline, TILE, PALETTE["floor"]),
            "ceiling": _ceiling(outline, plan.height),
            "walls": merged([wall(value) for value in plan.wall]),
            "openings": merged([opening(value, _thickness(plan, value, thickest)) for value in plan.opening]),
            "furniture": merged([solid(value) for value in plan.solid]),
        }
    )


def _thickness(plan: PlanFile, value: Opening, otherwise: float) -> float:
    """Thickness of the wall whose middle line an opening lies on."""
    import shapely

    middle = shapely.Point(np.mean([value.start, value.end], axis=0))
    best = min(plan.wall, key=lambda w: shapely.LineString([w.start, w.end]).distance(middle), default=None)
    return otherwise if best is None else best.thickness


def _ceiling(outline: NDArray[np.float64], height: float) -> Part:
    """Boards seen from below, with beams across."""
    import shapely

    shape = shapely.Polygon(outline)
    low_x, low_z, high_x, high_z = shape.bounds
    parts = [cap(outline, height, linear(PALETTE["boards"]) * 1.15, up=False)]
    beams = [shapely.box(low_x, z - 0.1, high_x, z + 0.1) for z in np.arange(low_z + 1, high_z, BEAM_EVERY)]
    beams += [shapely.box(x - 0.14, low_z, x + 0.14, high_z) for x in np.linspace(low_x, high_x, 7)[1:-1]]
    for beam in beams:
        for piece in shapely.get_parts(beam.intersection(shape)):
            ring = np.asarray(piece.exterior.coords)[:-1]
            parts.append(prism(ring, height - 0.24, height - 0.01, PALETTE["lacquer"], lid=False))
            parts.append(cap(ring, height - 0.24, linear(PALETTE["lacquer"]) * 1.2, up=False))
    return merged(parts)


def studio_glb(radius: float = 9.0) -> bytes:
    """The close-up's surroundings: a plate on pale ground before a wall that catches the light."""
    rings, sides = 10, 36
    angle = 2 * np.pi * np.arange(sides) / sides
    rise = np.linspace(-0.35, 1.0, rings)
    vertices, colours = [], []
    low, high = linear("#8E8474"), linear("#DCD3C3")
    for share in rise:
        around = radius * np.cos(share * np.pi / 2) if share > 0 else radius
        vertices.append(
            np.column_stack([around * np.cos(angle), np.full(sides, share * radius), around * np.sin(angle)])
        )
        glow = np.exp(-(((share - 0.12) / 0.3) ** 2))
        colours.append(np.broadcast_to(low + (high - low) * glow, (sides, 3)))
    faces = []
    for ring in range(rings - 1):
        for side in range(sides):
            a, b = ring * sides + side, ring * sides + (side + 1) % sides
            faces += [[a, a + sides, b], [b, a + sides, b + sides]]
    dome = Part(np.concatenate(vertices), np.asarray(faces, np.int32), np.concatenate(colours))
    plate = drum((0.0, 0.0), 1.5, -0.06, 0.0, "#A89C8A", sides=64)
    ground = disc((0.0, 0.0), radius, -0.06, "#948977", sides=64)
    return unlit_glb({"dome": dome, "plate": plate, "ground": ground}, double_sided=True)
