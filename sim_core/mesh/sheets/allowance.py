"""The line that runs beside an outline at the distance of a seam allowance."""

import numpy as np
import shapely

from sim_core.errors import OutlineError

__all__ = ["moved_outline"]

MITRE = 3.0  # a corner may lie so many times the allowance away from where it was
CRACK = 1e-10  # of an outline's area: what rounding leaves between two sides
FEW = 1000  # corners of an outline that shapely moves in a moment however they lie


def moved_outline(outline: np.ndarray, away: float) -> np.ndarray:
    """An outline (n, 2) [m] moved by `away` [m], outwards where that is positive, its corners mitred.

    Raises OutlineError where nothing is left or several parts. shapely crosses all moved sides with each other, which
    takes n² of them where teeth are closer than the allowance (a star of 10,000 points: 39 s and 4.6 GB); of many
    corners, the areas that single sides sweep over are put together instead, neighbours first (3 s, .2 GB).
    """
    shape = shapely.Polygon(outline)
    if len(outline) <= FEW or not shape.is_valid:
        moved = shapely.buffer(shape, away, join_style="mitre", mitre_limit=MITRE)
        parts = [part for part in shapely.get_parts(moved) if not part.is_empty]
    else:
        band = shapely.union_all(_swept(shape, away))
        rims = [
            shapely.Polygon(ring) for ring in shapely.get_rings(band)
        ]  # what no side swept over is all in or out
        inner = sorted((rim for rim in rims if rim.area > CRACK * shape.area), key=lambda rim: -rim.area)[1:]
        shapely.prepare(shape)
        parts = (
            [max(rims, key=lambda rim: rim.area)]
            if away > 0
            else [rim for rim in inner if shape.contains(rim.representative_point())]
        )
    if len(parts) != 1 or not isinstance(parts[0], shapely.Polygon):
        raise OutlineError(f"an allowance of {1000 * abs(away):g} mm leaves no piece – give less")
    return np.array(parts[0].exterior.coords)[:-1]


def _swept(shape: shapely.Polygon, away: float) -> np.ndarray:
    """The areas between the sides of an outline and where they move to, and the corners between those that part."""
    points = np.array(shapely.orient_polygons(shape, exterior_cw=False).exterior.coords)[:-1]
    points = points[(points != np.roll(points, 1, axis=0)).any(axis=1)]
    along = np.roll(points, -1, axis=0) - points
    along /= np.hypot(*along.T)[:, None]
    out = np.column_stack([along[:, 1], -along[:, 0]])
    sides = [points, np.roll(points, -1, axis=0)]
    found = [np.stack([*sides, sides[1] + away * out, sides[0] + away * out], axis=1)]
    before, ahead = np.roll(out, 1, axis=0), np.roll(along, 1, axis=0)
    parts = (ahead[:, 0] * along[:, 1] - ahead[:, 1] * along[:, 0]) * away > 0
    points, before, out, ahead, along = (a[parts] for a in (points, before, out, ahead, along))
    half = np.sqrt(np.maximum((1 + (before * out).sum(axis=1)) / 2, 0))  # the cosine of half the turn
    # how far both moved sides go on: until they meet, or until the corner is MITRE times away and is cut off
    sine = np.sqrt(1 - half**2)
    meets = half * MITRE > 1
    far = np.where(meets, sine / np.maximum(half, 1e-9), (MITRE - half) / np.maximum(sine, 1e-9)) * abs(away)
    ends = points + away * before, points + away * out
    tips = ends[0] + far[:, None] * ahead, ends[1] - far[:, None] * along
    tips = tips[0], np.where(meets[:, None], tips[0], tips[1])
    found.append(np.stack([points, ends[0], *tips, ends[1]], axis=1))
    return np.concatenate([np.asarray(shapely.polygons(rings), object) for rings in found])
