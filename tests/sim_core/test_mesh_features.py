"""Inner lines, size fields, holes that touch, bends, and the promise of `best` for wide corners."""

import json

import numpy as np
import pytest
from exact_delaunay import delaunay_faults
from full_matrix import by_day

from sim_core.errors import FileProblem, OutlineError, OutlineWarning
from sim_core.mesh import SizeField, panel_mesh, quality, staggered_points
from sim_core.mesh.measures import mesh_fault
from sim_core.mesh.outline import clean_contours, inner_lines, read_size_field, sharpest_corner
from sim_core.mesh.points import lattice_near

RECTANGLE = np.array([[0, 0], [1, 0], [1, 0.7], [0, 0.7]])
TURN = np.arange(64) * 2 * np.pi / 64
ROUND = np.column_stack([np.cos(TURN), np.sin(TURN)])
QUALITIES = ["fair", "light", "best"]


def assert_sound(mesh) -> None:
    assert mesh_fault(mesh.vertices, mesh.faces, mesh.boundary, mesh.lines) is None
    steps = [np.column_stack([loop, np.roll(loop, -1)]) for loop in mesh.boundary]
    steps += [np.column_stack([line[:-1], line[1:]]) for line in mesh.lines]
    assert delaunay_faults(mesh.vertices, mesh.faces, np.concatenate(steps)) == []
    assert mesh.report.conformity == 1.0
    assert mesh.report.area_error <= 1e-12


def line_length(mesh) -> float:
    return float(sum(np.hypot(*np.diff(mesh.vertices[line], axis=0).T).sum() for line in mesh.lines))


LINES = {
    "pleat folds from edge to edge": ([[[x, 0], [x, 0.7]] for x in (0.2, 0.25, 0.31)], 2.1),
    "crossing": ([[[0.1, 0.1], [0.5, 0.6]], [[0.1, 0.6], [0.5, 0.1]]], 2 * np.hypot(0.4, 0.5)),
    "ending on another": ([[[0.1, 0.3], [0.9, 0.3]], [[0.4, 0.3], [0.5, 0.6]]], 0.8 + np.hypot(0.1, 0.3)),
    "closed": ([[[0.4, 0.2], [0.7, 0.25], [0.6, 0.5], [0.4, 0.2]]], None),
    "from a corner": ([[[0, 0], [0.3, 0.3]]], np.hypot(0.3, 0.3)),
    "along the outline for a part": ([[[0.2, 0], [0.5, 0], [0.5, 0.3]]], 0.3),
    "close together": ([[[0.1, 0.3], [0.9, 0.3]], [[0.1, 0.301], [0.9, 0.301]]], 1.6),
}


@pytest.mark.parametrize("kind", QUALITIES)
@pytest.mark.parametrize("name", LINES)
def test_inner_lines_are_edges_of_the_mesh(name, kind):
    lines, length = LINES[name]
    mesh = panel_mesh(RECTANGLE, edge=0.05, constraints=lines, quality=kind)
    assert_sound(mesh)
    wanted = length or sum(np.hypot(*np.diff(np.array(line), axis=0).T).sum() for line in lines)
    assert line_length(mesh) == pytest.approx(wanted, rel=1e-9)
    for line in mesh.lines:
        assert np.hypot(*np.diff(mesh.vertices[line], axis=0).T).max() <= 0.05 * (1 + 1e-9)


BAD_LINES = {
    "constraint 0: leaves the cloth": [[[0.5, 0.1], [1.5, 0.2]]],
    "constraint 1: 1 different": [[[0.1, 0.1], [0.2, 0.2]], [[0.5, 0.5], [0.5, 0.5]]],
    "constraint 0: point 0 is": [[[np.nan, 0.5], [0.1, 0.1]]],
    "constraint 0: 0 points": [[]],
    "constraint 0: not a list": [[[1], [1, 2]]],
}


@pytest.mark.parametrize("message", BAD_LINES)
def test_bad_lines_are_named(message):
    with pytest.raises(OutlineError, match=message):
        panel_mesh(RECTANGLE, edge=0.05, constraints=BAD_LINES[message])


def spokes(count: int) -> list:
    """Lines that meet at one point."""
    t = np.arange(count) * 2 * np.pi / count
    return [[[0.5, 0.35], [0.5 + 0.3 * np.cos(a), 0.35 + 0.3 * np.sin(a)]] for a in t]


CROWDS = {
    "at one point": spokes,
    "on one side": lambda count: [[[x, 0], [x, 0.3]] for x in np.linspace(0.01, 0.99, count)],
    "on one line": lambda count: (
        [[[0.01, 0.3], [0.99, 0.3]]] + [[[x, 0.3], [x, 0.6]] for x in np.linspace(0.02, 0.98, count)]
    ),
    "apart": lambda count: [[[x, 0.1], [x, 0.6]] for x in np.linspace(0.01, 0.99, count)],
}


@pytest.mark.parametrize("name", CROWDS)
def test_lines_are_not_compared_with_all_others(name, monkeypatch):
    """Each end with each line: 8 million comparisons for two thousand lines."""
    tried = []
    foot = inner_lines._Chains.foot
    monkeypatch.setattr(inner_lines._Chains, "foot", lambda *given: tried.append(1) or foot(*given))
    lines, contours, kept = inner_lines.clean_lines(CROWDS[name](2000), clean_contours(RECTANGLE, ()))
    assert len(tried) <= 8 * 2000
    assert len(kept) == len(contours[0]) - 4 == (2000 if name == "on one side" else 0)
    assert len(lines) == {"on one line": 2000 + 1999 + 2}.get(name, 2000)


@pytest.mark.parametrize("name", CROWDS)
def test_crowds_of_lines_are_meshed(name):
    assert_sound(panel_mesh(RECTANGLE, edge=0.05, constraints=CROWDS[name](60)))


def test_a_line_that_is_given_twice_is_one():
    line = [[0.1, 0.1], [0.5, 0.6]]
    for lines in ([line, line], [line, line[::-1]], [line, [line[0], [0.3, 0.35]]]):
        found = inner_lines.clean_lines(lines, clean_contours(RECTANGLE, ()))[0]
        assert sum(np.hypot(*np.diff(part, axis=0).T).sum() for part in found) == pytest.approx(
            np.hypot(0.4, 0.5)
        )


def test_lines_do_not_go_with_sampled_contours():
    with pytest.raises(OutlineError, match="sampled"):
        panel_mesh(RECTANGLE, edge=0.5, constraints=[[[0.1, 0.1], [0.2, 0.2]]], sampled=True)


@pytest.mark.parametrize("kind", QUALITIES)
def test_edges_follow_the_size_field(kind):
    field = SizeField(np.array([[0.0, 0.0], [0.6, 0.4]]), np.array([0.01, 0.015]), 0.2)
    mesh = panel_mesh(RECTANGLE, edge=0.05, sizes=field, quality=kind)
    assert_sound(mesh)
    pairs = np.unique(np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    a, b = mesh.vertices[pairs[:, 0]], mesh.vertices[pairs[:, 1]]
    ratio = np.hypot(*(b - a).T) / field.at((a + b) / 2, 0.05)
    assert 0.85 < np.median(ratio) < 1.15
    assert np.percentile(ratio, 99) < 1.7
    assert np.percentile(ratio, 1) > 0.6
    if kind != "fair":
        assert mesh.report.min_angle_deg >= 33


def test_size_field_has_bounded_gradation():
    rng = np.random.default_rng(0)
    field = SizeField(rng.random((9, 2)), rng.uniform(0.01, 0.05, 9), 0.3)
    a, b = rng.random((2, 500, 2))
    assert (np.abs(field.at(a, 0.1) - field.at(b, 0.1)) <= 0.3 * np.hypot(*(a - b).T) + 1e-15).all()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[]", "points: missing"),
        ('{"points": [[0, 0]]}', "shape"),
        ('{"points": [[0, 0, "a"]]}', "give numbers"),
        ('{"points": [[0, 0, -1]]}', "positive"),
        ('{"points": [[0, 0, 1e300]]}', "at most 1e"),
        ('{"points": [[1e300, 0, 0.1]]}', "at most 1e"),
        ('{"points": [[0, 0, 0.1]], "gradation": 2}', "gradation"),
        ('{"points": [[0, 0, 0.1]], "gradation": "x"}', "gradation"),
        ('{"points": [[0, 0, 0.1]], "extra": 2}', "extra"),
    ],
)
def test_bad_size_fields_are_named(tmp_path, text, message):
    path = tmp_path / "field.json"
    path.write_text(text)
    with pytest.raises(FileProblem, match=message):
        read_size_field(path)


def test_size_fields_beyond_measure_are_refused():
    with pytest.raises(OutlineError, match="below a 64th"):
        panel_mesh(RECTANGLE, edge=0.1, sizes=SizeField(np.zeros((1, 2)), np.array([1e-4])))
    with pytest.raises(OutlineError, match="points – give larger"):
        panel_mesh(RECTANGLE, edge=0.02, sizes=SizeField(np.full((1, 2), 0.5), np.array([5e-4]), 1e-4))


def test_sizes_above_the_edge_change_nothing_but_are_allowed():
    field = SizeField(np.full((1, 2), 0.5), np.array([0.4]))
    for kind in QUALITIES:
        mesh = panel_mesh(RECTANGLE, edge=0.1, sizes=field, quality=kind)
        assert_sound(mesh)
        lengths = np.hypot(*np.diff(mesh.vertices[mesh.faces[:, [0, 1, 2, 0]]], axis=1).reshape(-1, 2).T)
        assert 0.07 < np.median(lengths) < 0.13


def test_one_fine_spot_of_a_long_panel_is_reached_and_costs_no_lattice_over_all_of_it():
    """A hundred metres of cloth with edges of 4 mm at one place: 28 million candidates were there one lattice."""
    field = SizeField(np.array([[50.0, 0.0]]), np.array([0.004]), 0.2)
    strip = np.array([[0, 0], [100, 0], [100, 0.5], [0, 0.5]])
    mesh = panel_mesh(strip, edge=0.2, sizes=field, quality="fair")
    assert_sound(mesh)
    assert mesh.report.min_angle_deg >= 25
    rim = mesh.vertices[mesh.boundary[0]]
    steps = np.hypot(*(np.roll(rim, -1, axis=0) - rim).T)
    assert 0.003 < steps.min() < 0.006


def test_only_tiles_that_want_a_lattice_are_made():
    field = SizeField(np.array([[0.2, 0.2], [3.1, 0.4]]), np.array([0.011, 0.02]), 0.3)
    low, high, edge = np.zeros(2), np.array([4.0, 1.0]), 0.1
    for longest in (0.1, 0.05, 0.025, 0.0125):
        every, some = staggered_points(low, high, longest / 3), lattice_near(low, high, longest, edge, field)
        kept = []
        for points in (every, some):
            wanted = field.at(points, edge)
            points = points[(wanted <= longest) & (wanted > longest / 2)]
            kept.append(points[np.lexsort(points.T)])
        np.testing.assert_array_equal(*kept)
    assert len(some) < len(every) / 20


def test_a_good_size_field_is_read(tmp_path):
    path = tmp_path / "field.json"
    path.write_text(json.dumps({"points": [[0, 0, 0.01]], "gradation": 0.1}))
    assert read_size_field(path).at(np.array([[1.0, 0]]), 1.0)[0] == pytest.approx(0.11)


TOUCHING = {
    "a circle inside the border": ([0.1 * ROUND + (0.1, 0.35)], 1),
    "a side on the border": ([[[0.5, 0], [0.6, 0], [0.6, 0.1], [0.5, 0.1]]], 1),
    "two holes at a corner": (
        [[[0.3, 0.3], [0.4, 0.3], [0.4, 0.4]], [[0.4, 0.4], [0.5, 0.4], [0.5, 0.5]]],
        2,
    ),
}


@pytest.mark.parametrize("kind", QUALITIES)
@pytest.mark.parametrize("name", TOUCHING)
def test_holes_that_touch_are_merged_with_a_warning(name, kind):
    holes, loops = TOUCHING[name]
    with pytest.warns(OutlineWarning, match="hole 0.*merged"):
        mesh = panel_mesh(RECTANGLE, edge=0.04, holes=holes, quality=kind)
    assert_sound(mesh)
    assert len(mesh.boundary) == loops
    cloth = 0.7 - sum(
        abs(np.linalg.det(np.array([h[1], h[2]]) - h[0])) / 2 for h in map(np.array, holes) if len(h) == 3
    )
    if name == "two holes at a corner":
        assert clean_area(mesh) == pytest.approx(cloth, abs=0.001)


@pytest.mark.parametrize("kind", QUALITIES)
@pytest.mark.parametrize("name", TOUCHING)
def test_deviation_of_merged_holes_is_told_from_the_contours_given(name, kind):
    """The widening by 0.02 of the edge is one, and so is the mouth that a round hole gets where it touches."""
    mouth = np.sqrt(2 * 0.1 * 0.02 * 0.04) if "circle" in name else 0.0  # half of the chord that is cut off
    with pytest.warns(OutlineWarning, match="merged"):
        mesh = panel_mesh(RECTANGLE, edge=0.04, holes=TOUCHING[name][0], quality=kind)
    assert max(0.9 * mouth, 0.0007) < mesh.report.outline_deviation < max(1.1 * mouth, 0.0045)


@pytest.mark.parametrize("off", [0.0, 1e-10])
def test_a_hole_that_leaves_no_cloth_is_named(off):
    with pytest.raises(OutlineError, match="hole 0: leaves no cloth"):
        panel_mesh(RECTANGLE, edge=0.05, holes=[RECTANGLE - (0, off) * (RECTANGLE > 0)])


def clean_area(mesh) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    u, v = b - a, c - a
    return float(np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum() / 2)


def test_a_hole_that_cuts_the_panel_in_two_is_named():
    with pytest.raises(OutlineError, match="hole 0: cuts the panel"):
        panel_mesh(RECTANGLE, edge=0.05, holes=[[[0.5, 0], [0.6, 0], [0.6, 0.7], [0.5, 0.7]]])


@pytest.mark.parametrize("kind", QUALITIES)
@pytest.mark.parametrize("radius", [0.06, 0.1, 0.3])
def test_bends_are_followed_within_a_twentieth_of_the_edge(radius, kind):
    t = np.arange(400) * 2 * np.pi / 400
    circle = radius * np.column_stack([np.cos(t), np.sin(t)])
    mesh = panel_mesh(circle, edge=0.05, quality=kind)
    assert_sound(mesh)
    assert mesh.report.outline_deviation <= 0.05 * 0.05


def distance(a, b, c, d) -> float:
    """Between two segments that do not cross."""

    def to(p, a, b):
        t = np.clip(np.dot(p - a, b - a) / np.dot(b - a, b - a), 0, 1)
        return np.hypot(*(p - a - t * (b - a)))

    return min(to(a, c, d), to(b, c, d), to(c, a, b), to(d, a, b))


def feature_size(polygon) -> float:
    """Shortest side, or distance of sides that are no neighbours."""
    n = len(polygon)
    least = np.hypot(*(polygon - np.roll(polygon, 1, axis=0)).T).min()
    for i in range(n):
        for j in range(i + 2, n):
            if (j + 1) % n != i:
                least = min(
                    least, distance(polygon[i], polygon[(i + 1) % n], polygon[j], polygon[(j + 1) % n])
                )
    return float(least)


def wide_cornered(seed: int):
    """A random polygon with corners of at least 60 degrees, and an edge of at most half its feature size."""
    rng = np.random.default_rng(seed)
    while True:
        count = int(rng.integers(3, 12))
        t, r = np.sort(rng.random(count)) * 2 * np.pi, rng.uniform(0.4, 1, count)
        try:
            polygon = clean_contours(np.column_stack([r * np.cos(t), r * np.sin(t)]), ())[0]
        except OutlineError:
            continue
        size = feature_size(polygon)
        if sharpest_corner([polygon]) >= 60 and size > 0.05:
            return polygon, max(size / rng.uniform(2, 8), 0.015)


@pytest.mark.parametrize("block", range(4))
def test_best_keeps_every_angle_above_38_degrees_where_corners_are_wide(block):
    for seed in range(25 * block, 25 * block + 25):
        polygon, edge = wide_cornered(seed)
        mesh = panel_mesh(polygon, edge=edge, quality="best")
        assert_sound(mesh)
        assert mesh.report.min_angle_deg >= 38, seed


def test_best_beats_fair_in_mean_quality():
    fair, best = (panel_mesh(RECTANGLE, edge=0.02, quality=kind) for kind in ("fair", "best"))
    assert quality(best.vertices, best.faces).shape.mean() > quality(fair.vertices, fair.faces).shape.mean()


def arc(radius: float, begin: float, end: float, count: int) -> np.ndarray:
    t = np.linspace(begin, end, count)
    return radius * np.column_stack([np.cos(t), np.sin(t)])


@pytest.mark.parametrize("kind", QUALITIES)
@pytest.mark.parametrize("gap", by_day([1e-5], [1e-4, 1e-5]))
def test_a_line_close_under_bends_far_from_the_origin_is_followed(gap, kind):
    """Given points and samples fall together but for rounding there."""
    outer = arc(1, 0, 2 * np.pi, 151)[:-1]
    hole = (1 - gap) * outer[::-1]
    mesh = panel_mesh(outer + 1e3, edge=0.1, holes=[hole + 1e3], quality=kind)
    assert_sound(mesh)
    line = arc((1 - gap) * np.cos(np.pi / 150), 0.3, 3, 150)
    assert_sound(panel_mesh(outer + 1e3, edge=0.03, constraints=[line + 1e3], quality=kind))


@pytest.mark.parametrize("kind", QUALITIES)
@pytest.mark.parametrize("gap", by_day([1e-6], [1e-4, 1e-5, 1e-6]))
def test_bends_that_nearly_touch_do_not_cross_once_sampled(gap, kind):
    """Nearer to each other than sampling may leave them: there the given points are taken."""
    outer = arc(1, 0, 2 * np.pi, 301)[:-1]
    moved = (0.1, -0.2)  # so that samples of both do not fall side by side
    hole = 0.5 * arc(1, 0.1, 2 * np.pi + 0.1, 251)[:-1]
    hole += (1 - 0.5 - gap - 1e-4, 0)
    mesh = panel_mesh(outer + moved, edge=0.3, holes=[hole + moved], quality=kind)
    assert_sound(mesh)
    assert len(mesh.boundary) == 2
    line = arc(1 - gap - 2e-4, 0.4, 2.9, 700)
    mesh = panel_mesh(outer + moved, edge=0.3, constraints=[line + moved], quality=kind)
    assert_sound(mesh)
    sleeve = np.vstack([arc(1, 0, 4, 90), arc(1 - 7e-4 - gap, 4, 0, 90)])
    mesh = panel_mesh(sleeve, edge=0.3, quality=kind)
    assert_sound(mesh)
