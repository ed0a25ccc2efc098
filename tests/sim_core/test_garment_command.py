"""`simcore garment`: files, summary and one-line errors."""

import json
from pathlib import Path

import pytest

from sim_core.cli import main

PATTERN = 'name = "short"\nedge = 0.05\nsize = [0.4, 2.4]\ndye = "#c4624f"\n'
WEAVE = Path(__file__).parents[2] / "assets" / "weaves" / "gauze.toml"


def test_bad_words_are_told_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    empty = tmp_path / "empty.toml"
    empty.touch()
    assert main(["garment", str(empty), "--weave", str(WEAVE), "--out", str(tmp_path / "out")]) == 1
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    assert "empty.toml" in lines[0]
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_garment_command_writes_all_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from sim_core.garment.recipes import scarf

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
