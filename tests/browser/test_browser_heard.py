"""The hall for those who hear it read or use keys alone: axe's rules in every state, both languages, desk and phone."""

import pytest
from bench.axe import violations
from bench.browser import CHOOSE, PATIENCE, stand_before
from full_matrix import by_day

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SIZES = {"desk": (1280, 720), "phone": (390, 844)}
TABS = ("intro", "pictures", "film", "sound", "data")
EXHIBIT = "pibo"


@pytest.fixture(scope="module", params=by_day(["desk"], SIZES))
def page(request, shipped_hall, chromium):
    """The hall as it ships, before its door."""
    width, height = SIZES[request.param]
    context = chromium.new_context(
        viewport={"width": width, "height": height}, has_touch=width < 700, reduced_motion="reduce"
    )
    page = context.new_page()
    page.add_init_script(f"({CHOOSE})('low')")
    page.goto(f"{shipped_hall.url}/?lang=zh")
    page.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=PATIENCE)
    yield page
    context.close()


def heard(page, state: str) -> list[str]:
    """What is wrong in this state, in both languages; also names that do not hold what is seen on the thing."""
    wrong = []
    for lang in ("en", "zh"):
        page.evaluate("(lang) => document.querySelector(`[data-testid=lang-${lang}]`).click()", lang)
        page.wait_for_timeout(200)
        wrong += [f"{state} {lang}: {line}" for line in violations(page)]
        wrong += [f"{state} {lang}: named {pair}" for pair in page.evaluate(MISNAMED)]
    return wrong


# WCAG 2.5.3, which axe leaves out by default: whoever speaks to the page says what is to be read there.
MISNAMED = """
() => {
  const plain = (text) => text.toLowerCase().replace(/[^\\p{L}\\p{N}]+/gu, " ").trim();
  return [...document.querySelectorAll("#hall-ui :is(button, a[href], summary)[aria-label]")]
    .filter((e) => e.checkVisibility({opacityProperty: true, visibilityProperty: true}) && !e.closest("[inert]"))
    .filter((e) => !plain(e.getAttribute("aria-label")).includes(plain(e.innerText)))
    .map((e) => `${e.getAttribute("aria-label")} | ${e.innerText}`);
}
"""


def go_in(page) -> None:
    if page.locator("[data-testid=enter-screen]").count():
        page.click("[data-testid=enter]")
        page.locator("[data-testid=enter-screen]").wait_for(state="detached")


def opened(page) -> None:
    go_in(page)
    if not page.locator("[data-testid=panel]").is_visible():
        page.click("[data-testid=list]")
        page.click(f"[data-testid=list-item-{EXHIBIT}]")
        page.locator("[data-testid=panel]").wait_for()


def closed(page) -> None:
    go_in(page)
    if page.locator("[data-testid=panel]").is_visible():
        page.click("[data-testid=panel-close]")
        page.locator("[data-testid=panel]").wait_for(state="hidden")


@pytest.mark.nightly
def test_door(page):
    assert heard(page, "door") == []


@pytest.mark.nightly
def test_hall(page):
    closed(page)
    assert heard(page, "hall") == []


@pytest.mark.nightly
def test_near_an_exhibit(page):
    closed(page)
    stand_before(page, EXHIBIT)
    page.locator("[data-testid=caption]").wait_for()
    assert heard(page, "near") == []


@pytest.mark.nightly
@pytest.mark.parametrize("window", by_day(["list"], ["list", "help", "settings", "hall-survey"]))
def test_windows(page, window):
    closed(page)
    page.click(f"[data-testid={window}]")
    page.locator("dialog[open]").wait_for()
    if window == "hall-survey":
        page.frame_locator("[data-testid=survey-frame]").locator("input").first.wait_for(timeout=PATIENCE)
    wrong = heard(page, window)
    page.keyboard.press("Escape")
    assert wrong == []


@pytest.mark.nightly
def test_plan_folded_and_open(page):
    closed(page)
    wrong = []
    for turn in ("the other way", "back"):
        page.click("[data-testid=minimap-toggle]")
        wrong += heard(page, f"plan {turn}")
    assert wrong == []


@pytest.mark.nightly
@pytest.mark.parametrize("tab", by_day(["intro"], TABS))
def test_panel(page, tab):
    opened(page)
    page.click(f"[data-testid=tab-{tab}]")
    assert heard(page, tab) == []


@pytest.mark.nightly
def test_enlarged_picture(page):
    opened(page)
    page.click("[data-testid=tab-pictures]")
    page.locator(".picture").first.click()
    page.locator("dialog[open]").wait_for()
    wrong = heard(page, "viewer")
    page.keyboard.press("Escape")
    assert wrong == []


@pytest.mark.nightly
def test_folded_panel(page):
    opened(page)
    if page.viewport_size["width"] < 700:
        page.click("[data-testid=panel-fold]")
        assert page.get_attribute("[data-testid=panel-fold]", "aria-expanded") == "false"
        wrong = heard(page, "folded")
        page.click("[data-testid=panel-fold]")
        assert wrong == []
    else:
        assert not page.locator("[data-testid=panel-fold]").is_visible()


@pytest.mark.nightly
def test_picture_away(page):
    closed(page)
    page.evaluate("""() => { const gl = window.__viserMutable.scene.__r3f.root.getState().gl.getContext();
        window.__context = gl.getExtension("WEBGL_lose_context"); window.__context.loseContext(); }""")
    page.locator("[data-testid=curtain-reload]").wait_for(timeout=20_000)
    wrong = heard(page, "curtain")
    page.evaluate("() => window.__context.restoreContext()")
    page.locator("[data-testid=curtain]").wait_for(state="hidden", timeout=PATIENCE)
    assert wrong == []


@pytest.mark.nightly
def test_the_hall_itself_stays_an_application(page):
    stage = page.locator("[data-testid=stage]")
    assert stage.get_attribute("role") == "application"
    assert stage.get_attribute("aria-label")
