"""A curator's day in a browser: an exhibit of his own, from files to the hall and back; pages clean and whole."""

import json
import math
import urllib.request

import pytest
from bench.axe import violations
from bench.browser import PATIENCE, alive, enter, soon
from full_matrix import by_day
from read_pages import read_whole
from test_browser_me import PASSWORD, SMALL, page_of, press_to
from test_browser_office import clerk, engaged

from hall_app.house.people import Role

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SHOWN_WITHIN = 5.0  # [s] of being published: what a curator is promised
COLLECTION = (
    *("/office/collection", "/office/collection/box", "/office/collection/box/text?file=exhibit.toml"),
    *(f"/office/collection/box/{part}" for part in ("preview", "place", "history")),
    *("/office/bakes", "/office/questionnaires", "/office/backups", "/office/collection/nothing"),
)
PLACED = "document.getElementById('place-place.x').value"


def exhibits(hall) -> dict[str, str]:
    with urllib.request.urlopen(f"{hall.url}/api/scene") as answer:
        return {one["id"]: one["title"]["en"] for one in json.load(answer)["exhibits"]}


def until_shown(hall, page, key: str, title: str | None) -> None:
    """What the hall shows under that name, within what is promised; None: nothing."""
    soon(page, lambda: exhibits(hall).get(key) == title, patience=SHOWN_WITHIN)


# What a visitor's page draws under that name, and what its list of exhibits calls it.
DRAWN = """(key) => {
  let meshes = 0;
  window.__viserMutable.nodeRefFromName[`/exhibits/${key}`]?.traverse((one) => { meshes += one.isMesh ? 1 : 0; });
  return meshes > 0;
}"""
LISTED = "(key) => document.querySelector(`[data-testid=list-item-${key}]`)?.textContent ?? null"


def until_seen(visitor, key: str, title: str | None) -> None:
    """By who stands in the hall all the while and loads nothing anew; a page may take its time to draw."""
    if not visitor.locator("[data-testid=list-item-box]").count():
        visitor.click("[data-testid=list]")
    alive(visitor, lambda: visitor.evaluate(DRAWN, key) == (title is not None), PATIENCE / 1000)
    alive(visitor, lambda: listed(visitor, key, title), PATIENCE / 1000)


def listed(visitor, key: str, title: str | None) -> bool:
    """The list follows the hall by a step of its own."""
    found = visitor.evaluate(LISTED, key)
    return found is None if title is None else title in (found or "")


# Pixels of the canvas as text, by which one view is told from another.
PIXELS = "document.querySelector('.drawn canvas').toDataURL()"


def turned_by_hand(page) -> None:
    """The model that was brought, in three dimensions: by key, by button, by mouse; clean to axe."""
    begin = page.get_by_role("button", name="Turn it")
    begin.focus()
    page.keyboard.press("Enter")
    canvas = page.get_by_role("application", name="arrow keys turn it")
    canvas.wait_for(timeout=120_000)
    assert page.evaluate("document.activeElement.tagName") == "CANVAS", "keys reach it at once"
    views = [page.evaluate(PIXELS)]
    for key in ("ArrowLeft", "ArrowUp", "+"):
        page.keyboard.press(key)
        views.append(page.evaluate(PIXELS))
    page.get_by_role("button", name="Turn right").click()
    views.append(page.evaluate(PIXELS))
    box = canvas.bounding_box()
    page.mouse.move(box["x"] + 50, box["y"] + 60)
    page.mouse.down()
    page.mouse.move(box["x"] + 130, box["y"] + 60)
    page.mouse.up()
    views.append(page.evaluate(PIXELS))
    assert len(set(views)) == len(views), "each shows it from elsewhere"
    assert violations(page) == []
    touched = "[...document.querySelectorAll('.turning button')].map((one) => one.getBoundingClientRect())"
    assert page.evaluate(f"{touched}.every((box) => box.width >= 44 && box.height >= 44)")


@pytest.mark.door
def test_a_curator_s_day(office_hall, chromium, tmp_path):
    from PIL import Image

    Image.new("RGB", (1600, 900), "#31506b").save(tmp_path / "Front view.jpg")
    Image.new("RGB", (900, 900), "#7a4b2e").save(tmp_path / "back.png")
    hall = office_hall
    visitor = chromium.new_context(viewport={"width": 480, "height": 270}).new_page()
    enter(visitor, f"{hall.url}/?lang=en")
    until_seen(visitor, "box", "Plain box")
    page = chromium.new_context(viewport={"width": 1280, "height": 800}).new_page()
    page.set_default_timeout(120_000)  # a walk through the hall takes a while where others work
    page.goto(f"{hall.url}/office?lang=en")
    page.fill("#sign-in-address", engaged(hall, Role.CURATOR)[0])
    page.fill("#sign-in-password", PASSWORD)
    page.get_by_role("button", name="Sign in").click()
    page.get_by_role("link", name="Collection").first.click()
    page.fill("#exhibit-id", "blue-box")
    page.fill("[id='exhibit-title.zh']", "蓝匣")
    page.fill("[id='exhibit-title.en']", "Blue box")
    page.get_by_role("button", name="Begin a draft").click()
    page.get_by_role("heading", name="Blue box").wait_for()

    def upload(use: str, *files, **words: str) -> None:
        page.select_option("#upload-use", use)
        page.set_input_files("#upload-file", [str(file) for file in files])
        for name, text in words.items():
            page.fill(f"[id='upload-alt.{name}']", text)
        page.get_by_role("button", name="Upload to the draft").click()
        page.get_by_role("status").wait_for()

    upload("hall", hall.content / "exhibits/box/box.glb")
    upload("picture", tmp_path / "Front view.jpg", tmp_path / "back.png", zh="一只蓝匣", en="A blue box")
    shown = page.locator(".media > li > img")
    assert shown.count() == 2
    widths = "[...document.querySelectorAll('.media > li > img')].map((one) => one.naturalWidth)"
    soon(page, lambda: page.evaluate(widths) == [1600, 900])
    page.locator(".drawn img").scroll_into_view_if_needed()
    drawn = "document.querySelector('.drawn img').naturalWidth"
    soon(page, lambda: page.evaluate(drawn) == 480, patience=120)
    turned_by_hand(page)
    page.get_by_role("link", name="Place on the plan").click()
    page.get_by_role("img", name="Plan").wait_for()
    drag(page)
    page.get_by_role("button", name="Save to the draft").click()
    page.locator("#reached[data-state=yes]").wait_for(timeout=120_000)
    assert -3 < float(page.evaluate(PLACED)) < -2
    assert violations(page) == []
    page.get_by_role("link", name="Back to the exhibit").click()
    page.get_by_role("link", name="Preview").click()
    page.get_by_role("article").get_by_role("heading", name="Blue box").wait_for()
    assert page.locator("article img").count() == 3
    assert page.locator(".faults").count() == 0
    assert "blue-box" not in exhibits(hall), "a draft is not in the hall"
    page.get_by_role("button", name="Publish").click()
    page.get_by_role("status").wait_for(timeout=120_000)
    until_shown(hall, page, "blue-box", "Blue box")
    until_seen(visitor, "blue-box", "Blue box")

    page.goto(f"{hall.url}/office/collection/box?lang=en")
    press_to(page, "Save")  # the first form's, by key alone
    page.focus("[id='words-title.en']")
    page.keyboard.press("Control+A")
    page.keyboard.type("A box renamed")
    page.keyboard.press("Enter")
    page.get_by_role("heading", name="A box renamed", level=1).wait_for()
    page.get_by_role("button", name="Publish").click()
    page.get_by_text("there is no draft").wait_for(timeout=120_000)
    until_shown(hall, page, "box", "A box renamed")
    until_seen(visitor, "box", "A box renamed")
    page.get_by_role("link", name="History").click()
    page.get_by_role("button", name="Undo this change").click()
    page.get_by_text("Undone").wait_for(timeout=120_000)
    until_shown(hall, page, "box", "Plain box")
    until_seen(visitor, "box", "Plain box")
    page.goto(f"{hall.url}/office/collection/blue-box/history?lang=en")
    page.get_by_role("button", name="Undo this change").click()
    page.get_by_text("Undone").wait_for(timeout=120_000)
    until_shown(hall, page, "blue-box", None)
    until_seen(visitor, "blue-box", None)
    visitor.context.close()
    page.context.close()


def drag(page) -> None:
    """The exhibit on the plan, four metres to the left of where a new one stands; then its arrow, all round it."""
    before = float(page.evaluate(PLACED))
    scale = page.evaluate("document.getElementById('plan').getScreenCTM().a")

    def from_middle(right: float, down: float) -> tuple[float, float]:
        at = page.evaluate("(({e, f}) => [e, f])(document.getElementById('own').getScreenCTM())")
        return at[0] + right * scale, at[1] + down * scale

    def drawn(start: tuple[float, float], end: tuple[float, float]) -> None:
        page.mouse.move(*start)
        page.mouse.down()
        page.mouse.move(*end, steps=8)
        page.mouse.up()

    drawn(from_middle(0, 0), from_middle(-before - 2.5, 0))
    assert abs(float(page.evaluate(PLACED)) + 2.5) < 0.2
    there, front = page.evaluate(PLACED), 0.75  # [m] from the middle of the box to its arrow
    ways = {(1, 0): "90", (0, -1): "180", (-1, 0): "270", (-1, 1): "315", (0, 1): "0"}
    at = (0.0, 1.0)
    for way, facing in ways.items():
        drawn(from_middle(front * at[0], front * at[1]), from_middle(3 * way[0], 3 * way[1]))
        assert page.evaluate("document.getElementById('place-place.facing').value") == facing
        length = math.hypot(*way)
        at = (way[0] / length, way[1] / length)
    assert page.evaluate(PLACED) == there, "what is turned stays where it is"


@pytest.mark.parametrize("width", by_day([390], [320, 390, 1280]))
@pytest.mark.parametrize("lang", by_day(["zh"], ["zh", "en"]))
def test_the_collection_is_clean_and_fits(office_hall, chromium, lang, width):
    hall = office_hall
    clerks, _ = clerk(hall, Role.ADMINISTRATOR)
    seal = json.loads(clerks.ask("GET", "/api/office/me").body)["seal"]
    told = {"Content-Type": "application/json", "Origin": hall.url, "X-Seal": seal}
    draft = json.dumps(
        {"title.en": "A drafted box", "record.colour.zh": "红", "record.colour.en": "red"}
    ).encode()
    assert clerks.ask("POST", "/api/office/collection/box/fields", draft, told).status == 200
    assert clerks.ask("POST", "/api/office/backups", b"{}", told).status == 200
    assert (
        clerks.get("/office/collection/box/picture?name=box.glb").status == 200
    )  # drawn before the pages ask
    page = page_of(chromium, clerks, width)
    page.goto(
        f"{hall.url}/office/collection/box/place?lang={lang}"
    )  # which shows itself again once the walk is done
    page.locator("#reached:not([data-state=wait])").wait_for(timeout=240_000)
    for path in COLLECTION:
        mark = "&" if "?" in path else "?"
        read_whole(page, f"{hall.url}{path}{mark}lang={lang}", width, SMALL)
        assert page.evaluate("document.activeElement.id") == "main", path
    seen = json.dumps({"seen": json.loads(clerks.get("/api/office/collection/box").body)["mark"]}).encode()
    clerks.ask("POST", "/api/office/collection/box/drop", seen, told)
    page.context.close()
