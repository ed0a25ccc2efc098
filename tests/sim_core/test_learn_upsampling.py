"""Fine vertices from coarse ones: exact on affine maps, smooth between, and blind to how the cloth is turned."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sim_core.cloth.scenes import equilateral_sheet
from sim_core.errors import SimCoreError
from sim_core.learn.pooling import farthest_points, random_points
from sim_core.learn.upsampling import LocalFramesFit, biharmonic, linear, squared_laplacian, tangent_frames

FINE = equilateral_sheet(0.5, 0.4, 0.025)
OTHER = equilateral_sheet(0.5, 0.4, 0.06)
AFFINE = np.array([[0.3, -1.2, 0.4], [0.9, 0.2, -0.5]])


def wave(rest: np.ndarray, phase: float = 0.0) -> np.ndarray:
    x, y = rest.T
    return np.column_stack([x, 0.03 * np.sin(14 * x + 5 * y + phase), y + 0.004 * np.cos(9 * x - phase)])


def moved(places: np.ndarray) -> np.ndarray:
    return Rotation.from_rotvec([0.7, -1.9, 0.4]).apply(places) + [3.0, -1.0, 7.0]


def coarse_meshes():
    """Rest, faces and constraints: kept vertices with the border, without it, and a mesh of its own."""
    rest, faces = FINE
    found = []
    for border in (True, False):
        pooled = farthest_points(rest, faces, 0.3, border=border)
        found.append((rest[pooled.kept], pooled.faces, pooled.kept))
    found.append((*OTHER, linear(rest, faces, OTHER[0])))
    return found


@pytest.mark.parametrize("case", [0, 1, 2])
def test_upsampling_is_exact_on_affine_maps(case):
    rest, faces = FINE
    flat, joined, constraints = coarse_meshes()[case]
    matrices = [biharmonic(rest, faces, constraints, cut=cut).matrix for cut in (0.0, 1e-4, 1e-2)]
    if case != 1:  # a coarse mesh without the border does not reach every fine vertex
        matrices.append(linear(flat, joined, rest))
    for matrix in matrices:
        assert matrix.shape == (len(rest), len(flat))
        assert matrix.dtype == np.float64
        assert np.abs(matrix @ (flat @ AFFINE + [5.0, 0, 1]) - (rest @ AFFINE + [5.0, 0, 1])).max() < 1e-9


def test_linear_weights_are_barycentric_and_points_outside_are_taken_to_the_border():
    rest, faces = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]), np.array([[0, 1, 2], [0, 2, 3]])
    made = linear(rest, faces, np.array([[0.5, 0.25], [1.0, 1.0], [2.0, 0.5], [-1e-17, 0.5]])).toarray()
    assert made == pytest.approx(
        np.array([[0.5, 0.25, 0.25, 0], [0, 0, 1, 0], [0, 0.5, 0.5, 0], [0.5, 0, 0, 0.5]]), abs=1e-12
    )
    turned = linear(rest, faces[:, ::-1], np.array([[0.5, 0.25]])).toarray()[0]
    assert turned == pytest.approx(made[0], abs=1e-12)


def test_linear_finds_the_face_of_every_point():
    rest, faces = FINE
    flat, joined, _ = coarse_meshes()[2]
    points = np.random.default_rng(2).uniform([0, 0], [0.5, 0.4], (200, 2)) + rest.min(0)
    matrix = linear(flat, joined, points)
    assert matrix.data.min() >= 0
    corners = {frozenset(face) for face in joined.tolist()}
    for row in range(len(points)):
        own = set(matrix.indices[matrix.indptr[row] : matrix.indptr[row + 1]].tolist())
        assert any(own <= face for face in corners)


def test_biharmonic_goes_through_what_is_kept_and_beats_linear_on_a_wave():
    rest, faces = FINE
    for flat, joined, constraints in coarse_meshes():
        made = biharmonic(rest, faces, constraints)
        smooth = np.linalg.norm(made.matrix @ wave(flat) - wave(rest), axis=1)
        straight = np.linalg.norm(linear(flat, joined, rest) @ wave(flat) - wave(rest), axis=1)
        assert smooth.mean() < 0.4 * straight.mean()
        assert smooth.max() < 0.012  # the border does not swing where it is not held
        if isinstance(constraints, np.ndarray):
            assert smooth[constraints].max() == 0.0
        else:
            assert np.abs(constraints @ (made.matrix @ wave(flat)) - wave(flat)).max() < 1e-4


def test_biharmonic_cut_is_told():
    rest, faces = FINE
    flat, _, constraints = coarse_meshes()[2]
    dense, thin = (biharmonic(rest, faces, constraints, cut=cut) for cut in (0.0, 1e-3))
    assert dense.cut < 1e-8 < thin.cut
    assert thin.matrix.nnz < 0.7 * dense.matrix.nnz
    moved_by = np.abs(thin.matrix @ wave(flat) - dense.matrix @ wave(flat)).max()
    assert 1e-7 < moved_by < thin.cut * 0.035  # no coarse vertex is further from the flat sheet


def test_biharmonic_solves_its_equations():
    """A strip held by two rows at each end bends as a beam does: a cubic comes back."""
    rest, faces = equilateral_sheet(0.2, 1.0, 0.05)
    held = np.flatnonzero((rest[:, 1] - rest[:, 1].min() < 0.05) | (rest[:, 1].max() - rest[:, 1] < 0.05))
    y = rest[:, 1] - rest[:, 1].min()
    cubic = y**3 - 1.4 * y**2
    made = biharmonic(rest, faces, held, cut=0.0).matrix @ cubic[held]
    assert np.abs(made - cubic).max() < 0.02 * np.ptp(cubic)


def test_squared_laplacian_of_a_bowl_a_saddle_and_a_plane():
    for size in (1.0, 7.0):
        rest, faces = equilateral_sheet(size, size, 0.02 * size)
        energy = squared_laplacian(rest, faces)
        bowl = 0.5 * (rest**2).sum(1)  # its Laplacian is 2
        assert bowl @ energy @ bowl == pytest.approx(4 * size**2, rel=0.05)
        saddle = rest.prod(1)
        assert saddle @ energy @ saddle == pytest.approx(8 * size**2, rel=0.05)
        plane = rest @ [3.0, -2.0] + 1.0
        assert np.abs(energy @ plane).max() < 1e-9 * np.abs(energy @ bowl).max()


def test_local_frames_learn_eight_frames_by_heart():
    fit, coarse, fine, base = learned()
    fit.add(coarse[:8], fine[:8])
    model = fit.solve(1e-10)
    assert (
        max(np.abs(base @ place - truth).max() for place, truth in zip(coarse[:8], fine[:8], strict=True))
        > 1e-4
    )
    for place, truth in zip(coarse[:8], fine[:8], strict=True):
        assert np.abs(model.predict(place) - truth).max() < 1e-6


def learned(case: int = 2):
    """A fit without frames yet, forty frames of a travelling wave, coarse and fine, and the base."""
    rest, faces = FINE
    flat, joined, constraints = coarse_meshes()[case]
    base = biharmonic(rest, faces, constraints).matrix
    fit = LocalFramesFit(flat, joined, rest, base)
    coarse = np.array([wave(flat, phase) for phase in np.linspace(0, 6, 40)])
    fine = np.array([wave(rest, phase) for phase in np.linspace(0, 6, 40)])
    return fit, coarse, fine, base


def test_local_frames_learn_what_the_base_leaves():
    fit, coarse, fine, base = learned()
    fit.add(coarse[::2], fine[::2])
    model = fit.solve(1e-6)
    for place, truth in zip(coarse[1:-1:2], fine[1:-1:2], strict=True):
        assert np.abs(model.predict(place) - truth).max() < 0.2 * np.abs(base @ place - truth).max()
    heavy = fit.solve(1e6)
    assert np.abs(heavy.weights).max() < 1e-3 * np.abs(model.weights).max()


@pytest.mark.parametrize("case", [0, 2])
def test_local_frames_turn_with_the_cloth(case):
    fit, coarse, fine, base = learned(case)
    fit.add(coarse, fine)
    model = fit.solve()
    place = wave(coarse_meshes()[case][0], 0.77)
    assert np.abs(model.predict(place) - base @ place).max() > 1e-5  # there is something to turn
    assert np.abs(model.predict(moved(place)) - moved(model.predict(place))).max() < 1e-7  # 1e-4 mm


def test_local_frames_are_least_squares_with_a_constant():
    """Against numpy, vertex by vertex: fewer neighbours than frames, and hardly any ridge."""
    rest, faces = FINE
    flat, joined, constraints = coarse_meshes()[2]
    _, coarse, fine, base = learned()
    fit = LocalFramesFit(flat, joined, rest, base, neighbours=4)
    fit.add(coarse, fine)
    model = fit.solve(1e-12)
    turns = [model.frames.of(place) for place in coarse]
    told = [model.predict(place) for place in coarse]
    for vertex in (33, 150, 301):
        own = model.anchor[vertex]
        assert own == np.argmin(((flat - rest[vertex]) ** 2).sum(1))
        around = [
            (p[model.near[own, 1:]] - p[own]) @ turn[own] for p, turn in zip(coarse, turns, strict=True)
        ]
        known = np.column_stack([np.reshape(around, (len(coarse), -1)), np.ones(len(coarse))])
        left = [(f - base @ p)[vertex] @ turn[own] for f, p, turn in zip(fine, coarse, turns, strict=True)]
        fitted = known @ np.linalg.lstsq(known, np.array(left), rcond=None)[0]
        given = [(t - base @ p)[vertex] @ turn[own] for t, p, turn in zip(told, coarse, turns, strict=True)]
        assert np.array(given) == pytest.approx(fitted, abs=1e-7)


def test_local_frames_of_blocks_are_those_of_all_frames_at_once():
    fit, coarse, fine, _ = learned()
    blocks, *_ = learned()
    turned = learned()[0]
    fit.add(coarse, fine)
    for begin in (0, 7, 30):
        end = {0: 7, 7: 30, 30: 40}[begin]
        blocks.add(coarse[begin:end], fine[begin:end])
    turned.add(*([moved(x.reshape(-1, 3)).reshape(x.shape) for x in (coarse, fine)]))
    whole = fit.solve(1e-2)
    assert blocks.solve(1e-2).weights == pytest.approx(whole.weights, abs=1e-9)
    assert turned.solve(1e-2).weights == pytest.approx(whole.weights, abs=1e-6)


def test_local_frames_of_residuals_that_are_zero_are_the_base():
    fit, coarse, _, base = learned()
    fit.add(coarse, np.array([base @ place for place in coarse]))
    assert np.abs(fit.solve().predict(coarse[3]) - base @ coarse[3]).max() < 1e-9


def test_tangent_frames_are_right_handed_and_follow_the_cloth():
    flat, joined = OTHER
    frames = tangent_frames(flat, joined)
    level = frames.of(np.column_stack([flat, np.zeros(len(flat))]))
    assert level == pytest.approx(np.tile(np.eye(3), (len(flat), 1, 1)), abs=1e-12)
    turn = frames.of(moved(wave(flat)))
    assert np.linalg.det(turn) == pytest.approx(np.ones(len(flat)), abs=1e-12)
    assert frames.of(np.column_stack([flat[:, 0], 0 * flat])) == pytest.approx(0.0)  # all in line: no plane


def test_upsampling_refuses():
    rest, faces = FINE
    with pytest.raises(SimCoreError, match="^constraints: two coarse vertices are the same"):
        biharmonic(rest, faces, [0, 5, 5, 9])
    with pytest.raises(SimCoreError, match="^constraints: give three"):
        biharmonic(rest, faces, [0, 5])
    with pytest.raises(SimCoreError, match="^constraints: "):
        biharmonic(rest, faces, np.flatnonzero(rest[:, 1] == rest[:, 1].min()))  # all in line
    with pytest.raises(SimCoreError, match="^constraints: shape"):
        biharmonic(rest, faces, linear(*OTHER, rest))
    with pytest.raises(SimCoreError, match="^cut: "):
        biharmonic(rest, faces, [0, 5, 90], cut=2.0)
    with pytest.raises(SimCoreError, match="^rest_fine: shape"):
        linear(rest, faces, np.zeros((4, 3)))
    with pytest.raises(SimCoreError, match="^rest: vertex 0 is not finite"):
        linear(np.full_like(rest, np.nan), faces, rest)
    fit, coarse, fine, _ = learned()
    with pytest.raises(SimCoreError, match="^frames: there are none"):
        fit.solve()
    with pytest.raises(SimCoreError, match="^coarse, fine: shapes"):
        fit.add(coarse, fine[:, 1:])
    with pytest.raises(SimCoreError, match="^coarse, fine: positions that are not finite"):
        fit.add(coarse * np.nan, fine)
    fit.add(coarse, fine)
    with pytest.raises(SimCoreError, match="^coarse: vertex 0 is not finite"):
        fit.solve().predict(coarse[0] * np.nan)
    with pytest.raises(SimCoreError, match="^base: shape"):
        LocalFramesFit(*OTHER, rest[1:], linear(*OTHER, rest))


def test_a_thinned_border_is_bridged():
    rest, faces = FINE
    pooled = random_points(rest, faces, 0.3, 4, border=False)
    matrix = linear(rest[pooled.kept], pooled.faces, rest)
    assert matrix.sum(1) == pytest.approx(np.ones(len(rest)))
    assert np.abs(matrix @ rest[pooled.kept] - rest).max() < 0.2
