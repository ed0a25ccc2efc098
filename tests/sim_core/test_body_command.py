"""`simcore figure`: names, draws, and says in one line what it lacks."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sim_core import cli
from sim_core.body import JOINTS, POSES
from sim_core.body.making import FIGURES

WOMAN = Path(__file__).parents[2] / "assets" / "mannequins" / "woman.npz"


def test_it_names_figures_and_poses(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["figure", "--list"]) == 0
    told = capsys.readouterr().out
    assert all(f"  {name} " in told for name in (*FIGURES, *POSES))
    assert cli.main(["figure", "--list", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["figures"]["man-167"]["stature_m"] == 1.67
    assert set(facts["poses"]["step"]["joints"]) <= set(JOINTS)


def test_it_draws_a_figure_in_a_pose(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shades = {}
    for pose in ("t", "held"):
        path = tmp_path / f"{pose}.png"
        words = ["figure", str(WOMAN), "--pose", pose, "--picture", str(path), "--json"]
        assert cli.main(words) == 0
        facts = json.loads(capsys.readouterr().out)
        assert facts["figure"] == "woman"
        assert facts["pose"] == pose
        shades[pose] = np.asarray(Image.open(path).convert("L"), float)
    assert shades["t"].shape == (700, 1120)
    assert (np.abs(shades["t"] - shades["held"]) > 20).mean() > 0.02  # arms are elsewhere


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "NAME: missing"),
        (["woman"], "nothing to do"),
        (["woman", "--picture", "p.png"], "OUT.npz is missing"),
        (["nobody", "out.npz"], "no figure of that name"),
    ],
)
def test_what_cannot_be_meant_ends_with_2(
    words: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["figure", *words]) == 2
    assert told in capsys.readouterr().err


def test_without_anny_it_says_where_figures_are_made(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "anny", None)
    assert cli.main(["figure", "woman", str(tmp_path / "out.npz")]) == 1
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "where figures are made" in told
    assert not list(tmp_path.iterdir())


WALK = WOMAN.parents[1] / "motions" / "walk.toml"


def test_it_names_the_motions_that_ship(capsys: pytest.CaptureFixture[str]) -> None:
    content = ["--content", str(WALK.parents[1])]
    assert cli.main(["motion", "--list", *content]) == 0
    told = capsys.readouterr().out
    assert all(f"{name}.toml" in told for name in ("walk", "turn", "salute", "raised-sleeve"))
    assert cli.main(["motion", "--list", "--json", *content]) == 0
    assert json.loads(capsys.readouterr().out)["walk.toml"]["loop"] is True


def test_it_draws_measures_and_writes_a_motion(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, picture = tmp_path / "walk.npz", tmp_path / "walk.png"
    words = ["motion", str(WALK), "--figure", str(WOMAN), "--out", str(out), "--picture", str(picture)]
    assert cli.main([*words, "--measure", "--rate", "50", "--in-place", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["period_s"] == 1.12
    assert max(facts["slide_mm"].values()) < 5.0
    assert facts["floor_mm"] < 5.0
    assert min(facts["clearance_mm"].values()) > 0.0
    assert facts["seam"]["place_mm"] < 1e-3
    with Image.open(picture) as drawn:
        assert drawn.size[0] > 1000
    with np.load(out) as data:
        assert set(data.files) == {"time", "joints", "joint_names", "turns", "shift"}
        assert data["joints"].shape == (113, len(JOINTS), 3) == (len(data["time"]), *data["joints"].shape[1:])
        assert tuple(data["joint_names"]) == JOINTS
        assert data["time"][-1] == pytest.approx(2.24)
        assert data["joints"][-1] == pytest.approx(data["joints"][0], abs=1e-6)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "MOTION.toml: missing"),
        (["walk.npz", "--measure"], "a motion file ends in .toml"),
        (["walk.toml"], "nothing to do – add --measure"),
    ],
)
def test_what_cannot_be_meant_of_a_motion_ends_with_2(
    words: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["motion", *words]) == 2
    assert told in capsys.readouterr().err


def test_what_a_figure_cannot_do_is_told_with_the_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "bow.toml"
    curve = '[[curve]]\njoint = "spine_1"\naxis = "x"\nat = [0, 50]\ndegrees = [0, 170]\nsource = "made up"\n'
    file.write_text(f"period = 1.0\n{curve}", "utf-8")
    assert cli.main(["motion", str(file), "--figure", str(WOMAN), "--measure"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"simcore motion: {file}: motion bow at ")
    assert "spine_1 turned" in line
