"""`hall check --garments`: figures of baked garments against their limits, and against the files that are shipped."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from content_house import edit

from hall_app.check import check
from hall_app.check.garments import (
    Measured,
    Worn,
    cloth_in,
    figure_lines,
    garment_lines,
    measured_again,
    quality,
    table,
)
from hall_app.cli import main
from hall_app.content import load
from hall_app.content.bakes import FILES, publish, seal
from hall_app.content.schema import Show
from sim_core.garment import Garment

ASSETS = Path(__file__).parents[2] / "assets"
MODELS = {"hall_hausdorff_mean": 4e-4, "hall_hausdorff_p99": 1.8e-3, "hall_hausdorff_max": 7e-3}
CLOTH = {
    **dict.fromkeys(("inside_vertices", "inside_midpoints", "inside_centroids", "inside_edges"), 0),
    "area_strain_p95": 0.006,
    "area_strain_max": 0.09,
    "rest_p99_m": 8e-6,
    "self_intersections": 0,
    "layer_order": 0,
}
SEWN = {"seam_gap_sewn_m": 0.0, "seam_gap_m": 0.0, "asymmetry_m": 0.0}
SIZES = {"triangles": 12_000, "hall_all_triangles": 5_900}
TIMES = {"seconds": {"drape": 100.0}, "stages": {"drape_cpu": 93.0}}

# What is worn, from the skin outwards.
COAT = Worn("coat", "flat", seams=True, sewn=True, half=True)
ROBE = replace(COAT, name="robe", beneath=True)
WORN = {
    "half": (COAT,),
    "whole": (replace(COAT, half=False),),
    "wrapped": (Worn("skirt", "wrapped", seams=True, sewn=True),),
    "gathered": (Worn("scarf", "overbar"),),
    "folded": (Worn("scarf", "folded"),),
    "spread": (Worn("robe", "flat", seams=True, sewn=True, spread=True),),
    "belted": (replace(ROBE, cloth=3.3), Worn("belt", "wrapped", cloth=0.06)),
    "layered": (ROBE, Worn("pibo", "alongpath", seams=True, half=True)),
    "scarfed": (replace(ROBE, cloth=1.8), Worn("pibo", "alongpath", seams=True, cloth=0.9, accessory=True)),
}
UNDER = {f"robe_{name}": value for name, value in (CLOTH | SEWN | MODELS | SIZES).items()}
GOOD = CLOTH | SEWN | SIZES | MODELS | UNDER

# What the project asks of each garment: (figure, the worst that is good, the best that is not).
INSIDE = [(f"inside_{what}", 0, 1) for what in ("vertices", "midpoints", "centroids", "edges")]
STRAIN = [("area_strain_p95", 0.0299, 0.0301), ("area_strain_max", 0.0999, 0.1001), ("layer_order", 0, 1)]
REST, STILL = [("rest_p99_m", 0.99e-5, 1.01e-5)], [("rest_p99_m", 0.99e-4, 1.01e-4)]
SEAMS = [("seam_gap_sewn_m", 0.99e-3, 1.01e-3), ("seam_gap_m", 0.99e-4, 1.01e-4)]
HALVES = [("asymmetry_m", 0.0099, 0.0101)]
TRIANGLES = [("triangles", 11_000, 10_999), ("hall_all_triangles", 6_000, 6_001)]
THINNED = [("hall_hausdorff_p99", 2.0e-3, 2.1e-3)]
DRESSED = INSIDE + STRAIN + REST + SEAMS + [("self_intersections", 0, 1)]
HUNG = [*INSIDE, *STRAIN, *STILL, ("self_intersections", 0, 1), *THINNED]
ASKED = {
    "half": DRESSED + HALVES + TRIANGLES + THINNED,
    "whole": DRESSED + TRIANGLES + THINNED,
    "wrapped": DRESSED + TRIANGLES + THINNED,
    "gathered": HUNG,
    "folded": HUNG,
    "spread": DRESSED + THINNED,
    "belted": [
        *INSIDE,
        *STRAIN,
        *REST,
        ("triangles", 200, 199),  # as many on its cloth as the robe has
        TRIANGLES[1],
        ("self_intersections", 0, 1),
        *THINNED,
        *[(f"robe_{name}", good, bad) for name, good, bad in [*DRESSED, *HALVES, TRIANGLES[0]]],
        ("robe_hall_hausdorff_p99", 3.9e-3, 4.1e-3),
    ],
    "layered": [
        *INSIDE,
        *STRAIN,
        *REST,
        SEAMS[1],
        *HALVES,
        *TRIANGLES,
        ("self_intersections", 25, 26),
        *THINNED,
        *[(f"robe_{name}", good, bad) for name, good, bad in DRESSED + HALVES],
        ("robe_hall_hausdorff_p99", 3.9e-3, 4.1e-3),
    ],
}


def lines_of(
    name: str, record: dict[str, Any], figures: dict[str, float] | None = None
) -> list[quality.Line]:
    """Lines of a garment looked at from a metre: a pixel's budget is 2.05 mm at two pixels."""
    return figure_lines(
        "x", Show(nearest=1.0, hall_error_px=2.0), record, Measured((), WORN[name], figures or {}, ())
    )


def judged(name: str, figures: dict[str, float] | None = None, /, **changes: Any) -> dict[str, quality.Line]:
    found = lines_of(name, {**TIMES, "errors": {**GOOD, **changes}}, figures)
    assert len({line.name for line in found}) == len(found), "each figure is told once"
    return {line.name: line for line in found}


@pytest.mark.parametrize("name", ASKED)
def test_every_limit_is_kept_by_good_figures(name: str):
    assert [line for line in judged(name).values() if not line.kept] == []
    assert set(judged(name)) >= {figure for figure, _, _ in ASKED[name]}


def test_what_a_belt_goes_round_is_as_fine_as_what_is_worn_outermost():
    assert "robe_triangles" not in judged("layered"), "what lies beneath a garment is seen at its edges"
    for name, over in (("belted", 200), ("scarfed", 5500)):
        assert judged(name)["robe_triangles"].limit == "at least 11000"
        assert judged(name)["triangles"].limit == f"at least {over}"


def test_halves_are_compared_only_where_one_was_dressed():
    assert "asymmetry_m" not in judged("whole")
    assert "asymmetry_m" in judged("half")
    assert "robe_asymmetry_m" in judged("layered")


@pytest.mark.parametrize(
    ("name", "figure", "good", "bad"), [(name, *asked) for name, rows in ASKED.items() for asked in rows]
)
def test_each_limit_of_each_garment(name: str, figure: str, good: float, bad: float):
    assert judged(name, **{figure: good})[figure].kept
    broken = [line for line in judged(name, **{figure: bad}).values() if not line.kept]
    assert [(line.name, line.value) for line in broken] == [(figure, bad)]


@pytest.mark.parametrize("odd", ["x", [], None, True, {}], ids=repr)
def test_what_is_no_number_is_one_line(odd: object):
    (broken,) = [line for line in judged("half", area_strain_max=odd).values() if not line.kept]
    assert broken.name == "area_strain_max"
    assert broken.value is None
    assert broken.limit.endswith("bake it again")


@pytest.mark.parametrize("part", ["errors", "seconds", "stages"])
@pytest.mark.parametrize("odd", ["x", [1, 2], None, 7], ids=repr)
def test_a_record_of_odd_parts_is_told(part: str, odd: object):
    lines = lines_of("half", {**TIMES, "errors": GOOD, part: odd})
    broken = [line for line in lines if not line.kept]
    assert broken
    assert all("bake it again" in line.limit for line in broken)
    assert table(lines)


def test_not_a_number_keeps_no_limit():
    assert not judged("half", area_strain_max=float("nan"))["area_strain_max"].kept


def test_dressing_all_layers_has_a_time():
    assert judged("layered")["drape_s"].value == 100.0
    slow = {"errors": GOOD, "seconds": {"drape": 100.0}, "stages": {"drape_cpu": 361.0}}
    (line,) = [line for line in lines_of("layered", slow) if not line.kept]
    assert line.name == "drape_cpu_s"
    assert "360.0 s" in line.limit  # of both layers


@pytest.mark.parametrize(
    ("figure", "told", "found"),
    [
        ("inside_vertices", 0, 3),
        ("self_intersections", 0, 12),
        ("area_strain_max", 0.05, 0.08),
        ("asymmetry_m", 0.0, 0.004),
        ("hall_hausdorff_p99", 0.0005, 0.0018),
        ("hall_all_triangles", 5_900, 5_901),
        ("robe_self_intersections", 0, 1),
    ],
)
def test_a_record_is_believed_only_where_the_files_agree(figure: str, told: float, found: float):
    assert judged("layered", {figure: told}, **{figure: told})[figure].kept
    line = judged("layered", {figure: found}, **{figure: told})[figure]
    assert not line.kept
    assert line.value == found
    assert "bake.json says" in line.limit


# With a scarf that is baked on a coarse mesh.


@pytest.fixture
def scarf(coarse_scarf: tuple[Path, dict[str, Any]], tmp_path: Path) -> Path:
    """A content folder with the coarse scarf alone, no media."""
    home = tmp_path / "assets"
    shutil.copytree(
        coarse_scarf[0], home, ignore=shutil.ignore_patterns("room", "mirror", "pibo-figure", "media")
    )
    text = toml(home).read_text("utf-8")
    toml(home).write_text(text.partition("[[media]]")[0], "utf-8")
    edit(home / "hall.toml", "music", "# music")
    return home


def toml(home: Path) -> Path:
    return home / "exhibits/pibo/exhibit.toml"


def baked(home: Path, exhibit: str = "pibo") -> Path:
    return home / "exhibits" / exhibit / "baked"


def reseal(baked: Path, **changes: object) -> None:
    """Vouch for the files as they are now, and change the record."""
    record = json.loads((baked / "bake.json").read_text("utf-8"))
    record |= {**changes, FILES: seal(baked, "bake.json")}
    (baked / "bake.json").write_text(json.dumps(record), "utf-8")


def cut_off(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:1000])


def changed(**facts: Any) -> Callable[[Path], object]:
    def change(home: Path) -> None:
        file = baked(home) / "garment.npz"
        replace(Garment.load(file), **facts).save(file)

    return change


def raised(home: Path) -> None:
    file = baked(home) / "garment.npz"
    garment = Garment.load(file)
    replace(garment, positions=garment.positions + [0.0, 0.005, 0.0]).save(file)


def sealed(change: Callable[[Path], object], **record: object) -> Callable[[Path], object]:
    def spoil(home: Path) -> None:
        change(home)
        reseal(baked(home), **record)

    return spoil


def nothing(home: Path) -> None:
    return None


FAULTS: dict[str, tuple[Callable[[Path], object], str, str]] = {
    "not baked": (lambda home: shutil.rmtree(baked(home)), "bake", "has not been baked"),
    "stale": (lambda home: edit(toml(home), "nearest = 1.3", "nearest = 1.4"), "bake", "is stale"),
    "stale outfit": (
        lambda home: edit(home / "outfits/pibo.toml", "seed = 3", "seed = 2"),
        "bake",
        "is stale",
    ),
    "another garment": (raised, "files", "baked/garment.npz is not the file that was baked"),
    "another garment, sealed": (sealed(raised), "digest", "is not the garment that bake.json tells of"),
    "another name, sealed": (
        sealed(changed(name="robe")),
        "files",
        "cannot be measured (close.glb holds no 'robe')",
    ),
    "on nothing, sealed": (sealed(changed(settled=None)), "files", "does not say what it lies on"),
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
    "no layers": (sealed(nothing, layers=None), "bake", "does not tell its layers"),
    "a layer that is not there": (sealed(nothing, layers=[{}, {}]), "files", "cannot be measured"),
    "unreadable": (lambda home: toml(home).write_text("title ="), "exhibit", "exhibit.toml: not TOML"),
    "list for a record": (lambda home: (baked(home) / "bake.json").write_text("[]"), "bake", "not whole"),
}


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_what_is_baked_is_looked_at(scarf: Path, fault: str):
    spoil, name, what = FAULTS[fault]
    spoil(scarf)
    broken = [line for line in garment_lines(load(scarf)) if not line.kept]
    assert broken
    assert broken[0].exhibit == "pibo"
    assert broken[0].name == name
    assert what in broken[0].limit
    assert table(broken)


@pytest.mark.slow
def test_a_bake_measured_again_is_what_its_record_says(
    scarf: Path, coarse_scarf: tuple[Path, dict[str, Any]]
):
    again, record = measured_again(baked(scarf), 1), coarse_scarf[1]
    assert again.digests == (record["digest"],)
    assert again.worn == (Worn("pibo", "overbar", cloth=again.worn[0].cloth),)
    assert again.worn[0].cloth == pytest.approx(2.4 * 0.4, rel=0.02)
    assert again.faults == ()
    lines = {line.name: line for line in garment_lines(load(scarf))}
    assert not [line for line in lines.values() if "bake.json says" in line.limit]
    assert {"inside_vertices", "rest_p99_m", "hall_hausdorff_p99", "drape_s"} <= lines.keys()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["garment.npz", "hall.glb", "drape.jpg"])
def test_check_names_a_file_that_was_not_baked(scarf: Path, name: str):
    cut_off(baked(scarf) / name)
    lines = [str(problem) for problem in check(scarf) if problem.file == "exhibits/pibo/exhibit.toml"]
    (line,) = [line for line in lines if name in line]
    assert f"outfit: baked/{name} is not the file that was baked" in line
    assert line.endswith("run: hall build --exhibit pibo")


# With the garments that are shipped.


@pytest.fixture
def shipped(tmp_path: Path) -> Path:
    """The shipped content with all that is dressed, no media."""
    home = tmp_path / "assets"
    shutil.copytree(ASSETS, home, ignore=shutil.ignore_patterns("room", "mirror", "media", "drape.*"))
    for path in home.glob("exhibits/*/exhibit.toml"):
        path.write_text(path.read_text("utf-8").partition("[[media]]")[0], "utf-8")
        reseal(path.parent / "baked")
    edit(home / "hall.toml", "music", "# music")
    return home


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
    shutil.copyfile(baked(shipped, "pibo") / "close.glb", baked(shipped, "beizi") / "close.glb")
    reseal(baked(shipped, "beizi"))
    assert main(["check", "--garments", "--json", str(shipped)]) == 1
    figures = json.loads(capsys.readouterr().out)["figures"]
    broken = {(line["exhibit"], line["name"]): line for line in figures if not line["kept"]}
    assert broken["pibo-figure", "robe_inside_vertices"]["value"] == 0
    assert "says 900" in broken["pibo-figure", "robe_inside_vertices"]["limit"]
    assert broken["pibo-figure", "robe_self_intersections"]["value"] == 0
    assert "holds no 'moxiong'" in broken["beizi", "files"]["limit"]


def test_the_robe_in_a_model_is_welded_whole():
    robe = cloth_in(ASSETS / "exhibits/pibo-figure/baked/close.glb", "robe")
    edges = {
        tuple(sorted(pair)) for face in robe.faces for pair in zip(face, [*face[1:], face[0]], strict=True)
    }
    # A tube with two sleeves open at the ends: vertices - edges + faces of a sphere with four holes.
    assert len(robe.positions) - len(edges) + len(robe.faces) == 2 - 4
    assert robe.rest.shape == (len(robe.faces), 3, 2)


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
