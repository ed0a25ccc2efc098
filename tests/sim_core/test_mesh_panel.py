"""Panels: invariants of finished meshes, quality bounds, and every bad outline with its own message."""

from dataclasses import replace

import numpy as np
import pytest
from exact_delaunay import delaunay_faults

from sim_core import cli
from sim_core.errors import OutlineError
from sim_core.mesh import panel_mesh, write_mesh
from sim_core.mesh.measures import mesh_fault, quality, triangle_areas
from sim_core.mesh.outline import signed_area

TURN = np.arange(64) * 2 * np.pi / 64
ROUND = np.column_stack([np.cos(TURN), np.sin(TURN)])
RECTANGLE = np.array([[0, 0], [1, 0], [1, 0.7], [0, 0.7]])
TRAPEZOID = np.array([[0.2, 0], [0.8, 0], [1, 0.9], [0, 0.9]])


def half_robe() -> np.ndarray:
    """Half a robe cut flat: neck curve, sleeve, concave underarm."""
    t = np.linspace(0, 1, 15)[:, None]
    neck = 0.09 * np.column_stack([np.sin(t * np.pi / 2), np.cos(t * np.pi / 2)])
    a, b, c, d = np.array([[0.35, 0.32], [0.27, 0.33], [0.26, 0.36], [0.27, 0.45]])
    arm = (1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * b + 3 * (1 - t) * t**2 * c + t**3 * d
    return np.vstack([neck, [[0.75, 0.02], [0.75, 0.3]], arm, [[0.38, 1.2], [0, 1.22]]])


PANELS = {
    "rectangle": (RECTANGLE, ()),
    "robe": (half_robe(), ()),
    "hole": (TRAPEZOID, (0.15 * ROUND + (0.5, 0.45),)),
    "scarf": (np.array([[0, 0], [2.4, 0], [2.4, 0.4], [0, 0.4]]), ()),
}


def assert_sound(mesh, holes: int) -> None:
    assert mesh_fault(mesh.vertices, mesh.faces, mesh.boundary) is None
    assert mesh.faces.dtype == np.int32
    edges = {
        tuple(sorted(e)) for f in mesh.faces.tolist() for e in ((f[0], f[1]), (f[1], f[2]), (f[2], f[0]))
    }
    assert len(mesh.vertices) - len(edges) + len(mesh.faces) == 1 - holes
    assert len(mesh.boundary) == 1 + holes
    assert mesh.report.area_error <= 1e-12
    assert mesh.report.conformity == 1.0
    assert [signed_area(mesh.vertices[loop]) > 0 for loop in mesh.boundary] == [True] + [False] * holes


@pytest.mark.parametrize("name", PANELS)
@pytest.mark.parametrize("edge", [0.03, 0.012])
def test_panels_are_sound_and_well_shaped(name, edge):
    outline, holes = PANELS[name]
    mesh = panel_mesh(outline, edge=edge, holes=holes)
    assert_sound(mesh, len(holes))
    assert mesh.report.min_angle_deg >= 30
    assert mesh.report.mean_quality >= (0.99 if edge < 0.02 else 0.96)
    assert mesh.report.mean_edge_ratio >= (0.95 if edge < 0.02 else 0.9)
    assert mesh.report.outline_deviation <= edge / 8


@pytest.mark.parametrize("name", PANELS)
@pytest.mark.parametrize("edge", [0.03, 0.012])
def test_best_panels_have_no_small_angle(name, edge):
    outline, holes = PANELS[name]
    mesh = panel_mesh(outline, edge=edge, holes=holes, quality="best")
    assert_sound(mesh, len(holes))
    assert mesh.report.min_angle_deg >= 38
    assert mesh.report.mean_quality >= (0.992 if edge < 0.02 else 0.985)
    steps = [np.column_stack([loop, np.roll(loop, -1)]) for loop in mesh.boundary]
    assert delaunay_faults(mesh.vertices, mesh.faces, np.concatenate(steps)) == []


@pytest.mark.parametrize("name", PANELS)
def test_direction_of_the_contours_does_not_matter(name):
    outline, holes = PANELS[name]
    mesh = panel_mesh(outline[::-1], edge=0.04, holes=[hole[::-1] for hole in holes])
    assert_sound(mesh, len(holes))


def test_paper_lattice_without_smoothing_keeps_its_points():
    mesh = panel_mesh(RECTANGLE, edge=0.05, quality="fair")
    inner = np.setdiff1d(np.arange(len(mesh.vertices)), mesh.boundary[0])
    rows = mesh.vertices[inner, 1] / (0.05 * np.sqrt(3) / 2)
    np.testing.assert_allclose(rows, np.rint(rows), atol=1e-9)


def test_boundary_steps_are_at_most_the_edge_and_corners_stay():
    mesh = panel_mesh(half_robe(), edge=0.02)
    loop = mesh.vertices[mesh.boundary[0]]
    assert np.hypot(*(np.roll(loop, -1, axis=0) - loop).T).max() <= 0.02 * (1 + 1e-9)
    for corner in ([0.75, 0.02], [0.75, 0.3], [0.38, 1.2], [0, 1.22]):
        assert np.abs(loop - corner).max(axis=1).min() == 0


def test_same_input_same_bits():
    first, again = (panel_mesh(half_robe(), edge=0.02) for _ in range(2))
    np.testing.assert_array_equal(first.vertices, again.vertices)
    np.testing.assert_array_equal(first.faces, again.faces)


@pytest.mark.parametrize(
    "outline",
    [
        [[0, 0], [1, 0], [1, 0.02], [0, 0.02]],  # strip narrower than the edge
        [[0, 0], [1, 0], [1, 1], [0.52, 1], [0.52, 0.1], [0.48, 0.1], [0.48, 1], [0, 1]],  # slit
        [[0, 0], [1, 0.09], [0, 0.18]],  # spike of 10 degrees
        [[0, 0], [1, 0], [1, 1]],
        (0.06 * ROUND).tolist(),
    ],
)
def test_narrow_features_are_followed(outline):
    assert_sound(panel_mesh(outline, edge=0.05), 0)


@pytest.mark.parametrize("seed", range(30))
def test_spiky_stars_are_filled_whatever_the_edge(seed):
    """Needles finer than the edge in every direction: outline steps act as walls where they must."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(5, 40))
    angle = (np.arange(count) + rng.uniform(-0.4, 0.4, count)) * 2 * np.pi / count
    radius = rng.uniform(0.05, 1, count)
    star = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    assert_sound(panel_mesh(star, edge=float(rng.uniform(0.03, 0.3))), 0)


def test_close_holes_are_followed():
    holes = [0.2 * ROUND + (0.3, 0.35), 0.2 * ROUND + (0.705, 0.35)]
    assert_sound(panel_mesh(RECTANGLE, edge=0.04, holes=holes), 2)


@pytest.mark.parametrize("move", [0, 100.0])
@pytest.mark.parametrize("scale", [1e-3, 1, 50])
def test_size_and_place_do_not_matter(scale, move):
    mesh = panel_mesh(half_robe() * scale + move * scale, edge=0.03 * scale)
    assert_sound(mesh, 0)
    assert mesh.report.min_angle_deg >= 30


BAD = {
    "0 points": ([], {}),
    "at least three": ([[0, 0], [1, 1]], {}),
    "2 different points": ([[0, 0], [1, 1], [0, 0], [1, 1], [1, 1]][2:], {}),
    "point 1 is": ([[0, 0], [1, np.nan], [1, 1]], {}),
    "list of": ([[0, 0], [1], [1, 1]], {}),
    "shape": ([[0, 0, 0], [1, 0, 0], [1, 1, 0]], {}),
    "zero area": ([[0, 0], [1, 0], [2, 0]], {}),
    r"segment 0 .*segment 2": ([[0, 0], [1, 1], [1, 0], [0, 1]], {}),
    "crosses or touches itself": ([[0, 0], [1, 0], [1, 1], [0.5, 0], [0, 1]], {}),
    "hole 0 segment|outline segment": (RECTANGLE, {"holes": [0.2 * ROUND + (0.1, 0.3)]}),
    "hole 0: lies outside": (RECTANGLE, {"holes": [0.2 * ROUND + (2, 0.3)]}),
    "lies inside hole 0": (RECTANGLE, {"holes": [0.3 * ROUND + (0.5, 0.35), 0.1 * ROUND + (0.5, 0.35)]}),
    "edge -1.0 m": (RECTANGLE, {"edge": -1.0}),
    "edge nan m": (RECTANGLE, {"edge": np.nan}),
    "edge 0 m": (RECTANGLE, {"edge": 0}),
    "longer than the panel": (RECTANGLE, {"edge": 1.1}),
    "threshold": (RECTANGLE, {"threshold": 0.2}),
}


@pytest.mark.parametrize("message", BAD)
def test_bad_outlines_are_named(message):
    outline, options = BAD[message]
    with pytest.raises(OutlineError, match=message):
        panel_mesh(outline, **{"edge": 0.05, **options})


@pytest.mark.parametrize("degrees", [0, 30, 45])
def test_how_long_an_edge_may_be_does_not_depend_on_how_the_panel_lies(degrees):
    t = np.radians(degrees)
    strip = np.array([[0, 0], [1, 0], [1, 0.02], [0, 0.02]]) @ [
        [np.cos(t), np.sin(t)],
        [-np.sin(t), np.cos(t)],
    ]
    assert_sound(panel_mesh(strip, edge=0.99), 0)
    with pytest.raises(OutlineError, match="longer than the panel"):
        panel_mesh(strip, edge=1.01)


def test_repeated_closing_point_is_accepted():
    mesh = panel_mesh(np.vstack([RECTANGLE, RECTANGLE[:1]]), edge=0.1)
    assert_sound(mesh, 0)
    assert triangle_areas(mesh.vertices, mesh.faces).sum() == pytest.approx(0.7, rel=1e-12)
    assert quality(mesh.vertices, mesh.faces).min_angle.min() == pytest.approx(mesh.report.min_angle_deg)


@pytest.mark.parametrize("kind", ["fair", "light", "best"])
@pytest.mark.parametrize("width", [1e-4, 1e-6, 3e-7])
def test_hair_thin_strips_at_any_angle_are_sound(width, kind):
    """Cancellation in the areas of slivers is no fault of the mesh."""
    for degrees in (11, 30, 84):
        t = np.radians(degrees)
        strip = np.array([[0, 0], [1, 0], [1, width], [0, 0.6 * width]])
        strip = strip @ [[np.cos(t), np.sin(t)], [-np.sin(t), np.cos(t)]]
        mesh = panel_mesh(strip, edge=0.1, quality=kind)
        assert_sound(mesh, 0)
        steps = [np.column_stack([loop, np.roll(loop, -1)]) for loop in mesh.boundary]
        assert delaunay_faults(mesh.vertices, mesh.faces, np.concatenate(steps)) == []


@pytest.mark.parametrize("ending", [".npz", ".NPZ", ".ply", ".obj"])
def test_a_failed_write_leaves_the_old_file_alone(tmp_path, ending):
    path = tmp_path / f"mesh{ending}"
    mesh = panel_mesh(RECTANGLE, edge=0.2)
    write_mesh(path, mesh)
    before = path.read_bytes()
    assert len(before) > 500
    with pytest.raises((TypeError, ValueError, IndexError)):
        write_mesh(path, replace(mesh, faces="none", boundary=()))
    assert path.read_bytes() == before
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("option", ["--out", "--picture"])
def test_an_output_that_cannot_be_written_is_one_line_with_a_remedy(tmp_path, capsys, option):
    outline = tmp_path / "panel.json"
    outline.write_text('{"outline": [[0, 0], [1, 0], [1, 1]]}')
    name = "mesh.ply" if option == "--out" else "mesh.png"
    for place in (outline / name, tmp_path / name):  # a file where a folder should be; a folder of that name
        if place.parent == tmp_path:
            place.mkdir()
        assert cli.main(["mesh", str(outline), "--edge", "0.3", option, str(place)]) == 1
        lines = capsys.readouterr().err.splitlines()
        (told,) = (
            line for line in lines if "making machine code" not in line
        )  # told once, where it takes long
        assert f"{place}: cannot be written (" in told
        assert "– give" in told
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([name, "panel.json"])
