"""A scan as an exhibit: what is wrong with it is said by `hall check` and at the bake, and its models are measured."""

from __future__ import annotations

import json
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import scan_like
from content_house import add_exhibit, edit, make_house
from PIL import Image

from hall_app.check import check, hints
from hall_app.cli import main
from hall_app.content import exhibit_json, load
from hall_app.content.bakes import bake_key, models_of
from hall_app.content.models import read_glb
from sim_core.mesh.scan import Fine, Level, cleaned, read_scan, stood

SCANNED = '\n[scanned]\nunits = "mm"\nup = "z"\nkeep = "largest"\n'


@pytest.fixture(scope="module")
def made() -> scan_like.Made:
    """The coat as a scanner leaves it: millimetres, z up, noise, holes, flakes around it."""
    whole = scan_like.scan_of(20_000, pixels=512)
    return scan_like.with_flakes(scan_like.with_holes(whole, 3, 0.05), 5, 0.004, 1.0).turned()


def house_of(folder: Path, made: scan_like.Made, scanned: str = SCANNED, form: str = "glb") -> Path:
    """A content folder with one exhibit, "robe", that is a scan which has not been baked."""
    house = make_house(folder)
    home = add_exhibit(house, "robe")
    toml = home / "exhibit.toml"
    edit(toml, '[models]\nhall = "media/chest.glb"\n', "")
    edit(toml, "x = 0.0\nz = -1.0", "x = 2.5\nz = 2.5")
    edit(toml, "behaviours", f'scan = "scan/robe.{form}"\nbehaviours')
    toml.write_text(toml.read_text("utf-8") + scanned, "utf-8")
    (home / "media/chest.glb").unlink()
    (home / "scan").mkdir()
    write = {"glb": scan_like.write_glb, "obj": scan_like.write_obj, "ply": scan_like.write_ply}[form]
    write(made, home / f"scan/robe.{form}")
    return house


def build(house: Path) -> int:
    return main(
        [
            "build",
            "--content",
            str(house),
            "--data",
            str(house.parent / "data"),
            "--exhibit",
            "robe",
            "--json",
        ]
    )


@pytest.fixture(scope="module")
def baked(made, tmp_path_factory) -> Path:
    house = house_of(tmp_path_factory.mktemp("scan") / "assets", made)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("hall_app.build.scan.PIXELS", {"close": 512, "hall": 256})
        assert build(house) == 0
    return house


def lines(house: Path) -> list[str]:
    return [str(problem) for problem in check(house)]


def test_what_is_wrong_is_said_with_its_remedy(made, tmp_path, capsys):
    house = house_of(tmp_path / "assets", made, scanned="")
    said = lines(house)
    toml = "exhibits/robe/exhibit.toml: "
    high = np.ptp(scan_like.garment_mesh()[0][:, 1])  # [m] of the coat, without flakes
    assert [line.split(" – ")[1] for line in said if line.startswith(f"{toml}scanned: ")] == [
        f'write units = "mm" below [scanned] ({high:.3g} m)'
    ]
    assert any(line.startswith(f"{toml}scanned.up: it seems to lie") and 'up = "z"' in line for line in said)
    loose = next(line for line in said if line.startswith(f"{toml}scanned.keep: "))
    assert "5 loose parts" in loose
    assert 'keep = "largest"' in loose
    assert build(house) == 1
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert f"{toml}scanned.up: it seems to lie" in told
    assert " – write up" in told


def test_following_the_remedies_leads_to_an_exhibit(made, tmp_path):
    house = house_of(tmp_path / "assets", made)
    assert lines(house) == [
        "exhibits/robe/exhibit.toml: scan: has not been baked – run: hall build --exhibit robe"
    ]
    remarks = [str(one) for one in hints(house) if one.file.startswith("exhibits/robe/")]
    assert len(remarks) == 1
    assert "it has 3 holes, the largest" in remarks[0]


def test_of_a_torn_scan_nothing_else_is_said(made, tmp_path):
    """Neither the size of a single triangle, nor that there are thousands of parts."""
    corners = made.vertices[made.faces].reshape(-1, 3)
    corners += np.random.default_rng(0).normal(scale=1e-3, size=corners.shape)
    faces = np.arange(len(corners), dtype=np.int32).reshape(-1, 3)
    torn = replace(made, vertices=corners, faces=faces, uv=made.uv[made.faces].reshape(-1, 2))
    said = [line for line in lines(house_of(tmp_path / "assets", torn, "")) if "robe" in line]
    assert said == [
        "exhibits/robe/exhibit.toml: scan: its triangles hardly hang together: 100 % of all edges are open"
        " – merge its vertices by distance in the scanning software"
    ]


@pytest.mark.parametrize(
    ("scale", "remedy"),
    [(1e3, 'units = "mm"'), (1e2, 'units = "cm"'), (39.37, 'units = "in"'), (1e-3, "scale = 1000")],
)
def test_a_wrong_scale_names_the_right_one(made, tmp_path, scale, remedy):
    small = scan_like.scan_of(20_000, pixels=64).turned(scale)
    house = house_of(tmp_path / "assets", small, '\n[scanned]\nup = "z"\n')
    assert any(remedy in line for line in lines(house))


def test_a_bake_is_measured_and_whole(made, baked):
    assert lines(baked) == []
    content = load(baked)
    exhibit = content.exhibit("robe")
    assert exhibit is not None
    models = models_of(content, exhibit, None)
    assert models is not None
    record = json.loads((models.hall.parent / "bake.json").read_text("utf-8"))
    hall, close = read_glb(models.hall), read_glb(models.close)
    assert hall.triangles == record["errors"]["hall_triangles"] <= 15_000
    assert close.triangles == record["errors"]["close_triangles"] <= 80_000
    assert hall.textures == ((256, 256),)
    assert hall.size < 1_500_000
    assert hall.low[1] == pytest.approx(0, abs=0.01)
    assert hall.high[1] == pytest.approx(1.15, abs=0.03)
    assert record["scan"]["hall"]["within_budget"]
    assert record["errors"]["hall_hausdorff_p99"] <= record["hall_budget_m"]
    assert record["scan"]["condition"]["triangles"] == len(made.faces)


def test_its_deviation_is_that_of_the_files(baked):
    """Measured again from the scan and the shipped model, placed by themselves."""
    from sim_core.gltf import glb_parts

    home = baked / "exhibits/robe"
    scan, _ = cleaned(read_scan(home / "scan/robe.glb", baked))
    from sim_core.mesh.scan import largest_part

    scan = stood(largest_part(scan), 0.001, "z")
    parts = glb_parts((home / "baked/hall.glb").read_bytes())
    primitive = parts.document["meshes"][0]["primitives"][0]
    vertices, normals = (parts.numbers(primitive["attributes"][name]) for name in ("POSITION", "NORMAL"))
    faces = parts.numbers(primitive["indices"]).reshape(-1, 3).astype("int32")
    again = Fine(scan.vertices, scan.faces).deviation(Level(vertices, faces, normals), 100_000)
    told = json.loads((home / "baked/bake.json").read_text("utf-8"))["errors"]
    assert told["hall_hausdorff_p99"] == pytest.approx(again.p99, rel=0.1)
    assert told["hall_hausdorff_mean"] == pytest.approx(again.mean, rel=0.1)


def test_visitors_read_what_was_measured(baked):
    shown = exhibit_json(load(baked), "robe")
    assert shown is not None
    assert shown["has_close"]
    labels = [line["label"]["en"] for line in shown["measured"]]
    assert "Triangles of the scan" in labels
    assert "Hall model, deviation, 99th percentile" in labels


def test_its_key_follows_the_scan_and_what_lies_beside(made, tmp_path):
    house = house_of(tmp_path / "assets", made, form="obj")
    home = house / "exhibits/robe"

    def key() -> str:
        content = load(house)
        exhibit = content.exhibit("robe")
        assert exhibit is not None, content.problems
        return bake_key(content, exhibit)

    keys = [key()]
    (home / "scan/robe.jpg").write_bytes(scan_like.jpeg(made.picture[::-1]))
    keys.append(key())
    edit(home / "exhibit.toml", 'keep = "largest"', 'keep = "all"')
    keys.append(key())
    edit(home / "exhibit.toml", "[scanned]", "[show]\nnearest = 3.0\n[scanned]")
    keys.append(key())
    assert len(set(keys)) == 4
    assert "exhibits/robe/scan/robe.mtl" not in "\n".join(lines(house))  # it is used


def test_an_unbaked_scan_hides_nothing_of_what_is_missing(made, tmp_path):
    house = house_of(tmp_path / "assets", made, form="obj")
    (house / "exhibits/robe/scan/robe.jpg").unlink()
    said = [line for line in lines(house) if line.startswith("exhibits/robe/")]
    assert said == [
        "exhibits/robe/exhibit.toml: scan: scan/robe.obj: the file it names, 'robe.jpg', is not there"
        " – put it beside robe.obj"
    ]


def test_only_one_source_of_models_is_allowed(made, tmp_path):
    house = house_of(tmp_path / "assets", made)
    edit(house / "exhibits/robe/exhibit.toml", "scan = ", 'outfit = "outfits/scarf.toml"\nscan = ')
    assert any("needs one of outfit, scan and [models]" in line for line in lines(house))


@pytest.mark.nightly
def test_a_million_triangles_become_both_models(tmp_path):
    """With their deviation measured, colours kept, holes and flakes told; a hall's model within its budget."""
    big = scan_like.scan_of(1_000_000, pixels=2048)
    big = scan_like.with_flakes(scan_like.with_holes(big, 12, 0.02), 30, 0.004).turned()
    house = house_of(tmp_path / "assets", big, form="ply")
    assert build(house) == 0
    assert lines(house) == []
    home = house / "exhibits/robe/baked"
    record = json.loads((home / "bake.json").read_text("utf-8"))
    condition, hall, close = (record["scan"][name] for name in ("condition", "hall", "close"))
    assert condition["triangles"] == len(big.faces) > 900_000
    assert condition["parts"] == 31
    assert 12 <= condition["holes"] <= 24
    assert hall["within_budget"]
    assert close["deviation"]["p99_m"] < 1.5 * close["budget_m"]
    assert close["triangles"] == read_glb(home / "close.glb").triangles <= 80_000
    picture = Image.open(BytesIO(picture_of(home / "close.glb"))).convert("RGB")
    reds = np.asarray(picture).reshape(-1, 3).astype(int)
    assert 0.2 < ((reds[:, 0] > 1.6 * reds[:, 1]) & (reds[:, 0] > 80)).mean() < 0.9  # the coat's ground


def picture_of(path: Path) -> bytes:
    from sim_core.gltf import glb_parts

    parts = glb_parts(path.read_bytes())
    begin, end = parts.picture_place(0)
    return parts.data[begin:end]


@pytest.mark.nightly
def test_an_interrupted_bake_goes_on(made, tmp_path, monkeypatch):
    """What was finished is not made again, and the result is the same to the byte."""
    monkeypatch.setattr("hall_app.build.scan.PIXELS", {"close": 128, "hall": 64})
    whole, broken = (house_of(tmp_path / name / "assets", made) for name in ("a", "b"))
    assert build(whole) == 0

    def fail(*given: object) -> bytes:
        raise RuntimeError("lights out")

    with monkeypatch.context() as patch:
        patch.setattr("sim_core.mesh.scan.model.scan_glb", fail)
        assert build(broken) == 1
    kept = list((broken.parent / "data/bake-work").glob("robe-*/levels.npz"))
    assert len(kept) == 1
    with monkeypatch.context() as patch:
        patch.setattr("sim_core.mesh.scan.levels.coarsened", fail)
        assert build(broken) == 0
    assert not kept[0].exists()
    for name in ("hall.glb", "close.glb"):
        first, second = (h / "exhibits/robe/baked" / name for h in (whole, broken))
        assert first.read_bytes() == second.read_bytes()
