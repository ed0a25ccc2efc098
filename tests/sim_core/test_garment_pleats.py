"""Pleats: read, folded, laid round a wearer, dressed; creases that nothing resists and that open only so far."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import LinearNDInterpolator

from sim_core import metrics
from sim_core.body import Figure, Mannequin, pose_named
from sim_core.cloth import Material, Sheet
from sim_core.errors import FileProblem
from sim_core.garment import Garment, dress, garment_sheet, load_outfit
from sim_core.garment.dressing import overlap
from sim_core.garment.pattern import Pattern, Pleat, Plies, latches
from sim_core.garment.placement import Ground, Wrapped
from sim_core.mesh import panel_mesh
from sim_core.picture import normals

ASSETS = Path(__file__).parents[2] / "assets"
SKIRT = """\
name = "skirt"
edge = 0.016
[measures]
length = 300
door = 240
piece = "2 * door + 5 * (2 * 45 + 24)"
seen = "2 * door + 5 * 24"
second = "seen - 190"

[[panel]]
name = "left"
outline = [
  { name = "top_begin", at = [0, 0] },
  { name = "hem_begin", at = [0, "length"] },
  { name = "hem_end", at = ["piece", "length"] },
  { name = "top_end", at = ["piece", 0] },
]
pleats = [{ at = "door", count = 5, depth = 45, step = 24, towards = "end", opens = 60 }]

[[panel]]
name = "right"
outline = [
  { name = "top_begin", at = ["second", 0] },
  { name = "hem_begin", at = ["second", "length"] },
  { name = "hem_end", at = ["second + piece", "length"] },
  { name = "top_end", at = ["second + piece", 0] },
]
pleats = [{ at = "second + door", count = 5, depth = 45, step = 24, towards = "begin", opens = 60 }]
"""
PLACE = 'way = "wrapped"\nbegin = 92\ngap = 0.002'
STEPS = """
[[layer.step]]
do = "pin"
at = ["top"]
[[layer.step]]
do = "settle"
seconds = 0.4
gravity = [0.0, 9.81]
damping = 20.0
touch = { thickness = 0.0016 }
[[layer.step]]
do = "rest"
seconds = 0.8
damping = 12.0
friction = 0.45
still = 1e-4
"""


@pytest.fixture(scope="module")
def pattern(tmp_path_factory: pytest.TempPathFactory) -> Pattern:
    file = tmp_path_factory.mktemp("pattern") / "skirt.toml"
    file.write_text(SKIRT, "utf-8")
    return Pattern.load(file)


@pytest.fixture(scope="module")
def skirt(tmp_path_factory: pytest.TempPathFactory) -> Garment:
    folder = tmp_path_factory.mktemp("skirt")
    (folder / "skirt.toml").write_text(SKIRT, "utf-8")
    head = 'wearer = "mannequins/woman.npz"\npose = "display"\n[[layer]]\n'
    layer = f'pattern = "{folder / "skirt.toml"}"\nweave = "weaves/juan.toml"\n[layer.place]\n{PLACE}\n'
    (folder / "it.toml").write_text(head + layer + STEPS, "utf-8")
    (garment,) = dress(load_outfit(folder / "it.toml", ASSETS))
    return garment


def ground() -> Ground:
    figure = Figure(Mannequin.load(ASSETS / "mannequins/woman.npz"))
    pose = pose_named("display")
    vertices, faces = figure.mesh(pose)
    return Ground(vertices, faces, figure.trunk(), figure.mannequin.landmarks(pose))


@st.composite
def pleated(draw: st.DrawFn) -> tuple[float, tuple[Pleat, ...]]:
    """A width and pleats in it, in groups that point either way."""
    at, found = draw(st.floats(0.1, 0.4)), []
    for _ in range(draw(st.integers(1, 3))):
        depth, step = draw(st.floats(0.01, 0.08)), draw(st.floats(0.005, 0.05))
        towards = draw(st.sampled_from(["end", "begin"]))
        for _ in range(draw(st.integers(1, 6))):
            found.append(Pleat(at, depth, towards))
            at += 2 * depth + step
        at += draw(st.floats(0.2, 0.5))
    return at + 0.2, tuple(found)


@given(pleated())
@settings(max_examples=200, deadline=None)
def test_plies_keep_their_length_and_lie_over_each_other_in_order(given: tuple[float, tuple[Pleat, ...]]):
    width, pleats = given
    plies = Plies.of(0.0, width, pleats)
    lengths = np.abs(np.diff(plies.places))
    np.testing.assert_allclose(lengths, np.diff(plies.bounds), atol=1e-12)  # folded, not stretched
    taken = sum(2 * pleat.depth for pleat in pleats)
    assert plies.places[-1] == pytest.approx(width - taken)
    low = np.minimum(plies.places[:-1], plies.places[1:])
    high = np.maximum(plies.places[:-1], plies.places[1:])
    for over, under in plies.stacked():
        first, last = max(low[over], low[under]), min(high[over], high[under])
        at = np.linspace(first, last, 9)[1:-1]  # where both lie; on the fold itself they meet
        inside = []
        for ply in (over, under):
            begin, end = plies.bounds[ply : ply + 2]
            share = (at - plies.places[ply]) / (plies.places[ply + 1] - plies.places[ply])
            inside.append(plies.heights(begin + share * (end - begin)))
        assert (inside[0] - inside[1] > 1.0 - 1e-6).all()  # a gap apart, wherever a mesh has its vertices
    assert (plies.heights(np.linspace(0.0, width, 400)) > -1e-9).all()


@given(pleated(), st.floats(0.0, 0.8), st.floats(0.01, 0.1))
@settings(max_examples=200, deadline=None)
def test_pleats_that_stand_open_keep_their_length_and_order(
    given: tuple[float, tuple[Pleat, ...]], share: float, lean: float
) -> None:
    width, pleats = given
    plies, rise = Plies.of(0.0, width, pleats), share * min(pleat.depth for pleat in pleats)
    steepest = max(float(np.abs(ramp[np.isfinite(ramp).all(1), 1]).max()) for ramp in plies.ramps)
    gap = lean / steepest  # plies lean on each other by some degrees
    opened = plies.opened(rise, gap)
    for begin, end in zip(plies.bounds[:-1], plies.bounds[1:], strict=True):
        x = np.linspace(begin + 1e-5, end - 1e-5, 400)
        along = np.hypot(np.diff(opened.laid(x)), np.diff(opened.heights(x)))
        steep = along > (1.0 + 1e-9) * np.diff(x)  # where a ply begins to lean between points it is told at
        assert (along[~steep] > 0.0).all()
        assert along.sum() <= 1.1 * (end - begin)
    for over, under in plies.stacked():
        ends = np.array([plies.bounds[[k, k + 1]] for k in (over, under)])
        x = np.linspace(ends[:, 0] + 1e-9, ends[:, 1] - 1e-9, 2000)
        at = opened.laid(x.ravel()).reshape(x.shape)
        upper, lower = (at[:, k] for k in range(2))
        both = np.linspace(max(upper.min(), lower.min()), min(upper.max(), lower.max()), 9)[1:-1]
        if np.ptp(both) > 1e-6:
            high = [np.interp(both, *_ascending(at[:, k], opened.heights(x[:, k]))) for k in range(2)]
            assert (high[0] > high[1]).all()


def _ascending(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    order = np.argsort(x, kind="stable")
    return x[order], y[order]


def test_pleats_open_until_they_are_as_wide_as_asked() -> None:
    plies = Plies.of(0.0, 1.0, [Pleat(0.2 + 0.1 * k, 0.035) for k in range(6)])
    closed = plies.opened(0.0, 0.001).width
    for more in (0.02, 0.06, 0.1):
        assert plies.as_wide(closed + more, 0.034, 0.001).width == pytest.approx(closed + more, abs=1e-6)
    assert plies.as_wide(closed + 0.1, 0.01, 0.001).width < closed + 0.1  # creases may open no further


def test_cloth_that_lies_over_pleats_touches_none_and_has_no_step() -> None:
    plies = Plies.of(0.0, 1.0, [Pleat(0.2 + 0.1 * k, 0.035) for k in range(6)])
    opened = plies.opened(0.015, 0.001)
    x = np.linspace(0.0, 1.0, 4001)
    own = opened.over(opened.laid(x), 0.002) - opened.heights(x)
    assert own.min() > 0.001
    beside = np.linspace(opened.places[0] - 0.2, opened.places[-1] + 0.2, 4001)
    over = opened.over(beside, 0.002)
    assert over[0] == over[-1] == 0.0
    assert np.abs(np.diff(over) / np.diff(beside)).max() < 0.6


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ('depth = 45, step = 24, towards = "end"', ""),
        ('at = "door", count = 5 -> at = 1200, count = 5', "panel.left: pleats: a fold at x"),
        ("depth = 45 -> depth = 1", "panel.left.pleats.1.depth: 1 mm"),
        ("step = 24, towards -> step = 0, towards", "panel.left.pleats.1.step"),
        ("opens = 60 }] -> opens = 60 }, { at = 300, depth = 20 }]", "panel.left.pleats: one takes up"),
        ("count = 5 -> count = 0", "pleats.1.count"),
        ("opens = 60 -> opens = 200", "pleats.1.opens"),
        ('towards = "end" -> towards = "front"', "pleats.1.towards"),
    ],
)
def test_pleats_that_cannot_be_folded_are_refused(tmp_path: Path, change: str, told: str) -> None:
    old, _, new = change.partition(" -> ")
    assert old in SKIRT
    file = tmp_path / "skirt.toml"
    file.write_text(SKIRT.replace(old, new, 1) if new else SKIRT, "utf-8")
    if not told:
        assert len(Pattern.load(file).panels[0].pleats) == 5
        return
    with pytest.raises(FileProblem) as error:
        Pattern.load(file)
    assert told in str(error.value)
    assert str(file) in str(error.value)


def test_edges_run_along_every_fold(pattern: Pattern) -> None:
    cloth = pattern.cloth()
    assert len(cloth.creases) > 0
    for number, panel in enumerate(pattern.panels):
        own = cloth.creases[cloth.panel_of[cloth.creases[:, 0]] == number]
        x = cloth.vertices[own]
        for pleat in panel.pleats:
            for fold in pleat.folds():
                along = x[np.abs(x[:, :, 0] - fold).max(1) < 1e-6]
                length = np.abs(along[:, 0, 1] - along[:, 1, 1]).sum()
                assert length == pytest.approx(0.3, abs=1e-6)  # from the top to the hem


def test_patterns_with_pleats_are_kept(pattern: Pattern) -> None:
    again = Pattern.from_dict(pattern.to_dict())
    assert [panel.pleats for panel in again.panels] == [panel.pleats for panel in pattern.panels]
    plain = Pattern.load(ASSETS / "patterns/robe.toml")
    assert all(
        "pleats" not in panel for panel in plain.to_dict()["panels"]
    )  # older garments stay as they were


def test_pleats_lie_round_the_waist_without_a_crossing(pattern: Pattern) -> None:
    on = ground()
    cloth = pattern.cloth(0.015)
    x = Wrapped(begin=92.0, gap=0.002).start(pattern, cloth, on, np.random.default_rng(0))
    faces = cloth.closed[cloth.faces]
    assert metrics.intersections(x, faces) == 0
    clearance = metrics.penetration(x, faces, on.vertices, on.faces).clearance
    assert min(clearance) > 0.0
    top = x[cloth.vertices[:, 1] < 1e-6]
    assert np.ptp(top[:, 1]) < 1e-9
    angle = np.sort(np.arctan2(top[:, 0], top[:, 2] - top[:, 2].mean()))
    assert np.diff(angle, append=angle[0] + 2 * np.pi).max() < 0.3  # all the way round


def test_the_edge_that_is_pinned_begins_hardly_stretched() -> None:
    """Where pleats stand open on the narrow sides of a waist, and where a second lap climbs on them."""
    skirt = load_outfit(ASSETS / "outfits/song-beizi.toml", ASSETS).layers[1]
    cloth = skirt.pattern.cloth(0.02)
    x = replace(skirt.place, gap=0.002).start(skirt.pattern, cloth, ground(), np.random.default_rng(0))
    top = np.flatnonzero(cloth.vertices[:, 1] < 1e-6)
    top = top[np.argsort(cloth.vertices[top, 0])]
    lengths = np.linalg.norm(np.diff(x[top], axis=0), axis=1)
    assert np.abs(lengths / np.diff(cloth.vertices[top, 0]) - 1).max() < 0.06


def test_nothing_resists_folding_along_a_crease() -> None:
    mesh = panel_mesh(
        [(0, 0), (0.2, 0), (0.2, 0.2), (0, 0.2)], edge=0.02, constraints=[[(0.1, 0), (0.1, 0.2)]]
    )
    material, (line,) = Material(density=0.05, stretch=50.0, bend=1e-5), mesh.lines
    kind, corner = np.zeros(len(mesh.faces), np.int32), mesh.vertices[mesh.faces]
    creases = np.column_stack([line[:-1], line[1:]])
    flat = np.column_stack([mesh.vertices, np.zeros(len(mesh.vertices))])
    folded = flat.copy()
    over = flat[:, 0] > 0.1
    folded[over] = np.column_stack([np.full(over.sum(), 0.1), flat[over, 1], flat[over, 0] - 0.1])

    def bent(sheet: Sheet, x: np.ndarray) -> float:
        rows, q = sheet.stencil.rows, sheet.stencil.bend
        of = np.repeat(np.arange(len(x)), np.diff(rows))
        away = x[sheet.stencil.neighbour] - x[of]
        return float(-0.25 * (q * (away**2).sum(1)).sum())

    plain, creased = (
        Sheet.of_corners(corner, mesh.faces, [material], kind, creases=given) for given in (None, creases)
    )
    assert bent(plain, folded) > 1e-6
    assert abs(bent(creased, folded)) < 1e-6 * bent(plain, folded)
    rolled = np.column_stack([0.05 * np.sin(flat[:, 0] / 0.05), flat[:, 1], 0.05 * np.cos(flat[:, 0] / 0.05)])
    assert bent(creased, rolled) == pytest.approx(bent(plain, rolled), rel=0.2)  # elsewhere it is as stiff


def test_creases_open_as_far_as_they_may() -> None:
    x, y = np.meshgrid(np.arange(0.0, 0.2001, 0.02), np.arange(0.0, 0.1001, 0.02))
    points = np.column_stack([x.ravel(), y.ravel()])
    pleat = Pleat(0.1, 0.06, "end", np.radians(40.0))
    pairs, ends = latches(points, [pleat], 0.02)
    assert len(pairs) == len(ends) > 0
    for fold in pleat.folds():
        near = np.abs(points[pairs, 0] - fold).max(1) < 0.03
        at_angle = points[pairs[near]].copy()
        for row in at_angle:  # the far side turned about the fold to 40 degrees from the near one
            d = row[1, 0] - fold
            row[1, 0] = fold - d * np.cos(np.radians(40.0))
        depth = (points[pairs[near][:, 1], 0] - fold) * np.sin(np.radians(40.0))
        apart = np.hypot(np.linalg.norm(at_angle[:, 0] - at_angle[:, 1], axis=1), depth)
        np.testing.assert_allclose(ends[near], apart, atol=1e-9)
    assert len(latches(points, [Pleat(0.1, 0.06)], 0.02)[0]) == 0  # 180 degrees: they may open flat


@pytest.mark.slow
def test_a_pleated_skirt_is_dressed_and_stays_folded(skirt: Garment) -> None:
    facts = skirt.provenance["errors"]
    assert facts["inside_vertices"] + facts["inside_midpoints"] + facts["inside_centroids"] == 0
    assert facts["area_strain_p95"] < 0.04
    under, over = overlap(skirt, Wrapped())
    assert over > 50
    assert under <= 0.02 * over  # a short program on a coarse mesh
    assert skirt.settled is not None
    assert len(skirt.settled.holds.pairs) > 20  # creases are held when it is carried on
    assert len(garment_sheet(skirt).rest) == len(skirt.positions)


@pytest.mark.slow
def test_a_ply_that_came_to_lie_over_its_neighbour_is_told(skirt: Garment) -> None:
    """The first fold, at .24 m, the other way: what lies 4 cm beyond it lies on what it lay beneath, not under it."""
    assert skirt.settled is not None
    own = np.unique(skirt.pattern_faces[skirt.panel == 0])
    place, cloth = skirt.pattern[own], skirt.weld[own]
    up = normals(skirt.positions, skirt.faces)[cloth]
    _, outward = skirt.settled.beneath.field().with_gradient(skirt.positions[cloth])
    up *= np.sign((up * outward)[place[:, 0] < 0.2].sum())
    lifted = LinearNDInterpolator(place, skirt.positions[cloth] + 0.006 * up)
    turned = (place[:, 0] > 0.242) & (place[:, 0] < 0.284)
    positions = skirt.positions.copy()
    positions[cloth[turned]] = lifted([0.48, 0.0] + [-1.0, 1.0] * place[turned])
    before, _ = overlap(skirt, Wrapped())
    under, _ = overlap(replace(skirt, positions=positions), Wrapped())
    assert turned.sum() > 25
    assert under > before + 15
