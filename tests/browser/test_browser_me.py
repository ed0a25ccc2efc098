"""The user centre in a browser: clean to axe, whole on a phone, done by key alone."""

import itertools
import json
import uuid

import pyotp
import pytest
from bench.axe import violations
from bench.browser import enter
from form_visitor import Visitor
from full_matrix import by_day
from read_pages import read_whole, see_whole

pytestmark = [pytest.mark.browser, pytest.mark.slow]

PASSWORD = "a robe of blue ramie"
NUMBERS = itertools.count()
OUTSIDE = ("/me", "/me/register", "/me/open", "/me/privacy", "/me/answers/new")
INSIDE = (
    *("/me", "/me/second-factor", "/me/delete", "/me/answers/new"),
    *("/me/keep?exhibit={exhibit}", "/me/keep?exhibit=nothing"),
)
TOUCHED = (
    "main :is(button, select, .tick label), main input:not([type=hidden], [type=checkbox]), .site a, .doors a"
)
SMALL = (
    f'() => [...document.querySelectorAll("{TOUCHED}")]'
    """.map((one) => [one.textContent.trim() || one.id, one.getBoundingClientRect()])
  .filter(([, box]) => box.height && (box.height < 43.9 || box.width < 23.9)).map(([text]) => text)
"""
)


def member(hall) -> tuple[Visitor, str]:
    visitor, address = Visitor(hall.url), f"reader{next(NUMBERS)}@example.org"
    visitor.send("/me/register", "form-register", address=address, password=PASSWORD, again=PASSWORD)
    return visitor, address


def answered(visitor: Visitor, number: int = 0, *, said: str = "") -> str:
    """A questionnaire was sent; its code. number: by which one answer differs from another; said: a suggestion."""
    asked = json.loads(visitor.get("/api/v1/questionnaires/garment").text)
    items = [item["id"] for module in asked["modules"] for item in module["items"]]
    code = str(uuid.uuid4())
    told = {"id": code, "version": asked["version"], "language": "zh", "consent": True}
    told["scores"] = {item: 1 + (3 + number * (1 + at % 4)) % 5 for at, item in enumerate(items)}
    told["suggestions"] = {asked["modules"][0]["id"]: said} if said else {}
    sent = visitor.ask(
        "POST",
        "/api/v1/questionnaires/garment/submissions",
        json.dumps(told).encode(),
        {"Content-Type": "application/json"},
    )
    assert sent.status < 300, sent.text
    return code


def page_of(chromium, visitor: Visitor, width: int):
    context = chromium.new_context(viewport={"width": width, "height": 800})
    context.add_cookies(
        [{"name": name, "value": value, "url": visitor.url} for name, value in visitor.cookies.items()]
    )
    return context.new_page()


@pytest.mark.parametrize("width", by_day([390], [320, 390, 1280]))
@pytest.mark.parametrize("lang", by_day(["zh"], ["zh", "en"]))
@pytest.mark.parametrize("signed_in", [False, True])
def test_pages_are_clean_and_fit(plain_hall, chromium, lang, width, signed_in):
    visitor = member(plain_hall)[0] if signed_in else Visitor(plain_hall.url)
    page = page_of(chromium, visitor, width)
    found = visitor.get("/catalogue").text.partition("/me/keep?exhibit=")[2].partition("&")[0]
    if signed_in:
        visitor.send(f"/me/keep?exhibit={found}", "form-keep")
        visitor.send("/me", "/me/visits")
        visitor.send("/me/answers/new", "form-keep-code", code=answered(visitor), consent="on")
    for path in INSIDE if signed_in else OUTSIDE:
        mark = "&" if "?" in path else "?"
        address = f"{plain_hall.url}{path.format(exhibit=found)}{mark}lang={lang}"
        read_whole(page, address, width, SMALL)
        assert page.evaluate("document.activeElement.id") == "main", path
    page.context.close()


@pytest.mark.parametrize("width", by_day([390], [320, 390, 1280]))
@pytest.mark.parametrize("lang", by_day(["zh"], ["zh", "en"]))
def test_recovery_codes_and_the_page_with_a_second_factor_are_clean_and_fit(
    plain_hall, chromium, lang, width
):
    page = page_of(chromium, member(plain_hall)[0], width)
    page.goto(f"{plain_hall.url}/me/second-factor?lang={lang}")
    secret = page.locator("#form-second-factor [name=secret]").get_attribute("value")
    page.fill("#second-factor-code", pyotp.TOTP(secret).now())
    page.fill("#second-factor-password", PASSWORD)
    with page.expect_navigation() as came:
        page.locator("#form-second-factor button").press("Enter")
    assert came.value.status == 200
    assert page.locator(".codes li").count() > 0
    see_whole(page, width, SMALL)
    read_whole(page, f"{plain_hall.url}/me?lang={lang}", width, SMALL)
    page.context.close()


def test_an_exhibit_is_kept_from_its_close_up_by_key_alone(plain_hall, chromium):
    page = page_of(chromium, member(plain_hall)[0], 1000)
    for lang, name in (("zh", "收藏这件展品"), ("en", "Keep this exhibit")):
        enter(page, f"{plain_hall.url}/?exhibit=box&lang={lang}")
        way = page.get_by_role("dialog").get_by_role("link", name=name)
        way.wait_for(timeout=120_000)
        assert way.get_attribute("href") == f"/me/keep?exhibit=box&lang={lang}"
        box = way.bounding_box()
        assert min(box["width"], box["height"]) >= 44
    page.locator("[data-testid=panel]").press("Tab")  # from the title to what comes first after it
    assert page.evaluate("document.activeElement.dataset.testid") == "keep"
    page.keyboard.press("Enter")
    page.locator("#form-keep button").press("Enter")
    page.get_by_role("status").get_by_text("It is among your favourites.").wait_for()
    back = page.get_by_role("link", name="Back to the hall").get_attribute("href")
    assert back == "/?exhibit=box&lang=en"
    page.context.close()


@pytest.mark.door
def test_signing_up_and_out_by_key_alone(plain_hall, chromium):
    page = page_of(chromium, Visitor(plain_hall.url), 1000)
    refused = []
    page.on("console", lambda said: refused.append(said.text) if "Security" in said.text else None)
    page.goto(f"{plain_hall.url}/me?lang=en")
    press_to(page, "Make an account")
    page.keyboard.press("Enter")
    page.wait_for_url("**/me/register**")
    page.focus("#register-address")
    page.keyboard.type(f"keys{next(NUMBERS)}@example.org")
    page.keyboard.press("Tab")
    page.keyboard.type("Keys")
    page.keyboard.press("Tab")
    page.keyboard.type(PASSWORD)
    page.keyboard.press("Tab")
    page.keyboard.type("something else")
    page.keyboard.press("Enter")
    page.get_by_role("alert").wait_for()
    assert violations(page) == []
    assert page.input_value("#register-name") == "Keys"
    for field in ("#register-password", "#register-again"):
        page.focus(field)
        page.keyboard.type(PASSWORD)
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    page.get_by_role("heading", name="Your account").wait_for()
    assert violations(page) == []
    press_to(page, "Sign out")
    page.keyboard.press("Enter")
    page.get_by_role("heading", name="Sign in").wait_for()
    assert refused == [], "nothing that a page does is against its own policy"
    page.context.close()


def test_a_withdrawal_code_is_kept_and_used_by_key_alone(plain_hall, chromium):
    """From the thanks of a questionnaire into the account, which asks first, and back out with the answers."""
    page = page_of(chromium, member(plain_hall)[0], 1000)
    page.goto(f"{plain_hall.url}/questionnaires/garment?lang=en")
    for item in page.locator(".item").all():
        item.locator("input").nth(3).focus()
        page.keyboard.press("Space")
    page.focus("#consent")
    page.keyboard.press("Space")
    press_to(page, "Send my answers")
    page.keyboard.press("Enter")
    page.get_by_role("heading", name="Thank you").wait_for()
    assert violations(page) == []
    code = page.locator("#code").inner_text()
    press_to(page, "Keep it in my account")
    with page.expect_popup() as opened:
        page.keyboard.press("Enter")
    beside = opened.value
    beside.get_by_role("heading", name="Keep a withdrawal code in the account").wait_for()
    assert code not in beside.url, "no history learns the code"
    assert beside.input_value("#keep-code-code") == code
    assert not beside.is_checked("#keep-code-consent")
    assert violations(beside) == []
    press_to(beside, "Keep the code")
    beside.keyboard.press("Enter")
    beside.get_by_role("alert").get_by_text("Tick the box first").wait_for()
    beside.focus("#keep-code-consent")
    beside.keyboard.press("Space")
    press_to(beside, "Keep the code")
    beside.keyboard.press("Enter")
    beside.get_by_role("status").get_by_text("The account keeps the code").wait_for()
    assert beside.get_by_text(code).is_visible()
    assert violations(beside) == []
    press_to(beside, "Withdraw my answers")
    beside.keyboard.press("Enter")
    beside.get_by_role("status").get_by_text("Withdrawn.").wait_for()
    assert beside.get_by_text(code).count() == 0
    page.context.close()


def press_to(page, words: str) -> None:
    """Tab until the element of these words has the focus."""
    for _ in range(60):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.textContent.trim()").startswith(words):
            return
    raise AssertionError(f"no key leads to {words!r}")
