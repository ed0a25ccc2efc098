"""Each way of placing, proved by a small outfit of its own: wrapped, folded over a bar, along a path, upright."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from sim_core import metrics
from sim_core.body import Figure, Mannequin, TBar, pose_named
from sim_core.errors import SimCoreError
from sim_core.garment import Garment, check_fits, dress, layer_order, load_outfit
from sim_core.garment.dressing import overlap
from sim_core.garment.pattern import Pattern
from sim_core.garment.placement import Ground, Wrapped

ASSETS = Path(__file__).parents[2] / "assets"
SKIRT = """\
name = "skirt"
edge = 0.03
[measures]
round = 1080
length = 500
[[panel]]
name = "tube"
outline = [
  { name = "top_begin", at = [0, 0] },
  { name = "hem_begin", at = [0, "length"] },
  { name = "hem_end", at = ["round", "length"] },
  { name = "top_end", at = ["round", 0] },
]
[[seam]]
sewn = ["tube: top_begin > hem_begin", "tube: top_end < hem_end"]
"""
LAPPED = SKIRT.split("[[seam]]")[0].replace("1080", "1500").replace('"skirt"', '"lapped"')
CLOTH = 'name = "cloth"\nedge = 0.03\nsize = [0.5, 1.2]\n'
BAND = """\
name = "band"
edge = 0.03
mirror = true
[measures]
half = 700
width = 60
[[panel]]
name = "strip"
outline = [
  { name = "top", at = [0, 0] },
  { name = "bottom", at = [0, "width"] },
  { name = "end_bottom", at = ["half", "width"] },
  { name = "end_top", at = ["half", 0] },
]
[[seam]]
middle = "strip: top > bottom"
"""
STEPS = """
[[layer.step]]
do = "settle"
seconds = 0.2
gravity = [0.0, 9.81]
damping = 10.0
[[layer.step]]
do = "rest"
seconds = 1.0
damping = 12.0
friction = 0.6
still = 1e-4
"""


def of(folder: Path, pattern: str, place: str, on: str, steps: str = STEPS) -> tuple[Garment, ...]:
    """A small outfit from files, dressed."""
    (folder / "piece.toml").write_text(pattern, "utf-8")
    head = f'{on}\n[[layer]]\npattern = "{folder / "piece.toml"}"\nweave = "weaves/juan.toml"\n'
    (folder / "it.toml").write_text(f"{head}[layer.place]\n{place}\n{steps}", "utf-8")
    return dress(load_outfit(folder / "it.toml", ASSETS))


WEARER = 'wearer = "mannequins/woman.npz"\npose = "display"'
WELDED = """
[[layer.step]]
do = "pin"
at = ["top"]
[[layer.step]]
do = "sew"
seconds = 0.08
[[layer.step]]
do = "weld"
"""


T_BAR = '[stand]\nkind = "t_bar"\nheight = 1.0\nspan = 1.4'
SHORT_ROBE = """\
name = "jacket"
edge = 0.035
mirror = true
[[panel]]
name = "body"
outline = [
  { name = "nape", at = [0, -20] },
  { name = "throat", at = [80, 0] },
  { name = "front_hem", at = [80, 500] },
  { name = "side_front", at = [250, 500] },
  { name = "pit_front", at = [250, 250] },
  { name = "cuff_front", at = [600, 200] },
  { name = "cuff_back", at = [600, -200] },
  { name = "pit_back", at = [250, -250] },
  { name = "side_back", at = [250, -500] },
  { name = "back_hem", at = [0, -500] },
]
[[seam]]
sewn = ["body: side_front > cuff_front", "body: side_back < cuff_back"]
[[seam]]
middle = "body: back_hem > nape"
"""


PINNED = '[[layer.step]]\ndo = "pin"\nat = ["top"]\n'


@pytest.fixture(scope="module")
def woman() -> Mannequin:
    return Mannequin.load(ASSETS / "mannequins/woman.npz")


def clear(garment: Garment) -> bool:
    facts = garment.provenance["errors"]
    return facts["inside_vertices"] + facts["inside_midpoints"] + facts["inside_centroids"] == 0


@pytest.mark.slow
def test_a_robe_is_spread_on_a_bar_through_both_sleeves(tmp_path: Path) -> None:
    sewing = '[[layer.step]]\ndo = "sew"\nseconds = 0.4\n[[layer.step]]\ndo = "weld"\n'
    (jacket,) = of(tmp_path, SHORT_ROBE, 'way = "flat"', T_BAR, sewing + STEPS)
    facts = jacket.provenance["errors"]
    assert clear(jacket)
    assert facts["self_intersections"] == 0
    assert facts["area_strain_p95"] < 0.03
    x = jacket.positions
    assert np.ptp(x[:, 0]) == pytest.approx(1.2, abs=0.03)  # as wide as it was cut
    assert 1.02 < x[:, 1].max() < 1.045  # over the bar, chords of its mesh clear of it
    assert 0.5 < x[:, 1].min() < 0.62  # and down in front and behind; sides droop
    assert jacket.settled is not None
    stand = jacket.settled.beneath.stand
    assert isinstance(stand, TBar)
    jacket.save(tmp_path / "jacket.npz")
    again = Garment.load(tmp_path / "jacket.npz")
    assert again.settled is not None
    assert again.settled.beneath.stand == stand


@pytest.mark.slow
def test_a_tube_skirt_goes_round_the_hips_and_hangs(tmp_path: Path, woman: Mannequin) -> None:
    (skirt,) = of(tmp_path, SKIRT, 'way = "wrapped"', WEARER, WELDED + STEPS)
    facts = skirt.provenance["errors"]
    assert clear(skirt)
    assert facts["self_intersections"] == 0
    assert facts["area_strain_p95"] < 0.03
    assert facts["seam_gap_m"] == 0.0
    waist = woman.landmarks(pose_named("display"))["waist"][1]
    x = skirt.worn()
    top = x[skirt.pattern[:, 1] < 1e-6]
    assert top[:, 1] == pytest.approx(waist, abs=1e-3)  # held there
    assert x[:, 1].min() == pytest.approx(waist - 0.5, abs=0.02)
    angle = np.sort(np.arctan2(top[:, 0], top[:, 2]))
    assert np.diff(angle).max() < 0.3  # all the way round
    assert skirt.settled is not None
    assert len(skirt.settled.last.pins) > 20  # and stays held when it is carried on


@pytest.mark.parametrize(("text", "turns"), [(SKIRT, 1.0), (LAPPED, 1.5)])
def test_wrapped_cloth_is_not_strained_and_keeps_its_layers_apart(
    tmp_path: Path, woman: Mannequin, text: str, turns: float
) -> None:
    (tmp_path / "piece.toml").write_text(text, "utf-8")
    pattern = Pattern.load(tmp_path / "piece.toml")
    figure, pose = Figure(woman), pose_named("display")
    vertices, faces = figure.mesh(pose)
    ground = Ground(vertices, faces, figure.trunk(), woman.landmarks(pose))
    cloth = pattern.cloth(0.02)
    x = Wrapped().start(pattern, cloth, ground, np.random.default_rng(0))
    strain = metrics.area_strain(cloth.vertices, x, cloth.faces)
    assert np.abs(strain).max() < 0.03
    welded = np.zeros((cloth.closed.max() + 1, 3))
    welded[cloth.closed] = x
    assert metrics.intersections(welded, cloth.closed[cloth.faces]) == 0
    assert metrics.penetration(x, cloth.faces, vertices, faces).total == 0
    middle = vertices[figure.trunk()].mean(0)
    ahead = np.unwrap(
        np.arctan2(x[:, 0], x[:, 2] - middle[2])[np.argsort(cloth.vertices[:, 0], kind="stable")]
    )
    assert np.ptp(ahead) / (2 * np.pi) == pytest.approx(turns, abs=0.1)


@pytest.mark.parametrize("edge", [0.016, 0.03])
def test_wrapped_cloth_keeps_clear_of_sharp_corners(tmp_path: Path, edge: float) -> None:
    """Of what it goes round, with its faces too: a stiff edge beneath a sash stands out like this post's corners."""
    (tmp_path / "piece.toml").write_text(LAPPED, "utf-8")
    pattern = Pattern.load(tmp_path / "piece.toml")
    post = trimesh.creation.box((0.3, 1.0, 0.3))
    post.apply_translation((0.0, 0.5, 0.0))
    corners = np.arange(len(post.vertices))
    own = post.vertices * [0.1, 1.0, 0.1]  # a thin wearer, who is told by vertices alone, in a post it wears
    ground = Ground(
        own, post.faces, corners, {"waist": np.array([0.0, 0.8, 0.0])}, worn=((post.vertices, post.faces),)
    )
    cloth = pattern.cloth(edge)
    x = Wrapped().start(pattern, cloth, ground, np.random.default_rng(0))
    found = metrics.penetration(x, cloth.faces, post.vertices, post.faces)
    assert found.total == 0
    assert min(found.clearance) > 0.0025


@pytest.mark.slow
def test_the_end_of_a_wrap_lies_over_its_begin(tmp_path: Path) -> None:
    (wrap,) = of(tmp_path, LAPPED, 'way = "wrapped"', WEARER, STEPS.replace("[[", PINNED + "[[", 1))
    assert wrap.provenance["errors"]["layer_order"] == 0
    under, over = overlap(wrap, Wrapped())
    assert under == 0
    assert over > 50
    back = replace(wrap, pattern=wrap.pattern * [-1.0, 1.0])  # as if it had been wound the other way
    assert layer_order(back, Wrapped()) > 50


def test_a_skirt_narrower_than_another_beneath_is_refused_before_anything_runs(tmp_path: Path) -> None:
    for name, text in (("inner", SKIRT), ("outer", SKIRT.replace("1080", "1040"))):
        (tmp_path / f"{name}.toml").write_text(text, "utf-8")
    layers = "".join(
        f'[[layer]]\nname = "{name}"\npattern = "{tmp_path / name}.toml"\nweave = "weaves/juan.toml"\n'
        f'[layer.place]\nway = "wrapped"\n{WELDED}{STEPS}'
        for name in ("inner", "outer")
    )
    (tmp_path / "it.toml").write_text(f"{WEARER}\n{layers}", "utf-8")
    it = load_outfit(tmp_path / "it.toml", ASSETS)
    with pytest.raises(
        SimCoreError, match=r"it\.toml: layer\.2\.place: pattern skirt: 1\.040 m wide – to go round"
    ):
        check_fits(it)
    check_fits(replace(it, layers=it.layers[:1]))


BENEATH = """
[[layer.step]]
do = "settle"
seconds = 0.4
damping = 6.0
friction = 0.3
[[layer.step]]
do = "pose"
seconds = 0.6
damping = 4.0
"""


@pytest.mark.nightly
def test_a_skirt_lies_beneath_a_robe_that_is_dressed_flat(tmp_path: Path) -> None:
    (tmp_path / "skirt.toml").write_text(SKIRT.replace("500", "800"), "utf-8")
    head = f'{WEARER}\n[[layer]]\npattern = "{tmp_path / "skirt.toml"}"\nweave = "weaves/juan.toml"\n'
    robe = '[[layer]]\npattern = "patterns/beizi.toml"\nweave = "weaves/ling.toml"\nedge = 0.03\n'
    begun = head + 'start = "t"\n[layer.place]\nway = "wrapped"\n' + WELDED + BENEATH
    path = tmp_path / "it.toml"
    path.write_text(begun.replace('start = "t"\n', "") + robe, "utf-8")
    with pytest.raises(
        SimCoreError, match=r"layer\.2\.step: .*beneath one that is dressed flat, start = \"t\""
    ):
        check_fits(load_outfit(path, ASSETS))
    path.write_text(begun + robe, "utf-8")
    skirt, over = dress(load_outfit(path, ASSETS))
    assert clear(skirt)
    assert clear(over)
    assert over.provenance["errors"]["rest_p99_m"] < 1e-4


UPRIGHT = 'way = "upright"\nrise = 0.03\nfront = 0.16\nback = 0.11'


def trousers() -> str:
    """The shipped pattern on a coarse mesh."""
    return (ASSETS / "patterns/ku.toml").read_text("utf-8").replace("edge = 0.02", "edge = 0.03")


@pytest.mark.slow
def test_trousers_stand_before_and_behind_the_legs_and_are_sewn_about_each(
    tmp_path: Path, woman: Mannequin
) -> None:
    sewing = (
        '[[layer.step]]\ndo = "pin"\nat = ["middle"]\n'
        '[[layer.step]]\ndo = "sew"\nseconds = 0.88\ngravity = [0.0, 0.0]\ndamping = 6.0\nfriction = 0.0\n'
        '[[layer.step]]\ndo = "sew"\nseconds = 0.16\ngravity = [0.0, 0.0]\ndamping = 8.0\nfriction = 0.0\n'
        '[[layer.step]]\ndo = "weld"\n'
    )
    (worn,) = of(tmp_path, trousers(), UPRIGHT, WEARER, sewing + PINNED + STEPS)
    facts = worn.provenance["errors"]
    assert clear(worn)
    assert facts["self_intersections"] == 0
    assert facts["seam_gap_m"] == 0.0
    x, marks = worn.positions, woman.landmarks(pose_named("display"))
    assert x[:, 1].max() == pytest.approx(marks["waist"][1] + 0.03, abs=0.02)
    assert 0.05 < x[:, 1].min() < 0.2  # to the ankles
    height = float(marks["knee_l"][1]) + 0.1
    legs = worn.faces[(np.abs(x[worn.faces, 1] - height) < 0.05).all(1)]
    sides = [legs[(x[legs, 0].mean(1) * side) > 0] for side in (1.0, -1.0)]
    for side, name in zip(sides, ("knee_l", "knee_r"), strict=True):  # each goes all the way round its leg
        away = x[side].mean(1) - [marks[name][0], height, marks[name][2]]
        angle = np.sort(np.arctan2(away[:, 0], away[:, 2]))
        assert np.diff(angle, append=angle[0] + 2 * np.pi).max() < 1.0


def test_an_upright_panel_is_before_the_body_or_behind_it(tmp_path: Path) -> None:
    across = trousers().replace(
        '{ name = "waist_middle", at = [0, 0] }', '{ name = "waist_middle", at = [0, -20] }', 1
    )
    with pytest.raises(SimCoreError, match="panel 'front' reaches from y = -0.020 .* cut it in two"):
        of(tmp_path, across, UPRIGHT, WEARER, "")
    with pytest.raises(SimCoreError, match="1.20 m long, 0.1.* more than there is from 'waist' to the floor"):
        of(tmp_path, trousers().replace("length = 975", "length = 1200"), UPRIGHT, WEARER, "")


def test_a_skirt_narrower_than_the_hips_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        SimCoreError, match=r"0\.700 m wide – to go round the wearer below 'waist' it needs 0\.9"
    ):
        of(tmp_path, SKIRT.replace("1080", "700"), 'way = "wrapped"', WEARER, WELDED + STEPS)


def test_a_cloth_folded_over_a_bar_hangs_on_both_sides(tmp_path: Path) -> None:
    (cloth,) = of(tmp_path, CLOTH, 'way = "folded"\nfront = 0.6', "[stand]\nheight = 1.5")
    facts = cloth.provenance["errors"]
    assert clear(cloth)
    assert facts["self_intersections"] == 0
    assert facts["area_strain_p95"] < 0.03
    x = cloth.positions
    assert 1.5 < x[:, 1].max() < 1.53
    for side in (1, -1):
        own = x[side * x[:, 2] > 0]
        assert own[:, 1].min() == pytest.approx(0.92, abs=0.03)
        assert np.abs(own[own[:, 1] < 1.3, 2]).max() < 0.15


def test_what_does_not_fit_a_stand_is_refused(tmp_path: Path) -> None:
    bar = "[stand]\nheight = 1.0"
    with pytest.raises(SimCoreError, match="touches the floor"):
        of(tmp_path, CLOTH.replace("1.2", "2.4"), 'way = "folded"\nfront = 0.6', bar)
    with pytest.raises(SimCoreError, match="wider than the stand"):
        of(tmp_path, CLOTH.replace("0.5", "0.9"), 'way = "folded"\nfront = 0.6', bar)
    with pytest.raises(SimCoreError, match="leaves none"):
        of(tmp_path, CLOTH, 'way = "folded"\nfront = 1.6', bar)


LED = {
    "one place": (
        'along = ["hip_l", "hip_l"]\n',
        "[0.0, 0.0, 0.0]",
        "place.along: hip_l and hip_l are one place",
    ),
    "out of reach": ("", "[15.0, 0.0, 0.0]", "place.knot: the knots lie up to .* half the strip"),
    "out of the world": ("", "[1e300, 0.0, 0.0]", "knot.3.by.1: .*less than"),
}


@pytest.mark.parametrize("case", LED)
def test_a_path_that_leads_nowhere_is_refused(tmp_path: Path, case: str) -> None:
    along, by, words = LED[case]
    knots = (
        '{ near = ["nape"] }, { near = ["shoulder_l"], by = [0.0, 0.05, 0.0] }, { near = ["hip_l"], by = BY }'
    )
    place = f'way = "along_path"\n{along}knot = [{knots.replace("BY", by)}]'
    with pytest.raises(SimCoreError, match=words):
        of(tmp_path, BAND, place, WEARER)


def test_a_band_lies_along_a_path_over_the_arms(tmp_path: Path, woman: Mannequin) -> None:
    knots = (
        '{ near = ["nape"], by = [0.0, -0.02, -0.06] }, { near = ["shoulder_l"], by = [-0.04, 0.06, -0.03] }, '
        '{ near = ["shoulder_l"], by = [-0.03, 0.03, 0.09] }, { near = ["shoulder_l"], by = [-0.04, -0.15, 0.15] }'
    )
    place = 'way = "along_path"\nalong = ["clavicle_l", "shoulder_l"]\n'
    place += f"begin = 0.05\nend = 0.055\nwaves = 1.0\nknot = [{knots}]"
    (band,) = of(tmp_path, BAND, place, WEARER)
    assert clear(band)
    assert not band.provenance["whole"]
    assert band.provenance["errors"]["asymmetry_m"] <= 1e-6  # let go as a whole in the end
    x, marks = band.positions, woman.landmarks(pose_named("display"))
    assert x[:, 1].max() > marks["shoulder_l"][1]  # over the shoulders
    assert 0.7 < x[:, 1].min() < 1.1  # its ends hang in front
    assert x[x[:, 1] < 1.1, 2].min() > 0.0


def test_a_mark_the_figure_does_not_have_is_named(tmp_path: Path) -> None:
    with pytest.raises(SimCoreError, match="no landmark 'tail' – landmarks: pelvis"):
        of(tmp_path, SKIRT, 'way = "wrapped"\nmark = "tail"', WEARER, WELDED + STEPS)
