"""Activities, visits and the office in a browser: clean to axe, whole on a phone, done by key alone."""

import contextlib
from datetime import UTC, datetime, timedelta

import pytest
from bench.axe import violations
from form_visitor import Visitor
from full_matrix import by_day
from read_pages import read_whole, see_whole
from test_browser_me import NUMBERS, PASSWORD, SMALL, answered, member, page_of, press_to

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


# Of this hall's activity, visit and account.
PROGRAMME = (
    *("/activities", "/activities/{activity}", "/visit", "/visit/{visit}"),
    "/activities/nothing",
)
OFFICE = (
    *("/office", "/office/events", "/office/events/{activity}", "/office/day?day={day}"),
    *("/office/tokens", "/office/people", "/office/people/{person}", "/office/audit"),
    *("/office/suggestions", "/office/questionnaires/garment/analysis", "/office/restored"),
    *("/office/people/nothing", "/office/nothing"),
)


@pytest.mark.parametrize("width", by_day([390], [320, 390, 1280]))
@pytest.mark.parametrize("lang", by_day(["zh"], ["zh", "en"]))
def test_the_programme_is_clean_and_fits(plain_hall, chromium, lang, width):
    activity, visit, visitor = plan(plain_hall, "activity"), plan(plain_hall, "visit"), member(plain_hall)[0]
    visitor.send(f"/activities/{activity}", "form-book", size="2")
    page = page_of(chromium, visitor, width)
    for path in PROGRAMME:
        where = path.format(activity=activity, visit=visit)
        read_whole(page, f"{plain_hall.url}{where}?lang={lang}", width, SMALL)
        assert page.evaluate("document.activeElement.id") == "main", path
    page.context.close()


@pytest.mark.parametrize("width", by_day([390], [320, 390, 1280]))
@pytest.mark.parametrize("lang", by_day(["zh"], ["zh", "en"]))
def test_the_office_is_clean_and_fits(office_hall, chromium, lang, width):
    activity, visitor = plan(office_hall, "activity"), member(office_hall)[0]
    visitor.send(f"/activities/{activity}", "form-book", size="2")
    for number in range(8):
        answered(visitor, number, said="Larger letters, please.")
    clerks, person = clerk(office_hall, Role.ADMINISTRATOR)
    clerks.send("/office/tokens", "form-token", label="for the paper")
    outside, page = page_of(chromium, Visitor(office_hall.url), width), page_of(chromium, clerks, width)
    read_whole(outside, f"{office_hall.url}/office?lang={lang}", width, SMALL)
    day = f"{SOON.astimezone():%Y-%m-%d}"
    for path in OFFICE:
        where, mark = path.format(activity=activity, person=person, day=day), "&" if "?" in path else "?"
        read_whole(page, f"{office_hall.url}{where}{mark}lang={lang}", width, SMALL)
        assert page.evaluate("document.activeElement.id") == "main", path
    page.goto(f"{office_hall.url}/office/suggestions?lang={lang}")
    assert page.locator(".said").first.inner_text() == "Larger letters, please."
    outside.context.close()
    page.context.close()


# Pages that have no address to open: a deed answers with them, and they are shown this once.
ANSWERS = ("people/{key}/code", "tokens", "backups/{key}/restore")


@pytest.mark.parametrize("width", by_day([390], [320, 390, 1280]))
@pytest.mark.parametrize("lang", by_day(["zh"], ["zh", "en"]))
def test_what_deeds_answer_with_is_clean_and_fits(office_hall, chromium, lang, width):
    clerks, person = clerk(office_hall, Role.ADMINISTRATOR)
    clerks.send("/office/backups", "form-make")
    page, tell = page_of(chromium, clerks, width), f"?lang={lang}"

    def answer(path: str, sent: str) -> None:
        """Press the button, see what comes."""
        with page.expect_navigation() as came:
            page.locator(sent).first.press("Enter")
        assert came.value.status == 200, path
        assert page.locator("h1").count() == 1
        see_whole(page, width, SMALL)

    page.goto(f"{office_hall.url}/office/people/{person}{tell}")
    answer(ANSWERS[0], f"form[action='/office/people/{person}/code'] button")
    page.goto(f"{office_hall.url}/office/tokens{tell}")
    page.fill("#token-label", "for the paper")
    answer(ANSWERS[1], "#form-token button")
    page.goto(f"{office_hall.url}/office/backups{tell}")
    page.locator("summary").first.click()
    page.fill("#restore-0-name", page.locator("li code").first.inner_text())
    answer(ANSWERS[2], "#form-restore-0 button")
    page.context.close()


@pytest.mark.parametrize("width", by_day([390], [320, 390, 1280]))
@pytest.mark.parametrize("lang", by_day(["zh"], ["zh", "en"]))
def test_what_is_refused_is_clean_and_fits(office_hall, chromium, lang, width, tmp_path):
    """Who may not; a file that is none; a text that somebody else changed; a form that is of another session."""
    page = page_of(chromium, clerk(office_hall, Role.CURATOR)[0], width)
    came = page.goto(f"{office_hall.url}/office/people?lang={lang}")
    assert came.status == 403
    see_whole(page, width, SMALL)
    at = f"{office_hall.url}/office/collection/crate"

    def refused(sent: str, status: int) -> None:
        with page.expect_navigation() as came:
            page.locator(sent).first.press("Enter")
        assert came.value.status == status
        assert page.get_by_role("alert").count() == 1
        see_whole(page, width, SMALL)

    (tmp_path / "drawing.svg").write_text("<html xmlns='http://www.w3.org/1999/xhtml'/>", "utf-8")
    page.goto(f"{at}?lang={lang}")
    page.set_input_files("#upload-file", str(tmp_path / "drawing.svg"))
    refused("#form-upload button", 400)
    page.goto(f"{at}/text?file=text.en.md&lang={lang}")
    page.fill("#text-text", "A crate, as one sees it.")
    other = page.context.new_page()
    other.goto(f"{at}/text?file=text.en.md&lang={lang}")
    other.fill("#text-text", f"A crate, as another sees it, {width} {lang}.")
    other.locator("#form-text button").click()
    other.close()
    refused("#form-text button", 409)
    assert page.locator(".diff").count() >= 1
    page.goto(f"{at}?lang={lang}")
    page.evaluate("document.querySelector('#form-words [name=seal]').value = 'of another session'")
    refused("#form-words button", 403)
    page.context.close()


@pytest.mark.door
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
