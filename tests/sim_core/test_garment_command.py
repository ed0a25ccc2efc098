"""`simcore dress`: files, summary and one-line errors."""

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from sim_core.cli import main
from sim_core.cloth import Drape
from sim_core.garment import Garment
from sim_core.mesh import sewn_meshes
from sim_core.weave import solve

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


@contextmanager
def frames_counted(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[int]]:
    """How many frames each run of the engine simulates itself, rather than finding them done."""
    module, counted = sys.modules["sim_core.garment.dressing.runs"], []
    drape = module.drape  # type: ignore[attr-defined]

    def heard(*given, **more) -> Drape:
        result = drape(*given, **more)
        counted.append(len(result.frame_seconds))
        return result

    with monkeypatch.context() as patch:
        patch.setattr(module, "drape", heard)
        yield counted


def test_bad_words_are_told_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    empty = tmp_path / "empty.toml"
    empty.touch()
    assert main(["dress", str(empty), "--out", str(tmp_path / "out.npz")]) == 1
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    assert "empty.toml" in lines[0]
    assert not (tmp_path / "out.npz").exists()


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


ROBE = """\
[[layer]]
name = "NAME"
pattern = "patterns/robe.toml"
weave = "weaves/juan.toml"
weaves = { band = "weaves/gauze.toml" }
edge = 0.05
[[layer.step]]
do = "sew"
seconds = 0.2
[[layer.step]]
do = "weld"
[[layer.step]]
do = "settle"
seconds = 0.12
"""


def calls_counted(monkeypatch: pytest.MonkeyPatch, function) -> list[str]:
    """What a function is called with first, wherever it is known by its name."""
    heard: list[str] = []

    def counted(*given, **more):
        heard.append(str(getattr(given[0], "name", "")))
        return function(*given, **more)

    for module in [m for name, m in sys.modules.items() if name.startswith("sim_core.")]:
        if getattr(module, function.__name__, None) is function:
            monkeypatch.setattr(module, function.__name__, counted)
    return heard


@pytest.mark.slow
def test_each_weave_is_solved_and_each_layer_meshed_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """For dressing, model and picture together; of two layers that are cut from the same weaves, too."""
    path = tmp_path / "two.toml"
    layers = ROBE.replace("NAME", "inner") + ROBE.replace("NAME", "outer").replace("gauze", "satin")
    path.write_text('wearer = "mannequins/woman.npz"\npose = "t"\n' + layers, "utf-8")
    woven, meshed = calls_counted(monkeypatch, solve), calls_counted(monkeypatch, sewn_meshes)
    words = ["dress", str(path), "--content", str(ASSETS), "--json"]
    assert main([*words, "--glb", str(tmp_path / "it.glb"), "--picture", str(tmp_path / "it.png")]) == 0
    names = [layer["name"] for layer in json.loads(capsys.readouterr().out)["layers"]]
    assert names == ["inner", "outer"]
    assert sorted(woven) == ["gauze", "juan", "satin"]
    assert len(meshed) == 2, "either layer's panels, all at once"


def test_what_cannot_be_written_is_told_before_anything_is_dressed(
    outfit: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sim_core.garment.dress", lambda *_, **__: pytest.fail("it was dressed"))
    text = outfit.read_text("utf-8")
    beneath = tmp_path / "beneath"
    beneath.mkdir()
    for name in ("out.npz", "out.glb", "out.png", "o-inner.npz", "file"):
        (beneath / name).mkdir() if name != "file" else (beneath / name).touch()

    def told(layers: str, option: str, name: str) -> str:
        outfit.write_text(layers, "utf-8")
        assert main(["dress", str(outfit), "--content", str(ASSETS), option, str(beneath / name)]) == 1
        (line,) = capsys.readouterr().err.strip().splitlines()
        return line

    for option, name in (("--out", "out.npz"), ("--glb", "out.glb"), ("--picture", "out.png")):
        assert f"{name}: this is a folder – name a file" in told(text, option, name)
    assert "file/o.npz: cannot be written (" in told(text, "--out", "file/o.npz")
    layer = (
        '[[layer]]\nname = "NAME"\npattern = "patterns/robe.toml"\nweave = "weaves/juan.toml"\nedge = 0.08\n'
    )
    worn = 'wearer = "mannequins/woman.npz"\n'
    two = worn + layer.replace("NAME", "inner") + layer.replace("NAME", "outer")
    assert "o-inner.npz: this is a folder" in told(two, "--out", "o.npz")
    for name in ("in/ner", "..", "a\\\\b", " ", "in:ner"):
        assert "letters, digits, _, - and inner spaces" in told(
            worn + layer.replace("NAME", name), "--out", "o.npz"
        )
    assert not [path for path in beneath.iterdir() if path.name.endswith(".part")]


def test_what_was_dressed_is_kept_until_all_is_written(
    outfit: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The picture fails: the same command then writes everything and simulates no frame again."""
    out = tmp_path / "new"
    words = ["dress", str(outfit), "--content", str(ASSETS), "--json"]
    words += ["--out", str(out / "a[1].npz"), "--picture", str(out / "it.png")]
    with monkeypatch.context() as patch:
        patch.setattr("sim_core.picture.save_png", lambda *_: (_ for _ in ()).throw(OSError("disk full")))
        assert main(words) == 1
    kept = [path.name for path in out.iterdir() if path.name.startswith("a[1].part.layer0")]
    assert kept
    (out / "a1.part.layer0.npz").touch()  # of another dressing, though a glob takes it for one of this
    (out / "a[1].part.layers.txt").touch()
    with frames_counted(monkeypatch) as counted:
        assert main(words) == 0
    assert counted == [0]
    assert sorted(path.name for path in out.iterdir()) == [
        "a1.part.layer0.npz",
        "a[1].npz",
        "a[1].part.layers.txt",
        "it.png",
    ]


def test_an_interrupt_after_the_last_run_loses_no_run(
    outfit: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["dress", str(outfit), "--content", str(ASSETS), "--out", str(tmp_path / "new" / "it.npz")]
    with monkeypatch.context() as patch:
        patch.setattr(
            sys.modules["sim_core.garment.dressing.dress"],
            "measured",
            lambda *_: (_ for _ in ()).throw(KeyboardInterrupt),
        )
        assert main(words) == 1
    assert capsys.readouterr().err.strip().endswith("simcore dress: interrupted")
    with frames_counted(monkeypatch) as counted:
        assert main(words) == 0
    assert counted == [0]


def test_without_files_it_tells_what_came_of_it(outfit: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["dress", str(outfit), "--content", str(ASSETS), "--edge", "0.08"]) == 0
    said = capsys.readouterr()
    assert "short:" in said.out
    assert "inside what lies beneath 0" in said.out
    assert "100.0 %" in said.err
