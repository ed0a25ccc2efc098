"""Shapes that grow: the work stays in proportion, the meshes stay exact, and sizes grade away from what is small."""

import numpy as np
import pytest
from exact_delaunay import delaunay_faults
from growing_shapes import SHAPES, small_holes
from mesh_polygons import random_panel

from sim_core.mesh import SizeField, panel_mesh, triangulate
from sim_core.mesh.geometry import nearest_others, size_boxes
from sim_core.mesh.improvement import refinement, small_angles
from sim_core.mesh.measures import deviation, mesh_fault, quality
from sim_core.mesh.outline import clean_contours, crossed_steps, first_crossing, sampled_rim
from sim_core.mesh.triangulation import PATIENCE, grow_points, inner_faces, joined_points

UPRIGHT = (1.0, -1.0)


def steps_of(contours) -> np.ndarray:
    first = np.cumsum([0, *(len(c) for c in contours)])
    return np.concatenate(
        [
            np.column_stack([np.arange(len(c)), np.roll(np.arange(len(c)), -1)]) + k
            for c, k in zip(contours, first, strict=False)
        ]
    )


def outline_of(mesh) -> np.ndarray:
    return np.concatenate([np.column_stack([loop, np.roll(loop, -1)]) for loop in mesh.boundary])


def canonical(faces) -> set:
    return {tuple(np.roll(face, -int(face.argmin())).tolist()) for face in np.asarray(faces)}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("count", [100, 1000, 10_000])
def test_growth_looks_at_a_bounded_number_of_points(shape, count):
    """Ten thousand points of a star: 10^8 if every search looked at every point."""
    outline, holes, _ = SHAPES[shape](count)
    contours = clean_contours(outline, holes)
    points, steps = np.concatenate(contours) * UPRIGHT, steps_of(contours)
    grown = grow_points(points, steps)
    assert grown.status == 0
    assert len(grown.faces) == len(points) - 2 + 2 * len(holes)
    assert grown.work <= 3 * PATIENCE * (len(points) + 64)


@pytest.mark.parametrize("shape", SHAPES)
def test_points_that_are_handed_over_make_the_same_triangles(shape):
    outline, holes, edge = SHAPES[shape](300)
    contours = sampled_rim(clean_contours(outline, holes), edge).contours
    rng = np.random.default_rng(3)
    points = np.concatenate(contours) + rng.normal(0, 1e-7, (sum(map(len, contours)), 2))  # no ties
    steps = steps_of(contours)
    flips, lost = joined_points(points * UPRIGHT, steps)
    assert lost == -1
    faces = inner_faces(flips)
    assert delaunay_faults(points, faces, steps) == []
    order = rng.permutation(len(points))
    place = np.argsort(order)
    other, _ = joined_points(points[order] * UPRIGHT, place[steps])
    assert canonical(order[inner_faces(other)]) == canonical(faces)


def test_growth_and_what_it_hands_over_to_agree():
    rng = np.random.default_rng(8)
    cloud = rng.random((3000, 2)) ** 9  # crowded into a corner
    patient = triangulate(cloud)
    grown = grow_points(cloud * UPRIGHT, None)
    assert grown.handed_over
    assert delaunay_faults(cloud, patient) == []
    even = rng.random((3000, 2))
    faces = grow_points(even * UPRIGHT, None)
    assert not faces.handed_over
    hull = steps_on_hull(faces.faces, len(even))
    assert canonical(inner_faces(joined_points(even * UPRIGHT, hull)[0])) == canonical(faces.faces)


def steps_on_hull(faces, count) -> np.ndarray:
    ahead = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    return ahead[~np.isin(ahead @ (count, 1), ahead[:, ::-1] @ (count, 1))]


def test_a_seed_through_a_point_is_told():
    square = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2], [1, 1]])
    steps = [[0, 1], [1, 2], [2, 3], [3, 0]]
    assert joined_points(square, np.array(steps))[1] == -1
    assert joined_points(square, np.array([*steps, [0, 2], [2, 0]]))[1] in (0, 2)
    assert joined_points(square[:4], np.array([*steps, [0, 2], [2, 0], [1, 3], [3, 1]]))[1] >= 0


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("kind", ["fair", "best"])
def test_growing_shapes_are_meshed_exactly(shape, kind):
    outline, holes, edge = SHAPES[shape](400)
    mesh = panel_mesh(outline, holes=holes, edge=edge, quality=kind)
    assert mesh_fault(mesh.vertices, mesh.faces, mesh.boundary) is None
    assert delaunay_faults(mesh.vertices, mesh.faces, outline_of(mesh)) == []
    assert mesh.report.outline_deviation <= 0.045 * edge


@pytest.mark.nightly
def test_a_star_of_ten_thousand_points_is_meshed():
    outline, _, edge = SHAPES["star"](10_000)
    mesh = panel_mesh(outline, edge=edge, quality="best")
    assert mesh.report.conformity == 1
    assert mesh.report.area_error <= 1e-12
    assert len(mesh.vertices) < 71_000  # seven steps a side: a gap of a hair is no reason for finer ones


@pytest.mark.parametrize("shape", ["comb", "spiral", "cluster"])
def test_no_angle_below_30_is_left_that_the_outline_allows(shape):
    outline, holes, edge = SHAPES[shape](200)
    mesh = panel_mesh(outline, holes=holes, edge=edge, quality="best")
    assert not small_angles(mesh.vertices, mesh.faces, outline_of(mesh)).any()


def test_sizes_grade_away_from_small_holes():
    """Holes of 2 mm at edges of 50 mm: some 34 points a hole, where Triangle with a bound of 30 degrees takes 33."""
    outline, holes, edge = small_holes(100)
    mesh = panel_mesh(outline, holes=holes, edge=edge, quality="best")
    assert mesh.report.min_angle_deg >= 30
    assert len(mesh.vertices) < 40 * len(holes)
    assert mesh_fault(mesh.vertices, mesh.faces, mesh.boundary) is None
    assert mesh.report.outline_deviation < 0.045 * edge
    again = panel_mesh(outline, holes=holes, edge=edge, quality="best")
    assert np.array_equal(again.vertices, mesh.vertices)


NARROW = {
    "a side of a millionth of the edge": 180,
    "two of them, beside other small angles": 381,
    "corners that nearly meet": 385,
    "strips": (455, 534, 550, 606, 678),  # up to fourteen thousand times longer than wide
}


@pytest.mark.parametrize("name", NARROW)
def test_short_sides_and_strips_get_the_points_they_need(name):
    for seed in np.atleast_1d(NARROW[name]).tolist():
        outline, holes, edge, _ = random_panel(seed)
        mesh = panel_mesh(outline, holes=holes, edge=edge, quality="best")
        assert mesh_fault(mesh.vertices, mesh.faces, mesh.boundary) is None
        assert not small_angles(mesh.vertices, mesh.faces, outline_of(mesh)).any(), seed
        assert len(mesh.vertices) < 25_000


def test_a_slit_that_would_need_hundreds_of_thousands_of_points_stays():
    """Cloth between two teeth of a hole: 0.7 edges long, 2.6e-6 edges wide where it is widest."""
    outline, holes, edge, _ = random_panel(621)
    mesh = panel_mesh(outline, holes=holes, edge=edge, quality="best")
    assert mesh_fault(mesh.vertices, mesh.faces, mesh.boundary) is None
    small = small_angles(mesh.vertices, mesh.faces, outline_of(mesh))
    sides = mesh.vertices[mesh.faces[small]]
    assert (np.hypot(*(sides - np.roll(sides, 1, axis=1)).transpose(2, 0, 1)).min(axis=1) < 3e-6 * edge).all()
    assert small.sum() <= 5


def test_refinement_takes_room_as_it_needs_it(monkeypatch):
    """Room for all points that may be put in was 2 GB for a small hole in a panel of a million points."""
    rooms = []

    def watched(places, steps, room):
        rooms.append(room)
        return joined_points(places, steps, room)

    monkeypatch.setattr(refinement, "joined_points", watched)
    outline, holes, edge = small_holes(100)
    panel_mesh(outline, holes=holes, edge=edge, quality="best")
    assert 0 < max(rooms) <= 4096


def test_sharp_corners_keep_their_own_angle_and_no_more():
    outline = np.array([[0.0, 0], [1, 0], [1, 0.1]])  # 5.7 degrees at one corner
    mesh = panel_mesh(outline, edge=0.1, quality="best")
    small = quality(mesh.vertices, mesh.faces).min_angle < 30
    assert small.any()
    assert not small_angles(mesh.vertices, mesh.faces, outline_of(mesh)).any()
    assert (mesh.vertices[mesh.faces[small]] == 0).all(axis=2).any(axis=1).all()  # all at that corner


def test_inner_lines_and_fields_are_divided_too():
    """A fold that nearly meets another, and a field that leaves small edges beside large ones."""
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    lines = [[[0.2, 0.2], [0.8, 0.2]], [[0.2, 0.203], [0.8, 0.21]]]
    field = SizeField(np.array([[0.5, 0.9]]), np.array([0.01]), 0.9)
    for sizes in (None, field):
        mesh = panel_mesh(square, edge=0.1, constraints=lines, sizes=sizes, quality="best")
        both = [np.column_stack([line[:-1], line[1:]]) for line in mesh.lines]
        fixed = np.concatenate([outline_of(mesh), *both])
        assert mesh_fault(mesh.vertices, mesh.faces, mesh.boundary, mesh.lines) is None
        assert not small_angles(mesh.vertices, mesh.faces, fixed).any()


def test_contours_that_are_sampled_already_stay_as_they_are():
    outline = np.array([[0.0, 0], [0.5, 0], [0.51, 0], [1, 0], [1, 1], [0, 1]])
    mesh = panel_mesh(outline, edge=0.5, sampled=True, quality="best")
    assert len(mesh.boundary[0]) == len(outline)


def brute_crossings(lines) -> np.ndarray:
    """Pairs (k, 2) of steps that meet without a common end, by trying all."""
    from shapely import LineString

    steps = [LineString(line[k : k + 2]) for line in lines for k in range(len(line) - 1)]
    ends = [{tuple(p) for p in line[k : k + 2].tolist()} for line in lines for k in range(len(line) - 1)]
    return np.array(
        [
            (i, j)
            for i in range(len(steps))
            for j in range(i)
            if not ends[i] & ends[j] and steps[i].intersects(steps[j])
        ]
    ).reshape(-1, 2)


@pytest.mark.parametrize("seed", range(40))
def test_the_sweep_finds_crossings_and_leaves_none(seed):
    rng = np.random.default_rng(seed)
    ends = (
        rng.integers(0, 9, (int(rng.integers(2, 14)), 2, 2)) * 1.0
    )  # on a lattice: touching, vertical, in one line
    ends = ends[(ends[:, 0] != ends[:, 1]).any(axis=1)]
    pairs = brute_crossings(ends)
    marked = np.concatenate(crossed_steps(list(ends)))
    assert np.isin(np.flatnonzero(marked), pairs).all()
    assert marked[pairs].any(axis=1).all() if len(pairs) else not marked.any()


@pytest.mark.parametrize("seed", range(40))
def test_the_sweep_tells_simple_polygons(seed):
    from shapely import Polygon

    rng = np.random.default_rng(seed)
    points = rng.integers(0, 12, (int(rng.integers(3, 9)), 2)) * 1.0
    _, first = np.unique(points, axis=0, return_index=True)
    points = points[np.sort(first)]
    if len(points) < 3:
        points = np.array([[0.0, 0], [1, 0], [0, 1]])
    found = first_crossing(points, np.roll(np.arange(len(points)), -1))
    assert (found == (-1, -1)) == Polygon(points).is_valid


@pytest.mark.parametrize("seed", range(20))
def test_the_nearest_of_others_is_found(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 300))
    points = rng.integers(0, 20, (count, 2)) / 20 if seed % 2 else rng.random((count, 2)) ** 5
    places, reach = rng.random((50, 2)), rng.random(50) * 0.3
    known = points[rng.integers(0, count, (50, 4))]
    boxes = size_boxes(points, np.zeros(count))
    found = nearest_others(places, reach, known, boxes.points, boxes.boxes, boxes.first)
    away = np.hypot(*(boxes.points - places[:, None]).transpose(2, 0, 1))
    away[(boxes.points == known[:, :, None]).all(axis=3).any(axis=1)] = np.inf
    least = away.min(axis=1)
    assert ((found >= 0) == (least < reach)).all()
    assert (away[np.arange(50), found] == least)[found >= 0].all()


@pytest.mark.parametrize("shape", SHAPES)
def test_the_deviation_is_the_hausdorff_distance(shape):
    from shapely import LinearRing, Point

    outline, holes, edge = SHAPES[shape](200)
    contours = clean_contours(outline, holes)
    loops = sampled_rim(contours, edge).contours
    worst = 0.0
    for one, other in [*zip(contours, loops, strict=True), *zip(loops, contours, strict=True)]:
        probes = np.concatenate([one, (one + np.roll(one, -1, axis=0)) / 2])
        line = LinearRing(other)
        worst = max(worst, max(line.distance(Point(probe)) for probe in probes))
    assert deviation(contours, loops) == pytest.approx(worst, abs=1e-12)
