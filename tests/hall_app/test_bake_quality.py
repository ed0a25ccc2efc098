"""`hall check --garments`: figures of baked garments against their limits."""

import json
from pathlib import Path

import pytest
from content_house import EXHIBIT, add_exhibit, make_house

from hall_app.bake.places import NEEDED
from hall_app.bake.quality import garment_lines, table
from hall_app.cli import main
from hall_app.content.loading import load

GOOD = {
    "inside_vertices": 0,
    "inside_midpoints": 0,
    "inside_centroids": 0,
    "area_strain_p95": 0.006,
    "area_strain_max": 0.09,
    "rest_p99_m": 4.8e-5,
    "self_intersections": 0,
    "hall_hausdorff_p99": 0.003,
    "hall_hausdorff_max": 0.007,
}


@pytest.fixture
def house(tmp_path: Path) -> Path:
    return make_house(tmp_path / "house")


@pytest.fixture
def scarf(house: Path) -> Path:
    """A content folder with a garment whose bake is a record and empty files."""
    recipe = '[garment]\npattern = "patterns/p.toml"\nweave = "weaves/w.toml"\nrecipe = "scarf_on_stand"'
    home = add_exhibit(house, "scarf", EXHIBIT.replace('[models]\nhall = "media/chest.glb"', recipe))
    for name in ("patterns/p.toml", "weaves/w.toml"):
        (house / name).parent.mkdir(exist_ok=True)
        (house / name).write_text("# not read here")
    (home / "baked").mkdir()
    for name in NEEDED:
        (home / "baked" / name).write_bytes(b"")
    return home / "baked" / "bake.json"


def bake(record: Path, **changes: float) -> None:
    record.write_text(json.dumps({"key": "k", "errors": {**GOOD, **changes}, "seconds": {"drape": 90.0}}))


def test_figures_within_their_limits(house: Path, scarf: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bake(scarf)
    lines = garment_lines(load(house))
    assert all(line.kept for line in lines)
    assert {line.exhibit for line in lines} == {"scarf"}
    text = table(lines)
    assert "0.048 mm   at most 0.100 mm" in text
    assert "0.60%   at most 3.00%" in text
    assert main(["check", "--garments", str(house)]) == 0
    assert capsys.readouterr().out == text


def test_a_broken_limit_is_marked_and_ends_with_1(
    house: Path, scarf: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bake(scarf, inside_midpoints=2)
    assert main(["check", "--garments", "--json", str(house)]) == 1
    figures = json.loads(capsys.readouterr().out)["figures"]
    broken = [figure for figure in figures if not figure["kept"]]
    assert [(figure["name"], figure["value"]) for figure in broken] == [("inside_midpoints", 2.0)]
    assert main(["check", "--garments", str(house)]) == 1
    assert "! inside_midpoints" in capsys.readouterr().out


def test_what_was_not_baked_or_measured_is_told(house: Path, scarf: Path) -> None:
    (line,) = garment_lines(load(house))
    assert not line.kept
    assert "hall build --exhibit scarf" in line.limit
    scarf.write_text(json.dumps({"key": "k", "errors": {}}))
    assert all("bake it again" in line.limit for line in garment_lines(load(house)))
