"""A petticoat (衬裙) as a mount: a stiff bell from the hips down that a skirt hangs over, its pleats fanned out."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import ConvexHull

from sim_core.body.joints import JOINTS
from sim_core.body.mannequin import Colour, Mannequin, Piece
from sim_core.errors import SimCoreError
from sim_core.mesh.geometry import line_girth, tangent_line

__all__ = ["Petticoat", "in_petticoat"]

ABOVE, BELOW = 0.012, 0.05  # [m] above and below the hips between which its own girth is taken
SUNK = 0.004  # [m] that it begins within them
FOLDED = 0.75  # of the hips' girth, that of a folded one: no skirt is as narrow
ROUND = 96  # points round it, a multiple of 4
RING = 0.02  # [m] between rings
RIM = 0.02  # [m] by which its hem is rounded: no sharp edge, which cloth would be caught on
TURNS = (0.0, 0.25, 0.5, 0.75, 1.0)  # of a quarter turn, the rings of the rim
ROUNDED = 8  # of its points, to both sides, over which corners of the hips are rounded


@dataclass(frozen=True)
class Petticoat:
    """Its colour (sRGB, 0 to 1), how far round its hem is [m], and how high above the floor that ends [m]."""

    dye: Colour
    girth: float = 1.5
    hem: float = 0.16


def in_petticoat(figure: Mannequin, petticoat: Petticoat) -> Mannequin:
    """The figure with one more closed surface, which goes with the pelvis; folded it is a tube narrower than the hips;
    heights are those of the T-pose.

    Raises SimCoreError where its hem is not below the hips, or not as wide as they are.
    """
    top = float(figure.marks["hip"][1])
    x = figure.vertices[figure.trunk()]
    hips = x[(x[:, 1] < top + ABOVE) & (x[:, 1] > top - BELOW)][:, [0, 2]]
    hips = np.concatenate([hips, hips * [-1.0, 1.0]])
    corners = hips[ConvexHull(hips).vertices]
    narrow = line_girth(corners)
    if petticoat.girth < narrow:
        raise SimCoreError(f"girth: {petticoat.girth:g} m – the hips are {narrow:.2f} m round; give more")
    if petticoat.hem > top - 0.1:
        raise SimCoreError(
            f"hem: {petticoat.hem:g} m – the hips are {top:.2f} m high; end it 0.1 m lower, or more"
        )
    heights = np.linspace(top, petticoat.hem, int(np.ceil((top - petticoat.hem) / RING)) + 1)
    turn = 0.5 * np.pi * np.array(TURNS)
    heights = np.r_[heights[heights > petticoat.hem + 1.5 * RIM], petticoat.hem + RIM * (1.0 - np.sin(turn))]
    wider = np.interp(heights, [petticoat.hem, top], [(petticoat.girth - narrow) / (2 * np.pi), -SUNK])
    wider[-len(turn) :] -= RIM * (1.0 - np.cos(turn))
    slimmer = np.full(len(heights), (FOLDED - 1.0) * narrow / (2 * np.pi))
    (vertices, faces), (folded, _) = (_bell(corners, heights, each) for each in (wider, slimmer))
    count = len(figure.vertices)
    weights = np.zeros((len(vertices), len(JOINTS)))
    weights[:, JOINTS.index("pelvis")] = 1.0
    own = np.arange(count + len(vertices)) >= count
    others = tuple(
        replace(piece, vertices=np.r_[piece.vertices, np.zeros(len(vertices), bool)])
        for piece in figure.pieces
    )
    return replace(
        figure,
        name=f"{figure.name}, in a petticoat",
        vertices=np.concatenate([figure.vertices, vertices]),
        folded=np.concatenate([figure.vertices, folded]),
        faces=np.concatenate([figure.faces, faces + count]).astype(np.int32),
        weights=np.concatenate([figure.weights, weights]),
        pieces=(*others, Piece("petticoat", petticoat.dye, own)),
    )


def _bell(corners: np.ndarray, heights: np.ndarray, wider: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) [m] and faces (F, 3), counter-clockwise from outside, of a closed surface: lines about a convex
    one (m, 2), `wider` (L,) [m] than that all round, at descending heights (L,), and a lid to both ends.

    It is its own mirror image.
    """
    angle = 2 * np.pi * np.arange(ROUND) / ROUND
    outward = np.stack([np.sin(angle), np.cos(angle)], 1)
    centre = np.array([0.0, corners[:, 1].mean()])
    reach = (outward @ (corners - centre).T).max(1)
    window = np.hanning(2 * ROUNDED + 3)[1:-1]
    spread = np.convolve(np.tile(reach, 3), window / window.sum(), "same")[ROUND : 2 * ROUND]
    reach = 0.5 * (spread + np.roll(spread[::-1], 1))
    line = tangent_line(reach, outward, centre)
    rings = []
    for y, off in zip(heights, wider, strict=True):
        x, z = (line + off * outward).T
        rings.append(np.column_stack([x, np.full(ROUND, y), z]))
    last = ROUND * (len(heights) - 1)
    here = np.arange(ROUND)
    after = (here + 1) % ROUND
    sides = [
        _between(above + here, above + after, above + ROUND + here, above + ROUND + after)
        for above in range(0, last, ROUND)
    ]
    high, low = (np.full(ROUND, last + ROUND + k) for k in (0, 1))
    lids = (np.column_stack([here, after, high]), np.column_stack([last + after, last + here, low]))
    middles = [[0.0, y, centre[1]] for y in (heights[0], heights[-1])]
    return np.concatenate([*rings, middles]), np.concatenate([*sides, *lids])


def _between(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Two faces for each four-sided one of a, b above and c, d below, (2 n, 3); in its mirror image, the other half of
    the ring, it is divided the other way."""
    half = len(a) // 2
    first = [np.column_stack(way)[:half] for way in ((a, c, d), (a, d, b))]
    return np.concatenate([*first, *(np.column_stack(way)[half:] for way in ((a, c, b), (b, c, d)))])
