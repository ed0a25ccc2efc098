"""A scan in a running hall: told and shown in both languages; its own files are handed to nobody."""

from __future__ import annotations

import json
import shutil
import time
import urllib.error
import urllib.request
from contextlib import closing

import pytest
from content_house import edit
from running_hall import running_hall, wait_for_exhibit
from scanned_hall import write_scanned_hall

from hall_app.content import load
from hall_app.content.models import read_glb
from hall_app.content.views import is_source


def get(url: str) -> bytes:
    with closing(urllib.request.urlopen(url, timeout=60)) as answer:
        return answer.read()


def status(url: str) -> int:
    try:
        with closing(urllib.request.urlopen(url, timeout=60)) as answer:
            return answer.status
    except urllib.error.HTTPError as error:
        return error.code


def test_it_shows_what_was_measured(scanned_hall):
    shown = json.loads(get(f"{scanned_hall.url}/api/exhibits/robe"))
    assert shown["scanned"]
    assert shown["has_close"]
    labels = [line["label"]["en"] for line in shown["measured"]]
    assert "Close-up model, deviation, 99th percentile" in labels


@pytest.mark.nightly
def test_an_open_hall_bakes_it_by_itself(tmp_path):
    content = write_scanned_hall(tmp_path / "content")
    with running_hall(content, tmp_path) as hall:
        wait_for_exhibit(hall, "robe")
        record = json.loads(next((hall.data / "bakes").rglob("bake.json")).read_text("utf-8"))
    brought = (content / "exhibits/robe/scan/robe.obj").read_text("utf-8").count("\nf ")
    assert 0.95 * brought < record["errors"]["scan_triangles"] <= brought
    for name in ("hall", "close"):
        told = record["scan"][name]
        assert told["deviation"]["p99_m"] <= told["budget_m"]


def test_a_licensed_model_is_offered_and_it_is_a_scans(scanned_hall, tmp_path):
    path = tmp_path / "robe.glb"
    path.write_bytes(get(f"{scanned_hall.url}/collection/robe/model.glb"))
    assert read_glb(path).triangles <= 80_000
    told = get(f"{scanned_hall.url}/oai?verb=ListIdentifiers&metadataPrefix=oai_dc&set=scanned").decode()
    assert "robe" in told
    assert "box" not in told


@pytest.mark.parametrize("lang", ["zh", "en"])
def test_the_catalogue_tells_it(scanned_hall, lang):
    page = get(f"{scanned_hall.url}/catalogue?lang={lang}").decode()
    assert {"zh": "扫描与测量", "en": "Scanned and measured"}[lang] in page
    assert {"zh": "近观模型平均偏差", "en": "Close-up model, mean deviation"}[lang] in page


@pytest.mark.parametrize("name", ["robe.obj", "robe.mtl", "robe.jpg"])
@pytest.mark.parametrize("door", ["media", "thumbnails"])
def test_its_files_are_handed_to_nobody(scanned_hall, door, name):
    assert (scanned_hall.content / "exhibits/robe/scan" / name).is_file()
    assert status(f"{scanned_hall.url}/{door}/robe/scan/{name}") == 404


def test_what_an_exhibit_shows_itself_is_no_source(scanned_hall, tmp_path):
    """A scan's picture is hidden, until a table or a text shows it; another exhibit's folder hides it no less."""
    folder = tmp_path / "content"
    shutil.copytree(scanned_hall.content, folder)
    home = folder / "exhibits/robe"
    picture = (home / "scan/robe.jpg").resolve()
    assert is_source(load(folder), picture)
    assert is_source(load(folder), (home / "scan/robe.obj").resolve())
    assert not is_source(load(folder), (folder / "exhibits/box/box.png").resolve())
    (home / "text.en.md").write_text("![How it was scanned](scan/robe.jpg)", "utf-8")
    assert not is_source(load(folder), picture)
    (home / "text.en.md").write_text("A robe.", "utf-8")
    shutil.move(home / "scan/robe.jpg", folder / "exhibits/box/robe.jpg")
    edit(home / "scan/robe.mtl", "robe.jpg", "../../box/robe.jpg")
    assert is_source(load(folder), (folder / "exhibits/box/robe.jpg").resolve())


def test_a_scan_that_is_spoilt_leaves_its_last_model_on_show(scanned_hall):
    """And the log says which file is at fault, and what to do."""
    path = scanned_hall.content / "exhibits/robe/scan/robe.obj"
    kept = path.read_bytes()
    path.write_text("Dear curator, here is the scan.\n", "utf-8")
    try:
        end = time.monotonic() + 240
        while "mesh it in the scanning software" not in scanned_hall.said():
            assert time.monotonic() < end, scanned_hall.said()[-2000:]
            time.sleep(0.5)
        assert "robe" in [one["id"] for one in json.loads(get(f"{scanned_hall.url}/api/scene"))["exhibits"]]
        assert status(f"{scanned_hall.url}/collection/robe/model.glb") == 200
    finally:
        path.write_bytes(kept)
