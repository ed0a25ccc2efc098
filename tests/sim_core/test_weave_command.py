"""`simcore weave --relax` where a large repeat is too much for the particles."""

import json

import numpy as np
import pytest
from PIL import Image

from sim_core.cli import main


@pytest.fixture
def motif(tmp_path):
    y, x = np.mgrid[:24, :24]
    path = tmp_path / "motif.png"
    Image.fromarray(np.where((x - 12) ** 2 + (y - 12) ** 2 < 50, 0, 255).astype(np.uint8)).save(path)
    return str(path)


@pytest.mark.parametrize(
    ("limit", "reason"), [("MOST_PARTICLES", "more than 100"), ("MOST_WORK", "do not come to rest")]
)
def test_a_large_figure_falls_back_to_the_crossings_and_says_so(motif, limit, reason, monkeypatch, capsys):
    monkeypatch.setattr(f"sim_core.weave.cli.{limit}", 100 if limit == "MOST_PARTICLES" else 200_000)
    assert main(["weave", motif, "--relax", "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["note"].startswith("stage A")
    assert reason in summary["note"]
    assert summary["penetration"] <= 5e-4


def test_a_small_weave_is_relaxed_whole_and_has_no_note(capsys):
    assert main(["weave", "satin:8/3", "--relax", "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert "note" not in summary
    assert summary["penetration_of"].startswith("curves")
