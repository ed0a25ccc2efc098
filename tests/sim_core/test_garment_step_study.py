"""`simcore dress --study`: an outfit at several mesh steps, how far they lie apart, resumed where it was stopped."""

import json
from pathlib import Path

import pytest

from sim_core.cli import main
from sim_core.garment import dress

ASSETS = Path(__file__).parents[2] / "assets"
CLOTH = """\
[stand]
height = 1.5
[[layer]]
pattern = "piece.toml"
weave = "WEAVE"
[layer.place]
way = "folded"
front = 0.5
[[layer.step]]
do = "settle"
seconds = 0.12
damping = 10.0
[[layer.step]]
do = "rest"
seconds = 0.4
damping = 10.0
still = 1e-4
"""


@pytest.fixture
def outfit(tmp_path: Path) -> Path:
    (tmp_path / "outfits").mkdir()
    (tmp_path / "piece.toml").write_text('name = "cloth"\nedge = 0.05\nsize = [0.3, 0.9]\n', "utf-8")
    (tmp_path / "weave.toml").write_bytes((ASSETS / "weaves/juan.toml").read_bytes())
    path = tmp_path / "outfits/cloth.toml"
    path.write_text(CLOTH.replace("WEAVE", "weave.toml"), "utf-8")
    return path


def test_a_study_says_how_far_steps_lie_apart_and_goes_on(
    outfit: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "cloth.steps.json"
    words = ["dress", str(outfit), "--study", str(file), "--steps", "0.05,0.1", "--json"]
    edges: list[float] = []

    def counted(outfit, **options):
        if len(edges) == 2 and not stopped:
            stopped.append(True)
            raise KeyboardInterrupt
        edges.append(outfit.layers[0].edge)
        return dress(outfit, **options)

    stopped: list[bool] = []
    monkeypatch.setattr("sim_core.garment.step_study.dress", counted)
    assert main(words) != 0
    assert not file.exists()
    assert main(words) == 0
    assert edges == pytest.approx([0.102, 0.1, 0.05])  # what was dressed is not dressed again
    told = json.loads(capsys.readouterr().out)
    assert told == json.loads(file.read_text("utf-8"))
    (layer,) = told["layers"]
    assert layer["edges"] == [0.1, 0.05]
    assert layer["triangles"][1] > 2 * layer["triangles"][0]
    assert len(layer["apart"]) == 1
    assert 0 < layer["apart"][0]["mean_m"] <= layer["apart"][0]["p99_m"] < 0.9
    assert 0 < layer["scatter"]["p99_m"] < 0.9
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "cloth.steps.json",
        "outfits",
        "piece.toml",
        "weave.toml",
    ]


def test_a_study_wants_two_steps(outfit: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["dress", str(outfit), "--study", "x.json", "--steps", "0.05"])
    assert stopped.value.code == 2
    assert "two steps or more are compared" in capsys.readouterr().err
    assert main(["dress", str(outfit), "--study", "x.npz"]) == 2
    assert "name a file that ends in .json" in capsys.readouterr().err
