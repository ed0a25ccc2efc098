"""The errors of a frame, against shapes whose answer is known and against brute force."""

from dataclasses import astuple

import numpy as np
import pytest
import trimesh

from sim_core.cloth.scenes import equilateral_sheet
from sim_core.errors import SimCoreError
from sim_core.learn.evaluation import FrameErrors, frame_errors, summary, two_sided

REST, FACES = equilateral_sheet(0.5, 0.4, 0.05)


def level(height: float = 0.0) -> np.ndarray:
    return np.column_stack([REST[:, 0], np.full(len(REST), height), REST[:, 1]])


def test_planes_3_mm_apart():
    found = frame_errors(level(0.003), level(), FACES, REST)
    assert astuple(found) == pytest.approx((0.003,) * 5 + (0.0, 0.0, 0, 0), abs=1e-12)


def test_hausdorff_against_brute_force():
    rng = np.random.default_rng(8)
    a, b = (level() + rng.normal(0, 0.02, (len(REST), 3)) for _ in range(2))

    def there(points: np.ndarray, places: np.ndarray) -> np.ndarray:
        corners = places[FACES]
        return np.array(
            [
                np.linalg.norm(
                    trimesh.triangles.closest_point(corners, np.tile(p, (len(FACES), 1))) - p, axis=1
                ).min()
                for p in points
            ]
        )

    found = frame_errors(a, b, FACES, REST)
    both = np.concatenate([there(a, b), there(b, a)])
    assert two_sided(a, FACES, b, FACES) == pytest.approx(both, abs=1e-12)
    assert (found.hausdorff, found.surface) == pytest.approx((both.max(), both.mean()), abs=1e-12)


def test_hausdorff_has_two_sides():
    spike = level()
    spike[40, 1] = 0.3
    assert frame_errors(spike, level(), FACES, REST).hausdorff == pytest.approx(0.3)
    assert frame_errors(level(), spike, FACES, REST).hausdorff == pytest.approx(0.3)
    coarse = equilateral_sheet(0.5, 0.4, 0.2)
    flat = np.column_stack([coarse[0][:, 0], 0 * coarse[0][:, 0], coarse[0][:, 1]])
    away = two_sided(flat, coarse[1], spike, FACES)
    assert away[: len(flat)].max() < 0.05 < away[len(flat) :].max()


def test_a_slide_in_the_plane_is_seen_by_vertices_alone():
    inner = np.flatnonzero((np.abs(REST - REST.mean(0)) < 0.1).all(1))
    slid = level()
    slid[inner, 0] += 0.004
    found = frame_errors(slid, level(), FACES, REST, over=inner)
    assert found.hausdorff < 1e-12
    assert (found.vertex, found.vertex_p95, found.vertex_max) == pytest.approx((0.004,) * 3)
    assert frame_errors(slid, level(), FACES, REST).vertex == pytest.approx(0.004 * len(inner) / len(REST))


def test_normals_and_strain():
    angle = np.radians(10)
    turn = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])
    tilted = frame_errors(level() @ turn, level(), FACES, REST)
    assert tilted.normal == pytest.approx(10.0)
    assert tilted.strain < 1e-12
    assert frame_errors(level() * 1.03, level(), FACES, REST).strain == pytest.approx(0.03)
    slight = frame_errors(
        level() + [[0, 1e-10, 0]] * (np.arange(len(REST)) == 40)[:, None], level(), FACES, REST
    )
    assert 0 < slight.normal < 1e-7


def test_intersections_are_those_of_each():
    rest, faces = np.concatenate([REST, REST]), np.concatenate([FACES, FACES + len(REST)])
    upright = np.column_stack([REST[:, 0], REST[:, 1] - 0.21, np.full(len(REST), 0.21)])
    crossed, parted = (np.concatenate([level(), upright + [0, rise, 0]]) for rise in (0.0, 1.0))
    there, back = frame_errors(crossed, parted, faces, rest), frame_errors(parted, crossed, faces, rest)
    assert there.intersections == back.reference_intersections > 10
    assert there.reference_intersections == back.intersections == 0


def test_summary_of_frames():
    errors = [frame_errors(level(h), level(), FACES, REST) for h in np.linspace(0.001, 0.101, 101)]
    found = summary(errors)
    assert found.frames == 101
    assert isinstance(found.mean, FrameErrors)
    assert (found.mean.hausdorff, found.p95.hausdorff) == pytest.approx((0.051, 0.096))
    with pytest.raises(SimCoreError, match="^errors: no frame"):
        summary([])


def test_evaluation_refuses():
    with pytest.raises(SimCoreError, match="^positions: vertex 0 is not finite"):
        frame_errors(level() * np.nan, level(), FACES, REST)
    with pytest.raises(SimCoreError, match="^reference, rest: shapes"):
        frame_errors(level(), level()[1:], FACES, REST)
    with pytest.raises(SimCoreError, match="^over: no vertex"):
        frame_errors(level(), level(), FACES, REST, over=[])
    with pytest.raises(SimCoreError, match="^over: index 5000"):
        frame_errors(level(), level(), FACES, REST, over=[5000])


def test_what_the_cloth_lies_on_stands_under_each_mesh() -> None:
    from sim_core.gltf import glb_parts, node_matrix
    from sim_core.learn.evaluation import Side, side_by_side_clip

    corners, faces = np.array([[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 1.0]]), np.array([[0, 1, 2]])
    frames = np.stack([corners, corners - [0.0, 0.1, 0.0]]).astype(np.float32)
    sides = [Side(name, "#336699", frames, faces) for name in ("coarse", "learned", "fine")]
    pot = np.array([[-0.5, 0.2, 0.0], [0.5, 0.2, 0.0], [0.0, 0.8, 0.0]])
    model, clip = side_by_side_clip(sides, 25.0, solid=(pot, faces))
    parts = glb_parts(model)
    nodes = {node["name"]: node for node in parts.document["nodes"]}

    def places(name: str) -> np.ndarray:
        mesh = parts.document["meshes"][nodes[name]["mesh"]]
        own = parts.numbers(mesh["primitives"][0]["attributes"]["POSITION"])
        return own + node_matrix(nodes[name])[:3, 3]

    assert clip.names == ("coarse", "learned", "fine")  # what stands is not moved
    assert len(parts.document["meshes"]) == 4  # and kept once
    for number, side in enumerate(sides, 1):
        shift = clip.positions(0, side.name) - corners
        assert np.abs(places(f"solid-{number}") - pot - shift[0]).max() < 1e-4
    assert places("solid-1")[:, 1].min() == pytest.approx(0.0)
