"""The certifier: one frame is accepted when a path without intersection leads from its begin to its end.

Continuous collision detection by `ipctk` (optional) of every vertex against every triangle and every edge against
every edge, of the cloth and of a solid's mesh, along straight ways: from a start without intersections a way without
collisions leads to an end without, and nothing can have passed through anything. The cloth itself goes in hundreds of
small steps; where the straight way from begin to end collides, the frame is done again in parts (see
`certified_run`).

What still would pass through something within a step goes along with it instead: impact zones, after Provot (1997)
and Harmon et al. (2008), with translations alone. The vertices of all crossing pairs that share one move by their
common mean, weighted by mass. Nothing within a zone moves against the rest of it, so it cannot cross; what a zone
then runs into joins it. In the end the whole cloth is one zone, and stands still or flies.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.metrics import components, intersections
from sim_core.validation import excerpt, points, triangles

ROUNDS = 40  # in which zones may grow before a part is given up
SAME = 1e-12  # [m] two led vertices that move alike to within this are one body
LONGEST = 2_000  # halvings of one pair's way; parallel edges have no one place to meet: what is not free then, meets

Mesh = tuple[np.ndarray, np.ndarray]


def need_ipctk() -> Any:
    """The library; raises SimCoreError with the remedy where it is not installed."""
    try:
        ipctk = import_module("ipctk")
    except ImportError as error:
        raise SimCoreError(
            "certify: ipctk is missing – install it: pip install 'handress-hall[certify]'"
        ) from error
    ipctk.set_logger_level(ipctk.LoggerLevel.off)
    ipctk.set_num_threads(1)
    return ipctk


def _edges_of(faces: np.ndarray) -> np.ndarray:
    """Unique edges (E, 2) int32 of faces (F, 3)."""
    return np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0).astype(np.int32)


class Certifier:
    """Looks at ways of a cloth with faces (F, 3) beside a still solid's mesh."""

    def __init__(self, start: np.ndarray, faces: np.ndarray, solid: Mesh | None = None) -> None:
        """start (V, 3) [m]; solid: vertices (S, 3) [m] and faces. Raises SimCoreError where they intersect."""
        self._ipctk = need_ipctk()
        self._narrow = self._ipctk.TightInclusionCCD(max_iterations=LONGEST)
        self.count, self.faces = len(start), np.ascontiguousarray(faces, np.int32)
        self.solid = _checked(solid)
        self.still, solid_faces = self.solid
        self._all_faces = np.concatenate([self.faces, solid_faces + self.count]).astype(np.int32)
        self._edges = _edges_of(self._all_faces)
        self._own = intersections(self.still, solid_faces) if len(solid_faces) else 0
        self._mesh = self._ipctk.CollisionMesh(
            self._whole(start), np.asfortranarray(self._edges), np.asfortranarray(self._all_faces)
        )
        self._mesh.can_collide = self._ipctk.make_static_obstacle_filter(self.count)
        crossed = self.intersections(start)
        if crossed:
            raise SimCoreError(
                f"certify: the start has {crossed} intersections – begin with a cloth that has none"
            )

    def _whole(self, x: np.ndarray) -> np.ndarray:
        return np.asfortranarray(np.concatenate([x, self.still]), dtype=float)

    def intersections(self, x: np.ndarray) -> int:
        """(edge, face) pairs of the cloth at x (V, 3), and of cloth and solid, that pass through each other."""
        return intersections(self._whole(x), self._all_faces) - self._own

    def free(self, before: np.ndarray, after: np.ndarray) -> bool:
        """Does nothing meet on the straight way from before to after (V, 3)?"""
        kinds = {"broad_phase": self._ipctk.LBVH(), "narrow_phase_ccd": self._narrow}
        ends = self._whole(before), self._whole(after)
        return bool(self._ipctk.is_step_collision_free(self._mesh, *ends, **kinds))

    def crossing(self, before: np.ndarray, after: np.ndarray) -> np.ndarray:
        """The vertices (K, 4) of all pairs that meet on the way, those of the solid numbered from V on."""
        ends = self._whole(before), self._whole(after)
        found = self._ipctk.Candidates()
        found.build(self._mesh, *ends, broad_phase=self._ipctk.LBVH())
        edges, faces, out = self._edges, self._all_faces, []
        for pair in (*found.fv_candidates, *found.ee_candidates):
            first, second = (pair.dof(end, edges, faces) for end in ends)
            if pair.ccd(first, second, narrow_phase_ccd=self._narrow)[0]:
                out.append(pair.vertex_ids(edges, faces))
        return np.array(out, np.int64).reshape(-1, 4)

    def mended(
        self, before: np.ndarray, after: np.ndarray, v: np.ndarray, inverse_mass: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, int, bool]:
        """End (V, 3) and velocities of a way without collisions, close to the one given, and how many rounds of zones.

        The last value tells whether the way is free now: led vertices may leave none.
        """
        solid = np.zeros((len(self.still), 3))
        inverse = np.r_[inverse_mass, np.zeros(len(solid))]
        way, speed = np.concatenate([after - before, solid]), np.concatenate([v, solid])
        seen = np.zeros((0, 4), np.int64)
        for rounds in range(ROUNDS):
            x = before + way[: self.count]
            if self.free(before, x):
                return x, speed[: self.count], rounds, True
            seen = np.concatenate([seen, self.crossing(before, x)])
            way, speed, stuck = moved_together(zones_of(seen, len(way)), way, speed, inverse)
            if stuck:
                break
        return before + way[: self.count], speed[: self.count], ROUNDS, False


def zones_of(stencils: np.ndarray, count: int) -> np.ndarray:
    """The zone (count,) each vertex belongs to, -1: none. stencils (K, 4): the vertices of pairs that would cross."""
    first = np.repeat(stencils[:, 0], stencils.shape[1])
    zone = components(count, first, stencils.ravel())
    inside = np.zeros(count, bool)
    inside[stencils.ravel()] = True
    zone[~inside] = -1
    _, renumbered = np.unique(zone[inside], return_inverse=True)
    zone[inside] = renumbered
    return zone


def moved_together(
    zone: np.ndarray, way: np.ndarray, v: np.ndarray, inverse_mass: np.ndarray
) -> tuple[np.ndarray, np.ndarray, int]:
    """Ways (V, 3) [m] and velocities (V, 3) [m/s] once every zone moves as one, and how many zones cannot.

    inverse_mass (V,) [1/kg]: 0 for what is held or led, whose way the zone then takes; a zone with two of different
    ways is left alone.
    """
    way, v, stuck = way.copy(), v.copy(), 0
    for number in range(int(zone.max(initial=-1)) + 1):
        member = np.flatnonzero(zone == number)
        held = member[inverse_mass[member] == 0.0]
        if len(held):
            if np.ptp(way[held], axis=0).max() > SAME:
                stuck += 1
                continue
            way[member], v[member] = way[held[0]], v[held[0]]
        else:
            weight = 1.0 / inverse_mass[member]
            weight /= weight.sum()
            way[member] = (weight[:, None] * way[member]).sum(0)
            v[member] = (weight[:, None] * v[member]).sum(0)
    return way, v, stuck


def _checked(solid: Mesh | None) -> Mesh:
    if solid is None:
        return np.zeros((0, 3)), np.zeros((0, 3), np.int32)
    if not isinstance(solid, tuple | list) or len(solid) != 2:
        raise SimCoreError(
            f"certify: {excerpt(solid)} – give True, or the vertices (S, 3) and faces (F, 3) of a solid"
        )
    vertices = points("certify: the solid's vertices", solid[0])
    return vertices, triangles("certify: the solid's faces", solid[1], len(vertices)).astype(np.int32)
