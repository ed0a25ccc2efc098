"""`simcore`: commands, one-line errors, exit status, lazy names."""

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import sim_core
from sim_core import cli

REPO = Path(__file__).parents[2]
SQUARE = {"outline": [[0, 0], [1, 0], [1, 1], [0, 1]], "holes": [[[0.4, 0.4], [0.6, 0.4], [0.5, 0.6]]]}


@pytest.fixture
def outline(tmp_path):
    path = tmp_path / "panel.json"
    path.write_text(json.dumps(SQUARE), "utf-8")
    return path


def test_every_public_name_resolves():
    for name in sim_core.__all__:
        assert getattr(sim_core, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'loom'"):
        sim_core.loom  # noqa: B018


def test_importing_sim_core_loads_no_engine():
    code = "import sim_core, sys; print(sorted({'numba', 'numpy', 'scipy', 'pydantic', 'torch'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=REPO, check=True)
    assert done.stdout.strip() == "[]"


def test_help_names_every_room_and_exits_with_0(capsys):
    with pytest.raises(SystemExit) as caught:
        cli.main(["--help"])
    assert caught.value.code == 0
    text = capsys.readouterr().out
    assert all(word in text for word in (*cli.ROOMS, "bench", "Exit status"))


@pytest.mark.parametrize("words", [[], ["knit"], ["mesh", "x.json"], ["bench", "hall"]])
def test_wrong_arguments_exit_with_2(words, capsys):
    with pytest.raises(SystemExit) as caught:
        sys.exit(cli.main(words))
    assert caught.value.code == 2
    assert re.search("^(usage: simcore|simcore mesh: --edge: missing)", capsys.readouterr().err, re.MULTILINE)


@pytest.mark.parametrize("kind", [".npz", ".ply", ".obj"])
def test_mesh_writes_files_and_summary(outline, tmp_path, capsys, kind):
    out, picture = tmp_path / f"mesh{kind}", tmp_path / "mesh.png"
    words = ["mesh", str(outline), "--edge", "0.1", "--out", str(out), "--picture", str(picture), "--json"]
    assert cli.main(words) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["conformity"] == 1
    assert summary["area_error"] <= 1e-12
    assert {"mean", "worst"} == set(summary["quality"]) == set(summary["edge_ratio"])
    assert {"seconds", "compile_seconds", "min_angle_deg", "outline_deviation"} <= set(summary)
    if kind == ".npz":
        with np.load(out) as stored:
            assert stored["faces"].shape == (summary["faces"], 3)
            assert stored["vertices"].shape == (summary["vertices"], 2)
    else:
        import trimesh

        mesh = trimesh.load(out, process=False)
        assert len(mesh.faces) == summary["faces"]
        assert mesh.area == pytest.approx(1 - 0.02, rel=1e-6)
        assert (mesh.face_normals[:, 2] > 0.99).all()
    assert np.asarray(Image.open(picture)).std() > 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "empty"),
        ("{", "not valid JSON"),
        ("[]", "outline: missing"),
        ('{"outline": [[0,0],[1,0],[0,1]], "hole": []}', "hole: unknown key"),
        ('{"outline": [[0,0],[1,1],[1,0],[0,1]]}', "crosses"),
        ('{"outline": []}', "0 points"),
        ('{"outline": 3}', "shape"),
    ],
)
def test_bad_outline_files_give_one_line_and_exit_with_1(tmp_path, capsys, text, message):
    path = tmp_path / "bad.json"
    path.write_text(text, "utf-8")
    assert cli.main(["mesh", str(path), "--edge", "0.1"]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert message in error
    assert "bad.json" in error


def test_missing_file_and_unknown_kind_of_file(outline, tmp_path, capsys):
    assert cli.main(["mesh", str(tmp_path / "none.json"), "--edge", "0.1"]) == 1
    assert "none.json" in capsys.readouterr().err
    with pytest.raises(SystemExit) as caught:
        cli.main(["mesh", str(outline), "--edge", "0.1", "--out", str(tmp_path / "mesh.stl")])
    assert caught.value.code == 2
    assert ".ply" in capsys.readouterr().err


def test_debug_shows_the_traceback(tmp_path):
    with pytest.raises(sim_core.SimCoreError):
        cli.main(["--debug", "mesh", str(tmp_path / "none.json"), "--edge", "0.1"])


KEYS = {
    "repeat", "face", "floats", "interlacings", "integral", "crimp", "thickness", "height", "areal_density",
    "openness", "residual", "penetration", "penetration_of", "seconds", "parameters",
    "compression", "bending", "shear", "tensile", "published",
}  # fmt: skip


@pytest.mark.parametrize("relax", [[], ["--relax"]])
def test_weave_writes_maps_yarns_wif_and_summary(tmp_path, capsys, relax):
    import trimesh

    yarns, wif, maps = tmp_path / "y.glb", tmp_path / "d.wif", tmp_path / "maps"
    words = [
        "weave",
        "twill:2/1",
        *relax,
        "--maps",
        str(maps),
        "--size",
        "64",
        "--yarns",
        str(yarns),
        "--wif",
        str(wif),
    ]
    assert cli.main([*words, "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert set(summary) == KEYS
    assert summary["repeat"] == {"ends": 3, "picks": 3}
    assert (summary["face"], summary["interlacings"], summary["integral"]) == ("warp", 12, True)
    assert summary["floats"] == {"warp": {"longest": 2, "mean": 1.5}, "weft": {"longest": 2, "mean": 1.5}}
    assert 0 < summary["crimp"]["warp"] < 0.2
    assert summary["penetration"] <= 5e-4
    assert summary["residual"] <= 1e-3
    stored = json.loads((maps / "parameters.json").read_text("utf-8"))
    assert {key: stored[key] for key in KEYS} == summary
    for name in ("albedo", "normal", "height", "roughness", "direction", "opacity", "yarn", "lit"):
        assert np.asarray(Image.open(maps / f"{name}.png")).shape[:2] == (64, 64)
    scene = trimesh.load(yarns)
    assert scene.extents[2] == pytest.approx(summary["height"], rel=0.02)
    assert cli.main(["weave", str(wif), "--json"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert again["floats"] == summary["floats"]


@pytest.mark.parametrize("name", ["glass-7628", "polyester-190-31"])
@pytest.mark.parametrize("stage", [[], ["--relax"]])
def test_weight_and_thickness_of_cloths_that_are_told_whole(name, stage, capsys):
    """Of which sett, yarn, weight and thickness can be read together: within 5 and 20 per cent, nothing fitted."""
    assert cli.main(["weave", str(REPO / f"tests/bench/cited/{name}.toml"), *stage, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)["published"]
    assert abs(told["areal_density"]["off"]) <= 0.05
    assert abs(told["thickness"]["off"]) <= 0.20


def test_weave_tells_what_is_published_beside_what_it_reckons(tmp_path, capsys):
    """Inside the range that a source tells nothing is off; what it does not tell has no source."""
    text = (REPO / "assets/weaves/gauze.toml").read_text("utf-8")
    table = '[published]\nsource = "a bolt"\nareal_density = [0.010, 0.0154]\nopenness = 0.9\n\n[draft]'
    yarns, weaving = text.partition("[published]")[0], text.partition("[draft]")[2]
    (tmp_path / "gauze.toml").write_text(yarns + table + weaving, "utf-8")
    assert cli.main(["weave", str(tmp_path / "gauze.toml"), "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    told = summary["published"]
    assert told["source"] == "a bolt"
    assert told["areal_density"] == {"value": [0.01, 0.0154], "ours": summary["areal_density"], "off": 0.0}
    assert told["openness"]["off"] == pytest.approx(summary["openness"] / 0.9 - 1)
    assert {told[name] for name in ("thickness", "bending", "shear", "tensile")} == {"no source"}
    assert cli.main(["weave", str(tmp_path / "gauze.toml")]) == 0
    out = capsys.readouterr().out
    assert "0.01 to 0.0154 published" in out
    assert "no source of thickness, bending, shear, tensile" in out
    assert "gf/(cm deg)" in out


def test_weave_takes_a_picture_of_a_motif_and_our_json(tmp_path, capsys):
    from sim_core.weave import draft_to_dict
    from sim_core.weave.draft import gauze

    motif = np.full((20, 20, 3), 255, np.uint8)
    motif[5:15, 5:15] = 0
    Image.fromarray(motif).save(tmp_path / "motif.png")
    assert cli.main(["weave", str(tmp_path / "motif.png"), "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["repeat"] == {"ends": 20, "picks": 20}
    assert max(summary["floats"][side]["longest"] for side in ("warp", "weft")) <= 8
    (tmp_path / "sha.json").write_text(json.dumps(draft_to_dict(gauze())), "utf-8")
    assert cli.main(["weave", str(tmp_path / "sha.json"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["integral"] is True


def test_weave_text_and_broken_file(tmp_path, capsys):
    assert cli.main(["weave", str(REPO / "assets" / "weaves" / "satin.toml")]) == 0
    assert "N/m" in capsys.readouterr().out
    (tmp_path / "blank.png").write_bytes(b"x")
    (tmp_path / "bad.toml").touch()
    (tmp_path / "bad.json").write_text('{"lift": [[1, 2]]}', "utf-8")
    (tmp_path / "bad.wif").write_text("[WIF]\nVersion=1.1\n", "utf-8")
    for source in ("blank.png", "bad.toml", "bad.json", "bad.wif", "none.wif", "none.png"):
        assert cli.main(["weave", str(tmp_path / source)]) == 1
        told = capsys.readouterr().err
        assert told.count("\n") == 1
        assert source in told
    assert cli.main(["weave", "satin:8/2"]) == 1
    assert "shares a factor" in capsys.readouterr().err


def test_bench_outside_a_checkout_exits_with_2(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(cli, "__file__", str(tmp_path / "sim_core" / "cli.py"))
    assert cli.main(["bench", "mesh"]) == 2
    assert "checkout" in capsys.readouterr().err
