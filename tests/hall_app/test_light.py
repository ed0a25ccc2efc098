"""The light baker against analytic light, brute force and itself."""

import dataclasses
import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from light_rooms import box, level, quads

from hall_app.light import SHOULDER, WALL, LightError, Sampling, Spot, bake_light, light_jpeg, show
from hall_app.light.atlas import atlas_of, pack
from hall_app.light.rays import blocked, build_tree, cast

PLAIN = {"fill_light": 0.0, "filtered": False}


def lamp_free(light, surfaces):
    """Light without the lamps' own glow, for rooms of one albedo and emission."""
    return light.image[light.covered] - surfaces.emission[0] / np.maximum(surfaces.albedo[0], 0.05)


@pytest.mark.parametrize("bounces", [1, 2, 4])
def test_furnace_sums_the_series(bounces):
    room = quads(box((0, 0, 0), (2, 1.5, 3), inward=True), albedo=0.5, emission=1.0, density=4)
    light = bake_light(room, sampling=Sampling((64,) * bounces), **PLAIN)
    expected = sum(0.5**k for k in range(bounces))
    found = lamp_free(light, room)
    assert found.mean() == pytest.approx(expected, rel=0.01)
    assert light.record["missed"] == 0.0
    assert light.record["inside"] == 0.0


def test_furnace_reaches_its_limit():
    room = quads(box((0, 0, 0), (1, 1, 1), inward=True), albedo=0.5, emission=1.0, density=4)
    light = bake_light(room, sampling=Sampling((36,) * 12, lamp_share=0.0), **PLAIN)
    assert np.abs(lamp_free(light, room) - 2.0).max() < 0.001


@pytest.mark.parametrize("share", [0.0, 1 / 3])
def test_parallel_squares(share):
    # Two unit squares at distance 1: form factor 0.1998 (Howell, configuration C-11).
    floor, lamp = level(0, 1, 0, 1, 0), level(0, 1, 0, 1, 1, up=False)
    light = bake_light(
        quads([floor, lamp], emission=[0, 1], density=[10, 4]),
        sampling=Sampling((256,), lamp_share=share),
        **PLAIN,
    )
    assert _chart(light, 0).mean() == pytest.approx(0.19982, rel=0.01)


def test_perpendicular_squares():
    # Two unit squares with a common edge: form factor 0.20004 (Howell, configuration C-14).
    floor = level(0, 1, 0, 1, 0)
    lamp = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    light = bake_light(
        quads([floor, lamp], emission=[0, 1], density=[20, 4]), sampling=Sampling((256,)), **PLAIN
    )
    assert _chart(light, 0).mean() == pytest.approx(0.20004, rel=0.015)


def _chart(light, quad):
    """Texels of a quad's chart, row-major."""
    height, width = light.image.shape[:2]
    corners = light.uv[2 * quad : 2 * quad + 2].reshape(-1, 2) * [width, height]
    (x0, y0), (x1, y1) = np.round(corners.min(0)).astype(int), np.round(corners.max(0)).astype(int)
    return light.image[y0:y1, x0:x1]


def test_sphere_hides_part_of_the_sky():
    # A black sphere of angular radius asin(r/d) above a point hides (r/d)² of a uniform sky.
    import trimesh

    ball = trimesh.creation.icosphere(3, 1.0)
    sky = box((-20, -20, -20), (20, 20, 20), inward=True)
    small = level(-0.02, 0.02, -0.02, 0.02, -2.0)
    room = quads([*sky, small], emission=[1.0] * 6 + [0.0], density=[0.1] * 6 + [50.0])
    count = len(ball.faces)
    joined = dataclasses.replace(
        room,
        vertices=np.r_[room.vertices, ball.vertices],
        faces=np.r_[room.faces, ball.faces + len(room.vertices)].astype(np.int32),
        chart=np.r_[room.chart, np.full(count, -1)].astype(np.int32),
        chart_uv=np.r_[room.chart_uv, np.zeros((count, 3, 2))],
        albedo=np.r_[room.albedo, np.zeros((count, 3))].astype(np.float32),
        emission=np.r_[room.emission, np.zeros((count, 3))].astype(np.float32),
    )
    light = bake_light(joined, sampling=Sampling((4000,)), **PLAIN)
    assert _chart(light, 6).mean() == pytest.approx(1 - 0.25, abs=0.01)


def test_disc_lamp_over_a_point():
    # A disc of radius r at height h over a point facing it: light r² / (r² + h²).
    angle = np.linspace(0, 2 * np.pi, 65)
    ring = np.column_stack([np.cos(angle), np.full(65, 1.5), np.sin(angle)])
    middle = np.broadcast_to([0, 1.5, 0], (64, 3))
    corners = np.stack([ring[:-1], ring[1:], (ring[1:] + middle) / 2, (ring[:-1] + middle) / 2], 1)
    inner = np.stack([(ring[:-1] + middle) / 2, (ring[1:] + middle) / 2, middle, middle], 1)
    small = level(-0.02, 0.02, -0.02, 0.02, 0.0)
    lamp = quads(
        np.concatenate([[small], corners, inner]),
        emission=[0.0] + [1.0] * 128,
        density=50.0,
        charted=[True] + [False] * 128,
    )
    light = bake_light(lamp, sampling=Sampling((2000,)), **PLAIN)
    assert _chart(light, 0).mean() == pytest.approx(1 / (1 + 1.5**2), rel=0.02)


def test_edge_of_a_spots_shadow():
    # A board's edge half way between a point of light and the floor throws its shadow twice as far.
    floor = level(-2, 2, -0.5, 0.5, 0)
    board = level(0.2, 2, -2, 2, 1)
    under = level(0.2, 2, -2, 2, 0.99, up=False)
    spot = Spot(np.array([0, 2.0, 0]), np.array([0, 0.0, 0]), np.ones(3), 4.0, 60.0, 10.0, radius=0.0)
    light = bake_light(
        quads([floor, board, under], density=[40, 4, 4]), [spot], sampling=Sampling((4,)), **PLAIN
    )
    row = _chart(light, 0)[20, :, 0]
    x = (np.arange(160) + 0.5) / 40 - 2
    assert row[(x < 0.36)].min() > 0.3
    assert row[(x > 0.44)].max() == 0.0
    assert row[80] == pytest.approx(1.0, rel=0.01)


def test_energy_is_never_gained():
    solid = np.concatenate([box((0, 0, 0), (4, 3, 4), inward=True), box((1, 0, 1), (2, 1, 2))])
    lamp = level(1, 3, 1, 3, 2.9, up=False)
    room = quads([*solid, lamp], albedo=0.9, emission=[0] * 12 + [1.0], density=5)
    last = 0.0
    for passes in (1, 2, 4):
        light = bake_light(room, sampling=Sampling((36,) * passes), fill_light=0.0)
        mean = np.concatenate([_chart(light, k).reshape(-1, 3) for k in range(6)]).mean()
        assert last < mean < 1.0
        last = mean


def test_sheet_shows_the_mean_of_both_sides():
    sheet = level(0, 1, 0, 1, 1)
    lamp = level(-50, 50, -50, 50, 2, up=False)
    light = bake_light(
        quads([sheet, lamp], emission=[0, 1], density=[4, 0.1], two_sided=[True, False]),
        sampling=Sampling((128,)),
        **PLAIN,
    )
    assert _chart(light, 0).mean() == pytest.approx(0.5, rel=0.02)


def test_coplanar_charts_meet_without_a_seam():
    halves = [level(0, 2, 0, 4, 0), level(2, 4, 0, 4, 0)]
    lamp = level(0.5, 2.5, 1, 3, 2.5, up=False)
    light = bake_light(
        quads([*halves, lamp], emission=[0, 0, 1], density=[10, 10, 2]), sampling=Sampling((36, 144))
    )
    left, right = _chart(light, 0), _chart(light, 1)
    left = left if left.shape[:2] == (40, 20) else left.transpose(1, 0, 2)
    right = right if right.shape[:2] == (40, 20) else right.transpose(1, 0, 2)
    step = np.abs(left[:, -1] - right[:, 0])
    assert (step / left[:, -1]).max() < 0.08


def test_nothing_leaks_into_a_body():
    solid = np.concatenate([box((0, 0, 0), (4, 3, 4), inward=True), box((1, 0, 1), (2, 1, 2))])
    room = quads([*solid], albedo=0.5, emission=[1.0] * 5 + [0.0] * 7, density=10)
    light = bake_light(room, sampling=Sampling((36, 36)), **PLAIN)
    floor = _chart(light, 5)
    assert floor.min() > 0.1  # texels under the box are filled, not black
    assert light.record["inside"] > 0


@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 2**31), count=st.integers(1, 300))
def test_tree_finds_what_brute_force_finds(seed, count):
    rng = np.random.default_rng(seed)
    corners = (rng.uniform(-1, 1, (count, 1, 3)) + rng.normal(0, 0.2, (count, 3, 3))).astype(np.float32)
    corners[0, 2] = corners[0, 1]  # without area
    faces = np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
    origins = rng.uniform(-2, 2, (10_000 // 8, 3)).astype(np.float32)
    toward = rng.normal(size=origins.shape)
    toward = (toward / np.linalg.norm(toward, axis=1)[:, None]).astype(np.float32)
    face, distance, *_ = cast(build_tree(corners.reshape(-1, 3).astype(float), faces), origins, toward)
    best, rim = _brute(corners.astype(float), origins.astype(float), toward.astype(float))
    sure = ~rim
    assert ((face >= 0) == np.isfinite(best))[sure].all()
    both = sure & (face >= 0)
    assert np.allclose(distance[both], best[both], rtol=1e-3, atol=1e-4)


def test_no_ray_slips_between_neighbours():
    """Aimed at corners and edges of a closed ball from inside, and past its edges at a hair's breadth."""
    import trimesh

    ball = trimesh.creation.icosphere(3, 1.0)
    tree = build_tree(ball.vertices, ball.faces)
    rng = np.random.default_rng(0)
    ends = ball.vertices[ball.edges_unique]
    along = rng.random((40, len(ends), 1))
    edges = (ends[:, 0] * along + ends[:, 1] * (1 - along)).reshape(-1, 3)
    aims = np.concatenate([ball.vertices, edges, edges + rng.normal(0, 1e-7, edges.shape)])
    eyes = rng.uniform(-0.5, 0.5, aims.shape)
    way = (aims - eyes) / np.linalg.norm(aims - eyes, axis=1)[:, None]
    face, distance, *_ = cast(tree, eyes, way)
    assert (face >= 0).all()
    assert np.abs(distance - np.linalg.norm(aims - eyes, axis=1)).max() < 1e-5
    singles = eyes.astype(np.float32), way.astype(np.float32)
    assert blocked(tree, *singles, distance + np.float32(1e-3)).all()
    assert not blocked(tree, *singles, distance - np.float32(1e-3)).any()


def _brute(corners, origins, toward):
    """Nearest distance (inf: none), and whether any triangle was met near its rim or edge on."""
    best, rim = np.full(len(origins), np.inf), np.zeros(len(origins), bool)
    for a, b, c in corners[1:]:
        e, f = b - a, c - a
        p = np.cross(toward, f)
        det = p @ e
        t = origins - a
        with np.errstate(all="ignore"):
            u = (t * p).sum(1) / det
            q = np.cross(t, e)
            v, far = (toward * q).sum(1) / det, (q @ f) / det
        near = np.min([u, v, 1 - u - v], axis=0)
        met = (near >= 0) & (far > 0)
        rim |= (np.abs(near) < 1e-3) & (far > -1e-3) | (np.abs(det) < 1e-5) | (np.abs(far) < 1e-3)
        best = np.where(met & (far < best), far, best)
    return best, rim


@settings(max_examples=30, deadline=None)
@given(st.lists(st.tuples(st.integers(3, 40), st.integers(3, 40)), min_size=1, max_size=80))
def test_packing_never_overlaps(sizes):
    boxes = np.array(sizes, np.int32)
    corners, width, height = pack(boxes)
    taken = np.zeros((height, width), int)
    for (x, y), (w, h) in zip(corners, boxes, strict=True):
        assert x >= 0
        assert y >= 0
        taken[y : y + h, x : x + w] += 1
    assert taken.max() == 1
    assert taken.sum() == boxes.prod(1).sum()


def test_charts_keep_their_borders():
    light = bake_light(
        quads(box((0, 0, 0), (1, 2, 3), inward=True), emission=1.0, density=5), sampling=Sampling((4,))
    )
    height, width = light.covered.shape
    for k in range(6):
        corners = np.round(light.uv[2 * k : 2 * k + 2].reshape(-1, 2) * [width, height]).astype(int)
        (x0, y0), (x1, y1) = corners.min(0), corners.max(0)
        ring = light.covered[y0 - 1 : y1 + 1, x0 - 1 : x1 + 1].copy()
        ring[1:-1, 1:-1] = False
        assert not ring.any()
        assert np.array_equal(light.image[y0 - 1, x0:x1], light.image[y0, x0:x1])


class Stopped(Exception):
    """What interrupts a bake."""


def test_the_state_of_another_bake_is_not_taken(tmp_path):
    """The same room at another seed, and another room: their passes would be mixed without a word."""
    sides, kept = box((0, 0, 0), (2, 2, 2), inward=True), tmp_path / "light.npz"
    room = quads(sides, albedo=0.5, emission=[1, 0, 0, 0, 0, 0], density=8)
    other = quads(sides, albedo=0.5, emission=[0, 1, 0, 0, 0, 0], density=8)

    def stop(share, label):
        if label == "pass 3 of 3":
            raise Stopped

    with pytest.raises(Stopped):
        bake_light(room, sampling=Sampling((9, 9, 16), seed=3), progress=stop, checkpoint=kept)
    state = kept.read_bytes()
    for surfaces, seed in ((room, 4), (other, 3)):
        kept.write_bytes(state)
        resumed = bake_light(surfaces, sampling=Sampling((9, 9, 16), seed=seed), checkpoint=kept)
        assert np.array_equal(
            resumed.image, bake_light(surfaces, sampling=Sampling((9, 9, 16), seed=seed)).image
        )


def test_resumed_bake_has_the_same_bits(tmp_path):
    room = quads(box((0, 0, 0), (2, 2, 2), inward=True), albedo=0.5, emission=[1, 0, 0, 0, 0, 0], density=8)
    whole = bake_light(room, sampling=Sampling((9, 9, 16), seed=3))
    kept = tmp_path / "light.npz"

    def stop(share, label):
        if label == "pass 3 of 3":
            raise Stopped

    with pytest.raises(Stopped):
        bake_light(room, sampling=Sampling((9, 9, 16), seed=3), progress=stop, checkpoint=kept)
    labels = []
    resumed = bake_light(
        room,
        sampling=Sampling((9, 9, 16), seed=3),
        progress=lambda share, label: labels.append(label),
        checkpoint=kept,
    )
    assert np.array_equal(whole.image, resumed.image)
    assert "pass 2 of 3" not in labels
    kept.write_bytes(b"damaged")
    assert np.array_equal(
        whole.image, bake_light(room, sampling=Sampling((9, 9, 16), seed=3), checkpoint=kept).image
    )
    assert not np.array_equal(whole.image, bake_light(room, sampling=Sampling((9, 9, 16), seed=4)).image)


def test_light_depends_on_neither_threads_nor_chunks(monkeypatch):
    room = quads(box((0, 0, 0), (2, 2, 2), inward=True), albedo=0.5, emission=[1, 0, 0, 0, 0, 0], density=8)
    spot = Spot(np.array([1, 1.9, 1]), np.array([1, 0.0, 1]), np.ones(3), 5.0, 20.0, 10.0)
    whole = bake_light(room, [spot], sampling=Sampling((9, 16)))
    for threads, chunk in ((1, 100), (3, 1), (2, 1 << 20)):
        monkeypatch.setattr("hall_app.light.rays.sampling._threads", lambda threads=threads: threads)
        monkeypatch.setattr("hall_app.light.rays.sampling._CHUNK", chunk)
        parts = bake_light(room, [spot], sampling=Sampling((9, 16)))
        assert np.array_equal(whole.image, parts.image)
        assert whole.record["rays"] == parts.record["rays"]


CORES = """
import numpy as np
from hall_app.light.rays import build_tree, cast
rng = np.random.default_rng(0)
corners = rng.uniform(-1, 1, (30_000, 1, 3)) + rng.normal(0, 0.05, (30_000, 3, 3))
faces = np.arange(90_000, dtype=np.int32).reshape(-1, 3)
twice = np.concatenate([faces, faces[::-1]])  # two faces at every place: nothing but the tree decides which is met
way = rng.normal(size=(20_000, 3))
found = cast(build_tree(corners.reshape(-1, 3), twice), np.zeros_like(way), way / np.linalg.norm(way, axis=1)[:, None])
print(*(hash(array.tobytes()) for array in found))
"""


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="needs sched_setaffinity to take cores away")
def test_rays_meet_the_same_on_one_core():
    """The tree is made by as many threads as there are cores; which of two equal faces is met must not tell."""
    environment = {**os.environ, "PYTHONHASHSEED": "0"}
    whole, alone = (
        subprocess.run(
            [sys.executable, "-c", first + CORES], env=environment, capture_output=True, check=True
        ).stdout
        for first in ("", "import os; os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})\n")
    )
    assert whole == alone


def test_without_embree_one_line_tells_what_to_do(monkeypatch):
    monkeypatch.setitem(sys.modules, "embreex.rtcore_scene", None)
    with pytest.raises(
        LightError, match=r"^light: rays: embreex cannot be loaded .* – `pip install embreex`"
    ):
        build_tree(np.eye(3), np.array([[0, 1, 2]]))


def test_picture_stays_below_white_except_on_lamps():
    room = quads(box((0, 0, 0), (4, 3, 4), inward=True), albedo=0.8, emission=[0, 0, 0, 0, 3.0, 0], density=5)
    spot = Spot(np.array([2, 2.9, 2]), np.array([2, 0.0, 2]), np.ones(3), 50.0, 20.0, 10.0)
    light = bake_light(room, [spot], sampling=Sampling((16, 16)))
    for k in (0, 1, 2, 3, 5):
        height, width = light.covered.shape
        corners = np.round(light.uv[2 * k : 2 * k + 2].reshape(-1, 2) * [width, height]).astype(int)
        (x0, y0), (x1, y1) = corners.min(0), corners.max(0)
        assert 0.8 * light.shown[y0:y1, x0:x1].max() <= 1.0 + 1e-5
    assert light_jpeg(light)[:2] == b"\xff\xd8"
    assert light_jpeg(light) == light_jpeg(light)


def test_highlights_keep_their_shades():
    """What is brighter than the shoulder still grows brighter, ever more slowly, and never reaches white."""
    room = quads(box((0, 0, 0), (4, 3, 4), inward=True), albedo=0.8, density=10)
    atlas = atlas_of(room)
    image = np.full((atlas.height, atlas.width, 3), 1.0, np.float32)
    inside = np.argwhere(atlas.chart_image() == 5)
    # The floor; walls set the gain.
    ramp = np.linspace(1.0, 1.28 / WALL, len(inside)).astype(np.float32)
    image[inside[:, 0], inside[:, 1]] = ramp[:, None]
    found = show(room, atlas, image)
    asked = WALL * ramp
    drawn = 0.8 * found.shown[inside[:, 0], inside[:, 1], 0]
    low = asked < SHOULDER
    assert np.allclose(drawn[low], asked[low], rtol=1e-3)
    assert (np.diff(drawn) > 0).all()
    assert drawn.max() < 0.995
    assert drawn[asked > 1.1].min() > SHOULDER + 0.5 * (1 - SHOULDER)
    assert 0.85 <= SHOULDER <= 0.92
    assert found.rolled == pytest.approx((~low).sum() / (atlas.chart_image() >= 0).sum(), rel=0.02)


def test_faces_without_chart_hide_and_reflect():
    floor, lamp = level(0, 2, 0, 2, 0), level(0, 2, 0, 2, 2, up=False)
    shade = level(0, 2, 0, 2, 1)
    room = quads(
        [floor, lamp, shade],
        albedo=[0, 0, 0.8],
        emission=[0, 1, 0],
        density=5,
        charted=[True, True, False],
    )
    light = bake_light(room, sampling=Sampling((64, 64)), **PLAIN)
    bare = bake_light(quads([floor, lamp], emission=[0, 1], density=5), sampling=Sampling((64,)), **PLAIN)
    assert _chart(light, 0).mean() < 0.5 * _chart(bare, 0).mean()
    assert (light.uv[4:] == 0).all()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"vertices": np.full((24, 3), np.nan)}, "vertices"),
        ({"faces": np.full((12, 3), 99, np.int32)}, "faces"),
        ({"albedo": np.full((12, 3), 1.5, np.float32)}, "albedo"),
        ({"density": np.zeros(6)}, "density"),
        ({"faces": np.zeros((0, 3), np.int32)}, "no triangles"),
        ({"chart": np.zeros(5, np.int32)}, "shape"),
    ],
)
def test_errors_name_what_and_where(change, words):
    room = quads(box((0, 0, 0), (1, 1, 1)))
    with pytest.raises(LightError, match=words):
        dataclasses.replace(room, **change)
    with pytest.raises(LightError, match="towards"):
        Spot(np.zeros(3), np.zeros(3), np.ones(3), 1.0, 20.0, 5.0)


def test_only_triangles_without_area():
    room = quads(np.zeros((1, 4, 3)))
    assert np.isfinite(bake_light(room, sampling=Sampling((4,))).image).all()
