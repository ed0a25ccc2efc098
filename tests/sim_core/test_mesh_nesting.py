"""Which contours are close, and which lie in which: against every pair compared, on contours that interleave."""

import numpy as np
import pytest
from shapely import Polygon
from shapely.affinity import rotate

from sim_core.errors import OutlineError
from sim_core.mesh.outline import cleaned_contours, close_contours, enclosing

NEAR = 1e-9
SQUARE = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])


def chevrons(count: int) -> list[np.ndarray]:
    """V-shaped contours, one within the mouth of the other: the boxes round them overlap, each with each."""
    lows, wide = 0.9 * np.arange(count) / count, 0.4 / count
    side = np.array([[-0.9, -0.9], [0, 0], [0.9, -0.9]])
    return [np.concatenate([side, side[::-1] + [0, wide]]) + [0, low] for low in lows]


def scattered(seed: int, count: int = 40) -> list[np.ndarray]:
    """Stars of 4 to 9 points, thrown about at any size and turned either way round."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(count):
        n = int(rng.integers(4, 10))
        angle = np.sort(rng.random(n)) * 2 * np.pi
        radius = rng.uniform(0.3, 1, n) * rng.choice([0.02, 0.1, 0.4])
        star = rng.uniform(-1, 1, 2) + radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
        if Polygon(star).is_valid:
            found.append(star[:: rng.choice([-1, 1])])
    return found


def apart(contours: list[np.ndarray]) -> list[np.ndarray]:
    """Those whose rims meet none before them."""
    kept: list[np.ndarray] = []
    for contour in contours:
        rim = Polygon(contour).exterior
        if all(rim.distance(Polygon(other).exterior) > 1e-6 for other in kept):
            kept.append(contour)
    return kept


@pytest.mark.parametrize("seed", range(30))
def test_the_innermost_contour_around_each_is_found(seed):
    contours = apart(scattered(seed, 120))
    shapes = [Polygon(contour) for contour in contours]
    for k, found in enumerate(enclosing(contours)):
        around = [m for m, shape in enumerate(shapes) if m != k and shape.contains(shapes[k])]
        assert found == min(around, key=lambda m: shapes[m].area, default=-1)


@pytest.mark.parametrize("seed", range(30))
def test_contours_that_cross_are_found_and_those_apart_are_not(seed):
    contours = scattered(seed)
    rims = [Polygon(contour).exterior for contour in contours]
    near = np.array([[one.distance(other) <= NEAR for other in rims] for one in rims])
    np.fill_diagonal(near, False)
    close = np.zeros(len(contours), bool)
    close[close_contours(contours, NEAR)] = True
    assert not (close & ~near.any(axis=1)).any()
    assert not near[~close][:, ~close].any()  # of each pair one at least


@pytest.mark.parametrize("degrees", [0, 1e-7, 17, 45, 90, 133])
@pytest.mark.parametrize("gap", [0, 0.5 * NEAR, 3 * NEAR])
@pytest.mark.parametrize("place", ["side", "corner", "tip"])
def test_contours_that_nearly_touch_are_close_from_any_side(place, gap, degrees):
    box = np.array([[0.0, 0], [0.2, 0], [0.2, 0.2], [0, 0.2]])
    other = {
        "side": box + [0.2 + gap, 0.05],
        "corner": box + [0.2 + gap, 0.2],
        "tip": np.array([[0.2 + gap, 0.1], [0.4, 0.05], [0.4, 0.15]]),
    }[place]
    far = box - [0.5, 0.5]
    turned = [
        np.array(rotate(Polygon(c), degrees, origin=(0, 0)).exterior.coords)[:-1] for c in (box, far, other)
    ]
    assert close_contours(turned, NEAR).tolist() == ([0, 2] if gap <= NEAR else [])


@pytest.mark.nightly
def test_thousands_of_holes_that_interleave_are_told_apart():
    holes = chevrons(8000)
    cleaned, given = cleaned_contours(SQUARE, holes, edge=0.1)
    assert given is None
    assert len(cleaned) == 1 + len(holes)


def test_one_hole_within_thousands_is_named():
    holes = chevrons(2000)
    arm = (holes[700][0] + holes[700][1] + holes[700][4] + holes[700][5]) / 4
    holes.append(arm + 1e-5 * SQUARE)
    with pytest.raises(OutlineError, match="hole 2000: lies inside hole 700 "):
        cleaned_contours(SQUARE, holes, edge=0.1)
