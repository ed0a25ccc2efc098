"""From nothing to fine cloth by commands alone: data, training, table, film, picture, and what an exhibit shows."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim_core.cli import main
from sim_core.learn.data import DESIGNS

SEQUENCES, FRAMES, UPDATES = 10, 60, 3000
PRESET = replace(DESIGNS["flag"], coarse=90, fine=340)  # small enough to learn in two minutes


@pytest.mark.nightly
def test_the_commands_lead_from_nothing_to_fine_cloth(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Flags of 340 vertices: what was learned from seven is nearer, on three held back, than the base it mends."""
    pytest.importorskip("torch")
    monkeypatch.setitem(DESIGNS, "flag", PRESET)

    def said(*words: str) -> dict:
        assert main(["learn", *words, "--json"]) == 0
        return json.loads(capsys.readouterr().out)

    folder, weights = str(tmp_path / "data"), str(tmp_path / "flag.safetensors")
    made = said(
        "data",
        "flag",
        "--sequences",
        str(SEQUENCES),
        "--frames",
        str(FRAMES),
        "--floor",
        "0",
        "--out",
        folder,
    )
    assert made["frames"] == SEQUENCES * FRAMES
    trained = said("train", "flag", "--data", folder, "--out", weights, "--updates", str(UPDATES))
    assert trained["device"]
    table = said(
        "evaluate", "flag", "--data", folder, "--weights", weights,
        "--rows", "linear,biharmonic,local_frames,ours",
    )  # fmt: skip
    assert not set(table["tested"]) & set(trained["learned_from"])
    rows = table["rows"]
    # A test of the way. The base of sheets as coarse as these is worse than the coarse surface, and so is what mends it
    # (6.1 of 6.6, 5.7 mm); what is gained on sheets of the published size is told by bench_learn.py.
    assert rows["ours"]["mean_mm"] < 0.95 * rows["biharmonic"]["mean_mm"]
    assert rows["ours"]["mean_mm"] < rows["local_frames"]["mean_mm"]
    film = str(tmp_path / "film.npz")
    said("infer", "flag", "--weights", weights, "--case", "3", "--frames", "5", "--out", film)
    with np.load(film) as found:
        assert np.isfinite(found["fine"]).all()
    picture = tmp_path / "drawn.png"
    drawn = said("draw", "--data", folder, "--weights", weights, "--out", str(picture))
    assert [row["sequence"] for row in drawn["rows"]] == table["tested"][:1]
    shown = said(
        "show",
        "flag",
        "--data",
        folder,
        "--weights",
        weights,
        "--frames",
        "25",
        "--out",
        str(tmp_path / "shown"),
    )
    assert {path.name for path in (tmp_path / "shown").iterdir()} == {
        "comparison.glb", "comparison.clip", "comparison.toml",
    }  # fmt: skip
    assert shown["sides"][1]["milliseconds"] < shown["sides"][2]["milliseconds"]
