"""Sewing and dressing before any simulation: equal steps on both sides, who is paired, what is held and where."""

from pathlib import Path

import numpy as np
import pytest

from sim_core.cloth.scenes import GF_CM
from sim_core.garment import Pattern, load_outfit
from sim_core.garment.dressing import SewnSheet, materials_of, sewn_sheet, simplified
from sim_core.garment.outfit import default_program
from sim_core.garment.pattern import SIDES, Cloth, Panel, cut_cloth
from sim_core.garment.pattern import Path as Way
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
def sheet(half: tuple[Pattern, Cloth]) -> SewnSheet:
    pattern, cloth = half
    apart = np.array([n if panel.along else 0 for n, panel in enumerate(pattern.panels)])[cloth.panel]
    kind = np.zeros(len(cloth.faces), np.int32)
    return sewn_sheet(cloth, cloth.joined, [GF_CM], kind, apart)


@pytest.mark.parametrize("way", ["flat", "over_bar"])
def test_materials_bear_their_weight_and_fold_as_the_mesh_can(way: str) -> None:
    weave, program, longest = Weave.load(ASSETS / "weaves" / "ling.toml"), default_program(way), 1.12
    parameters = parameters_of(weave, solve(weave))
    single, choices = simplified(parameters, program, longest, EDGE)
    assert single.stretch_warp is not None
    softest = min(single.stretch, single.stretch_warp)
    strain = parameters.density * 9.81 * longest / softest
    assert strain == pytest.approx(program.sag) or softest == pytest.approx(
        min(parameters.stretch_weft, parameters.stretch_warp)
    )
    assert single.stretch <= parameters.stretch_weft
    assert single.density == pytest.approx(parameters.density)
    assert (single.bend / (single.density * 9.81)) ** (1 / 3) >= program.fold * EDGE * (1 - 1e-9)
    assert single.shear is not None
    assert parameters.shear < single.shear <= softest / 2.6  # an isotropic sheet's
    assert set(choices) == {"stretch", "shear", "bend", "poisson"}


def test_every_panel_has_its_own_weave_and_weight() -> None:
    """Doubled cloth is twice as heavy and stiff to stretch, and a panel of another weave has that one's numbers."""
    outfit = load_outfit(ASSETS / "outfits/gown.toml")
    (layer,) = outfit.layers
    cloth = layer.pattern.cloth(EDGE)
    materials = materials_of(layer, cloth, 1.28)
    assert materials.names == ("gown-gauze", "juan doubled")
    single, twice = materials.kinds
    kinds = materials.of_faces(cloth.mirrored())
    doubled = [panel.doubled for panel in layer.pattern.panels] * 2
    assert (kinds == np.array(doubled)[cloth.mirrored().panel]).all()
    plain = simplified(
        parameters_of(juan := layer.weaves["band"], solve(juan, particles=True)),
        layer.program,
        1.28,
        layer.edge,
    )
    assert twice.density == pytest.approx(2 * plain[0].density)
    assert twice.stretch == pytest.approx(2 * plain[0].stretch)
    assert twice.bend == pytest.approx(6 * plain[0].bend)
    assert single.density < plain[0].density
    assert "doubled" in materials.choices


def test_pairs_are_the_twins_of_the_sewn_seams(half: tuple[Pattern, Cloth], sheet: SewnSheet) -> None:
    _, cloth = half
    x = sheet.gathered(np.column_stack([cloth.vertices, np.zeros(len(cloth.vertices))]))
    wanted = {tuple(sorted(pair)) for pair in sheet.number[_named(cloth)].tolist()}
    assert {tuple(pair) for pair in cloth.pairs.tolist()} == wanted
    assert (x[sheet.slaves[:, 0]] == x[sheet.slaves[:, 1]] * [-1.0, 1.0, 1.0]).all()
    assert (x[sheet.middle, 0] == 0.0).all()


def _named(cloth: Cloth) -> np.ndarray:
    """Pattern vertices (K, 2) of the cloth's own pairs, which number points of `joined`."""
    first = np.zeros(cloth.joined.max() + 1, int)
    first[cloth.joined[::-1]] = np.arange(len(cloth.joined))[::-1]
    return first[cloth.pairs]


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
