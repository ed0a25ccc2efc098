"""`hall build` as a curator uses it, on a coarse mesh: whole, up to date, interrupted, faulty, filmed."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from coarse_bake import LAYERED, build, build_command, coarse, last_line
from content_house import edit
from PIL import Image

from hall_app.build import (
    SOUND_RATE,
    Look,
    Part,
    Piece,
    TrailLostError,
    Trails,
    Wardrobe,
    budget,
    encode_film,
    film_possible,
    filming,
    refuse_disorder,
)
from hall_app.check import check
from hall_app.check.garments import measured_again
from hall_app.content import load
from hall_app.content.bakes import bake_folder, bake_key, layer_files, read_record
from hall_app.content.models import open_glb, read_glb
from sim_core.body import Pose
from sim_core.errors import SimCoreError
from sim_core.garment import Frame, Garment, load_outfit

ASSETS = Path(__file__).parents[2] / "assets"

pytestmark = pytest.mark.slow


@pytest.fixture
def folder(tmp_path):
    return coarse(tmp_path)


@pytest.mark.door
def test_build_is_whole_and_up_to_date(coarse_scarf):
    folder, first = coarse_scarf
    baked = folder / "exhibits" / "pibo" / "baked"
    assert first["state"] == "baked"
    assert {"garment.npz", "hall.glb", "close.glb", "bake.json", "drape.jpg"} <= {
        p.name for p in baked.iterdir()
    }
    garment = Garment.load(baked / "garment.npz")
    assert garment.digest() == first["digest"]
    assert [first["errors"][f"inside_{what}"] for what in ("vertices", "midpoints", "centroids")] == [0, 0, 0]
    hall, afar = read_glb(baked / "hall.glb"), first["afar"]
    assert (
        hall.afar == afar["triangles"] < first["errors"]["hall_all_triangles"] == hall.triangles - hall.afar
    )
    assert afar["from_m"] == pytest.approx(3 * 1.3)  # as near as it is seen
    assert afar["hausdorff_p99_m"] <= 3 * first["hall_budget_m"]
    low, high = read_glb(baked / "close.glb").low, read_glb(baked / "close.glb").high
    assert 1.2 < high[1] - low[1] < 2.0
    toml = "exhibits/pibo/exhibit.toml"  # the other garments of the folder are not built here
    missing = [problem.what for problem in check(folder) if problem.file == toml and problem.key == "outfit"]
    assert all(what.startswith("baked/drape.") for what in missing), (
        missing
    )  # the film, which was not asked for
    assert last_line(build(folder))["state"] == "up to date"


def test_what_is_shown_otherwise_is_not_dressed_again(coarse_scarf, tmp_path):
    folder = tmp_path / "content"
    shutil.copytree(coarse_scarf[0], folder)
    first, baked = coarse_scarf[1], folder / "exhibits" / "pibo" / "baked"
    files = {path.name: path.read_bytes() for path in baked.iterdir() if path.suffix in (".npz", ".jpg")}
    shown = folder / "exhibits" / "pibo" / "exhibit.toml"
    edit(shown, "hall_error_px = 2.5", "hall_error_px = 20.0")
    second = last_line(build(folder))
    assert (second["state"], second["digest"]) == ("baked", first["digest"])
    assert second["key"] != first["key"]
    assert second["seconds"]["drape"] == first["seconds"]["drape"]  # what it took when it was dressed
    assert second["errors"]["hall_triangles"] < first["errors"]["hall_triangles"]
    assert {name: (baked / name).read_bytes() for name in files} == files
    assert bake_folder(load(folder), load(folder).exhibit("pibo"), folder, stale=False) is not None


@pytest.mark.nightly
def test_a_build_by_force_is_equal_to_the_bit(coarse_scarf):
    folder, first = coarse_scarf
    baked = folder / "exhibits" / "pibo" / "baked"
    models = {name: (baked / name).read_bytes() for name in ("hall.glb", "close.glb")}
    again = last_line(build(folder, "--force"))
    assert again["digest"] == first["digest"]
    assert {name: (baked / name).read_bytes() for name in models} == models


def test_a_changed_pattern_makes_the_bake_stale(coarse_scarf, tmp_path):
    folder = tmp_path / "content"
    shutil.copytree(coarse_scarf[0], folder)
    content = load(folder)
    exhibit = content.exhibit("pibo")
    assert bake_folder(content, exhibit, folder, stale=False) is not None
    before = bake_key(content, exhibit)
    pattern = folder / "patterns" / "pibo.toml"
    pattern.write_text(pattern.read_text("utf-8").replace("2.4]", "2.3]"), "utf-8")
    assert bake_key(content, exhibit) != before
    assert bake_folder(content, exhibit, folder, stale=False) is None
    assert bake_folder(content, exhibit, folder) is not None  # the last one stays on show
    assert [problem for problem in check(folder) if "hall build" in problem.fix]


@pytest.mark.nightly
def test_an_interrupted_build_goes_on_to_the_same_bits(folder):
    # Fine enough to run longer than to its first checkpoint.
    edit(folder / "outfits/pibo.toml", "edge = 0.06", "edge = 0.025")
    whole = last_line(build(folder, "--into-data"))
    data = folder.parent / "data"
    shutil.rmtree(data / "bakes")
    state = data / "bake-work" / f"pibo-{whole['key']}" / "dress"
    with subprocess.Popen(
        build_command(folder, "--into-data"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    ) as process:
        end = time.monotonic() + 120
        while not list(state.glob("state.npz*")) and process.poll() is None and time.monotonic() < end:
            time.sleep(0.02)
        assert list(state.glob("state.npz*"))
        os.kill(process.pid, signal.SIGKILL)
    assert read_record(data / "bakes" / f"pibo-{whole['key']}") is None  # half a bake is none
    resumed = last_line(build(folder, "--into-data"))
    assert resumed["state"] == "baked"
    assert resumed["digest"] == whole["digest"]
    assert not state.parent.exists()


@pytest.mark.parametrize(
    ("file", "text", "words"),
    [
        ("patterns/pibo.toml", "", "patterns/pibo.toml"),
        ("patterns/pibo.toml", "name = ", "patterns/pibo.toml"),
        (
            "patterns/pibo.toml",
            'name = "x"\ntitle = { zh = "x", en = "x" }\nedge = 0.05\noutline = [[0, 0], [1, 1], [1, 0], [0, 1]]\n',
            "cross",
        ),
        ("weaves/gauze.toml", "", "weaves/gauze.toml"),
        ("outfits/pibo.toml", "", "outfits/pibo.toml"),
        ("outfits/pibo.toml", "[stand]\n[[layer]]\nseed = -1\n", "layer.1.pattern"),
        ("outfits/pibo.toml", "stand = 3\n", "outfits/pibo.toml: stand"),
    ],
    ids=[
        "0-byte pattern",
        "broken pattern",
        "outline that crosses itself",
        "0-byte weave",
        "0-byte outfit",
        "layer without a pattern",
        "outfit of another shape",
    ],
)
def test_faulty_input_is_one_clear_line(folder, file, text, words):
    (folder / file).write_text(text, "utf-8")
    done = build(folder)
    assert done.returncode == 1
    [line] = done.stderr.strip().splitlines()
    assert words in line
    assert "Traceback" not in line


@pytest.mark.parametrize("name", ["nobody", "mirror"])
def test_only_garments_are_baked(folder, name):
    done = build(folder, exhibit=name)
    assert done.returncode == 1
    assert name in done.stderr


@pytest.mark.nightly
def test_layers_are_baked_from_the_skin_outwards_and_measured_again(coarse_layers):
    folder, record = coarse_layers
    baked = folder / "exhibits/pibo-figure/baked"
    assert [layer["name"] for layer in record["layers"]] == ["robe", "pibo"]
    garments = [Garment.load(baked / name) for name in layer_files(2)]
    assert [garment.digest() for garment in garments] == [layer["digest"] for layer in record["layers"]]
    again = measured_again(baked, 2)
    assert [worn.name for worn in again.worn] == ["robe", "pibo"]
    assert again.faults == ()
    for name in ("inside_vertices", "self_intersections", "area_strain_max"):
        assert again.figures[name] == pytest.approx(record["errors"][name])
        assert again.figures[f"robe_{name}"] == pytest.approx(record["errors"][f"robe_{name}"])
    names = {str(node.get("name")) for node in open_glb(baked / "hall.glb").document["nodes"]}
    assert {"robe", "pibo", "figure", "base"} <= names


@pytest.mark.nightly
@pytest.mark.skipif(not film_possible(), reason="films need PyAV")
def test_the_film_shows_the_outermost_layer_over_what_is_worn_beneath(coarse_layers, tmp_path):
    folder = tmp_path / "content"
    shutil.copytree(coarse_layers[0], folder, ignore=shutil.ignore_patterns("baked"))
    record = last_line(build(folder, exhibit=LAYERED, film=True))
    assert record["digest"] == coarse_layers[1]["digest"], "to be filmed changes nothing"
    assert {"drape.webm", "drape.mp4"} <= {
        path.name for path in (folder / f"exhibits/{LAYERED}/baked").iterdir()
    }


def test_a_film_begins_with_the_garment_and_its_belt_follows():
    for name, begins in (("ming-yuanling", 0), ("han-gown", 1), ("ming-mamian", 2)):
        outfit = load_outfit(ASSETS / f"outfits/{name}.toml", ASSETS)
        assert Wardrobe(outfit).filmed == begins, name
    told = [replace(layer, accessory=k > 0) for k, layer in enumerate(outfit.layers)]
    assert Wardrobe(replace(outfit, layers=tuple(told))).filmed == 0, "an outfit may tell its accessories"


def test_what_is_not_worn_yet_is_not_in_the_picture(tmp_path):
    corners = np.array([[-0.3, 0.2, 0.0], [0.3, 0.2, 0.0], [0.0, 0.9, 0.0]])
    sheet = Piece(corners, (Part(np.array([[0, 1, 2]], np.int32), (0.9, 0.1, 0.1)),))
    clothed = replace(sheet, vertices=corners + [0.0, 0.0, 0.05])
    with filming(Look((clothed, sheet), 1.0), tmp_path) as film:
        film.shoot([None, corners])
        film.shoot([corners + [0.0, 5.0, 0.0], corners])  # worn, and out of sight
        film.shoot([corners + [0.0, 0.0, 0.05], corners])
        film.walk_round([clothed.vertices, corners])
        film.wait(lambda share: None)
    bare, away, worn = (np.asarray(Image.open(tmp_path / f"{k:05d}.png")).astype(int) for k in range(3))
    assert np.abs(bare - worn).max() > 20
    assert np.abs(bare - away).mean() < 1.0


def test_what_nobody_sees_move_is_no_picture_of_its_own(tmp_path, monkeypatch):
    monkeypatch.setattr("hall_app.build.film.ROUND", 1)
    corners = np.array([[-0.3, 0.2, 0.0], [0.3, 0.2, 0.0], [0.0, 0.9, 0.0]])
    sheet = Piece(corners, (Part(np.array([[0, 1, 2]], np.int32), (0.9, 0.1, 0.1)),))

    def pictures(folder: Path, steps: list[float]) -> int:
        with filming(Look((sheet,), 1.0), folder) as film:
            for at in np.cumsum(steps):
                film.shoot([corners + [0.0, at, 0.0]])
            film.walk_round([corners + [0.0, sum(steps), 0.0]])
            film.wait(lambda share: None)
        return len(list(folder.glob("*.png"))) - 1

    assert pictures(tmp_path / "falls", [0.01] * 9) == 9
    assert pictures(tmp_path / "rests", [0.01, *[0.0] * 40]) == 1
    assert 3 <= pictures(tmp_path / "creeps", [0.0001] * 50) <= 5  # 5 mm, at half a pixel or more a picture


def test_backs_are_lit_as_fronts_are(tmp_path):
    turn, high = np.meshgrid(np.linspace(0, 2 * np.pi, 73)[:-1], np.linspace(0.0, 1.2, 13))
    drum = np.stack([0.3 * np.sin(turn), high, 0.3 * np.cos(turn)], 2).reshape(-1, 3)
    a = (np.arange(12)[:, None] * 72 + np.arange(72)).ravel()
    b = (np.arange(12)[:, None] * 72 + (np.arange(72) + 1) % 72).ravel()
    faces = np.concatenate([np.stack([a, b, b + 72], 1), np.stack([a, b + 72, a + 72], 1)]).astype(np.int32)
    look = Look((Piece(drum, (Part(faces, (0.6, 0.5, 0.4)),)),), 1.2)
    with filming(look, tmp_path) as film:
        film.stills(look, tmp_path)
        film.wait(lambda share: None)
    shown = {
        name: np.asarray(Image.open(tmp_path / f"still-{name}.jpg").convert("L")).astype(float)
        for name in ("front", "side", "back")
    }
    middle = {name: picture[400:700, 300:600] for name, picture in shown.items()}
    assert np.ptp(middle["front"].mean(0)) > 20  # the lamp stands aside: one flank is brighter
    for name in ("side", "back"):
        assert np.abs(middle[name] - middle["front"]).mean() < 2.0


@pytest.mark.nightly
@pytest.mark.skipif(not film_possible(), reason="films need PyAV")
def test_the_film_of_a_belted_dress_shows_both(tmp_path):
    import av

    folder = coarse(tmp_path)
    outfit = folder / f"outfits/{LAYERED}.toml"
    bodice = (ASSETS / "outfits/ming-mamian.toml").read_text("utf-8").split("[[layer]]")[1]
    belt = (ASSETS / "outfits/ming-yuanling.toml").read_text("utf-8").split("[[layer]]")[-1]
    head = outfit.read_text("utf-8").split("[[layer]]")[0]
    outfit.write_text("[[layer]]".join([head, bodice.replace("0.022", "0.05"), belt]), "utf-8")
    last_line(build(folder, exhibit=LAYERED, film=True))
    baked = folder / f"exhibits/{LAYERED}/baked"
    shown = [Garment.load(baked / name).provenance["simulated"] for name in layer_files(2)]
    with av.open(str(baked / "drape.mp4")) as film:
        pictures = sum(1 for _ in film.decode(video=0))
    dress, belt = (25 * seconds for seconds in shown)
    assert belt < pictures - 75 <= round(dress + belt)  # and once round; less what nobody sees move


def test_pattern_sheets_are_drawn_for_all_or_for_one(folder):
    command = [sys.executable, "-m", "hall_app", "build", "--pattern", "--content", str(folder)]
    for more, drawn in ((["--exhibit", "pibo"], {"pibo"}), ([], {"pibo", "pibo-figure"})):
        done = subprocess.run([*command, *more], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        assert {path.parts[-3] for path in folder.glob("exhibits/*/media/pattern.svg")} == drawn
    assert not list(folder.glob("exhibits/*/baked"))
    mirror = folder / "exhibits/mirror/media/pattern.svg"  # of an exhibit without an outfit: nobody draws it
    shutil.copyfile(folder / "exhibits/pibo/media/pattern.svg", mirror)
    checked = subprocess.run(
        [sys.executable, "-m", "hall_app", "check", str(folder), "--json"], capture_output=True, text=True
    )
    unused = [
        problem["file"] for problem in json.loads(checked.stdout)["problems"] if "not used" in problem["what"]
    ]
    assert unused == ["exhibits/mirror/media/pattern.svg"], (
        "a sheet belongs to its exhibit, shown by its text or not"
    )


def test_what_is_worn_beneath_is_filmed_as_it_was_in_that_pose(tmp_path):
    half, down = Pose.arms(20.0), Pose.arms(45.0)
    told = [(0, Pose()), (0, Pose()), (0, half), (0, down), (0, down), (1, Pose()), (1, half)]
    frames = [Frame(layer, np.full((2, 3), k, np.float32), pose) for k, (layer, pose) in enumerate(told)]
    trails = Trails(tmp_path)
    for frame in frames:
        trails.hear(frame)

    def shown(trails: Trails, layer: int, pose: Pose) -> list[float]:
        return [float(positions[0, 0]) for positions in trails.beneath(layer, pose)]

    assert shown(trails, 1, Pose()) == [1.0], "of frames in one pose the last: it has been sewn by then"
    assert shown(trails, 1, Pose.arms(22.0)) == [2.0]
    assert shown(trails, 2, down) == [6.0, 4.0], "the outermost first"
    assert trails.beneath(0, down) == []
    assert shown(Trails(tmp_path), 2, half) == [6.0, 2.0], "an interrupted bake finds them again"
    with pytest.raises(TrailLostError, match="layer 3"):
        Trails(tmp_path).beneath(3, half)


def test_budget_is_a_pixel_at_the_nearest_view():
    # 1080 pixels over 58 degrees: 1.03 mm a pixel from one metre.
    assert budget(1.0, 1.0) == pytest.approx(2 * np.tan(np.radians(29)) / 1080)
    assert budget(2.0, 3.0) == pytest.approx(6 * budget(1.0, 1.0))


def test_cloth_that_lies_under_what_it_should_lie_over_fails_a_bake(coarse_scarf):
    baked = coarse_scarf[0] / "exhibits/pibo/baked"
    (name,) = layer_files(1)
    scarf = Garment.load(baked / name)
    refuse_disorder([scarf])
    errors = {**scarf.provenance["errors"], "layer_order": 3}
    with pytest.raises(
        SimCoreError, match="pibo: 3 vertices lie under the front they should lie over – raise"
    ):
        refuse_disorder([scarf, scarf.noted(errors=errors)])


@pytest.mark.skipif(not film_possible(), reason="films need PyAV")
@pytest.mark.parametrize(("ending", "codecs"), [(".webm", ("vp9", "opus")), (".mp4", ("h264", "aac"))])
def test_films_are_what_browsers_play(tmp_path, ending, codecs):
    import av

    rng = np.random.default_rng(1)
    tone = (0.2 * rng.standard_normal(SOUND_RATE * 3)).astype(np.float32)
    pictures = [np.full((90, 160, 3), value, np.uint8) for value in range(0, 200, 8)]
    path = tmp_path / f"film{ending}"
    encode_film(path, pictures.__getitem__, len(pictures), sound=tone)
    with av.open(str(path)) as film:
        assert film.streams.video[0].codec_context.name.removeprefix("lib").startswith(codecs[0][:3])
        assert film.streams.audio[0].codec_context.name.removeprefix("lib").startswith(codecs[1])
        shown = [frame.to_ndarray(format="rgb24").mean() for frame in film.decode(video=0)]
    assert len(shown) == len(pictures)
    assert np.abs(np.array(shown) - [picture.mean() for picture in pictures]).max() < 4
    assert list(tmp_path.iterdir()) == [path]  # nothing half-written is left
