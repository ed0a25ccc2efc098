"""The room's light map, the garments' lights and reflections, as the page lays them on viser's scene."""

import io
import sys
from pathlib import Path

import numpy as np
import pytest
from bench.browser import enter, soon
from bench.track import place
from bench.wire import wire
from PIL import Image
from plain_hall import write_plain_hall
from running_hall import running_hall

pytestmark = [pytest.mark.nightly, pytest.mark.browser, pytest.mark.slow]

PROGRAM = (sys.executable, str(Path(__file__).parents[1] / "lit_hall.py"))
VIEW = {"width": 480, "height": 270}

ROOM = """() => {
  const found = {};
  window.__viserMutable.nodeRefFromName["/room"]?.traverse((o) => {
    if (!o.isMesh) return;
    const m = o.material;
    found[o.name] = {visible: o.visible, basic: m.isMeshBasicMaterial === true,
      map: m.map?.uuid, channel: m.map?.channel, strength: m.lightMapIntensity,
      light: m.lightMap?.uuid ?? null, lightChannel: m.lightMap?.channel ?? null,
      anisotropy: m.map?.anisotropy};
  });
  return found;
}"""
LIT = """() => {
  const meshes = [];
  window.__viserMutable.nodeRefFromName["/room"]?.traverse(
    (o) => o.isMesh && o.name.startsWith("hall_") && meshes.push(o));
  return meshes.length > 0 && meshes.every((o) => o.material.lightMap);
}"""

FLAT = f"() => {{ const room = ({ROOM})(); return Object.keys(room).length > 0 && !room.lightmap; }}"


@pytest.fixture(scope="module")
def lit(tmp_path_factory):
    """A hall whose room carries a light map, and the file that says so."""
    work = tmp_path_factory.mktemp("lit")
    room = work / "room"
    room.write_text("light")
    content = write_plain_hall(work / "content")
    with running_hall(content, work, program=PROGRAM, env={"HALL_TEST_ROOM": str(room)}) as hall:
        yield hall, room


@pytest.fixture(scope="module")
def line(lit):
    with wire(lit[0].port) as line:
        yield line


@pytest.fixture(scope="module")
def page(line, chromium):
    page = chromium.new_page(viewport=VIEW)
    page.troubles = []
    page.on("pageerror", lambda error: page.troubles.append(str(error)))
    page.on("console", lambda said: page.troubles.append(said.text) if said.type == "error" else None)
    page.add_init_script("localStorage.setItem('hall.quality', 'medium')")
    enter(page, f"http://127.0.0.1:{line.port}/?lang=en")
    yield page
    page.close()


def picture(page) -> np.ndarray:
    """What the canvas shows, (H, W, 3) 0..255; nothing of the overlay."""
    page.evaluate("() => { document.querySelector('#hall-ui').style.visibility = 'hidden'; }")
    page.wait_for_timeout(800)
    shot = page.screenshot()
    page.evaluate("() => { document.querySelector('#hall-ui').style.visibility = ''; }")
    return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"), float)


def test_light_map_lies_on_the_room(page):
    page.wait_for_function(LIT)
    room = page.evaluate(ROOM)
    bearer = room.pop("lightmap")
    assert not bearer["visible"]
    assert len(room) == 3
    for name, mesh in room.items():
        assert name.startswith("hall_")
        assert mesh["basic"]
        assert mesh["light"] == bearer["map"]
        assert (mesh["channel"], mesh["lightChannel"]) == (0, 1)
        assert mesh["strength"] == pytest.approx(2 * np.pi)


def test_light_is_seen(page):
    """The map's halves differ fivefold in light; so must the two halves of the wall ahead."""
    place(page, 0.0, -4.0, 0.0)
    page.wait_for_function(LIT)
    seen = picture(page)[60:160]
    left, right = seen[:, 60:180].mean(), seen[:, 300:420].mean()
    assert left > 1.5 * right


def test_colours_are_as_authored(page):
    """Tiles of 150 and 190 under light of 1: the brightest left pixels are the albedo itself."""
    place(page, -4.0, -4.0, 0.0)
    seen = picture(page)[60:160, 100:380]
    assert np.percentile(seen, 95) == pytest.approx(190, abs=6)
    assert np.percentile(seen, 5) == pytest.approx(150, abs=6)


def test_laying_it_again_changes_nothing(page):
    page.wait_for_function(LIT)
    versions = """() => { const v = []; window.__viserMutable.nodeRefFromName["/room"].traverse(
        (o) => o.isMesh && v.push(o.material.version, o.material.map.version)); return v; }"""
    before = page.evaluate(versions)
    for _ in range(5):
        page.evaluate("() => window.__viserMutable.requestRender()")
        page.wait_for_timeout(100)
    assert page.evaluate(versions) == before


def test_survives_a_changed_room(page, lit):
    hall, room = lit
    plan = hall.content / "plan.toml"
    room.write_text("flat")
    plan.write_text(plan.read_text("utf-8").replace("height = 3.0", "height = 3.1"), "utf-8")
    place(page, 4.0, -4.0, 0.0)
    page.wait_for_function(FLAT, timeout=20_000)
    flat = picture(page)
    room.write_text("light")
    plan.write_text(plan.read_text("utf-8").replace("height = 3.1", "height = 3.0"), "utf-8")
    page.wait_for_function(LIT, timeout=20_000)
    assert np.abs(picture(page) - flat).mean() > 5


def test_survives_a_lost_connection(page, line):
    old = page.evaluate("() => window.__viserMutable.nodeRefFromName['/room'].uuid")
    line.cut()
    page.wait_for_function(
        """(old) => { const room = window.__viserMutable?.nodeRefFromName?.["/room"];
            return room && room.uuid !== old; }""",
        arg=old,
        timeout=30_000,
    )
    page.wait_for_function(LIT, timeout=20_000)


def test_garments_reflect_the_room_where_the_machine_is_strong(page):
    """viser carries our picture; the page takes it off below "high", and the sky makes up for it."""
    reflects = "() => Boolean(window.__viserMutable.scene.environment)"
    sky = """() => { let found = 0;
        window.__viserMutable.scene.traverse((o) => { if (o.isHemisphereLight) found = o.intensity; });
        return found; }"""
    page.evaluate("() => hall.setQuality('high')")
    page.wait_for_function(reflects, timeout=20_000)
    with_reflections = page.evaluate(sky)
    for level in ("medium", "low"):
        page.evaluate("(level) => hall.setQuality(level)", level)
        page.wait_for_function(f"() => !({reflects})()", timeout=20_000)
        assert page.evaluate(sky) > 1.5 * with_reflections
    page.evaluate("() => hall.setQuality('high')")
    page.wait_for_function(reflects, timeout=20_000)
    assert page.evaluate(sky) == with_reflections > 0
    assert picture(page).mean() > 20
    assert page.evaluate("() => getComputedStyle(window.__viserMutable.canvas).opacity") == "1"


def test_textures_are_sharpened(page):
    for level, wanted in [("low", 1), ("medium", 4), ("high", 8)]:
        page.evaluate("(level) => hall.setQuality(level)", level)
        page.evaluate("() => window.__viserMutable.requestRender()")
        most = page.evaluate(
            "() => window.__viserMutable.scene.__r3f.root.getState().gl.capabilities.getMaxAnisotropy()"
        )
        sharp = {min(wanted, most)}

        def sharpened(sharp: set[int] = sharp) -> bool:
            found = page.evaluate(ROOM)
            assert found.pop("lightmap")["anisotropy"] == 1  # light is smooth: one look-up will do
            return {mesh["anisotropy"] for mesh in found.values()} == sharp

        soon(page, sharpened)


def test_without_hooks_the_hall_is_flat_but_whole(line, chromium):
    page = chromium.new_page(viewport=VIEW)
    troubles = []
    page.on("pageerror", lambda error: troubles.append(str(error)))
    enter(page, f"http://127.0.0.1:{line.port}/?lang=en&withoutHooks=1")
    page.wait_for_timeout(1500)
    assert {mesh["light"] for mesh in page.evaluate(ROOM).values()} == {None}
    assert picture(page)[100:].mean() > 40
    page.close()
    assert troubles == []


def test_no_trouble_on_the_way(page):
    assert [text for text in page.troubles if "WebSocket" not in text] == []
