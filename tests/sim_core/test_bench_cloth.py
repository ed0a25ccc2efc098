"""The cloth bench's own figures: the README holds what was measured, and small runs have the figures' shape."""

import re
import sys
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from sim_core import cloth
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
    found = readme.figures()
    assert not found["quick"]
    text = (ROOT / "sim_core/cloth/DETAILS.md").read_text("utf-8")
    assert readme.tables(found) in text.split(readme.BEGIN)[1].split(readme.END)[0]
    text, (begin, end) = (ROOT / "sim_core/cloth/README.md").read_text("utf-8"), readme.HEAD
    assert readme.headline(found) in text.split(begin)[1].split(end)[0]


def test_the_readme_holds_the_peers_figures(bench, monkeypatch) -> None:
    peers = import_module("cloth_peer_tables")
    for name in ("cloth_peer_tables", "cloth_figures", "cloth_sweeps", "mapping"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    results = peers.measured()
    text, (begin, end) = (peers.ROOM / "README.md").read_text("utf-8"), peers.SHORT
    told = text.split(begin)[1].split(end)[0]
    assert peers.short(results) in told
    assert peers.tables(peers.measured(published=True)) in peers.README.read_text("utf-8")
    assert peers.tables(peers.measured(published=False)) in (peers.ROOM / "DETAILS.md").read_text("utf-8")
    least = min(p["cheapest_within_2mm"]["ratio_cheapest"] for p in results["hang_edge"]["peers"].values())
    assert f"within 2 mm, {least:.1f} (" in told


def test_a_peer_that_was_not_compared_or_never_came_near_is_told(bench, monkeypatch) -> None:
    peers = import_module("cloth_peer_tables")
    for name in ("cloth_peer_tables", "cloth_figures", "cloth_sweeps", "mapping"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    far = {"cpu_ms": 50.0, "ratio": 12.5, "own": {"mean": 3.14}}
    assert peers.short_cell(None) == peers.short_cell({"error": "no module"}) == "not compared"
    told = peers.short_cell({"cheapest_within_2mm": None, "best": far, "limit_from_ours": {"mean": 0.5}})
    assert told == "50 ms (never within 2 mm: 3.1), 12.5 / –; limit 0.5 mm off"


def test_pages_of_the_room_name_files_and_tests_that_are_there() -> None:
    room, tests = ROOT / "sim_core/cloth", ROOT / "tests/sim_core"
    known = "".join(path.read_text("utf-8") for path in tests.glob("test_cloth_*.py"))
    for page in ("README.md", "DETAILS.md"):
        text = (room / page).read_text("utf-8")
        for name in set(re.findall(r"`(?:test_cloth_\w+\.py: )?(test_\w+)`", text)):
            assert f"def {name}(" in known, f"{page}: {name}"
        for name in set(re.findall(r"`([\w/]+\.(?:py|toml|json))\b", text)):
            assert any((*room.rglob(name), *tests.glob(name), *ROOT.glob(name))), f"{page}: {name}"
        for link in re.findall(r"\]\(([^)#]+)", text):
            assert (room / link).exists(), f"{page}: {link}"


def test_the_readme_shows_public_names_alone() -> None:
    text = (ROOT / "sim_core/cloth/README.md").read_text("utf-8").split("```")[1]
    (line,) = re.findall(r"from sim_core.cloth import (.*)", text)
    assert set(line.split(", ")) <= set(cloth.__all__)
    assert set(re.findall(r"\b([A-Z]\w+|choose|drape|scene)[.(]", text)) <= set(line.split(", "))


@pytest.mark.nightly
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


@pytest.mark.nightly
def test_order_is_that_of_the_steps_from_mesh_to_mesh(bench) -> None:
    found = bench["cloth_measures"].meshes(hang_edge, (1.0, 1.0), 0.12, [0.16, 0.08, 0.04], lambda _: None)
    first, second = found["steps_mm"]
    assert found["order"] == pytest.approx([np.log2(first / second)])
    assert found["rows"][-1]["from_finest_mm"]["max"] == 0.0


@pytest.mark.nightly
def test_layers_keep_the_teapots_cloth_apart() -> None:
    before, after = (scene("teapot", vertices=300).layered(gap).contact for gap in (0.0, 0.003))
    assert before is not None
    assert after == replace(before, thickness=0.003)
    assert before.thickness == 0.0
