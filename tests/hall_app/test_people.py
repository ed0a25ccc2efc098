"""People: nothing changes without its row in the journal, nobody comes in twice, what is deleted is gone."""

from __future__ import annotations

import io
import json
import re
import subprocess
import sys
import threading
import time
import zipfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from datetime import timedelta
from pathlib import Path

import argon2
import pyotp
import pytest
from sqlalchemy import Connection, create_engine, inspect, select, text, update
from sqlalchemy.exc import DBAPIError

from hall_app.house.people import ACTS, OWN_ACTS, People, PeopleError, Role, existing_people, may
from hall_app.house.people.database import HEAD, Ledger, tables
from hall_app.house.people.records import OFFICE_HOURS, RECOVERY_CODES, Plan
from survey.errors import StoreError, SurveyError
from survey.export import pseudonym
from survey.store.database import now

ADDRESS, PASSWORD = "lan.yi@example.org", "a robe of blue ramie"


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


def refused(key: str):
    return pytest.raises(PeopleError, check=lambda error: error.key == key)


def everything(ledger: Ledger) -> str:
    """All that stands in any table."""
    with ledger.read() as connection:
        return "\n".join(
            str(tuple(row))
            for table in tables.metadata.sorted_tables
            for row in connection.execute(select(table))
        )


def staff(people: People, address: str, *roles: Role):
    person = people.accounts.sign_up(address, PASSWORD)
    people.roles.set("console", person.id, frozenset(roles))
    return people.accounts.of(person.id)


def test_an_account_is_made_once_however_its_address_is_written(people):
    people.accounts.sign_up(ADDRESS, PASSWORD)
    with refused("address-taken"):
        people.accounts.sign_up(" Lan.Yi@EXAMPLE.org", PASSWORD)
    person, token = people.sessions.sign_in(ADDRESS, PASSWORD)
    found = people.sessions.find(token)
    assert found is not None
    assert found[0] == person
    assert not person.roles
    assert person.verified is None
    assert people.sessions.find(token, office=True) is None
    assert people.sessions.find(token + "x") is None


@pytest.mark.parametrize(
    "address",
    ["", "a", "a@b", "a@b.", "a b@c.d", "a@@c.d", "a" * 65 + "@c.d", "a@" + "b." * 130 + "c", "a\x00@c.d"],
)
def test_what_is_no_address_is_refused(tmp_path, address):
    people = People(tmp_path)
    with refused("address"):
        people.accounts.sign_up(address, PASSWORD)
    people.close()


@pytest.mark.parametrize(
    ("password", "key"),
    [
        ("short one", "password-short"),
        ("x" * 201, "password-long"),
        ("abababababab", "password-plain"),
        ("lan.yi.2026", "password-plain"),
    ],
)
def test_what_is_easily_guessed_is_refused(tmp_path, password, key):
    people = People(tmp_path)
    with refused(key):
        people.accounts.sign_up(ADDRESS, password)
    people.close()


def test_every_refusal_is_in_both_languages():
    from hall_app.house.people import REFUSALS

    for key, (zh, en) in REFUSALS.items():
        assert any("\u4e00" <= letter <= "\u9fff" for letter in zh), key
        assert en.isascii(), key
        assert zh.count("{") == en.count("{"), key


def test_a_refusal_in_chinese_calls_every_kind_of_file_by_its_chinese_name():
    from hall_app.house.drafts import LARGEST

    for kind in LARGEST:
        for key in ("file-size", "file-use"):
            error = PeopleError(key, name="1", kind=kind, most=40)
            assert not re.search("[a-z]", error.text("zh")), error.text("zh")
            assert kind in error.text("en")


def test_no_secret_is_kept_as_it_is(people, ledger):
    person = people.accounts.sign_up(ADDRESS, PASSWORD)
    _, token = people.sessions.sign_in(ADDRESS, PASSWORD)
    code = people.accounts.code_for("console", person.id)
    kept = everything(ledger)
    assert "$argon2id$" in kept
    for secret in (PASSWORD, token, code, code.replace("-", "")):
        assert secret not in kept


def test_a_change_that_fails_leaves_no_row_and_one_that_holds_leaves_one(ledger):
    def made() -> int:
        with ledger.read() as connection:
            return len(connection.execute(select(tables.audit)).all())

    row = {"id": "a" * 16, "address": "a@b.c", "name": "", "language": "zh", "made": now()}

    def failing() -> None:
        with ledger.change("console", "people", "a") as connection:
            connection.execute(tables.user.insert().values(**row))
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        failing()
    assert made() == 0
    assert "a@b.c" not in everything(ledger)
    with ledger.change("console", "people", "a") as connection:
        connection.execute(tables.user.insert().values(**row))
    assert made() == 1


SOUGHT = (
    "Öztürk",
    "öztürk",
    "ÖZTÜRK",
    "Groß",
    "groß",
    "gross",
    "GROSS",
    "Éva",
    "éva",
    "E\u0301VA",
    "ｇｒｏｓｓ",
)


def test_people_are_found_however_their_names_are_written(people):
    """In letters of every kind, not only those that a database folds by itself."""
    someone = people.accounts.sign_up("someone@example.org", PASSWORD, name="Somebody else")
    found = people.accounts.sign_up("x@straße.example", PASSWORD, name="Öztürk Groß Éva")
    for wanted in (*SOUGHT, "STRASSE", "Straße"):
        assert [one.id for one in people.accounts.all(wanted)] == [found.id], wanted
        assert people.accounts.count(wanted) == 1
    people.accounts.set_profile(found.id, name="张 Şahin", language="en")
    assert [people.accounts.count(wanted) for wanted in ("groß", "张", "şahin", "ŞAHIN")] == [0, 1, 1, 1]
    assert people.accounts.count("%") == people.accounts.count("_") == 0
    assert people.accounts.count() == people.accounts.count("e") == 2
    assert people.accounts.of(someone.id).name == "Somebody else"


def test_people_of_an_older_schema_are_found_too(database):
    first = People(database)
    person = first.accounts.sign_up(ADDRESS, PASSWORD, name="Öztürk Groß Éva")
    first.close()
    with stepped_back(database, "0008"):
        pass
    again = People(database)
    assert [[one.id for one in again.accounts.all(wanted)] for wanted in SOUGHT] == [[person.id]] * len(
        SOUGHT
    )
    again.close()


def test_there_is_no_other_way_to_change_anything(people, ledger):
    person = people.accounts.sign_up(ADDRESS, PASSWORD)
    before = everything(ledger)

    def around() -> None:
        with ledger.read() as connection:
            connection.execute(update(tables.user).where(tables.user.c.id == person.id).values(name="other"))
            connection.commit()

    with pytest.raises((StoreError, DBAPIError)):
        around()
    with pytest.raises(ValueError, match="no such act"), ledger.change("console", "invented", "x"):
        pass
    assert everything(ledger) == before
    people.accounts.set_profile(
        person.id, name="兰", language="en"
    )  # and the connection it lent still writes
    assert people.accounts.of(person.id).name == "兰"


def test_every_way_to_change_something_is_in_the_journal(people):
    """Each public step adds rows, with the id of who did it and never the address."""
    person = people.accounts.sign_up(ADDRESS, PASSWORD)
    _, token = people.sessions.sign_in(ADDRESS, PASSWORD)
    session = people.sessions.find(token)[1]
    keeper = staff(people, "keeper@example.org", Role.ADMINISTRATOR)
    code = people.accounts.code_for(keeper.id, person.id)
    secret = pyotp.random_base32()
    steps = {
        "profile": lambda: people.accounts.set_profile(person.id, name="Lan", language="en"),
        "use code": lambda: people.accounts.use_code(code, PASSWORD),
        "password": lambda: people.accounts.set_password(person, PASSWORD, PASSWORD + "!"),
        "second factor": lambda: people.accounts.begin_second_factor(
            person, PASSWORD + "!", secret, pyotp.TOTP(secret).now()
        ),
        "people": lambda: people.accounts.close(keeper.id, person.id, closed=True),
        "roles": lambda: people.roles.set(keeper.id, person.id, frozenset({Role.EDITOR})),
        "take copy": lambda: people.copy_of(person),
        "delete account": lambda: people.accounts.delete(person, PASSWORD + "!"),
    }
    assert session.id
    for act, step in steps.items():
        last = people.journal.entries()[0].id
        step()
        added = [entry for entry in people.journal.entries() if entry.id > last]
        assert [entry.act for entry in added] == [act]
        assert added[0].subject.startswith(person.id)
    assert all("@" not in f"{entry.who}{entry.subject}" for entry in people.journal.entries())


def test_sessions_end_one_by_one_and_all(people):
    person = people.accounts.sign_up(ADDRESS, PASSWORD)
    tokens = [people.sessions.sign_in(ADDRESS, PASSWORD)[1] for _ in range(3)]
    first, *_ = (people.sessions.find(token)[1] for token in tokens)
    people.sessions.end(person.id, "sign out", person.id, first.id)
    assert [people.sessions.find(token) is None for token in tokens] == [True, False, False]
    with refused("no-session"):
        people.sessions.end(person.id, "sign out", person.id, first.id)
    stranger = people.accounts.sign_up("stranger@example.org", PASSWORD)
    second = people.sessions.find(tokens[1])[1]
    with refused("no-session"):  # nobody ends another's by its number
        people.sessions.end(stranger.id, "sign out", stranger.id, second.id)
    code = people.accounts.code_for("console", person.id)
    people.accounts.set_password(person, PASSWORD, "another robe, of silk", keep=second.id)
    with refused("code"):
        people.accounts.holder(code)  # whoever found the slip of paper
    assert [people.sessions.find(token) is None for token in tokens] == [True, False, True]
    assert people.sessions.end_all("console", "people", person.id) == 1
    assert people.sessions.of(person.id) == ()


def test_a_session_ends_by_itself(people, ledger, monkeypatch):
    keeper = staff(people, ADDRESS, Role.CURATOR)
    _, token = people.sessions.sign_in(ADDRESS, PASSWORD, office=True)
    session = people.sessions.find(token, office=True)[1]
    assert (session.expires - session.made).total_seconds() == OFFICE_HOURS * 3600
    with ledger.change("console", "people", keeper.id) as connection:
        connection.execute(update(tables.session).values(expires=now()))
    assert people.sessions.find(token, office=True) is None
    people.sessions.sign_in(ADDRESS, PASSWORD)
    with ledger.read() as connection:
        assert len(connection.execute(select(tables.session)).all()) == 1  # the other's row went


def test_the_office_is_for_people_with_a_role(people):
    person = people.accounts.sign_up(ADDRESS, PASSWORD)
    with refused("no-office"):
        people.sessions.sign_in(ADDRESS, PASSWORD, office=True)
    entry = people.journal.entries()[0]
    assert (entry.act, entry.subject, entry.refused) == ("sign in", person.id, True)
    people.roles.set("console", person.id, frozenset({Role.EDITOR}))
    _, token = people.sessions.sign_in(ADDRESS, PASSWORD, office=True)
    assert people.sessions.find(token, office=True)[0].roles == {Role.EDITOR}
    people.roles.set("console", person.id, frozenset())
    assert people.sessions.find(token, office=True) is None


def test_an_account_that_anybody_may_have_made_is_given_no_role(people):
    keeper = staff(people, "keeper@example.org", Role.ADMINISTRATOR)
    squatter = people.accounts.sign_up(ADDRESS, PASSWORD)
    with refused("not-verified"):
        people.roles.set(keeper.id, squatter.id, frozenset({Role.CURATOR}))
    assert not people.accounts.of(squatter.id).roles
    people.accounts.use_code(people.accounts.code_for(keeper.id, squatter.id), "a password of its owner's")
    people.roles.set(keeper.id, squatter.id, frozenset({Role.CURATOR}))
    with refused("sign-in"):
        people.sessions.sign_in(ADDRESS, PASSWORD, office=True)
    made = people.accounts.make(keeper.id, "new@example.org")  # by the office: nobody has a password yet
    people.roles.set(keeper.id, made.id, frozenset({Role.EDITOR}))


def test_wrong_passwords_and_unknown_addresses_are_told_alike(people):
    people.accounts.sign_up(ADDRESS, PASSWORD)
    told = set()
    for address, password in ((ADDRESS, "wrong password"), ("nobody@example.org", PASSWORD)):
        with refused("sign-in") as caught:
            people.sessions.sign_in(address, password)
        told.add(str(caught.value))
    assert len(told) == 1


@pytest.fixture
def meanwhile(monkeypatch):
    """Have something done once, while the next password is looked at."""

    hasher = argon2.PasswordHasher.__mro__[-2]  # argon2's own, of which the tests' weak one is made

    def once(deed) -> None:
        verify = hasher.verify

        def slowly(self, *given) -> bool:
            right = verify(self, *given)
            monkeypatch.setattr(hasher, "verify", verify)
            deed()
            return right

        monkeypatch.setattr(hasher, "verify", slowly)

    return once


SINCE = "a password set meanwhile"


def changed_meanwhile(people: People, person, how: str) -> None:
    secret = pyotp.random_base32()
    match how:
        case "password":
            people.accounts.set_password(person, PASSWORD, SINCE)
        case "code":
            people.accounts.use_code(people.accounts.code_for("console", person.id), SINCE)
        case "closed":
            people.accounts.close("console", person.id, closed=True)
        case "factor":
            people.accounts.begin_second_factor(person, PASSWORD, secret, pyotp.TOTP(secret).now())


@pytest.mark.parametrize("how", ["password", "code", "closed", "factor"])
def test_who_was_signing_in_while_the_account_was_changed_is_not_in(people, ledger, meanwhile, how):
    staff(people, "keeper@example.org", Role.ADMINISTRATOR)
    person = people.accounts.sign_up(ADDRESS, PASSWORD)
    meanwhile(lambda: changed_meanwhile(people, person, how))
    with refused("sign-in"):
        people.sessions.sign_in(ADDRESS, PASSWORD)
    entry = people.journal.entries()[0]
    assert (entry.act, entry.subject, entry.refused) == ("sign in", person.id, True)
    assert people.sessions.of(person.id) == ()
    if how in ("password", "code"):
        with refused("sign-in"):
            people.sessions.sign_in(ADDRESS, PASSWORD)
        people.sessions.sign_in(ADDRESS, SINCE)


@pytest.mark.parametrize("deed", ["password", "factor", "factor off", "delete"])
def test_what_an_old_password_had_begun_is_not_done_once_there_is_a_new_one(people, meanwhile, deed):
    person, secret = people.accounts.sign_up(ADDRESS, PASSWORD), pyotp.random_base32()
    deeds = {
        "password": lambda: people.accounts.set_password(person, PASSWORD, "a stranger's password"),
        "factor": lambda: people.accounts.begin_second_factor(
            person, PASSWORD, secret, pyotp.TOTP(secret).now()
        ),
        "factor off": lambda: people.accounts.end_second_factor(person, PASSWORD),
        "delete": lambda: people.accounts.delete(person, PASSWORD),
    }
    meanwhile(lambda: changed_meanwhile(people, person, "code"))
    with refused("password-wrong"):
        deeds[deed]()
    found, _ = people.sessions.sign_in(ADDRESS, SINCE)
    assert not found.second_factor


def test_a_hash_is_made_anew_where_it_is_a_weaker_one_and_nowhere_else(people, ledger):
    def kept() -> str:
        with ledger.read() as connection:
            return connection.execute(select(tables.user.c.password)).scalar_one()

    person = people.accounts.sign_up(ADDRESS, PASSWORD)
    first = kept()
    people.sessions.sign_in(ADDRESS, PASSWORD)
    assert kept() == first
    (former,) = argon2.PasswordHasher.__bases__
    weaker = former(time_cost=2, memory_cost=8, parallelism=1).hash(PASSWORD)
    with ledger.change("console", "people", person.id) as connection:
        connection.execute(update(tables.user).values(password=weaker))
    people.sessions.sign_in(ADDRESS, PASSWORD)
    assert "t=1" in kept()
    people.sessions.sign_in(ADDRESS, PASSWORD)


def test_the_second_factor(people):
    person = people.accounts.sign_up(ADDRESS, PASSWORD)
    secret = pyotp.random_base32()
    with refused("authenticator"):
        people.accounts.begin_second_factor(person, PASSWORD, secret, "000000")
    with refused("password-wrong"):
        people.accounts.begin_second_factor(person, "wrong password", secret, pyotp.TOTP(secret).now())
    code = pyotp.TOTP(secret).now()
    recovery = people.accounts.begin_second_factor(person, PASSWORD, secret, code)
    assert len(set(recovery)) == RECOVERY_CODES
    for wrong in ("", "000000", code, secret, "ABCD-EFGH-JKMN"):  # `code` was used to set it up: not twice
        with refused("sign-in"):
            people.sessions.sign_in(ADDRESS, PASSWORD, wrong)
    people.sessions.sign_in(ADDRESS, PASSWORD, f" {recovery[0].lower().replace('-', ' ')} ")
    with refused("sign-in"):
        people.sessions.sign_in(ADDRESS, PASSWORD, recovery[0])
    with refused("sign-in"):
        people.sessions.sign_in(ADDRESS, "wrong password", recovery[1])
    people.sessions.sign_in(ADDRESS, PASSWORD, recovery[1])  # a wrong password used up no code
    people.accounts.end_second_factor(person, PASSWORD, recovery[2])
    people.sessions.sign_in(ADDRESS, PASSWORD)


def test_the_second_factor_is_replaced_and_turned_off_by_who_has_it(people):
    person, secret, other = (
        people.accounts.sign_up(ADDRESS, PASSWORD),
        *(pyotp.random_base32() for _ in "ab"),
    )
    code = pyotp.TOTP(secret).now()
    recovery = people.accounts.begin_second_factor(person, PASSWORD, secret, code)

    def replaced(present: str) -> tuple[str, ...]:
        return people.accounts.begin_second_factor(person, PASSWORD, other, pyotp.TOTP(other).now(), present)

    for wrong in ("", "000000", code, pyotp.TOTP(other).now()):  # `code` was used to set it up
        with refused("present-factor"):
            replaced(wrong)
        entry = people.journal.entries()[0]
        assert (entry.act, entry.subject, entry.refused) == ("second factor", person.id, True)
        with refused("present-factor"):
            people.accounts.end_second_factor(person, PASSWORD, wrong)
    with refused("password-wrong"):
        people.accounts.end_second_factor(person, "wrong password", recovery[0])
    people.sessions.sign_in(ADDRESS, PASSWORD, recovery[0])  # and none of that used it up
    newer = replaced(recovery[1])
    with refused("present-factor"):
        people.accounts.end_second_factor(person, PASSWORD, recovery[2])  # of the one before
    people.accounts.end_second_factor(person, PASSWORD, newer[0])
    assert not people.accounts.of(person.id).second_factor


def test_a_factor_that_was_set_up_by_who_never_proved_the_address_goes_with_a_code(people):
    squatter, secret = people.accounts.sign_up(ADDRESS, PASSWORD), pyotp.random_base32()
    people.accounts.begin_second_factor(squatter, PASSWORD, secret, pyotp.TOTP(secret).now())
    opened = people.accounts.use_code(people.accounts.code_for("console", squatter.id), "her own password 1")
    assert not opened.second_factor
    people.sessions.sign_in(ADDRESS, "her own password 1")
    people.accounts.begin_second_factor(opened, "her own password 1", secret, pyotp.TOTP(secret).now())
    again = people.accounts.use_code(people.accounts.code_for("console", squatter.id), "her own password 2")
    assert again.second_factor, "of a verified address it stays: a code stands in for the password alone"
    with refused("sign-in"):
        people.sessions.sign_in(ADDRESS, "her own password 2")


def test_one_recovery_code_sent_by_eight_at_once_lets_one_in(people):
    person = people.accounts.sign_up(ADDRESS, PASSWORD)
    secret = pyotp.random_base32()
    (code, *_) = people.accounts.begin_second_factor(person, PASSWORD, secret, pyotp.TOTP(secret).now())
    start = threading.Barrier(8)

    def attempt(_: int) -> bool:
        start.wait()
        try:
            people.sessions.sign_in(ADDRESS, PASSWORD, code)
        except PeopleError:
            return False
        return True

    with ThreadPoolExecutor(8) as pool:
        assert sum(pool.map(attempt, range(8))) == 1


def test_a_code_opens_an_account_once(people):
    person = people.accounts.sign_up(ADDRESS, PASSWORD)
    _, token = people.sessions.sign_in(ADDRESS, PASSWORD)
    first = people.accounts.code_for("console", person.id)
    code = people.accounts.code_for("console", person.id)
    link = code.lower().replace("-", " ")
    with refused("code"):
        people.accounts.holder(first)  # the newest alone is good
    with refused("password-short"):
        people.accounts.use_code(link, "short")
    people.accounts.use_code(link, "a new password for lan")
    assert people.sessions.find(token) is None, "whoever had the old password is out"
    with refused("code"):
        people.accounts.use_code(code, "yet another password")
    found, _ = people.sessions.sign_in(ADDRESS, "a new password for lan")
    assert found.verified is not None


def test_a_code_goes_out_of_date(people, ledger):
    person = people.accounts.sign_up(ADDRESS, PASSWORD)
    code = people.accounts.code_for("console", person.id)
    with ledger.change("console", "people", person.id) as connection:
        connection.execute(update(tables.code).values(expires=now()))
    with refused("code"):
        people.accounts.use_code(code, "a new password for lan")


def test_the_house_keeps_an_administrator(people):
    first = staff(people, ADDRESS, Role.ADMINISTRATOR)
    with refused("last-administrator"):
        people.roles.set(first.id, first.id, frozenset({Role.EDITOR}))
    with refused("last-administrator"):
        people.accounts.close(first.id, first.id, closed=True)
    with refused("last-administrator"):
        people.accounts.delete(first, PASSWORD)
    assert people.accounts.of(first.id) == first
    second = staff(people, "second@example.org", Role.ADMINISTRATOR)
    people.accounts.delete(first, PASSWORD)
    with refused("last-administrator"):
        people.roles.set(second.id, second.id, frozenset())


def test_a_closed_account_is_shut(people):
    staff(people, "keeper@example.org", Role.ADMINISTRATOR)
    person = people.accounts.sign_up(ADDRESS, PASSWORD)
    _, token = people.sessions.sign_in(ADDRESS, PASSWORD)
    people.accounts.close("console", person.id, closed=True)
    assert people.sessions.find(token) is None
    with refused("sign-in"):
        people.sessions.sign_in(ADDRESS, PASSWORD)
    people.accounts.close("console", person.id, closed=False)
    people.sessions.sign_in(ADDRESS, PASSWORD)


def test_what_is_deleted_is_gone_from_every_table_and_from_the_files(people, ledger, database):
    person = people.accounts.sign_up(ADDRESS, PASSWORD, name="Lan Yi the second")
    secret = pyotp.random_base32()
    people.sessions.sign_in(ADDRESS, PASSWORD)
    people.accounts.begin_second_factor(person, PASSWORD, secret, pyotp.TOTP(secret).now())
    people.accounts.code_for("console", person.id)
    people.roles.set("console", person.id, frozenset({Role.EDITOR}))
    staff(people, "keeper@example.org", Role.ADMINISTRATOR)
    with refused("password-wrong"):
        people.accounts.delete(person, "wrong password")
    assert ADDRESS in everything(ledger)
    people.accounts.delete(people.accounts.of(person.id), PASSWORD)
    kept = everything(ledger)
    for trace in (ADDRESS, "lan.yi", "Lan Yi", secret):
        assert trace not in kept
    told = people.journal.about(person.id)
    assert told[-1].act == "delete account"  # the pseudonym stays, and leads to nobody
    with refused("no-account"):
        people.accounts.of(person.id)
    if isinstance(database, Path):
        files = b"".join(file.read_bytes() for file in database.iterdir())
        assert b"keeper@example.org" in files
        for trace in (ADDRESS, "Lan Yi the second", secret):
            assert trace.encode() not in files


def test_a_closed_account_gets_no_code_and_is_deleted_by_the_house(people, ledger):
    keeper = staff(people, "keeper@example.org", Role.ADMINISTRATOR)
    person = people.accounts.sign_up(ADDRESS, PASSWORD, name="Lan Yi the second")
    people.keepsakes.keep(person.id, "gown")
    people.accounts.close(keeper.id, person.id, closed=True)
    with refused("account-closed") as caught:
        people.accounts.code_for(keeper.id, person.id)
    assert "open it again" in caught.value.text("en")
    assert "重新开放" in caught.value.text("zh")
    with refused("no-account"):
        people.accounts.code_for(keeper.id, "0123456789abcdef")
    people.accounts.remove(keeper.id, person.id)
    for trace in (ADDRESS, "Lan Yi", "gown"):
        assert trace not in everything(ledger)
    told = people.journal.about(person.id)[-1]
    assert (told.who, told.act, told.subject) == (keeper.id, "people", f"{person.id} deleted")
    with refused("no-account"):
        people.accounts.remove(keeper.id, person.id)
    with refused("last-administrator"):
        people.accounts.remove("console", keeper.id)
    assert people.accounts.of(keeper.id) == keeper


def test_a_copy_holds_all_but_secrets(people):
    person = people.accounts.sign_up(ADDRESS, PASSWORD, name="兰", language="zh")
    _, token = people.sessions.sign_in(ADDRESS, PASSWORD)
    with zipfile.ZipFile(io.BytesIO(people.copy_of(person))) as archive:
        assert archive.testzip() is None
        files = {name: archive.read(name).decode() for name in archive.namelist()}
    account = json.loads(files["account.json"])
    assert (account["address"], account["name"], account["id"]) == (ADDRESS, "兰", person.id)
    assert len(json.loads(files["sessions.json"])) == 1
    assert [entry["act"] for entry in json.loads(files["journal.json"])] == [
        "sign up",
        "sign in",
        "take copy",
    ]
    for secret in (token, PASSWORD, "$argon2"):
        assert secret not in "".join(files.values())


def test_a_copy_holds_what_names_the_person_elsewhere(people):
    keeper = staff(people, "keeper@example.org", Role.ADMINISTRATOR)
    person = staff(people, ADDRESS, Role.CURATOR)
    begins = now() + timedelta(days=2)
    plan = Plan("activity", "讲座", "A talk", begins, begins + timedelta(hours=1), 5, 2)
    (occasion,) = people.occasions.plan(keeper.id, plan)
    before = people.bookings.book(keeper.id, occasion, 1, "keeper's form")
    people.bookings.cancel(keeper.id, "reservations", before.id)  # SQLite gives its number again
    booked = people.bookings.book(person.id, occasion, 1, "a form")
    people.bookings.arrive(keeper.id, booked.id, here=True)
    people.followups.set(person.id, "a1.culture", "done", "larger letters")
    people.followups.set(keeper.id, "a2.culture", "open", "of another's")
    with people.revisions.adding(person.id, "publish", "gown", {"exhibit.toml": ("", "1")}):
        pass
    drafted = [{"exhibit": "robe", "at": "2026-11-28T10:00:00+00:00"}]
    with zipfile.ZipFile(io.BytesIO(people.copy_of(person, drafts=drafted))) as archive:
        files = {name: archive.read(name).decode() for name in archive.namelist()}
    assert [one["note"] for one in json.loads(files["followups.json"])] == ["larger letters"]
    assert [one["exhibit"] for one in json.loads(files["revisions.json"])] == ["gown"]
    assert json.loads(files["drafts.json"]) == drafted
    told = [(entry["act"], entry["subject"]) for entry in json.loads(files["journal.json"])]
    assert ("check-in", f"booking {booked.id}") in told
    assert "reservations" not in {act for act, _ in told}, "a number that was another's is no longer that"
    assert "authenticator" in files["README.txt"]
    assert "验证器密钥" in files["README.txt"]


def test_two_stores_may_share_a_database_server_and_an_older_schema_is_brought_up(database):
    """Alembic's steps and the tables as they are make one and the same schema."""
    from alembic import command
    from alembic.config import Config

    import hall_app.house.people.database as room

    People(database).close()
    if isinstance(database, Path):
        stepwise = create_engine(f"sqlite:///{database / 'steps.sqlite'}")
        space = None
        made = create_engine(f"sqlite:///{database / 'people.sqlite'}")
    else:
        made = create_engine(database)
        stepwise, space = made, "people"
        with made.begin() as connection:
            connection.execute(text("CREATE SCHEMA steps"))
    config = Config()
    config.set_main_option("script_location", str(Path(room.__file__).parent / "migrations"))
    with stepwise.begin() as connection:
        if space:
            connection.execute(text("SET search_path TO steps"))
        config.attributes["connection"] = connection
        command.upgrade(config, "head")
    shapes = [
        {
            table: [
                (c["name"], str(c["type"]), c["nullable"]) for c in found.get_columns(table, schema=where)
            ]
            for table in found.get_table_names(schema=where)
        }
        for found, where in ((inspect(made), space), (inspect(stepwise), "steps" if space else None))
    ]
    assert shapes[0] == shapes[1]
    for found, prefix in ((made, "people." if space else ""), (stepwise, "steps." if space else "")):
        with found.connect() as connection:
            newest = connection.execute(text(f"SELECT version_num FROM {prefix}alembic_version")).scalar()
            assert newest == HEAD, "the newest of the steps is the one a new house is told to have"
    made.dispose()
    stepwise.dispose()


@contextmanager
def stepped_back(database: Path | str, number: str) -> Iterator[Connection]:
    """A closed house as an older version left it, once the block has taken out what was not there yet."""
    here = isinstance(database, Path)
    engine = create_engine(f"sqlite:///{database / 'people.sqlite'}" if here else database)
    with engine.begin() as connection:
        if not here:
            connection.execute(text("SET search_path TO people"))
        yield connection
        connection.execute(text('ALTER TABLE "user" DROP COLUMN name_folded'))  # since 0009
        connection.execute(text("UPDATE alembic_version SET version_num = :number"), {"number": number})
    engine.dispose()


@pytest.mark.parametrize(
    "had", [(), ("revision",)], ids=["before revisions", "with the table under the older name"]
)
def test_a_house_of_an_older_schema_is_brought_up_and_keeps_its_people(database, had):
    first = People(database)
    person = first.accounts.sign_up(ADDRESS, PASSWORD)
    first.close()
    with stepped_back(database, "0003") as connection:
        for table in {"answer_code", "revision"} - {*had}:
            connection.execute(text(f"DROP TABLE {table}"))
    again = People(database)
    assert again.accounts.of(person.id).address == ADDRESS
    code = "0b2c7e7e-8f0e-4e1c-9d0a-3f5b6a7c8d9e"
    again.answer_codes.keep(person.id, code)
    assert [one.code for one in again.answer_codes.of(person.id)] == [code]
    assert again.revisions.of("gown") == ()
    again.close()


def test_withdrawal_codes_leave_a_house_of_an_older_schema(database):
    code = "0b2c7e7e-8f0e-4e1c-9d0a-3f5b6a7c8d9e"
    first = People(database)
    for key in (f"{code}.fabric", "a1.culture"):
        first.followups.set("console", key, "done", "Longer by 2 cm")
    first.close()
    with stepped_back(database, "0005"):
        pass
    again = People(database)
    named = f"{pseudonym(code)}.fabric"
    assert {one.id: one.note for one in again.followups.all().values()} == dict.fromkeys(
        (named, "a1.culture"), "Longer by 2 cm"
    )
    subjects = [entry.subject for entry in again.journal.entries() if entry.act == "answers"]
    assert sorted(subjects) == sorted((f"{named} done", "a1.culture done"))
    again.close()


def as_they_lie(ledger: Ledger) -> list[tuple]:
    """Of visits, whose and what, in the order in which the database has them; in PostgreSQL with what wrote each."""
    mark, place = ("''", "rowid") if ledger_is_sqlite(ledger) else ("CAST(xmin AS text)", "ctid")
    with ledger.read() as connection:
        found = connection.execute(text(f"SELECT exhibit, {mark} FROM look ORDER BY {place}"))
        return [tuple(row) for row in found]


def ledger_is_sqlite(ledger: Ledger) -> bool:
    with ledger.read() as connection:
        return connection.dialect.name == "sqlite"


def test_a_look_is_in_no_journal_and_nothing_tells_which_came_first(people, ledger):
    person = people.accounts.sign_up(ADDRESS, PASSWORD)
    people.keepsakes.note_look(person.id, "gown")
    assert people.keepsakes.looks(person.id) == (), "nothing is kept unasked"
    people.keepsakes.set_keeping(person.id, on=True)
    before = people.journal.entries()
    looked = ("robe", "belt", "gown", "coat", "robe")
    for exhibit in looked:
        people.keepsakes.note_look(person.id, exhibit)
    assert people.journal.entries() == before
    assert [one.exhibit for one in people.keepsakes.looks(person.id)] == sorted({*looked})
    if ledger_is_sqlite(ledger):
        assert [exhibit for exhibit, _ in as_they_lie(ledger)] == sorted({*looked})
    assert len({mark for _, mark in as_they_lie(ledger)}) == 1, "one transaction wrote them all"
    people.keepsakes.set_keeping(person.id, on=False)
    assert people.keepsakes.looks(person.id) == ()
    switched = [entry.subject for entry in people.journal.about(person.id) if entry.act == "visits"]
    assert switched == [f"{person.id} on", f"{person.id} off"]


def test_a_look_that_comes_while_visits_are_turned_off_is_not_kept(people, ledger):
    person = people.accounts.sign_up(ADDRESS, PASSWORD)
    people.keepsakes.set_keeping(person.id, on=True)
    looking = threading.Thread(target=people.keepsakes.note_look, args=(person.id, "gown"))
    with ledger.change(person.id, "visits", person.id) as connection:
        connection.execute(update(tables.user).values(keeps_looks=0))
        looking.start()
        time.sleep(0.3)  # it has seen that visits are kept, and waits for its turn to write
    looking.join()
    assert people.keepsakes.looks(person.id) == ()


def test_looks_leave_the_journal_of_a_house_of_an_older_schema(database, ledger):
    first = People(database)
    person = first.accounts.sign_up(ADDRESS, PASSWORD)
    first.keepsakes.set_keeping(person.id, on=True)
    first.close()
    today = now().date()
    with ledger.change(person.id, "visits", person.id) as connection:
        for exhibit in ("robe", "belt", "gown"):
            connection.execute(tables.look.insert().values(user=person.id, exhibit=exhibit, day=today))
    with stepped_back(database, "0006"):
        pass
    again = People(database)
    assert [entry.act for entry in again.journal.entries()] == ["sign up"]
    assert {one.exhibit for one in again.keepsakes.looks(person.id)} == {"robe", "belt", "gown"}
    if ledger_is_sqlite(ledger):
        assert [exhibit for exhibit, _ in as_they_lie(ledger)] == ["belt", "gown", "robe"]
    again.close()


def test_withdrawals_leave_the_journal_of_a_house_of_an_older_schema(database, ledger):
    with ledger.change("", "answers", "a1.culture withdrawn") as connection:
        space = "" if ledger_is_sqlite(ledger) else "people."
        connection.execute(text(f"UPDATE {space}alembic_version SET version_num = '0009'"))
    again = People(database)
    again.followups.set("console", "a1.culture", "done", "")
    assert [entry.subject for entry in again.journal.entries()] == ["a1.culture done"]
    again.close()


def test_what_was_noted_of_a_withdrawn_answer_is_in_no_table_and_no_file(people, ledger, database):
    """However often it was written anew; when it went is in no journal either."""
    for number in range(200):
        people.followups.set(
            "console", f"a{number}.culture", "done", f"note {number} " + "larger letters " * 20
        )
    for state in ("open", "answered", "done"):
        people.followups.set("console", "a7.fabric", state, f"as he said: wider sleeves, {state} " * 8)
    before = people.journal.entries()
    people.followups.forget("a7")
    assert people.journal.entries() == before
    assert len(people.followups.all()) == 199
    assert "wider sleeves" not in everything(ledger)
    if isinstance(database, Path):
        files = b"".join(file.read_bytes() for file in database.iterdir())
        assert b"note 8 " in files
        assert b"note 7 " not in files
        assert b"wider sleeves" not in files


def test_answers_and_people_in_one_postgres_database_do_not_meet(postgres):
    from survey.store import Store

    url = postgres()
    store, people = Store(url), People(url)
    people.accounts.sign_up(ADDRESS, PASSWORD)
    store.audit.note("export", "x")
    assert [entry.action for entry in store.audit.entries()] == ["export"]
    assert [entry.act for entry in people.journal.entries()] == ["sign up"]
    people.close()
    store.close()


def test_a_newer_schema_is_refused(tmp_path):
    People(tmp_path).close()
    engine = create_engine(f"sqlite:///{tmp_path / 'people.sqlite'}")
    with engine.begin() as connection:
        connection.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    engine.dispose()
    with pytest.raises(StoreError, match="install the newer version"):
        People(tmp_path)


def test_reading_makes_no_empty_house(tmp_path):
    with pytest.raises(SurveyError, match="no accounts there"):
        existing_people(tmp_path)
    assert list(tmp_path.iterdir()) == []


# The table of the house, as it was decided: who may do what.
DECIDED = {
    "draft preview": "editor curator administrator",
    "publish place bake undo": "curator administrator",
    "events reservations check-in": "curator administrator",
    "questionnaires answers analysis export": "researcher administrator",
    "people roles tokens audit backup": "administrator",
}


def test_the_table_of_acts_is_the_one_that_was_decided():
    decided = {act: set(roles.split()) for acts, roles in DECIDED.items() for act in acts.split()}
    assert {act: set(row.roles) for act, row in ACTS.items()} == decided
    assert not set(ACTS) & set(OWN_ACTS)
    for act in ACTS:
        assert not may((), act)
        assert may({Role.ADMINISTRATOR}, act)


def admin(folder: Path, *words: str, typed: str | None = None) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "hall_app", "admin", *words, "--data", str(folder)]
    return subprocess.run(command, capture_output=True, text=True, input=typed or "", check=False)


@pytest.mark.slow
def test_the_command_names_the_first_administrator(tmp_path):
    made = admin(tmp_path, "create", ADDRESS, "--generate")
    assert made.returncode == 0, made.stderr
    password = made.stdout.strip().splitlines()[-1].strip()
    ledger = Ledger(tmp_path)
    with ledger.read() as connection:
        kept = connection.execute(select(tables.user.c.password)).scalar_one()
    ledger.close()
    assert kept.startswith("$argon2id$v=19$m=47104,t=1,p=1$"), "what the tests weaken is strong in the house"
    people = People(tmp_path)
    person, _ = people.sessions.sign_in(ADDRESS, password, office=True)
    assert person.roles == {Role.ADMINISTRATOR}
    assert (tmp_path / "people.sqlite").stat().st_mode & 0o077 == 0
    again = admin(tmp_path, "create", ADDRESS, "--role", "curator")
    assert "keeps its password" in again.stdout
    assert people.accounts.of(person.id).roles == {Role.ADMINISTRATOR, Role.CURATOR}
    assert f"{ADDRESS}: administrator, curator; verified; 1 session" in admin(tmp_path, "list").stdout
    link = admin(tmp_path, "link", ADDRESS, "--url", "https://hall.example.org/").stdout.split()[-1]
    assert link.startswith("https://hall.example.org/me/open?code=")
    people.accounts.use_code(link.partition("=")[2], "a new password for lan")
    code = admin(tmp_path, "code", ADDRESS).stdout.split()[-1]
    assert people.accounts.holder(code).id == person.id
    assert "0 sessions ended" in admin(tmp_path, "revoke", ADDRESS).stdout
    with refused("code"):
        people.accounts.holder(code)  # a code that is about would let him in again
    people.close()


@pytest.mark.slow
def test_the_command_deletes_an_account_once_that_is_confirmed(tmp_path):
    people = People(tmp_path)
    staff(people, "keeper@example.org", Role.ADMINISTRATOR)
    person = people.accounts.sign_up(ADDRESS, PASSWORD)
    people.accounts.close("console", person.id, closed=True)
    asked = admin(tmp_path, "delete", ADDRESS)
    assert asked.returncode == 1
    assert "give --yes" in asked.stderr
    assert people.accounts.of(person.id).address == ADDRESS
    done = admin(tmp_path, "delete", ADDRESS, "--yes")
    assert done.returncode == 0, done.stderr
    assert "deleted" in done.stdout
    with refused("no-account"):
        people.accounts.of(person.id)
    assert people.journal.entries()[0].subject == f"{person.id} deleted"
    people.close()


@pytest.mark.slow
def test_the_command_makes_nobody_an_administrator_who_only_knew_the_address(tmp_path):
    people = People(tmp_path)
    squatter, secret = people.accounts.sign_up(ADDRESS, PASSWORD), pyotp.random_base32()
    people.accounts.begin_second_factor(squatter, PASSWORD, secret, pyotp.TOTP(secret).now())
    token = people.sessions.open(squatter)
    made = admin(tmp_path, "create", ADDRESS, "--generate")
    assert "never confirmed" in made.stdout, made.stderr
    assert people.sessions.find(token) is None
    with refused("sign-in"):
        people.sessions.sign_in(ADDRESS, PASSWORD, pyotp.TOTP(secret).at(now().timestamp() + 30))
    password = made.stdout.strip().splitlines()[-1].strip()
    person, _ = people.sessions.sign_in(ADDRESS, password, office=True)
    assert person.roles == {Role.ADMINISTRATOR}
    people.close()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("create", ADDRESS), "give --generate"),
        (("create", "nobody"), "write it as name@example.org"),
        (("list",), "as `hall serve` has it"),
    ],
)
def test_the_command_says_what_is_wrong_in_one_line(tmp_path, words, said):
    done = admin(tmp_path / "data", *words)
    assert done.returncode == 1
    assert said in done.stderr
    assert done.stderr.count("\n") == 1
