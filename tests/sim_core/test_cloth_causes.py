"""A frame that cannot be gone through says why, where and what helps; what was thought to be one runs."""

import numpy as np
import pytest

from sim_core.cloth import Contact, HalfSpace, Live, Material, Phase, Sheet, drape
from sim_core.errors import SimCoreError

MATERIAL = Material(density=0.1, stretch=49.0)
LAYERS = Contact(thickness=0.003)


def flat(count: int, size: float, material: Material = MATERIAL) -> tuple[Sheet, np.ndarray]:
    """A level square of count x count vertices, and where they lie."""
    x, z = np.meshgrid(*[np.linspace(0.0, size, count)] * 2, indexing="ij")
    rest = np.stack([x.ravel(), z.ravel()], axis=1)
    a = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    faces = np.concatenate(
        [np.stack([a, a + 1, a + count], 1), np.stack([a + 1, a + count + 1, a + count], 1)]
    )
    return Sheet.of(rest, faces, material), np.insert(rest, 1, 0.0, axis=1)


@pytest.mark.parametrize(
    ("size", "density"), [(0.005, 0.1), (1000.0, 0.1), (1.0, 1e-9)], ids=["5mm", "1km", "1ug"]
)
def test_cloth_of_any_size_runs(size, density):
    sheet, x = flat(11, size, Material(density=density, stretch=49.0))
    end = drape(sheet, x, [Phase(1.0)], pins=[0, 110])
    assert end.frames == 25
    assert np.isfinite(end.positions).all()
    assert end.worst_stretch < 1.01
    assert (
        -1.1 * size - 5.0 < end.positions[:, 1].min() < -0.01 * min(size, 1.0)
    )  # it hangs, and fell no further


def test_what_is_too_small_for_its_stiffness_is_told_with_the_steps():
    sheet, x = flat(11, 0.005, Material(density=1e-9, stretch=49.0))
    with pytest.raises(
        SimCoreError, match=r"frame 0: it would take [\d,]+ steps, 50,000 at most: edges of 0\.5 mm"
    ) as e:
        drape(sheet, x, [Phase(1.0)], pins=[0, 110])
    assert "coarser mesh, a heavier cloth" in str(e.value)


def test_a_start_within_a_solid_is_told_with_its_depth():
    sheet, x = flat(21, 1.0)
    with pytest.raises(SimCoreError, match=r"vertex \d+ at .* lies 300 mm inside the collider – begin"):
        drape(sheet, x, [Phase(1.0)], collider=HalfSpace((0.0, 0.3, 0.0)))


def test_pins_led_to_one_place_are_named_and_nothing_has_happened():
    sheet, x = flat(21, 1.0)
    cloth, twin = (Live(sheet, x, pins=[0, 1], contact=LAYERS) for _ in range(2))
    with pytest.raises(
        SimCoreError, match="pins 0 and 1 are to be 0 mm apart, the cloth between them is 50 mm"
    ):
        cloth.step(targets=np.array([[0.5, 0.0, 0.5]] * 2))
    for _ in range(3):
        assert np.array_equal(cloth.step(), twin.step())


@pytest.mark.parametrize("contact", [None, LAYERS], ids=["bare", "layers"])
@pytest.mark.parametrize("count", [1, 300])
def test_a_pull_beyond_measure_is_refused_and_nothing_has_happened(contact, count):
    sheet, x = flat(21, 1.0)
    cloth, twin = (Live(sheet, x, pins=[0], contact=contact) for _ in range(2))
    pulled = np.arange(100, 100 + count)
    with pytest.raises(
        SimCoreError, match=r"pulls: vertex \d+ would be .* m/s faster .* with .* N at most, not 1e\+04"
    ):
        cloth.step(pulls=(pulled, np.tile([0.0, 1e4, 0.0], (count, 1))))
    for _ in range(3):
        assert np.array_equal(cloth.step(), twin.step())
