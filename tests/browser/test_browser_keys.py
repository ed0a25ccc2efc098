"""Turning and looking level by key, and what Enter means after a jump: real key presses in a real page."""

import math

import pytest
from bench.browser import displayed, enter, rested, soon
from bench.track import place
from full_matrix import by_day
from plain_hall import EXHIBIT, write_plain_hall
from running_hall import running_hall

pytestmark = [pytest.mark.browser, pytest.mark.slow]

VIEW = {"width": 640, "height": 480}
STEP = math.radians(15)
RATE = math.radians(90)

# When a turning key went down and came up [ms]; registered ahead of the page's own listeners, which stop the event.
TURNS = """
() => {
  window.__turns = [];
  const note = ({ code, timeStamp, repeat }) =>
    !repeat && /KeyQ|KeyE|Arrow/.test(code) && window.__turns.push(timeStamp);
  for (const kind of ["keydown", "keyup"]) addEventListener(kind, note, true);
}
"""

TAP = """
([code, shiftKey]) => {
  const event = (kind) => new KeyboardEvent(kind, { code, shiftKey, bubbles: true, cancelable: true });
  for (const kind of ["keydown", "keyup"]) document.activeElement.dispatchEvent(event(kind));
}
"""

CHORD = """
([held, key]) => {
  const code = key === "Home" ? key : `Key${key.toUpperCase()}`;
  const flag = { Control: "ctrlKey", Alt: "altKey", Meta: "metaKey" }[held];
  const event = (kind) => new KeyboardEvent(kind, { code, key, [flag]: true, bubbles: true, cancelable: true });
  for (const kind of ["keydown", "keyup"]) document.activeElement.dispatchEvent(event(kind));
}
"""


@pytest.fixture(scope="module")
def hall(tmp_path_factory):
    """The plain hall with a second exhibit."""
    work = tmp_path_factory.mktemp("keys")
    content = write_plain_hall(work / "content")
    box, cup = content / "exhibits" / "box", content / "exhibits" / "cup"
    cup.mkdir()
    for file in box.iterdir():
        (cup / file.name).write_bytes(file.read_bytes())
    text = (
        EXHIBIT.replace("方匣", "杯")
        .replace("Plain box", "Plain cup")
        .replace("x = 2.5, z = 3.0", "x = -3.5, z = 3.0")
    )
    (cup / "exhibit.toml").write_text(text, "utf-8")
    with running_hall(content, work) as hall:
        yield hall


@pytest.fixture(scope="module")
def page(hall, chromium):
    page = chromium.new_page(viewport=VIEW)
    page.add_init_script(f"({TURNS})()")
    enter(page, f"{hall.url}/?lang=en")
    page.wait_for_timeout(1500)
    yield page
    page.close()


@pytest.fixture(autouse=True)
def standing(page):
    """In the middle of free floor, in the hall, nothing pressed."""
    if page.evaluate("() => hall.opened()"):
        page.wait_for_function("() => document.documentElement.dataset.closeup")  # its panel is there
        page.keyboard.press("Escape")
        page.wait_for_function("() => !hall.opened()")
    place(page, 0.0, 4.5, 0.0)


def still(page) -> dict:
    """The pose once nothing turns any more."""
    return rested(page, "hall.pose()")


def tap(page, key: str) -> None:
    """Down and up within one task of the page: no machine is too busy for that to be a tap."""
    page.evaluate(TAP, [key.removeprefix("Shift+"), key.startswith("Shift+")])


@pytest.mark.door
@pytest.mark.parametrize(
    ("key", "sign"),
    by_day([("KeyQ", 1)], [("KeyQ", 1), ("KeyE", -1), ("Shift+ArrowLeft", 1), ("Shift+ArrowRight", -1)]),
)
def test_a_tap_turns_by_fifteen_degrees_and_taps_add_up(page, key, sign):
    before = still(page)
    tap(page, key)
    assert still(page)["yaw"] - before["yaw"] == pytest.approx(sign * STEP, abs=1e-9)
    for _ in range(3):
        tap(page, key)
    after = still(page)
    assert after["yaw"] - before["yaw"] == pytest.approx(4 * sign * STEP, abs=1e-9)
    assert (after["x"], after["z"], after["eye"]) == (before["x"], before["z"], before["eye"])


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("key", "sign"),
    [("q", 1), ("e", -1), ("Shift+ArrowLeft", 1), ("Shift+ArrowRight", -1)],
)
def test_held_keys_turn_steadily(page, key, sign):
    """Real presses; how long they lasted is taken from the page's own key events."""
    before = still(page)
    page.evaluate("() => { window.__turns.length = 0; }")
    *shift, last = key.split("+")
    for name in shift:
        page.keyboard.down(name)
    page.keyboard.down(last)
    page.wait_for_timeout(1000)
    page.keyboard.up(last)
    for name in shift:
        page.keyboard.up(name)
    after = still(page)
    down, up = page.evaluate("() => window.__turns")
    held = (up - down) / 1000
    turned = sign * (after["yaw"] - before["yaw"])
    assert turned == pytest.approx(RATE * (held - 0.1), abs=0.03 + RATE * 0.1)
    assert math.hypot(after["x"] - before["x"], after["z"] - before["z"]) == 0.0


def test_turning_while_walking_walks_round(page):
    before = still(page)
    page.keyboard.down("w")
    page.keyboard.down("q")
    page.wait_for_function(
        """({ x, z, yaw }) => {
          const at = hall.pose();
          return at.yaw > yaw + 0.8 && at.z < z - 0.3 && at.x < x - 0.1;
        }""",
        arg=before,
        timeout=30_000,
    )
    page.keyboard.up("q")
    page.keyboard.up("w")
    after = still(page)
    assert after["yaw"] > before["yaw"] + 0.8
    assert after["z"] < before["z"] - 0.3
    assert after["x"] < before["x"] - 0.1  # to the left of where W alone leads


@pytest.mark.nightly
def test_home_looks_level(page):
    page.mouse.move(320, 200)
    page.mouse.down()
    page.mouse.move(320, 120, steps=4)
    page.mouse.up()
    before = still(page)
    assert abs(before["pitch"]) > 0.1
    page.keyboard.press("Home")
    after = still(page)
    assert after["pitch"] == 0.0
    assert after["yaw"] == before["yaw"]
    page.wait_for_timeout(300)
    assert displayed(page)[1] == pytest.approx(before["eye"], abs=1e-3)


@pytest.mark.nightly
def test_less_motion_turns_and_levels_at_once(hall, chromium):
    context = chromium.new_context(viewport=VIEW, reduced_motion="reduce")
    page = context.new_page()
    enter(page, f"{hall.url}/?lang=en")
    page.wait_for_timeout(1000)
    page.evaluate("""() => {
      window.__yaws = new Set();
      const look = () => { window.__yaws.add(hall.pose().yaw); requestAnimationFrame(look); };
      look();
    }""")
    before = still(page)["yaw"]
    tap(page, "KeyQ")
    assert still(page)["yaw"] - before == pytest.approx(STEP, abs=1e-9)
    assert len(page.evaluate("() => [...window.__yaws]")) == 2
    context.close()


@pytest.mark.nightly
@pytest.mark.parametrize("chord", ["Control+q", "Alt+e", "Meta+q", "Control+Home"])
def test_chords_are_the_browsers(page, chord):
    before = still(page)
    page.evaluate(CHORD, chord.split("+"))
    assert still(page) == before


@pytest.mark.parametrize("where", by_day(["dialog"], ["field", "dialog"]))
def test_typing_and_windows_keep_their_keys(page, where):
    before = still(page)
    if where == "field":
        page.evaluate("""() => {
          const field = document.createElement("input");
          field.id = "field";
          document.body.append(field);
          field.focus();
        }""")
    else:
        page.click("[data-testid=help]")
    for key in ("q", "e", "Shift+ArrowLeft", "Home"):
        page.keyboard.press(key)
    if where == "field":
        assert (
            page.evaluate("() => { const f = document.querySelector('#field'); f.remove(); return f.value; }")
            == "qe"
        )
    else:
        page.keyboard.press("Escape")
    assert still(page) == before


@pytest.mark.nightly
def test_in_the_close_up_the_arrows_turn_the_exhibit(page):
    before = still(page)
    page.evaluate("() => document.activeElement.blur()")
    page.click("[data-testid=list]")
    page.click("[data-testid=list-item-box]")
    page.wait_for_function("() => document.documentElement.dataset.closeup === 'drawn'", timeout=60_000)
    page.focus("[data-testid=stage]")
    seen = displayed(page)
    page.keyboard.press("Shift+ArrowLeft")
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("q")
    soon(page, lambda: math.dist(displayed(page), seen) > 0.05)
    page.keyboard.press("Escape")
    page.wait_for_function("() => !hall.opened()")
    after = still(page)
    assert (after["yaw"], after["x"], after["z"]) == (before["yaw"], before["x"], before["z"])


@pytest.mark.nightly
def test_help_and_hints_show_the_keys(page):
    hints = page.locator("[data-testid=hints]").text_content()
    assert "Q" in hints
    assert "E" in hints
    page.click("[data-testid=help]")
    told = page.locator("[data-testid=help-dialog]").inner_text()
    for text in ("Q", "E", "Shift ←", "Shift →", "Home", "Turn left", "Turn right", "Look level"):
        assert text in told
    page.keyboard.press("Escape")


def caption_names(page, title: str) -> None:
    page.wait_for_function(
        "(title) => document.querySelector('[data-testid=caption] strong').textContent === title "
        "&& !document.querySelector('[data-testid=caption]').hidden",
        arg=title,
        timeout=30_000,
    )


@pytest.mark.nightly
@pytest.mark.parametrize("way", by_day(["dot by key"], ["dot by key", "dot by mouse", "list"]))
def test_enter_after_a_jump_opens_what_the_caption_names(page, way):
    if not page.locator("[data-testid=minimap-plan]").is_visible():
        page.click("[data-testid=minimap-toggle]")
    if way == "list":
        page.click("[data-testid=list]")
        page.click("[data-testid=list-go-cup]")
    else:
        page.focus("[data-testid=dot-cup]")
        if way == "dot by key":
            page.keyboard.press("Enter")
        else:
            page.click("[data-testid=dot-cup]", force=True)
    caption_names(page, "Plain cup")
    page.keyboard.press("Enter")
    page.wait_for_function("() => hall.opened() === 'cup'", timeout=30_000)


@pytest.mark.nightly
def test_enter_opens_the_captions_exhibit_and_not_the_one_last_chosen(page):
    """Jump to the cup, then stand before the box: the caption says box, and so does Enter."""
    page.click("[data-testid=list]")
    page.click("[data-testid=list-go-cup]")
    caption_names(page, "Plain cup")
    place(page, 2.5, 4.2, 0.0)
    caption_names(page, "Plain box")
    page.keyboard.press("Enter")
    page.wait_for_function("() => hall.opened() === 'box'", timeout=30_000)
