"""A body that moves while cloth lies on it: sampled distance fields, one per key pose, blended in time."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np

from sim_core.cloth.contact.packed import FASTEST, GRID, MOVING, Packed
from sim_core.cloth.contact.solids import GridSdf, Solid, Union, nodes
from sim_core.errors import SimCoreError
from sim_core.validation import (
    FURTHEST,
    excerpt,
    finite,
    instance_of,
    integer,
    numeric_array,
    optional_callable,
    triangles,
    vector3,
)

_WIDTH = 20
Made = TypeVar("Made")
Worn = tuple[np.ndarray, np.ndarray]  # nearest faces (nx, ny, nz) int32, and the corners (F, 3, 3) of all


@dataclass(frozen=True)
class MovingGrid:
    """Distance fields on one grid: key(k) gives the values (nx, ny, nz) [m] of pose k, 0 <= k < count.

    origin (3,), cell [m]; name identifies all poses (a hash of what they are made from) for checkpoints. Between two
    keys the distance is blended linearly, so a limb should move less than half its thickness from key to key.
    surface(k): the face nearest to each node (nx, ny, nz), -1 for none, and the corners of the faces (F, 3, 3) [m] in
    pose k, of which `name` tells as well. With it friction acts against the moving surface; without it a body pushes
    cloth by what it does across itself, and holds it back as if it stood still along itself.
    beside: solids that stand still beside the body, such as a floor (HalfSpace()), with their exact distance; no grid.
    Raises SimCoreError, naming the value, for what is no grid.
    """

    origin: tuple[float, float, float]
    cell: float
    count: int
    key: Callable[[int], np.ndarray] = field(repr=False)
    name: str = ""
    surface: Callable[[int], Worn] | None = field(default=None, repr=False, compare=False)
    beside: Solid | None = None
    _kept: dict[int, np.ndarray] = field(default_factory=dict, repr=False, compare=False)
    _worn: dict[int, Worn] = field(default_factory=dict, repr=False, compare=False)
    _most: dict[tuple[int, int], float] = field(default_factory=dict, repr=False, compare=False)

    def __post_init__(self) -> None:
        vector3("body.origin", self.origin, "in metres")
        finite("body.cell [m]", self.cell, above=0, most=FURTHEST)
        integer("body.count", self.count, 1, "key poses, 1 or more")
        if self.key is None:
            raise SimCoreError("body.key: None – give a function of a key's number")
        optional_callable("body.key", self.key)
        if self.surface is not None:
            optional_callable("body.surface", self.surface)
        instance_of("body.name", self.name, str, "a text is meant")
        if self.beside is not None:
            instance_of("body.beside", self.beside, Solid, "a solid is meant, e.g. HalfSpace()")
            if GRID in self.beside.packed().kind:
                raise SimCoreError(
                    "body.beside: a grid – only solids with exact distance stand beside a body"
                )

    def packed(self, early: float, late: float) -> tuple[Packed, tuple[float, float]]:
        """The arrays for a frame in which the body goes from `early` to `late` (in keys), and both within its keys.

        Raises SimCoreError when a frame would pass a key, or leave them.
        """
        first, second = self.between(early, late)
        if first == second:
            return self._pack(GRID, first, first), (0.0, 0.0)
        return self._pack(MOVING, first, second), (early - first, late - first)

    def between(self, early: float, late: float) -> tuple[int, int]:
        """The keys that a frame from `early` to `late` lies between, one and the same where it rests on one."""
        low, high = min(early, late), max(early, late)
        if low < -1e-9 or high > self.count - 1 + 1e-9:
            raise SimCoreError(f"body: keys {early:.2f} to {late:.2f} – there are 0 to {self.count - 1}")
        if high - low < 1e-9 and abs(low - round(low)) < 1e-9:
            return round(low), round(low)
        k = min(int(low + 1e-9), self.count - 2)
        if high > k + 1 + 1e-9:
            raise SimCoreError(
                f"body: a frame goes from key {early:.2f} to {late:.2f} – at most to the next key"
            )
        return k, k + 1

    def closed(self, radius: float) -> MovingGrid:
        """The same with its gaps filled key by key, as `distance_field.closed` fills them; radius [m]."""
        if radius <= 0.0:
            return self
        from sim_core.cloth.contact.distance_field import DistanceField, closed

        origin = np.array(self.origin)

        def key(k: int) -> np.ndarray:
            return closed(DistanceField(origin, self.cell, self.key(k)), radius).values

        return replace(
            self, key=key, name=f"{self.name}, gaps of {radius} filled", _kept={}, _worn={}, _most={}
        )

    def solid(self, k: int) -> Solid:
        """The body in pose k and what stands beside it, as a solid that stands still."""
        own = GridSdf(self.origin, self.cell, self._kept[k] if k in self._kept else self.key(k))
        return own if self.beside is None else Union((own, self.beside))

    def _pack(self, kind: int, first: int, second: int) -> Packed:
        _renew(self._kept, (first, second), lambda k: nodes(f"body: key {k}", self.key(k)))
        if self._kept[first].shape != self._kept[second].shape:
            raise SimCoreError(f"body: keys {first} and {second} have other nodes – all lie on one grid")
        data = np.zeros((1, _WIDTH))
        data[0, :3], data[0, 3], data[0, 19] = self.origin, self.cell, -1.0
        if kind == MOVING:
            data[0, FASTEST] = self._motion(first, second)
        kinds = np.array([kind])
        if self.beside is not None:  # the grid comes first
            still = self.beside.packed()
            kinds, data = np.concatenate([kinds, still.kind]), np.concatenate([data, still.data])
        packed = Packed(kinds, data, self._kept[first], self._kept[second], np.zeros(2))
        if kind != MOVING:
            return packed
        surface, shape = self.surface, self._kept[first].shape
        if surface is None:
            return packed
        _renew(self._worn, (first, second), lambda k: _worn(f"body: surface {k}", surface(k), shape))
        (nearest, corners), (_, later) = self._worn[first], self._worn[second]
        if corners.shape != later.shape:
            raise SimCoreError(f"body: surfaces {first} and {second} have other faces – all are of one mesh")
        return packed._replace(nearest=nearest, corners=corners, ways=later - corners)

    def _motion(self, first: int, second: int) -> float:
        """The most that the distance changes anywhere between two kept keys [m]."""
        if (first, second) not in self._most:
            change = self._kept[second] - self._kept[first]
            self._most[first, second] = float(max(change.max(), -change.min()))
        return self._most[first, second]


def _renew(kept: dict[int, Made], keys: tuple[int, int], made: Callable[[int], Made]) -> None:
    """Leaves these keys alone in what is kept, and makes those that are missing."""
    for k in [k for k in kept if k not in keys]:
        del kept[k]
    for k in keys:
        if k not in kept:
            kept[k] = made(k)


def _worn(name: str, value: object, shape: tuple[int, ...]) -> Worn:
    """What surface(k) gave, of a grid of this shape; raises SimCoreError for what is none."""
    remedy = f"give the nearest face of each of {shape} nodes, or -1, and the corners (F, 3, 3) of all faces"
    if not isinstance(value, tuple | list) or len(value) != 2:
        raise SimCoreError(f"{name}: {excerpt(value)} – {remedy}")
    nearest, corners = (
        numeric_array(f"{name}: {what}", v, remedy)
        for what, v in zip(("faces", "corners"), value, strict=True)
    )
    if corners.ndim != 3 or corners.shape[1:] != (3, 3) or not (np.abs(corners) <= FURTHEST).all():
        raise SimCoreError(f"{name}: corners {corners.shape}, or not finite – {remedy}")
    whole_numbers = nearest.shape == shape and nearest.dtype.kind in "iu"
    if not whole_numbers or nearest.min() < -1 or nearest.max() >= len(corners):
        raise SimCoreError(f"{name}: faces {nearest.shape}, or numbers of none – {remedy}")
    return np.ascontiguousarray(nearest, np.int32), np.ascontiguousarray(corners, float)


def _nodes_around(
    points: np.ndarray, low: np.ndarray, cell: float, band: float, shape: tuple[int, ...]
) -> tuple[np.ndarray, np.ndarray] | None:
    """Lowest and highest index (3,) of the nodes within `band` [m] of points (…, 3); None where there are none."""
    flat = points.reshape(-1, 3)
    first = np.maximum(np.floor((flat.min(0) - band - low) / cell), 0).astype(int)
    last = np.minimum(np.ceil((flat.max(0) + band - low) / cell), np.array(shape) - 1).astype(int)
    return (first, last) if (last > first).all() else None


def moving_mesh(
    positions: np.ndarray,
    faces: np.ndarray,
    *,
    cell: float = 0.008,
    band: float = 0.04,
    hulls: Sequence[np.ndarray] = (),
    box: tuple[Sequence[float], Sequence[float]] | None = None,
    beside: Solid | None = None,
    thicker: Sequence[float] = (),
) -> MovingGrid:
    """A body given by its vertices frame by frame, as what cloth lies on: one key for each frame.

    positions (T, V, 3) [m]; faces (F, 3) counter-clockwise from outside, closed; cell, band [m] of the distance
    fields, which are made as the frames come; the band grows with the longest way of a frame. A phase with
    body = (0, T - 1) that lasts (T - 1) / 25 s plays it; what is thinner than twice the way of one frame may be missed
    in between. hulls: faces (H, 3) of further closed meshes on the same vertices that are united with the body; box:
    lowest and highest corner [m] of the fields, else all frames and the band around; beside: what stands still beside
    it (a floor: HalfSpace()); thicker [m]: by how much each of the hulls reaches beyond its mesh, as a garment worn
    beneath another does (none given: not at all). Raises SimCoreError at once where the mesh is open, ill-wound or not
    finite, or is turned inside out in any frame, and says where.
    """
    from sim_core.cloth.contact.distance_field import checked_cell, checked_mesh, field_and_faces, inside_out

    frames = np.array(
        numeric_array("moving mesh: positions", positions, "expected (T, V, 3)"), float, order="C"
    )
    if frames.ndim != 3 or frames.shape[2] != 3 or not len(frames):
        raise SimCoreError(f"moving mesh: positions {frames.shape} – expected (T, V, 3), T at least 1")
    wrong = np.flatnonzero(~(np.abs(frames) <= FURTHEST).all((1, 2)))
    if len(wrong):
        raise SimCoreError(f"moving mesh: frame {wrong[0]} has vertices that are not finite – mend it")
    checked_cell("moving mesh", cell, band)
    faces = np.array(triangles("moving mesh: faces", faces, frames.shape[1]), np.int32, order="C")
    checked_mesh(frames[0], faces, cell, band)
    # Where both distances are cut off at the band the body does not move; half its thickness is what it may go.
    way = float(np.sqrt((np.diff(frames, axis=0) ** 2).sum(2)).max(initial=0.0))
    band = max(band, min(way, 0.5 * float(np.ptp(frames, axis=1).min())) + 2 * cell)
    if box is None:
        low, high = frames.min((0, 1)) - band, frames.max((0, 1)) + band
    else:
        low, high = (np.array(vector3("moving mesh: box", corner, "in metres")) for corner in box)
    parts = [faces]
    for hull in hulls:
        parts.append(np.array(triangles("moving mesh: hulls", hull, frames.shape[1]), np.int32, order="C"))
    whole_faces = np.concatenate(parts)
    beyond = [finite("moving mesh: thicker [m]", reach, least=0, most=FURTHEST) for reach in thicker]
    beyond = beyond or [0.0] * len(hulls)
    if len(beyond) != len(hulls):
        raise SimCoreError(
            f"moving mesh: thicker has {len(beyond)} lengths – give one for each of {len(hulls)} hulls"
        )
    told = frames.tobytes() + whole_faces.tobytes() + repr(([len(part) for part in parts], beyond)).encode()
    digest = hashlib.sha256(told).hexdigest()[:16]

    near: dict[int, np.ndarray] = {}  # the nearest faces of the keys made last

    def key(k: int) -> np.ndarray:
        values, nearest = field_and_faces(frames[k], faces, cell=cell, band=band, box=(low, high))
        before = len(faces)
        for hull, reach in zip(parts[1:], beyond, strict=True):
            wide = band + reach
            around = _nodes_around(frames[k][hull], low, cell, wide, values.shape)
            if around is not None:
                first, last = around
                there = tuple(slice(a, b + 1) for a, b in zip(first, last, strict=True))
                inner = low + cell * first, low + cell * last
                other, face = field_and_faces(frames[k], hull, cell=cell, band=wide, box=inner)
                other, face = other - reach, np.where(face < 0, -1, face + before)
                nearer = other < values[there]
                values[there] = np.where(nearer, other, values[there])
                nearest[there] = np.where(nearer, face, nearest[there])
            before += len(hull)
        for old in [j for j in near if abs(j - k) > 1]:
            del near[old]
        near[k] = nearest
        return values

    def surface(k: int) -> Worn:
        if k not in near:
            key(k)
        return near[k], frames[k][whole_faces]

    first, origin = key(0), (float(low[0]), float(low[1]), float(low[2]))
    for number, vertices in enumerate(frames[1:], 1):  # the first is looked at with its field
        if inside_out(vertices, faces):
            raise SimCoreError(f"moving mesh: frame {number} is turned inside out – mend it")
    name = f"mesh {digest} cell {cell} band {band}, carries"
    return MovingGrid(origin, cell, len(frames), key, name, surface, beside, {0: first})
