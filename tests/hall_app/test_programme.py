"""Activities and visits as visitors meet them: open to all, booked with an account, cancelled, in a calendar."""

from __future__ import annotations

import io
import json
import re
import time
import zipfile
from datetime import UTC, datetime, timedelta
from html import unescape
from zoneinfo import ZoneInfo

import pytest
from form_visitor import Visitor
from icalendar import Calendar
from office_clerk import clerk
from open_counter import open_counter
from test_me import PASSWORD, member

from hall_app.content.search import Query, SearchIndex
from hall_app.house.people import People, Role
from hall_app.house.people.records import Plan
from hall_app.web.platform import programme_entries

SOON = datetime.now(UTC).replace(microsecond=0) + timedelta(days=3)


@pytest.fixture
def planned(counter):
    """A function that plans an occasion beside the open hall, as the office does."""

    def plan(**changed) -> str:
        whole = {"kind": "activity", "title_zh": "缂丝工作坊", "title_en": "Tapestry <weaving>", "places": 2}
        whole |= {"begins": SOON, "ends": SOON + timedelta(hours=2), "party": 2, "place_zh": "东厢"}
        whole |= {"text_zh": "带一把剪刀。\n穿便服。", "text_en": "Bring scissors."}
        return counter.people.occasions.plan("console", Plan(**(whole | changed)))[0]

    return plan


def test_the_programme_is_open_to_all(counter, planned):
    activity, visit = planned(), planned(kind="visit", title_en="Guided hour")
    stranger = Visitor(counter.url)
    listed = stranger.get("/activities?lang=en").text
    assert f"/activities/{activity}?lang=en" in listed
    assert "Tapestry &lt;weaving&gt;" in listed
    assert visit not in listed
    assert f"/visit/{visit}?lang=zh" in stranger.get("/visit?lang=zh").text
    stranger.get(f"/activities/{activity}.ics")
    shown = stranger.get(f"/activities/{activity}?lang=zh").text
    assert not stranger.cookies, "nothing of this has a form"
    assert "余 2 位（共 2 位）" in shown
    assert "东厢" in shown
    assert "form-book" not in shown
    assert "东厢" in stranger.get(f"/activities/{activity}?lang=en").text, (
        "what is not translated is told as it is"
    )


@pytest.mark.parametrize("path", ["/activities/nothing", "/visit/nothing", "/activities/nothing.ics"])
@pytest.mark.parametrize(("lang", "title"), [("zh", "没有这一页"), ("en", "There is no such page")])
def test_what_is_not_planned_is_not_found(counter, path, lang, title):
    told = Visitor(counter.url).get(f"{path}?lang={lang}")
    assert told.status == 404
    assert f"<h1>{title}</h1>" in told.text
    assert f'href="/{path.split("/")[1]}?lang={lang}"' in told.text, "and the way to what there is"


@pytest.fixture
def house_stands_in(monkeypatch):
    """A function that sets the zone whose clock the house goes by."""

    def stands(zone: str) -> None:
        monkeypatch.setenv("TZ", zone)
        time.tzset()

    yield stands
    monkeypatch.undo()
    time.tzset()


@pytest.mark.parametrize(
    ("zone", "told"),
    [("Asia/Shanghai", "UTC+8"), ("Asia/Kolkata", "UTC+5:30"), ("Etc/GMT+3", "UTC−3"), ("UTC", "UTC")],
)
def test_pages_that_tell_hours_say_once_by_which_clock(counter, planned, house_stands_in, zone, told):
    house_stands_in(zone)
    activity, visit = planned(), planned(kind="visit")
    visitor, _ = member(counter)
    keeper = clerk(counter, counter.people, Role.ADMINISTRATOR)
    keeper.told("tokens", {"label": "for the paper"})
    pages = [
        (visitor, way)
        for way in ("/activities", f"/activities/{activity}", "/visit", f"/visit/{visit}", "/me")
    ]
    office = ("events", f"events/{activity}", f"day?day={SOON.astimezone():%Y-%m-%d}", "audit", "tokens")
    for who, way in (*pages, *((keeper, f"/office/{way}") for way in office)):
        for lang, line in (
            ("zh", f"时间为本馆当地时间（现为 {told}）。"),
            ("en", f"All times are the house's local time (at present {told})."),
        ):
            page = who.get(f"{way}{'&' if '?' in way else '?'}lang={lang}").text
            assert unescape(page).count(line) == 1, way
            assert page.count("UTC") == 1, "and beside no hour, where all have the same"
            for at, words in re.findall(r'<time datetime="([^"]+)">([^<]+)</time>', page):
                assert words.endswith(at[11:16])
                assert datetime.fromisoformat(at).utcoffset() == datetime.now().astimezone().utcoffset()
    for who, way in ((visitor, "/me/privacy"), (keeper, "/office"), (keeper, "/office/people")):
        assert "UTC" not in who.get(f"{way}?lang=en").text, "where no hour is told"


@pytest.mark.parametrize("month", [1, 7])
def test_an_hour_of_another_season_says_its_own_offset(counter, planned, house_stands_in, month):
    house_stands_in("Europe/Berlin")
    year = datetime.now().year + 2
    begins = datetime(year, month, 5, 14, 0).astimezone()
    key = planned(kind="visit", begins=begins, ends=begins + timedelta(hours=1))
    summer = month == 7
    same = datetime.now().astimezone().utcoffset() == timedelta(hours=1 + summer)
    for lang, beside in (("zh", f"（UTC+{1 + summer}）"), ("en", f" (UTC+{1 + summer})")):
        end = "" if same else beside
        for way, told in (
            (f"/visit/{key}?", "14:00</time>"),
            (f"/visit?month={year}-{month:02}&", "15:00</time>"),
        ):
            page = Visitor(counter.url).get(f"{way}lang={lang}").text
            assert f"{told}{end}<" in page


def test_places_are_booked_waited_for_and_given_back(counter, planned):
    way = f"/activities/{planned()}?lang=en"
    first, second = member(counter)[0], member(counter)[0]
    page = first.get(way)
    assert "looking" not in page.text
    booked = first.send(page, "form-book", size="2")
    assert "booked · 2 people" in booked.text
    again = first.send(page, "form-book", size="2")
    assert "booked · 2 people" in again.text, "the same form once more is the same booking"
    waiting = second.send(way, "form-book", size="1")
    assert "number 1 on the waiting list" in waiting.text
    assert "Full, 1 waiting" in waiting.text
    action = way.partition("?")[0] + "/cancel"
    assert "The reservation is cancelled" in first.send(booked, action).text
    assert "booked · 1 person" in second.get(way).text
    assert "booked · 1 person" in second.get("/me?lang=en").text


def test_two_of_one_name_are_told_apart_at_the_desk(counter, planned):
    key = planned()
    addresses = []
    for name in ("Lin", "Lin", "Mei"):
        visitor, address = member(counter)
        person = counter.people.accounts.find(address=address).id
        counter.people.accounts.set_profile(person, name=name, language="en")
        visitor.send(f"/activities/{key}?lang=en", "form-book", size="1")
        addresses.append(address)
    desk = clerk(counter, counter.people, Role.CURATOR).get(f"/office/events/{key}?lang=en").text
    assert [one in desk for one in addresses] == [True, True, False]


def test_a_form_that_comes_again_after_its_booking_was_cancelled_books_nothing(counter, planned):
    key, (visitor, address) = planned(), member(counter)
    form = visitor.get(f"/activities/{key}?lang=en").form("form-book")
    assert "done=booked" in visitor.post(f"/activities/{key}/book", form).headers["Location"]
    visitor.send(f"/activities/{key}?lang=en", f"/activities/{key}/cancel")
    again = visitor.post(f"/activities/{key}/book", form)
    assert again.status == 400
    assert "That reservation was cancelled" in again.text
    person = counter.people.accounts.find(address=address).id
    assert counter.people.bookings.of(person) == ()
    assert "It is booked" in visitor.send(again, "form-book").text, "the form that is shown then is a new one"


def test_who_was_checked_in_stays_so(counter, planned):
    key, (visitor, address) = planned(), member(counter)
    page = visitor.send(f"/activities/{key}?lang=en", "form-book")
    person = counter.people.accounts.find(address=address).id
    (booked,) = counter.people.bookings.of(person)
    counter.people.bookings.arrive("console", booked.id, here=True)
    told = visitor.send(page, f"/activities/{key}/cancel")
    assert told.status == 400
    assert "You have been checked in" in told.text
    assert f"/activities/{key}/cancel" not in told.text
    assert [one.arrived is None for one in counter.people.bookings.of(person)] == [False]
    counter.people.bookings.cancel("console", "reservations", booked.id)  # the desk may
    assert counter.people.bookings.of(person) == ()


def test_who_did_not_come_cannot_undo_that_he_had_booked(counter, planned, monkeypatch):
    key, (visitor, address) = planned(), member(counter)
    page = visitor.send(f"/activities/{key}?lang=en", "form-book")
    assert f"/activities/{key}/cancel" in page.text
    later = SOON + timedelta(hours=3)
    for place in ("house.people.records.bookings", "web.platform.programme.occasion"):
        monkeypatch.setattr(f"hall_app.{place}.now", lambda: later)
    told = visitor.send(page, f"/activities/{key}/cancel")
    assert told.status == 400
    assert "It is over" in told.text
    assert f"/activities/{key}/cancel" not in told.text
    assert len(counter.people.bookings.of(counter.people.accounts.find(address=address).id)) == 1


def test_what_has_begun_or_is_off_offers_nothing_to_book(counter, planned):
    begun, off = planned(begins=datetime.now(UTC) - timedelta(minutes=1)), planned()
    counter.people.occasions.call_off("console", off)
    for visitor in (member(counter)[0], Visitor(counter.url)):
        for key, told in ((begun, "It has begun"), (off, "Called off")):
            page = visitor.get(f"/activities/{key}?lang=en").text
            assert told in page
            assert "form-book" not in page
            assert "A booking needs an account" not in page


def test_what_is_not_there_is_not_booked_or_cancelled(counter, planned):
    visitor, _ = member(counter)
    seal = visitor.get("/me").form("form-profile")["seal"]
    for act in ("book", "cancel"):
        told = visitor.post(f"/activities/nothing/{act}", {"seal": seal, "lang": "en"})
        assert told.status == 404
        assert "There is no such" in told.text
    key = planned()
    assert visitor.post(f"/activities/{key}/cancel", {"seal": seal, "lang": "en"}).status == 404
    led = visitor.ask("GET", f"/activities/{key}/book?lang=en")
    assert (led.status, led.headers["Location"]) == (303, f"/activities/{key}?lang=en")


@pytest.mark.parametrize("size", ["0", "3", "-1", "1.5", "two", "", "９"])
def test_a_number_that_is_none_is_refused_beside_the_form(counter, planned, size):
    visitor, _ = member(counter)
    told = visitor.send(f"/activities/{planned()}?lang=en", "form-book", size=size)
    assert told.status == 400
    assert 'role="alert">The number of people is a whole number from 1 to 2' in told.text


def test_no_form_brings_what_a_database_refuses(counter, planned):
    """PostgreSQL takes no NUL, and says so by an error."""
    visitor, _ = member(counter)
    visit = planned(kind="visit")
    told = visitor.send(f"/visit/{visit}?lang=en", "form-book", size="1", party="class\0")
    assert told.status == 400
    assert "form-cancel" not in told.text
    assert counter.people.bookings.for_occasion(visit) == ()


def test_a_class_books_a_visit_and_takes_it_out_in_its_copy(counter, planned):
    visitor, _ = member(counter)
    visit = planned(kind="visit", places=40, party=40)
    told = visitor.send(f"/visit/{visit}?lang=zh", "form-book", size="32", party="三年级二班")
    assert "已预约 · 32 人 · 三年级二班" in told.text
    copy = visitor.send("/me", "/me/copy")
    with zipfile.ZipFile(io.BytesIO(copy.body)) as archive:
        (kept,) = json.loads(archive.read("bookings.json"))
        (what,) = json.loads(archive.read("occasions.json"))
    assert (what["id"], what["plan"]["title_zh"]) == (visit, "缂丝工作坊")
    assert datetime.fromisoformat(what["plan"]["begins"]) == SOON
    assert (kept["occasion"], kept["size"], kept["party"]) == (visit, 32, "三年级二班")
    visitor.send("/me/delete", "form-delete", password=PASSWORD)
    assert "余 40 位" in Visitor(counter.url).get(f"/visit/{visit}?lang=zh").text


def test_who_is_not_signed_in_books_nothing(counter, planned):
    activity = planned()
    visitor, _ = member(counter)
    given = visitor.get(f"/activities/{activity}").form("form-book")
    visitor.send("/me", "/me/sign-out")
    seal = visitor.get("/me").form("form-sign-in")["seal"]
    led = visitor.post(f"/activities/{activity}/book", given | {"seal": seal})
    assert led.headers["Location"].startswith("/me?")
    assert activity in led.headers["Location"]


def test_who_deletes_the_account_meanwhile_is_led_as_who_is_signed_out(counter, planned, monkeypatch):
    activity = planned()
    visitor, _ = member(counter)
    page, bookings = visitor.get(f"/activities/{activity}?lang=en"), counter.people.bookings
    book = bookings.book

    def deleted(person: str, *given, **named):
        counter.people.accounts.remove("console", person)
        return book(person, *given, **named)

    monkeypatch.setattr(bookings, "book", deleted)
    led = visitor.post(f"/activities/{activity}/book", page.form("form-book"))
    assert led.status == 303
    assert led.headers["Location"].startswith("/me?")
    assert activity in led.headers["Location"]
    assert counter.people.occasions.of(activity).taken == 0


def test_a_calendar_takes_it_over(counter, planned):
    activity = planned()
    for path in (f"/activities/{activity}.ics?lang=en", "/activities.ics?lang=en"):
        answer = Visitor(counter.url).ask("GET", path)
        assert answer.headers["Content-Type"] == "text/calendar; charset=utf-8"
        events = [
            event
            for event in Calendar.from_ical(answer.body).walk("VEVENT")
            if str(event["uid"]).startswith(activity)
        ]
        (event,) = events
        assert event["dtstart"].dt == SOON
        assert event["summary"] == "Tapestry <weaving>"
        assert str(event["url"]).startswith(f"{counter.url}/activities/{activity}")


def test_a_calendar_that_has_it_is_told_when_it_is_called_off(counter, planned):
    activity = planned()
    counter.people.occasions.call_off("console", activity)
    answer = Visitor(counter.url).ask("GET", "/activities.ics")
    found = {str(e["uid"]): str(e["status"]) for e in Calendar.from_ical(answer.body).walk("VEVENT")}
    assert found[f"{activity}-hall"] == "CANCELLED"
    assert activity not in Visitor(counter.url).get("/activities").text, "nobody books it any more"


@pytest.mark.parametrize("asked", ["缂丝", "工作坊", "tapestry", "WEAVING", "剪刀", "scissors", "东厢"])
@pytest.mark.parametrize("lang", ["zh", "en"])
def test_an_activity_is_found_in_either_language(counter, planned, asked, lang):
    activity, visit, off = planned(), planned(kind="visit"), planned()
    counter.people.occasions.call_off("console", off)
    found = SearchIndex(programme_entries(counter.people)).find(Query.of(asked), lang).best
    addresses = [one.shown.address for one in found]
    assert f"/activities/{activity}?lang={lang}" in addresses
    assert not any(visit in address or off in address for address in addresses)


def test_the_search_goes_on_without_accounts(tmp_path):
    people = People(tmp_path)
    (tmp_path / "people.sqlite").unlink()
    people.close()
    assert programme_entries(people) == ()


def test_what_was_just_planned_is_found_in_the_open_hall(plain_hall):
    people = People(plain_hall.data)
    whole = {"title_zh": "拓印课", "title_en": "Rubbings", "places": 2, "party": 2}
    plan = Plan("activity", begins=SOON, ends=SOON + timedelta(hours=1), **whole)
    (key,) = people.occasions.plan("console", plan)
    stranger = Visitor(plain_hall.url)
    (found,) = json.loads(stranger.get("/api/search?q=rubbing&lang=en").body)["found"]
    assert (found["kind"], found["address"]) == ("activity", f"/activities/{key}?lang=en")
    assert "<mark>拓印</mark>课" in stranger.get("/search?q=拓印&lang=zh").text
    people.occasions.call_off("console", key)
    assert json.loads(stranger.get("/api/search?q=rubbing&lang=en").body)["found"] == []
    people.close()


DAYS, HOURS = 64, 8


@pytest.fixture(scope="module")
def busy(tmp_path_factory):
    """A counter of its own with more to come than any page lists; the noon of its first day."""
    noon = (datetime.now() + timedelta(days=2)).replace(hour=12, minute=0, second=0, microsecond=0)
    with open_counter(tmp_path_factory.mktemp("busy")) as found:
        starts = [noon + timedelta(days=day, hours=hour - 4) for day in range(DAYS) for hour in range(HOURS)]
        found.people.occasions.plan("console", *map(guided, starts))
        yield found, noon


def guided(at: datetime, kind: str = "visit") -> Plan:
    begins = at if at.tzinfo else at.astimezone()
    return Plan(kind, "讲解", "Guided", begins, begins + timedelta(hours=1), 10, 10)


@pytest.fixture
def people_of(tmp_path):
    found = People(tmp_path)
    yield found
    found.close()


def test_what_comes_after_the_five_hundredth_is_there(busy):
    counter, noon = busy
    curator, stranger = clerk(counter, counter.people, Role.CURATOR), Visitor(counter.url)
    last = noon + timedelta(days=DAYS + 40)
    visit, activity = counter.people.occasions.plan("console", guided(last), guided(last, "activity"))
    sheet = curator.told(f"day?day={last:%Y-%m-%d}")
    assert [one["id"] for one in sheet] == sorted([visit, activity])
    assert f"/office/events/{visit}/" not in curator.get(f"/office/day?day={noon:%Y-%m-%d}").text
    assert len(curator.told(f"day?day={noon:%Y-%m-%d}")) == HOURS
    listed, page = [], 1
    while found := curator.told(f"events?page={page}"):
        assert len(found) <= 200
        listed += [one["id"] for one in found]
        page += 1
    assert len(set(listed)) == len(listed) == DAYS * HOURS + 2
    shown = curator.get("/office/events?lang=en")
    for _ in range(page - 2):
        shown = curator.get(unescape(re.findall(r'rel="next" href="([^"]*)"', shown.text)[0]))
    assert f"/office/events/{activity}" in shown.text
    assert 'rel="next"' not in shown.text
    assert 'rel="prev"' in shown.text
    assert visit in stranger.get(f"/visit?month={last:%Y-%m}&lang=en").text
    assert f'month={last:%Y-%m}"' in stranger.get("/visit?lang=en").text, "its month is named"


def test_the_months_of_visits_hold_all_of_them_once(busy):
    counter, _ = busy
    stranger = Visitor(counter.url)
    first = stranger.get("/visit?lang=zh").text
    months = re.findall(r'/visit\?lang=zh&month=([\d-]+)"', first.replace("&amp;", "&"))
    assert months == sorted(set(months))
    pages = [stranger.get(f"/visit?lang=zh&month={month}").text for month in months]
    assert pages[0].partition("<main")[2] == first.partition("<main")[2], "the next one is shown unasked"
    shown = [key for page in pages for key in re.findall(r'href="/visit/([0-9a-f]+)\?', page)]
    assert len(shown) == len(set(shown)) >= DAYS * HOURS
    for odd in ("2026-13", "x", "9999-12", "0001-01"):
        assert stranger.get(f"/visit?month={odd}").status == 200


def test_activities_are_listed_on_pages(tmp_path):
    with open_counter(tmp_path) as counter:
        at = datetime.now() + timedelta(days=2)
        keys = counter.people.occasions.plan(
            "console", *(guided(at + timedelta(hours=n), "activity") for n in range(70))
        )
        stranger, shown = Visitor(counter.url), []
        for page in ("", "&page=2", "&page=3", "&page=x"):
            shown.append(
                re.findall(
                    r'href="/activities/([0-9a-f]{16})\?', stranger.get(f"/activities?lang=en{page}").text
                )
            )
        calendar = Calendar.from_ical(stranger.ask("GET", "/activities.ics").body).walk("VEVENT")
    assert (*shown[0], *shown[1]) == keys
    assert shown[2:] == [[], shown[0]]
    assert len(calendar) == len(keys), "a calendar has all of them"


@pytest.mark.parametrize("zone", ["Asia/Shanghai", "America/New_York"])
def test_an_hour_is_kept_whatever_the_clock_it_was_given_by(people_of, zone):
    at = datetime(SOON.year + 2, 1, 5, 14, 0, tzinfo=ZoneInfo(zone))
    (key,) = people_of.occasions.plan("console", guided(at))
    assert people_of.occasions.of(key).plan.begins == at
    assert [one.id for one in people_of.occasions.between(at, at + timedelta(seconds=1))] == [key]
    people_of.occasions.change("console", key, guided(at + timedelta(hours=1)))
    assert people_of.occasions.of(key).plan.begins == at + timedelta(hours=1)
