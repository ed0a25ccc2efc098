"""Why an exhibit moves: what was tracked of it lies over its close-up, of the frame its model shows; and the panel."""

import numpy as np
import pytest
import trimesh
from bench.axe import violations
from bench.browser import alive, enter, settled
from full_matrix import by_day
from moving_hall import FRAMES, box_points, write_moving_hall
from running_hall import running_hall

pytestmark = [pytest.mark.browser, pytest.mark.nightly]

VIEW = {"width": 900, "height": 600}

# The close-up's own corners as three.js projects them, in the picture's pixels; and the frame that is drawn over it.
BOTH = """
() => {
  const {camera, canvas, nodeRefFromName} = window.__viserMutable, told = hall.points(), corners = new Map();
  nodeRefFromName["/closeup"].traverse((mesh) => {
    if (!mesh.isMesh) return;
    const at = mesh.geometry.attributes.position, spot = mesh.position.clone();
    for (let k = 0; k < at.count; k++) {
      spot.fromBufferAttribute(at, k).applyMatrix4(mesh.matrixWorld).project(camera);
      corners.set(k, [(spot.x + 1) / 2 * canvas.clientWidth, (1 - spot.y) / 2 * canvas.clientHeight]);
    }
  });
  return told && {frame: told.frame, points: Array.from(told.points), cloth: Array.from(told.cloth),
    corners: [...corners.values()]};
}
"""
COLOUR = """
([x, y]) => {
  const canvas = document.querySelector("canvas.points"), scale = canvas.width / canvas.clientWidth;
  return Array.from(canvas.getContext("2d").getImageData(Math.round(x * scale), Math.round(y * scale), 1, 1).data);
}
"""
DRAWN = "() => hall.points() !== null"
HEARD = "() => window.__viserMutable.scene.onAfterRender.name"


@pytest.fixture(scope="module")
def hall(tmp_path_factory):
    work = tmp_path_factory.mktemp("why")
    with running_hall(write_moving_hall(work / "content", points=True), work) as hall:
        yield hall


def look_closely(chromium, hall, lang: str = "en", **options):
    page = chromium.new_page(**{"viewport": VIEW, **options})
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    enter(page, f"{hall.url}/?lang={lang}&exhibit=box")
    page.locator("html[data-closeup=drawn]").wait_for(state="attached", timeout=60_000)
    return page, asked


def away(told) -> np.ndarray:
    """How far [px] each of the box's points is from the nearest corner of the model that is drawn."""
    own = np.array(told["points"]).reshape(-1, 3)[:8, :2]
    return np.linalg.norm(own[:, None] - np.array(told["corners"])[None], axis=2).min(1)


@pytest.fixture(scope="module")
def page(chromium, hall):
    page, asked = look_closely(chromium, hall)
    page.asked = asked
    yield page
    page.close()


def test_nothing_is_fetched_or_drawn_before_it_is_asked_for(page):
    assert page.locator("[data-testid=tab-why]").is_visible()
    assert not any(".points" in url for url in page.asked)
    assert page.evaluate("() => hall.points()") is None
    page.locator("[data-testid=tab-why]").click()
    alive(page, lambda: page.evaluate(DRAWN))
    assert sum(".points" in url for url in page.asked) == 1


def test_the_page_reads_what_python_wrote(page):
    told = page.evaluate(
        """async (url) => {
        const {readPoints} = await import("/static/look/points/points_file.js");
        const read = await readPoints(await (await fetch(url)).arrayBuffer());
        return {...read, torso: [...read.torso], ...Object.fromEntries(
            ["points", "cloth", "m", "delta", "lost"].map((name) => [name, Array.from(read[name])]))};
    }""",
        next(url for url in page.asked if ".points" in url),
    )
    made = box_points()
    for name, within in (("points", 0.126e-3), ("cloth", 0.126e-3), ("m", 0.51e-3), ("delta", 0.051e-3)):
        assert np.abs(np.array(told[name]) - getattr(made, name).ravel()).max() < within, name
    assert told["torso"] == np.flatnonzero(made.torso).tolist()
    assert told["bones"] == made.bones.tolist()
    assert (told["rows"], told["begin"]) == (FRAMES + 1, 1)
    assert (told["frames"], told["rate"], told["m0"], told["noise"]) == (FRAMES, 25, 0.1, 0.01)
    assert not any(told["lost"])


def test_they_lie_where_the_model_is_and_go_with_its_frames(page):
    frames = set()

    def followed() -> bool:
        told = page.evaluate(BOTH)
        frames.add(told["frame"])
        assert away(told).max() < 1.5, told["frame"]  # of a box that sways by a hundred pixels
        return len(frames) > 7

    alive(page, followed)


def test_the_trunk_is_red_the_limbs_are_green_and_cloth_is_hollow(page):
    page.keyboard.press("p")
    settled(page)
    told = page.evaluate(BOTH)
    own, cloth = (np.array(told[name]).reshape(-1, 3)[:, :2] for name in ("points", "cloth"))
    inside = (own > 0).all(1) & (own < [VIEW["width"], VIEW["height"]]).all(1)
    assert inside[:8].sum() > 5
    for number in np.flatnonzero(inside[:8]):
        trunk = box_points().torso[number]
        red, green, _, solid = page.evaluate(COLOUR, own[number].tolist())
        assert solid > 250
        assert (red > 1.5 * green) if trunk else (green > 1.5 * red)
    assert page.evaluate(COLOUR, cloth[0].tolist())[3] < 200  # its middle is open
    page.keyboard.press("p")


def test_they_stop_with_the_model_and_the_cursor_with_them(page):
    page.keyboard.press("p")
    page.wait_for_timeout(300)
    before, at = page.evaluate(BOTH), page.locator("[data-testid=why-moment]").inner_text()
    assert f"frame {before['frame'] + 1} of {FRAMES}" in at
    assert page.locator("[data-testid=why-stopped]").is_visible()
    for _ in range(5):
        page.mouse.move(150 + _, 300)
        page.wait_for_timeout(100)
    after = page.evaluate(BOTH)
    assert (after["frame"], after["points"]) == (before["frame"], before["points"])
    assert page.locator("[data-testid=why-moment]").inner_text() == at
    page.keyboard.press("p")
    alive(page, lambda: page.evaluate(BOTH)["frame"] != before["frame"])
    assert page.locator("[data-testid=why-moment]").inner_text() != at


def test_they_follow_a_camera_that_turns(page):
    page.keyboard.press("p")
    page.locator("[data-testid=stage]").focus()
    before = page.evaluate(BOTH)
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    alive(page, lambda: page.evaluate(BOTH)["points"] != before["points"])
    settled(page)
    told = page.evaluate(BOTH)
    assert away(told).max() < 1.5
    page.keyboard.press("p")


def test_the_switch_hides_them_by_key_and_the_charts_go_on(page):
    switch = page.locator("[data-testid=why-switch]")
    switch.focus()
    page.keyboard.press("Space")
    assert not switch.is_checked()
    assert page.evaluate("() => hall.points()") is None
    at = page.locator("[data-testid=why-moment]").inner_text()
    alive(page, lambda: page.locator("[data-testid=why-moment]").inner_text() != at)
    page.keyboard.press("Space")
    alive(page, lambda: page.evaluate(DRAWN))
    page.keyboard.press("p")  # the switch has the focus, and is nothing that one writes in
    assert page.locator("[data-testid=why-stopped]").is_visible()
    page.keyboard.press("p")


def test_another_tab_ends_it(page):
    assert page.evaluate(HEARD) == "paint"
    page.locator("[data-testid=tab-intro]").click()
    assert page.evaluate("() => hall.points()") is None
    assert page.locator("canvas.points").is_hidden()
    assert page.evaluate(HEARD) != "paint"
    page.locator("[data-testid=tab-why]").click()
    alive(page, lambda: page.evaluate(DRAWN))
    assert sum(".points" in url for url in page.asked) == 2  # one of them is this file's own
    page.keyboard.press("Escape")
    page.locator("[data-testid=panel]").wait_for(state="hidden")
    assert page.evaluate("() => hall.points()") is None
    assert page.evaluate(HEARD) != "paint"


@pytest.mark.parametrize("lang", by_day(["zh"], ["zh", "en"]))
def test_it_reads_in_both_languages_on_a_phone(chromium, hall, lang):
    page, _ = look_closely(chromium, hall, lang, viewport={"width": 360, "height": 740})
    page.locator("[data-testid=tab-why]").click()
    alive(page, lambda: page.evaluate(DRAWN))
    settled(page)
    text = page.locator("[data-testid=why]").inner_text()
    assert ("10 毫米" if lang == "zh" else "10 mm") in text
    assert "why." not in text
    assert violations(page, within="[data-testid=panel]") == []
    wide, inside = page.evaluate(
        """() => { const {scrollWidth, clientWidth} = document.querySelector(".panel-body");
        return [scrollWidth, clientWidth]; }"""
    )
    assert wide <= inside
    page.close()


def test_who_asks_for_less_motion_sees_them_stand(chromium, hall):
    page, asked = look_closely(chromium, hall, reduced_motion="reduce")
    page.locator("[data-testid=tab-why]").click()
    alive(page, lambda: page.evaluate(DRAWN))
    for _ in range(4):
        page.mouse.move(150 + _, 300)
        page.wait_for_timeout(100)
    told = page.evaluate(BOTH)
    assert told["frame"] == -1  # as it stands
    assert page.locator("[data-testid=why-moment]").inner_text() == "Standing, before the motion"
    assert away(told).max() < 1.5
    assert not any(".clip" in url for url in asked)
    page.close()


@pytest.mark.nightly
def test_an_exhibit_without_them_has_no_such_tab(chromium, plain_hall):
    page, _ = look_closely(chromium, plain_hall)
    assert page.locator("[data-testid=tab-why]").is_hidden()
    page.close()


@pytest.mark.nightly
def test_they_lie_right_over_a_finer_model_that_stands(chromium, tmp_path):
    """A curator's close-up of another model, which no clip goes with: they stand as it does."""
    content = write_moving_hall(tmp_path / "content", points=True)
    home = content / "exhibits" / "box"
    (box,) = trimesh.load_scene(home / "box.glb").geometry.values()
    fine = box.subdivide()
    fine.visual.face_colors = [60, 60, 160, 255]
    (home / "fine.glb").write_bytes(fine.export(file_type="glb"))
    toml = (home / "exhibit.toml").read_text("utf-8")
    toml = toml.replace('hall = "box.glb"', 'hall = "box.glb", close = "fine.glb"')
    (home / "exhibit.toml").write_text(toml, "utf-8")
    with running_hall(content, tmp_path) as hall:
        page, _ = look_closely(chromium, hall)
        page.locator("[data-testid=tab-why]").click()
        alive(page, lambda: page.evaluate(DRAWN))
        page.wait_for_timeout(600)
        told = page.evaluate(BOTH)
        assert told["frame"] == -1
        assert len(told["corners"]) > 24
        assert away(told).max() < 1.5
        page.close()
