"""What our material is in the units of each peer. Pure numpy: it serves the bench and the peers' process alike.

Ours: St. Venant-Kirchhoff membrane of stretch k [N/m] and Poisson's ratio nu, bending B [N m] by the quadratic hinge
E = B/(2 (A1 + A2)) |L theta|^2 (to second order; L the edge, A1 + A2 its two triangles), lumped mass, no damping.
"""

from __future__ import annotations

import numpy as np

FRAME = 1 / 25  # [s]
SPRING_SHARE = np.sqrt(0.75)  # spring constant of a triangular lattice by its two-dimensional Young's modulus


def lame(stretch: float, poisson: float) -> tuple[float, float]:
    """mu and lambda [N/m] of the sheet in plane stress."""
    return stretch / (2 * (1 + poisson)), stretch * poisson / (1 - poisson**2)


def shell(stretch: float, poisson: float, bend: float) -> tuple[float, float]:
    """Young's modulus [Pa] and thickness [m] of the shell with E t = k and E t^3/(12 (1 - nu^2)) = B.

    MuJoCo's flex is the same membrane energy and, by its documentation, a hinge that stores D kappa^2/2 in a cylinder.
    """
    thickness = float(np.sqrt(12 * (1 - poisson**2) * bend / stretch))
    return stretch / thickness, thickness


def hinges(rest: np.ndarray, opposite: np.ndarray, edge: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Length [m] of every hinge's edge and the area [m2] of its two triangles.

    rest: (V, 2) [m]; opposite, edge: (H, 2) vertices. Newton's VBD stores kappa L theta^2/2, hence kappa = B L/(A1+A2);
    Style3D stores kappa 3/(2 (A1+A2)) |q x|^2 with |q x| = L theta, hence kappa = B/3.
    """
    a, b = rest[edge[:, 0]], rest[edge[:, 1]]
    along = b - a

    def doubled(point: np.ndarray) -> np.ndarray:
        away = point - a
        return np.abs(along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0])

    return np.hypot(*along.T), (doubled(rest[opposite[:, 0]]) + doubled(rest[opposite[:, 1]])) / 2


def blender_numbers(
    rest: np.ndarray,
    faces: np.ndarray,
    mass: float,
    stretch: float,
    bend: float,
    gravity: float,
    vertex: float = 1.0,
) -> dict[str, float]:
    """Stiffnesses of Blender's springs. Its unit of time is the frame, of gravity 1000 m/frame^2, of mass the vertex.

    A spring along every edge is a triangular lattice of nu = 1/3 and Young's modulus 2 K/sqrt(3), so K = sqrt(3)/2 k;
    Blender divides what it is told by the mean edge. A hinge (`angular`) pushes each triangle by f = 0.1 c L theta,
    a third of it at the far corner, i.e. it turns the edge with f h/3, which is to be B L/h theta: c = 30 B/h^2,
    h the height of an equilateral triangle. All vertices weigh the same, nu is 1/3 instead of 0.3 and borders are
    stiffer: Blender's own limit is 1 mm or so from ours.
    """
    edges = np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    length = float(np.linalg.norm(rest[edges[:, 0]] - rest[edges[:, 1]], axis=1).mean())
    height = length * SPRING_SHARE
    to_frames = FRAME**2 * vertex * len(rest) / mass  # N/m to kg/frame^2 of vertices that weigh `vertex`
    return {
        "mass": vertex,
        "tension": float(SPRING_SHARE * stretch * to_frames * length),
        "bending": float(30 * bend / height**2 * to_frames),
        "gravity": gravity * FRAME**2 / 1e-3,
    }


def blender_steps(quality: int) -> int:
    """How many steps Blender takes in a frame: it adds 1/quality up in single precision until it reaches 1.

    Where that takes one step more than `quality` (12, 28, 40, 48, 80 …), a frame lasts longer and the run is ahead.
    """
    step, reached, taken = np.float32(1) / np.float32(quality), np.float32(0), 0
    while reached < np.float32(1):
        reached, taken = np.float32(reached + step), taken + 1
    return taken


def pressed(x: np.ndarray, v: np.ndarray, faces: np.ndarray, wind: np.ndarray, air: float) -> np.ndarray:
    """Forces (V, 3) [N] of the wind (3,) [m/s] on vertices x, v (V, 3): air/2 A |u.n| (u.n) n of every triangle.

    air: density times drag coefficient [kg/m3]; u the wind less the triangle's mean velocity; a third to each vertex.
    """
    a, b, c = (x[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    doubled = np.linalg.norm(normal, axis=1)
    through = ((wind - v[faces].mean(1)) * normal).sum(1) / doubled
    share = normal * (air / 12 * np.abs(through) * through)[:, None]
    flat = np.repeat(share, 3, axis=0)
    return np.stack([np.bincount(faces.ravel(), flat[:, k], len(x)) for k in range(3)], axis=1)
