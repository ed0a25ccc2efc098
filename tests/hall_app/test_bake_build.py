"""`hall build` as a curator uses it, on a coarse mesh: whole, up to date, interrupted, faulty, filmed."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from hall_app.build import SOUND_RATE, budget, encode_film, film_possible
from hall_app.check import check
from hall_app.content import load
from hall_app.content.bakes import bake_folder, bake_key, read_record
from hall_app.content.models import read_glb
from sim_core.garment import Garment

ASSETS = Path(__file__).parents[2] / "assets"

pytestmark = pytest.mark.slow


def coarse(place: Path) -> Path:
    """The shipped content with a coarse scarf that has not been baked."""
    home = place / "content"
    shutil.copytree(ASSETS, home, ignore=shutil.ignore_patterns("baked"))
    shutil.rmtree(home / "exhibits" / "beizi")  # a minute of its own: tests/sim_core/test_garment_robe.py
    toml = home / "exhibits" / "pibo" / "exhibit.toml"
    lines = toml.read_text("utf-8").splitlines()
    lines = ["edge = 0.06" if line.startswith("edge = ") else line for line in lines]
    toml.write_text("\n".join(lines) + "\n", "utf-8")
    return home


@pytest.fixture
def folder(tmp_path):
    return coarse(tmp_path)


def build(folder: Path, *options: str, **more) -> subprocess.CompletedProcess[str]:
    """`hall build` of one garment (the room's light would take longer than all of these tests)."""
    which = () if "--exhibit" in options else ("--exhibit", "pibo")
    command = [
        sys.executable,
        "-m",
        "hall_app",
        "build",
        "--content",
        folder,
        "--data",
        folder.parent / "data",
    ]
    return subprocess.run(
        [*command, "--no-film", "--json", *which, *options], capture_output=True, text=True, **more
    )


def last_line(done: subprocess.CompletedProcess[str]) -> dict:
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.strip().splitlines()[-1])


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The folder with its scarf baked once for all tests that only look at it, and what the command said."""
    home = coarse(tmp_path_factory.mktemp("built"))
    return home, last_line(build(home))


def test_build_is_whole_and_up_to_date(built):
    folder, first = built
    baked = folder / "exhibits" / "pibo" / "baked"
    assert first["state"] == "baked"
    assert {"garment.npz", "hall.glb", "close.glb", "bake.json", "drape.jpg"} <= {
        p.name for p in baked.iterdir()
    }
    garment = Garment.load(baked / "garment.npz")
    assert garment.digest() == first["digest"]
    assert [first["errors"][f"inside_{what}"] for what in ("vertices", "midpoints", "centroids")] == [0, 0, 0]
    low, high = read_glb(baked / "close.glb").low, read_glb(baked / "close.glb").high
    assert 1.2 < high[1] - low[1] < 2.0
    toml = "exhibits/pibo/exhibit.toml"  # the other garments of the folder are not built here
    missing = [problem.what for problem in check(folder) if problem.file == toml and problem.key == "garment"]
    assert all(what.startswith("baked/drape.") for what in missing), (
        missing
    )  # the film, which was not asked for
    assert last_line(build(folder))["state"] == "up to date"


@pytest.mark.nightly
def test_a_build_by_force_is_equal_to_the_bit(built):
    folder, first = built
    baked = folder / "exhibits" / "pibo" / "baked"
    models = {name: (baked / name).read_bytes() for name in ("hall.glb", "close.glb")}
    again = last_line(build(folder, "--force"))
    assert again["digest"] == first["digest"]
    assert {name: (baked / name).read_bytes() for name in models} == models


def test_a_changed_pattern_makes_the_bake_stale(built, tmp_path):
    folder = tmp_path / "content"
    shutil.copytree(built[0], folder)
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
    toml = (
        folder / "exhibits" / "pibo" / "exhibit.toml"
    )  # fine enough to run longer than to its first checkpoint
    toml.write_text(toml.read_text("utf-8").replace("edge = 0.06", "edge = 0.025"), "utf-8")
    whole = last_line(build(folder, "--into-data"))
    data = folder.parent / "data"
    shutil.rmtree(data / "bakes")
    command = [
        sys.executable,
        "-m",
        "hall_app",
        "build",
        "--content",
        folder,
        "--data",
        data,
        "--no-film",
        "--json",
    ]
    state = data / "bake-work" / f"pibo-{whole['key']}" / "drape.npz"
    with subprocess.Popen(
        [*command, "--exhibit", "pibo", "--into-data"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    ) as process:
        end = time.monotonic() + 120
        while not state.is_file() and process.poll() is None and time.monotonic() < end:
            time.sleep(0.02)
        assert state.is_file()
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
    ],
    ids=["0-byte pattern", "broken pattern", "outline that crosses itself", "0-byte weave"],
)
def test_faulty_input_is_one_clear_line(folder, file, text, words):
    (folder / file).write_text(text, "utf-8")
    done = build(folder, "--exhibit", "pibo")
    assert done.returncode == 1
    [line] = done.stderr.strip().splitlines()
    assert words in line
    assert "Traceback" not in line


@pytest.mark.parametrize("name", ["nobody", "mirror"])
def test_only_garments_are_baked(folder, name):
    done = build(folder, "--exhibit", name)
    assert done.returncode == 1
    assert name in done.stderr


def test_budget_is_a_pixel_at_the_nearest_view():
    # 1080 pixels over 58 degrees: 1.03 mm a pixel from one metre.
    assert budget(1.0, 1.0) == pytest.approx(2 * np.tan(np.radians(29)) / 1080)
    assert budget(2.0, 3.0) == pytest.approx(6 * budget(1.0, 1.0))


@pytest.mark.skipif(not film_possible(), reason="films need PyAV (extra 'bake')")
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
