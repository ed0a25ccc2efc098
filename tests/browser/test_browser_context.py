"""The WebGL context is taken away and given back: a sentence meanwhile, then the same picture by itself."""

import io

import numpy as np
import pytest
from bench.browser import PATIENCE, enter, pose
from bench.track import place
from PIL import Image

pytestmark = [pytest.mark.nightly, pytest.mark.browser, pytest.mark.slow]

VIEW = {"width": 480, "height": 540}
NOTE = "[data-testid=curtain-note]"
LOSE = """() => {
  const gl = window.__viserMutable.scene.__r3f.root.getState().gl.getContext();
  window.__context = gl.getExtension("WEBGL_lose_context");
  window.__context.loseContext();
}"""
RESTORE = "() => window.__context.restoreContext()"


@pytest.fixture
def page(chromium):
    context = chromium.new_context(viewport=VIEW, reduced_motion="reduce")
    page = context.new_page()
    page.troubles = []
    page.on("pageerror", lambda error: page.troubles.append(str(error)))
    yield page
    assert page.troubles == []
    context.close()


def picture(page) -> np.ndarray:
    """What is drawn, (H, W, 3) 0..255, without the overlay."""
    page.evaluate("() => { document.querySelector('#hall-ui').style.visibility = 'hidden'; }")
    page.wait_for_timeout(300)
    shot = page.screenshot()
    page.evaluate("() => { document.querySelector('#hall-ui').style.visibility = ''; }")
    return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"), float)


def settled(page) -> np.ndarray:
    """The picture once it no longer changes."""
    last = picture(page)
    for _ in range(40):
        page.evaluate("() => window.__viserMutable.requestRender()")
        page.wait_for_timeout(400)
        now = picture(page)
        if np.abs(now - last).max() < 2:
            return now
        last = now
    raise AssertionError("the picture never came to rest")


def same(before: np.ndarray, after: np.ndarray) -> None:
    apart = np.abs(after - before).max(axis=2)
    assert before.std() > 10  # a picture, no plain colour
    assert apart.mean() < 0.1
    assert (apart > 12).mean() < 0.0005


def lost(page, said: str) -> None:
    page.evaluate(LOSE)
    page.locator(NOTE, has_text=said).wait_for(timeout=5_000)
    ground = page.locator("[data-testid=curtain]").bounding_box()
    assert (ground["width"], ground["height"]) == (VIEW["width"], VIEW["height"])
    shot = np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB"), float)
    assert shot[100:200, 2:9].max() < 110  # calm, and no white page with a broken picture


def restored(page) -> None:
    """Nobody touches anything: the sentence goes when there is a picture."""
    page.evaluate(RESTORE)
    page.locator(NOTE).wait_for(state="hidden", timeout=PATIENCE)
    page.wait_for_timeout(2500)  # what the page asks for by itself is through


def test_in_the_hall(shipped_hall, page):
    enter(page, f"{shipped_hall.url}/?lang=en", quality="high")
    page.click("[data-testid=motion]")  # the picture is to be the same again: nobody walks in it
    place(page, 0.0, 3.0, 0.0)
    before = settled(page)
    lost(page, "bringing it back")
    page.click("[data-testid=list]")  # everything but the picture goes on
    assert page.locator("[data-testid=list-item-pibo]").is_visible()
    page.keyboard.press("Escape")
    page.click("[data-testid=lang-zh]")
    page.locator(NOTE, has_text="正在恢复").wait_for()
    restored(page)
    same(before, picture(page))
    drawn = page.evaluate("() => hall.framesDrawn()")
    page.evaluate("() => hall.goTo(0, 2, 0)")
    page.wait_for_function("(drawn) => hall.framesDrawn() > drawn", arg=drawn)


@pytest.mark.parametrize("exhibit", ["pibo-figure", "mirror"])
def test_in_a_close_up(shipped_hall, page, exhibit):
    """Studio, environment map, cloth shaded by sight: all as before, twice over."""
    enter(page, f"{shipped_hall.url}/?lang=en&exhibit={exhibit}", quality="high")
    page.locator("html[data-closeup=drawn]").wait_for(state="attached", timeout=PATIENCE)
    before = settled(page)
    for _ in range(2):
        lost(page, "bringing it back")
        assert page.locator("[data-testid=panel]").is_visible()
        page.click("[data-testid=tab-data]")
        page.click("[data-testid=tab-intro]")
        restored(page)
        same(before, picture(page))
    page.keyboard.press("Escape")
    page.locator("[data-testid=panel]").wait_for(state="hidden")


def test_before_entering(shipped_hall, page):
    page.add_init_script("localStorage.setItem('hall.quality', 'high')")
    page.goto(f"{shipped_hall.url}/?lang=zh")
    page.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=PATIENCE)
    before = settled(page)
    lost(page, "正在恢复")
    restored(page)
    same(before, picture(page))
    lost(page, "正在恢复")
    page.click("[data-testid=enter]")
    page.locator("[data-testid=enter-screen]").wait_for(state="detached")
    restored(page)
    same(before, picture(page))


def test_lost_while_the_hall_still_loads(plain_hall, page):
    """Lost before the first picture: once given back, the hall opens within its patience, not after two minutes."""
    page.goto(f"{plain_hall.url}/?lang=en")
    page.wait_for_function("() => window.__viserMutable?.scene?.__r3f?.root?.getState?.().gl", polling=10)
    page.evaluate(LOSE)
    page.locator(NOTE).wait_for(timeout=30_000)
    page.evaluate(RESTORE)
    page.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=60_000)
    page.locator(NOTE).wait_for(state="hidden", timeout=PATIENCE)


def test_given_up_it_offers_to_load_again_at_the_same_spot(plain_hall, page):
    enter(page, f"{plain_hall.url}/?lang=en")
    place(page, 1.0, -3.0, 0.7)
    lost(page, "bringing it back")
    again = page.locator("[data-testid=curtain-reload]")
    assert not again.is_visible()
    again.wait_for(timeout=20_000)
    with page.expect_navigation():
        again.click()
    page.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=PATIENCE)
    assert not page.locator(NOTE).is_visible()
    at = pose(page)
    assert (at["x"], at["z"], at["yaw"]) == pytest.approx((1.0, -3.0, 0.7), abs=0.05)


def test_given_back_late_it_is_drawn_all_the_same(plain_hall, page):
    enter(page, f"{plain_hall.url}/?lang=en")
    before = settled(page)
    lost(page, "bringing it back")
    page.locator("[data-testid=curtain-reload]").wait_for(timeout=20_000)
    restored(page)
    same(before, picture(page))
