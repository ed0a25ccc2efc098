"""From an anatomical body to the smooth solid of a shop figure, by distance fields.

The trunk becomes a dress form: every horizontal section its convex hull (as a tape measure sees it), smoothed along
and around. Hands become closed mittens, feet plain shapes, both by convex hulls; the neck ends in a dome. The parts
meet by a smooth minimum, and the field they make is smoothed. The heights and widths below are those of the woman of
1.62 m; another body is scaled until its shoulders are as high, and told how much wider it is and reaches further.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import gaussian_filter, gaussian_filter1d
from scipy.spatial import ConvexHull

from sim_core.body.joints import JOINTS
from sim_core.body.making.source import Body
from sim_core.cloth.contact.distance_field import DistanceField, field_of, hull_mesh

SHOULDER, WRIST = np.array([0.1586, 1.2803]), 0.6162  # [m] of the woman of 1.62 m: x and y of the joint, x
LOW, HIGH = np.array([-0.85, -0.03, -0.22]), np.array([0.85, 1.50, 0.30])  # [m] of the working field
RAY = np.radians(np.arange(0.0, 360.0, 3.0))  # of a section


@dataclass(frozen=True)
class FormSettings:
    """Lengths in metres; pairs are from..to heights. wide: of the shoulders; reach: of the wrists beyond WRIST."""

    wide: float = 1.0
    reach: float = 0.0
    cell: float = 0.005
    slice: float = 0.005
    neck_top: float = 0.020  # above the neck's lower joint the section stays what it is there
    neck_long: float = 0.060  # and the dome begins
    dome: float = 0.55  # height in radii of the neck
    along: float = 0.030  # smoothing of the dress form along the trunk
    along_neck: float = 0.012
    neck_from: tuple[float, float] = (1.27, 1.33)
    around: float = 9.0  # [degrees]
    blend: tuple[float, float] = (0.012, 0.034)  # of the smooth minimum below and above the waist
    smooth_trunk: float = 0.016
    smooth_arm: float = 0.009
    smooth_hand: float = 0.010
    hand_thicker: float = 0.003
    hand_slimmer: float = 0.70  # width of the closed hand in that of the spread one
    web: float = (
        0.0  # reach of the smooth minimum between hand and thumb: where their tips touch, else a hole is left
    )

    def box(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner [m] of the working field, symmetric, in whole cells."""
        more = np.array([self.cell * np.ceil(max(self.reach, 0.0) / self.cell), 0.0, 0.0])
        return LOW - more, HIGH + more


def step(x: np.ndarray, low: np.ndarray | float, high: np.ndarray | float) -> np.ndarray:
    """0 below `low`, 1 above `high`, smooth between."""
    t = np.clip((x - low) / (np.asarray(high) - low), 0, 1)
    return t * t * (3 - 2 * t)


def smooth_minimum(a: np.ndarray, b: np.ndarray, reach: np.ndarray | float) -> np.ndarray:
    """min(a, b) with its crease filled over `reach` [m] (polynomial, a quarter of it where a = b)."""
    near = np.maximum(reach - np.abs(a - b), 0.0) / reach
    return np.minimum(a, b) - 0.25 * reach * near * near


def section(vertices: np.ndarray, faces: np.ndarray, y: float) -> np.ndarray:
    """Points (N, 2) x, z where the mesh meets the plane at height y."""
    height = vertices[:, 1] - y
    points = []
    for i, j in ((0, 1), (1, 2), (2, 0)):
        a, b = faces[:, i], faces[:, j]
        cut = (height[a] < 0) != (height[b] < 0)
        a, b = a[cut], b[cut]
        t = (height[a] / (height[a] - height[b]))[:, None]
        points.append(((1 - t) * vertices[a] + t * vertices[b])[:, [0, 2]])
    return np.concatenate(points)


def crotch_height(body: Body) -> float:
    """The lowest height [m] above the knees at which the body crosses its middle."""
    for y in np.arange(0.55, 1.0, 0.005):
        if (np.abs(section(body.vertices, body.faces, float(y))[:, 0]) < 0.004).any():
            return float(y)
    raise ValueError("the body has no crotch between 0.55 and 1.0 m – it is not a standing figure")


def figure_field(body: Body, settings: FormSettings) -> DistanceField:
    """The shop figure as a smoothed field, mirrored in x = 0; its zero surface is the figure."""
    s, fork = settings, crotch_height(body)
    body = replace(body, vertices=_slim_hands(body, s.hand_slimmer))
    spaces = {"cell": s.cell, "band": 0.04, "box": s.box()}
    form = field_of(*dress_form(body, fork, s), **spaces).values
    limbs = field_of(body.vertices, body.faces, **spaces).values
    x, y = _nodes(form.shape, s)
    limbs = np.maximum(limbs + 0.06 * _trunk(x / s.wide, y, fork), y - (body.neck[0] + 0.035))
    blend = np.where(y < 1.0, s.blend[0], s.blend[1])
    solid = smooth_minimum(form, limbs, blend)
    for side, wrist in enumerate((JOINTS.index("wrist_l"), JOINTS.index("wrist_r"))):
        hand, thumb = body.weights[:, wrist] > 0.5, body.thumbs[side]
        ball = hand & (np.linalg.norm(body.vertices - body.heads[wrist], axis=1) < 0.05)
        foot = body.feet[side] & (body.vertices[:, 1] < 0.07)
        for chosen, thicker in (
            (hand & ~thumb, s.hand_thicker),
            (thumb | ball, s.hand_thicker),
            (foot, 0.002),
        ):
            hull = field_of(*hull_mesh(body.vertices[chosen]), **spaces).values
            union = np.minimum(solid, hull - thicker)
            if s.web and chosen is not foot:
                union = smooth_minimum(solid, hull - thicker, s.web)
            solid = union
    solid = 0.5 * (solid + solid[::-1])
    return DistanceField(s.box()[0], s.cell, _smoothed(solid, x, y, s).astype(np.float32))


def _slim_hands(body: Body, width: float) -> np.ndarray:
    """Vertices (V, 3) with the spread fingers drawn together, in front and behind the wrist alike."""
    x, wrist = body.vertices, body.heads[JOINTS.index("wrist_l")]
    share = 1 - (1 - width) * step(np.abs(x[:, 0]), wrist[0] - 0.01, wrist[0] + 0.09)
    middle = wrist[2] - 0.004
    return np.column_stack([x[:, :2], middle + share * (x[:, 2] - middle)])


def _nodes(shape: tuple[int, ...], s: FormSettings) -> tuple[np.ndarray, np.ndarray]:
    """|x| (nx, 1, 1) and y (1, ny, 1) of a field's nodes [m]."""
    x, y = (s.box()[0][axis] + s.cell * np.arange(shape[axis]) for axis in (0, 1))
    return np.abs(x)[:, None, None], y[None, :, None]


def _trunk(x: np.ndarray, y: np.ndarray, fork: float) -> np.ndarray:
    """1 where only the dress form shows and the body is left out, 0 at arms and legs."""
    heights = [1.17, 1.21, 1.26, 1.40]
    near, far = (
        np.interp(y, heights, [0.16, 0.105, 0.085, 0.085]),
        np.interp(y, heights, [0.22, 0.155, 0.135, 0.135]),
    )
    middle = np.where(y < heights[0], 1.0, 1.0 - step(x, near, far))
    return np.maximum(step(y, fork - 0.02, fork + 0.06) * middle, step(y, 1.33, 1.36))


def _smoothed(solid: np.ndarray, x: np.ndarray, y: np.ndarray, s: FormSettings) -> np.ndarray:
    """Gaussian smoothing, little at hands and arms, much at the trunk and the legs."""
    hand, arm, trunk = (
        gaussian_filter(solid, w / s.cell) for w in (s.smooth_hand, s.smooth_arm, s.smooth_trunk)
    )
    at_hand = step(x - s.reach, 0.58, 0.63)
    at_arm = step(x / s.wide, 0.22, 0.34) * step(y, 1.15, 1.20)
    limb = at_hand * hand + (1 - at_hand) * arm
    return at_arm * limb + (1 - at_arm) * trunk


def dress_form(body: Body, fork: float, s: FormSettings) -> tuple[np.ndarray, np.ndarray]:
    """A closed mesh of hulled sections from below the fork to the neck, which ends in a dome."""
    heights = np.arange(fork - 0.10, body.neck[0] + s.neck_top, s.slice)
    widths = np.interp(heights, [1.17, 1.20, 1.26, 1.33], [0.30, 0.165, 0.145, 0.14]) * s.wide
    radius, middle = _profile(body, heights, widths, s)
    slimmer = 0.6 + 0.4 * np.sqrt(step(heights, fork - 0.115, fork - 0.02))  # closes between the thighs
    radius *= slimmer[:, None]
    ring = radius[-1] * 0.93
    tall = np.arange(heights[-1] + s.slice, body.neck[0] + s.neck_long, s.slice)
    dome = np.radians(np.arange(6.0, 90.0, 7.0))
    extra = np.r_[tall, tall[-1] + s.dome * ring.mean() * np.sin(dome)]
    scale = np.r_[np.ones(len(tall)), np.cos(dome)]
    radius = np.concatenate([radius, scale[:, None] * ring])
    heights, middle = np.r_[heights, extra], np.r_[middle, np.full(len(extra), middle[-1])]
    rings = np.stack(
        [
            radius * np.cos(RAY),
            np.broadcast_to(heights[:, None], radius.shape),
            middle[:, None] + radius * np.sin(RAY),
        ],
        axis=-1,
    )
    return _tube(rings)


def _profile(
    body: Body, heights: np.ndarray, widths: np.ndarray, s: FormSettings
) -> tuple[np.ndarray, np.ndarray]:
    """Smoothed radius (H, A) of the hulled sections, each cut at |x| <= its width first, and their middles z (H,)."""
    sections = []
    for y, wide in zip(heights, widths, strict=True):
        points = section(body.vertices, body.faces, float(y))
        points = np.concatenate([points, points * [-1, 1]])
        sections.append(points[np.abs(points[:, 0]) <= wide])
    centre = np.array([(p[:, 1].min() + p[:, 1].max()) / 2 for p in sections])
    middle = gaussian_filter1d(centre, s.along / s.slice, mode="nearest")
    ray = np.stack([np.cos(RAY), np.sin(RAY)], axis=1)
    radius = np.zeros((len(heights), len(RAY)))
    for row, (points, z) in enumerate(zip(sections, middle, strict=True)):
        plane = ConvexHull(points - [0.0, z]).equations
        along = ray @ plane[:, :2].T
        radius[row] = np.where(along > 1e-9, -plane[:, 2] / np.maximum(along, 1e-9), np.inf).min(1)
    radius = gaussian_filter1d(radius, s.around / 3.0, axis=1, mode="wrap")
    much, little = (
        gaussian_filter1d(radius, w / s.slice, axis=0, mode="nearest") for w in (s.along, s.along_neck)
    )
    up = step(heights, *s.neck_from)[:, None]
    return much * (1 - up) + little * up, middle


def _tube(rings: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A closed mesh over rings (H, A, 3), capped by fans."""
    h, a = rings.shape[:2]
    caps = np.stack([rings[0].mean(0), rings[-1].mean(0)])
    number = np.arange(h * a).reshape(h, a)
    i, j = number[:-1], number[1:]
    i2, j2 = np.roll(i, -1, axis=1), np.roll(j, -1, axis=1)
    bottom, top = number[0], number[-1]
    faces = [
        np.stack([i, j, i2], -1).reshape(-1, 3),
        np.stack([i2, j, j2], -1).reshape(-1, 3),
        np.stack([np.full(a, h * a), bottom, np.roll(bottom, -1)], 1),
        np.stack([np.full(a, h * a + 1), np.roll(top, -1), top], 1),
    ]
    return np.concatenate([rings.reshape(-1, 3), caps]), np.concatenate(faces).astype(np.int32)
