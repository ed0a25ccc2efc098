"""Small named scenes: a structured sheet of equilateral triangles that hangs by an edge, or lies over a bar."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from sim_core.cloth.collider import Capsule, Solid
from sim_core.cloth.draping import Contact, Phase
from sim_core.cloth.material import Material
from sim_core.cloth.sheet import Sheet
from sim_core.errors import WrongArgument

MOST_VERTICES = 100_000

GF_CM = Material(0.05, 49.0, 0.3, 4.9e-5, 0.3, 0.5, 2e-5)  # the preset `gf-cm` of the published scenes


@dataclass(frozen=True)
class Scene:
    """What `drape` needs: sheet, start positions (V, 3) [m], phases, pins, collider, contact."""

    name: str
    sheet: Sheet
    positions: np.ndarray
    phases: tuple[Phase, ...]
    pins: tuple[int, ...] = ()
    collider: Solid | None = None
    contact: Contact | None = None


def equilateral_sheet(width: float, height: float, edge: float) -> tuple[np.ndarray, np.ndarray]:
    """Rows of equilateral triangles, half-width at the side borders: rest (V, 2) [m], faces (F, 3).

    Raises WrongArgument for an edge that leaves less than two triangles across, or makes more than 100 000 vertices.
    """
    least, most = sqrt(width * height * 2 / sqrt(3) / MOST_VERTICES), min(width, height) / 2
    if not least <= edge <= most:
        raise WrongArgument(
            f"edge {edge} m – a sheet of {width} x {height} m takes {least:.2g} to {most:.2g} m"
        )
    columns, rows = max(1, round(width / edge)), max(1, round(height / (edge * np.sqrt(0.75))))
    points, first = [], []
    for row in range(rows + 1):
        x = np.linspace(0, width, columns + 1)
        if row % 2:
            x = np.r_[0.0, (x[1:] + x[:-1]) / 2, width]
        first.append(sum(map(len, points)))
        points.append(np.stack([x, np.full(len(x), row * height / rows)], axis=1))
    faces = []
    for row in range(rows):
        even, odd = (first[row], first[row + 1]) if row % 2 == 0 else (first[row + 1], first[row])
        for c in range(columns):
            faces += [(even + c, even + c + 1, odd + c + 1), (even + c, odd + c + 1, odd + c)]
        faces.append((even + columns, odd + columns + 1, odd + columns))
    rest = np.concatenate(points)
    index = np.array(faces, np.int32)
    a, b = rest[index[:, 1]] - rest[index[:, 0]], rest[index[:, 2]] - rest[index[:, 0]]
    turned = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > 0  # positive area in (x, -y)
    index[turned] = index[turned][:, [0, 2, 1]]
    return rest, index


def hang_edge(edge: float = 0.0134, *, seconds: float = 1.0, material: Material = GF_CM) -> Scene:
    """A horizontal 1 x 1 m sheet let go with one edge pinned: the comparison scene of the published work."""
    rest, faces = equilateral_sheet(1.0, 1.0, edge)
    positions = np.stack([rest[:, 0], np.zeros(len(rest)), rest[:, 1]], axis=1)
    pins = tuple(int(i) for i in np.flatnonzero(rest[:, 1] < 1e-9))
    return Scene("hang", Sheet.of(rest, faces, material), positions, (Phase(seconds, label="hanging"),), pins)


def bar(edge: float = 0.02, *, seconds: float = 1.6) -> Scene:
    """A 0.3 x 0.8 m sheet dropped on a round bar: contact, friction and self-contact in a few seconds."""
    rest, faces = equilateral_sheet(0.3, 0.8, edge)
    positions = np.stack([rest[:, 0] - 0.15, np.full(len(rest), 1.03), rest[:, 1] - 0.38], axis=1)
    material = Material(0.08, 100.0, 0.3, 2e-5, 0.5, 1.0, 2e-5)
    contact = Contact(clearance=0.004, sample_clearance=0.001, thickness=0.003, speed_limit=4.0)
    phases = (Phase(seconds, damping=1.5, label="falling"), Phase(seconds / 2, damping=10.0, label="resting"))
    solid = Capsule((-0.3, 1.0, 0.0), (0.3, 1.0, 0.0), 0.02)
    return Scene("bar", Sheet.of(rest, faces, material), positions, phases, (), solid, contact)


SCENES = {"hang": hang_edge, "bar": bar}
