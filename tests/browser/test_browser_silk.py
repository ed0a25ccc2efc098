"""Silk in a running hall: its gleam is drawn the cheap way, and a double click comes to the yarns of a figured one."""

from io import BytesIO

import numpy as np
import pytest
from bench.browser import enter, soon
from bench.look_silk import dressed_hall
from PIL import Image
from running_hall import running_hall

pytestmark = [pytest.mark.browser, pytest.mark.nightly]

VIEW = {"width": 900, "height": 600}
MATERIALS = """
() => {
  const found = [];
  for (const name of ["/closeup", "/exhibits/box"]) {
    window.__viserMutable.nodeRefFromName[name]?.traverse(({material}) => {
      if (material?.name.startsWith("silk")) {
        const {sheen, anisotropy, userData, defines} = material;
        found.push({name: material.name, sheen, anisotropy, gleams: userData.gleams, cells: defines.SILK_CELLS ?? 0});
      }
    });
  }
  return found;
}
"""
DISTANCE = "() => window.__viserMutable.cameraControl.distance"
SHOWN = (150, 200, 330, 420)  # [px] of the cloth, free of panel and bars


@pytest.fixture(scope="module")
def hall(tmp_path_factory):
    work = tmp_path_factory.mktemp("silk")
    content = dressed_hall(work / "content", "silk")
    with running_hall(content, work) as hall:
        yield hall


@pytest.fixture(scope="module")
def page(chromium, hall):
    page = chromium.new_page(viewport=VIEW)
    page.wrong = []
    page.on("console", lambda message: page.wrong.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: page.wrong.append(str(error)))
    enter(page, f"{hall.url}/?lang=en&exhibit=box")
    page.locator("html[data-closeup=drawn]").wait_for(state="attached", timeout=60_000)
    page.wait_for_timeout(1500)
    yield page
    page.close()


def seen(page) -> np.ndarray:
    """The cloth as it is drawn once the picture rests (rows, columns), 0 to 255."""
    page.wait_for_timeout(700)
    left, top, right, bottom = SHOWN
    clip = {"x": left, "y": top, "width": right - left, "height": bottom - top}
    return np.asarray(Image.open(BytesIO(page.screenshot(clip=clip))).convert("L"), float)


def test_every_silk_gleams_by_one_lobe_and_its_shader_compiles(page):
    soon(page, lambda: len(page.evaluate(MATERIALS)) >= 4)
    found = page.evaluate(MATERIALS)
    assert all(one["gleams"] and one["sheen"] == 0 and one["anisotropy"] == 0 for one in found)
    assert {one["cells"] for one in found if one["name"] == "silk_close"} == {2}
    assert {one["cells"] for one in found if one["name"] == "silk_hall"} == {0}
    assert page.wrong == []


def test_a_double_click_comes_to_the_yarns_bit_by_bit_and_back(page):
    whole = page.evaluate(DISTANCE)
    page.mouse.dblclick(240, 310)
    soon(page, lambda: page.evaluate("() => 'closeupNear' in document.documentElement.dataset"))
    assert page.evaluate(DISTANCE) == pytest.approx(0.1, rel=0.02)
    far = seen(page)
    bright, sharp = [far.mean()], [np.abs(np.diff(far, axis=1)).mean()]
    for _ in range(12):
        page.keyboard.press("Equal")
        picture = seen(page)
        bright.append(picture.mean())
        sharp.append(np.abs(np.diff(picture, axis=1)).mean())
    assert page.evaluate(DISTANCE) == pytest.approx(0.012, rel=0.15)
    assert np.abs(np.diff(bright)).max() < 10  # levels a step: nothing pops
    assert sharp[-1] > 1.5 * sharp[0]  # yarns are seen
    page.keyboard.press("0")
    soon(page, lambda: page.evaluate(DISTANCE) == pytest.approx(whole, rel=0.01))
    page.keyboard.press("z")
    soon(page, lambda: page.evaluate("() => 'closeupNear' in document.documentElement.dataset"))
    page.keyboard.press("0")
    soon(page, lambda: page.evaluate(DISTANCE) == pytest.approx(whole, rel=0.01))
    page.wait_for_timeout(2000)  # until the whole is drawn: a click meets what is seen
    page.mouse.dblclick(30, 560)  # nothing of the exhibit is there
    page.wait_for_timeout(300)
    assert not page.evaluate("() => 'closeupNear' in document.documentElement.dataset")
    assert page.wrong == []
