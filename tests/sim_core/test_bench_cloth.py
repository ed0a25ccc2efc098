"""The cloth bench's own figures: the README holds what was measured, and small runs have the figures' shape."""

import json
import sys
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from sim_core.cloth.scenes import hang_edge, scene

NAMES = ("cloth_cases", "cloth_curves", "cloth_measures", "cloth_runs", "readme_cloth")
ROOT = Path(__file__).parents[2]


@pytest.fixture
def bench(monkeypatch):
    """The modules of the bench, which import each other by their bare names."""
    monkeypatch.syspath_prepend(str(ROOT / "tests" / "bench"))
    yield {name: import_module(name) for name in NAMES}
    for name in NAMES:
        sys.modules.pop(name, None)


def test_the_readme_holds_what_was_measured(bench) -> None:
    readme = bench["readme_cloth"]
    found = json.loads((ROOT / "docs/figures/cloth.json").read_text("utf-8"))
    assert not found["quick"]
    text = (ROOT / "sim_core/cloth/README.md").read_text("utf-8")
    assert readme.tables(found) in text.split(readme.BEGIN)[1].split(readme.END)[0]


def test_more_substeps_err_less_and_are_told(bench) -> None:
    measures = bench["cloth_measures"]
    settings = [measures.Setting(), *(measures.Setting("explicit", n) for n in (60, 120))]
    heard: list[str] = []
    made = hang_edge(0.08)
    how = {"rounds": 1, "finest": 480, "undamped": True, "tell": heard.append}
    rows = measures.timed(made, 0.12, settings, **how)["rows"]
    errors = [row["error_mm"]["mean"] for row in rows[1:]]
    assert errors[0] > 2 * errors[1] > 0
    assert all(row["quartiles_ms"][0] <= row["ms"] <= row["quartiles_ms"][1] for row in rows)
    assert len(heard) == 4
    assert set(bench["cloth_curves"].curves_of({"rows": rows})) == {"explicit"}


def test_order_is_that_of_the_steps_from_mesh_to_mesh(bench) -> None:
    found = bench["cloth_measures"].meshes(hang_edge, (1.0, 1.0), 0.12, [0.16, 0.08, 0.04], lambda _: None)
    first, second = found["steps_mm"]
    assert found["order"] == pytest.approx([np.log2(first / second)])
    assert found["rows"][-1]["from_finest_mm"]["max"] == 0.0


def test_layers_keep_the_teapots_cloth_apart() -> None:
    before, after = (scene("teapot", vertices=300, layers=gap).contact for gap in (0.0, 0.003))
    assert before is not None
    assert after == replace(before, thickness=0.003)
    assert before.thickness == 0.0
