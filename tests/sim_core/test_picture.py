"""Stills: the rasteriser against a plain one, light shared between pictures, errors."""

from __future__ import annotations

import numpy as np
import pytest

from sim_core.errors import SimCoreError
from sim_core.picture import Camera, Fabric, Surface, depth_map, lighting, normals, render, split_along

SQUARE = np.array([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0], [0.5, 1.0, 0.0], [-0.5, 1.0, 0.0]])
FACES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
CAMERA = Camera((0.4, 0.9, 3.0), (0.0, 0.5, 0.0))


def _plain_depth(screen, faces, height, width):
    """Every pixel's middle against every triangle."""
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    depth = np.full((height, width), np.inf)
    for a, b, c in screen[faces]:
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        u = ((b[0] - x) * (c[1] - y) - (b[1] - y) * (c[0] - x)) / area
        v = ((c[0] - x) * (a[1] - y) - (c[1] - y) * (a[0] - x)) / area
        within = (u >= 0) & (v >= 0) & (u + v <= 1)
        z = u * a[2] + v * b[2] + (1 - u - v) * c[2]
        depth = np.where(within & (z < depth), z, depth)
    return depth


def test_depth_map_agrees_with_a_plain_one():
    rng = np.random.default_rng(3)
    screen = rng.uniform(-12, 60, (90, 3))
    # Steep, flat, tiny and axis-parallel triangles too.
    screen[:9] = np.array(
        [
            [5, 5, 1],
            [5, 30, 2],
            [9, 12, 1],
            [0, 8, 1],
            [47, 8, 2],
            [20, 8.4, 3],
            [7, 7, 1],
            [7.6, 7, 1],
            [7.3, 7.6, 1],
        ]
    )
    faces = np.arange(90, dtype=np.int32).reshape(-1, 3)
    depth = np.full((40, 48), np.inf)
    depth_map(screen, faces, depth)
    plain = _plain_depth(screen, faces, 40, 48)
    differs = np.isinf(depth) != np.isinf(plain)
    assert differs.sum() <= 2  # middles on an edge, decided by the last bit
    both = ~np.isinf(depth) & ~np.isinf(plain)
    assert both.sum() > 500
    np.testing.assert_allclose(depth[both], plain[both], atol=1e-9)


def test_depth_map_leaves_out_what_has_no_area():
    screen = np.array([[1.0, 1, 0], [5, 5, 0], [9, 9, 0]])
    depth = np.full((12, 12), np.inf)
    depth_map(screen, np.array([[0, 1, 2]], np.int32), depth)
    assert np.isinf(depth).all()


def test_light_is_shared_between_pictures():
    surfaces = [Surface(SQUARE, FACES, (0.7, 0.2, 0.2), alpha=0.6), Surface(SQUARE - [0, 0, 0.3], FACES)]
    lit = lighting(surfaces)
    np.testing.assert_array_equal(
        render(surfaces, CAMERA, (80, 60), lit=lit), render(surfaces, CAMERA, (80, 60))
    )


def test_floor_and_wall_meet_without_a_line():
    picture = render(
        [Surface(SQUARE, FACES, (0.8, 0.2, 0.2))], Camera((0.0, 0.9, 3.4), (0.0, 0.6, 0.0)), (240, 180)
    )
    # Where nothing stands and no shadow falls.
    beside = picture[:, [*range(20), *range(230, 240)]].astype(int)
    assert np.abs(np.diff(beside, axis=0)).max() <= 2
    under = picture[:, 120].astype(int)
    assert under.min(0).tolist() < beside.min((0, 1)).tolist()


def test_the_sky_of_other_pictures_serves_again():
    """A film's pictures between two share what was seen of the sky then."""
    surfaces = [Surface(SQUARE, FACES), Surface(SQUARE - [0, 0, 0.3], FACES)]
    lit = lighting(surfaces)
    again, dark = lighting(surfaces, sky=lit.sky), lighting(surfaces, sky=0.2 * lit.sky)
    pictures = [render(surfaces, CAMERA, (80, 60), lit=light).astype(int) for light in (lit, again, dark)]
    np.testing.assert_array_equal(pictures[0], pictures[1])
    assert pictures[2].mean() < pictures[0].mean()


def test_a_pixel_that_one_face_fills_is_shaded_once_and_looks_the_same():
    """Fine faces are shaded at each sample, a coarse one once a pixel: a flat square is one colour either way."""
    steps = np.linspace(0.0, 1.0, 41)
    u, v = (part.ravel() for part in np.meshgrid(steps, steps, indexing="ij"))
    fine = np.column_stack([u - 0.5, v, 0 * u])
    a = (np.arange(40)[:, None] * 41 + np.arange(40)).ravel()
    faces = np.concatenate([np.stack([a, a + 41, a + 42], 1), np.stack([a, a + 42, a + 1], 1)]).astype(
        np.int32
    )
    seen = []
    for surface in (Surface(SQUARE, FACES), Surface(fine, faces)):
        lit = lighting([surface], floor=False, sky=np.ones(len(surface.vertices)))
        seen.append(render([surface], CAMERA, (80, 60), lit=lit).astype(int))
    assert np.abs(seen[0] - seen[1]).max() <= 1


def test_a_sheer_square_shows_what_is_behind_it():
    def middle(alpha):
        surfaces = [
            Surface(SQUARE, FACES, (0.9, 0.0, 0.0), alpha=alpha),
            Surface(SQUARE - [0, 0, 0.3], FACES, (0.0, 0.0, 0.9)),
        ]
        return render(surfaces, CAMERA, (80, 60), floor=False)[30, 40].astype(int)

    red, veil = middle(1.0), middle(0.4)
    assert red[0] > 3 * red[2]
    assert veil[2] > veil[0] > red[2]


@pytest.mark.parametrize(
    ("vertices", "says"),
    [(np.zeros((0, 3)), "expected"), (np.full((4, 3), np.nan), "not finite")],
)
def test_nothing_to_draw_is_said(vertices, says):
    with pytest.raises(SimCoreError, match=says):
        render([Surface(vertices, FACES)], CAMERA, (8, 6))


def test_a_fabric_covers_a_surface_in_true_scale():
    """A square of a metre in a check of 25 cm: four fields each way, the first at the upper left, seen head-on."""
    picture = np.zeros((2, 2, 3), np.uint8)
    picture[0, 0] = picture[1, 1] = (255, 60, 60)
    picture[0, 1] = picture[1, 0] = (60, 60, 255)
    flat = np.column_stack([SQUARE[:, 0] + 0.5, 1.0 - SQUARE[:, 1]])  # y down
    surface = Surface(SQUARE, FACES, (1.0, 1.0, 1.0), fabric=Fabric(picture, (0.5, 0.5)), corners=flat[FACES])
    seen = render(
        [surface], Camera((0.0, 0.5, 4.0), (0.0, 0.5, 0.0), 2 * np.degrees(np.arctan(1 / 8))), (80, 80)
    )
    red = seen[..., 0].astype(int) - seen[..., 2]
    for row in range(4):
        for column in range(4):
            field = red[20 * row + 4 : 20 * row + 16, 20 * column + 4 : 20 * column + 16]
            assert (field > 20).all() if (row + column) % 2 == 0 else (field < -20).all()
    plain = render([Surface(SQUARE, FACES, (1.0, 1.0, 1.0))], CAMERA, (40, 30))
    white = Fabric(np.full((3, 3, 3), 255, np.uint8), (0.1, 0.1))
    covered = Surface(SQUARE, FACES, (1.0, 1.0, 1.0), fabric=white, corners=flat[FACES])
    np.testing.assert_array_equal(render([covered], CAMERA, (40, 30)), plain)


def test_corners_that_are_not_the_faces_are_refused():
    corners = np.zeros((3, 3, 2))
    fabric = Fabric(np.zeros((1, 1, 3), np.uint8), (0.1, 0.1))
    with pytest.raises(SimCoreError, match=r"corners \(3, 3, 2\) of 2 faces"):
        lighting([Surface(SQUARE, FACES, fabric=fabric, corners=corners)])


def test_normals_are_smooth_up_to_a_crease_and_not_over_it():
    """A strip folded to a right angle along its middle, with and without the crease told."""
    x = np.array([[-1.0, 0, 0], [-1, 0, 1], [0, 0, 0], [0, 0, 1], [0, 1, 0], [0, 1, 1]])
    faces = np.array([[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]], np.int32)
    same, source = split_along(faces, np.zeros((0, 2), np.int32))
    np.testing.assert_array_equal(same, faces)
    split, source = split_along(faces, np.array([[3, 2]], np.int32))
    assert len(source) == 8  # both ends of the crease are there twice
    np.testing.assert_array_equal(source[split], faces)
    assert not set(split[:2].ravel()) & set(split[2:].ravel())
    shading = normals(x[source], split)
    for own in (split[:2], split[2:]):
        flat = shading[np.unique(own)]
        np.testing.assert_allclose(flat, np.tile(flat[0], (len(flat), 1)), atol=1e-12)  # each side is flat
    assert abs(float(shading[split[0, 0]] @ shading[split[2, 2]])) < 1e-12
