"""`simcore cloth` and `simcore garment`: files, summaries and one-line errors."""

import json
from pathlib import Path

import numpy as np
import pytest

from sim_core.cli import main

PATTERN = 'name = "short"\nedge = 0.05\nsize = [0.4, 2.4]\ndye = "#c4624f"\n'
WEAVE = Path(__file__).parents[2] / "assets" / "weaves" / "gauze.toml"


def test_cloth_scene_writes_positions_and_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = [
        "cloth",
        "hang",
        "--edge",
        "0.2",
        "--seconds",
        "0.08",
        "--out",
        str(tmp_path),
        "--picture",
        "--json",
    ]
    assert main(words) == 0
    summary = json.loads(capsys.readouterr().out)[0]
    with np.load(summary["file"]) as data:
        assert data["positions"].shape == (summary["vertices"], 3)
        assert data["positions"][:, 1].min() < -0.01
    assert (tmp_path / "hang.png").stat().st_size > 1000


def test_bad_words_are_told_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["cloth", "bar", "--edge", "0.2", "--out", str(tmp_path)]) == 2
    empty = tmp_path / "empty.toml"
    empty.touch()
    assert main(["garment", str(empty), "--weave", str(WEAVE), "--out", str(tmp_path / "out")]) == 1
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 2
    assert "edge 0.2 m" in lines[0]
    assert "empty.toml" in lines[1]
    assert not (tmp_path / "out").exists()
    with pytest.raises(SystemExit) as caught:
        main(["cloth", "teapot"])
    assert caught.value.code == 2


@pytest.mark.slow
def test_garment_command_writes_all_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from sim_core.garment import scarf

    monkeypatch.setattr(scarf.scarf_on_stand, "__kwdefaults__", _short(scarf.scarf_on_stand.__kwdefaults__))
    pattern = tmp_path / "short.toml"
    pattern.write_text(PATTERN, "utf-8")
    words = [
        "garment",
        str(pattern),
        "--weave",
        str(WEAVE),
        "--out",
        str(tmp_path),
        "--pixels",
        "64",
        "--json",
    ]
    assert main([*words, "--budget", "0.02", "--picture"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["errors"]["inside_vertices"] == 0
    assert summary["bytes"]["hall.glb"] < 1_500_000
    assert summary["bytes"]["close.glb"] < 15_000_000
    for name in ("garment.npz", "close.glb", "hall.glb", "garment.png"):
        assert (tmp_path / name).stat().st_size > 5000
    assert not (tmp_path / "drape.checkpoint").exists()


def _short(defaults: dict | None) -> dict:
    assert defaults is not None
    return {**defaults, "phases": defaults["phases"][:1]}
