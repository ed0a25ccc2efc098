"""Small windows: phones upright and lying down, and a desk at 200 % zoom. Exhibit and text share what there is."""

import pytest
from bench.browser import CHOOSE, PATIENCE, at_rest, displayed, enter, soon
from bench.readable import CROWDED, TARGETS
from full_matrix import by_day

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SIZES = ((320, 568), (360, 640), (390, 844), (568, 320), (640, 360), (667, 375), (844, 390))
DAY = (320, 568)  # the hardest; the other sizes are of the night
LEAST_FREE = {"open": 0.25, "folded": 0.40}  # of the picture: nothing of the page lies over it
READ_AT_ONCE = 80  # [px] of text that is seen at a time, at the least
FOLD, PANEL = "[data-testid=panel-fold]", "[data-testid=panel]"

FREE = """
() => {
  let free = 0, all = 0;
  for (let x = 2; x < innerWidth; x += 6) for (let y = 2; y < innerHeight; y += 6) {
    all += 1;
    free += document.elementFromPoint(x, y)?.tagName === "CANVAS";
  }
  return free / all;
}
"""
# Whether the middle of a thing, and so its click, is its own.
REACHED = """
(selector) => {
  const e = document.querySelector(selector), b = e.getBoundingClientRect();
  return e.contains(document.elementFromPoint(b.left + b.width / 2, b.top + b.height / 2));
}
"""
# How much of its height is seen [px].
SEEN = """
(e) => {
  const b = e.getBoundingClientRect(), middle = b.left + b.width / 2;
  return Array.from({ length: innerHeight }, (_, y) => document.elementFromPoint(middle, y + 0.5))
    .filter((over) => e.contains(over)).length;
}
"""
# The exhibit's box on the screen [px]: left, top, right, bottom.
DRAWN = """
() => {
  const m = window.__viserMutable, box = [Infinity, Infinity, -Infinity, -Infinity];
  m.nodeRefFromName["/closeup"].traverse((mesh) => {
    if (!mesh.isMesh) return;
    mesh.geometry.computeBoundingBox();
    const {min, max} = mesh.geometry.boundingBox;
    for (let i = 0; i < 8; i++) {
      const p = min.clone().set(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z)
        .applyMatrix4(mesh.matrixWorld).project(m.camera);
      const x = (p.x + 1) / 2 * innerWidth, y = (1 - p.y) / 2 * innerHeight;
      box[0] = Math.min(box[0], x); box[1] = Math.min(box[1], y);
      box[2] = Math.max(box[2], x); box[3] = Math.max(box[3], y);
    }
  });
  return box;
}
"""


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(size, marks=() if size == DAY else pytest.mark.nightly, id=f"{size[0]}x{size[1]}")
        for size in SIZES
    ],
)
def page(request, shipped_hall, chromium):
    """A phone's page in the hall, at one size."""
    width, height = request.param
    context = chromium.new_context(
        viewport={"width": width, "height": height}, has_touch=True, reduced_motion="reduce"
    )
    page = context.new_page()
    page.set_default_timeout(20_000)
    page.add_init_script(f"({CHOOSE})('low')")
    page.goto(f"{shipped_hall.url}/?lang=zh")
    page.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=PATIENCE)
    page.tap("[data-testid=enter]")
    page.locator("[data-testid=enter-screen]").wait_for(state="detached")
    yield page
    context.close()


def speak(page, lang: str) -> None:
    page.evaluate("(lang) => document.querySelector(`[data-testid=lang-${lang}]`).click()", lang)


def opened(page) -> None:
    """The close-up, unfolded, with its model drawn."""
    if not page.locator(PANEL).is_visible():
        page.tap("[data-testid=list]")
        page.tap("[data-testid=list-item-pibo]")
        page.locator("html[data-closeup=drawn]").wait_for(state="attached", timeout=PATIENCE)
    if page.get_attribute(FOLD, "aria-expanded") == "false":
        page.tap(FOLD)


def closed(page) -> None:
    if page.locator(PANEL).is_visible():
        page.tap("[data-testid=panel-close]")
        page.locator(PANEL).wait_for(state="hidden")


def sound(page, what: str) -> list[str]:
    """What lies over something else, is cut, or too small for a thumb."""
    page.wait_for_timeout(300)
    crowded = page.evaluate(CROWDED)
    wrong = [f"{what}: {kind} {name}" for kind in ("over", "wide", "out") for name in crowded[kind]]
    wrong += [
        f"{what}: small {t['name']} {t['width']:.0f}x{t['height']:.0f}"
        for t in page.evaluate(TARGETS)
        if t["width"] < 43.9 or t["height"] < 43.9
    ]
    return wrong + [f"{what}: scrolls sideways"] * crowded["page"]


def exhibit_is_framed(page) -> None:
    """The exhibit stands whole in what is free: below the bar, above or beside the sheet."""
    at_rest(page)
    left, top, right, bottom = page.evaluate(DRAWN)
    view, panel = page.viewport_size, page.locator(PANEL).bounding_box()
    tools = page.locator(".tools").bounding_box()
    aside = panel["width"] < 0.9 * view["width"]
    assert left > -2
    assert right < (panel["x"] if aside else view["width"]) + 2
    assert bottom < (view["height"] if aside else panel["y"]) + 2
    assert top > tools["y"] + tools["height"] - 2
    assert bottom - top > 0.2 * view["height"] or right - left > 0.2 * view["width"]


def test_sheet_leaves_the_exhibit_in_sight(page):
    opened(page)
    assert page.evaluate(FREE) >= LEAST_FREE["open"]
    exhibit_is_framed(page)
    page.tap(FOLD)
    assert page.get_attribute(FOLD, "aria-expanded") == "false"
    assert page.evaluate(FREE) >= LEAST_FREE["folded"]
    exhibit_is_framed(page)
    assert "披帛" in page.inner_text(PANEL) or "pibo" in page.inner_text(PANEL)
    line = page.locator(".panel-line")
    assert line.is_visible()
    assert line.bounding_box()["height"] < 30
    assert page.evaluate(REACHED, "[data-testid=panel-close]")


@pytest.mark.nightly
def test_nothing_overlaps(page):
    wrong = []
    for lang in ("zh", "en"):
        closed(page)
        speak(page, lang)
        wrong += sound(page, f"hall {lang}")
        opened(page)
        for tab in ("pictures", "film", "sound", "data", "intro"):
            page.tap(f"[data-testid=tab-{tab}]")
            wrong += sound(page, f"{tab} {lang}")
        page.tap(FOLD)
        wrong += sound(page, f"folded {lang}")
        page.tap(FOLD)
    assert wrong == []


@pytest.mark.nightly
def test_text_can_be_read_to_its_end(page):
    opened(page)
    page.tap("[data-testid=tab-intro]")
    body = page.locator(".panel-body").bounding_box()
    assert body["height"] >= READ_AT_ONCE
    first = page.locator("[data-testid=exhibit-text] p").first.bounding_box()
    assert first["y"] + 24 < body["y"] + body["height"]  # it begins in sight, also below a film
    last = page.locator("[data-testid=exhibit-text] > *").last
    page.mouse.move(body["x"] + body["width"] / 2, body["y"] + body["height"] / 2)
    for _ in range(60):
        page.mouse.wheel(0, 400)
        page.wait_for_timeout(20)

    def end() -> float:
        box = last.bounding_box()
        return box["y"] + box["height"]

    soon(page, lambda: end() <= body["y"] + body["height"] + 1)
    assert page.evaluate(REACHED, "[data-testid=exhibit-text] > :last-child")


@pytest.mark.nightly
def test_sheet_by_keyboard(page):
    opened(page)
    page.focus(FOLD)
    page.keyboard.press("Enter")
    assert page.get_attribute(FOLD, "aria-expanded") == "false"
    controlled = page.get_attribute(FOLD, "aria-controls")
    assert not page.locator(f"#{controlled}").is_visible()
    page.keyboard.press("Tab")
    assert (
        page.evaluate("() => document.activeElement.dataset.testid") == "panel-close"
    )  # nothing hidden between
    page.keyboard.press("Shift+Tab")
    page.keyboard.press("Space")
    assert page.get_attribute(FOLD, "aria-expanded") == "true"
    assert page.locator(f"#{controlled}").is_visible()
    seen = at_rest(page)  # the exhibit has taken its place
    page.focus("[data-testid=sheet-intro]")
    page.evaluate("() => { document.querySelector('.panel-body').scrollTop = 0; }")
    before = page.evaluate("() => document.querySelector('.panel-body').scrollTop")
    for _ in range(6):
        page.keyboard.press("ArrowDown")
    # It is read, not turned; how soon depends on how long a frame takes.
    page.wait_for_function("(before) => document.querySelector('.panel-body').scrollTop > before", arg=before)
    assert displayed(page) == pytest.approx(seen, abs=1e-6)


def test_sheet_by_thumb(page):
    opened(page)
    head = page.locator(".panel-names").bounding_box()
    x, y = head["x"] + 40, head["y"] + head["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x, y + 60, steps=4)
    page.mouse.up()
    assert page.get_attribute(FOLD, "aria-expanded") == "false"
    page.touchscreen.tap(x, page.locator(".panel-names").bounding_box()["y"] + 10)
    assert page.get_attribute(FOLD, "aria-expanded") == "true"
    page.wait_for_timeout(300)
    assert page.locator("dialog[open]").count() == 0  # nor did the tap reach what came to lie under it


@pytest.mark.nightly
def test_folding_keeps_the_exhibit_turned(page):
    opened(page)
    page.focus(FOLD)
    for _ in range(4):
        page.keyboard.press("KeyA")
    page.wait_for_timeout(400)

    def bearing() -> float:
        return page.evaluate(
            "() => { const c = window.__viserMutable.cameraControl; return c.azimuthAngle; }"
        )

    turned = bearing()
    page.keyboard.press("Enter")
    page.wait_for_timeout(400)
    assert bearing() == pytest.approx(turned, abs=1e-3)
    page.keyboard.press("Enter")
    page.wait_for_timeout(400)
    assert bearing() == pytest.approx(turned, abs=1e-3)


@pytest.mark.nightly
@pytest.mark.parametrize("window", by_day(["hall-survey"], ["list", "settings", "help", "hall-survey"]))
def test_windows_fit(page, window):
    """The hall's questionnaire is among them: everybody can reach it."""
    closed(page)
    wrong = []
    for lang in ("zh", "en"):
        speak(page, lang)
        assert page.evaluate(REACHED, f"[data-testid={window}]")
        page.tap(f"[data-testid={window}]")
        page.locator("dialog[open]").wait_for()
        if window == "hall-survey":
            frame = page.frame_locator("[data-testid=survey-frame]")
            frame.locator("input").first.wait_for(state="attached", timeout=PATIENCE)
            page.locator(".survey-wait").wait_for(
                state="hidden", timeout=PATIENCE
            )  # it gives its room to the form
            assert page.locator("[data-testid=survey-frame]").bounding_box()["height"] > 200
        wrong += sound(page, f"{window} {lang}")
        box = page.locator("dialog[open]").bounding_box()
        assert box["x"] >= 0
        assert box["y"] >= 0
        assert box["x"] + box["width"] <= page.viewport_size["width"] + 1
        assert box["y"] + box["height"] <= page.viewport_size["height"] + 1
        body = page.locator("dialog[open] .dialog-body").bounding_box()
        assert body["height"] > 0.6 * box["height"]
        assert page.evaluate(REACHED, "dialog[open] .dialog-head button")
        page.tap("dialog[open] .dialog-head button")
        page.locator("dialog[open]").wait_for(state="detached")
    assert wrong == []


@pytest.mark.nightly
def test_enlarged_picture_is_large(page):
    opened(page)
    page.tap("[data-testid=tab-pictures]")
    page.locator(".picture").first.tap()
    page.locator("dialog[open]").wait_for()
    image = page.locator("[data-testid=viewer-image]").bounding_box()
    view = page.viewport_size
    assert image["width"] * image["height"] > 0.4 * view["width"] * view["height"]
    assert sound(page, "viewer") == []
    for name in ("viewer-close", "viewer-previous", "viewer-next"):
        assert page.evaluate(REACHED, f"[data-testid={name}]"), name
    page.tap("[data-testid=viewer-close]")


@pytest.mark.nightly
def test_at_400_per_cent_zoom_the_text_is_read_and_feedback_reached(shipped_hall, chromium):
    """1280 × 1024 at 400 %: head and foot of the sheet leave no room between them, so all of it scrolls."""
    context = chromium.new_context(viewport={"width": 320, "height": 256}, reduced_motion="reduce")
    page = context.new_page()
    enter(page, f"{shipped_hall.url}/?exhibit=pibo&lang=en")
    page.locator(PANEL).wait_for()
    text = page.locator("[data-testid=exhibit-text]")
    ends = (text.locator("p").first, text.locator(":scope > *").last, page.locator(".panel-foot .primary"))
    for element in ends:
        element.evaluate("(element) => element.scrollIntoView({ block: 'center' })")
        assert element.evaluate(SEEN) >= min(element.bounding_box()["height"], READ_AT_ONCE) - 2
    assert page.evaluate(REACHED, ".panel-foot .primary")
    page.click(FOLD)
    assert page.evaluate(FREE) >= LEAST_FREE["folded"]
    context.close()
