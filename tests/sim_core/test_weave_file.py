"""Weave files: read, round trip, and every mistake with file, key and remedy."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

from sim_core.errors import FileProblem, SimCoreError, WeaveError
from sim_core.weave import Weave, Yarn

FOLDER = Path(__file__).parents[2] / "assets" / "weaves"
GAUZE = re.sub(
    r"\[published\].*?(?=\[draft\])", "", (FOLDER / "gauze.toml").read_text("utf-8"), flags=re.DOTALL
)


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_weaves_load_and_survive_a_dictionary(path):
    weave = Weave.load(path)
    assert weave.name == path.stem
    assert Weave.from_dict(weave.to_dict()) == weave
    assert tomllib.loads(path.read_text("utf-8"))["source"]


def test_satin_file_with_weft_face(tmp_path):
    text = (FOLDER / "satin.toml").read_text("utf-8").replace('face = "warp"', 'face = "weft"')
    path = tmp_path / "weft.toml"
    path.write_text(text, "utf-8")
    assert Weave.load(path).draft.face == "weft"


def test_written_out_draft(tmp_path):
    path = tmp_path / "lift.toml"
    path.write_text(GAUZE.replace('kind = "plain"', 'kind = "lift"\nlift = ["110", "011", "101"]'), "utf-8")
    assert Weave.load(path).draft.lift.tolist() == [[1, 1, 0], [0, 1, 1], [1, 0, 1]]


SATIN = (FOLDER / "satin.toml").read_text("utf-8")
MISTAKES = {
    "the warp is 95% of its spacing wide .* flatten one by 1.1 times more": SATIN.replace(
        "flattening = 2.9", "flattening = 1.1"
    ),
    "a leno holds its yarns apart": (FOLDER / "sha.toml")
    .read_text("utf-8")
    .replace("sheer = true", "sheer = false"),
    "the file is empty": "",
    "not valid TOML": "name = ",
    "draft: missing": GAUZE.split("[draft]")[0],
    "frction: unknown key": GAUZE.replace("friction", "frction", 1),
    "warp.tex: missing": GAUZE.replace("tex = 1.25e-6 ", "#", 1),
    "ends_per_m: 'many'": GAUZE.replace("6200.0", '"many"'),
    "ends_per_m is -5.0": GAUZE.replace("6200.0", "-5.0"),
    "warp.colour: 'red'": GAUZE.replace('"#e9dcc0"', '"red"'),
    "draft: .*kind": GAUZE.replace('kind = "plain"', 'kind = "knit"'),
    "satin 8: step 2": GAUZE.replace('kind = "plain"', 'kind = "satin"\nends = 8\nstep = 2'),
    "warp: yarn: diameter": GAUZE.replace("diameter = 45e-6", "diameter = 4.5e-6", 1),
    "flattening": GAUZE.replace("flattening = 1.25 ", "flattening = 0.5 ", 1),
    "published.source: missing": GAUZE.replace("[draft]", "[published]\nareal_density = 0.0154\n\n[draft]"),
    "published.openness": GAUZE.replace("[draft]", '[published]\nsource = "x"\nopenness = [0.5]\n\n[draft]'),
    r"draft\.damask\.motif: 'vines' is no motif – name a file that ends in .toml": GAUZE.replace(
        'kind = "plain"', 'kind = "damask"\nmotif = "vines"'
    ),
    r"published\.openness: -1.0 is no value of a source – write a number above 0, or \[least, most\]$": GAUZE.replace(
        "[draft]", '[published]\nsource = "x"\nopenness = -1.0\n\n[draft]'
    ),
    "ends_per_m: nan: .* – write an ordinary number": GAUZE.replace("6200.0", "nan"),
    "warp.colour: 'blue' is no colour – write six hexadecimal digits": GAUZE.replace('"#e9dcc0"', '"blue"'),
    "rows differ": GAUZE.replace('kind = "plain"', 'kind = "lift"\nlift = ["10", "010"]'),
}


@pytest.mark.parametrize("message", MISTAKES)
def test_mistakes_are_named_with_the_file(tmp_path, message):
    path = tmp_path / "bad.toml"
    path.write_text(MISTAKES[message], "utf-8")
    with pytest.raises(SimCoreError, match=message) as caught:
        Weave.load(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_missing_file_and_broken_dictionary():
    with pytest.raises(FileProblem, match="nowhere.toml"):
        Weave.load("nowhere.toml")
    values = Weave.load(FOLDER / "gauze.toml").to_dict()
    with pytest.raises(WeaveError, match="to_dict"):
        Weave.from_dict({key: value for key, value in values.items() if key != "draft"})


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"diameter": 0.0}, "diameter"),
        ({"tex": float("nan")}, "tex"),
        ({"stiffness": -1.0}, "stiffness"),
        ({"colour": (2, 0, 0)}, "colour"),
        ({"unevenness": 0.9}, "unevenness"),
        ({"tension": -1.0}, "tension"),
    ],
)
def test_impossible_yarns_are_named(values, message):
    with pytest.raises(WeaveError, match=message):
        Yarn(**{"diameter": 5e-5, "tex": 1e-6, **values})


def test_bending_bounds_enclose_the_derived_stiffness():
    yarn = Yarn(5e-5, 1.2e-6)
    assert yarn.stiffness_free < yarn.stiffness < yarn.stiffness_stuck


@pytest.mark.parametrize(
    ("option", "name"), [("--maps", "file"), ("--maps", "file/x"), ("--wif", "folder.wif")]
)
def test_places_that_cannot_be_written_are_named_before_the_work(option, name, tmp_path, capsys):
    from sim_core.cli import main

    (tmp_path / "file").touch()
    (tmp_path / "folder.wif").mkdir()
    assert main(["weave", "plain", option, str(tmp_path / name)]) == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    assert f"{tmp_path / name}: a f" in printed.err
    assert "Errno" not in printed.err


STRIPED = GAUZE.replace("[draft]", 'warp_colours = ["#102030", "#ffffff"]\n[draft]')


def test_stripes_colour_the_ends_and_leave_the_weave_as_it_is(tmp_path):
    path = tmp_path / "striped.toml"
    path.write_text(
        STRIPED.replace('"plain"', '"twill"\nup = 2\ndown = 1\nwarp_stripes = [[4, 0], [1, 1]]'), "utf-8"
    )
    weave = Weave.load(path)
    assert weave.draft.lift.shape == (3, 15)  # where a repeat of 3 and stripes of 5 close together
    series = weave.draft.channels.end_series
    assert series.tolist() == [0, 0, 0, 0, 1] * 3
    assert np.array_equal(weave.draft.lift[:, :3], weave.draft.lift[:, 3:6])
    assert Weave.from_dict(weave.to_dict()) == weave


@pytest.mark.parametrize(
    ("stripes", "words"),
    [
        ("[[4, 2]]", r"draft.warp_stripes: a colour that is not there – warp_colours has 2"),
        ("[[0, 1]]", r"draft.warp_stripes: a stripe of no yarns"),
        ("[[4]]", r"warp_stripes.0"),
        (
            "[[997, 0], [1021, 1], [1013, 0], [1009, 1], [1019, 0], [1024, 1]] ",
            r"crossings – give at most|yarns – give",
        ),
    ],
)
def test_stripes_that_cannot_be_woven_are_named(tmp_path, stripes, words):
    path = tmp_path / "striped.toml"
    path.write_text(
        STRIPED.replace('"plain"', f'"satin"\nends = 17\nstep = 5\nwarp_stripes = {stripes}'), "utf-8"
    )
    with pytest.raises(WeaveError, match=f"striped.toml: .*{words}"):
        Weave.load(path)
