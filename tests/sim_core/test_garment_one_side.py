"""A panel that one side of a mirrored pattern has alone: cut once, sewn to its half, laid round the back, thinned."""

import json
import re
import shutil
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim_core import metrics
from sim_core.body import Figure, Mannequin, pose_named
from sim_core.cli import main
from sim_core.errors import FileProblem, SimCoreError
from sim_core.garment import Garment, Pattern, choose_detail, dress, load_outfit
from sim_core.garment.dressing import capped, overlap
from sim_core.garment.pattern import Cloth
from sim_core.garment.placement import Flat, Ground

ASSETS = Path(__file__).parents[2] / "assets"
QUJU = ASSETS / "patterns" / "quju.toml"
STEP = 0.04
CHORD = 0.0023  # [m2] between a quarter of a circle of 9 cm, as under an arm, and its chord

BAG = """\
name = "bag"
edge = 0.05
mirror = true
[[panel]]
name = "sack"
outline = [
  { name = "top", at = [0, -200] }, { name = "low", at = [0, 200] },
  { name = "corner", at = [200, 200] }, { name = "edge", at = [200, -200] },
]
[[panel]]
name = "flap"
side = "left"
outline = [
  { name = "low", at = [200, 200] }, { name = "far", at = [300, 200] },
  { name = "tip", at = [300, -200] }, { name = "high", at = [200, -200] },
]
[[seam]]
middle = "sack: top > low"
[[seam]]
joined = ["sack: corner > edge", "flap: low < high"]
[[tie]]
name = "tip"
a = { panel = "flap", at = [300, 0] }
b = { panel = "sack", side = "right", at = [0, 0] }
length = 10
"""


BESIDE = """\
[[panel]]
name = "edging"
along = "flap: far > tip"
outline = [
  { name = "a", at = [0, 0] }, { name = "b", at = [30, 0] },
  { name = "c", at = [30, 400] }, { name = "d", at = [0, 400] },
]
"""


def read(tmp_path: Path, text: str = BAG) -> Pattern:
    path = tmp_path / "bag.toml"
    path.write_text(text, "utf-8")
    return Pattern.load(path)


def area(points: np.ndarray, faces: np.ndarray) -> float:
    a, b = (points[faces[:, k]] - points[faces[:, 0]] for k in (1, 2))
    return 0.5 * float((a[:, 1] * b[:, 0] - a[:, 0] * b[:, 1]).sum())


def test_it_is_cut_once_and_joined_to_its_own_half(tmp_path: Path) -> None:
    pattern = read(tmp_path)
    cut = pattern.cloth(0.05)
    whole = pattern.whole(cut)
    assert whole.names == ("sack left", "flap left", "sack right", "flap right")
    assert area(whole.vertices, whole.faces) == pytest.approx(2 * 0.08 + 0.04)
    assert not (whole.panel == 3).any()
    assert not (whole.panel_of == 3).any()
    assert (np.unique(whole.faces) == np.arange(len(whole.vertices))).all()
    seam = pattern.seams[1]
    assert seam.b is not None
    a, b = (whole.along(path, pattern.panel(path.panel), " left") for path in (seam.a, seam.b))
    assert (whole.joined[a] == whole.joined[b]).all()
    assert len(np.unique(whole.joined)) == whole.joined.max() + 1
    assert len(np.unique(whole.closed)) == whole.closed.max() + 1
    assert not any(key.startswith("flap right") for key in whole.paths)
    assert pattern.ties[0].a.side == "left"  # it need not be said


def test_it_survives_the_way_through_a_dictionary(tmp_path: Path) -> None:
    pattern = read(tmp_path)
    again = Pattern.from_dict(pattern.to_dict())
    assert [panel.side for panel in again.panels] == ["", "left"]
    assert not again.alike
    assert (
        "side" not in pattern.panels[0].to_dict()
    )  # as garments have it that were saved before there were any
    assert (
        again.whole(again.cloth(0.05)).vertices.tobytes()
        == pattern.whole(pattern.cloth(0.05)).vertices.tobytes()
    )


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("mirror = true", "", ["panel.flap.side", "mirror = true"]),
        ('side = "left"', 'side = "middle"', ["panel.2.side", "'left'", "middle"]),
        ('panel = "flap", at', 'panel = "flap", side = "right", at', ["tie.tip.a.side", "left alone"]),
        ("[[seam]]\nmiddle", BESIDE + "[[seam]]\nmiddle", ["panel.edging.side", "'flap'", "left alone"]),
        ('middle = "sack: top > low"', 'middle = "flap: low > far"', ["seam.1.middle", "one side alone"]),
        ('name = "sack"', 'name = "sack"\nside = "right"', ["seam.1.middle", "one side alone"]),
    ],
)
def test_mistakes_name_file_and_key(tmp_path: Path, old: str, new: str, words: Sequence[str]) -> None:
    assert old in BAG
    with pytest.raises(FileProblem) as caught:
        read(tmp_path, BAG.replace(old, new, 1))
    assert str(caught.value).startswith(str(tmp_path / "bag.toml"))
    for word in words:
        assert word in str(caught.value)


def test_panels_of_opposite_sides_are_not_sewn_together(tmp_path: Path) -> None:
    text = BAG.replace('[[seam]]\nmiddle = "sack: top > low"\n', "").replace(
        'name = "sack"', 'name = "sack"\nside = "right"', 1
    )
    with pytest.raises(FileProblem, match="never meet"):
        read(tmp_path, text.replace('panel = "sack", side = "right"', 'panel = "sack"'))


GORE = """
[[panel]]
name = "p"
outline = [
  { name = "top", at = [0, 0] }, { name = "low", at = [0, 400] },
  { name = "hem", at = [150, 400] }, { name = "apex", at = [200, 0] },
]
[[panel]]
name = "gore"
side = "left"
outline = [{ name = "apex", at = [200, 0] }, { name = "near", at = [150, 400] }, { name = "far", at = [250, 400] }]
[[panel]]
name = "q"
outline = [
  { name = "apex", at = [200, 0] }, { name = "hem", at = [250, 400] },
  { name = "corner", at = [400, 400] }, { name = "edge", at = [400, 0] },
]
[[seam]]
middle = "p: top > low"
[[seam]]
KIND = ["p: apex < hem", "gore: apex > near"]
[[seam]]
KIND = ["q: apex > hem", "gore: apex < far"]
"""


@pytest.mark.parametrize("kind", ["joined", "sewn"])
def test_what_it_joins_on_its_own_side_stays_apart_on_the_other(tmp_path: Path, kind: str) -> None:
    """A gore set into a slit: on the right, where there is none, nothing holds the slit's sides together."""
    pattern = read(tmp_path, 'name = "slit"\nedge = 0.05\nmirror = true\n' + GORE.replace("KIND", kind))
    whole = pattern.whole(pattern.cloth(0.05))
    for side, met in (("left", True), ("right", False)):
        p, q = (whole.closed[whole.panel_of == whole.names.index(f"{name} {side}")] for name in "pq")
        assert (len(np.intersect1d(p, q)) > 0) is met
    right = np.isin(whole.panel_of, [k for k, name in enumerate(whole.names) if name.endswith("right")])
    assert not np.isin(whole.pairs, whole.joined[right]).any()
    capped(np.column_stack([whole.vertices, np.zeros(len(whole.vertices))]), whole.closed[whole.faces])


def test_each_side_may_have_its_own_on_one_edge(tmp_path: Path) -> None:
    """A wide flap for the left, a narrow one for the right: they never meet."""
    small = """\
[[panel]]
name = "small"
side = "right"
outline = [
  { name = "low", at = [200, 200] }, { name = "far", at = [240, 200] },
  { name = "tip", at = [240, -200] }, { name = "high", at = [200, -200] },
]
[[seam]]
joined = ["sack: corner > edge", "small: low < high"]
[[tie]]"""
    pattern = read(tmp_path, BAG.replace("[[tie]]", small, 1))
    whole = pattern.whole(pattern.cloth(0.05))
    assert area(whole.vertices, whole.faces) == pytest.approx(2 * 0.08 + 0.04 + 0.016)
    for seam, side in zip(pattern.seams[1:], (" left", " right"), strict=True):
        assert seam.b is not None
        a, b = (whole.along(path, pattern.panel(path.panel), side) for path in (seam.a, seam.b))
        assert (whole.joined[a] == whole.joined[b]).all()
    with pytest.raises(FileProblem, match="sewn already"):
        read(tmp_path, BAG.replace("[[tie]]", small.replace('"right"', '"left"'), 1))


def test_other_formats_have_it_once(tmp_path: Path) -> None:
    read(tmp_path)
    assert main(["mesh", str(tmp_path / "bag.toml"), "--pattern", str(tmp_path / "bag.json")]) == 0
    code = json.loads((tmp_path / "bag.json").read_text("utf-8"))["pattern"]
    assert sorted(code["panels"]) == ["flap", "sack", "sack_other"]
    assert len(code["stitches"]) == 2
    assert main(["mesh", str(tmp_path / "bag.json"), "--pattern", str(tmp_path / "back.toml")]) == 0
    back = Pattern.load(tmp_path / "back.toml")
    assert [panel.side for panel in back.panels] == ["", "left"]


def test_pins_know_what_the_right_side_has_alone(tmp_path: Path) -> None:
    """The nape is on the first panel, though that is the second half's alone: it stays while all else falls."""
    text = BAG.replace('side = "right", at = [0, 0]', "at = [0, 0]").replace(
        'side = "left"', 'side = "right"'
    )
    head, sack, flap, seams = re.split(r"(?=\[\[panel\]\])|(?=\[\[seam\]\]\nmiddle)", text)
    read(tmp_path, head + flap + sack + seams)
    steps = '[[layer.step]]\ndo = "pin"\nat = ["nape"]\n[[layer.step]]\ndo = "settle"\nseconds = 0.12\n'
    layer = f'[[layer]]\npattern = "bag.toml"\nweave = "juan.toml"\nedge = 0.05\n{steps}'
    (tmp_path / "it.toml").write_text(f'stand = {{ kind = "t_bar", height = 1.6 }}\n{layer}', "utf-8")
    shutil.copy(ASSETS / "weaves" / "juan.toml", tmp_path)
    frames: list[np.ndarray] = []
    (garment,) = dress(
        load_outfit(tmp_path / "it.toml", tmp_path), on_frame=lambda f: frames.append(f.positions)
    )
    moved = np.linalg.norm(frames[-1] - frames[0], axis=1)
    flap_right = np.unique(garment.pattern_faces[garment.panel == garment.panels.index("flap right")])
    assert moved.max() > 0.01
    assert (moved[flap_right] < 1e-6).any()


def laid(
    tmp_path: Path, reach: float = 560.0, over: str = "left", side: str = "", also: Sequence[str] = ()
) -> tuple[Cloth, np.ndarray]:
    """The curved wrap robe, its point of `reach` [mm] tied nowhere, as it is laid: cloth, positions (P, 3). side: that
    has the point, the outer one unless it is told; also: what it has alone besides."""
    text = re.sub(r"\[\[tie\]\].*?\n\n", "", QUJU.read_text("utf-8"), flags=re.DOTALL)
    (tmp_path / "bag.toml").write_text(text, "utf-8")
    pattern = Pattern.load(tmp_path / "bag.toml", {"reach": reach})
    own = side or over
    panels = tuple(replace(p, side=own if p.side or p.name in also else "") for p in pattern.panels)
    pattern = replace(pattern, panels=panels)
    figure = Figure(Mannequin.load(ASSETS / "mannequins" / "woman.npz"))
    pose = pose_named("t")
    vertices, faces = figure.mesh(pose)
    ground = Ground(vertices, faces, trunk=figure.trunk())
    cut = pattern.cloth(STEP)
    return pattern.whole(cut), Flat(over=over).whole(pattern, cut, ground)


@pytest.mark.parametrize("over", ["left", "right"])
def test_what_lies_beyond_the_sides_goes_on_round_the_back(tmp_path: Path, over: str) -> None:
    """Without strain, outside of all that is laid flat, and as far as it is long."""
    cloth, x = laid(tmp_path, reach=900.0, over=over)
    point = cloth.panel == cloth.names.index(f"point {over}")
    assert np.abs(metrics.area_strain(cloth.vertices, x, cloth.faces[point])).max() < 0.005
    own = np.unique(cloth.faces[point])
    towards = -1.0 if over == "left" else 1.0  # across the front to the other side of the wearer
    flat = np.array([not name.startswith("point") for name in cloth.names])
    body = x[np.unique(cloth.faces[flat[cloth.panel]])]
    body = body[np.abs(body[:, 1] - 0.6) < 0.3]  # below the sleeves
    out = x[own[x[own, 2] < 0.05]]
    beside, behind = towards * out[:, 0] > (towards * body[:, 0]).max(), out[:, 2] < body[:, 2].min()
    assert behind.sum() > 10
    assert (beside | behind).all()
    whole = np.zeros((cloth.joined.max() + 1, 3))
    whole[cloth.joined] = x
    below = cloth.faces[(np.abs(cloth.vertices[cloth.faces, 1]) > 0.3).all(1)]
    assert metrics.intersections(whole, cloth.joined[below]) == 0


def test_a_longer_point_goes_round_again_outside_of_itself(tmp_path: Path) -> None:
    cloth, x = laid(tmp_path, reach=3200.0)
    point = cloth.panel == cloth.names.index("point left")
    assert np.abs(metrics.area_strain(cloth.vertices, x, cloth.faces[point])).max() < 0.005
    own = np.unique(cloth.faces[point])
    turns = np.unwrap(np.arctan2(x[own, 0], x[own, 2])[np.argsort(-cloth.vertices[own, 0])])
    assert np.ptp(turns) > 2 * np.pi
    whole = np.zeros((cloth.joined.max() + 1, 3))
    whole[cloth.joined] = x
    below = cloth.faces[(np.abs(cloth.vertices[cloth.faces, 1]) > 0.3).all(1)]
    assert metrics.intersections(whole, cloth.joined[below]) == 0


def test_an_inner_front_does_not_go_round(tmp_path: Path) -> None:
    with pytest.raises(SimCoreError, match="over = 'right': a front of the left reaches beyond"):
        laid(tmp_path, over="right", side="left")


def test_another_panel_of_one_side_does_not_hold_the_point_back(tmp_path: Path) -> None:
    """The lapel of the left alone begins as high as the sleeves, which nothing turns round."""
    cloth, x = laid(tmp_path)
    other, y = laid(tmp_path, also=("lapel", "lapel_band"))
    for name in ("point left", "point_band left"):
        (a, b) = (np.unique(one.faces[one.panel == one.names.index(name)]) for one in (cloth, other))
        assert y[b] == pytest.approx(x[a], abs=1e-9)


@pytest.fixture(scope="module")
def robe() -> Garment:
    """The shipped outfit's robe by itself, coarse and not yet at rest."""
    outfit = load_outfit(ASSETS / "outfits" / "quju.toml", content=ASSETS)
    layer = next(layer for layer in outfit.layers if layer.pattern.name == "quju")
    steps = tuple(
        replace(step, seconds=min(step.seconds, 1.0)) if step.do == "rest" else step
        for step in layer.program.steps
    )
    program = replace(layer.program, steps=steps)
    (garment,) = dress(replace(outfit, layers=(replace(layer, edge=0.05, program=program),)))
    return garment


@pytest.mark.nightly
@pytest.mark.slow
def test_a_robe_with_a_point_is_dressed(robe: Garment) -> None:
    """Sewn, its point behind the wearer and outside of the back."""
    facts = robe.provenance["errors"]
    assert facts["inside_midpoints"] == facts["inside_centroids"] == 0
    assert facts["clearance_m"][0] > -0.0025  # triangles of 5 cm: less than a layer's thickness
    assert facts["seam_gap_m"] == 0.0
    assert facts["layer_order"] <= 5
    assert facts["area_strain_p95"] <= 0.03
    assert "asymmetry_m" not in facts  # its halves are not alike
    x, point = robe.worn(), np.unique(robe.pattern_faces[robe.panel == robe.panels.index("point left")])
    tip = point[np.argmin(robe.pattern[point, 0])]
    assert x[tip, 0] > 0.1  # it went from the middle of the front by the right and the back to the left side
    behind = {
        name: np.unique(robe.pattern_faces[robe.panel == robe.panels.index(name)])
        for name in ("point left", "back right")
    }
    low = {name: own[np.abs(x[own, 1] - 0.75) < 0.1] for name, own in behind.items()}
    assert x[low["point left"], 2].min() < x[low["back right"], 2].min()  # and lies outside


@pytest.mark.nightly
@pytest.mark.slow
def test_a_robe_with_a_point_is_thinned_whole(robe: Garment, tmp_path: Path) -> None:
    robe.save(tmp_path / "robe.npz")
    again = Garment.load(tmp_path / "robe.npz")
    assert again.positions.tobytes() == robe.positions.tobytes()
    level = choose_detail(again, 0.02)
    assert len(level.faces) < len(robe.faces)
    for number, name in enumerate(robe.panels):
        before, after = (area(one.pattern, one.pattern_faces[one.panel == number]) for one in (robe, level))
        curved = name.partition(" ")[0] in ("body", "band")
        assert after == pytest.approx(before, abs=2 * CHORD if curved else 1e-9), name


def test_a_front_that_lies_wrong_is_counted(robe: Garment) -> None:
    """The robe as it lies is in order but for what its coarse triangles do; told to lie the other way it is not."""
    under, over = overlap(robe, Flat(over="left"))
    wrong, right = overlap(robe, Flat(over="right"))
    assert over > 4 * under
    assert wrong > 4 * right
