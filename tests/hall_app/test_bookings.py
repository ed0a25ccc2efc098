"""Places: never more than there are, in the order of asking, once however often it is sent, whole when it is killed."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from form_visitor import Answer, Visitor
from full_matrix import by_day
from open_counter import OpenCounter, open_counter
from sqlalchemy import update

from hall_app.house.people import People, PeopleError
from hall_app.house.people.database import Ledger, tables
from hall_app.house.people.records import Plan, accounts

PASSWORD = "a robe of blue ramie"
ASKED, PLACES = 200, 20
SOON = datetime.now(UTC) + timedelta(days=3)


@pytest.fixture
def people(database) -> Iterator[People]:
    found = People(database)
    yield found
    found.close()


@pytest.fixture
def ledger(database) -> Iterator[Ledger]:
    found = Ledger(database)
    yield found
    found.close()


def moved(ledger: Ledger, occasion: str, **hours: int) -> None:
    """As if time had passed: its beginning or end that many hours from now."""
    times = {name: datetime.now(UTC) + timedelta(hours=away) for name, away in hours.items()}
    with ledger.change("console", "events", occasion) as connection:
        table = tables.occasion
        connection.execute(update(table).where(table.c.id == occasion).values(**times))


def plan(**changed) -> Plan:
    whole = {
        "kind": "activity",
        "title_zh": "缂丝工作坊",
        "title_en": "Tapestry weaving",
        "begins": SOON,
        "ends": SOON + timedelta(hours=2),
        "places": PLACES,
        "party": 6,
    }
    return Plan(**(whole | changed))


def planned(people: People, **changed) -> str:
    return people.occasions.plan("console", plan(**changed))[0]


def visitors(people: People, count: int) -> list[str]:
    """Accounts without passwords: nobody signs in here."""
    return [people.accounts.make("console", f"visitor{n}@example.org").id for n in range(count)]


def refused(key: str):
    return pytest.raises(PeopleError, check=lambda error: error.key == key)


def in_order(people: People, occasion: str) -> bool:
    """Whether what is taken is what was booked, and who waits came after who has places."""
    found, whole = people.bookings.for_occasion(occasion), people.occasions.of(occasion)
    booked = [one for one in found if not one.place]
    waiting = [one for one in found if one.place]
    assert whole.taken == sum(one.size for one in booked) <= whole.plan.places
    assert [one.place for one in waiting] == list(range(1, len(waiting) + 1))
    return not booked or not waiting or max(one.turn for one in booked) < min(one.turn for one in waiting)


@pytest.mark.door
def test_two_hundred_ask_for_twenty_places_at_once(people, database):
    """Over eight houses that share the database, as eight processes would: each has locks of its own."""
    houses = [people, *(People(database) for _ in range(7))]
    occasion, asking = planned(people), visitors(people, ASKED)
    start = threading.Barrier(40)

    def ask(number: int) -> int:
        if number < 40:
            start.wait()
        return houses[number % 8].bookings.book(asking[number], occasion, 1, f"key {number}").turn

    with ThreadPoolExecutor(40) as pool:
        turns = list(pool.map(ask, range(ASKED)))
    assert len(set(turns)) == ASKED
    found = people.bookings.for_occasion(occasion)
    assert len([one for one in found if not one.place]) == PLACES
    assert [one.place for one in found if one.place] == list(range(1, ASKED - PLACES + 1))
    assert in_order(people, occasion)
    with ThreadPoolExecutor(20) as pool:
        again = list(
            pool.map(
                lambda n: houses[n % 8].bookings.book(asking[n], occasion, 1, f"key {n}").turn, range(20)
            )
        )
    assert again == turns[:20]
    assert people.bookings.for_occasion(occasion) == found
    for house in houses[1:]:
        house.close()


@pytest.fixture(params=["sqlite", pytest.param("postgresql", marks=[pytest.mark.slow, pytest.mark.nightly])])
def house(request, tmp_path, quick_hashes) -> Iterator[OpenCounter]:
    """Open on a port, its pace as it ships: nobody else's tries count here."""
    accounts = None if request.param == "sqlite" else request.getfixturevalue("postgres")()
    with open_counter(tmp_path, accounts) as found:
        yield found


@pytest.mark.slow
def test_two_hundred_send_the_form_for_twenty_places_at_once(house):
    """As browsers do: each signed in, each form with the seal and the key that its own page gave it."""
    occasion, people = planned(house.people), house.people
    way = f"/activities/{occasion}?lang=en"

    def enter(number: int) -> tuple[Visitor, Answer]:
        visitor, address = Visitor(house.url), f"asking{number}@example.org"
        people.accounts.sign_up(address, PASSWORD)
        assert address in visitor.send("/me?lang=en", "form-sign-in", address=address, password=PASSWORD).text
        return visitor, visitor.get(way)

    start = threading.Barrier(40)

    def ask(number: int) -> str:
        if number < 40:
            start.wait()
        return send(number)

    def send(number: int) -> str:
        visitor, page = entered[number]
        told = visitor.send(page, "form-book", size="1")
        assert told.status == 200
        (standing,) = re.findall(r"booked · 1 person|number \d+ on the waiting list", told.text)
        return standing

    with ThreadPoolExecutor(40) as pool:
        entered = list(pool.map(enter, range(ASKED)))
        forms = [page.form("form-book") for _, page in entered]
        assert all(len({form[name] for form in forms}) == ASKED for name in ("seal", "key"))
        told = list(pool.map(ask, range(ASKED)))
    found = people.bookings.for_occasion(occasion)
    assert len(found) == len({one.person for one in found}) == ASKED
    assert [one.place for one in found] == [0] * PLACES + list(range(1, ASKED - PLACES + 1))
    assert in_order(people, occasion)
    waiting = [f"number {number} on the waiting list" for number in range(1, ASKED - PLACES + 1)]
    assert sorted(told) == sorted(["booked · 1 person"] * PLACES + waiting), "and everybody is told"
    booked = [number for number, standing in enumerate(told) if standing.startswith("booked")]
    twice = [*booked[:10], *(number for number in range(ASKED) if number not in booked)][:20]
    with ThreadPoolExecutor(20) as pool:
        assert list(pool.map(send, twice)) == [told[number] for number in twice]
    assert people.bookings.for_occasion(occasion) == found, "the same form once more books nothing"


def test_one_form_sent_twenty_times_at_once_books_once(people):
    occasion, (person,) = planned(people), visitors(people, 1)
    with ThreadPoolExecutor(20) as pool:
        ids = set(pool.map(lambda _: people.bookings.book(person, occasion, 2, "same").id, range(20)))
    assert len(ids) == 1
    assert people.occasions.of(occasion).taken == 2
    assert [entry.act for entry in people.journal.about(person)].count("book") == 1
    with refused("booked-already"):
        people.bookings.book(person, occasion, 2, "another form")


def test_places_given_back_go_to_who_waits_in_order(people):
    occasion, asking = planned(people, places=4, party=3), visitors(people, 5)
    sizes = (3, 1, 2, 1, 1)
    made = [
        people.bookings.book(person, occasion, size, person)
        for person, size in zip(asking, sizes, strict=True)
    ]
    assert [one.place for one in made] == [0, 0, 1, 2, 3]
    people.bookings.cancel(asking[1], "cancel booking", made[1].id, person=asking[1])
    assert [one.place for one in people.bookings.for_occasion(occasion)] == [0, 1, 2, 3], (
        "two do not fit in one"
    )
    people.bookings.cancel("console", "reservations", made[0].id)
    assert [one.place for one in people.bookings.for_occasion(occasion)] == [0, 0, 0]
    assert people.occasions.of(occasion).taken == 4
    with refused("no-booking"):
        people.bookings.cancel("console", "reservations", made[0].id)
    assert in_order(people, occasion)


def test_places_that_are_added_go_to_who_waits_and_booked_ones_stay(people):
    occasion, asking = planned(people, places=2, party=1), visitors(people, 4)
    for person in asking:
        people.bookings.book(person, occasion, 1, person)
    people.occasions.change("console", occasion, plan(places=3, party=1))
    assert [one.place for one in people.bookings.for_occasion(occasion)] == [0, 0, 0, 1]
    with refused("occasion-places"):
        people.occasions.change("console", occasion, plan(places=2, party=1))


def test_places_are_never_fewer_than_the_largest_party_that_waits(people):
    """It would stand at the head of the list for ever, and all others behind it, with every place free."""
    occasion, asking = planned(people, places=6, party=6), visitors(people, 2)
    for person, size in zip(asking, (1, 6), strict=True):
        people.bookings.book(person, occasion, size, person)
    with refused("occasion-places"):
        people.occasions.change("console", occasion, plan(places=5, party=5))
    people.bookings.cancel("console", "reservations", people.bookings.of(asking[0])[0].id)
    assert people.bookings.of(asking[1])[0].place == 0


def test_nobody_cancels_anothers_booking(people):
    occasion, (one, other) = planned(people), visitors(people, 2)
    booking = people.bookings.book(one, occasion, 1, "key")
    with refused("no-booking"):
        people.bookings.cancel(other, "cancel booking", booking.id, person=other)
    assert people.bookings.of(one) == (booking,)


@pytest.mark.parametrize("size", [0, -1, 7, 10**6])
def test_a_party_has_a_size(people, size):
    occasion, (person,) = planned(people), visitors(people, 1)
    with refused("party-size"):
        people.bookings.book(person, occasion, size, "key")
    assert people.occasions.of(occasion).taken == 0


def test_a_key_is_of_one_occasion_alone(people):
    """A program that sends its own key everywhere books each of them, and no one else's booking answers it."""
    first, second = planned(people), planned(people)
    one, other = visitors(people, 2)
    made = [people.bookings.book(one, occasion, 1, "key") for occasion in (first, second)]
    assert [booking.occasion for booking in made] == [first, second]
    assert people.bookings.book(other, first, 1, "key").person == other


def test_what_is_over_or_off_is_not_booked(people):
    (person,) = visitors(people, 1)
    past = planned(people, begins=SOON - timedelta(days=9), ends=SOON)
    off = planned(people)
    people.occasions.call_off("console", off)
    for occasion in (past, off, "no-such-thing"):
        with refused("no-occasion"):
            people.bookings.book(person, occasion, 1, occasion)
    assert off not in [one.id for one in people.occasions.to_come()]
    assert off in [one.id for one in people.occasions.to_come(past=True)]


def test_what_is_off_or_has_begun_is_given_to_nobody_who_waits(people, ledger):
    """He would be told that he is booked for what does not take place, or what he cannot come to any more."""
    off, begun = (planned(people, places=1, party=1) for _ in range(2))
    one, other = visitors(people, 2)
    for occasion in (off, begun):
        for person in (one, other):
            people.bookings.book(person, occasion, 1, occasion)
    people.occasions.call_off("console", off)
    moved(ledger, begun, begins=-1)
    for occasion, who in ((off, one), (begun, "")):
        booked, waiting = people.bookings.for_occasion(occasion)
        people.bookings.cancel(one, "cancel booking", booked.id, person=who)
        assert [made.place for made in people.bookings.for_occasion(occasion)] == [1]
        assert people.occasions.of(occasion).taken == 0
    people.occasions.change("console", off, plan(places=5, party=1))
    assert people.bookings.for_occasion(off)[0].place == 1
    people.occasions.change("console", begun, plan(places=1, party=1))
    assert people.bookings.for_occasion(begun)[0].place == 0, (
        "it begins later now, and who waited has the place"
    )


def test_what_is_over_is_no_longer_cancelled_by_who_booked_it(people, ledger):
    """Whoever did not come would have it that he never said he would."""
    occasion, (one, other) = planned(people, places=1, party=1), visitors(people, 2)
    made, waits = (people.bookings.book(person, occasion, 1, person) for person in (one, other))
    moved(ledger, occasion, begins=-2, ends=-1)
    for mine in (made, waits):
        with refused("occasion-over"):
            people.bookings.cancel(mine.person, "cancel booking", mine.id, person=mine.person)
    assert len(people.bookings.for_occasion(occasion)) == 2
    people.bookings.cancel("console", "reservations", made.id)  # the desk may
    assert [left.place for left in people.bookings.for_occasion(occasion)] == [1]


def test_what_is_cancelled_while_the_answer_is_under_way_is_told_so(people, monkeypatch):
    occasion, (person,) = planned(people), visitors(people, 1)
    made, look = people.bookings.book(person, occasion, 1, "key"), people.bookings.of

    def too_late(whose: str):
        monkeypatch.undo()
        people.bookings.cancel(person, "cancel booking", made.id, person=person)
        return look(whose)

    monkeypatch.setattr(people.bookings, "of", too_late)
    with refused("booking-cancelled"):
        people.bookings.book(person, occasion, 1, "key")


@pytest.mark.parametrize(
    ("changed", "key"),
    [
        ({"ends": datetime(9999, 12, 31, 23, 30, tzinfo=UTC)}, "occasion-far"),
        ({"begins": datetime(1, 1, 1, tzinfo=UTC)}, "occasion-far"),
        ({"ends": SOON.replace(year=SOON.year + 12, day=1)}, "occasion-far"),
        ({"title_en": " "}, "occasion-title"),
        ({"title_zh": "长" * 121}, "occasion-title"),
        ({"ends": SOON}, "occasion-times"),
        ({"places": 0}, "occasion-places"),
        ({"places": 1001}, "occasion-places"),
        ({"places": 3, "party": 4}, "occasion-places"),
        ({"text_zh": "长" * 4001}, "occasion-text"),
        ({"text_en": "a bell \a"}, "occasion-text"),
        ({"kind": "feast"}, "occasion-kind"),
    ],
)
def test_a_plan_is_checked_and_nothing_of_it_kept(people, changed, key):
    with refused(key):
        people.occasions.plan("console", plan(), plan(**changed))
    assert people.occasions.to_come() == ()


def test_a_deleted_account_leaves_its_places_to_who_waits(people):
    occasion = planned(people, places=1, party=1)
    leaving = people.accounts.sign_up("leaving@example.org", PASSWORD)
    (waiting,) = visitors(people, 1)
    people.bookings.book(leaving.id, occasion, 1, "first")
    assert people.bookings.book(waiting, occasion, 1, "second").place == 1
    people.accounts.delete(leaving, PASSWORD)
    (left,) = people.bookings.for_occasion(occasion)
    assert (left.person, left.place) == (waiting, 0)


@pytest.mark.parametrize("how", ["delete", "remove"])
def test_who_books_while_his_account_is_deleted_is_refused(people, database, monkeypatch, how):
    """At once, in two houses that share the database: the one that deletes has given all places back already."""
    occasion, other, beside = planned(people), planned(people), People(database)
    leaving = people.accounts.sign_up("leaving@example.org", PASSWORD)
    people.bookings.book(leaving.id, other, 1, "first")
    release = accounts.release
    with ThreadPoolExecutor(1) as pool:
        asked = []

        def released(connection, person: str) -> None:
            release(connection, person)
            asked.append(pool.submit(beside.bookings.book, person, occasion, 1, "second"))
            time.sleep(0.3)

        monkeypatch.setattr(accounts, "release", released)
        if how == "delete":
            people.accounts.delete(leaving, PASSWORD)
        else:
            people.accounts.remove("console", leaving.id)
        with refused("no-account"):
            asked[0].result()
    assert [people.bookings.for_occasion(one) for one in (occasion, other)] == [(), ()]
    assert people.occasions.of(occasion).taken == 0
    beside.close()


def test_who_cancels_while_his_account_is_deleted_is_told_so(people, database, monkeypatch):
    """Neither waits for the other: what either holds is held in the same order."""
    occasion, beside = planned(people), People(database)
    leaving = people.accounts.sign_up("leaving@example.org", PASSWORD)
    mine = people.bookings.book(leaving.id, occasion, 1, "first")
    release = accounts.release
    with ThreadPoolExecutor(1) as pool:
        asked = []

        def released(connection, person: str) -> None:
            asked.append(
                pool.submit(beside.bookings.cancel, person, "cancel booking", mine.id, person=person)
            )
            time.sleep(0.3)
            release(connection, person)

        monkeypatch.setattr(accounts, "release", released)
        people.accounts.delete(leaving, PASSWORD)
        with refused("no-booking"):
            asked[0].result()
    assert people.bookings.for_occasion(occasion) == ()
    beside.close()


def test_a_number_that_was_given_again_is_not_taken_for_who_had_it_before(people):
    """SQLite gives the number of a cancelled booking to the next one, of whatever occasion."""
    occasion, other, asking = planned(people), planned(people), visitors(people, 3)
    seen = people.bookings.book(asking[0], occasion, 1, "first")
    people.bookings.cancel("console", "reservations", seen.id)
    place = (seen.occasion, seen.turn)
    for at, person in ((other, asking[1]), (occasion, asking[2])):
        now = people.bookings.book(person, at, 1, person)
        with refused("no-booking"):
            people.bookings.arrive("console", now.id, here=True, place=place)
        with refused("no-booking"):
            people.bookings.cancel("console", "reservations", now.id, place=place)
        people.bookings.arrive("console", now.id, here=True, place=(at, now.turn))


def test_only_who_has_places_is_checked_in(people):
    occasion, asking = planned(people, places=1, party=1), visitors(people, 2)
    first, second = (people.bookings.book(person, occasion, 1, person) for person in asking)
    people.bookings.arrive("console", first.id, here=True)
    assert people.bookings.of(asking[0])[0].arrived is not None
    people.bookings.arrive("console", first.id, here=False)
    assert people.bookings.of(asking[0])[0].arrived is None
    with refused("no-booking"):
        people.bookings.arrive("console", second.id, here=True)


_BOOKS = """
import sys
from hall_app.house.people import People
from pathlib import Path
where, occasion, *asking = sys.argv[1:]
people = People(where if "://" in where else Path(where))
print("ready", flush=True)
for person in asking:
    people.bookings.book(person, occasion, 1, person)
    print(person, flush=True)
"""


@pytest.mark.slow
@pytest.mark.parametrize("kills", by_day([4], [4, 50]))
def test_killed_in_mid_booking_nothing_is_lost_or_doubled(people, database, kills):
    """What was confirmed stands; what was not is whole or not there. Asked again, everybody is booked once."""
    asking = visitors(people, 40)
    for kill in range(kills):
        occasion = planned(people)
        command = [sys.executable, "-c", _BOOKS, str(database), occasion, *asking]
        with subprocess.Popen(
            command, stdout=subprocess.PIPE, text=True, cwd=Path(__file__).parents[2]
        ) as process:
            assert process.stdout is not None
            told = [process.stdout.readline() for _ in range(2 + kill % 17)][1:]
            os.kill(process.pid, signal.SIGKILL)
            told += process.stdout.readlines()
        confirmed = {line.strip() for line in told if line.endswith("\n")}
        kept = [one.person for one in people.bookings.for_occasion(occasion)]
        assert confirmed <= set(kept)
        assert len(kept) == len(set(kept)) <= len(confirmed) + 1
        assert in_order(people, occasion)
        for person in asking:
            people.bookings.book(person, occasion, 1, person)
        assert len(people.bookings.for_occasion(occasion)) == len(asking)
        assert people.occasions.of(occasion).taken == PLACES
