"""Which vertices stay: angle defects, the published decimation, quadrics, and the two to compare with."""

import numpy as np
import pytest
import trimesh

from sim_core.cloth.scenes import equilateral_sheet
from sim_core.errors import SimCoreError
from sim_core.learn.pooling import (
    Pooled,
    angle_defects,
    collapse,
    decimate,
    farthest_points,
    gauss_curvature,
    mean_absolute_curvature,
    random_points,
)
from sim_core.mesh import triangle_areas
from sim_core.metrics import surface_distance

PINS = (45, 77)


def sheet() -> tuple[np.ndarray, np.ndarray]:
    return equilateral_sheet(0.5, 0.4, 0.025)


def lifted(rest: np.ndarray, height: np.ndarray) -> np.ndarray:
    return np.column_stack([rest[:, 0], height, rest[:, 1]])


def bump(rest: np.ndarray, phase: float = 0.0) -> np.ndarray:
    """Flat but for a bump in the left half."""
    away = ((rest - [0.12, 0.2]) ** 2).sum(1)
    return lifted(rest, (0.04 + 0.01 * np.sin(phase)) * np.exp(-away / 0.002))


def frames(rest: np.ndarray, count: int = 3) -> np.ndarray:
    return np.array([bump(rest, phase) for phase in range(count)])


def border(rest: np.ndarray) -> np.ndarray:
    """Vertices on the sides of the rectangle."""
    low, high = rest.min(0), rest.max(0)
    return np.flatnonzero((np.isclose(rest, low) | np.isclose(rest, high)).any(1))


def holed() -> tuple[np.ndarray, np.ndarray]:
    """The sheet without the faces round two vertices far from each other: two holes."""
    rest, faces = sheet()
    inner = [int(np.argmin(((rest - spot) ** 2).sum(1))) for spot in ([0.15, 0.2], [0.35, 0.2])]
    faces = faces[~np.isin(faces, inner).any(1)]
    used, index = np.unique(faces, return_inverse=True)
    return rest[used], index.reshape(-1, 3)


def valid(pooled: Pooled, rest: np.ndarray, faces: np.ndarray) -> None:
    """The coarse triangles cover what the fine ones do, none of them turned over, and use every vertex."""
    fine, coarse = triangle_areas(rest, faces), triangle_areas(rest[pooled.kept], pooled.faces)
    assert (np.sign(coarse) == np.sign(fine[0])).all()
    assert coarse.sum() == pytest.approx(fine.sum(), rel=1e-9)
    assert np.array_equal(np.unique(pooled.faces), np.arange(len(pooled.kept)))
    assert pooled.kept.dtype == np.int64
    assert pooled.faces.dtype == np.int32
    assert (np.diff(pooled.kept) > 0).all()
    assert pooled.share == len(pooled.kept) / len(rest)


def neighbours(faces: np.ndarray) -> dict[int, set[int]]:
    found: dict[int, set[int]] = {}
    for a, b, c in faces.tolist():
        for one, others in ((a, (b, c)), (b, (c, a)), (c, (a, b))):
            found.setdefault(one, set()).update(others)
    return found


@pytest.mark.parametrize(("holes", "euler"), [(0, 1), (2, -1)])
def test_angle_defects_of_a_sheet_are_its_euler_characteristic(holes, euler):
    rest, faces = holed() if holes else sheet()
    rough = lifted(rest, 0.02 * np.random.default_rng(3).normal(size=len(rest)))
    assert angle_defects(rough, faces).sum() == pytest.approx(2 * np.pi * euler, abs=1e-9)


def test_angle_defects_of_closed_and_pinched_meshes():
    ball = trimesh.creation.icosphere(subdivisions=2)
    ring = trimesh.creation.torus(1.0, 0.3)
    assert angle_defects(ball.vertices, ball.faces).sum() == pytest.approx(4 * np.pi, abs=1e-9)
    assert angle_defects(ring.vertices, ring.faces).sum() == pytest.approx(0.0, abs=1e-9)
    bow = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [-1, 0, 0], [-1, -1, 1.0]])
    assert angle_defects(bow, np.array([[0, 1, 2], [0, 3, 4]])).sum() == pytest.approx(2 * np.pi, abs=1e-9)


def test_gauss_curvature_of_a_ball_and_of_a_developable_wave():
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.5)
    assert np.median(gauss_curvature(ball.vertices, ball.faces)) == pytest.approx(4.0, rel=0.02)
    rest, faces = sheet()
    inner = np.setdiff1d(np.arange(len(rest)), border(rest))
    assert np.abs(angle_defects(lifted(rest, 0 * rest[:, 0]), faces)[inner]).max() < 1e-12
    bent = np.column_stack([rest[:, 0], 0.1 * np.sin(rest[:, 1] / 0.1), 0.1 * np.cos(rest[:, 1] / 0.1)])
    assert (
        np.abs(gauss_curvature(bent, faces)[inner]).max() < 0.1
    )  # 1 / m2, where the bump below has hundreds
    assert mean_absolute_curvature(iter(frames(rest)), faces)[inner].max() > 100


def test_decimation_leaves_less_than_its_share_and_takes_what_is_flat():
    rest, faces = sheet()
    curvature = mean_absolute_curvature(frames(rest), faces)
    pooled = decimate(rest, faces, curvature, pins=PINS)
    assert 0.6 * len(rest) - 1 <= len(pooled.kept) < 0.6 * len(rest)
    valid(pooled, rest, faces)
    kept = set(pooled.kept.tolist())
    assert kept.issuperset(border(rest).tolist())
    assert kept.issuperset(PINS)
    near = neighbours(faces)
    assert all(near[gone] & kept for gone in set(range(len(rest))) - kept)
    again = decimate(rest, faces, curvature, pins=PINS)
    assert np.array_equal(pooled.kept, again.kept)
    assert np.array_equal(pooled.faces, again.faces)
    bent = ((rest - [0.12, 0.2]) ** 2).sum(1) < 0.05**2
    flat = ((rest - [0.35, 0.2]) ** 2).sum(1) < 0.1**2
    stays = np.isin(np.arange(len(rest)), pooled.kept)
    assert stays[bent].mean() > stays[flat].mean() + 0.2
    spared = decimate(rest, faces, curvature, part=0.05).kept
    assert np.isin(np.flatnonzero(bent), spared).mean() > 0.95


def test_decimation_goes_on_below_what_neighbours_allow():
    rest, faces = equilateral_sheet(1.0, 1.0, 0.03)
    pooled = decimate(rest, faces, np.zeros(len(rest)), 0.18)
    assert 0.17 < pooled.share < 0.18
    valid(pooled, rest, faces)


def test_quadrics_keep_a_crease_that_curvature_does_not_see():
    rest, faces = sheet()
    sides = border(rest)
    crease = np.abs(rest[:, 0] - 0.2375) + 0.3 * np.maximum(rest[:, 0] - 0.35, 0)
    folds = np.array([lifted(rest, slope * crease) for slope in (0.5, 1.0)])
    pooled = collapse(rest, faces, folds, 0.4, pins=PINS)
    valid(pooled, rest, faces)
    assert set(pooled.kept.tolist()) >= {*sides.tolist(), *PINS}
    assert len(pooled.kept) == np.ceil(0.4 * len(rest)) - 1

    def error(one: Pooled) -> float:
        return float(surface_distance(folds[1], folds[1][one.kept], one.faces).max())

    assert error(pooled) < 0.3 * error(random_points(rest, faces, 0.4, 5, pins=PINS))
    again = collapse(rest, faces, folds, 0.4, pins=PINS)
    assert np.array_equal(pooled.kept, again.kept)
    assert np.array_equal(pooled.faces, again.faces)


def test_quadrics_are_summed_over_frames():
    rest, faces = sheet()
    left, right = (
        lifted(rest, np.maximum(0.0, s * (rest[:, 0] - x))) for s, x in ((-1.0, 0.15), (1.0, 0.35))
    )
    both = collapse(rest, faces, np.array([left, right]), 0.35)
    alone = collapse(rest, faces, np.array([left, left]), 0.35)

    def error(one: Pooled, frame: np.ndarray) -> float:
        return float(surface_distance(frame, frame[one.kept], one.faces).max())

    assert max(error(both, left), error(both, right)) < 0.5 * error(alone, right)


def test_quadrics_without_the_border_keep_corners_and_penalty_keeps_what_is_curved():
    rest, faces = sheet()
    pooled = collapse(rest, faces, frames(rest), 0.2, border=False)
    valid(pooled, rest, faces)
    kept = np.isin(border(rest), pooled.kept)
    assert 4 <= kept.sum() < len(kept)
    bent = np.flatnonzero(((rest - [0.12, 0.2]) ** 2).sum(1) < 0.05**2)
    wavy = frames(rest) + lifted(0 * rest, 0.002 * np.sin(150 * rest[:, 0]))
    plain, heavy = (collapse(rest, faces, wavy, 0.5, penalty=p) for p in (0.0, 100.0))
    assert np.isin(bent, heavy.kept).sum() > np.isin(bent, plain.kept).sum()


def test_selections_to_compare_with():
    rest, faces = sheet()
    drawn = random_points(rest, faces, 0.5, 7, pins=PINS)
    valid(drawn, rest, faces)
    assert np.array_equal(drawn.kept, random_points(rest, faces, 0.5, 7, pins=PINS).kept)
    assert not np.array_equal(drawn.kept, random_points(rest, faces, 0.5, 8, pins=PINS).kept)
    even = farthest_points(rest, faces, 0.25)
    valid(even, rest, faces)
    free = farthest_points(rest, faces, 0.1, border=False)
    places = rest[free.kept]
    apart = np.sqrt(((places[:, None] - places) ** 2).sum(2)) + np.eye(len(places))
    reach = np.sqrt(((rest[:, None] - places) ** 2).sum(2)).min(1).max()
    assert reach <= apart.min() + 1e-12  # what farthest points are: none could be added at a greater distance


def test_a_pooled_sheet_keeps_its_holes():
    rest, faces = holed()
    flat = lifted(rest, 0 * rest[:, 0])
    valid(decimate(rest, faces, np.zeros(len(rest))), rest, faces)
    valid(collapse(rest, faces, flat[None], 0.5), rest, faces)
    valid(random_points(rest, faces, 0.5, 1), rest, faces)


def test_pooling_refuses():
    rest, faces = sheet()
    with pytest.raises(SimCoreError, match=r"^share: 0.1 of 390 vertices – border and pins alone are 76;"):
        decimate(rest, faces, np.zeros(len(rest)), 0.1)
    with pytest.raises(SimCoreError, match="^share: 1.5 "):
        random_points(rest, faces, 1.5, 0)
    with pytest.raises(SimCoreError, match="^pins: index 9999"):
        farthest_points(rest, faces, 0.5, pins=[9999])
    with pytest.raises(SimCoreError, match="^frames: shape"):
        collapse(rest, faces, np.zeros((2, 3, 3)))
    with pytest.raises(SimCoreError, match="^frames: coordinates"):
        collapse(rest, faces, np.full((1, len(rest), 3), np.nan))
    with pytest.raises(SimCoreError, match="^frames: there are none"):
        mean_absolute_curvature([], faces)
    with pytest.raises(SimCoreError, match="^curvature: shape"):
        decimate(rest, faces, np.zeros(3))
    with pytest.raises(SimCoreError, match="meets itself at vertex"):
        random_points(rest[:5], np.array([[0, 1, 2], [0, 2, 1], [0, 1, 3]]), 1.0, 0)
