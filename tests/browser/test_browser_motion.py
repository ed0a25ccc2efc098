"""An exhibit that moves by a clip, in a running hall: it plays, stops by key and button, and stands for who asks."""

import numpy as np
import pytest
import trimesh
from bench.axe import violations
from bench.browser import enter, soon, stand_before
from moving_hall import write_moving_hall
from running_hall import running_hall

pytestmark = [pytest.mark.browser, pytest.mark.slow]

VIEW = {"width": 480, "height": 270}
NODE = "/exhibits/box"
TOP = """
(node) => {
  let far = null;
  window.__viserMutable.nodeRefFromName[node]?.traverse(({isMesh, geometry}) => {
    if (isMesh) far = Math.max(...Array.from(geometry.attributes.position.array).filter((_, k) => k % 3 === 0));
  });
  return far;
}
"""


@pytest.fixture(scope="module")
def hall(tmp_path_factory):
    work = tmp_path_factory.mktemp("moving")
    with running_hall(write_moving_hall(work / "content"), work) as hall:
        yield hall


def visit(chromium, hall, **options):
    page = chromium.new_page(viewport=VIEW, **options)
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    enter(page, f"{hall.url}/?lang=en")
    stand_before(page, "box")
    return page, asked


def sways(page, node: str = NODE) -> float:
    """How far the box's right side goes to and fro in a second [m]."""
    seen = []
    for _ in range(12):
        page.mouse.move(240 + len(seen), 130)  # a sign of life
        seen.append(page.evaluate(TOP, node))
        page.wait_for_timeout(90)
    assert None not in seen
    return float(np.ptp(seen))


@pytest.fixture(scope="module")
def page(chromium, hall):
    page, asked = visit(chromium, hall)
    page.asked = asked
    yield page
    page.close()


@pytest.mark.door
def test_it_plays_and_asks_for_no_byte_more(page):
    soon(page, lambda: page.mouse.move(200, 100) or page.evaluate("() => hall.playing()") == [NODE])
    assert sways(page) > 0.05
    before = len(page.asked)
    assert sways(page) > 0.05
    assert len(page.asked) == before
    assert sum("sway.clip" in url for url in page.asked) == 1


def test_it_stops_by_key_and_by_button(page):
    button = page.locator("[data-testid=motion]")
    page.keyboard.press("p")
    assert button.get_attribute("aria-pressed") == "false"
    page.wait_for_timeout(200)
    assert sways(page) == 0.0
    button.click()
    assert button.get_attribute("aria-pressed") == "true"
    assert sways(page) > 0.05


def test_out_of_sight_nothing_is_drawn_for_it(page):
    page.evaluate("() => { const {x, z, yaw} = hall.pose(); hall.goTo(x, z, yaw + Math.PI); }")
    page.wait_for_timeout(3000)
    assert sways(page) == 0.0
    stand_before(page, "box")
    soon(page, lambda: sways(page) > 0.05)


def test_the_closeup_moves_where_it_shows_the_same_model(page):
    page.evaluate("() => document.querySelector('[data-testid=list]').click()")
    page.locator("[data-testid=list-item-box]").click()
    page.locator("html[data-closeup=drawn]").wait_for(state="attached", timeout=60_000)
    soon(page, lambda: sways(page, "/closeup") > 0.05)
    page.keyboard.press("Escape")
    page.locator("[data-testid=panel]").wait_for(state="hidden")


def test_a_model_that_is_drawn_anew_goes_on_moving(page, hall):
    """As after a curator's change, or when viser's socket connected again: other meshes."""
    mark = "(node) => { __viserMutable.nodeRefFromName[node].traverse((one) => { one.__old = true; }); }"
    old = """(node) => { let old = false;
        __viserMutable.nodeRefFromName[node]?.traverse((one) => { old ||= one.isMesh && one.__old; }); return old; }"""
    stand_before(page, "box")
    page.evaluate(mark, NODE)
    model = hall.content / "exhibits" / "box" / "box.glb"
    scene = trimesh.load_scene(model)
    (box,) = scene.geometry.values()
    box.visual.face_colors = [60, 60, 160, 255]
    model.write_bytes(scene.export(file_type="glb"))
    soon(page, lambda: page.mouse.move(210, 110) or page.evaluate(TOP, NODE) and not page.evaluate(old, NODE))
    soon(page, lambda: sways(page) > 0.05)


def test_seven_tools_fit_on_a_phone(page):
    page.set_viewport_size({"width": 360, "height": 640})
    page.evaluate("() => { document.querySelector('[data-testid=music]').hidden = false; }")
    page.wait_for_timeout(400)
    left, right, wide = page.evaluate(
        """() => { const {left, right} = document.querySelector(".tools").getBoundingClientRect();
        return [left, right, document.documentElement.scrollWidth]; }"""
    )
    page.evaluate("() => { document.querySelector('[data-testid=music]').hidden = true; }")
    page.set_viewport_size(VIEW)
    assert left >= 0
    assert right <= 360
    assert wide <= 360


def test_it_stands_for_who_asks_for_less_motion(chromium, hall):
    page, asked = visit(chromium, hall, reduced_motion="reduce")
    assert page.locator("[data-testid=motion]").get_attribute("aria-pressed") == "false"
    assert sways(page) == 0.0
    assert not any("sway.clip" in url for url in asked)
    page.locator("[data-testid=motion]").click()  # whoever asks for it has it
    soon(page, lambda: sways(page) > 0.05)
    page.close()


def test_the_button_is_named_as_it_reads(chromium, hall):
    """axe's rules, and in both languages a name that holds what is to be read on it."""
    page, _ = visit(chromium, hall)
    page.set_viewport_size({"width": 1280, "height": 400})
    for lang, text in (("zh", "动态"), ("en", "Motion")):
        page.click(f"[data-testid=lang-{lang}]")
        button = page.locator("[data-testid=motion]")
        assert button.inner_text().strip() == text
        assert text in button.get_attribute("aria-label")
        assert violations(page, within=".tools") == []
    page.close()
