"""Seams: both sides match vertex for vertex, notches and corners kept, ease told."""

import numpy as np
import pytest

from sim_core.errors import OutlineError, OutlineWarning
from sim_core.mesh import Seam, SeamSide, SewnPanel, SizeField, sewn_meshes
from sim_core.mesh.measures import mesh_fault

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
T = np.linspace(0, np.pi / 2, 30)
CURVED = np.vstack(
    [[[0, 0], [1.2, 0]], np.column_stack([1.2 - 0.3 * np.sin(T), 0.3 + 0.7 * (1 - np.cos(T))]), [[0, 1.0]]]
)


def sewn(outlines, seams, *, edge, quality="light", **each):
    """Panels of these outlines, each with its own of what else is given."""
    own = [{name: given[k] for name, given in each.items()} for k in range(len(outlines))]
    panels = [SewnPanel(outline, **more) for outline, more in zip(outlines, own, strict=True)]
    return sewn_meshes(panels, seams, edge=edge, quality=quality)


def lengths(mesh, vertices) -> np.ndarray:
    return np.hypot(*np.diff(mesh.vertices[vertices], axis=0).T)


def assert_on_outline(mesh, vertices) -> None:
    """Neighbours of the seam are neighbours on the mesh's outline, in one direction."""
    loop = mesh.boundary[0].tolist()
    where = np.array([loop.index(v) for v in vertices])
    steps = np.diff(where) % len(loop)
    assert (steps == 1).all() or (steps == len(loop) - 1).all()


@pytest.mark.parametrize("quality", ["light", "best"])
@pytest.mark.parametrize("backward", [False, True])
def test_equal_sides_match_to_the_last_bit_of_length(backward, quality):
    side = SeamSide(1, 3, 2, backward=True) if backward else SeamSide(1, 2, 3)
    meshes, (fit,) = sewn([SQUARE, SQUARE], [Seam(SeamSide(0, 0, 1), side)], edge=0.07, quality=quality)
    for mesh, column in zip(meshes, fit.pairs.T, strict=True):
        assert mesh_fault(mesh.vertices, mesh.faces, mesh.boundary) is None
        assert_on_outline(mesh, column)
    assert fit.mismatch <= 1e-9
    assert fit.ease <= 1e-12
    assert np.abs(lengths(meshes[0], fit.pairs[:, 0]) - lengths(meshes[1], fit.pairs[:, 1])).max() <= 1e-9
    assert len(fit.pairs) == np.ceil(1 / 0.07) + 1
    assert len(np.unique(fit.pairs[:, 0])) == len(np.unique(fit.pairs[:, 1])) == len(fit.pairs)
    assert tuple(meshes[0].vertices[fit.pairs[0, 0]]) == (0, 0)
    assert tuple(meshes[1].vertices[fit.pairs[0, 1]]) == ((0, 1) if backward else (1, 1))


def test_ease_notches_and_corners_of_a_curved_side():
    last = len(CURVED) - 1
    seam = Seam(SeamSide(0, 1, 2), SeamSide(1, 1, last, backward=False), notches=(0.25, 0.6))
    meshes, (fit,) = sewn([SQUARE, CURVED], [seam], edge=0.05)
    a, b = fit.lengths
    assert a == pytest.approx(1.0)
    assert b == pytest.approx(np.hypot(*np.diff(CURVED[1:], axis=0).T).sum())
    assert fit.ease == pytest.approx((b - a) / a)
    assert fit.mismatch == pytest.approx((b - a) / (len(fit.pairs) - 1))
    for notch, at in zip((0.25, 0.6), fit.notches, strict=True):
        assert lengths(meshes[0], fit.pairs[: at + 1, 0]).sum() == pytest.approx(notch * a, rel=1e-9)
        assert lengths(meshes[1], fit.pairs[: at + 1, 1]).sum() == pytest.approx(notch * b, rel=2e-3)
    corner = (meshes[1].vertices[fit.pairs[:, 1]] == CURVED[2]).all(axis=1)
    assert corner.sum() == 1  # the corner between the straight and the curve is a vertex of the seam


def test_deviation_is_told_from_the_outline_that_was_given():
    bend = np.array([[0, 0], [1, 0], *(0.5 + 0.5 * np.column_stack([np.cos(T), np.sin(T)])), [0.0, 1]])
    seam = Seam(SeamSide(0, 1, len(bend) - 2), SeamSide(1, 0, 1))
    for outline in (bend, bend[::-1]):
        side = seam.a if outline is bend else SeamSide(0, 1, len(bend) - 2)
        meshes, _ = sewn([outline, SQUARE], [Seam(side, seam.b)], edge=0.25)
        sag = 0.5 * (1 - np.cos(np.pi / 4 / 4))  # of four steps over the quarter circle
        assert 0.5 * sag < meshes[0].report.outline_deviation < 2 * sag
        assert meshes[1].report.outline_deviation < 1e-12


def test_a_panel_sewn_on_two_sides_to_two_others():
    seams = [
        Seam(SeamSide(0, 1, 2), SeamSide(1, 0, 3, backward=True)),
        Seam(SeamSide(0, 3, 0), SeamSide(2, 1, 2)),
    ]
    meshes, fits = sewn([SQUARE, SQUARE, SQUARE * (1, 1.3)], seams, edge=0.08)
    for seam, fit in zip(seams, fits, strict=True):
        assert_on_outline(meshes[seam.a.panel], fit.pairs[:, 0])
        assert_on_outline(meshes[seam.b.panel], fit.pairs[:, 1])
    assert fits[0].mismatch <= 1e-9
    assert fits[1].ease == pytest.approx(0.3)


def test_a_dart_is_sewn_to_itself():
    dart = np.array([[0.0, 0], [1, 0], [1, 1], [0.55, 1], [0.5, 0.6], [0.45, 1], [0, 1]])
    meshes, (fit,) = sewn([dart], [Seam(SeamSide(0, 3, 4), SeamSide(0, 5, 4, backward=True))], edge=0.04)
    assert fit.pairs[-1, 0] == fit.pairs[-1, 1]  # the tip
    assert fit.mismatch <= 1e-9
    assert mesh_fault(meshes[0].vertices, meshes[0].faces, meshes[0].boundary) is None


HOLE = np.array([[0.4, 0.4], [0.6, 0.4], [0.5, 0.6]])
PLEAT = [[0.3, 0.0], [0.3, 1.0]]  # from the sewn side to the free one
STRAIGHT = Seam(SeamSide(0, 0, 1), SeamSide(1, 0, 1))


def assert_matched(meshes, fit, seam) -> None:
    for mesh, side, column in zip(meshes, (seam.a, seam.b), fit.pairs.T, strict=True):
        assert mesh_fault(mesh.vertices, mesh.faces, mesh.boundary, mesh.lines) is None
        assert_on_outline(mesh, column)
        ends = SQUARE[[side.first, side.last]]
        np.testing.assert_array_equal(mesh.vertices[column[[0, -1]]], ends)
    assert len(np.unique(fit.pairs[:, 0])) == len(np.unique(fit.pairs[:, 1])) == len(fit.pairs)
    steps = [lengths(mesh, column) for mesh, column in zip(meshes, fit.pairs.T, strict=True)]
    np.testing.assert_allclose(steps[0], steps[1], atol=1e-9)


@pytest.mark.parametrize("quality", ["fair", "light", "best"])
@pytest.mark.parametrize("other", [SQUARE, SQUARE[::-1]])
def test_sewn_panels_have_holes_pleats_and_finer_places(quality, other):
    """A fold that ends on the seam has a vertex there on both sides, and so has every other step."""
    corner = SizeField(np.array([[1.0, 0.0]]), np.array([0.02]))
    first = int((other == (0, 0)).all(axis=1).argmax())
    last = int((other == (1, 0)).all(axis=1).argmax())
    side = SeamSide(1, first, last, backward=(last - first) % 4 == 3)
    seam = Seam(SeamSide(0, 0, 1), side)
    meshes, (fit,) = sewn(
        [SQUARE, other],
        [seam],
        edge=0.08,
        holes=[[HOLE], []],
        constraints=[[PLEAT], []],
        sizes=[None, corner],
        quality=quality,
    )
    for mesh, column in zip(meshes, fit.pairs.T, strict=True):
        assert mesh_fault(mesh.vertices, mesh.faces, mesh.boundary, mesh.lines) is None
        assert_on_outline(mesh, column)
        steps = lengths(mesh, column)
        assert steps[-1] < 0.03 < 0.06 < steps[0]  # the coarse side follows the fine one
    a, b = (mesh.vertices[column] for mesh, column in zip(meshes, fit.pairs.T, strict=True))
    np.testing.assert_allclose(a, b, atol=1e-9)
    assert np.isclose(a, (0.3, 0), atol=1e-12).all(axis=1).sum() == 1
    fold = meshes[0].vertices[np.unique(np.concatenate(meshes[0].lines))]
    assert np.abs(fold[:, 0] - 0.3).max() < 1e-12
    assert np.ptp(fold[:, 1]) == 1.0
    assert len(meshes[0].boundary) == 2
    assert len(meshes[1].boundary) == 1


def test_folds_of_both_sides_end_on_the_seam():
    lines = [[PLEAT, [[0.7, 0], [0.7, 0.5]]], [[[0.5, 0], [0.5, 0.4]]]]
    meshes, (fit,) = sewn([SQUARE, SQUARE], [STRAIGHT], edge=0.3, constraints=lines)
    assert_matched(meshes, fit, STRAIGHT)
    for at in (0.3, 0.5, 0.7):
        for mesh, column in zip(meshes, fit.pairs.T, strict=True):
            assert np.isclose(mesh.vertices[column, 0], at, atol=1e-12).any()


def test_free_stretches_are_halved_where_they_must_and_seams_are_not():
    """A hole 2 mm from both a sewn and a free side: steps of the free one become finer, the seam's stay a pair."""
    hole = np.array([[0.002, 0.35], [0.35, 0.002], [0.35, 0.35]])
    meshes, (fit,) = sewn([SQUARE, SQUARE], [STRAIGHT], edge=0.1, holes=[[hole], []])
    assert_matched(meshes, fit, STRAIGHT)
    assert len(fit.pairs) == 11
    rim = meshes[0].vertices[meshes[0].boundary[0]]
    free = np.sort(rim[rim[:, 0] == 0, 1])
    assert np.diff(free).min() < 0.06


def test_holes_that_touch_are_merged_unless_they_touch_the_outline():
    pair = [[[0.3, 0.3], [0.4, 0.3], [0.4, 0.4]], [[0.4, 0.4], [0.5, 0.4], [0.5, 0.5]]]
    with pytest.warns(OutlineWarning, match="merged"):
        meshes, (fit,) = sewn([SQUARE, SQUARE], [STRAIGHT], edge=0.1, holes=[pair, []])
    assert_matched(meshes, fit, STRAIGHT)
    assert len(meshes[0].boundary) == 2
    assert 0.0018 < meshes[0].report.outline_deviation < 0.01
    on_it = [[[0.3, 0], [0.4, 0], [0.4, 0.1]]]
    with (
        pytest.warns(OutlineWarning),
        pytest.raises(OutlineError, match="panel 0: a hole touches the outline"),
    ):
        sewn([SQUARE, SQUARE], [STRAIGHT], edge=0.1, holes=[on_it, []])


@pytest.mark.parametrize("apart", [1e-4, 0.015])
def test_marks_of_both_sides_that_nearly_meet_are_one_and_told(apart):
    """A corner at half of one side, one a hair further on the other: one vertex, at the corner of each."""
    one = np.array([[0, 0], [0.5, -0.3], [1, 0], [1, 1], [0, 1.0]])
    two = np.array([[0, 0], [0.5 + apart, -0.3], [1, 0], [1, 1], [0, 1.0]])
    seam = Seam(SeamSide(0, 0, 2), SeamSide(1, 0, 2), notches=(0.5 + apart / 2,))
    meshes, (fit,) = sewn([one, two], [seam], edge=0.1)
    steps = [lengths(mesh, column) for mesh, column in zip(meshes, fit.pairs.T, strict=True)]
    assert min(step.min() for step in steps) > 0.05
    middle = int(fit.notches[0])
    for mesh, outline, column in zip(meshes, (one, two), fit.pairs.T, strict=True):
        assert tuple(mesh.vertices[column[middle]]) == tuple(outline[1])
    halves = [np.hypot(*np.diff(outline[:3], axis=0).T) for outline in (one, two)]
    wanted = abs(halves[0][0] / halves[0].sum() - halves[1][0] / halves[1].sum()) * max(fit.lengths)
    assert fit.joined == pytest.approx(wanted, rel=0.5)
    assert fit.joined > 0


def test_marks_further_apart_stay_two_and_so_do_corners_of_one_side():
    step = np.array([[0, 0], [0.5, 0], [0.5, 0.01], [1, 0.01], [1, 1], [0, 1.0]])
    seam = Seam(SeamSide(0, 0, 3), SeamSide(1, 0, 1), notches=(0.2, 0.25))
    meshes, (fit,) = sewn([step, SQUARE], [seam], edge=0.1)
    assert fit.joined == 0
    on = {tuple(point) for point in meshes[0].vertices[fit.pairs[:, 0]]}
    assert {tuple(point) for point in step[:4]} <= on
    assert np.diff(fit.notches) == 1


@pytest.mark.parametrize("backward", [False, True])
def test_corners_that_are_named_meet_whatever_their_angle(backward):
    """Both sides turn nowhere; one has its corner at .3, the other at .55: the legs between them meet one by one."""
    one = np.array([[0.0, 0], [0.3, 0], [1, 0], [1, 1], [0, 1]])
    two = np.array([[0.0, 0], [0.55, 0], [1, 0], [1, 1], [0, 1]])
    other = SeamSide(1, 2, 0, backward=True) if backward else SeamSide(1, 0, 2)
    if backward:
        one = one * (-1, 1) + (1, 0)
    corners = [range(5), range(5)]
    seam = Seam(SeamSide(0, 0, 2), other, notches=(0.1, 0.9))
    meshes, (fit,) = sewn([one, two], [seam], edge=0.04, corners=corners)
    at = [mesh.vertices[column] for mesh, column in zip(meshes, fit.pairs.T, strict=True)]
    corner = [
        int((where == outline[1]).all(axis=1).argmax()) for where, outline in zip(at, (one, two), strict=True)
    ]
    assert corner[0] == corner[1] > 0
    for mesh, column in zip(meshes, fit.pairs.T, strict=True):
        assert_on_outline(mesh, column)
        assert lengths(mesh, column).max() <= 0.04 * (1 + 1e-6)
    first = lengths(meshes[0], fit.pairs[:, 0])
    assert [first[:at].sum() for at in fit.notches] == pytest.approx([0.1, 0.9])


def test_a_single_leg_is_divided_at_its_own_mark_where_that_is_near():
    """The other side's corner lies at .5 of it, a fold of its own ends at .51: one vertex, and it is told."""
    two = np.array([[0.0, 0], [0.5, 0], [1, 0], [1, 1], [0, 1]])
    fold = [[0.51, 0.0], [0.51, 1.0]]
    for reverse in (False, True):
        seam = Seam(SeamSide(0, 0, 1), SeamSide(1, 0, 2))
        if reverse:
            seam = Seam(SeamSide(1, 2, 0, backward=True), SeamSide(0, 1, 0, backward=True))
        meshes, (fit,) = sewn(
            [SQUARE, two], [seam], edge=0.1, corners=[range(4), range(5)], constraints=[[fold], []]
        )
        x = [
            meshes[side.panel].vertices[column, 0]
            for side, column in zip((seam.a, seam.b), fit.pairs.T, strict=True)
        ]
        single, parted = x[::-1] if reverse else x
        assert (np.flatnonzero(single == 0.51) == np.flatnonzero(parted == 0.5)).all()
        assert np.abs(np.diff(single)).min() > 0.08
        assert fit.joined == pytest.approx(0.01)


def test_a_panel_gets_the_same_points_wherever_its_outline_begins():
    """Each leg is sampled by itself, to the bit, bends with more steps than straights."""
    count = len(CURVED)
    made = []
    for begin in (0, 1, 7, count - 1):
        turned = np.roll(CURVED, -begin, axis=0)
        corners = [(0 - begin) % count, (1 - begin) % count]
        ((mesh,), _) = sewn([turned], [], edge=0.11, corners=[corners])
        rim = mesh.vertices[mesh.boundary[0]]
        made.append(set(map(tuple, rim.tolist())))
        assert mesh.report.outline_deviation < 0.045 * 0.11
    assert made[0] == made[1] == made[2] == made[3]
    assert made[0] >= {tuple(point) for point in CURVED[[0, 1, 2, -1]].tolist()}


def test_lines_that_leave_the_cloth_are_named():
    with pytest.raises(OutlineError, match="panel 1: constraint 0: leaves the cloth"):
        sewn([SQUARE, SQUARE], [], edge=0.1, constraints=[[], [[[0.5, 0.5], [1.5, 0.5]]]])


NONE, ALL = [(), ()], [range(4), range(4)]
BAD = {
    "seam 0: panel 4": (Seam(SeamSide(0, 0, 1), SeamSide(4, 0, 1)), NONE),
    "seam 0: point 9": (Seam(SeamSide(0, 0, 9), SeamSide(1, 0, 1)), NONE),
    "notches": (Seam(SeamSide(0, 0, 1), SeamSide(1, 0, 1), notches=(1.5,)), NONE),
    "panel 0: seams overlap behind": (Seam(SeamSide(0, 0, 2), SeamSide(0, 1, 3)), NONE),
    "panel 0: two seams begin at point 1": (Seam(SeamSide(0, 0, 2), SeamSide(0, 1, 2)), ALL),
    "panel 1: corner 4 – the outline has 4 points": (STRAIGHT, [(), (0, 4)]),
    "seam 0: 2 legs meet 3": (Seam(SeamSide(0, 0, 2), SeamSide(1, 0, 3)), ALL),
}


@pytest.mark.parametrize("message", BAD)
def test_seams_that_cannot_be_are_named(message):
    seam, corners = BAD[message]
    with pytest.raises(OutlineError, match=message):
        sewn([SQUARE, SQUARE], [seam], edge=0.1, corners=corners)
