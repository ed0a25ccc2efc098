"""What stands near the entrance comes before a visitor can enter, what else the hall holds while he walks."""

from __future__ import annotations

import json
import shutil
import struct
import time
import urllib.request
from pathlib import Path

import pytest
import trimesh
from bench.browser import CHOOSE, enter
from bench.wire import wire
from plain_hall import EXHIBIT, write_plain_hall
from running_hall import running_hall

pytestmark = pytest.mark.browser

BOX = "/exhibits/box"  # aside of where a visitor looks first
FARTHEST = "/exhibits/crate-10"
STANDS = """(node) => {
  let meshes = 0;
  window.__viserMutable?.nodeRefFromName?.[node]?.traverse((child) => { meshes += child.isMesh ? 1 : 0; });
  return meshes > 0;
}"""
CENTRE = """async (node) => {
  const { meshesOf } = await import("/static/viser/viser_adapter.js");
  const { renderer, camera } = window.__viserMutable, mesh = meshesOf(node)[0];
  mesh.geometry.computeBoundingBox();
  const middle = mesh.geometry.boundingBox.getCenter(mesh.position.clone());
  const seen = middle.applyMatrix4(mesh.matrixWorld).project(camera);
  return [((seen.x + 1) / 2) * innerWidth, ((1 - seen.y) / 2) * innerHeight];
}"""


def write_hall(folder: Path) -> Path:
    """A plain hall of twelve: ten crates ahead of the entrance, one farther away, and the box aside."""
    content = write_plain_hall(folder)
    large = trimesh.creation.box((0.5, 1.2, 0.5)).subdivide_loop(iterations=5)
    large.apply_translation((0, 0.6, 0))
    box = content / "exhibits" / "box"
    small = (box / "box.glb").read_bytes()
    (box / "box.glb").write_bytes(large.export(file_type="glb"))
    for number in range(11):
        crate = content / "exhibits" / f"crate-{number:02}"
        shutil.copytree(box, crate)
        (crate / "box.glb").write_bytes(small)
        z = -5.4 if number == 10 else -3.6
        told = EXHIBIT.replace("x = 2.5, z = 3.0", f"x = {-6.0 + 1.2 * number:.1f}, z = {z}")
        (crate / "exhibit.toml").write_text(told, "utf-8")
    return content


@pytest.fixture(scope="module")
def hall(tmp_path_factory):
    work = tmp_path_factory.mktemp("nearness")
    with running_hall(write_hall(work / "content"), work) as running:
        yield running


def asked(hall, path: str) -> bytes:
    return urllib.request.urlopen(hall.url + path, timeout=60).read()


def test_the_first_view_is_of_what_stands_near_and_ahead(hall):
    scene = json.loads(asked(hall, "/api/scene"))
    late = {one["id"] for one in scene["exhibits"]} - {node.rpartition("/")[2] for node in scene["nodes"]}
    assert late == {"box", "crate-10"}


def test_what_is_not_in_it_comes_after_it_and_is_an_exhibit_as_all(hall, chromium):
    page = chromium.new_page(viewport={"width": 480, "height": 270})
    came: list[str] = []
    page.on("request", lambda request: came.append(request.url))
    enter(page, f"{hall.url}/?lang=en")
    page.wait_for_function(STANDS, arg=BOX, timeout=60_000)
    pieces = [at for at, url in enumerate(came) if "/scene/pieces/" in url]
    assert pieces, "it is in no pack"
    assert min(pieces) > max(at for at, url in enumerate(came) if "/scene/packs/" in url)
    page.evaluate("() => hall.goTo(2.5, 5.0, 0)")
    page.wait_for_function("() => hall.near() === 'box'", timeout=60_000)
    page.wait_for_timeout(1_500)
    x, y = page.evaluate(CENTRE, BOX)
    page.mouse.click(x, y - 20)
    page.wait_for_function("() => hall.opened() === 'box'", timeout=60_000)
    page.close()


@pytest.mark.nightly
def test_the_nearest_comes_next(hall, chromium):
    page = chromium.new_page(viewport={"width": 480, "height": 270})
    page.add_init_script(f"({CHOOSE})('low')")
    page.goto(f"{hall.url}/?lang=en")
    page.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=60_000)
    page.wait_for_function(STANDS, arg=FARTHEST, timeout=60_000)
    assert page.evaluate(STANDS, BOX), "asked for when the box was drawn"
    page.close()


@pytest.mark.nightly
def test_a_piece_that_fails_once_is_asked_for_again_and_the_hall_stays(hall, chromium):
    page = chromium.new_page(viewport={"width": 480, "height": 270})
    failed: list[str] = []

    def fail_once(route) -> None:
        failed.append(route.request.url)
        if failed.count(route.request.url) > 1:
            route.continue_()
        else:
            route.fulfill(status=503)

    page.route("**/scene/pieces/**", fail_once)
    page.add_init_script(f"({CHOOSE})('low')")
    page.goto(f"{hall.url}/?lang=en")
    page.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=60_000)
    room = "() => window.__viserMutable.nodeRefFromName['/room'].uuid"
    stood = page.evaluate(room)
    page.wait_for_function(STANDS, arg=BOX, timeout=60_000)
    assert len(failed) > len(set(failed))
    assert page.evaluate(room) == stood
    page.close()


@pytest.mark.nightly
def test_what_a_curator_takes_away_while_a_page_loads_is_not_waited_for(chromium, tmp_path):
    content, held = write_hall(tmp_path / "content"), []
    with running_hall(content, tmp_path) as hall:
        page = chromium.new_page(viewport={"width": 480, "height": 270})
        page.route("**/scene/packs/**", lambda route: held.append(route))
        page.goto(f"{hall.url}/?lang=en")
        page.wait_for_function("() => HALL.view.here", timeout=60_000)
        shutil.rmtree(content / "exhibits" / "crate-05")
        deadline = time.monotonic() + 60
        while b"crate-05" in asked(hall, "/api/scene"):
            assert time.monotonic() < deadline
            page.wait_for_timeout(200)
        held[0].continue_()
        page.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=60_000)
        page.close()


@pytest.mark.nightly
def test_the_pack_is_called_the_same_by_every_server(tmp_path):
    """So browsers have it still after a restart."""
    content = write_hall(tmp_path / "content")
    crates = sorted((content / "exhibits").glob("crate-*/box.glb"))
    for number, crate in enumerate(crates):
        large = trimesh.creation.box((0.5, 1.2 + 0.01 * number, 0.5)).subdivide_loop(iterations=5)
        large.apply_translation((0, 0.7, 0))
        crate.write_bytes(large.export(file_type="glb"))
    names = set()
    for seed in "123":
        with running_hall(content, tmp_path / seed, env={"PYTHONHASHSEED": seed}) as hall:
            names.add(asked(hall, "/?lang=en").decode().partition("/scene/packs/")[2].partition('"')[0])
    assert len(names) == 1


@pytest.mark.nightly
def test_it_is_there_again_after_a_lost_line(hall, chromium):
    with wire(hall.port) as line:
        page = chromium.new_page(viewport={"width": 480, "height": 270})
        enter(page, f"http://127.0.0.1:{line.port}/?lang=en")
        page.wait_for_function(STANDS, arg=BOX, timeout=60_000)
        page.evaluate(f"() => {{ window.__viserMutable.nodeRefFromName['{BOX}'].__old = true; }}")
        line.cut()
        new = f"() => window.__viserMutable?.nodeRefFromName?.['{BOX}']?.__old === undefined"
        page.wait_for_function(new, timeout=90_000)
        page.wait_for_function(STANDS, arg=BOX, timeout=90_000)
        page.close()


@pytest.mark.nightly
def test_a_curator_moves_it_and_takes_it_away(chromium, tmp_path):
    content = write_hall(tmp_path / "content")
    told = content / "exhibits" / "box" / "exhibit.toml"
    place = f"() => window.__viserMutable.nodeRefFromName['{BOX}']?.position.x"
    with running_hall(content, tmp_path) as hall:
        page = chromium.new_page(viewport={"width": 480, "height": 270})
        enter(page, f"{hall.url}/?lang=en")
        page.wait_for_function(STANDS, arg=BOX, timeout=60_000)
        assert page.evaluate(place) == pytest.approx(2.5)
        told.write_text(EXHIBIT.replace("x = 2.5", "x = 3.5"), "utf-8")
        page.wait_for_function(f"() => Math.abs(({place})() - 3.5) < 1e-6", timeout=60_000)
        shutil.rmtree(content / "exhibits" / "box")
        page.wait_for_function(f"() => ({place})() === undefined", timeout=60_000)
        page.close()


@pytest.mark.nightly
def test_a_hall_of_twenty_outfits_costs_the_first_view_no_more(shipped_hall, tmp_path):
    """Its pack is what the room and ten exhibits weigh, however many there are."""
    content = tmp_path / "content"
    shutil.copytree(shipped_hall.content, content)
    for number in range(8):
        shutil.copytree(content / "exhibits" / "quju", content / "exhibits" / f"quju-{number}")
        told = content / "exhibits" / f"quju-{number}" / "exhibit.toml"
        text = told.read_text("utf-8").replace('on = "plinth-cutting"\n', "")
        before, _, after = text.replace("size = [1.5, 1.2]", "size = [0.6, 0.6]").partition("[place]\n")
        x, z = -10.0 + 1.7 * (number % 4), -2.0 + 4.0 * (number // 4)
        told.write_text(f"{before}[place]\nx = {x}\nz = {z}\nfacing{after.partition('facing')[2]}", "utf-8")
    with running_hall(content, tmp_path, light=False) as hall:
        scene = json.loads(asked(hall, "/api/scene"))
        assert len(scene["exhibits"]) == 21
        assert len(scene["nodes"]) == 11
        assert weight(hall) <= 1.02 * weight(shipped_hall)


def weight(hall) -> int:
    """[bytes] of the pack that the page asks for first."""
    page = asked(hall, "/?lang=en").decode()
    pack = asked(hall, "/scene/packs/" + page.partition("/scene/packs/")[2].partition('"')[0])
    (length,) = struct.unpack_from("<I", pack)
    assert json.loads(pack[4 : 4 + length])
    return len(pack)
