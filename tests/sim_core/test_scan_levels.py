"""From a dense scan to coarse models: condition, standing, levels of measured deviation, colours kept."""

from __future__ import annotations

import numpy as np
import pytest
import scan_like

from sim_core import metrics
from sim_core.gltf import glb_parts
from sim_core.mesh.scan import (
    UPWARDS,
    Colours,
    Fine,
    Scan,
    ScanError,
    chosen_level,
    cleaned,
    coarsened,
    laid_out,
    largest_part,
    painted,
    scan_glb,
    stood,
)


def sphere(rings: int = 80, radius: float = 0.5) -> tuple[np.ndarray, np.ndarray]:
    """A ball of about 4 rings^2 triangles: vertices (V, 3), faces (F, 3)."""
    around = 2 * rings
    theta = np.linspace(0, np.pi, rings + 1)[1:-1]
    phi = np.arange(around) * 2 * np.pi / around
    t, p = np.meshgrid(theta, phi, indexing="ij")
    ring = np.stack([np.sin(t) * np.cos(p), np.cos(t), np.sin(t) * np.sin(p)], axis=-1).reshape(-1, 3)
    vertices = radius * np.concatenate([ring, [[0, 1, 0], [0, -1, 0]]])
    i = np.arange(len(ring)).reshape(rings - 1, around)
    a, b = i, np.roll(i, -1, axis=1)
    faces = [np.stack([a[:-1], b[:-1], b[1:]], -1), np.stack([a[:-1], b[1:], a[1:]], -1)]
    top, bottom = np.full(around, len(ring)), np.full(around, len(ring) + 1)
    faces = [f.reshape(-1, 3) for f in faces]
    faces += [np.stack([top, b[0], a[0]], -1), np.stack([bottom, a[-1], b[-1]], -1)]
    return vertices, np.concatenate(faces).astype(np.int32)


def bare(vertices: np.ndarray, faces: np.ndarray, colours: np.ndarray | None = None) -> Scan:
    return Scan(vertices, faces, None, np.full(len(faces), -1, np.int16), (), colours)


def outwards(vertices: np.ndarray, faces: np.ndarray) -> float:
    """Share of a ball's faces that look away from its middle."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float((np.einsum("fk,fk->f", np.cross(b - a, c - a), a + b + c) > 0).mean())


def test_a_ball_stays_a_closed_ball():
    vertices, faces = sphere()
    for left, level in coarsened(vertices, faces, (4000, 1000, 200)):
        if level is None:
            continue
        wanted = next(count for count in (4000, 1000, 200) if left > 0.9 * count)
        assert 0.9 * wanted < len(level.faces) == left <= wanted
        edges = np.sort(level.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        _, many = np.unique(edges, axis=0, return_counts=True)
        assert (many == 2).all()
        assert len(level.vertices) - len(many) + len(level.faces) == 2  # Euler
        assert outwards(level.vertices, level.faces) == outwards(vertices, faces) == 1
        # A ball of T even triangles is off by some area of one over eight radii.
        off = np.abs(np.linalg.norm(level.vertices, axis=1) - 0.5)
        assert off.max() < 4 * np.pi * 0.25 / left / 0.5


def test_deviation_is_what_an_independent_measure_finds():
    vertices, faces = sphere(50)
    level = [one for _, one in coarsened(vertices, faces, (700,)) if one is not None][0]
    ours = Fine(vertices, faces).deviation(level, 60_000)
    other = metrics.hausdorff(vertices, faces, level.vertices, level.faces, spacing=0.01)
    assert ours.p99 == pytest.approx(other.p99, rel=0.15)
    assert ours.max == pytest.approx(other.max, rel=0.2)
    assert ours.mean == pytest.approx(other.mean, rel=0.2)


def test_noise_is_evened_not_kept():
    """A noisy plane's vertices lie nearer to the plane than what was scanned."""
    rng = np.random.default_rng(0)
    u, v = np.meshgrid(np.linspace(0, 1, 150), np.linspace(0, 1, 150), indexing="ij")
    i = np.arange(u.size).reshape(u.shape)
    a, b, c, d = (x.ravel() for x in (i[:-1, :-1], i[1:, :-1], i[1:, 1:], i[:-1, 1:]))
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32)
    vertices = np.stack([u.ravel(), v.ravel(), rng.normal(scale=1e-3, size=u.size)], axis=1)
    level = [one for _, one in coarsened(vertices, faces, (2000,)) if one is not None][0]
    assert level.vertices[:, 2].std() < 0.6e-3
    assert np.abs(level.normals[:, 2]).mean() > 0.98


def test_the_cheapest_level_within_its_budget_is_chosen():
    vertices, faces = sphere(60)
    counts = [4000, 2000, 1000, 500, 250, 120]
    levels = [one for _, one in coarsened(vertices, faces, counts) if one is not None]
    fine = Fine(vertices, faces)
    off = [fine.deviation(level, 50_000).p99 for level in levels]
    assert off == sorted(off)
    budget = 1.3 * off[3]
    chosen = chosen_level(fine, levels, budget)
    assert chosen.within
    assert chosen.deviation.p99 <= budget
    assert len(chosen.level.faces) == len(levels[3].faces)
    strict = chosen_level(fine, levels, 1e-9)
    assert not strict.within
    assert len(strict.level.faces) == len(levels[0].faces)


def test_condition_counts_what_was_broken():
    vertices, faces = sphere(40)
    hole = np.linalg.norm(vertices[faces].mean(1) - [0.5, 0, 0], axis=1) < 0.04
    faces = faces[~hole]
    flake = np.array([[2.0, 0, 0], [2.1, 0, 0], [2.0, 0.1, 0]])
    count = len(vertices)
    vertices = np.concatenate([vertices, flake, [[np.nan, 0, 0]]])
    more = np.array([[count, count + 1, count + 2], faces[0][[1, 2, 0]], [0, 0, 5], [0, 1, count + 3]])
    scan, found = cleaned(bare(vertices, np.concatenate([faces, more]).astype(np.int32)))
    assert (found.not_finite, found.degenerate, found.duplicated) == (1, 1, 1)
    assert (found.parts, found.holes, found.rims) == (2, 1, 0)
    assert 0.03 < found.hole_width < 0.13
    assert found.largest == pytest.approx((1, 1, 1), abs=0.01)
    assert found.whole[0] == pytest.approx(2.6, abs=0.01)
    assert 0 < found.loose_area < 0.01
    assert not found.coloured
    assert len(largest_part(scan).faces) == len(faces)


def test_equal_vertices_are_joined_and_nothing_else():
    vertices, faces = sphere(20)
    soup = bare(vertices[faces].reshape(-1, 3), np.arange(3 * len(faces), dtype=np.int32).reshape(-1, 3))
    scan, found = cleaned(soup)
    assert (found.parts, found.holes, found.open_edges) == (1, 0, 0)
    assert len(scan.vertices) == len(vertices)


def test_a_scan_of_nothing_is_refused():
    with pytest.raises(ScanError, match="no triangle that has an area"):
        cleaned(bare(np.zeros((3, 3)), np.array([[0, 1, 2]], np.int32)))


@pytest.mark.parametrize("up", UPWARDS)
def test_a_scan_stands_on_its_foot_unmirrored(up):
    rng = np.random.default_rng(1)
    vertices, faces = rng.normal(size=(40, 3)) * 1000, np.arange(39, dtype=np.int32).reshape(-1, 3)
    scan = stood(bare(vertices, faces), 0.001, up)  # type: ignore[arg-type]
    low, high = scan.vertices.min(0), scan.vertices.max(0)
    assert low[1] == pytest.approx(0)
    assert (low + high)[[0, 2]] == pytest.approx([0, 0])
    sign = -1 if up.startswith("-") else 1
    away = sign * vertices[:39, "xyz".index(up[-1])] / 1000
    assert np.ptp(scan.vertices[:, 1] - away) < 1e-9
    turns = [np.linalg.det(v[faces[0]] - v[faces[1]]) for v in (vertices / 1000, scan.vertices)]
    assert turns[0] == pytest.approx(turns[1])


def test_charts_cover_every_face_once_and_never_lie_over_each_other():
    made = scan_like.scan_of(30_000, pixels=64)
    scan, _ = cleaned(bare(made.vertices, made.faces))
    level = [one for _, one in coarsened(scan.vertices, scan.faces, (6000,)) if one is not None][0]
    layout = laid_out(level.vertices, level.faces, 512)
    assert (layout.chart >= 0).all()
    assert layout.place.min() >= 1
    assert layout.place.max() <= 511
    a, b, c = (layout.place[:, k] for k in range(3))
    flat = np.abs((b - a)[:, 0] * (c - a)[:, 1] - (c - a)[:, 0] * (b - a)[:, 1]) / 2
    seen = np.bincount(layout.owner[layout.owner >= 0], minlength=len(level.faces))
    # Pixels that a chart's faces own are its faces' area: what lay over something else would own less.
    own, area = np.bincount(layout.chart, seen), np.bincount(layout.chart, flat)
    assert np.abs(own - area)[area > 100].max() < 0.05 * area.max()
    assert seen.sum() == pytest.approx(flat.sum(), rel=0.02)
    assert seen.sum() > 0.2 * layout.owner.size


def test_colours_lie_where_they_lay():
    """A ball painted by place: the coarse model's picture says at each place what was there."""
    vertices, faces = sphere(80)
    colours = np.rint(255 * (0.5 + vertices)).clip(0, 255).astype(np.uint8)
    scan, _ = cleaned(bare(vertices, faces, colours))
    level = [one for _, one in coarsened(scan.vertices, scan.faces, (1500,)) if one is not None][0]
    layout = laid_out(level.vertices, level.faces, 256)
    fine = Fine(scan.vertices, scan.faces)
    picture = painted(level, layout, Colours(scan, fine.surface), 0.01)
    y, x = np.nonzero(layout.owner >= 0)
    face = layout.owner[y, x]
    a, b, c = (layout.place[face, k] for k in range(3))
    u, v, w = b - a, c - a, np.stack([x, y], axis=1) + 0.5 - a
    area = u[:, 0] * v[:, 1] - v[:, 0] * u[:, 1]
    s = (w[:, 0] * v[:, 1] - v[:, 0] * w[:, 1]) / area
    t = (u[:, 0] * w[:, 1] - w[:, 0] * u[:, 1]) / area
    places = np.einsum("nk,nkd->nd", np.stack([1 - s - t, s, t], axis=1), level.vertices[level.faces[face]])
    off = np.abs(picture[y, x] - 255 * (0.5 + places)).max(1)
    assert np.percentile(off, 99) < 4
    data = scan_glb(level, layout, picture, "ball")
    parts = glb_parts(data)
    primitive = parts.document["meshes"][0]["primitives"][0]
    assert set(primitive["attributes"]) == {"POSITION", "NORMAL", "TEXCOORD_0"}
    uv = parts.numbers(primitive["attributes"]["TEXCOORD_0"])
    assert uv.min() > 0
    assert uv.max() < 1


def test_colours_come_from_the_side_that_looks_the_same_way():
    """Cloth 1 mm thick, red outside and blue inside: neither shows through."""
    vertices, faces = sphere(60)
    inner = 0.998 * vertices
    both = np.concatenate([vertices, inner])
    count = len(vertices)
    red, blue = np.tile([[255, 0, 0]], (count, 1)), np.tile([[0, 0, 255]], (count, 1))
    scan = bare(
        both,
        np.concatenate([faces, faces[:, ::-1] + count]).astype(np.int32),
        np.concatenate([red, blue]).astype(np.uint8),
    )
    level = [one for _, one in coarsened(vertices, faces, (600,)) if one is not None][
        0
    ]  # cuts into the inner side
    layout = laid_out(level.vertices, level.faces, 128)
    fine = Fine(scan.vertices, scan.faces)
    picture = painted(level, layout, Colours(scan, fine.surface), 0.02)
    assert (picture[layout.owner >= 0] == [255, 0, 0]).mean() > 0.999
