"""Solids: what is accepted, what is refused and in which words; FCL's clearance against exact geometry."""

import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from walk_moves import FLOOR, dense_floor, room

from hall_app.walk import BODY, Floor, Prism, Round, SolidError, wall, world_of

SQUARE = ((0, 0), (1, 0), (1, 1), (0, 1))


@pytest.mark.parametrize(
    ("polygon", "words"),
    [
        ([(0, 0), (1, 1)], "2 corners"),
        ([(0, 0), (1, 1), (1, 0), (0, 1)], "Self-intersection"),
        ([(0, 0), (1, 0), (2, 0)], "remedy|move|Too few"),
        ([(0, 0), (math.nan, 0), (2, 1)], "finite"),
        ([(0, 0), (1e9, 0), (2, 1)], "finite"),
        ([(0, 0, 1), (1, 0, 1), (1, 1, 1)], r"\[x, z\]"),
        ("abc", r"\[x, z\]"),
    ],
)
def test_faulty_polygon_is_refused_with_a_remedy(polygon, words):
    with pytest.raises(SolidError, match=words) as caught:
        Prism(polygon)
    assert "–" in str(caught.value)
    assert "\n" not in str(caught.value)
    with pytest.raises(SolidError, match=words):
        Floor(polygon)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Prism(SQUARE, 0),
        lambda: Prism(SQUARE, math.nan),
        lambda: Round(0, 0, -1),
        lambda: Round(math.inf, 0, 1),
        lambda: wall((1, 1), (1, 1), 0.1),
        lambda: wall((1, 1), (2, 1), 0),
        lambda: Floor(SQUARE, ("column",)),  # type: ignore[arg-type]
    ],
)
def test_faulty_sizes_are_refused(make):
    with pytest.raises(SolidError, match="–"):
        make()


def test_polygons_are_values_in_one_sense():
    assert Prism(SQUARE) == Prism(SQUARE[::-1] + SQUARE[-1:])
    assert hash(Prism(SQUARE)) == hash(Prism(np.array(SQUARE)))
    assert pickle.loads(pickle.dumps(FLOOR)) == FLOOR


def test_wall_is_a_box_of_its_thickness():
    made = wall((1, 2), (4, 6), 0.25)
    assert made.is_box
    assert made.shape.area == pytest.approx(5 * 0.25)
    assert not Prism(((0, 0), (2, 0), (2.5, 1), (0, 1))).is_box


def test_triangles_fill_a_concave_polygon():
    shape_l = Prism(((0, 0), (2, 0), (2, 0.5), (0.5, 0.5), (0.5, 2), (0, 2)))
    parts = shape_l.triangles()
    areas = [0.5 * np.cross(np.append(b - a, 0), np.append(c - a, 0))[2] for a, b, c in parts]
    assert min(areas) > 0
    assert sum(areas) == pytest.approx(shape_l.shape.area)


def test_clearance_and_normal_are_exact_outside_and_solid_inside():
    rng = np.random.default_rng(4)
    floor = dense_floor(rng)
    world = world_of(floor)
    places = rng.uniform((0.1, 0.1), (23.9, 15.9), (4000, 2))
    true = room(places, floor)
    told = np.array([world.contact(x, z) for x, z in places])
    clear = true > -0.28
    np.testing.assert_allclose(told[clear, 0], true[clear], atol=1e-6)
    # A step along the normal changes the room by its length: the normal is the gradient.
    ahead = room(places[clear] + 1e-4 * told[clear, 1:], floor)
    assert np.quantile(np.abs((ahead - true[clear]) / 1e-4 - 1), 0.99) < 1e-2
    inside = (true < -0.30 - 1e-3) & floor_contains(floor, places)
    assert inside.sum() > 50
    assert np.all(told[inside, 0] == -BODY.radius)


def floor_contains(floor, places):
    import shapely

    return shapely.contains_xy(floor.shape, places)


@settings(max_examples=60, deadline=None)
@given(st.floats(0.05, 3), st.floats(0.02, 1), st.floats(0, 2 * math.pi), st.floats(-3, 3), st.floats(-3, 3))
def test_clearance_of_a_turned_box(length, thickness, turn, x, z):
    end = (length * math.cos(turn), length * math.sin(turn))
    floor = Floor(((-9, -9), (9, -9), (9, 9), (-9, 9)), (wall((0, 0), end, thickness),))
    true = float(room(np.array([[x, z]]), floor)[0])
    told = world_of(floor).clearance(x, z)
    assert told == pytest.approx(true, abs=1e-7) if true > -0.28 else told <= true + 0.02
