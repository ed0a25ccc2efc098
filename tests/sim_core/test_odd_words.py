"""Odd arguments of `simcore`: refused with exit status 2 before any work, or told in one line; never a traceback."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sim_core import cli

REPO = Path(__file__).parents[2]
WEAVE = str(REPO / "assets" / "weaves" / "gauze.toml")
OUTFIT = str(REPO / "assets" / "outfits" / "robe.toml")
PATTERN = str(REPO / "assets" / "patterns" / "robe.toml")

WRONG = {
    "weave": [
        *(["--size", word] for word in ("-3", "0", "31", "4097", "1e3", "9" * 5000)),
        ["--yarns", "yarns.obj"],
        ["--wif", "draft.txt"],
    ],
    "mesh": [
        *(["--edge", word] for word in ("0", "-1", "nan", "inf", "1e-300", "1e300", "x")),
        *(["--edge", "0.1", "--threshold", word] for word in ("nan", "0.4", "1")),
        *(["--edge", "0.1", "--picture", word] for word in ("p.xyz", "p", ".png")),
        *(["--edge", "0.1", "--out", word] for word in ("mesh.stl", "mesh")),
    ],
    "cloth": [
        *(["--frames", word] for word in ("0", "-1", "nan", "1e9", "x")),
        *(["--vertices", word] for word in ("0", "11", "nan", "400001")),
        *(["--size", word] for word in ("0", "nan", "1,2,3", "11,1", "0.01", "a,b")),
        *(["--wind", word] for word in ("4", "1,2", "nan,0,0", "101,0,0", "1,2,3")),
        *(["--pins", word] for word in ("all", "")),
        *(["--case", word] for word in ("0", "19", "x")),
        *(["--substeps", word] for word in ("0", "1.5")),
        *(["--error", word] for word in ("0", "-1", "nan", "inf")),
        *(["--integrator", word] for word in ("euler",)),
        *(["--out", word] for word in ("frames.npy", "frames", "none/frames.npz")),
        *(["--video", word] for word in ("film.gif", "none/film.mp4")),
        *(["--seed", word] for word in ("-1", "0.5")),
    ],
    "dress": [
        *(["--edge", word] for word in ("0", "-1", "nan", "1e-9", "5")),
        *(["--out", word] for word in ("robe", "robe.glb")),
        *(["--glb", word] for word in ("robe", "robe.npz")),
        *(["--picture", word] for word in ("robe", "robe.jpg")),
    ],
    "figure": [
        *(["--picture", word] for word in ("figure.jpeg", "figure")),
        ["figure.obj", "--json"],
        ["--picture", "figure.png", "--pose", "asleep"],
        ["--pose", "held"],
    ],
}
CASES = [(room, words) for room, cases in WRONG.items() for words in cases]


@pytest.mark.parametrize(("room", "words"), CASES, ids=[f"{r} {' '.join(w)[:40]}" for r, w in CASES])
def test_wrong_arguments_end_with_2_and_leave_nothing(
    room: str, words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    monkeypatch.chdir(tmp_path)
    first = {
        "weave": [WEAVE],
        "mesh": ["none.json"],
        "cloth": ["hanging"],
        "dress": [OUTFIT],
        "figure": ["woman"],
    }[room]
    try:
        status = cli.main([room, *first, *words])
    except SystemExit as caught:
        status = caught.code
    assert status == 2
    last = capsys.readouterr().err.strip().splitlines()[-1]
    assert last.startswith(f"simcore {room}: ")
    assert words[-2].lstrip("-") in last or "--mannequin" in last or words[-1] in last
    assert len(last) < 300
    assert list(tmp_path.iterdir()) == []


def test_a_scene_is_as_fine_as_its_sheet_bears(tmp_path: Path, capsys) -> None:
    out = str(tmp_path / "out.npz")
    assert cli.main(["cloth", "hanging", "--size", "10,0.1", "--vertices", "12", "--out", out]) == 2
    assert "too few for a sheet of 10.0 x 0.1 m" in capsys.readouterr().err
    assert not (tmp_path / "out.npz").exists()


def test_debug_stands_before_or_behind_the_command(tmp_path: Path, capsys) -> None:
    words = ["mesh", str(tmp_path / "none.json"), "--edge", "0.1"]
    for debug in (["--debug", *words], [*words, "--debug"], ["--debug", *words, "--debug"]):
        with pytest.raises(ValueError, match=r"none\.json"):
            cli.main(debug)
    assert cli.main(words) == 1
    assert capsys.readouterr().err.count("\n") == 1


def test_bench_keeps_debug_to_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    ran: list[list[str]] = []

    def heard(words: list[str], **_: object) -> subprocess.CompletedProcess:
        ran.append(words[2:])
        return subprocess.CompletedProcess(words, 0)

    monkeypatch.setattr(subprocess, "run", heard)
    # The package may be an installed one, without the benches of a checkout.
    monkeypatch.setattr(cli, "__file__", str(Path(__file__).parents[2] / "sim_core" / "cli.py"))
    for words in (["bench", "--debug", "mesh"], ["bench", "mesh", "--debug"], ["--debug", "bench", "mesh"]):
        assert cli.main([*words, "--", "--quick"]) == 0
    assert ran == [["--quick"]] * 3


def test_what_nobody_foresaw_is_one_line_too(monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    from sim_core.weave import Weave

    def broken(path: Path) -> Weave:
        raise ZeroDivisionError("division\nby zero")

    monkeypatch.setattr(Weave, "load", broken)
    assert cli.main(["weave", WEAVE]) == 1
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "unexpected ZeroDivisionError: division by zero" in told
    assert "--debug" in told
    with pytest.raises(ZeroDivisionError):
        cli.main(["weave", WEAVE, "--debug"])


def simcore(*words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    import os

    return subprocess.run(
        [sys.executable, "-m", "sim_core.cli", *words],
        capture_output=True,
        text=True,
        cwd=REPO,
        env={**os.environ, **environment},
        check=False,
    )


def test_a_terminal_without_the_letters_gets_escapes(tmp_path: Path) -> None:
    path = tmp_path / "sha.toml"
    text = Path(WEAVE).read_text("utf-8").replace('name = "gauze"', 'name = "纱"')
    path.write_text(text, "utf-8")
    done = simcore("weave", str(path), PYTHONIOENCODING="ascii")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("\\u7eb1: ")
    assert done.stderr == ""


def test_a_reader_who_has_seen_enough_is_no_error(tmp_path: Path) -> None:
    words = [sys.executable, "-m", "sim_core.cli", "weave", WEAVE]
    with subprocess.Popen(words, cwd=REPO, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as started:
        assert started.stdout is not None
        assert started.stderr is not None
        started.stdout.close()
        assert started.stderr.read() == b""


def test_places_that_cannot_be_written_are_told_before_the_work(tmp_path: Path, capsys) -> None:
    taken = tmp_path / "taken"
    taken.write_text("here", "utf-8")
    outline = tmp_path / "panel.json"
    outline.write_text(json.dumps({"outline": [[0, 0], [1, 0], [1, 1]]}), "utf-8")
    assert cli.main(["weave", WEAVE, "--maps", str(taken)]) == 1
    assert cli.main(["cloth", "hanging", "--out", str(taken / "frames.npz")]) == 2
    assert cli.main(["dress", OUTFIT, "--out", str(taken / "robe.npz")]) == 1
    assert cli.main(["mesh", str(outline), "--edge", "0.2", "--out", str(taken / "mesh.obj")]) == 1
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 4, lines
    assert all("taken" in line for line in lines)


def outfit_of(folder: Path, figure: Path) -> Path:
    """A robe on the figure of a file."""
    text = f'wearer = "{figure}"\n[[layer]]\npattern = "{PATTERN}"\nweave = "{WEAVE}"\n'
    path = folder / "outfit.toml"
    path.write_text(text, "utf-8")
    return path


def test_a_figure_that_is_none_is_told_with_its_file(tmp_path: Path, capsys) -> None:
    path = tmp_path / "figure.npz"
    np.savez(path, vertices=np.zeros((3, 3)))
    assert cli.main(["dress", str(outfit_of(tmp_path, path)), "--out", str(tmp_path / "out/robe.npz")]) == 1
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "figure.npz: not a mannequin" in told
    assert not list(tmp_path.glob("out/*"))


@pytest.mark.parametrize(
    ("name", "change", "word"),
    [
        ("faces", lambda a: a[1:], "open or ill-wound at 3 edges"),
        ("weights", lambda a: np.eye(21)[np.zeros(len(a), int)], "no hull"),
    ],
)
def test_a_figure_no_field_fits_is_told_before_the_drape(
    tmp_path: Path, capsys, name: str, change, word: str
) -> None:
    with np.load(REPO / "assets" / "mannequins" / "woman.npz") as data:
        arrays = dict(data)
    path = tmp_path / "figure.npz"
    np.savez(path, **{**arrays, name: change(arrays[name])})
    assert cli.main(["dress", str(outfit_of(tmp_path, path)), "--out", str(tmp_path / "out/robe.npz")]) == 1
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "figure.npz: field: " in told
    assert word in told
    assert not list(tmp_path.glob("out/*"))
