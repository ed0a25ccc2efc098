"""Mesh steps by a study: as coarse as the error allows, as fine as patience does; a spoilt study is one clear line."""

import json
from pathlib import Path

import pytest
from coarse_bake import build, coarse
from content_house import edit

from hall_app.check import check
from hall_app.content import load
from hall_app.content.bakes import bake_key, budget, chosen_steps, read_study

ASSETS = Path(__file__).parents[2] / "assets"
LAYER = {
    "name": "pibo",
    "whole": True,
    "edges": [0.026, 0.013],
    "triangles": [3000, 12000],
    "cpu_seconds": [10.0, 80.0],
    "apart": [{"mean_m": 0.001, "p99_m": 0.004}],
    "scatter": {"mean_m": 0.001, "p99_m": 0.002},
}


def study(**changed) -> dict:
    return {"outfit": "pibo", "inputs": "0" * 16, "layers": [{**LAYER, **changed}]}


def written(folder: Path, values: dict | str) -> Path:
    path = folder / "outfits/pibo.steps.json"
    path.write_text(values if isinstance(values, str) else json.dumps(values), "utf-8")
    return path


@pytest.fixture
def house(tmp_path):
    folder = coarse(tmp_path)
    text = (folder / "outfits/pibo.toml").read_text("utf-8")
    lines = [line for line in text.splitlines() if not line.startswith(("edge", "study"))]
    at = lines.index("[stand]")
    lines.insert(at, 'study = "outfits/pibo.steps.json"')
    (folder / "outfits/pibo.toml").write_text("\n".join(lines) + "\n", "utf-8")
    written(folder, study())
    return folder


def test_the_coarsest_step_within_the_error_is_taken(tmp_path):
    (tmp_path / "outfits").mkdir()
    (layer,) = read_study(written(tmp_path, study())).layers
    assert layer.order == 1.0
    assert layer.error(0.013) == pytest.approx(0.004)  # as far again from what is infinitely fine
    assert layer.error(0.026) - layer.error(0.013) == pytest.approx(0.004)
    for allowed, edge, by in (
        (0.006, 0.0195, "error"),
        (0.1, 0.026, "error"),
        (0.001, 0.013, "finest measured"),
    ):
        step = layer.step(allowed)
        assert (step.edge, step.by) == (pytest.approx(edge), by)
        assert step.error_p99_m == pytest.approx(layer.error(edge), abs=1e-6)


def test_no_step_costs_more_than_patience(tmp_path):
    (tmp_path / "outfits").mkdir()
    dear = study(whole=False, cpu_seconds=[100.0, 800.0])
    (layer,) = read_study(written(tmp_path, dear)).layers
    step = layer.step(0.001)
    assert step.by == "patience"
    assert 0.013 < step.edge < 0.026
    assert layer.seconds(step.edge) <= 180.0 < layer.seconds(step.edge - 0.001)
    assert layer.seconds(0.026) == pytest.approx(100.0)


def test_three_steps_tell_the_order(tmp_path):
    (tmp_path / "outfits").mkdir()
    apart = [{"mean_m": 0.004, "p99_m": 0.012}, {"mean_m": 0.001, "p99_m": 0.003}]
    three = {"edges": [0.026, 0.013, 0.0065], "triangles": [1, 2, 3], "cpu_seconds": [1.0, 8.0, 64.0]}
    (layer,) = read_study(written(tmp_path, study(apart=apart, **three))).layers
    assert layer.order == pytest.approx(2.0)
    assert layer.error(0.0065) == pytest.approx(0.001)
    assert layer.error(0.013) == pytest.approx(0.004)


def test_steps_decide_the_key_by_how_near_the_exhibit_is_seen(house):
    def key() -> tuple[str, float]:
        content = load(house)
        (exhibit,) = [e for e in content.exhibits if e.id == "pibo"]
        (step,) = chosen_steps(content, exhibit)
        show = exhibit.file.show
        assert step.budget_m == pytest.approx(budget(show.nearest, show.hall_error_px), abs=1e-6)
        return bake_key(content, exhibit), step.edge

    first = key()
    written(house, study(apart=[{"mean_m": 0.0005, "p99_m": 0.0012}]))
    second = key()
    assert first[0] != second[0]
    assert first[1] < second[1]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "Invalid JSON"),
        (study(edges=[0.013, 0.026]), "layers.1: layer pibo: 2 edges, coarsest first"),
        (study(apart=[]), "layers.1: layer pibo: 2 edges"),
        (study(cpu_seconds=[1.0, -1.0]), "layers.1.cpu_seconds.2"),
        ({"outfit": "pibo"}, "inputs: Field required"),
    ],
)
def test_a_spoilt_study_is_one_clear_line(house, text, words):
    written(house, text)
    found = [problem for problem in check(house) if problem.file == "outfits/pibo.steps.json"]
    assert len(found) == 1
    assert words in f"{found[0].key}: {found[0].what}"
    assert "simcore dress OUTFIT.toml --study" in found[0].fix


def test_a_layer_has_a_study_or_a_step(house):
    edit(house / "outfits/pibo.toml", "seed = 3", "seed = 3\nedge = 0.02")
    (found,) = [problem for problem in check(house) if problem.file == "outfits/pibo.toml"]
    assert found.key == "layer.1.edge"
    assert "leave out one of both" in found.fix


@pytest.mark.slow
def test_a_bake_takes_the_study_s_steps_and_records_why(house):
    edges = {"edges": [0.08, 0.06], "apart": [{"mean_m": 0.0001, "p99_m": 0.0002}]}
    written(house, study(**edges, cpu_seconds=[1.0, 2.0]))
    done = build(house)
    assert done.returncode == 0, done.stderr
    record = json.loads((house / "exhibits/pibo/baked/bake.json").read_text("utf-8"))
    (step,) = record["steps"]
    assert step["edge"] == 0.08
    assert step["by"] == "error"
    assert record["study_fits"] is False  # the study names other inputs
