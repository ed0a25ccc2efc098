"""Every form of the platform by keyboard alone: reached in its turn, seen to have the focus, filled in and sent."""

import json
import re
from dataclasses import dataclass

import pytest
from form_keys import send_all_forms
from form_visitor import Visitor
from full_matrix import by_day
from test_browser_me import PASSWORD, answered, member, page_of
from test_browser_office import SOON, clerk, plan

from hall_app.house.people import Role

pytestmark = [pytest.mark.browser, pytest.mark.slow]

# page -> (who asks, forms at least, those that must be sent: of the path below the hall)
PAGES = {
    "/me": ("stranger", ("/me/sign-in",)),
    "/me/register": ("stranger", ("/me/register",)),
    "/me/open": ("stranger", ("/me/open",)),
    "/me/privacy": ("stranger", ("/search",)),
    "/office": ("stranger", ("/office/sign-in",)),
    "/search?q=box": ("stranger", ("/search",)),
    "/questionnaires/garment": ("stranger", ("/api/v1/questionnaires/garment/submissions",)),
    "/me?": (
        "member",
        (
            *("/me/sign-out", "/me/profile", "/me/password", "/me/sessions/end", "/me/copy", "/me/visits"),
            *("/me/drop", "/me/answers/withdraw", "/me/answers/forget"),
        ),
    ),
    "/me/second-factor": ("member", ("/me/second-factor",)),
    "/me/delete": ("member", ("/me/delete",)),
    "/me/keep?exhibit=crate": ("member", ("/me/keep",)),
    "/me/answers/new": ("member", ("/me/answers/keep",)),
    "{activity}": ("member", ("{activity}/cancel",)),
    "{visit}": ("member", ("{visit}/book",)),
    "/office?": ("clerk", ("/office/sign-out",)),
    "/office/people": ("clerk", ("/office/people",)),
    "/office/people/{person}": (
        "clerk",
        tuple(f"/office/people/{{person}}/{deed}" for deed in ("roles", "code", "sign-out", "close")),
    ),
    "/office/tokens": ("clerk", ("/office/tokens", "/office/tokens/{token}/revoke")),
    "/office/suggestions": ("clerk", ("/office/suggestions/{suggestion}",)),
    "/office/events": ("clerk", ("/office/events", "/office/visits")),
    "/office/events/{event}": (
        "clerk",
        (
            *("/office/events/{event}", "/office/events/{event}/off"),
            *(f"/office/events/{{event}}/bookings/{{booking}}/{deed}" for deed in ("arrive", "cancel")),
        ),
    ),
    "/office/day?day={day}": ("clerk", ("/office/events/{event}/bookings/{booking}/arrive",)),
    "/office/backups": (
        "clerk",
        ("/office/backups", "/office/backups/{backup}/remove", "/office/backups/{backup}/restore"),
    ),
    "/office/collection": ("clerk", ("/office/collection",)),
    "/office/collection/crate": (
        "clerk",
        tuple(
            f"/office/collection/crate/{deed}"
            for deed in ("fields", "text", "upload", "remove", "drop", "publish")
        ),
    ),
    "/office/collection/crate/text?file=exhibit.toml": ("clerk", ("/office/collection/crate/text",)),
    "/office/collection/crate/place": ("clerk", ("/office/collection/crate/place",)),
    "/office/collection/crate/history": ("clerk", ("/office/collection/crate/undo",)),
    "/office/collection/crate/preview": ("clerk", ("/office/collection/crate/publish",)),
}


@dataclass(frozen=True)
class Set:
    """visitors: who asks; names: what stands in the addresses."""

    visitors: dict[str, Visitor]
    names: dict[str, str]


@pytest.fixture(scope="module")
def ready(office_hall):
    """Something in every place where there is a form to it."""
    hall = office_hall
    event, hours = plan(hall, "activity"), plan(hall, "visit")
    (reader, address), staff = member(hall), clerk(hall, Role.ADMINISTRATOR)[0]
    Visitor(hall.url).send(
        "/me", "form-sign-in", address=address, password=PASSWORD
    )  # a second session to end
    reader.send(f"/activities/{event}", "form-book", size="2")
    reader.send("/me/keep?exhibit=box", "form-keep")
    reader.send("/me", "/me/visits")
    code = answered(reader, said="Larger letters, please.")
    reader.send("/me/answers/new", "form-keep-code", code=code, consent="on")

    def tell(path: str, given: object = None):
        if given is None:
            return json.loads(staff.ask("GET", f"/api/office/{path}").body)
        seal = json.loads(staff.ask("GET", "/api/office/me").body)["seal"]
        told = {"Content-Type": "application/json", "Origin": hall.url, "X-Seal": seal}
        answer = staff.ask("POST", f"/api/office/{path}", json.dumps(given).encode(), told)
        assert answer.status == 200, answer.text
        return json.loads(answer.body)

    crate = "collection/crate"
    for colour in ("brown", "dark brown"):
        tell(f"{crate}/fields", {"record.colour.zh": "褐", "record.colour.en": colour})
        if colour == "brown":
            tell(f"{crate}/publish", {})
    tell("tokens", {"label": "for the paper"})
    assert staff.get(f"/office/{crate}/picture?name=box.glb").status == 200  # drawn before the pages ask
    names = {
        "activity": f"/activities/{event}",
        "visit": f"/visit/{hours}",
        "event": event,
        "booking": str(tell(f"events/{event}")["bookings"][0]["id"]),
        "person": tell("people", {"address": f"colleague-{event[:8]}@example.org"})["id"],
        "token": str(tell("tokens")[-1]["id"]),
        "suggestion": tell("suggestions")[0]["id"],
        "backup": tell("backups", {})["name"],
        "day": f"{SOON.astimezone():%Y-%m-%d}",
    }
    return Set({"stranger": Visitor(hall.url), "member": reader, "clerk": staff}, names)


@pytest.mark.parametrize("width", by_day([390], [390, 1280]))
@pytest.mark.parametrize("lang", by_day(["zh"], ["zh", "en"]))
@pytest.mark.parametrize("path", PAGES)
def test_every_form_is_filled_in_and_sent_by_key_alone(
    office_hall, chromium, ready, path, lang, width, tmp_path
):
    who, forms = PAGES[path]
    (tmp_path / "scan.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "utf-8")
    page = page_of(chromium, ready.visitors[who], width)
    where = path.format(**ready.names).rstrip("?")
    page.goto(f"{office_hall.url}{where}{'&' if '?' in where else '?'}lang={lang}")
    page.locator("#reached[data-state=wait]").wait_for(state="detached", timeout=240_000)
    sent = {one.to for one in send_all_forms(page, str(tmp_path / "scan.obj"))}
    assert sent >= {one.format(**ready.names) for one in forms}
    page.context.close()


def test_what_is_dragged_on_the_plan_is_placed_by_key_alone(office_hall, chromium, ready):
    """The numbers beside the drawing move the exhibit on it, and are what is saved; both while the walk is awaited."""
    page = page_of(chromium, ready.visitors["clerk"], 1280)
    page.goto(f"{office_hall.url}/office/collection/crate/place?lang=en")

    def write(*numbers: str) -> None:
        for name, value in zip(("x", "z", "facing"), numbers, strict=True):
            for _ in range(80):
                if page.evaluate("document.activeElement.id") == f"place-place.{name}":
                    break
                page.keyboard.press("Tab")
            page.keyboard.press("Control+A")
            page.keyboard.type(value)

    def moved() -> list[str]:
        return re.findall(r"-?[\d.]+", page.locator("#own").get_attribute("transform"))

    def placed() -> tuple[float, ...]:
        answer = ready.visitors["clerk"].ask("GET", "/api/office/collection/crate/place")
        return tuple(json.loads(answer.body)["place"][name] for name in ("x", "z", "facing"))

    write("-5.5", "4.25", "90")
    assert moved() == ["-5.5", "4.25", "-90"]
    with page.expect_navigation(timeout=120_000):
        page.keyboard.press("Enter")
    assert placed() == (-5.5, 4.25, 90.0)
    write("-5.25", "4", "45")
    page.locator("#reached:not([data-state=wait]) :first-child").wait_for(timeout=240_000)
    assert moved() == ["-5.25", "4", "-45"], "what was written is lost when the walk is done"
    page.keyboard.press("Enter")
    page.wait_for_function(
        "document.getElementById('place-place.x').defaultValue === '-5.25'", timeout=120_000
    )
    assert placed() == (-5.25, 4.0, 45.0)
    page.context.close()
