"""The address names what is open: links, Back, Forward, loading again, and where that leaves the visitor."""

import contextlib
import math
from urllib.parse import parse_qs, urlsplit

import pytest
from bench.browser import PATIENCE, at_rest, back_in_the_hall, displayed, enter, pose, soon
from bench.track import place
from plain_hall import write_plain_hall
from running_hall import free_port, running_hall

pytestmark = [pytest.mark.browser, pytest.mark.slow]

BOX = (2.5, 3.0)  # where it stands [m]
ENTRANCE = (0.0, 4.0)
PANEL = "[data-testid=panel]"


@pytest.fixture
def page(chromium):
    context = chromium.new_context(viewport={"width": 480, "height": 540})
    yield context.new_page()
    context.close()


def named(page) -> tuple[str | None, str | None]:
    """Exhibit and language the address names."""
    asked = parse_qs(urlsplit(page.url).query)
    return asked.get("exhibit", [None])[0], asked.get("lang", [None])[0]


def is_open(page) -> None:
    page.locator(PANEL).wait_for(timeout=PATIENCE)
    page.wait_for_function("() => hall.opened() === 'box' && location.search.includes('exhibit=box')")
    page.wait_for_function("() => document.title.startsWith('Plain box · ')")


def is_closed(page) -> None:
    page.locator(PANEL).wait_for(state="hidden", timeout=PATIENCE)
    page.wait_for_function("() => hall.opened() === null && !location.search.includes('exhibit')")
    page.wait_for_function("() => document.title === 'Plain hall'")
    back_in_the_hall(page)


def open_by_list(page) -> None:
    page.click("[data-testid=list]")
    page.click("[data-testid=list-item-box]")
    is_open(page)


def reload(page) -> None:
    page.reload()
    page.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=PATIENCE)
    page.click("[data-testid=enter]")
    page.locator("[data-testid=enter-screen]").wait_for(state="detached", timeout=PATIENCE)


def stands_before_the_box(page) -> None:
    """Near it, the display where the server is, and the box in the middle of the view."""
    at = pose(page)
    dx, dz = BOX[0] - at["x"], BOX[1] - at["z"]
    assert 0.7 < math.hypot(dx, dz) < 3.0
    ahead = (-math.sin(at["yaw"]) * dx - math.cos(at["yaw"]) * dz) / math.hypot(dx, dz)
    assert ahead > math.cos(math.radians(5))
    x, _, z = displayed(page)
    assert (x, z) == pytest.approx((at["x"], at["z"]), abs=0.01)


@pytest.mark.nightly
def test_an_open_exhibit_is_named_and_back_and_forward_lead_out_and_in(plain_hall, page):
    enter(page, f"{plain_hall.url}/?lang=en")
    place(page, 1.0, -3.0, 0.7)
    before = at_rest(page)
    open_by_list(page)
    assert named(page) == ("box", "en")
    page.go_back()
    is_closed(page)
    assert at_rest(page) == pytest.approx(before, abs=1e-6)
    page.go_forward()
    is_open(page)
    page.keyboard.press("Escape")
    is_closed(page)
    assert named(page) == (None, "en")
    page.go_forward()
    is_open(page)
    page.go_back()
    is_closed(page)
    assert pose(page)["z"] == pytest.approx(-3.0, abs=0.05)


@pytest.mark.nightly
def test_a_long_visit_leaves_one_entry_behind(plain_hall, page):
    page.goto("about:blank")
    enter(page, f"{plain_hall.url}/?lang=en")
    for _ in range(3):
        open_by_list(page)
        page.keyboard.press("Escape")
        is_closed(page)
    page.go_back(wait_until="commit")
    assert page.url == "about:blank"


@pytest.mark.nightly
def test_leaving_a_direct_link_leads_beside_the_exhibit(plain_hall, page):
    enter(page, f"{plain_hall.url}/?exhibit=box&lang=en")
    is_open(page)
    page.keyboard.press("Escape")
    is_closed(page)
    stands_before_the_box(page)
    page.locator("[data-testid=caption]", has_text="Plain box").wait_for()  # the server knows it too
    assert named(page) == (None, "en")


@pytest.mark.nightly
def test_back_closes_a_direct_link_too(plain_hall, page):
    enter(page, f"{plain_hall.url}/?exhibit=box&lang=en")
    is_open(page)
    page.go_back()
    is_closed(page)
    stands_before_the_box(page)


@pytest.mark.nightly
def test_back_leaves_a_window_over_the_exhibit_as_well(plain_hall, page):
    enter(page, f"{plain_hall.url}/?lang=en")
    open_by_list(page)
    page.click("[data-testid=tab-pictures]")
    page.locator(".picture").first.click()
    page.locator("dialog[open]").wait_for()
    page.go_back()
    is_closed(page)
    assert page.locator("dialog[open]").count() == 0


@pytest.mark.nightly
def test_a_link_to_nothing_says_so(plain_hall, page):
    enter(page, f"{plain_hall.url}/?exhibit=nowhere&lang=zh")
    page.locator("[data-testid=toast]", has_text="没有找到").wait_for()
    assert named(page) == (None, "zh")
    assert page.evaluate("() => hall.opened()") is None
    at = pose(page)
    assert (at["x"], at["z"]) == pytest.approx(ENTRANCE, abs=0.05)


@pytest.mark.nightly
def test_loading_again_opens_it_again_and_keeps_the_spot(plain_hall, page):
    enter(page, f"{plain_hall.url}/?lang=en")
    place(page, 1.0, -3.0, 0.7)
    open_by_list(page)
    reload(page)
    is_open(page)
    page.keyboard.press("Escape")
    is_closed(page)
    at = pose(page)
    assert (at["x"], at["z"], at["yaw"]) == pytest.approx((1.0, -3.0, 0.7), abs=0.05)


def test_loading_again_comes_back_to_spot_heading_and_eye(plain_hall, page):
    enter(page, f"{plain_hall.url}/?lang=en")
    place(page, -3.0, 2.0, 2.1)
    page.mouse.move(240, 300)
    page.mouse.down()
    page.mouse.move(240, 260)
    page.mouse.up()
    before = pose(page)
    assert before["pitch"] != 0
    reload(page)
    page.wait_for_timeout(300)
    after = pose(page)
    for name in ("x", "z", "yaw", "pitch", "eye"):
        assert after[name] == pytest.approx(before[name], abs=0.02), name

    def walked() -> float:
        return math.hypot(pose(page)["x"] - before["x"], pose(page)["z"] - before["z"])

    page.keyboard.down("KeyW")  # and the server stands there as well
    soon(page, lambda: walked() > 0.05)
    page.keyboard.up("KeyW")
    page.wait_for_function("() => hall.ahead() === 0", timeout=PATIENCE)  # its last word has come
    assert 0.05 < walked() < 2.0


@pytest.mark.nightly
def test_a_spot_that_is_built_over_by_now_is_left_for_the_nearest_free_one(plain_hall, page):
    enter(page, f"{plain_hall.url}/?lang=en")
    page.evaluate(
        "() => addEventListener('pagehide', () => sessionStorage.setItem('hall.spot',"
        " JSON.stringify({x: 5.2, z: 0.3, yaw: 1, pitch: 0, eye: 9})))"  # within the block; an eye out of bounds
    )
    reload(page)
    page.wait_for_timeout(300)
    at = pose(page)
    assert max(abs(at["x"] - 5.0), abs(at["z"])) > 1.2
    assert math.hypot(at["x"] - 5.2, at["z"] - 0.3) < 2.0
    assert at["eye"] <= 2.4
    assert displayed(page)[1] == pytest.approx(at["eye"], abs=0.01)


@pytest.mark.nightly
@pytest.mark.parametrize("kept", ["", "{", "null", '{"x": "here", "z": 1}'])
def test_a_spoilt_note_is_no_spot(plain_hall, page, kept):
    enter(page, f"{plain_hall.url}/?lang=en")
    page.evaluate(
        "(kept) => addEventListener('pagehide', () => sessionStorage.setItem('hall.spot', kept))", kept
    )
    reload(page)
    page.wait_for_timeout(300)
    at = pose(page)
    assert (at["x"], at["z"]) == pytest.approx(ENTRANCE, abs=0.05)


@pytest.mark.nightly
def test_a_fresh_visit_begins_at_the_entrance(plain_hall, page):
    enter(page, f"{plain_hall.url}/?lang=en")
    place(page, 1.0, -3.0, 0.7)
    with contextlib.closing(page.context.new_page()) as other:
        enter(other, f"{plain_hall.url}/?lang=en")
        other.wait_for_timeout(300)
        assert (pose(other)["x"], pose(other)["z"]) == pytest.approx(ENTRANCE, abs=0.05)
    enter(page, f"{plain_hall.url}/?lang=zh")  # a typed address in the same tab
    page.wait_for_timeout(300)
    assert (pose(page)["x"], pose(page)["z"]) == pytest.approx(ENTRANCE, abs=0.05)


@pytest.mark.nightly
def test_the_language_stays_in_the_address(plain_hall, page):
    enter(page, f"{plain_hall.url}/?lang=zh")
    page.click("[data-testid=lang-en]")
    assert named(page) == (None, "en")
    open_by_list(page)
    page.click("[data-testid=lang-zh]")
    assert named(page) == ("box", "zh")
    page.wait_for_function("() => document.title === '方匣 · 素厅'")
    page.go_back()
    page.wait_for_function("() => document.title === '素厅'")
    assert named(page) == (None, "zh")
    reload(page)
    assert page.locator("html").get_attribute("lang")[:2] == "zh"


@pytest.mark.nightly
def test_esc_leaves_an_exhibit_whose_text_does_not_come(page, plain_hall):
    enter(page, f"{plain_hall.url}/?lang=en")
    page.route("**/api/exhibits/**", lambda route: None)  # never answered
    page.click("[data-testid=list]")
    page.click("[data-testid=list-item-box]")
    page.wait_for_function("() => hall.opened() === 'box'")
    page.keyboard.press("Escape")
    page.wait_for_function("() => hall.opened() === null && !location.search.includes('exhibit')")
    before = pose(page)
    page.keyboard.down("w")
    page.wait_for_function("z => Math.abs(hall.pose().z - z) > 0.1", arg=before["z"], timeout=PATIENCE)
    page.keyboard.up("w")


@pytest.mark.nightly
def test_an_exhibit_whose_text_fails_is_said(page, plain_hall):
    enter(page, f"{plain_hall.url}/?lang=en")
    page.route("**/api/exhibits/**", lambda route: route.abort())
    page.click("[data-testid=list]")
    page.click("[data-testid=list-item-box]")
    page.locator("[data-testid=toast]", has_text="did not arrive").wait_for(timeout=PATIENCE)
    is_closed(page)


@pytest.mark.nightly
def test_a_link_opens_also_where_the_line_was_lost_before_entering(page, tmp_path):
    content, port = write_plain_hall(tmp_path / "content"), free_port()
    with running_hall(content, tmp_path / "work", port=port) as hall:
        page.add_init_script("localStorage['hall.quality'] ??= 'low'")
        page.goto(f"{hall.url}/?lang=en&exhibit=box")
        page.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=PATIENCE)
    page.locator("[data-testid=connection]").wait_for(timeout=PATIENCE)
    page.click("[data-testid=enter]")
    with running_hall(content, tmp_path / "work", port=port):
        is_open(page)
        page.close()


@pytest.mark.nightly
def test_of_two_edits_the_later_one_stays_though_the_earlier_arrives_after_it(page, tmp_path):
    content = write_plain_hall(tmp_path / "content")
    toml = content / "exhibits" / "box" / "exhibit.toml"
    first = toml.read_text("utf-8")
    with running_hall(content, tmp_path / "work") as hall:
        enter(page, f"{hall.url}/?lang=en")
        held = []

        def late(route) -> None:
            if held:
                route.continue_()
            else:
                held.append((route, route.fetch()))

        page.route("**/api/scene", late)
        toml.write_text(first.replace("Plain box", "Early box"), "utf-8")
        soon(page, lambda: held)
        toml.write_text(first.replace("Plain box", "Later box"), "utf-8")
        named_in_list = "() => document.querySelector('[data-testid=list-item-box]')?.textContent ?? ''"
        soon(page, lambda: "Later box" in page.evaluate(named_in_list))
        route, answer = held[0]
        route.fulfill(response=answer)
        page.wait_for_timeout(1500)
        assert "Later box" in page.evaluate(named_in_list)


@pytest.mark.nightly
def test_language_chosen_on_the_door_stays_in_the_address(page, plain_hall):
    page.goto(f"{plain_hall.url}/?lang=zh")
    page.click("[data-testid=lang-en]")
    assert named(page)[1] == "en"
    page.reload()
    page.wait_for_function("() => document.documentElement.lang === 'en'")
