"""`simcore dress`: files, summary and one-line errors."""

import json
from pathlib import Path

import pytest

from sim_core.cli import main
from sim_core.garment import Garment

ASSETS = Path(__file__).parents[2] / "assets"
PATTERN = 'name = "short"\nedge = 0.05\nsize = [0.4, 2.4]\ndye = "#c4624f"\n'
OUTFIT = """\
[stand]
height = 1.5
[[layer]]
pattern = "PATTERN"
weave = "weaves/gauze.toml"
[[layer.step]]
do = "settle"
seconds = 0.08
damping = 400.0
"""


@pytest.fixture
def outfit(tmp_path: Path) -> Path:
    (tmp_path / "short.toml").write_text(PATTERN, "utf-8")
    path = tmp_path / "it.toml"
    path.write_text(OUTFIT.replace("PATTERN", str(tmp_path / "short.toml")), "utf-8")
    return path


def test_bad_words_are_told_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    empty = tmp_path / "empty.toml"
    empty.touch()
    assert main(["dress", str(empty), "--out", str(tmp_path / "out.npz")]) == 1
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    assert "empty.toml" in lines[0]
    assert not (tmp_path / "out.npz").exists()


def test_a_folder_is_no_target(outfit: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "dir.npz"
    folder.mkdir()
    words = ["dress", str(outfit), "--content", str(ASSETS), "--out", str(folder)]
    assert main(words) == 2
    assert f"--out: {folder} is a folder" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["dir.npz", "it.toml", "short.toml"]


def test_dress_writes_what_is_asked_for(
    outfit: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "new"
    names = {"--out": "it.npz", "--glb": "it.glb", "--picture": "it.png"}
    words = ["dress", str(outfit), "--content", str(ASSETS), "--json"]
    for option, name in names.items():
        words += [option, str(out / name)]
    assert main(words) == 0
    (layer,) = json.loads(capsys.readouterr().out)["layers"]
    assert layer["errors"]["inside_vertices"] == 0
    assert layer["file"] == str(out / "it.npz")
    assert Garment.load(out / "it.npz").digest() == layer["digest"]
    for name in names.values():
        assert (out / name).stat().st_size > 5000
    assert sorted(path.name for path in out.iterdir()) == sorted(names.values())  # nothing is left behind


def test_without_files_it_tells_what_came_of_it(outfit: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["dress", str(outfit), "--content", str(ASSETS), "--edge", "0.08"]) == 0
    said = capsys.readouterr()
    assert "short:" in said.out
    assert "inside what lies beneath 0" in said.out
    assert "100.0 %" in said.err
