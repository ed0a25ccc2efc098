"""Outfit files: what they hold, what they leave to defaults, and what is refused before anything runs."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim_core.body import Pose, pose_named
from sim_core.errors import FileProblem, SimCoreError
from sim_core.garment import check_fits, dress, load_outfit
from sim_core.garment.dressing import courses
from sim_core.garment.outfit import default_program
from sim_core.garment.placement import AlongPath, Flat, OverBar

ASSETS = Path(__file__).parents[2] / "assets"
ROBE = """\
wearer = "mannequins/woman.npz"
pose = "display"
[[layer]]
pattern = "patterns/robe.toml"
weave = "weaves/juan.toml"
"""
SCARF = """\
[stand]
height = 1.5
[[layer]]
pattern = "patterns/pibo.toml"
weave = "weaves/gauze.toml"
"""
LENGTH = """\
[[layer]]
name = "{name}"
pattern = "patterns/length.toml"
weave = "weaves/juan.toml"
[layer.place]
way = "folded"
front = 1.2
at = {at}
"""
GOWN = ROBE.replace("robe.toml", "gown.toml").replace("juan", "gauze")

STRAIGHT = '[[layer.step]]\ndo = "sew"\nseconds = 0.4\n[[layer.step]]\ndo = "weld"\n'


def written(folder: Path, text: str) -> Path:
    path = folder / "it.toml"
    path.write_text(text, "utf-8")
    return path


@pytest.mark.parametrize("name", sorted(path.stem for path in (ASSETS / "outfits").glob("*.toml")))
def test_shipped_outfits_are_read_and_fit(name: str) -> None:
    outfit = load_outfit(ASSETS / "outfits" / f"{name}.toml")
    check_fits(outfit)
    assert outfit.title["zh"]
    assert outfit.title["en"]


def test_a_plain_robe_needs_no_steps(tmp_path: Path) -> None:
    outfit = load_outfit(written(tmp_path, ROBE), ASSETS)
    (layer,) = outfit.layers
    assert isinstance(layer.place, Flat)
    assert layer.program == default_program("flat")
    assert layer.edge == layer.pattern.edge
    runs, moves = courses(layer, outfit.pose)
    assert [run.closed for run in runs] == [False, True, True]
    assert moves.poses[0] == pose_named("t")
    assert moves.poses[-1] == pose_named("display")
    assert moves.shares[0] == 0.0
    assert moves.shares[-1] == pytest.approx(1.0)
    last = runs[-1].steps[-1]
    assert last.keys == (len(moves.poses) - 1,) * 2
    assert not last.pins
    assert runs[-1].steps[0].pins == ("nape",)


def test_a_pattern_with_ties_closes_them_where_one_without_passes_over(tmp_path: Path) -> None:
    plain, _ = courses(load_outfit(written(tmp_path, ROBE), ASSETS).layers[0], Pose())
    gown = load_outfit(written(tmp_path, GOWN), ASSETS).layers[0]
    runs, _ = courses(gown, Pose())
    assert not any(run.ties for run in plain)
    assert len(runs) == len(plain) + 1
    closing = next(run for run in runs if run.ties)
    assert [timed.sewing for timed in closing.steps][0] == (1.0, 0.0)
    assert all(run.ties == gown.pattern.ties for run in runs[runs.index(closing) :])


def test_scarves_lie_over_a_bar_or_along_a_path() -> None:
    (over,) = load_outfit(ASSETS / "outfits/pibo.toml").layers
    assert isinstance(over.place, OverBar)
    robe, along = load_outfit(ASSETS / "outfits/pibo-figure.toml").layers
    assert isinstance(robe.place, Flat)
    assert isinstance(along.place, AlongPath)


def test_measures_colours_and_weaves_of_panels_are_changed(tmp_path: Path) -> None:
    text = ROBE + (
        'weaves = { band = "weaves/ling.toml" }\ndye = "#102030"\ndyes = { band = "#ffffff" }\n'
        'measures = { length = 1100, hem = "chest + 60" }\nname = "short"\n'
    )
    (layer,) = load_outfit(written(tmp_path, text), ASSETS).layers
    assert layer.name == "short"
    assert layer.pattern.measures["length"] == 1100
    assert layer.pattern.measures["hem"] == layer.pattern.measures["chest"] + 60
    assert layer.pattern.panel("body").outline()[:, 1].max() == pytest.approx(1.1)
    assert layer.pattern.dye == pytest.approx((16 / 255, 32 / 255, 48 / 255))
    assert layer.pattern.panel("band").dye == (1.0, 1.0, 1.0)
    assert layer.weave_of("band").name == "ling"
    assert layer.weave_of("body").name == "juan"


def test_cloth_is_laid_with_its_repeat_where_it_should_fall(tmp_path: Path) -> None:
    text = ROBE + "origin = [0, 960.5]\norigins = { sleeve = [-20, 30] }\n"
    (layer,) = load_outfit(written(tmp_path, text), ASSETS).layers
    assert layer.placed
    assert layer.origin_of("body") == pytest.approx((0.0, 0.9605))
    assert layer.origin_of("sleeve") == pytest.approx((-0.02, 0.03))
    plain = load_outfit(written(tmp_path, ROBE), ASSETS)
    assert not plain.layers[0].placed
    assert "origin" not in str(plain.to_dict()["layers"])
    with pytest.raises(FileProblem, match=r"layer\.1\.origins: .*cap"):
        load_outfit(written(tmp_path, ROBE + "origins = { cap = [0, 0] }\n"), ASSETS)


def test_lined_cloth_folds_wider_and_gaps_beneath_it_are_filled(tmp_path: Path) -> None:
    """Both are of a layer, and of what decides the result only where they are told."""
    plain = load_outfit(written(tmp_path, ROBE), ASSETS)
    assert "closing" not in str(plain.to_dict())
    told = load_outfit(written(tmp_path, ROBE + "fold = 1.9\nclosing = 0.012\n"), ASSETS)
    (layer,), usual = told.layers, default_program("flat")
    assert (layer.program.fold, layer.closing) == (1.9, 0.012)
    assert layer.program.steps == usual.steps
    assert told.to_dict()["layers"][0]["closing"] == 0.012
    assert told.to_dict() != plain.to_dict()
    for wrong in ("fold = 0", "fold = 9.0", "closing = -0.01", "closing = 0.2"):
        with pytest.raises(FileProblem, match=rf"layer\.1\.{wrong.partition(' ')[0]}"):
            load_outfit(written(tmp_path, ROBE + wrong + "\n"), ASSETS)


def test_a_pose_is_a_name_or_joints(tmp_path: Path) -> None:
    text = ROBE.replace('"display"', '{ name = "held", joints = { neck = [10.0, 0.0, 0.0] } }')
    outfit = load_outfit(written(tmp_path, text), ASSETS)
    assert outfit.pose.vector("neck") == pytest.approx((10, 0, 0))
    assert outfit.pose.vector("elbow_l") == pytest.approx(pose_named("held").vector("elbow_l"))


def test_steps_replace_the_usual_ones(tmp_path: Path) -> None:
    text = ROBE + (
        '[[layer.step]]\ndo = "sew"\nseconds = 0.4\n[[layer.step]]\ndo = "weld"\n'
        '[[layer.step]]\ndo = "pin"\nat = [{ panel = "body", at = ["neck", 0] }]\n'
        '[[layer.step]]\ndo = "settle"\nseconds = 0.4\nfriction = 0.3\n'
    )
    (layer,) = load_outfit(written(tmp_path, text), ASSETS).layers
    assert [step.do for step in layer.program.steps] == ["sew", "weld", "pin", "settle"]
    (spot,) = layer.program.steps[2].spots
    assert spot.place == pytest.approx((0.092, 0.0))
    assert layer.program.contact == default_program("flat").contact


def test_steps_follow_on_the_usual_ones(tmp_path: Path) -> None:
    text = ROBE + '[[layer.then]]\ndo = "rest"\nseconds = 2.0\n'
    (layer,) = load_outfit(written(tmp_path, text), ASSETS).layers
    *usual, last = layer.program.steps
    assert tuple(usual) == default_program("flat").steps
    assert (last.do, last.seconds) == ("rest", 2.0)


BAD = {
    "a tie that follows and is none": (
        ROBE + '[[layer.then]]\ndo = "close"\nties = ["x"]\n[[layer.then]]\ndo = "rest"\nseconds = 1.0\n',
        "layer.1.then.1.ties",
    ),
    "neither": (SCARF.replace("[stand]\nheight = 1.5\n", ""), "wearer: give either"),
    "both": ('wearer = "mannequins/woman.npz"\n' + SCARF, "wearer: give either"),
    "no layer": ('wearer = "mannequins/woman.npz"\n', "layer"),
    "unknown key": (ROBE + "colour = 3\n", "layer.1.colour: unknown key"),
    "no such file": (ROBE.replace("robe.toml", "rope.toml"), r"layer.1.pattern: no file patterns/rope.toml"),
    "no such weave of a panel": (ROBE + 'weaves = { band = "x" }\n', r"layer.1.weaves.band: no file x"),
    "weave of no panel": (
        ROBE + 'weaves = { hood = "weaves/ling.toml" }\n',
        "no panel 'hood' – panels: body",
    ),
    "dye of no panel": (ROBE + 'dyes = { hood = "#000000" }\n', "layer.1.dyes: .*no panel 'hood'"),
    "no such measure": (
        ROBE + "measures = { lenght = 3 }\n",
        "measures.lenght: no such measure – measures: length",
    ),
    "no such pose": (ROBE.replace("display", "flying"), "pose: .*'flying'.* there are t, gown"),
    "no such joint": (
        ROBE.replace('"display"', "{ joints = { wing = [1, 2, 3] } }"),
        "pose: joints: no joint 'wing'",
    ),
    "beyond a limit": (
        ROBE.replace('"display"', "{ joints = { elbow_l = [0, -170, 0] } }"),
        "pose: joints: elbow_l",
    ),
    "no such way": (ROBE + '[layer.place]\nway = "hung"\n', "layer.1.place"),
    "way on a stand": (
        SCARF + '[layer.place]\nway = "flat"\n',
        "layer.1.place.way: 'flat' – choose over_bar",
    ),
    "way on a wearer": (
        ROBE + '[layer.place]\nway = "over_bar"\n',
        "layer.1.place.way: 'over_bar' – choose flat",
    ),
    "flat without panels": (ROBE.replace("robe.toml", "pibo.toml"), "layer.1.pattern: .* needs .*panel"),
    "no such step": (ROBE + '[[layer.step]]\ndo = "iron"\n', "layer.1.step.1.do"),
    "no such tie": (
        GOWN + '[[layer.step]]\ndo = "close"\nseconds = 1.0\nties = ["belt"]\n',
        "'belt' is no tie – ties: in",
    ),
    "no time": (ROBE + '[[layer.step]]\ndo = "sew"\n', "layer.1.step.1.seconds: sew takes time"),
    "never welded": (ROBE + '[[layer.step]]\ndo = "rest"\nseconds = 1.0\n', "layer.1.step: .*no step welds"),
    "sewn after welding": (
        ROBE + '[[layer.step]]\ndo = "weld"\n[[layer.step]]\ndo = "sew"\nseconds = 1.0\n',
        "layer.1.step.2.do: sew after weld",
    ),
    "pinned nothing": (ROBE + '[[layer.step]]\ndo = "pin"\n', "layer.1.step.1.at: say what is pinned"),
    "let go of nothing": (ROBE + '[[layer.step]]\ndo = "release"\n', "layer.1.step.1.do: nothing is pinned"),
    "spot outside": (
        ROBE + '[[layer.step]]\ndo = "pin"\nat = [{ panel = "body", at = [5000, 0] }]\n',
        "layer.1.step.1.at.1.at: 5000, 0 mm lies 4530 mm outside",
    ),
    "not a colour": (ROBE + 'dyes = { band = "red" }\n', "layer.1.dyes.band: .*match.*'red'"),
    "name of no file": (
        ROBE + 'name = "in/ner"\n',
        "layer.1.name: names a file, too – use letters.*'in/ner'",
    ),
    "title in no language of ours": ('title = { fr = "robe" }\n' + ROBE, "title.fr"),
    "seed that is none": (ROBE + "seed = true\n", "layer.1.seed"),
    "bar like a barrel": (SCARF.replace("1.5", "1.5\nbar_radius = 0.5"), "stand.bar_radius: .*less than"),
    "stand like a mast": (SCARF.replace("1.5", "20.0"), "stand.height: .*less than"),
    "wrapped far off": (ROBE + '[layer.place]\nway = "wrapped"\ngap = 20.0\n', "gap: .*less than"),
    "fall beyond all": (
        ROBE + '[[layer.step]]\ndo = "rest"\nseconds = 1.0\ngravity = [1e300, 1.0]\n',
        "layer.1.step.1.gravity.1: .*less than",
    ),
    "pose of no pose step": (
        ROBE + '[[layer.step]]\ndo = "settle"\nseconds = 1.0\npose = "held"\n',
        "layer.1.step.1.pose: settle does not read it, only pose",
    ),
    "time to weld": (ROBE + '[[layer.step]]\ndo = "weld"\nseconds = 1.0\n', "step.1.seconds: weld does not"),
    "welded at the very end": (ROBE + STRAIGHT, r"layer.1.step.2.do: weld comes last, and no time passes"),
    "let go at the very end": (
        ROBE
        + STRAIGHT
        + '[[layer.step]]\ndo = "pin"\nat = ["nape"]\n'
        + '[[layer.step]]\ndo = "settle"\nseconds = 0.2\n[[layer.step]]\ndo = "release"\n',
        r"layer.1.step.5.do: release comes last",
    ),
    "fronts far off": (ROBE + '[layer.place]\nway = "flat"\nlift = 5.0\n', "lift: .*less than"),
    "sheets far off": (ROBE + '[layer.place]\nway = "flat"\nfront = 15.0\n', "front: .*less than"),
    "another begin of flat": (ROBE + 'start = "held"\n', "layer.1.start: flat has its own begin"),
    "a begin that nothing leaves": (
        ROBE + 'start = "t"\n[layer.place]\nway = "wrapped"\n',
        "layer.1.start: no step leaves that pose",
    ),
    "let go of something else": (
        ROBE + '[[layer.step]]\ndo = "pin"\nat = ["nape"]\n[[layer.step]]\ndo = "release"\nat = ["top"]\n',
        "layer.1.step.2.at: it is not pinned",
    ),
    "held by a belt that is not drawn": (
        ROBE + '[[layer.step]]\ndo = "pin"\nat = ["belt"]\n',
        "layer.1.step.1.at: no belt is drawn before",
    ),
    "twice": (ROBE + ROBE.split("\n", 2)[2], "layer.2.name: 'robe' is there twice"),
    "two on a stand": (SCARF + SCARF.split("\n", 2)[2], "layer.2: a stand bears one layer"),
    "two in one place": (
        "[stand]\nspan = 1.2\n" + LENGTH.format(name="red", at=-0.1) + LENGTH.format(name="blue", at=0.1),
        "layer.2.place.at: 0.1 m – lies within 10 mm of 'red'; move it",
    ),
}


def test_lengths_hang_beside_each_other_on_one_stand(tmp_path: Path) -> None:
    rack = "[stand]\nheight = 1.4\nspan = 0.8\n"
    text = rack + LENGTH.format(name="red", at=-0.18) + LENGTH.format(name="blue", at=0.18)
    red, blue = dress(load_outfit(written(tmp_path, text), ASSETS).coarser(0.06))
    assert red.positions[:, 0].max() < 0.0 < blue.positions[:, 0].min()
    assert red.provenance["errors"]["inside_vertices"] == blue.provenance["errors"]["inside_vertices"] == 0
    wide = rack + LENGTH.format(name="red", at=0.3)
    with pytest.raises(SimCoreError, match=r"0\.27 m wide at 0\.3 m reaches 0\.04 m beyond a post – move it"):
        check_fits(load_outfit(written(tmp_path, wide), ASSETS))


@pytest.mark.parametrize("case", BAD)
def test_what_is_wrong_is_told_with_file_key_and_remedy(tmp_path: Path, case: str) -> None:
    text, words = BAD[case]
    path = written(tmp_path, text)
    with pytest.raises(FileProblem, match=words) as caught:
        load_outfit(path, ASSETS)
    assert str(caught.value).startswith(str(tmp_path)) or str(ASSETS) in str(caught.value)
    assert "\n" not in str(caught.value)


WAY = {
    "another end": ((("held",),), r"it\.toml: layer\.1\.step: its steps leave the wearer in another pose"),
    "one by way of another": (
        (("step", "display"), ("display",)),
        r"it\.toml: layer\.2\.step: it is dressed while the wearer moves",
    ),
}


@pytest.mark.parametrize("case", WAY)
def test_layers_share_the_way_of_the_wearer_and_its_end(tmp_path: Path, case: str) -> None:
    layers, words = WAY[case]
    head, _, robe = ROBE.partition("[[layer]]\n")
    text = head
    for number, poses in enumerate(layers):
        name = 'name = "over"\n' if number else ""
        steps = "".join(f'[[layer.step]]\ndo = "pose"\nseconds = 0.4\npose = "{pose}"\n' for pose in poses)
        text += f"[[layer]]\n{name}{robe}{STRAIGHT}{steps}"
    with pytest.raises(SimCoreError, match=words):
        check_fits(load_outfit(written(tmp_path, text), ASSETS))


NARROW = {
    "sleeve": (
        "measures = { cuff = 60, armhole = 62 }\n",
        r"layer\.1\.measures: its left sleeve, .* cm round, what it must go round or let pass",
    ),
    "sleeve at its root": (
        "measures = { armhole = 40 }\n",
        r"layer\.1\.measures: its left sleeve, .* cm from the armpit, is .* cm round",
    ),
    "body": (
        "measures = { chest = 120, hem = 150 }\n",
        r"layer\.1\.measures: its body, .* cm above the floor, is .* cm round",
    ),
    "neck": (
        "measures = { neck = 30, neck_back = 5, close = 60, band = 5 }\n",
        "its neck hole is .* cm round",
    ),
}


@pytest.mark.parametrize("case", NARROW)
def test_what_the_body_cannot_pass_is_refused(tmp_path: Path, case: str) -> None:
    changed, words = NARROW[case]
    outfit = load_outfit(written(tmp_path, ROBE + changed), ASSETS)
    with pytest.raises(SimCoreError, match=words):
        check_fits(outfit)


def test_a_tie_shorter_than_the_girth_it_goes_round_is_refused(tmp_path: Path) -> None:
    """A gown whose fronts are tied right round to the back would have to be narrower than the hips."""
    text = (
        (ASSETS / "patterns/gown.toml")
        .read_text("utf-8")
        .replace('at = ["lap", "upper"]', 'at = ["waist", "upper"]')
    )
    (tmp_path / "tight.toml").write_text(text.replace("waist = 240 ", "waist = 190 "), "utf-8")
    outfit = load_outfit(
        written(tmp_path, GOWN.replace("patterns/gown.toml", str(tmp_path / "tight.toml"))), ASSETS
    )
    with pytest.raises(
        SimCoreError, match="tie 'inner_high' and the cloth .* the girth they go round .* longer"
    ):
        check_fits(outfit)


def test_a_layer_dressed_on_the_way_needs_one_beneath_that_came_the_same_way(tmp_path: Path) -> None:
    text = ROBE + (
        '[[layer]]\nname = "over"\npattern = "patterns/beizi.toml"\nweave = "weaves/ling.toml"\n'
        '[[layer.step]]\ndo = "sew"\nseconds = 0.4\n[[layer.step]]\ndo = "weld"\n'
        '[[layer.step]]\ndo = "rest"\nseconds = 0.4\n'
    )
    check_fits(load_outfit(written(tmp_path, text), ASSETS))
    held = text.replace(
        '[[layer]]\nname = "over"',
        '[[layer.step]]\ndo = "sew"\nseconds = 0.4\n'
        '[[layer.step]]\ndo = "weld"\n[[layer.step]]\ndo = "rest"\nseconds = 0.4\n[[layer]]\nname = "over"',
    )
    moving = held.rsplit("[[layer.step]]", 1)[0] + '[[layer.step]]\ndo = "pose"\nseconds = 0.4\n'
    with pytest.raises(SimCoreError, match=r"it\.toml: layer\.2\.step: it is dressed while the wearer moves"):
        check_fits(load_outfit(written(tmp_path, moving), ASSETS))


def test_who_wears_it_is_known_by_all_that_decides_how_he_stands(tmp_path: Path) -> None:
    """A layer kept of an interrupted dressing serves again for the same wearer alone."""
    outfit = load_outfit(written(tmp_path, ROBE), ASSETS)
    wearer = outfit.wearer
    assert wearer is not None
    others = [
        replace(wearer, vertices=wearer.vertices[:, [2, 1, 0]]),  # the same numbers on other axes
        replace(wearer, weights=np.roll(wearer.weights, 1, axis=1)),
        replace(wearer, heads=wearer.heads + [0.0, 0.01, 0.0]),
        replace(wearer, marks={**wearer.marks, "waist": wearer.marks["waist"] + [0.0, 0.01, 0.0]}),
        replace(wearer, skin="dual" if wearer.skin != "dual" else "linear arms"),
    ]
    told = [str(replace(outfit, wearer=who).to_dict()) for who in (wearer, replace(wearer), *others)]
    assert told[0] == told[1]
    assert len(set(told[1:])) == len(told[1:])
