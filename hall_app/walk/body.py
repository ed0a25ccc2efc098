"""The visitor's body among the solids: clearance and contact, asked of FCL.

FCL's frame is (x, z, height). Everything that stands on the floor blocks the whole body, so solids are
extruded to one height and the body is asked at half of it: a planar question, which FCL answers best with
spheres.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import fcl  # pyright: ignore[reportMissingImports] (compiled, without stubs)
import numpy as np

from hall_app.walk.solids import Floor, Prism, Solid

HEIGHT = 2.0  # [m] of every solid in the collision world; the probe sits at half of it
_EDGE = 1e-6  # [m] thickness of the slabs that stand for polygon edges
_BOUNDARY = 0.05  # [m] thickness of the invisible walls along the outline
Contact = tuple[float, float, float]  # clearance [m], nx, nz: the unit normal away from the nearest solid
_MIDDLE = np.array([0.0, 0.0, HEIGHT / 2])


@dataclass(frozen=True)
class Body:
    """The visitor seen from above: a circle. radius, skin (rest distance from solids), core [m]."""

    radius: float = 0.30
    skin: float = 0.010
    core: float = 0.010

    def __post_init__(self) -> None:
        if not 0 < self.core < self.radius or not 0 < self.skin < self.radius:
            raise ValueError(
                f"body: radius {self.radius}, skin {self.skin}, core {self.core}"
                " – core and skin must be above 0 and below the radius"
            )

    @property
    def leap(self) -> float:
        """Longest straight step [m] that is safe when both its ends are clear by the skin.

        A solid's point at least radius + skin from both ends is at least
        sqrt((radius + skin)² - (leap / 2)²) = radius from everything between them.
        """
        return 2 * math.sqrt((self.radius + self.skin) ** 2 - self.radius**2)


BODY = Body()


class World:
    """The solids of one floor in FCL, for one thread. Use `world_of(floor)`.

    The core is a small sphere and rectangles are boxes: sphere–box and sphere–cylinder are closed forms in
    FCL, exact to 1e-14 m, where its GJK (capsules, convex parts) overestimates a few in 10⁴ by up to
    centimetres. Other polygons are edge slabs, for the exact distance, plus convex parts, so that their
    inside is solid too.
    """

    def __init__(self, floor: Floor, body: Body) -> None:
        self.body = body
        self._objects = [
            fcl.CollisionObject(*part) for part in _parts(floor)
        ]  # the manager keeps no reference
        self._manager = fcl.DynamicAABBTreeCollisionManager()
        self._manager.registerObjects(self._objects)
        self._manager.setup()
        self._core = fcl.CollisionObject(fcl.Sphere(body.core))
        # The veto leaves most of the skin as reserve, so that a rest at the skin is never vetoed.
        self._full = fcl.CollisionObject(fcl.Sphere(body.radius + 0.3 * body.skin))
        self._ask_far = fcl.DistanceRequest(enable_nearest_points=False)
        self._ask_near = fcl.DistanceRequest(enable_nearest_points=True)
        self._place = _MIDDLE.copy()

    def clearance(self, x: float, z: float) -> float:
        """Distance [m] from the body's circle at (x, z) to the nearest solid; -radius if the core is inside."""
        return self._distance(x, z, self._ask_far)[0]

    def contact(self, x: float, z: float) -> Contact:
        """Clearance and normal at (x, z); -radius and (0, 0) if the core is inside."""
        clearance, result = self._distance(x, z, self._ask_near)
        if clearance <= self.body.core - self.body.radius:
            return -self.body.radius, 0.0, 0.0
        best, nx, nz = 0.0, 0.0, 0.0
        # The order of the two points is not reliable through the manager: the solid's is the farther one.
        for point in result.nearest_points:
            dx, dz = x - float(point[0]), z - float(point[1])
            if (far := dx * dx + dz * dz) > best:
                best, nx, nz = far, dx, dz
        length = math.sqrt(best)
        return clearance, nx / length, nz / length

    def collides(self, x: float, z: float) -> bool:
        """True if the body (with 0.3 of its skin) touches anything: FCL's boolean test, the veto."""
        self._place[0], self._place[1] = x, z
        self._full.setTranslation(self._place)
        data = fcl.CollisionData()  # fresh per query (fcl#117)
        self._manager.collide(self._full, data, fcl.defaultCollisionCallback)
        return data.result.is_collision

    def _distance(self, x: float, z: float, request: Any) -> tuple[float, Any]:
        self._place[0], self._place[1] = x, z
        self._core.setTranslation(self._place)
        data = fcl.DistanceData(request=request)
        self._manager.distance(self._core, data, fcl.defaultDistanceCallback)
        distance = data.result.min_distance
        if distance <= 0:  # never ask FCL how deep: its signed distance can abort the process
            return -self.body.radius, data.result
        return distance + self.body.core - self.body.radius, data.result


def world_of(floor: Floor, body: Body = BODY) -> World:
    """The floor's collision world for the calling thread, built on first use."""
    worlds: dict[Any, World] = floor._worlds.__dict__
    world = worlds.get(body)
    if world is None:
        world = worlds[body] = World(floor, body)
    return world


def _parts(floor: Floor) -> list[tuple[Any, Any]]:
    corners = np.array(floor.outline)
    # The outline runs counter-clockwise, so its outside is to the right; the walls stand wholly outside.
    parts = [_slab(a, b, _BOUNDARY, -_BOUNDARY / 2) for a, b in _edges(corners)]
    for solid in floor.solids:
        parts.extend(_solid_parts(solid))
    return parts


def _solid_parts(solid: Solid) -> list[tuple[Any, Any]]:
    if not isinstance(solid, Prism):
        return [(fcl.Cylinder(solid.radius, HEIGHT), fcl.Transform(_MIDDLE + [solid.x, solid.z, 0]))]
    points = solid.points
    if solid.is_box:
        width = float(np.linalg.norm(points[2] - points[1]))
        return [_slab(points[0], points[1], width, width / 2)]
    slabs = [_slab(a, b, _EDGE, 0.0) for a, b in _edges(points)]
    return slabs + [(_convex(triangle), fcl.Transform()) for triangle in solid.triangles()]


def _edges(points: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    return list(zip(points, np.roll(points, -1, axis=0), strict=True))


def _slab(a: np.ndarray, b: np.ndarray, thickness: float, shift: float) -> tuple[Any, Any]:
    """Box along a–b, its middle moved by `shift` [m] to the left of the direction of travel."""
    length = float(np.linalg.norm(b - a))
    (cos, sin) = (b - a) / length
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    middle = (a + b) / 2 + shift * np.array([-sin, cos])
    box = fcl.Box(length, thickness, HEIGHT)
    return box, fcl.Transform(turn, np.array([middle[0], middle[1], HEIGHT / 2]))


def _convex(polygon: np.ndarray) -> Any:
    """Upright convex prism over a counter-clockwise (N, 2) polygon."""
    n = len(polygon)
    vertices = np.zeros((2 * n, 3))
    vertices[:n, :2] = vertices[n:, :2] = polygon
    vertices[n:, 2] = HEIGHT
    faces = [n, *range(n - 1, -1, -1), n, *range(n, 2 * n)]
    for i in range(n):
        j = (i + 1) % n
        faces += [4, i, j, n + j, n + i]
    return fcl.Convex(vertices, n + 2, np.array(faces))
