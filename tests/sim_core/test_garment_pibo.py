"""The scarf on a figure: its path, its section, the capped robe under it, and a coarse drape."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from full_matrix import by_day

from sim_core import metrics
from sim_core.body import Figure, Mannequin, pose_named
from sim_core.cloth import Box, Capsule
from sim_core.cloth.contact import field_of, solid_mesh
from sim_core.errors import SimCoreError
from sim_core.garment import Frame, Garment, dress, load_outfit
from sim_core.garment.dressing import capped
from sim_core.garment.outfit import Step, default_program
from sim_core.garment.placement import Accordion, AlongPath, Ground, arranged_path, swept
from sim_core.metrics import winding

ASSETS = Path(__file__).parents[2] / "assets"
HELD = pose_named("held")
SHORT = (
    *default_program("along_path").steps[:2],
    Step("settle", 0.4, (2.0, 9.81), 6.0, 1.0),
    Step("settle", 0.2, damping=20.0, friction=2.0),
)


@pytest.fixture(scope="module")
def woman() -> Mannequin:
    return Mannequin.load(ASSETS / "mannequins" / "woman.npz")


def _path() -> np.ndarray:
    rod = field_of(*solid_mesh(Capsule((0.2, 1.0, -0.3), (0.2, 1.0, 0.3), 0.04), 32), cell=0.01, band=0.06)
    knots = np.array([[0.0, 1.0, 0.0], [0.1, 1.0, 0.0], [0.2, 1.02, 0.0], [0.3, 1.0, 0.0], [0.31, 0.9, 0.0]])
    return arranged_path(knots, rod, np.full(5, 0.03), 1.0)


def test_the_path_keeps_its_room_and_is_as_long_as_the_cloth() -> None:
    path = _path()
    assert path[0, 0] == 0.0
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    assert np.abs(steps - 0.005).max() < 0.0005
    assert steps.sum() >= 1.0
    far = np.linalg.norm((path - [0.2, 1.0, 0.0])[:, :2], axis=1)
    assert far.min() > 0.04 + 0.025
    rod = field_of(*solid_mesh(Capsule((0.2, 1.0, -0.3), (0.2, 1.0, 0.3), 0.04), 32), cell=0.01)
    with pytest.raises(SimCoreError, match="does not reach round the arm"):
        arranged_path(path[::20], rod, np.full(len(path[::20]), 0.03), 0.3)


def test_the_path_goes_round_what_a_knot_lies_in() -> None:
    """A fold of a sleeve may hang where a knot is meant to be."""
    wall = field_of(*solid_mesh(Box((0.2, 1.0, -0.1), (0.1, 0.2, 0.4)), 32), cell=0.01, band=0.08)
    knots = np.array([[0.0, 1.0, 0.0], [0.2, 1.0, 0.06], [0.4, 1.0, 0.0], [0.41, 0.9, 0.0]])
    path = arranged_path(knots, wall, np.full(4, 0.03), 1.2)
    assert wall.at(path[path[:, 1] > 0.9]).min() > 0.02
    assert path[:, 2].max() > 0.1  # past the wall's near end, where the knot is nearest
    assert path[:, 2].min() > -0.1


def test_every_section_is_as_long_as_the_cloth_is_wide() -> None:
    along, across = np.meshgrid(np.linspace(0, 0.95, 40), np.linspace(0, 0.4, 161), indexing="ij")
    rest = np.column_stack([along.ravel(), across.ravel()])
    accordion = Accordion((0.0, 0.4, 1.0), (0.2, 0.12, 0.24), 4.0)
    x = swept(rest, _path(), np.array([0.0, 0.0, 1.0]), accordion, np.random.default_rng(1))
    length = np.linalg.norm(np.diff(x.reshape(40, 161, 3), axis=1), axis=2).sum(1)
    assert np.abs(length / 0.4 - 1).max() < 0.02
    first = x.reshape(40, 161, 3)[0]
    assert np.abs(first[:, 0]).max() < 1e-9  # the middle lies in the mirror plane, upright
    assert np.ptp(first[:, 1]) > 0.15


def test_a_robe_capped_at_its_openings_has_an_inside() -> None:
    vertices, faces = solid_mesh(Capsule((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), 0.2), 32)
    middle = vertices[faces].mean(1)[:, 1]
    tube = faces[(middle > 0.1) & (middle < 0.9)]
    used, index = np.unique(tube, return_inverse=True)
    closed = capped(vertices[used], index.reshape(-1, 3).astype(np.int32))
    assert len(closed[0]) == len(used) + 2
    inside = winding(np.array([[0.0, 0.5, 0.0], [0.0, 1.3, 0.0]]), *closed)
    assert inside == pytest.approx([1.0, 0.0], abs=1e-6)
    again = capped(*closed)
    assert len(again[0]) == len(closed[0])  # nothing is open any more


def test_a_strip_along_a_bent_line_bends_over_its_flat_side() -> None:
    """Along a quarter circle that lies level, the width stands upright: no border is longer than the other."""
    t = np.linspace(0, np.pi / 2, 64)
    path = 0.2 * np.column_stack([np.sin(t), np.zeros(64), 1 - np.cos(t)])
    path = np.concatenate([path, path[-1] + np.arange(1, 60)[:, None] * [0.0, 0.0, 0.005]])
    path[63:, 1] += 1e-6 * np.sin(np.linspace(0, np.pi, 60))  # highest on the straight part
    along, across = np.meshgrid(np.linspace(0, 0.55, 56), np.linspace(0, 0.2, 21), indexing="ij")
    rest = np.column_stack([along.ravel(), across.ravel()])
    x = swept(
        rest,
        path,
        np.array([0.0, -1.0, 0.0]),
        Accordion((0.0, 1.0), (0.19, 0.19), 1.0),
        np.random.default_rng(0),
    )
    borders = x.reshape(56, 21, 3)[:, [0, -1]]
    length = np.linalg.norm(np.diff(borders, axis=0), axis=2).sum(0)
    assert length == pytest.approx([0.55, 0.55], rel=0.15)


@pytest.mark.parametrize("seed", by_day([0], [0, 1, 2]))
def test_the_laid_scarf_is_not_tangled_nor_inside_the_figure(woman: Mannequin, seed: int) -> None:
    """What a start is tangled by stays: cloth passes through cloth in the first frame, or never."""
    layer = load_outfit(ASSETS / "outfits/pibo-figure.toml").layers[1]
    place, cloth = layer.place, layer.pattern.cloth(0.014)
    assert isinstance(place, AlongPath)
    figure = Figure(woman)
    ground = Ground(*figure.mesh(HELD), figure.trunk(), woman.landmarks(HELD))
    x = place.start(layer.pattern, cloth, ground, np.random.default_rng(seed))
    field = ground.distance
    assert metrics.intersections(x, cloth.faces) == 0
    assert field.at(x).min() > -0.003  # a little inside is pushed out, 10 mm never come free
    ends = np.sort(cloth.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    length, rest = (np.linalg.norm(a[ends[:, 0]] - a[ends[:, 1]], axis=1) for a in (x, cloth.vertices))
    assert (length / rest).max() < 1.8
    assert (length / rest).min() > 0.3


@pytest.mark.nightly
@pytest.mark.slow
def test_a_coarse_scarf_stays_on_the_forearms(woman: Mannequin) -> None:
    both = load_outfit(ASSETS / "outfits/pibo-figure.toml").coarser(0.03)
    scarf = both.layers[1]
    contact = replace(scarf.program.contact, clearance=0.007, sample_clearance=0.0035)
    layer = replace(scarf, program=replace(scarf.program, steps=SHORT, contact=contact))
    frames: list[Frame] = []
    shares: list[float] = []
    (garment,) = dress(
        replace(both, layers=(layer,)),
        on_frame=frames.append,
        progress=lambda share, label: shares.append(share),
    )
    facts = garment.provenance["errors"]
    assert facts["inside_vertices"] + facts["inside_midpoints"] + facts["inside_centroids"] == 0
    assert facts["area_strain_p95"] < 0.03
    assert facts["asymmetry_m"] < 1e-9
    assert garment.positions[:, 1].min() > 0.2  # it has not fallen
    over = woman.landmarks(HELD)
    arm = 0.5 * (over["elbow_l"] + over["wrist_l"])
    near = np.linalg.norm(garment.positions - arm, axis=1)
    assert (garment.positions[near < 0.12][:, 1] > arm[1] + 0.02).any()
    assert len(frames) == sum(round(25 * step.seconds) for step in SHORT)
    assert frames[0].positions.shape == (len(garment.pattern), 3)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_the_baked_scarf_is_clear_of_body_and_robe(woman: Mannequin) -> None:
    folder = ASSETS / "exhibits" / "pibo-figure" / "baked"
    if not folder.is_dir():
        pytest.skip("not baked here: run hall build --exhibit pibo-figure")
    garment = Garment.load(folder / "garment.npz")
    inside = metrics.penetration(garment.positions, garment.faces, woman.posed(HELD), woman.faces)
    assert inside.total == 0
