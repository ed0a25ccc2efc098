"""The clearance grid: honest samples, what can be reached, a cache that mends itself."""

import math

import numpy as np
import pytest
from walk_moves import FLOOR, room

from hall_app.walk import (
    BODY,
    Body,
    Floor,
    Keys,
    Pose,
    Prism,
    Round,
    UnreachableError,
    bake,
    cached_grid,
    flood,
    grid_key,
    step,
    wall,
)

ROOM = ((0, 0), (4, 0), (4, 3), (0, 3))
DIVIDED = Floor(ROOM, (wall((2, 0), (2, 3), 0.1), Round(1, 1.5, 0.2)))


def places(grid):
    nz, nx = grid.samples.shape
    return np.stack(np.meshgrid(grid.x0 + grid.cell * np.arange(nx), grid.z0 + grid.cell * np.arange(nz)), -1)


def test_samples_are_the_exact_clearance_rounded_down():
    grid = bake(FLOOR)
    true = room(places(grid), FLOOR).reshape(grid.samples.shape)
    clear = true > -0.28
    error = grid.clearance[clear] - np.minimum(true[clear], 32767e-4)
    assert error.max() <= 1e-6
    assert error.min() >= -1.01e-4
    assert np.all(grid.clearance[true < -BODY.radius - 1e-3] == pytest.approx(-BODY.radius))


def test_bytes_and_description_agree():
    grid = bake(DIVIDED)
    meta = grid.meta()
    again = np.frombuffer(grid.to_bytes(), "<i2").reshape(meta["nz"], meta["nx"])
    np.testing.assert_array_equal(again, grid.samples)
    assert meta["x0"] + meta["cell"] * (meta["nx"] - 1) >= 4 + meta["cell"]
    assert meta["z0"] + meta["cell"] * (meta["nz"] - 1) >= 3 + meta["cell"]


def test_only_this_side_of_the_wall_is_reachable():
    grid = bake(DIVIDED)
    mask, spots = flood(grid, (0.5, 0.5)), places(bake(DIVIDED))
    assert spots[mask][:, 0].max() < 2
    assert np.all(mask[grid.free & (spots[..., 0] < 2)])
    assert not np.any(mask & ~grid.free)


def test_reachable_spots_can_be_walked_to():
    """From any reachable sample each reachable neighbour is one step away."""
    grid, rng = bake(DIVIDED), np.random.default_rng(2)
    mask = flood(grid, (0.5, 0.5))
    for iz, ix in rng.permutation(np.argwhere(mask))[:60]:
        for dz, dx in ((0, 1), (1, 0), (1, 1), (-1, 1)):
            if not mask[iz + dz, ix + dx]:
                continue
            x, z = grid.x0 + ix * grid.cell, grid.z0 + iz * grid.cell
            pose = Pose(x, z, math.atan2(-dx, -dz))
            after = step(pose, Keys(1, 0), grid.cell * math.hypot(dx, dz) / 1.6, DIVIDED)
            assert math.hypot(after.x - x - dx * grid.cell, after.z - z - dz * grid.cell) < 0.005


def test_nearest_free_spot():
    grid = bake(DIVIDED)
    x, z = grid.nearest_free(1.0, 1.5)
    assert BODY.skin <= room(np.array([[x, z]]), DIVIDED)[0] < 0.05
    assert grid.reach((0.5, 0.5)).spot(3.9, 1.5)[0] < 2
    with pytest.raises(UnreachableError, match="move a solid"):
        bake(Floor(ROOM, (Prism(((-1, -1), (5, -1), (5, 4), (-1, 4))),))).nearest_free(1, 1)


def test_outline_bounds_the_walk_even_with_a_notch():
    floor = Floor(((0, 0), (4, 0), (4, 3), (2.5, 3), (2.5, 1.5), (1.5, 1.5), (1.5, 3), (0, 3)))
    grid = bake(floor)
    spots = places(grid)[flood(grid, (0.5, 2.5))]
    assert room(spots, floor).min() >= BODY.skin
    assert spots[:, 0].max() > 3.5  # round the notch to the other side


def test_progress_runs_to_one():
    seen = []
    bake(DIVIDED, cell=0.1, progress=lambda fraction, label: seen.append(fraction))
    assert seen == sorted(seen)
    assert seen[-1] == 1
    with pytest.raises(ValueError, match="use less"):
        bake(DIVIDED, cell=0.2)


def test_cache_is_used_mended_and_bounded(tmp_path, monkeypatch):
    first = cached_grid(DIVIDED, tmp_path, cell=0.1)
    (path,) = tmp_path.iterdir()
    monkeypatch.setattr("hall_app.walk.grid.bake", lambda *a, **k: pytest.fail("baked although cached"))
    np.testing.assert_array_equal(cached_grid(DIVIDED, tmp_path, cell=0.1).samples, first.samples)
    monkeypatch.undo()
    good = path.read_bytes()
    for bad in (b"", b"not a grid", good[:-7], good[:-1] + b"\x01", b"[]\n" + good):
        path.write_bytes(bad)
        np.testing.assert_array_equal(cached_grid(DIVIDED, tmp_path, cell=0.1).samples, first.samples)
        assert path.read_bytes() == good
    for k in range(12):
        cached_grid(Floor(ROOM, (Round(1 + k / 10, 1, 0.2),)), tmp_path, cell=0.1)
    assert len(list(tmp_path.iterdir())) == 8


def test_cache_without_a_folder_to_write_to(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    assert cached_grid(DIVIDED, blocked / "grids", cell=0.1).free.any()


def test_key_depends_on_what_the_samples_depend_on():
    keys = {
        grid_key(DIVIDED),
        grid_key(Floor(ROOM, DIVIDED.solids[:1])),
        grid_key(DIVIDED, cell=0.1),
        grid_key(DIVIDED, body=Body(radius=0.25)),
    }
    assert len(keys) == 4
    assert grid_key(DIVIDED) == grid_key(Floor(ROOM, DIVIDED.solids))
