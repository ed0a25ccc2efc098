"""The overlay: readable, large enough to touch, nothing over anything else, still for whoever asked for less motion."""

import math

import pytest
from bench.browser import CHOOSE, displayed, enter, pose, settled, soon
from bench.readable import CROWDED, TARGETS, faint_texts
from bench.track import place
from full_matrix import by_day

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SIZES = {1280: 720, 1024: 768, 768: 1024, 480: 800, 360: 640}
READ = (1280, 360)  # where every text's contrast is measured: style changes with width, colours hardly
LANGUAGES = ("zh", "en")  # both where texts are read; elsewhere English, whose words are longer
DIALOGS = ("list", "settings", "help")
TABS = ("intro", "pictures", "data")


@pytest.fixture(scope="module", params=by_day([360], SIZES), ids=str)
def page(request, plain_hall, chromium):
    """A visitor's page at one size; small ones are touched."""
    size = {"width": request.param, "height": SIZES[request.param]}
    context = chromium.new_context(viewport=size, has_touch=request.param < 700)
    page = context.new_page()
    page.add_init_script(f"({CHOOSE})('low')")
    page.goto(f"{plain_hall.url}/?lang=zh")
    page.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=60_000)
    yield page
    context.close()


def languages(page) -> tuple[str, ...]:
    return LANGUAGES if page.viewport_size["width"] in READ else ("en",)


def speak(page, lang: str) -> None:
    if page.locator("html").get_attribute("lang")[:2] != lang:
        page.evaluate("(lang) => document.querySelector(`[data-testid=lang-${lang}]`).click()", lang)


def sound(page, what: str) -> list[str]:
    """What is wrong with what is now to be seen."""
    settled(page)
    crowded = page.evaluate(CROWDED)
    small = [t for t in page.evaluate(TARGETS) if t["width"] < 43.9 or t["height"] < 43.9]
    wrong = [f"{what}: over {pair}" for pair in crowded["over"]]
    wrong += [f"{what}: too wide {name}" for name in crowded["wide"]]
    wrong += [f"{what}: outside {name}" for name in crowded["out"]]
    wrong += [f"{what}: small {t['name']} {t['width']:.0f}x{t['height']:.0f}" for t in small]
    if page.viewport_size["width"] in READ:
        wrong += [f"{what}: faint {text}" for text in faint_texts(page)]
    return wrong + [f"{what}: scrolls sideways"] * crowded["page"]


def go_in(page) -> None:
    if page.locator("[data-testid=enter-screen]").count():
        page.click("[data-testid=enter]")
        page.locator("[data-testid=enter-screen]").wait_for(state="detached")


@pytest.mark.nightly
def test_enter_screen(page):
    wrong = []
    for lang in languages(page):
        speak(page, lang)
        wrong += sound(page, f"enter {lang}")
    assert wrong == []


def test_hall_and_windows(page):
    go_in(page)
    wrong = []
    place(page, 2.5, 4.6, 0.0)  # before the box: its caption shows
    page.locator("[data-testid=caption]").wait_for()
    for lang in languages(page):
        speak(page, lang)
        wrong += sound(page, f"hall {lang}")
        for name in DIALOGS:
            page.click(f"[data-testid={name}]")
            wrong += sound(page, f"{name} {lang}")
            page.keyboard.press("Escape")
    assert wrong == []


@pytest.mark.nightly
def test_plan(page):
    go_in(page)
    toggle = page.locator("[data-testid=minimap-toggle]")
    before = toggle.get_attribute("aria-expanded")
    toggle.click()
    wrong = sound(page, "plan the other way")
    toggle.click()
    assert toggle.get_attribute("aria-expanded") == before
    assert wrong == []


@pytest.mark.nightly
def test_panel(page):
    go_in(page)
    page.click("[data-testid=list]")
    page.click("[data-testid=list-item-box]")
    page.locator("[data-testid=panel]").wait_for()
    wrong = []
    for lang in languages(page):
        speak(page, lang)
        for tab in TABS:
            page.click(f"[data-testid=tab-{tab}]")
            wrong += sound(page, f"{tab} {lang}")
    page.keyboard.press("Escape")
    page.locator("[data-testid=panel]").wait_for(state="hidden")
    assert wrong == []


@pytest.mark.nightly
@pytest.mark.parametrize("width", by_day([360], READ))
def test_questionnaire_is_readable(plain_hall, chromium, width):
    form = chromium.new_page(viewport={"width": width, "height": SIZES[width]})
    wrong = []
    for lang in LANGUAGES:
        form.goto(f"{plain_hall.url}/questionnaires/garment?lang={lang}")
        form.wait_for_load_state("networkidle")
        wrong += faint_texts(form)
        wrong += ["scrolls sideways"] * form.evaluate(
            "() => document.documentElement.scrollWidth > innerWidth"
        )
    form.close()
    assert wrong == []


RING = """
() => {
  const at = document.activeElement;
  if (!at.closest("#hall-ui")) return null;
  const style = getComputedStyle(at, at.classList.contains("dot") ? "::after" : null);
  return [style.outlineColor, style.outlineWidth, style.boxShadow].join(" ");
}
"""


@pytest.mark.nightly
def test_focus_ring_is_gold_with_a_dark_halo(plain_hall, chromium):
    page = chromium.new_page(viewport={"width": 1280, "height": 720})
    enter(page, f"{plain_hall.url}/?lang=en")
    seen = set()
    for _ in range(12):
        page.keyboard.press("Tab")
        seen.add(page.evaluate(RING))
    seen.discard(None)
    page.close()
    assert len(seen) <= 2  # on things, and round the hall itself
    assert all(ring.startswith("rgb(217, 182, 91) 3px rgb") and "6px" in ring for ring in seen)


@pytest.mark.nightly
@pytest.mark.parametrize("motion", ["reduce", "no-preference"])
def test_motion_is_reduced_on_request(plain_hall, chromium, motion):
    """Nothing fades, slides or turns by itself, and no view flies."""
    context = chromium.new_context(viewport={"width": 480, "height": 270}, reduced_motion=motion)
    page = context.new_page()
    enter(page, f"{plain_hall.url}/?lang=en")
    place(page, 2.5, 4.8, 0.0)
    turned = "() => window.__viserMutable.nodeRefFromName['/exhibits/box'].quaternion.y"
    page.mouse.move(100, 100)
    page.wait_for_timeout(600)
    before = page.evaluate(turned)
    page.mouse.move(120, 100)
    if motion == "reduce":
        page.wait_for_timeout(900)
        assert page.evaluate(turned) == before
    else:
        soon(page, lambda: page.evaluate(turned) != before)
    moving = page.evaluate("""() => [...document.querySelectorAll("#hall-ui, #hall-ui *")].filter((e) => {
        const s = getComputedStyle(e);
        return s.transitionDuration.split(",").some((t) => parseFloat(t) > 0) || s.animationName !== "none";
    }).length""")
    page.click("[data-testid=list]")
    page.click("[data-testid=list-item-box]")
    page.locator("[data-testid=panel]").wait_for()
    page.wait_for_function("() => hall.displayed()[0] > 400", timeout=60_000)
    there = displayed(page)
    page.wait_for_timeout(600)
    assert displayed(page) == pytest.approx(there, abs=1e-6)
    assert there[0] > 400
    context.close()
    assert (moving == 0) == (motion == "reduce")


PROJECTED = """
(name) => {
  const m = window.__viserMutable;
  let mesh = null;
  m.nodeRefFromName[name].traverse((child) => { if (child.isMesh && !mesh) mesh = child; });
  mesh.geometry.computeBoundingSphere();
  const p = mesh.geometry.boundingSphere.center.clone().applyMatrix4(mesh.matrixWorld).project(m.camera);
  return [(p.x + 1) / 2 * innerWidth, (1 - p.y) / 2 * innerHeight];
}
"""
HIT = """
([name, x, y]) => {
  const m = window.__viserMutable, state = m.scene.__r3f.root.getState();
  const pointer = state.pointer.clone().set((x / innerWidth) * 2 - 1, 1 - (y / innerHeight) * 2);
  state.raycaster.setFromCamera(pointer, m.camera);
  return state.raycaster.intersectObject(m.nodeRefFromName[name], true).length > 0;
}
"""


@pytest.mark.nightly
@pytest.mark.parametrize(("width", "height"), [(1280, 720), (390, 844)], ids=["desk", "phone"])
def test_garment_stays_in_the_free_part(plain_hall, chromium, width, height):
    page = chromium.new_page(viewport={"width": width, "height": height})
    enter(page, f"{plain_hall.url}/?lang=en")
    page.click("[data-testid=list]")
    page.click("[data-testid=list-item-box]")
    page.locator("html[data-closeup=drawn]").wait_for(state="attached", timeout=60_000)
    page.wait_for_timeout(500)

    def stands() -> bool:
        """The picture has the window's size, and a second look finds the garment where it was."""
        before = page.evaluate(PROJECTED, "/closeup")
        page.wait_for_timeout(300)
        full = page.evaluate("() => window.__viserMutable.canvas.clientWidth === innerWidth")
        return full and page.evaluate(PROJECTED, "/closeup") == before

    def check() -> None:
        x, y = page.evaluate(PROJECTED, "/closeup")
        panel = page.locator("[data-testid=panel]").bounding_box()
        tools = page.locator(".tools").bounding_box()
        assert tools["y"] + tools["height"] < y
        if width > 720:
            assert abs(x - panel["x"] / 2) < 20
        else:
            assert abs(x - panel["width"] / 2) < 20
            assert y < panel["y"] - 60
        assert page.evaluate(HIT, ["/closeup", x, y])
        assert not page.evaluate(HIT, ["/closeup", x, min(y + height * 0.45, height)])

    check()
    page.set_viewport_size({"width": width - 60, "height": height - 40})
    width, height = width - 60, height - 40
    page.wait_for_timeout(900)
    soon(page, stands)
    check()
    page.keyboard.press("Escape")
    page.locator("[data-testid=panel]").wait_for(state="hidden")
    soon(page, lambda: not page.evaluate("() => window.__viserMutable.camera.view?.enabled"))
    page.set_viewport_size({"width": width, "height": height - 30})
    page.wait_for_timeout(600)
    assert not page.evaluate("() => window.__viserMutable.camera.view?.enabled")
    page.close()


@pytest.mark.nightly
def test_clicks_follow_a_moved_view(plain_hall, chromium):
    page = chromium.new_page(viewport={"width": 900, "height": 800})
    enter(page, f"{plain_hall.url}/?lang=en")
    place(page, 2.5, 5.2, 0.0)
    straight = page.evaluate(PROJECTED, "/exhibits/box")
    page.evaluate("""() => { const m = window.__viserMutable;
        m.camera.setViewOffset(innerWidth, innerHeight, -220, 60, innerWidth, innerHeight); m.requestRender(); }""")
    there = pytest.approx([straight[0] + 220, straight[1] - 60], abs=2)
    soon(page, lambda: page.evaluate(PROJECTED, "/exhibits/box") == there)
    moved = page.evaluate(PROJECTED, "/exhibits/box")
    page.mouse.click(straight[0], straight[1] - 150)  # where its upper part was
    page.wait_for_timeout(700)
    assert page.evaluate("() => hall.opened()") is None
    assert pose(page)["z"] == pytest.approx(5.2, abs=0.3)
    page.mouse.click(moved[0], moved[1] - 150)  # where it is seen
    page.locator("[data-testid=panel]").wait_for(timeout=60_000)
    assert page.evaluate("() => hall.opened()") == "box"
    page.close()


TURNED = """() => {
    const [w, , y] = window.__viserMutable.nodePoseData["/exhibits/box"].wxyz;
    return 2 * Math.atan2(y, w);
}"""


@pytest.mark.nightly
def test_a_moving_exhibit_shows_all_the_same_side(plain_hall, chromium):
    """By the hall's clock: whoever comes later, too; and not at all for whoever asked for less motion."""
    contexts = [
        chromium.new_context(viewport={"width": 320, "height": 240}, reduced_motion=motion)
        for motion in ("no-preference", "no-preference", "reduce")
    ]
    pages = []
    for context in contexts:
        pages.append(context.new_page())
        enter(pages[-1], plain_hall.url)
        place(pages[-1], 2.5, 4.6, 0.0)
    one, other, calm = pages
    begin = [page.evaluate(TURNED) for page in pages]

    def apart() -> float:
        for page in (one, other):
            page.mouse.move(100, 100)  # somebody is there
        away = one.evaluate(TURNED) - other.evaluate(TURNED)
        return abs(math.remainder(away, math.tau))

    soon(one, lambda: apart() < 0.1 and abs(math.remainder(one.evaluate(TURNED) - begin[0], math.tau)) > 0.5)
    assert calm.evaluate(TURNED) == begin[2] == 0.0
    for context in contexts:
        context.close()
