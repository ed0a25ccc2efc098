"""The user centre as a visitor meets it: signing in and out, forms that nobody else can send, everything out again."""

from __future__ import annotations

import io
import itertools
import json
import re
import subprocess
import sys
import time
import zipfile
from urllib.parse import urlencode

import pyotp
import pytest
from form_visitor import Forms, Visitor
from plain_hall import write_plain_hall
from running_hall import RunningHall, running_hall
from sqlalchemy import create_engine, text

from hall_app.house.people.records import CODE_DAYS, OFFICE_HOURS, VISITOR_DAYS
from hall_app.web.platform.counter import OFFICE, RATES, VISITOR

PASSWORD = "a robe of blue ramie"
NUMBERS = itertools.count()


def member(hall: RunningHall, lang: str = "en") -> tuple[Visitor, str]:
    """A visitor who has just made an account, and its address."""
    address = f"visitor{next(NUMBERS)}@example.org"
    visitor = Visitor(hall.url)
    made = visitor.send(
        f"/me/register?lang={lang}", "form-register", address=address, password=PASSWORD, again=PASSWORD
    )
    assert made.status == 200
    assert "form-sign-in" not in made.text
    return visitor, address


def exhibit_of(visitor: Visitor) -> str:
    return re.findall(r"/me/keep\?exhibit=([a-z0-9-]+)", visitor.get("/catalogue?lang=en").text)[0]


def in_store(hall: RunningHall, words: str) -> bool:
    """Whether the words stand anywhere in the database of people, its log included."""
    files = hall.data.glob("people.sqlite*")
    return any(words.encode() in file.read_bytes() for file in files)


def test_an_account_is_made_and_signed_in_to(plain_hall):
    visitor, address = member(plain_hall)
    assert address in visitor.get("/me?lang=en").text
    out = visitor.send("/me?lang=en", "/me/sign-out")
    assert "You are signed out" in out.text
    assert "hall-me" not in visitor.cookies
    wrong = visitor.send("/me?lang=zh", "form-sign-in", address=address, password="a robe of red ramie")
    assert wrong.status == 400
    assert "邮箱、密码或验证码不对" in wrong.text
    assert f'value="{address}"' in wrong.text, "what was typed stands there again"
    assert PASSWORD not in wrong.text
    back = visitor.send("/me?lang=zh", "form-sign-in", address=address.upper(), password=PASSWORD)
    assert address in back.text


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"again": "another robe of ramie"}, "两次输入的密码不一致"),
        ({"password": "short", "again": "short"}, "密码至少 10 个字符"),
        ({"address": "nobody"}, "这不是电子邮箱地址"),
    ],
)
def test_what_is_refused_is_told_beside_the_form(plain_hall, fields, said):
    whole = {"address": "new@example.org", "password": PASSWORD, "again": PASSWORD} | fields
    told = Visitor(plain_hall.url).send("/me/register?lang=zh", "form-register", **whole)
    assert told.status == 400
    assert f'role="alert">{said}' in told.text


def test_a_cookie_tells_no_script_and_no_other_site(plain_hall):
    visitor = Visitor(plain_hall.url)
    page = visitor.get("/me/register")
    given = page.form("form-register") | {
        "address": "cookie@example.org",
        "password": PASSWORD,
        "again": PASSWORD,
    }
    made = visitor.post("/me/register", given)
    cookies = made.headers.get_all("Set-Cookie")
    (session,) = [cookie for cookie in cookies if cookie.startswith("hall-me=")]
    assert {"httponly", "samesite=lax", "path=/"} <= {part.strip().lower() for part in session.split(";")}
    assert made.headers["Location"].startswith("/me?")


@pytest.mark.parametrize(
    "path",
    [
        "/me",
        "/me/register",
        "/me/open",
        "/me/second-factor",
        "/me/delete",
        "/me/keep?exhibit=chest",
        "/me/answers/new",
    ],
)
def test_pages_with_forms_are_kept_nowhere_and_run_nothing(plain_hall, path):
    for visitor in (Visitor(plain_hall.url), member(plain_hall)[0]):
        answer = visitor.ask("GET", path)
        policy = answer.headers["Content-Security-Policy"]
        assert "default-src 'none'" in policy
        assert "form-action 'self'" in policy
        assert "frame-ancestors 'none'" in policy
        assert "unsafe" not in policy
        assert answer.headers["Cache-Control"] == "no-store"
        assert answer.headers["X-Content-Type-Options"] == "nosniff"
        assert answer.headers["Referrer-Policy"] == "same-origin"
        assert "style=" not in answer.text
        assert "<script" not in answer.text


# Every act of /me, and fields that would do it.
ACTS = {
    "/me/sign-out": {},
    "/me/profile": {"name": "Eve", "language": "en"},
    "/me/password": {"old": PASSWORD, "password": "a robe of red silk", "again": "a robe of red silk"},
    "/me/second-factor/end": {"password": PASSWORD},
    "/me/sessions/end": {"session": "others"},
    "/me/copy": {},
    "/me/delete": {"password": PASSWORD},
    "/me/visits": {"on": "on"},
    "/me/drop": {"exhibit": "chest"},
    "/me/answers/keep": {"code": "0b2c7e7e-8f0e-4e1c-9d0a-3f5b6a7c8d9e", "consent": "on"},
    "/me/answers/withdraw": {"code": "0b2c7e7e-8f0e-4e1c-9d0a-3f5b6a7c8d9e"},
    "/me/answers/forget": {"code": "0b2c7e7e-8f0e-4e1c-9d0a-3f5b6a7c8d9e"},
}


@pytest.mark.parametrize("how", ["elsewhere", "null", "nowhere", "seal", "other seal"])
def test_no_other_page_can_act_for_a_visitor(plain_hall, how):
    """A form from elsewhere, or without its seal, does nothing, whoever is signed in."""
    visitor, address = member(plain_hall)
    seal = {"seal": visitor.get("/me").form("form-profile")["seal"]}
    told = {"Origin": plain_hall.url, "Content-Type": "application/x-www-form-urlencoded"}
    match how:
        case "elsewhere":
            told["Origin"] = "https://elsewhere.example.org"
        case "null":
            told["Origin"] = "null"
        case "nowhere":
            del told["Origin"]
        case "seal":
            seal = {}
        case "other seal":
            seal = {"seal": member(plain_hall)[0].get("/me").form("form-profile")["seal"]}
    for path, fields in ACTS.items():
        answer = visitor.ask("POST", path, urlencode(fields | seal).encode(), told)
        assert answer.status == 403, path
    shown = visitor.get("/me?lang=en")
    assert address in shown.text
    assert "Eve" not in shown.text
    again = Visitor(plain_hall.url).send("/me", "form-sign-in", address=address, password=PASSWORD)
    assert address in again.text


@pytest.mark.parametrize(
    "path", ["sign-in", "sign-out", "profile", "copy", "answers/forget", "second-factor/end"]
)
def test_the_address_of_a_form_leads_to_its_page(plain_hall, path):
    led = Visitor(plain_hall.url).ask("GET", f"/me/{path}?lang=en")
    to = "/me/second-factor" if path.startswith("second") else "/me"
    assert (led.status, led.headers["Location"]) == (303, f"{to}?lang=en")


def test_a_form_of_another_kind_or_too_large_is_refused(plain_hall):
    visitor, _ = member(plain_hall)
    seal = visitor.get("/me").form("form-profile")["seal"]
    large = visitor.post("/me/profile", {"seal": seal, "name": "x" * 30_000})
    assert large.status == 413
    json_kind = visitor.ask(
        "POST",
        "/me/profile",
        json.dumps({"seal": seal, "name": "Eve"}).encode(),
        {"Content-Type": "application/json", "Origin": plain_hall.url},
    )
    assert json_kind.status == 400
    assert "Eve" not in visitor.get("/me").text


def test_who_is_not_signed_in_is_led_there_and_back(plain_hall):
    exhibit = exhibit_of(Visitor(plain_hall.url))
    visitor, address = member(plain_hall)
    visitor.send("/me", "/me/sign-out")
    for path in ("/me/delete", "/me/second-factor", "/me/keep"):
        assert visitor.ask("GET", path).headers["Location"].startswith("/me?")
    asked = visitor.get(f"/me/keep?exhibit={exhibit}&lang=en")
    led = visitor.send(asked, "form-sign-in", address=address, password=PASSWORD)
    assert led.address.startswith(f"/me/keep?exhibit={exhibit}")


@pytest.mark.parametrize(
    "way", ["https://elsewhere.example.org/", "//elsewhere.example.org", "/\\elsewhere", "x"]
)
def test_signing_in_leads_nowhere_else(plain_hall, way):
    visitor, address = member(plain_hall)
    visitor.send("/me", "/me/sign-out")
    page = visitor.get("/me")
    given = page.form("form-sign-in") | {"address": address, "password": PASSWORD, "next": way}
    assert visitor.post("/me/sign-in", given).headers["Location"].startswith("/me?")


def test_favourites_and_visits_are_kept_when_asked(plain_hall):
    visitor, _ = member(plain_hall)
    exhibit = exhibit_of(visitor)
    assert "among your favourites" in visitor.send(f"/me/keep?exhibit={exhibit}&lang=en", "form-keep").text
    assert f"/?exhibit={exhibit}&amp;lang=en" in visitor.get("/me?lang=en").text
    dropped = visitor.send("/me?lang=en", "/me/drop", found={"exhibit": exhibit})
    assert f"/?exhibit={exhibit}" not in dropped.text
    assert visitor.get("/me/keep?exhibit=no-such-thing&lang=en").status == 404

    visitor.get(f"/api/exhibits/{exhibit}")
    assert f"/?exhibit={exhibit}" not in visitor.get("/me?lang=en").text, "nothing is kept unasked"
    visitor.send("/me?lang=en", "/me/visits")
    assert visitor.ask("HEAD", f"/api/exhibits/{exhibit}").status == 200
    for _ in range(20):
        assert f"/?exhibit={exhibit}" not in visitor.get("/me?lang=en").text, "who asks so sees nothing of it"
    visitor.get(f"/api/exhibits/{exhibit}")
    for _ in range(100):
        if f"/?exhibit={exhibit}" in (shown := visitor.get("/me?lang=en")).text:
            break
    assert f"/?exhibit={exhibit}" in shown.text
    assert f"/?exhibit={exhibit}" not in visitor.send(shown, "/me/visits").text


def test_sessions_are_ended_from_another_device(plain_hall):
    visitor, address = member(plain_hall)
    phone = Visitor(plain_hall.url)
    phone.send("/me", "form-sign-in", address=address, password=PASSWORD)
    assert address in phone.get("/me").text
    visitor.send("/me?lang=en", "/me/sessions/end", found={"session": "others"})
    assert address not in phone.get("/me").text
    assert address in visitor.get("/me").text


def test_a_new_password_holds_and_ends_the_others(plain_hall):
    visitor, address = member(plain_hall)
    phone = Visitor(plain_hall.url)
    phone.send("/me", "form-sign-in", address=address, password=PASSWORD)
    new = "a coat of green gauze"
    wrong = visitor.send("/me?lang=en", "form-password", old="not the one", password=new, again=new)
    assert "The password is wrong" in wrong.text
    right = visitor.send("/me?lang=en", "form-password", old=PASSWORD, password=new, again=new)
    assert "The password is changed" in right.text
    assert address not in phone.get("/me").text
    phone.send("/me", "form-sign-in", address=address, password=new)
    assert address in phone.get("/me").text


def test_the_second_factor_is_set_up_and_asked_for(plain_hall):
    visitor, address = member(plain_hall)
    page = visitor.get("/me/second-factor?lang=en")
    secret = page.form("form-second-factor")["secret"]
    wrong = visitor.send(page, "form-second-factor", code="000000", password=PASSWORD)
    assert "check the phone" in wrong.text
    assert wrong.form("form-second-factor")["secret"] == secret, "the square that was scanned stays good"
    assert (
        visitor.send(page, "form-second-factor", secret="A" * 31, code="1", password=PASSWORD).status == 400
    )
    told = visitor.send(wrong, "form-second-factor", code=pyotp.TOTP(secret).now(), password=PASSWORD)
    codes = re.findall(r"<code>([-A-Z0-9]{14})</code>", told.text)
    assert len(set(codes)) == 10
    other = Visitor(plain_hall.url)
    without = other.send("/me", "form-sign-in", address=address, password=PASSWORD)
    assert without.status == 400
    other.send("/me", "form-sign-in", address=address, password=PASSWORD, code=codes[0])
    assert address in other.get("/me").text
    without = visitor.send("/me?lang=en", "form-factor-off", password=PASSWORD)
    assert without.status == 400
    assert "the authenticator that is on" in without.text
    page = visitor.get("/me/second-factor?lang=en")  # another phone
    newer = page.form("form-second-factor")["secret"]
    given = {"code": pyotp.TOTP(newer).now(), "password": PASSWORD}
    assert visitor.send(page, "form-second-factor", **given).status == 400
    told = visitor.send(page, "form-second-factor", present=codes[1], **given)
    codes = re.findall(r"<code>([-A-Z0-9]{14})</code>", told.text)
    off = visitor.send("/me?lang=en", "form-factor-off", password=PASSWORD, code=codes[0])
    assert "The second factor is off" in off.text


def test_a_code_from_the_house_sets_a_new_password(plain_hall):
    _, address = member(plain_hall)
    command = [sys.executable, "-m", "hall_app", "admin", "link", address, "--data", str(plain_hall.data)]
    link = subprocess.run([*command, "--url", plain_hall.url], capture_output=True, text=True, check=True)
    way = link.stdout.split()[-1].removeprefix(plain_hall.url)
    visitor, new = Visitor(plain_hall.url), "a coat of green gauze"
    page = visitor.get(way)
    short = visitor.send(page, "form-open", password="short", again="short")
    assert short.status == 400
    opened = visitor.send(short, "form-open", password=new, again=new)
    assert address in opened.text
    again = Visitor(plain_hall.url).send(way, "form-open", password=new, again=new)
    assert again.status == 400


def test_everything_is_taken_out_and_deleted_is_gone(plain_hall):
    visitor, address = member(plain_hall)
    exhibit = exhibit_of(visitor)
    visitor.send("/me?lang=en", "form-profile", name="Zhinu the weaver", language="en")
    visitor.send(f"/me/keep?exhibit={exhibit}", "form-keep")
    copy = visitor.send("/me", "/me/copy")
    assert copy.headers["Content-Type"] == "application/zip"
    with zipfile.ZipFile(io.BytesIO(copy.body)) as archive:
        files = {name: archive.read(name).decode() for name in archive.namelist()}
    assert json.loads(files["account.json"])["address"] == address
    assert [one["exhibit"] for one in json.loads(files["favourites.json"])] == [exhibit]
    assert in_store(plain_hall, "Zhinu the weaver")
    assert "backups made before" in visitor.get("/me/delete?lang=en").text
    wrong = visitor.send("/me/delete?lang=en", "form-delete", password="not the one")
    assert "The password is wrong" in wrong.text
    gone = visitor.send("/me/delete?lang=en", "form-delete", password=PASSWORD)
    assert "The account is deleted" in gone.text
    assert "hall-me" not in visitor.cookies
    assert not in_store(plain_hall, "Zhinu the weaver")
    assert not in_store(plain_hall, address)


def test_guessing_is_slowed_and_says_for_how_long(plain_hall):
    visitor, address = member(plain_hall)
    visitor.send("/me", "/me/sign-out")
    page = visitor.get("/me?lang=en")
    given = page.form("form-sign-in") | {"address": address, "password": "a robe of red ramie"}
    tries = [visitor.post("/me/sign-in", given) for _ in range(RATES["account from here"].amount + 1)]
    assert [one.status for one in tries] == [400] * (len(tries) - 1) + [429]
    assert re.search(r"try again in \d+ seconds", tries[-1].text)
    right = visitor.post("/me/sign-in", given | {"password": PASSWORD})
    assert right.status == 429
    other, theirs = member(plain_hall)
    assert theirs in other.get("/me").text, "others go on"


def joined(counter) -> tuple[Visitor, str]:
    """A visitor of the counter who has just made an account, and its address."""
    visitor, address = Visitor(counter.url), f"paced{next(NUMBERS)}@example.org"
    fields = {"address": address, "password": PASSWORD, "again": PASSWORD}
    page = visitor.get("/me/register?lang=en").form("form-register")
    made = visitor.post("/me/register", page | fields, X_Forwarded_For=f"192.0.2.{next(NUMBERS) % 250}")
    assert made.status == 303
    return visitor, address


def tried(visitor: Visitor, address: str, password: str, network: str) -> int:
    """The answer to signing in from there."""
    given = visitor.get("/me/open?lang=en").form("form-open")  # any form of the browser's has its seal
    return visitor.post(
        "/me/sign-in", given | {"address": address, "password": password}, X_Forwarded_For=network
    ).status


@pytest.fixture
def later(monkeypatch):
    """Let time pass, for what counts tries."""
    gone, clock = [0.0], time.time
    monkeypatch.setattr(time, "time", lambda: clock() + gone[0])

    def by(seconds: float) -> None:
        gone[0] += seconds

    return by


def test_signing_in_rightly_is_never_counted_against_an_account(counter):
    _, address = joined(counter)
    assert {tried(Visitor(counter.url), address, PASSWORD, "198.51.100.1") for _ in range(30)} == {303}


def test_who_guesses_from_one_address_shuts_nobody_else_out(counter, later):
    _, address = joined(counter)
    guesser, answers = Visitor(counter.url), []
    for _ in range(20):
        answers += [tried(guesser, address, "a guess at it", "198.51.100.2") for _ in range(12)]
        later(301)
        assert tried(Visitor(counter.url), address, "mistyped by me", "198.51.100.3") == 400
        assert tried(Visitor(counter.url), address, PASSWORD, "198.51.100.3") == 303
        later(301)
    assert answers.count(400) <= 20 / 6 * RATES["account share"].amount + RATES["account share"].amount
    assert set(answers) == {400, 429}


def guessed_from_everywhere(counter, address: str) -> None:
    for number in range(RATES["account"].amount // 5 + 1):
        for _ in range(5):
            tried(Visitor(counter.url), address, "a guess at it", f"203.0.113.{number}")


def test_a_browser_that_was_let_in_before_is_counted_by_itself(counter):
    visitor, address = joined(counter)
    guessed_from_everywhere(counter, address)
    assert tried(Visitor(counter.url), address, PASSWORD, "198.51.100.4") == 429, (
        "the account's tries are gone"
    )
    visitor.send("/me?lang=en", "/me/sign-out")
    assert tried(visitor, address, PASSWORD, "198.51.100.4") == 303
    visitor.send("/me?lang=en", "/me/sign-out")
    own = [tried(visitor, address, "mistyped by me", "198.51.100.4") for _ in range(11)]
    assert own == [400] * RATES["account from here"].amount + [429]


def test_what_a_browser_is_known_by_is_of_one_account_and_of_its_password(counter):
    visitor, address = joined(counter)
    other, _ = joined(counter)
    guessed_from_everywhere(counter, address)
    for mark in (other.cookies["hall-known"], visitor.cookies["hall-known"][:-1] + "?", "x", "a.b", "."):
        stranger = Visitor(counter.url, {"hall-known": mark})
        assert tried(stranger, address, PASSWORD, "198.51.100.5") == 429
    former = visitor.cookies["hall-known"]
    assert address not in former
    new = "a coat of green gauze"
    visitor.send("/me?lang=en", "form-password", old=PASSWORD, password=new, again=new)
    assert tried(Visitor(counter.url, {"hall-known": former}), address, new, "198.51.100.5") == 429
    visitor.send("/me?lang=en", "/me/sign-out")
    assert tried(visitor, address, new, "198.51.100.5") == 303, "who changed it is known by the new one"


def test_the_mark_of_a_browser_is_read_by_no_script(counter):
    visitor, address = joined(counter)
    given = visitor.get("/me?lang=en").form("form-profile")
    answer = visitor.post("/me/sign-in", given | {"address": address, "password": PASSWORD})
    (mark,) = [one for one in answer.headers.get_all("Set-Cookie") if one.startswith("hall-known=")]
    told = {part.strip().lower() for part in mark.split(";")}
    assert {"httponly", "samesite=lax", "path=/"} <= told
    assert any(part.startswith("max-age=") and int(part[8:]) > 180 * 86400 for part in told)


def test_who_is_signed_in_is_not_hindered_by_who_guesses(counter):
    visitor, address = joined(counter)
    for _ in range(12):
        tried(Visitor(counter.url), address, "a guess at it", "127.0.0.1")
    new = "a coat of green gauze"
    wrong = visitor.send("/me?lang=en", "form-password", old="mistyped by me", password=new, again=new)
    assert wrong.status == 400
    right = visitor.send("/me?lang=en", "form-password", old=PASSWORD, password=new, again=new)
    assert "The password is changed" in right.text


def test_an_account_is_no_condition(plain_hall):
    """Whoever has none gets no session and everything else as before."""
    stranger = Visitor(plain_hall.url)
    for path in ("/", "/catalogue", "/culture", "/research", "/search?q=x", "/api/scene", "/questionnaires"):
        answer = stranger.ask("GET", path)
        assert answer.status == 200, path
        cookies = answer.headers.get_all("Set-Cookie") or []
        assert not [one for one in cookies if one.startswith(("hall-me", "hall-form"))], path


@pytest.mark.parametrize("lang", ["zh", "en"])
def test_pages_are_in_one_language(plain_hall, lang):
    visitor, _ = member(plain_hall, lang)
    for path in ("/me", "/me/second-factor", "/me/delete", "/me/open", "/me/register", "/me/answers/new"):
        answer = visitor.get(f"{path}?lang={lang}")
        main = answer.text.partition("<main")[2].partition("</main>")[0]
        words = re.sub(r"<[^>]*>", " ", main)
        found = bool(re.search("[\u4e00-\u9fff]", words.replace("中文", "")))
        assert found == (lang == "zh"), path
        assert f'<html lang="{lang}">' in answer.text
        assert Forms(answer.text).all


@pytest.mark.slow
def test_a_store_that_is_lost_is_said_and_the_hall_stays_open(tmp_path):
    with running_hall(write_plain_hall(tmp_path / "content"), tmp_path) as hall:
        visitor, _ = member(hall)
        engine = create_engine(f"sqlite:///{hall.data / 'people.sqlite'}")
        with engine.begin() as connection:
            connection.execute(text("DROP TABLE session"))
        engine.dispose()
        lost = visitor.get("/me?lang=en")
        assert lost.status == 503
        assert "try again in a minute" in lost.text
        for path in ("/", "/catalogue", "/api/scene"):
            assert visitor.get(path).status == 200


@pytest.mark.parametrize("lang", ["zh", "en"])
def test_what_is_kept_is_told_before_one_makes_an_account(counter, lang):
    stranger = Visitor(counter.url)
    assert f'href="/me/privacy?lang={lang}"' in stranger.get(f"/me/register?lang={lang}").text
    told = stranger.get(f"/me/privacy?lang={lang}")
    assert told.status == 200
    for figure in (VISITOR_DAYS, OFFICE_HOURS, CODE_DAYS):
        assert f" {figure} " in told.text
    assert stranger.cookies.keys() <= {"hall-form", "hall-place"}
    for name in (OFFICE.name, VISITOR.name, "hall-form", "hall-known", "hall-place"):
        assert name in told.text, "every cookie is named"
