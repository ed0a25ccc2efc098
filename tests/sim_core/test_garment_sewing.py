"""Sewing and dressing before any simulation: equal steps on both sides, who is paired, what is held and where."""

from pathlib import Path

import numpy as np
import pytest

from sim_core.garment import Pattern
from sim_core.garment.pattern import SIDES, Cloth, Panel, cut_cloth
from sim_core.garment.pattern import Path as Way
from sim_core.garment.recipes import (
    GAP,
    SAG,
    Half,
    half_sheet,
    nape_pins,
    robe_holds,
    robe_materials,
    seam_gap,
)
from sim_core.weave import Weave, parameters_of, solve

ASSETS = Path(__file__).parents[2] / "assets"
EDGE = 0.05

# One leg of 303 mm, drawn upwards, meets two of 100 and 200 mm: sides differ by 1 %, and the first meets the top.
TWO = """\
name = "two"
edge = 0.02
[[panel]]
name = "one"
outline = [
  { name = "a", at = [0, 0] },
  { name = "b", at = [0, 303] },
  { name = "c", at = [-200, 303] },
  { name = "d", at = [-200, 0] },
]
[[panel]]
name = "other"
outline = [
  { name = "a", at = [0, 0] },
  { name = "b", at = [200, 0] },
  { name = "c", at = [200, 300] },
  { name = "d", at = [0, 300] },
  { name = "m", at = [0, 100] },
]
"""
SEAMS = {
    "down and down": '["one: a > b", "other: a < d"]',
    "up and up": '["one: b < a", "other: d > a"]',
    "crosswise": '["one: b < a", "other: a < d"]',
    "crosswise, turned": '["one: a > b", "other: d > a"]',
    "other first": '["other: d > a", "one: b < a"]',
}


@pytest.mark.parametrize("kind", ["sewn", "joined"])
@pytest.mark.parametrize("way", SEAMS)
def test_both_sides_have_the_same_steps_at_most_the_edge(tmp_path: Path, kind: str, way: str) -> None:
    path = tmp_path / "two.toml"
    path.write_text(f"{TWO}[[seam]]\n{kind} = {SEAMS[way]}\n", "utf-8")
    pattern = Pattern.load(path)
    cloth, (seam,) = pattern.cloth(), pattern.seams
    assert seam.b is not None
    sides = [cloth.along(p, pattern.panel(p.panel)) for p in (seam.a, seam.b)]
    lengths = [np.linalg.norm(np.diff(cloth.vertices[side], axis=0), axis=1) for side in sides]
    assert len(lengths[0]) == len(lengths[1])
    assert lengths[0] == pytest.approx(lengths[1], rel=0.011)
    assert max(map(np.max, lengths)) <= 0.02 * (1 + 1e-9)
    assert [length.sum() for length in lengths] == pytest.approx(
        [p.length(pattern.panel(p.panel)) for p in (seam.a, seam.b)]
    )
    start = pattern.panel(seam.a.panel).corners.index(seam.a.start)
    assert cloth.vertices[sides[0][0]] == pytest.approx(pattern.panel(seam.a.panel).legs[start][0])
    assert (cloth.closed[sides[0]] == cloth.closed[sides[1]]).all()
    assert (cloth.joined[sides[0]] == cloth.joined[sides[1]]).all() == (kind == "joined")
    assert len(cloth.pairs) == (len(sides[0]) if kind == "sewn" else 0)
    assert cloth.closed.max() + 1 == len(cloth.vertices) - len(sides[0])


def test_a_half_doubled_pairs_and_numbers_each_side_for_itself(half: tuple[Pattern, Cloth]) -> None:
    pattern, cloth = half
    whole, count = cloth.mirrored(), len(cloth.vertices)
    assert len(whole.pairs) == 2 * len(cloth.pairs)
    sewn = set()
    for side in SIDES:
        for seam in pattern.seams:
            if seam.kind == "sewn" and seam.b is not None:
                ends = [whole.along(p, pattern.panel(p.panel), side) for p in (seam.a, seam.b)]
                sewn |= {tuple(sorted(pair)) for pair in whole.joined[np.column_stack(ends)].tolist()}
    assert {tuple(sorted(pair)) for pair in whole.pairs.tolist()} == {(a, b) for a, b in sewn if a != b}
    left, right = (whole.along(seam.a, pattern.panel(seam.a.panel), side) for side in SIDES)
    assert whole.vertices[right] == pytest.approx(whole.vertices[left] * [-1.0, 1.0])
    assert (whole.panel_of[:count] == cloth.panel_of).all()
    assert (whole.panel_of[count:] == cloth.panel_of + len(cloth.names)).all()
    assert (whole.panel_of[whole.faces] == whole.panel[:, None]).all()


@pytest.fixture(scope="module")
def half() -> tuple[Pattern, Cloth]:
    pattern = Pattern.load(ASSETS / "patterns" / "beizi.toml")
    return pattern, pattern.cloth(EDGE)


@pytest.fixture(scope="module")
def made(half: tuple[Pattern, Cloth]):
    weave = Weave.load(ASSETS / "weaves" / "ling.toml")
    parameters = parameters_of(weave, solve(weave))
    return parameters, *robe_materials(parameters, *half, EDGE)


@pytest.fixture(scope="module")
def sheet(half: tuple[Pattern, Cloth], made) -> Half:
    pattern, cloth = half
    apart = np.array([n if panel.along else 0 for n, panel in enumerate(pattern.panels)])[cloth.panel]
    return half_sheet(cloth, cloth.joined, made[1], made[2], apart)


def test_materials_bear_the_robe_and_fold_as_the_mesh_can(half: tuple[Pattern, Cloth], made) -> None:
    (pattern, cloth), (parameters, (single, twice), kind, choices) = half, made
    longest = np.abs(cloth.vertices[:, 1]).max()
    strain = parameters.density * 9.81 * longest / min(single.stretch, single.stretch_warp)
    assert strain == pytest.approx(SAG) or min(single.stretch, single.stretch_warp) == pytest.approx(
        min(parameters.stretch_weft, parameters.stretch_warp)
    )
    assert single.stretch <= parameters.stretch_weft
    assert single.density == pytest.approx(parameters.density)
    assert (single.bend / (single.density * 9.81)) ** (1 / 3) >= 1.3 * EDGE * (1 - 1e-9)
    assert twice.density == 2 * single.density
    assert (twice.stretch, twice.shear) == (2 * single.stretch, 2 * single.shear)
    assert twice.stretch_warp == 2 * single.stretch_warp
    assert (twice.bend, twice.bend_warp) == (6 * single.bend, 6 * (single.bend_warp or 0.0))
    doubled = {n for n, panel in enumerate(pattern.panels) if panel.doubled}
    assert 0 < len(doubled) < len(pattern.panels)
    assert set(cloth.panel[kind == 1]) == doubled
    assert set(choices) == {"stretch", "bend", "doubled"}


def test_fronts_stay_on_their_side_and_the_middle_in_the_middle(
    half: tuple[Pattern, Cloth], sheet: Half
) -> None:
    pattern, cloth = half
    x = sheet.gathered(np.column_stack([cloth.vertices, np.zeros(len(cloth.vertices))]))
    holds = robe_holds(pattern, cloth, sheet, (0.3, 0.5, 0.01), x)
    assert (holds.low[sheet.middle] == 0).all()
    assert (holds.high[sheet.middle] == 0).all()
    others = np.setdiff1d(np.arange(sheet.real), sheet.middle)
    lowest = np.full(sheet.real, np.inf)
    np.minimum.at(lowest, sheet.number, cloth.vertices[:, 1])
    highest = np.full(sheet.real, -np.inf)
    np.maximum.at(highest, sheet.number, cloth.vertices[:, 1])
    assert (holds.low[others] == np.where(highest[others] > 0, GAP, -np.inf)).all()
    stitched = np.flatnonzero(np.isfinite(holds.high[: sheet.real]))
    stitched = np.setdiff1d(stitched, sheet.middle)
    assert len(stitched)
    assert (holds.high[stitched] == 0.01).all()
    assert (highest[stitched] > 0.3).all()
    assert (lowest[stitched] < 0.5).all()
    bands = [n for n, panel in enumerate(pattern.panels) if panel.along is not None]
    assert np.isin(stitched, sheet.number[np.isin(cloth.panel_of, bands)]).all()
    free = robe_holds(pattern, cloth, sheet, None, x)
    assert np.isinf(free.high[others]).all()


def test_pairs_are_the_twins_of_the_sewn_seams(half: tuple[Pattern, Cloth], sheet: Half) -> None:
    pattern, cloth = half
    x = sheet.gathered(np.column_stack([cloth.vertices, np.zeros(len(cloth.vertices))]))
    holds = robe_holds(pattern, cloth, sheet, None, x)
    wanted = {tuple(sorted(pair)) for pair in sheet.number[_named(cloth)].tolist()}
    assert {tuple(pair) for pair in holds.pairs.tolist()} == wanted
    assert holds.spans == pytest.approx(np.linalg.norm(x[holds.pairs[:, 0]] - x[holds.pairs[:, 1]], axis=1))
    assert (x[holds.slaves[:, 0]] == x[holds.slaves[:, 1]] * [-1.0, 1.0, 1.0]).all()


def _named(cloth: Cloth) -> np.ndarray:
    """Pattern vertices (K, 2) of the cloth's own pairs, which number points of `joined`."""
    first = np.zeros(cloth.joined.max() + 1, int)
    first[cloth.joined[::-1]] = np.arange(len(cloth.joined))[::-1]
    return first[cloth.pairs]


def test_the_gap_is_the_widest_open_seam(half: tuple[Pattern, Cloth], sheet: Half) -> None:
    _, cloth = half
    place = np.random.default_rng(3).normal(size=(cloth.closed.max() + 1, 3))
    points = np.zeros((sheet.real, 3))
    points[sheet.number] = place[cloth.closed]
    assert seam_gap(cloth, sheet, points) == 0.0
    a, b = sheet.number[_named(cloth)][len(cloth.pairs) // 2]
    points[a] += [0.003, 0.0, 0.004]
    assert seam_gap(cloth, sheet, points) == pytest.approx(0.005)
    points[b] += [0.003, 0.0, 0.004]
    others = seam_gap(cloth, sheet, points)
    assert others == pytest.approx(0.0) or others == pytest.approx(
        0.005
    )  # a corner of three panels stays open


def test_the_nape_is_pinned_with_its_neighbours_alone(half: tuple[Pattern, Cloth], sheet: Half) -> None:
    pattern, cloth = half
    nape = nape_pins(pattern, cloth, sheet)
    body = cloth.middle[cloth.panel_of[cloth.middle] == 0]
    top = sheet.number[body[np.argmax(cloth.vertices[body, 1])]]
    assert top in nape
    edges = sheet.sheet.edges
    for vertex in nape:
        assert vertex < sheet.real
        assert vertex == top or ((edges == top) | (edges == vertex)).all(1).any()
    assert 3 <= len(nape) <= 12


def test_a_path_round_several_corners_is_one_line() -> None:
    corner = np.array([[0.0, 0.0], [0.4, 0.0], [0.4, 0.3], [0.0, 0.3]])
    legs = tuple(np.stack([corner[k], corner[(k + 1) % 4]]) for k in range(4))
    panel = Panel("p", ("a", "b", "c", "d"), legs)
    cloth = cut_cloth([panel], [], 0.1)
    for way in (Way("p", "a", "d", True), Way("p", "d", "a", False), Way("p", "c", "b", True)):
        line = cloth.vertices[cloth.along(way, panel)]
        steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
        assert steps.sum() == pytest.approx(way.length(panel))
        assert steps.max() <= 0.1 + 1e-9
        assert line[0] == pytest.approx(corner["abcd".index(way.start)])
        assert line[-1] == pytest.approx(corner["abcd".index(way.end)])
