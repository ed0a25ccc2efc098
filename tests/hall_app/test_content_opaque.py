"""What of a plan one cannot see through."""

import pytest

from hall_app.content.floor import opaque_walls
from hall_app.content.schema import PlanFile

SQUARE = [[-6.0, -6.0], [6.0, -6.0], [6.0, 6.0], [-6.0, 6.0]]
NAVE = {"id": "nave", "name": {"zh": "中", "en": "Nave"}, "polygon": [[0, -6], [6, -6], [6, 6], [0, 6]]}


def plan(**tables) -> PlanFile:
    return PlanFile.model_validate({"outline": SQUARE, "height": 4.0, "nave_height": 5.0, **tables})


def wall(start, end, **more) -> dict:
    return {"from": start, "to": end, "thickness": 0.2, "height": 4.0, **more}


def test_openings_are_seen_through():
    door = {"kind": "door", "from": [-1.0, 0.0], "to": [-2.0, 0.0]}
    window = {"kind": "window", "from": [-4.5, 0.1], "to": [-3.5, 0.1], "sill": 1.0}
    elsewhere = {"kind": "window", "from": [-4.5, 6.0], "to": [-3.5, 6.0]}
    found = opaque_walls(plan(wall=[wall([-5, 0], [-0.5, 0])], opening=[door, window, elsewhere]))
    assert [stretch[:4] for stretch in found] == [
        pytest.approx((-5.0, 0.0, -4.5, 0.0)),
        pytest.approx((-3.5, 0.0, -2.0, 0.0)),
        pytest.approx((-1.0, 0.0, -0.5, 0.0)),
    ]


def test_an_opening_as_wide_as_its_wall_leaves_nothing():
    door = {"kind": "door", "from": [-5.1, 0.0], "to": [-0.4, 0.0]}
    assert opaque_walls(plan(wall=[wall([-5, 0], [-0.5, 0])], opening=[door])) == []


def test_an_opening_that_reaches_beyond_its_wall_is_drawn_in_none_and_opens_none():
    door = {"kind": "door", "from": [-6.0, 0.0], "to": [-1.0, 0.0]}
    assert len(opaque_walls(plan(wall=[wall([-5, 0], [-0.5, 0])], opening=[door]))) == 1


def test_lattices_are_seen_through():
    assert opaque_walls(plan(wall=[wall([-5, 0], [-0.5, 0], kind="lattice")])) == []


@pytest.mark.parametrize(
    ("bays", "height", "top"),
    [([], 4.0, None), ([], 3.9, 3.9), ([NAVE], 4.0, None), ([NAVE], 3.9, 3.9)],
    ids=["to the ceiling", "below it", "drawn up to the nave's", "below both"],
)
def test_a_wall_that_is_drawn_up_to_the_ceilings_has_no_top(bays, height, top):
    (found,) = opaque_walls(plan(wall=[wall([0, -5], [0, 5], height=height)], bay=bays))
    assert found == (0.0, -5.0, 0.0, 5.0, top)
