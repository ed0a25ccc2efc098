"""Strips of regular and irregular meshes, what they give way by when bent evenly, and how they rest as cantilevers.

Closed references: a plate without Poisson's effect bent to a constant curvature is in balance, and the heavy elastica.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import sparse
from scipy.integrate import solve_bvp
from scipy.sparse.linalg import splu, spsolve
from scipy.spatial import Delaunay

from sim_core.cloth import Material, Sheet
from sim_core.cloth.scenes import equilateral_sheet
from sim_core.mesh import panel_mesh

__all__ = [
    "MESHES",
    "bending_of",
    "cantilever",
    "elastica_curve",
    "gives_way",
    "sag",
    "sheet_of_strip",
    "tip_of",
]

G = 9.81
Mesh = tuple[np.ndarray, np.ndarray]


def rows(length: float, width: float, edge: float) -> Mesh:
    """The lattice of the published scenes; its every other row leans to the straight side."""
    rest, faces = equilateral_sheet(width, length, edge)
    return rest[:, ::-1].copy(), faces


def shaken(length: float, width: float, edge: float) -> Mesh:
    """The same with all inner vertices moved by up to a fifth of an edge each way."""
    rest, faces = rows(length, width, edge)
    inner = ((rest > 1e-9) & (rest < rest.max(0) - 1e-9)).all(1)
    rest[inner] += 0.2 * edge * np.random.default_rng(1).uniform(-1, 1, (inner.sum(), 2))
    return rest, faces


def scattered(length: float, width: float, edge: float, seed: int = 1) -> Mesh:
    """Delaunay's triangles of points thrown at random, none nearer than .68 edges."""
    rng, gap = np.random.default_rng(seed), 0.68 * edge
    along, across = (np.linspace(0, side, round(side / edge) + 1) for side in (length, width))
    points = [(a, b) for a in along for b in (0.0, width)] + [
        (a, b) for a in (0.0, length) for b in across[1:-1]
    ]
    cells: dict[tuple[int, int], list[tuple[float, float]]] = {}
    for point in points:
        cells.setdefault((int(point[0] // gap), int(point[1] // gap)), []).append(point)
    most = [length - 0.4 * edge, width - 0.4 * edge]
    for new in rng.uniform(0.4 * edge, most, (round(80 * length * width / edge**2), 2)):
        a, b = int(new[0] // gap), int(new[1] // gap)
        near = [p for i in (a - 1, a, a + 1) for j in (b - 1, b, b + 1) for p in cells.get((i, j), ())]
        if all((p[0] - new[0]) ** 2 + (p[1] - new[1]) ** 2 >= gap**2 for p in near):
            cells.setdefault((a, b), []).append((new[0], new[1]))
            points.append((new[0], new[1]))
    rest = np.array(points)
    faces = Delaunay(rest).simplices.astype(np.int32)
    a, b = (rest[faces[:, k]] - rest[faces[:, 0]] for k in (1, 2))
    return rest, faces[
        np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) > 1e-6 * edge**2
    ]  # flat ones at the sides


def grown(length: float, width: float, edge: float, turn: float = 0.0) -> Mesh:
    """A panel of the project's own mesher, its rows at an angle [rad] to the strip."""
    cos, sin = np.cos(turn), np.sin(turn)
    turned = np.array([[cos, sin], [-sin, cos]])
    panel = panel_mesh(np.array([[0, 0], [length, 0], [length, width], [0, width]]) @ turned, edge=edge)
    rest = panel.vertices @ turned.T
    return rest - rest.min(0), panel.faces


MESHES: dict[str, Callable[[float, float, float], Mesh]] = {
    "rows": rows,
    "shaken rows": shaken,
    "scattered": scattered,
    "scattered otherwise": lambda length, width, edge: scattered(length, width, edge, 2),
    "grown": grown,
    "grown, at 20 degrees": lambda length, width, edge: grown(length, width, edge, np.radians(20)),
}


def sheet_of_strip(mesh: Mesh, material: Material, *, balanced: bool | None) -> Sheet:
    rest, faces = mesh
    return Sheet.of_corners(rest[faces], faces, [material], np.zeros(len(faces), int), balanced=balanced)


def bending_of(sheet: Sheet) -> sparse.csr_array:
    """Q (V, V) [N/m] of the sheet's stencil."""
    s, count = sheet.stencil, len(sheet.rest)
    own = np.repeat(np.arange(count), np.diff(s.rows))
    apart = sparse.coo_array((s.bend, (own, s.neighbour)), (count, count)).tocsr()
    return sparse.csr_array(apart - sparse.diags_array(np.asarray(apart.sum(1)).ravel()))


def gives_way(sheet: Sheet, form: np.ndarray, held: np.ndarray, area: float) -> float:
    """The share of its energy that a plate of this area [m2] bent to a curvature (2, 2) loses where it is not held."""
    bending, middle = bending_of(sheet), sheet.rest - sheet.rest.mean(0)
    height = 0.5 * np.einsum("ni,ij,nj->n", middle, form, middle)
    free = np.flatnonzero(~held)
    moved = spsolve(sparse.csc_array(bending[free][:, free]), -(bending @ height)[free])
    lost = -0.5 * float(moved @ (bending @ height)[free])
    stiff = sheet.material.bending()
    energy = stiff[0] * form[0, 0] ** 2 + stiff[1] * form[1, 1] ** 2 + 2 * stiff[2] * form[0, 1] ** 2
    return lost / (0.5 * energy * area)


def sag(sheet: Sheet, held: float) -> float:
    """How much lower than a beam's the end hangs under a small weight, as a share; held on the beam up to x [m]."""
    x, bending = sheet.rest[:, 0], bending_of(sheet)
    length, stiff = x.max(), sheet.material.bending()[0]
    heavy = sheet.material.density / stiff
    beam = heavy / 24 * x**2 * (x**2 - 4 * length * x + 6 * length**2)
    # The tip of a corner whose only neighbour lies at the border itself is in no patch and bends freely.
    free, fixed = np.flatnonzero((x > held) & (bending.diagonal() > 0)), np.flatnonzero(x <= held)
    load = sheet.mass[free] - bending[free][:, fixed] @ beam[fixed]
    end = x[free] > length - 1e-9
    return float(
        spsolve(sparse.csc_array(bending[free][:, free]), load)[end].mean() / (heavy * length**4 / 8) - 1
    )


def elastica_curve(bend: float, density: float, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Heavy elastica B th'' + rho g (L - s) cos th = 0, th(0) = 0, th'(L) = 0: s (N,), points (N, 2) [m]."""
    start = np.linspace(0, 1, 401)
    found = solve_bvp(
        lambda s, y: np.stack([y[1], -density * G * (length - s) / bend * np.cos(y[0])]),
        lambda p, q: np.array([p[0], q[1]]),
        length * start,
        np.stack([np.pi / 4 * start, np.full_like(start, np.pi / 4 / length)]),
        tol=1e-9,
        max_nodes=100_000,
    )
    s = np.linspace(0, length, 4001)
    angle = found.sol(s)[0]
    way = np.column_stack([np.cos(angle), -np.sin(angle)])
    parts = 0.5 * (s[1] - s[0]) * (way[1:] + way[:-1])
    return s, np.vstack([np.zeros(2), np.cumsum(parts, axis=0)])


def cantilever(
    sheet: Sheet, curve: tuple[np.ndarray, np.ndarray], held: np.ndarray, clamp: float
) -> np.ndarray:
    """Where the strip (V, 3) [m] rests, held (V,) where the elastica has it that begins at x = clamp."""
    s, points = curve
    along = sheet.rest[:, 0] - clamp
    x = np.interp(along, s, points[:, 0]) + np.minimum(along, 0) + clamp
    return _rest(sheet, np.column_stack([x, np.interp(along, s, points[:, 1]), sheet.rest[:, 1]]), held)


def tip_of(sheet: Sheet, x: np.ndarray) -> np.ndarray:
    """The mean place (2,) [m] of the strip's end."""
    return x[sheet.rest[:, 0] > sheet.rest[:, 0].max() - 1e-9].mean(0)[:2]


def _rest(sheet: Sheet, x: np.ndarray, held: np.ndarray) -> np.ndarray:
    """The equilibrium near x (V, 3) by Newton's method with Armijo's rule."""
    st, count = sheet.stencil, len(x)
    edges, (i, j) = np.arange(len(st.edges)), st.edges.T
    membrane = sparse.coo_array(
        (
            np.r_[st.own, st.coupling.ravel()],
            (np.r_[edges, np.repeat(edges, 4)], np.r_[edges, st.around.ravel()]),
        )
    ).tocsr()
    differ = sparse.coo_array(
        (np.repeat([1.0, -1.0], len(edges)), (np.r_[edges, edges], np.r_[i, j]))
    ).tocsr()
    bending, load = bending_of(sheet), np.outer(sheet.mass, [0.0, -G, 0.0])
    thrice = sparse.kron(bending, sparse.eye_array(3)).tocsr()
    free = np.flatnonzero(np.repeat(~held, 3))

    def strain(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        d = x[i] - x[j]
        return d, (d**2).sum(1) - st.length2

    def energy(x: np.ndarray) -> float:
        eps = strain(x)[1]
        return float(0.5 * eps @ (membrane @ eps) + 0.5 * (x * (bending @ x)).sum() - (load * x).sum())

    ridge = 0.0
    for _ in range(200):
        d, eps = strain(x)
        tension = 2 * (membrane @ eps)
        push = (differ.T @ (tension[:, None] * d) + bending @ x - load).ravel()[free]
        if np.abs(push).max() < 1e-11:
            return x
        place = (np.tile(np.repeat(edges, 3), 2), np.r_[_threes(i), _threes(j)])
        jacobian = sparse.coo_array(
            (np.r_[2 * d.ravel(), -2 * d.ravel()], place), (len(edges), 3 * count)
        ).tocsr()
        # Without compressive tensions where the whole tangent has been indefinite.
        kept = tension if ridge == 0 else np.maximum(tension, 0)
        pull = sparse.kron(differ.T @ sparse.diags_array(kept) @ differ, sparse.eye_array(3))
        tangent = sparse.csc_array(
            sparse.csr_array(jacobian.T @ membrane @ jacobian + pull + thrice)[free][:, free]
        )
        step = splu(sparse.csc_array(tangent + ridge * sparse.eye_array(len(free)))).solve(-push)
        if step @ push > 0:
            ridge = max(1e-6, 2 * ridge)
            continue
        x, share = _along(energy, x, free, step, push)
        ridge = 0.0 if share == 1.0 else ridge
    raise ArithmeticError("the strip found no rest in 200 steps")


def _along(
    energy, x: np.ndarray, free: np.ndarray, step: np.ndarray, push: np.ndarray
) -> tuple[np.ndarray, float]:
    share, before = 1.0, energy(x)
    while True:
        y = x.copy()
        y.ravel()[free] += share * step
        # Close to rest, energies differ by less than they are rounded by.
        if share < 1e-6 or np.abs(push).max() < 1e-8 or energy(y) <= before + 1e-4 * share * (step @ push):
            return y, share
        share /= 2


def _threes(index: np.ndarray) -> np.ndarray:
    return (3 * index[:, None] + np.arange(3)).ravel()
