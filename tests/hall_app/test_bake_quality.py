"""`hall check --garments`: figures of baked garments against their limits, and against the files that are shipped."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from content_house import edit
from full_matrix import by_day

from hall_app.check import check
from hall_app.check.garments import (
    PIBO,
    ROBE,
    SCARF,
    Measured,
    cloth_in,
    figure_lines,
    garment_lines,
    quality,
    table,
)
from hall_app.cli import main
from hall_app.content import load
from hall_app.content.bakes import FILES, publish, seal
from hall_app.content.schema import GarmentRecipe

ASSETS = Path(__file__).parents[2] / "assets"
NOTHING = Measured("", {}, ())
MODELS = {"hall_hausdorff_mean": 4e-4, "hall_hausdorff_p99": 1.8e-3, "hall_hausdorff_max": 7e-3}
CLOTH = {
    **dict.fromkeys(("inside_vertices", "inside_midpoints", "inside_centroids"), 0),
    "area_strain_p95": 0.006,
    "area_strain_max": 0.09,
    "rest_p99_m": 8e-6,
    "self_intersections": 0,
}
SEWN = {"seam_gap_sewn_m": 0.0, "seam_gap_m": 0.0, "asymmetry_m": 0.0}
SIZES = {"triangles": 12_000, "hall_all_triangles": 5_900}
UNDER = {f"robe_{name}": value for name, value in (CLOTH | SEWN | MODELS).items()}
GOOD = {
    ROBE: CLOTH | SEWN | SIZES | MODELS,
    SCARF: CLOTH | MODELS,
    PIBO: CLOTH | {"asymmetry_m": 0.0} | SIZES | MODELS | UNDER,
}
TIMES = {"seconds": {"drape": 100.0, "beneath": 40.0}, "stages": {"drape_cpu": 93.0}}

# What the project asks of each garment: (figure, the worst that is good, the best that is not).
INSIDE = [(f"inside_{what}", 0, 1) for what in ("vertices", "midpoints", "centroids")]
STRAIN = [("area_strain_p95", 0.0299, 0.0301), ("area_strain_max", 0.0999, 0.1001)]
REST, STILL = [("rest_p99_m", 0.99e-5, 1.01e-5)], [("rest_p99_m", 0.99e-4, 1.01e-4)]
SEAMS = [("seam_gap_sewn_m", 0.99e-3, 1.01e-3), ("seam_gap_m", 0.99e-4, 1.01e-4)]
HALVES = [("asymmetry_m", 0.0099, 0.0101)]
TRIANGLES = [("triangles", 11_000, 10_999), ("hall_all_triangles", 6_000, 6_001)]
A_ROBE = INSIDE + STRAIN + REST + SEAMS + HALVES + [("self_intersections", 25, 26)]
ASKED = {
    ROBE: [*A_ROBE, *TRIANGLES, ("hall_hausdorff_p99", 2.0e-3, 2.1e-3)],
    SCARF: [*INSIDE, *STRAIN, *STILL, ("self_intersections", 0, 1), ("hall_hausdorff_p99", 2.0e-3, 2.1e-3)],
    PIBO: [
        *INSIDE,
        *STRAIN,
        *REST,
        *HALVES,
        *TRIANGLES,
        ("self_intersections", 300, 301),
        ("hall_hausdorff_p99", 2.0e-3, 2.1e-3),
        *[(f"robe_{name}", good, bad) for name, good, bad in A_ROBE],
        ("robe_hall_hausdorff_p99", 3.9e-3, 4.1e-3),
    ],
}


def recipe(name: str) -> GarmentRecipe:
    """A garment looked at from a metre: a pixel's budget is 2.05 mm at two pixels."""
    files = {"pattern": "p.toml", "weave": "w.toml", "nearest": 1.0, "hall_error_px": 2.0}
    if name != SCARF:
        files["mannequin"] = "m.npz"
    if name == PIBO:
        files |= {"robe_pattern": "r.toml", "robe_weave": "v.toml"}
    return GarmentRecipe.model_validate({**files, "recipe": name})


def judged(name: str, again: Measured | None = None, /, **changes: Any) -> dict[str, quality.Line]:
    record = {**TIMES, "errors": {**GOOD[name], **changes}}
    return {line.name: line for line in figure_lines("x", recipe(name), record, again or NOTHING)}


@pytest.mark.parametrize("name", ASKED)
def test_every_limit_is_kept_by_good_figures(name: str):
    assert [line for line in judged(name).values() if not line.kept] == []
    assert set(judged(name)) >= {figure for figure, _, _ in ASKED[name]}


@pytest.mark.parametrize(
    ("name", "figure", "good", "bad"), [(name, *asked) for name, rows in ASKED.items() for asked in rows]
)
def test_each_limit_of_each_recipe(name: str, figure: str, good: float, bad: float):
    assert judged(name, **{figure: good})[figure].kept
    broken = [line for line in judged(name, **{figure: bad}).values() if not line.kept]
    assert [(line.name, line.value) for line in broken] == [(figure, bad)]


@pytest.mark.parametrize("odd", ["x", [], None, True, {}], ids=repr)
def test_what_is_no_number_is_one_line(odd: object):
    (broken,) = [line for line in judged(ROBE, area_strain_max=odd).values() if not line.kept]
    assert broken.name == "area_strain_max"
    assert broken.value is None
    assert broken.limit.endswith("bake it again")


@pytest.mark.parametrize("part", ["errors", "seconds", "stages"])
@pytest.mark.parametrize("odd", ["x", [1, 2], None, 7], ids=repr)
def test_a_record_of_odd_parts_is_told(part: str, odd: object):
    record = {**TIMES, "errors": GOOD[ROBE], part: odd}
    lines = figure_lines("x", recipe(ROBE), record, NOTHING)
    broken = [line for line in lines if not line.kept]
    assert broken
    assert all("bake it again" in line.limit for line in broken)
    assert table(lines)


def test_not_a_number_keeps_no_limit():
    assert not judged(ROBE, area_strain_max=float("nan"))["area_strain_max"].kept


def test_the_drape_counts_the_robe_beneath():
    assert judged(PIBO)["drape_s"].value == 140.0
    record = {"errors": GOOD[PIBO], "seconds": {"drape": 100.0, "beneath": 81.0}}
    (line,) = [x for x in figure_lines("x", recipe(PIBO), record, NOTHING) if x.name == "drape_s"]
    assert not line.kept


@pytest.mark.parametrize(
    ("figure", "told", "found"),
    [
        ("inside_vertices", 0, 3),
        ("self_intersections", 0, 12),
        ("area_strain_max", 0.05, 0.08),
        ("asymmetry_m", 0.0, 0.004),
        ("hall_hausdorff_p99", 0.0005, 0.0018),
        ("hall_all_triangles", 5_900, 5_901),
    ],
)
def test_a_record_is_believed_only_where_the_files_agree(figure: str, told: float, found: float):
    assert judged(ROBE, Measured("", {figure: told}, ()), **{figure: told})[figure].kept
    line = judged(ROBE, Measured("", {figure: found}, ()), **{figure: told})[figure]
    assert not line.kept
    assert line.value == found
    assert "bake.json says" in line.limit


# With the garments that are shipped.


@pytest.fixture
def shipped(tmp_path: Path) -> Path:
    """The shipped content with both garments on figures, no film."""
    home = tmp_path / "assets"
    shutil.copytree(ASSETS, home, ignore=shutil.ignore_patterns("room", "mirror", "media", "drape.*", "pibo"))
    (home / "exhibits/pibo").mkdir()
    for source in (ASSETS / "exhibits/pibo").rglob("*"):
        if source.is_file() and source.suffix not in (".mp4", ".webm") and "media" not in source.parts:
            target = home / source.relative_to(ASSETS)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, target)
    for exhibit in ("beizi", "pibo-figure", "pibo"):
        toml = home / "exhibits" / exhibit / "exhibit.toml"
        toml.write_text(toml.read_text("utf-8").partition("[[media]]")[0], "utf-8")
        reseal(home / "exhibits" / exhibit / "baked")
    edit(home / "hall.toml", "music", "# music")
    return home


def reseal(baked: Path, **changes: object) -> None:
    """Vouch for the files as they are now, and change the record."""
    record = json.loads((baked / "bake.json").read_text("utf-8"))
    record |= {**changes, FILES: seal(baked, "bake.json")}
    (baked / "bake.json").write_text(json.dumps(record), "utf-8")


def baked(home: Path, exhibit: str = "beizi") -> Path:
    return home / "exhibits" / exhibit / "baked"


def cut_off(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:1000])


def swap(home: Path) -> None:
    for name in ("garment.npz", "hall.glb"):
        shutil.copyfile(baked(home, "pibo") / name, baked(home) / name)


def sealed(change: Callable[[Path], object]) -> Callable[[Path], object]:
    def spoil(home: Path) -> None:
        change(home)
        reseal(baked(home))

    return spoil


FAULTS: dict[str, tuple[Callable[[Path], object], str, str]] = {
    "not baked": (lambda home: shutil.rmtree(baked(home)), "bake", "has not been baked"),
    "stale": (lambda home: edit(toml(home), "arm = 45.0", "arm = 50.0"), "bake", "is stale"),
    "another garment": (swap, "files", "baked/garment.npz is not the file that was baked"),
    "cut off": (lambda home: cut_off(baked(home) / "garment.npz"), "files", "is not the file"),
    "model cut off": (lambda home: cut_off(baked(home) / "hall.glb"), "files", "baked/hall.glb is not"),
    "cut off and sealed": (
        sealed(lambda home: cut_off(baked(home) / "garment.npz")),
        "files",
        "cannot be measured",
    ),
    "model cut off and sealed": (
        sealed(lambda home: cut_off(baked(home) / "hall.glb")),
        "files",
        "cannot be measured",
    ),
    "another garment, sealed": (sealed(swap), "files", "cannot be measured (close.glb holds no 'pibo')"),
    "unreadable": (lambda home: toml(home).write_text("title ="), "exhibit", "exhibit.toml: not TOML"),
    "list for a record": (lambda home: (baked(home) / "bake.json").write_text("[]"), "bake", "not whole"),
}


def toml(home: Path) -> Path:
    return home / "exhibits/beizi/exhibit.toml"


@pytest.mark.parametrize("fault", FAULTS)
def test_what_is_shipped_is_looked_at(shipped: Path, fault: str, monkeypatch: pytest.MonkeyPatch):
    spoil, name, what = FAULTS[fault]
    for other in ("pibo", "pibo-figure"):
        if fault not in ("another garment", "another garment, sealed") or other != "pibo":
            shutil.rmtree(shipped / "exhibits" / other)
    spoil(shipped)
    shutil.rmtree(shipped / "exhibits/pibo", ignore_errors=True)
    broken = [line for line in garment_lines(load(shipped)) if not line.kept and line.exhibit == "beizi"]
    assert broken
    assert broken[0].name == name
    assert what in broken[0].limit
    assert table(broken)


@pytest.mark.slow
def test_the_shipped_garments_keep_their_limits_measured_again(shipped: Path, capsys):
    assert main(["check", "--garments", str(shipped)]) == 0
    text = capsys.readouterr().out
    assert "all limits kept" in text
    for name in ("robe_hall_hausdorff_p99", "robe_self_intersections", "hall_hausdorff_max"):
        assert name in text


@pytest.mark.nightly
@pytest.mark.slow
def test_a_record_that_says_other_than_its_files_is_told_from_the_command(shipped: Path, capsys):
    record = json.loads((baked(shipped, "pibo-figure") / "bake.json").read_text("utf-8"))
    record["errors"] |= {"robe_inside_vertices": 900, "robe_self_intersections": 6000}
    reseal(baked(shipped, "pibo-figure"), errors=record["errors"])
    shutil.copyfile(baked(shipped, "pibo") / "close.glb", baked(shipped) / "close.glb")
    reseal(baked(shipped))
    assert main(["check", "--garments", "--json", str(shipped)]) == 1
    figures = json.loads(capsys.readouterr().out)["figures"]
    broken = {(line["exhibit"], line["name"]): line for line in figures if not line["kept"]}
    assert broken["pibo-figure", "robe_inside_vertices"]["value"] == 0
    assert "says 900" in broken["pibo-figure", "robe_inside_vertices"]["limit"]
    assert broken["pibo-figure", "robe_self_intersections"]["value"] <= 25
    assert "holds no 'beizi'" in broken["beizi", "files"]["limit"]


def test_the_robe_in_a_model_is_welded_whole():
    robe = cloth_in(ASSETS / "exhibits/pibo-figure/baked/close.glb", "robe")
    edges = {
        tuple(sorted(pair)) for face in robe.faces for pair in zip(face, [*face[1:], face[0]], strict=True)
    }
    # A tube with two sleeves open at the ends: vertices - edges + faces of a sphere with four holes.
    assert len(robe.positions) - len(edges) + len(robe.faces) == 2 - 4
    assert robe.rest.shape == (len(robe.faces), 3, 2)


@pytest.mark.parametrize("name", by_day(["hall.glb"], ["garment.npz", "hall.glb", "drape.jpg"]))
def test_check_names_a_file_that_was_not_baked(shipped: Path, name: str):
    cut_off(baked(shipped) / name) if name != "drape.jpg" else (baked(shipped) / name).write_bytes(b"x")
    if name == "drape.jpg":
        reseal(baked(shipped))
        (baked(shipped) / name).write_bytes(b"y")
    lines = [str(problem) for problem in check(shipped) if problem.file == "exhibits/beizi/exhibit.toml"]
    (line,) = [line for line in lines if name in line]
    assert f"garment: baked/{name} is not the file that was baked" in line
    assert line.endswith("run: hall build --exhibit beizi")


def test_while_a_bake_is_put_in_place_the_old_record_is_gone(tmp_path: Path, monkeypatch):
    out, target = tmp_path / "out", tmp_path / "baked"
    for folder, text in ((out, "new"), (target, "old")):
        folder.mkdir()
        for name in ("garment.npz", "hall.glb", "close.glb", "bake.json"):
            (folder / name).write_text(text)
    copy, copied = shutil.copyfile, []

    def cut(source, there):
        copied.append(there)
        if len(copied) == 2:
            raise KeyboardInterrupt
        return copy(source, there)

    monkeypatch.setattr(shutil, "copyfile", cut)
    with pytest.raises(KeyboardInterrupt):
        publish(out, target, "bake.json")
    assert not (target / "bake.json").exists()
