"""Welded panels, sewing pairs, bounds, mirror images and moving bodies, on small sheets."""

import numpy as np
import pytest

from sim_core.cloth import (
    Capsule,
    Contact,
    GridSdf,
    Holds,
    Material,
    MovingGrid,
    Phase,
    Sheet,
    drape,
)
from sim_core.cloth.scenes import GF_CM, equilateral_sheet
from sim_core.cloth.step import Pace
from sim_core.errors import SimCoreError
from sim_core.garment.dressing import sewn_sheet
from sim_core.garment.pattern import Cloth


def test_panels_welded_along_a_seam_are_one_cloth() -> None:
    """Cut in two and shifted in the pattern plane: the stencils are those of the whole sheet."""
    rest, faces = equilateral_sheet(0.3, 0.2, 0.05)
    # So few columns are no lattice to `Sheet.of`, which would balance their bending.
    whole = Sheet.of_corners(rest[faces], faces, [GF_CM], np.zeros(len(faces), int))
    corner = rest[faces].copy()
    corner[corner[:, :, 0].mean(1) > 0.15] += [1.0, -2.0]
    welded = Sheet.of_corners(corner, faces, [GF_CM], np.zeros(len(faces), int))
    for name, a, b in zip(whole.stencil._fields, whole.stencil, welded.stencil, strict=True):
        assert a == pytest.approx(b, rel=1e-9, abs=1e-9), name


def test_faces_may_be_of_several_cloths() -> None:
    rest, faces = equilateral_sheet(0.3, 0.2, 0.05)
    heavy = Material(0.10, 98.0, 0.3, 9.8e-5)
    kind = (rest[faces][:, :, 0].mean(1) > 0.15).astype(int)
    sheet = Sheet.of_corners(rest[faces], faces, [GF_CM, heavy], kind)
    a, b = rest[faces[:, 1]] - rest[faces[:, 0]], rest[faces[:, 2]] - rest[faces[:, 0]]
    area = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    assert sheet.mass.sum() == pytest.approx(area @ np.array([0.05, 0.10])[kind])
    plain = Sheet.of(rest, faces, GF_CM)
    assert sheet.stencil.own.max() > 1.5 * plain.stencil.own.max()
    with pytest.raises(SimCoreError, match="corner"):
        Sheet.of_corners(rest[faces][:-1], faces, [GF_CM], kind)
    with pytest.raises(SimCoreError, match="belongs to no face"):
        Sheet.of_corners(rest[faces + 0], faces + 1, [GF_CM, heavy], kind)


def test_pairs_are_drawn_together_and_stay() -> None:
    rest, faces = equilateral_sheet(0.2, 0.2, 0.05)
    count = len(rest)
    flat = np.column_stack([rest[:, 0], np.ones(count), rest[:, 1]])
    x = np.concatenate([flat, flat + [0.0, -0.1, 0.0]])
    sheet = Sheet.of(np.concatenate([rest, rest + [5.0, 0]]), np.concatenate([faces, faces + count]), GF_CM)
    edge = np.flatnonzero(rest[:, 0] < 1e-9)
    pairs = np.column_stack([edge, edge + count])
    holds = Holds.of(2 * count, pairs=pairs, positions=x)
    phases = (
        Phase(0.4, (0.0, 0.0), 6.0, sewing=(1.0, 0.0)),
        Phase(0.12, (0.0, 0.0), 8.0),
    )
    gaps: list[float] = []

    def heard(index: int, now: np.ndarray) -> None:
        gaps.append(float(np.linalg.norm(now[pairs[:, 0]] - now[pairs[:, 1]], axis=1).max()))

    contact = Contact(thickness=0.004, speed_limit=2.5)
    done = drape(sheet, x, phases, holds=holds, contact=contact, on_frame=heard)
    assert np.diff(gaps).max() < 1e-6
    assert gaps[0] == pytest.approx(0.09, abs=1e-6)
    assert gaps[-1] < 1e-6
    assert np.isfinite(done.positions).all()
    assert holds.same[pairs[0, 0]] == holds.same[pairs[0, 1]]
    with pytest.raises(SimCoreError, match="pairs"):
        Holds.of(3, pairs=np.array([[0, 3]]), positions=x)
    with pytest.raises(SimCoreError, match="no room"):
        Holds.of(2, low=np.ones(2), high=np.zeros(2))


def test_a_half_with_images_is_the_whole_cloth() -> None:
    """A sheet that hangs by one edge, whole and as one half against its mirror image: the same to rounding."""
    half_rest, half_faces = equilateral_sheet(0.2, 0.3, 0.05)
    on = np.flatnonzero(half_rest[:, 0] < 1e-9).astype(np.int32)
    count = len(half_rest)
    alone = np.arange(count, dtype=np.int32)
    none = np.zeros((0, 2), np.int32)
    panels = (np.zeros(len(half_faces), np.int32), np.zeros(count, np.int32))
    cloth = Cloth(("half",), half_rest, half_faces, *panels, alone, alone, none, on, {})
    both = cloth.mirrored()

    def laid(rest: np.ndarray) -> np.ndarray:
        return np.column_stack([rest[:, 0], np.full(len(rest), 1.05), rest[:, 1] - 0.14])

    kind = np.zeros(len(half_faces), np.int32)
    half = sewn_sheet(cloth, cloth.closed, [GF_CM], kind, kind, even=False)
    low, high = np.full(len(half.sheet.rest), -np.inf), np.full(len(half.sheet.rest), np.inf)
    low[half.middle] = high[half.middle] = 0.0
    holds = Holds.of(len(low), low=low, high=high, slaves=half.slaves)
    top = np.flatnonzero(half_rest[:, 1] < 1e-9)
    begin = half.gathered(laid(half_rest))
    one = drape(half.sheet, begin, [Phase(0.4)], holds=holds, pins=half.number[top].tolist(), substeps=300)
    number = both.closed
    start = np.zeros((number.max() + 1, 3))
    start[number] = laid(both.vertices)
    sheet = Sheet.of_corners(both.vertices[both.faces], number[both.faces], [GF_CM], np.r_[kind, kind])
    pins = np.unique(number[np.r_[top, top + count]]).tolist()
    two = drape(sheet, start, [Phase(0.4)], pins=pins, substeps=300)
    assert one.positions[half.number] == pytest.approx(two.positions[number[:count]], abs=1e-12)
    assert two.positions[number[count:]] == pytest.approx(
        two.positions[number[:count]] * [-1, 1, 1], abs=1e-12
    )
    assert np.abs(one.positions[half.middle, 0]).max() == 0.0


def ball(height: float) -> np.ndarray:
    solid = Capsule((0.0, height, 0.0), (0.0, height, 0.0), 0.15)
    return GridSdf.sample(solid, np.full(3, -0.4), np.full(3, 0.4), 0.02).values


def test_a_rising_body_lifts_the_cloth() -> None:
    rest, faces = equilateral_sheet(0.3, 0.3, 0.03)
    sheet = Sheet.of(rest, faces, GF_CM)
    x = np.column_stack([rest[:, 0] - 0.15, np.full(len(rest), 0.07), rest[:, 1] - 0.15])
    body = MovingGrid((-0.4, -0.4, -0.4), 0.02, 3, lambda k: ball(-0.10 + 0.05 * k), "ball")
    phases = (
        Phase(0.24, (0.0, 9.8), 4.0),
        Phase(0.64, damping=4.0, body=(0.0, 2.0)),
        Phase(0.2, damping=6.0),
    )
    done = drape(sheet, x, phases, collider=body, contact=Contact(0.004, 0.001, speed_limit=2.5))
    top = done.positions[:, 1].max()
    assert 0.15 < top < 0.17
    away = Capsule((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.15).distance(done.positions)
    assert away.min() > 0.001
    again = drape(sheet, x, phases, collider=body, contact=Contact(0.004, 0.001, speed_limit=2.5))
    assert again.positions.tobytes() == done.positions.tobytes()
    with pytest.raises(SimCoreError, match="keys"):
        drape(sheet, x, [Phase(0.36, body=(0.0, 3.0))], collider=body)
    with pytest.raises(SimCoreError, match="next key"):
        drape(sheet, x, [Phase(0.04, body=(0.0, 2.0))], collider=body)


def test_pins_of_a_phase_hold_in_it_alone() -> None:
    rest, faces = equilateral_sheet(0.2, 0.2, 0.05)
    sheet = Sheet.of(rest, faces, GF_CM)
    x = np.column_stack([rest[:, 0], np.zeros(len(rest)), rest[:, 1]])
    top = tuple(int(k) for k in np.flatnonzero(rest[:, 1] < 1e-9))
    first = drape(sheet, x, [Phase(0.2, pins=top)])
    assert np.abs(first.positions[list(top)] - x[list(top)]).max() == 0.0
    then = drape(sheet, x, [Phase(0.2, pins=top), Phase(0.2)])
    assert then.positions[list(top), 1].max() < -0.1


@pytest.mark.parametrize("limit", [1.0, 0.05])
def test_a_limit_halves_what_edges_stretch(limit: float) -> None:
    """Its own weight stretches the strip by a third; one pass a substep is no hard stop, but takes most."""
    rest, faces = equilateral_sheet(0.1, 0.3, 0.02)
    sheet = Sheet.of(rest, faces, Material(0.05, 0.5, 0.0, 1e-7))
    x = np.column_stack([rest[:, 0], -rest[:, 1], np.zeros(len(rest))])
    top = tuple(int(k) for k in np.flatnonzero(rest[:, 1] < 1e-9))
    holds = Holds.of(len(x), limit=(1.0, limit))
    done = drape(sheet, x, [Phase(0.8, damping=20.0)], pins=top, holds=holds, substeps=1000)
    length = np.linalg.norm(np.diff(done.positions[sheet.edges], axis=1)[:, 0], axis=1)
    longest = (length / np.sqrt(sheet.stencil.length2)).max()
    assert (longest < 1.12) if limit < 1.0 else (longest > 1.2), longest
    assert np.abs(done.positions[list(top)] - x[list(top)]).max() == 0.0


def test_a_crushed_edge_is_brought_back_and_the_middle_of_mass_stays() -> None:
    rest, faces = equilateral_sheet(0.1, 0.1, 0.02)
    sheet = Sheet.of(rest, faces, Material(0.05, 0.5, 0.0, 1e-7))
    x = np.column_stack([0.6 * rest[:, 0], np.zeros(len(rest)), rest[:, 1]])
    held = drape(
        sheet, x, [Phase(0.04, (0.0, 0.0), 0.0)], holds=Holds.of(len(x), limit=(0.04, 0.04)), substeps=2000
    )
    length = np.linalg.norm(np.diff(held.positions[sheet.edges], axis=1)[:, 0], axis=1)
    assert (length / np.sqrt(sheet.stencil.length2)).min() > 0.9
    assert sheet.mass @ held.positions == pytest.approx(sheet.mass @ x, abs=1e-12)


@pytest.mark.parametrize("limit", [-0.1, 0.0, 1.1, np.nan])
def test_a_limit_is_a_share(limit: float) -> None:
    with pytest.raises(SimCoreError, match="limit"):
        Holds.of(3, limit=(0.5, limit))


def test_lengths_are_kept_in_double_precision_only() -> None:
    rest, faces = equilateral_sheet(0.1, 0.1, 0.05)
    x = np.column_stack([rest, np.zeros(len(rest))])
    with pytest.raises(SimCoreError, match="double precision"):
        drape(
            Sheet.of(rest, faces, GF_CM),
            x,
            [Phase(0.04)],
            holds=Holds.of(len(x), limit=(0.04, 0.04)),
            pace=Pace(precision="single"),
        )


def test_a_body_that_comes_quickly_wakes_the_cloth_in_time() -> None:
    """From a hand's breadth below, at 2.5 m/s: nobody has slept through it."""
    rest, faces = equilateral_sheet(0.3, 0.3, 0.03)
    sheet = Sheet.of(rest, faces, GF_CM)
    x = np.column_stack([rest[:, 0] - 0.15, np.full(len(rest), 0.17), rest[:, 1] - 0.15])
    body = MovingGrid((-0.4, -0.4, -0.4), 0.02, 4, lambda k: ball(-0.11 + 0.1 * k), "quick ball")
    low = []
    for k in (1, 2, 3):
        solid = Capsule((0.0, -0.11 + 0.1 * k, 0.0), (0.0, -0.11 + 0.1 * k, 0.0), 0.15)
        phases = [Phase(0.04 * k, (0.0, 0.0), 0.0, 0.0, body=(0.0, float(k)))]
        done = drape(sheet, x, phases, collider=body, contact=Contact(0.004, 0.001, cap=0.002))
        low.append(solid.distance(done.positions).min())
    assert min(low) > 0.0
    assert low[0] > 0.004 > low[2]  # at first it is far away, and in the end it carries the cloth


@pytest.mark.parametrize("limit", [0.04, (0.04,), (0.04, 0.04, 0.04), ("a", "b")])
def test_limits_are_two_numbers(limit: object) -> None:
    with pytest.raises(SimCoreError, match=r"holds\.limit"):
        Holds.of(4, limit=limit)  # type: ignore[arg-type]


def test_pairs_are_drawn_to_the_length_they_are_given() -> None:
    """A tie ends at its own length, a seam at nothing; what is nearer than its tie is long stays where it is."""
    rest, faces = equilateral_sheet(0.3, 0.2, 0.05)
    sheet = Sheet.of(rest, faces, GF_CM)
    x = np.column_stack([rest[:, 0], np.zeros(len(rest)), rest[:, 1]])
    corners = [
        int(np.argmin(np.hypot(*(rest - corner).T))) for corner in ((0, 0), (0.3, 0), (0, 0.2), (0.3, 0.2))
    ]
    pairs = np.array([corners[:2], corners[2:]])
    holds = Holds.of(len(rest), pairs=pairs, positions=x, ends=np.array([0.12, 0.0]))
    phases = [Phase(0.4, (0.0, 0.0), 6.0, sewing=(1.0, 0.0)), Phase(0.2, (0.0, 0.0), 20.0)]
    end = drape(sheet, x, phases, holds=holds).positions
    apart = np.linalg.norm(end[pairs[:, 0]] - end[pairs[:, 1]], axis=1)
    assert apart == pytest.approx([0.12, 0.0], abs=1e-3)
    loose = Holds.of(len(rest), pairs=pairs[:1], positions=x, ends=np.array([0.5]))
    still = drape(sheet, x, phases, holds=loose).positions
    assert still == pytest.approx(x, abs=1e-6)
    with pytest.raises(SimCoreError, match="ends"):
        Holds.of(len(rest), pairs=pairs, positions=x, ends=np.array([0.1, -0.1]))
