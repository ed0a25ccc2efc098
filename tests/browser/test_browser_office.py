"""Activities, visits and the office in a browser: clean to axe, whole on a phone, done by key alone."""

import contextlib
from datetime import UTC, datetime, timedelta

import pytest
from bench.axe import violations
from form_visitor import Visitor
from full_matrix import by_day
from read_pages import read_whole
from test_browser_me import NUMBERS, PASSWORD, SMALL, member, page_of, press_to

from hall_app.house.people import People, Role
from hall_app.house.people.records import Plan

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SOON = (datetime.now(UTC) + timedelta(days=2)).replace(microsecond=0)


@contextlib.contextmanager
def people_of(hall):
    """Beside the open hall, as `hall admin` works."""
    people = People(hall.data)
    try:
        yield people
    finally:
        people.close()


def plan(hall, kind: str) -> str:
    whole = {"kind": kind, "title_zh": "缂丝工作坊", "title_en": "Tapestry weaving", "places": 2, "party": 2}
    whole |= {
        "text_zh": "带一把剪刀。",
        "text_en": "Bring scissors.",
        "place_zh": "东厢",
        "place_en": "East wing",
    }
    with people_of(hall) as people:
        return people.occasions.plan("console", Plan(begins=SOON, ends=SOON + timedelta(hours=1), **whole))[0]


def engaged(hall, role: Role) -> tuple[str, str]:
    """Somebody of the staff: his address, for which PASSWORD opens, and id."""
    address = f"clerk{next(NUMBERS)}@example.org"
    with people_of(hall) as people:
        person = people.accounts.make("console", address)
        people.accounts.use_code(people.accounts.code_for("console", person.id), PASSWORD)
        people.roles.set("console", person.id, frozenset({role}))
    return address, person.id


def clerk(hall, role: Role) -> tuple[Visitor, str]:
    """Somebody of the staff, signed in; his id."""
    visitor, (address, person) = Visitor(hall.url), engaged(hall, role)
    visitor.send("/office", "form-sign-in", address=address, password=PASSWORD)
    return visitor, person


@pytest.mark.parametrize("width", by_day([390], [320, 390, 1280]))
@pytest.mark.parametrize("lang", by_day(["zh"], ["zh", "en"]))
def test_the_programme_is_clean_and_fits(plain_hall, chromium, lang, width):
    activity, visit, visitor = plan(plain_hall, "activity"), plan(plain_hall, "visit"), member(plain_hall)[0]
    visitor.send(f"/activities/{activity}", "form-book", size="2")
    page = page_of(chromium, visitor, width)
    for path in ("activities", f"activities/{activity}", "visit", f"visit/{visit}", "activities/nothing"):
        read_whole(page, f"{plain_hall.url}/{path}?lang={lang}", width, SMALL)
        assert page.evaluate("document.activeElement.id") == "main", path
    page.context.close()


@pytest.mark.parametrize("width", by_day([390], [320, 390, 1280]))
@pytest.mark.parametrize("lang", by_day(["zh"], ["zh", "en"]))
def test_the_office_is_clean_and_fits(plain_hall, chromium, lang, width):
    activity, visitor = plan(plain_hall, "activity"), member(plain_hall)[0]
    visitor.send(f"/activities/{activity}", "form-book", size="2")
    clerks, person = clerk(plain_hall, Role.ADMINISTRATOR)
    clerks.send("/office/tokens", "form-token", label="for the paper")
    outside, page = page_of(chromium, Visitor(plain_hall.url), width), page_of(chromium, clerks, width)
    read_whole(outside, f"{plain_hall.url}/office?lang={lang}", width, SMALL)
    parts = ("", "/events", f"/events/{activity}", f"/day?day={SOON.astimezone():%Y-%m-%d}", "/suggestions")
    for path in (*parts, "/tokens", "/people", f"/people/{person}", "/audit"):
        mark = "&" if "?" in path else "?"
        read_whole(page, f"{plain_hall.url}/office{path}{mark}lang={lang}", width, SMALL)
        assert page.evaluate("document.activeElement.id") == "main", path
    outside.context.close()
    page.context.close()


def test_a_place_is_booked_and_checked_in_by_key_alone(plain_hall, chromium):
    activity = plan(plain_hall, "activity")
    page = page_of(chromium, member(plain_hall)[0], 1000)
    page.goto(f"{plain_hall.url}/activities/{activity}?lang=en")
    page.focus("#book-size")
    page.keyboard.press("ArrowUp")
    press_to(page, "Book")
    page.keyboard.press("Enter")
    page.get_by_role("status").wait_for()
    assert "booked · 2 people" in page.locator("main").inner_text()
    page.context.close()
    page = page_of(chromium, clerk(plain_hall, Role.CURATOR)[0], 1000)
    page.goto(f"{plain_hall.url}/office/events/{activity}?lang=en")
    for words, told in (("Check in", "here"), ("Undo", "booked")):
        press_to(page, words)
        page.keyboard.press("Enter")
        page.get_by_role("cell", name=told, exact=True).wait_for()
    page.focus("#event-title_en")
    page.keyboard.press("Control+A")
    page.keyboard.type("Weaving by hand")
    press_to(page, "Save")
    page.keyboard.press("Enter")
    page.get_by_role("heading", name="Weaving by hand").wait_for()
    assert violations(page) == []
    page.context.close()
