"""The office: the table of roles holds at both doors, refusals stand in the journal, strangers see none of it."""

from __future__ import annotations

import itertools
import json
import re
import time
from datetime import UTC, datetime, timedelta
from html import escape
from urllib.parse import urlencode

import pytest
from content_house import EXHIBIT
from form_visitor import Visitor
from office_clerk import PASSWORD, clerk
from open_counter import ASKED, SAID, answered

from hall_app.house.people import People, Role
from hall_app.house.people.records import Plan
from hall_app.web.platform import follow_withdrawals
from survey.errors import StoreError
from survey.export import pseudonym

NUMBERS = itertools.count()
SOON = (datetime.now(UTC) + timedelta(days=5)).replace(microsecond=0)
EVENT = {
    "title_zh": "讲座",
    "title_en": "A talk",
    "begins": SOON.isoformat(),
    "ends": (SOON + timedelta(hours=1)).isoformat(),
    "places": 3,
    "party": 2,
}

READ_AGAIN = 0.5  # [s] within which a changed questionnaire shows
HALF_A_LETTER = json.dumps(EVENT | {"text_zh": "\ud83e"}).encode()

# Every address of the office below its two doors, by the act that it takes. GET: to read, POST: to do.
READ = {
    "draft": ["collection", "collection/{key}", "collection/{key}/text", "collection/{key}/history"],
    "preview": [
        "collection/{key}/file",
        "collection/{key}/picture",
        "collection/{key}/shape",
        "collection/{key}/preview",
    ],
    "place": ["collection/{key}/place"],
    "bake": ["bakes"],
    "questionnaires": ["questionnaires"],
    "analysis": ["questionnaires/{key}/analysis"],
    "export": ["questionnaires/{key}/export"],
    "backup": ["backups", "backups/{key}/file", "restored"],
    "people": ["people", "people/{key}"],
    "audit": ["audit"],
    "events": ["events"],
    "reservations": ["events/{key}", "day"],
    "answers": ["suggestions"],
    "tokens": ["tokens"],
}
DONE = {
    "draft": [
        "collection",
        "collection/{key}/fields",
        "collection/{key}/text",
        "collection/{key}/upload",
        "collection/{key}/remove",
        "collection/{key}/drop",
    ],
    "place": ["collection/{key}/place"],
    "publish": ["collection/{key}/publish"],
    "undo": ["collection/{key}/undo"],
    "bake": ["bakes/{key}/stop", "bakes/{key}/again"],
    "backup": ["backups", "backups/{key}/remove", "backups/{key}/restore", "restored/{key}/remove"],
    "people": [
        "people",
        "people/{key}/code",
        "people/{key}/close",
        "people/{key}/delete",
        "people/{key}/open",
        "people/{key}/sign-out",
        "people/{key}/second-factor",
    ],
    "roles": ["people/{key}/roles"],
    "events": ["events", "visits", "events/{key}", "events/{key}/off"],
    "check-in": ["events/{key}/bookings/1/arrive", "events/{key}/bookings/1/leave"],
    "reservations": ["events/{key}/bookings/1/cancel"],
    "answers": ["suggestions/{key}"],
    "tokens": ["tokens", "tokens/1/revoke"],
}
# What an address does beside, by what it is asked for: further acts of their own.
KINDS = {
    "questionnaires/{key}/export": [f"?kind={kind}" for kind in ("csv", "xlsx", "sav", "codebook")],
    "people": ["?q=example.org"],
    "audit": ["?before=9"],
}
# What a deed takes beside its act, by what it would do to the chest that a curator has placed in a draft.
BESIDE = {
    "place": {
        "collection/chest/fields": {"place.x": "0.5"},
        "collection/chest/text": {"file": "exhibit.toml", "text": EXHIBIT.replace("x = 0.0", "x = 0.5")},
        "collection/chest/drop": {},
    },
}
# Forms whose address has no page of its own.
LEADING = {
    ("GET", path) for path in {*sum(DONE.values(), []), "sign-in", "sign-out"} - {*sum(READ.values(), [])}
}
MAY = {
    Role.EDITOR: {"draft", "preview"},
    Role.CURATOR: {
        "draft",
        "preview",
        "place",
        "publish",
        "undo",
        "bake",
        "events",
        "reservations",
        "check-in",
    },
    Role.RESEARCHER: {"questionnaires", "analysis", "export", "answers"},
}


@pytest.fixture
def people(counter) -> People:
    return counter.people


def forbidden(role: Role) -> list[tuple[str, str, str]]:
    """(method, address, act) of all that a role may not."""
    found = []
    for method, table in (("GET", READ), ("POST", DONE)):
        for act in table.keys() - MAY[role]:
            for path in table[act]:
                for kind in ("", *(KINDS.get(path, ()) if method == "GET" else ())):
                    whole = path.replace("{key}", "0123456789abcdef") + kind
                    found += [(method, f"/{door}/{whole}", act) for door in ("office", "api/office")]
    return sorted(found)


@pytest.mark.parametrize("role", MAY)
def test_what_a_role_may_not_is_refused_and_written_down(counter, people, role):
    one = clerk(counter, people, role)
    page_seal = one.get("/office").form("/office/sign-out")["seal"]
    tried = forbidden(role)
    assert len({(method, path) for method, path, _ in tried if path.startswith("/office/")}) >= 25
    for method, path, act in tried:
        before = people.journal.entries(most=1)[0].id
        if method == "GET":
            answer = one.ask("GET", path)
        elif path.startswith("/api"):
            answer = one.api(path.removeprefix("/api/office/"), {})
        else:
            answer = one.post(path, {"seal": page_seal})
        assert answer.status == 403, (method, path)
        (entry,) = [entry for entry in people.journal.entries(most=5) if entry.id > before]
        assert (entry.who, entry.act, entry.subject, entry.refused) == (
            one.person,
            act,
            path.partition("?")[0],
            True,
        )
    first = one.get("/office").text
    open_to = {path.split("/")[0] for act in MAY[role] for path in READ.get(act, ())}
    for part in {path.split("/")[0] for paths in READ.values() for path in paths} - open_to:
        assert f'href="/office/{part}?' not in first, "nobody is shown what he may not"


def test_what_a_deed_takes_beside_its_act_is_refused_and_written_down(counter, people):
    editor, curator = clerk(counter, people, Role.EDITOR), clerk(counter, people, Role.CURATOR)
    curator.told("collection/chest/place", {"place.x": "1.5"})
    placed = curator.told("collection/chest")
    for act, table in BESIDE.items():
        assert act not in MAY[Role.EDITOR]
        for path, given in table.items():
            for door in ("api/office", "office"):
                before = people.journal.entries(most=1)[0].id
                fields = given | {"seen": placed["mark"]}
                if door == "api/office":
                    answer = editor.api(path, fields)
                else:
                    seal = editor.get("/office").form("/office/sign-out")["seal"]
                    answer = editor.post(f"/office/{path}", fields | {"seal": seal})
                assert answer.status == 403, (door, path)
                (entry,) = [entry for entry in people.journal.entries(most=5) if entry.id > before]
                assert (entry.who, entry.act, entry.subject, entry.refused) == (
                    editor.person,
                    act,
                    f"/{door}/{path}",
                    True,
                )
    assert curator.told("collection/chest")["draft"] == placed["draft"]
    curator.drop("chest")


def test_the_table_holds_every_address_of_the_office(counter):
    """A new one that nobody forbade to anybody would be missed by the test above."""
    at_the_door = {
        ("GET", ""),
        ("POST", "sign-in"),
        ("POST", "sign-out"),
        ("GET", "me"),
        ("GET", "openapi.json"),
    }
    told = {
        (method, path)
        for method, table in (("GET", READ), ("POST", DONE))
        for paths in table.values()
        for path in paths
    }
    found = set()
    for route in counter.app.routes:
        path = getattr(route, "path", "")
        if path.startswith(("/office", "/api/office")):
            below = path.partition("office")[2].removeprefix("/")
            found |= {(method, below.replace("{booking}", "1")) for method in route.methods}
    found = {(method, path.replace("tokens/{key}", "tokens/1")) for method, path in found} - at_the_door
    assert found - LEADING == told
    assert LEADING <= found | at_the_door


def test_who_asks_for_the_address_of_a_form_is_led_to_its_page(counter, people):
    """By a mark that was set after a refusal, or by loading the page again."""
    one, stranger = clerk(counter, people, Role.ADMINISTRATOR), Visitor(counter.url)
    pages = {"visits": "events", "sign-in": "", "sign-out": ""}
    for _, path in LEADING:
        whole = path.replace("{key}", "chest").replace("tokens/1", "tokens/9")
        for visitor in (one, stranger):
            led = visitor.ask("GET", f"/office/{whole}?lang=en")
            assert led.status == 303, path
            to = led.headers["Location"]
            assert to.endswith("?lang=en")
            above = to.partition("?")[0].removeprefix("/office").strip("/")
            assert above == pages[path] if path in pages else f"{whole}/".startswith(f"{above}/"), path
            assert above in ("", "chest") or above.partition("/")[0] in {
                one.partition("/")[0] for one in sum(READ.values(), [])
            }
            answer = visitor.ask("GET", to)
            assert answer.status in (200, 303, 404), "a page, the door, or that there is no such thing"


def test_what_is_not_there_is_not_found(counter, people):
    one = clerk(counter, people, Role.ADMINISTRATOR)
    for path in ("events/nothing", "people/nothing"):
        assert one.api(path).status == 404
        told = one.get(f"/office/{path}?lang=en")
        assert told.status == 404
        assert "There is no such" in told.text


def test_strangers_see_none_of_it(counter):
    stranger = Visitor(counter.url)
    seal = stranger.get("/office").form("form-sign-in")["seal"]
    told = {"Content-Type": "application/json", "Origin": counter.url, "X-Seal": seal}
    for paths in READ.values():
        for path in paths:
            assert stranger.ask("GET", f"/office/{path}").headers["Location"].startswith("/office?")
            assert stranger.ask("GET", f"/api/office/{path}").status == 401
    for paths in DONE.values():
        for path in paths:
            assert stranger.post(f"/office/{path}", {"seal": seal}).headers["Location"].startswith("/office?")
            assert stranger.ask("POST", f"/api/office/{path}", b"{}", told).status == 401


def test_a_visitor_s_session_opens_no_office(counter, people):
    person = people.accounts.sign_up(f"visitor{next(NUMBERS)}@example.net", PASSWORD)
    people.roles.set("console", person.id, frozenset({Role.CURATOR}))
    visitor = Visitor(counter.url)
    visitor.send("/me", "form-sign-in", address=person.address, password=PASSWORD)
    assert visitor.ask("GET", "/api/office/events").status == 401
    people.roles.set("console", person.id, frozenset())
    refused = visitor.send("/office?lang=en", "form-sign-in", address=person.address, password=PASSWORD)
    assert "has no role in the house" in refused.text


def test_no_other_site_acts_for_the_office(counter, people):
    one = clerk(counter, people, Role.ADMINISTRATOR)
    body, kind = json.dumps(EVENT).encode(), {"Content-Type": "application/json"}
    good = kind | {"Origin": counter.url, "X-Seal": one.seal}
    for wrong in (
        good | {"Origin": "https://elsewhere.example.org"},
        kind | {"X-Seal": one.seal},
        kind | {"Origin": counter.url},
        good | {"X-Seal": "0" * 40},
    ):
        assert one.ask("POST", "/api/office/events", body, wrong).status == 403
    assert one.ask("POST", "/api/office/events", body, good | {"Content-Type": "text/plain"}).status == 400
    for odd in (b"[]", b"{", b'{"places": null}', b'{"title_zh": {}}', b"\xff", b"[" * 9000, HALF_A_LETTER):
        answer = one.ask("POST", "/api/office/events", odd, good)
        assert (answer.status, json.loads(answer.body)["error"]) == (400, "form-kind"), odd
    large = json.dumps(EVENT | {"text_zh": "一" * 20_000}).encode()
    assert one.ask("POST", "/api/office/events", large, good).status == 413
    assert one.ask("POST", "/api/office/events", body, good).status == 200


def test_an_event_from_plan_to_check_in(counter, people):
    one = clerk(counter, people, Role.CURATOR)
    key = one.told("events", EVENT)["id"]
    asking = [people.accounts.make("console", f"guest{next(NUMBERS)}@example.org").id for _ in range(3)]
    made = [people.bookings.book(person, key, 2, person) for person in asking]
    assert [booking.place for booking in made] == [0, 1, 2]
    page = one.get(f"/office/events/{key}?lang=en")
    at = f"/office/events/{key}/bookings/{made[0].id}"
    assert one.send(page, f"{at}/arrive").text.count(f"{at}/leave") == 1
    told = one.told(f"events/{key}")
    assert [booking["waiting"] for booking in told["bookings"]] == [0, 1, 2]
    assert told["bookings"][0]["arrived"] is not None
    one.told(f"events/{key}", EVENT | {"places": 5, "title_en": "A longer talk"})
    told = one.told(f"events/{key}")
    assert (told["title_en"], told["taken"], told["waiting"]) == ("A longer talk", 4, 2)
    other = one.told("events", EVENT)["id"]
    for path, given in ((other, {}), (key, {"turn": 99})):
        for deed in ("arrive", "leave", "cancel"):
            assert one.api(f"events/{path}/bookings/{made[0].id}/{deed}", given).status == 404
    one.told(f"events/{key}/bookings/{made[0].id}/cancel", {"turn": told["bookings"][0]["turn"]})
    assert [booking["waiting"] for booking in one.told(f"events/{key}")["bookings"]] == [0, 0]
    day = SOON.astimezone().date()
    assert key in [sheet["id"] for sheet in one.told(f"day?day={day}")]
    assert "A longer talk" in one.get(f"/office/day?day={day}&lang=en").text
    for edge in ("0001-01-01", "9999-12-31", "2026-13-01"):
        assert one.get(f"/office/day?day={edge}").status == 200
    off = f"/office/events/{key}/off"
    unsure = one.send(f"/office/events/{key}?lang=en", "form-off")
    assert unsure.status == one.api(f"events/{key}/off", {}).status == 400
    assert "It cannot be put back" in unsure.text
    assert "People down for it, to be told by you: 4." in unsure.text, "nobody is called off unasked"
    assert one.told(f"events/{key}")["cancelled"] is False
    assert one.send(unsure, "form-off", sure="on").status == 200
    assert one.told(f"events/{key}")["cancelled"] is True
    assert off not in one.get(f"/office/events/{key}").text
    assert f"/activities/{key}" not in Visitor(counter.url).get("/activities").text


def test_hours_for_visits_are_cut_into_slots(counter, people):
    one = clerk(counter, people, Role.CURATOR)
    hours = EVENT | {"ends": (SOON + timedelta(hours=3)).isoformat()}
    keys = one.told("visits", hours | {"minutes": 45})["ids"]
    assert len(keys) == 4
    found = [one.told(f"events/{key}") for key in keys]
    assert all(slot["kind"] == "visit" for slot in found)
    assert [slot["ends"] for slot in found[:-1]] == [slot["begins"] for slot in found[1:]]
    for minutes in (0, 4, "x"):
        assert one.api("visits", hours | {"minutes": minutes}).status == 400


def test_two_who_change_an_event_at_once_do_not_undo_each_other(counter, people):
    first, second = clerk(counter, people, Role.CURATOR), clerk(counter, people, Role.CURATOR)
    key = first.told("events", EVENT)["id"]
    page, other = (one.get(f"/office/events/{key}?lang=en") for one in (first, second))
    assert first.send(page, "form-event", title_en="Mine").status == 200
    refused = second.send(other, "form-event", title_en="Theirs")
    assert refused.status == 409
    assert "Somebody changed this since you looked at it" in refused.text
    assert 'value="Theirs"' in refused.text
    assert first.told(f"events/{key}")["title_en"] == "Mine"
    assert second.send(refused, "form-event").status == 200
    now = first.told(f"events/{key}")
    assert now["title_en"] == "Theirs"
    assert first.api(f"events/{key}", EVENT | {"seen": "0" * 16}).status == 409
    first.told(f"events/{key}", EVENT | {"seen": now["mark"]})


def test_nothing_is_planned_in_the_past(counter, people):
    one = clerk(counter, people, Role.CURATOR)
    past = EVENT | {"begins": "2020-03-05T10:00", "ends": "2020-03-05T12:00"}
    key, before = one.told("events", EVENT)["id"], len(one.told("events?past=1"))
    for path, given in (("events", past), ("visits", past | {"minutes": 30}), (f"events/{key}", past)):
        told = one.api(path, given)
        assert (told.status, json.loads(told.body)["error"]) == (400, "occasion-past")
        assert "2020-03-05 10:00 is past" in told.text
        assert "2020-03-05 10:00 已经过去" in one.api(f"{path}?lang=zh", given).text
    assert len(one.told("events?past=1")) == before
    begun = Plan("activity", "讲座", "A talk", SOON - timedelta(days=6), SOON, 3, 2)
    (running,) = people.occasions.plan("console", begun)
    page = one.get(f"/office/events/{running}?lang=en")
    assert one.send(page, "form-event", title_en="Goes on").status == 200, (
        "what has begun is changed all the same"
    )
    assert one.told(f"events/{running}")["title_en"] == "Goes on"


@pytest.mark.parametrize("year", ["0001", "1969", "2199", "9999"])
def test_nothing_is_planned_in_another_age(counter, people, year):
    """No clock in the world tells some of these hours: a page that listed one would be none for anybody."""
    one = clerk(counter, people, Role.CURATOR)
    key = one.told("events", EVENT)["id"]
    hours = ("0001-01-01T00:10+00:00", "0001-01-01T23:50+00:00")
    hours = hours if year == "0001" else (f"{year}-12-31T22:30+00:00", f"{year}-12-31T23:30+00:00")
    given = EVENT | dict(zip(("begins", "ends"), hours, strict=True))
    for path, more in (("events", {}), ("visits", {"minutes": 30}), (f"events/{key}", {})):
        told = one.api(path, given | more)
        assert (told.status, json.loads(told.body)["error"]) == (400, "occasion-far"), path
        assert f"1970 to {SOON.year + 10}" in told.text
        assert "1970 年" in one.api(f"{path}?lang=zh", given | more).text


def test_hours_are_of_visits_and_ask_for_no_kind(counter, people):
    one = clerk(counter, people, Role.CURATOR)
    page = one.get("/office/events?lang=en")
    assert "kind" in page.form("form-event")
    assert "kind" not in page.form("form-visits")
    told = json.loads(one.api("openapi.json").body)["paths"]["/api/office/visits"]["post"]["requestBody"]
    assert "kind" not in told["content"]["application/json"]["schema"]["properties"]


@pytest.mark.parametrize(
    "wrong", [{"begins": "tomorrow"}, {"places": 0}, {"places": "many"}, {"party": 9}, {"title_en": ""}]
)
def test_a_faulty_plan_is_told_beside_its_form(counter, people, wrong):
    one = clerk(counter, people, Role.CURATOR)
    given = {name: str(value) for name, value in (EVENT | wrong).items()}
    told = one.send("/office/events?lang=en", "form-event", **given)
    assert told.status == 400
    assert 'role="alert"' in told.text
    assert one.api("events", EVENT | wrong).status == 400


def test_people_get_roles_codes_and_are_shut_out(counter, people):
    one = clerk(counter, people, Role.ADMINISTRATOR)
    address = f"new{next(NUMBERS)}@example.org"
    made = one.send("/office/people?lang=en", "form-person", address=address, name="Newcomer")
    key = made.address.partition("?")[0].rpartition("/")[2]
    one.send(made, "form-roles", editor="on", researcher="on")
    assert one.told(f"people/{key}")["roles"] == ["editor", "researcher"]
    assert one.told(f"people/{key}/roles", {"roles": ["curator"]})["roles"] == ["curator"]
    assert one.api(f"people/{key}/roles", {"roles": ["emperor"]}).status == 400
    shown = one.send(f"/office/people/{key}?lang=en", f"/office/people/{key}/code")
    code = re.findall(r"<code>([-A-Z0-9]{14})</code>", shown.text)[0]
    newcomer = Visitor(counter.url)
    assert (
        address in newcomer.send("/me/open", "form-open", code=code, password=PASSWORD, again=PASSWORD).text
    )
    one.told(f"people/{key}/close", {})
    assert address not in newcomer.get("/me").text
    one.told(f"people/{key}/open", {})
    assert not one.told(f"people/{key}")["closed"]
    acts = [entry["act"] for entry in one.told("audit") if entry["who"] == one.person]
    assert {"people", "roles"} <= set(acts)
    assert address in one.get("/office/audit?lang=en").text


def test_who_stands_beyond_the_page_is_found(counter, people):
    one, crowd = clerk(counter, people, Role.ADMINISTRATOR), next(NUMBERS)
    for number in range(201):
        people.accounts.make("console", f"crowd{crowd}-{number:03}@example.org", name="Of <b>the</b> crowd")
    last = f"crowd{crowd}-200@example.org"
    page = one.get("/office/people?lang=en")
    assert last not in page.text
    assert f"{people.accounts.count()} accounts in all" in page.text
    assert "the first 200 are listed" in page.text
    fields = page.form("form-search")
    assert fields["q"] == ""
    found = one.get(f"/office/people?{urlencode(fields | {'q': f'crowd{crowd}-20'})}")
    assert last in found.text
    assert f'value="crowd{crowd}-20"' in found.text
    assert f"1 of {people.accounts.count()} accounts" in found.text
    assert "are listed" not in found.text
    assert people.accounts.count("Of <B>the") == people.accounts.count(f"crowd{crowd}-") == 201
    nobody = one.get("/office/people?q=nobody-at-all&lang=zh")
    assert f"共 {people.accounts.count()} 个账户，符合的有 0 个" in nobody.text
    assert "q=nobody-at-all&amp;lang=en" in nobody.text, "the other language asks the same"


def test_a_closed_account_is_deleted_once_its_address_was_typed(counter, people):
    one = clerk(counter, people, Role.ADMINISTRATOR)
    person = people.accounts.sign_up(f"closed{next(NUMBERS)}@example.org", PASSWORD)
    at = f"people/{person.id}"
    one.told(f"{at}/close", {})
    for lang, said in (("en", "This account is closed"), ("zh", "这个账户已关闭")):
        told = one.send(f"/office/{at}?lang={lang}", f"/office/{at}/code")
        assert told.status == 400
        assert said in told.text
    wrong = one.send(f"/office/{at}?lang=en", "form-delete", address="somebody@example.org")
    assert wrong.status == 400
    assert "Type the address" in wrong.text.partition("refused")[2]
    assert one.api(f"{at}/delete", {}).status == 400
    assert people.accounts.of(person.id).address == person.address
    gone = one.send(wrong, "form-delete", address=f" {person.address.upper()}")
    assert (gone.status, gone.address.partition("?")[0]) == (200, "/office/people")
    assert one.api(at).status == 404
    assert person.address not in one.get("/office/audit?lang=en").text
    (told,) = [entry for entry in one.told("audit") if entry["subject"] == f"{person.id} deleted"]
    assert (told["act"], told["who"]) == ("people", one.person)


def test_tokens_are_made_shown_once_and_revoked(counter, people):
    one = clerk(counter, people, Role.ADMINISTRATOR)
    secret = one.told("tokens", {"label": "for its second paper"})["token"]
    (kept,) = [token for token in one.told("tokens") if token["label"] == "for its second paper"]
    assert secret not in one.get("/office/tokens").text
    one.told(f"tokens/{kept['id']}/revoke", {})
    assert one.api(f"tokens/{kept['id']}/revoke", {}).status == 404
    assert one.api("tokens", {"label": " "}).status == 400


@pytest.fixture
def questions(counter):
    """The file of the questionnaire, put back as it was."""
    path = counter.content / f"questionnaires/{ASKED.id}.toml"
    text = path.read_text("utf-8")
    yield path
    path.write_text(text, "utf-8")
    time.sleep(READ_AGAIN)


def test_what_was_answered_stays_in_reach_under_a_new_version_and_without_its_file(
    counter, people, questions
):
    one, (code, _) = (
        clerk(counter, people, Role.RESEARCHER),
        (answered(counter), answered(counter, dict.fromkeys(ASKED.item_ids, 2))),
    )
    mine, at = f"{pseudonym(code)}.", f"questionnaires/{ASKED.id}"
    newer = ASKED.version + 1
    raised = questions.read_text("utf-8").replace(f"\nversion = {ASKED.version}\n", f"\nversion = {newer}\n")

    def told() -> dict:
        (found,) = [asked for asked in one.told("questionnaires") if asked["id"] == ASKED.id]
        return found

    for change, version, open_here in (
        (lambda: questions.write_text(raised, "utf-8"), newer, True),
        (questions.unlink, ASKED.version, False),
    ):
        change()
        time.sleep(READ_AGAIN)
        assert (told()["version"], told()["asked"]) == (version, open_here)
        assert told()["versions"][str(ASKED.version)] >= 1
        assert any(said["id"].startswith(mine) for said in one.told("suggestions"))
        assert one.told(f"{at}/analysis?version={ASKED.version}")["n"] >= 2
        page = one.get("/office/questionnaires?lang=en").text
        for way in (
            f"analysis?lang=en&amp;version={ASKED.version}",
            f"export?lang=en&amp;version={ASKED.version}&amp;",
        ):
            assert f"/office/{at}/{way}" in page
        rows = one.get(f"/office/{at}/export?kind=csv&version={ASKED.version}")
        assert pseudonym(code) in rows.text
        assert one.get(f"/office/{at}/export?kind=csv&version=77").status == 400
        assert f"v{ASKED.version}" in one.get(f"/office/{at}/analysis?lang=en&version={ASKED.version}").text


def test_a_suggestion_is_followed_up_and_tells_no_withdrawal_code(counter, people):
    one = clerk(counter, people, Role.RESEARCHER)
    before = {said["id"] for said in one.told("suggestions")}  # of tests that share the house
    code, other = answered(counter), answered(counter)
    mine = [said for said in one.told("suggestions") if said["id"] not in before]
    assert {(said["text"], said["state"], said["by"]) for said in mine} == {(SAID, "open", "")}
    named = {said["id"].partition(".")[0]: said["id"] for said in mine}
    withdrawn, left = named[pseudonym(code)], named[pseudonym(other)]
    page = one.get("/office/suggestions?lang=en")
    assert escape(SAID) in page.text
    done = one.send(page, "form-follow-0", state="done", note="Longer by 2 cm")
    assert "Longer by 2 cm" in done.text
    (told,) = [said for said in one.told("suggestions") if said["id"] in named.values() and said["note"]]
    assert (told["state"], told["note"], told["by"]) == ("done", "Longer by 2 cm", one.person)
    for key, state, status in (("nothing", "done", 404), (left, "shelved", 400)):
        assert one.api(f"suggestions/{key}", {"state": state}).status == status
    for key in (withdrawn, left):
        one.told(f"suggestions/{key}", {"state": "answered"})

    keeper = clerk(counter, people, Role.ADMINISTRATOR)
    told = [one.get("/office/suggestions"), one.api("suggestions"), keeper.get("/office/audit")]
    told += [keeper.api("audit"), keeper.get("/office")]
    rows = " ".join(map(str, people.followups.all().values()))
    for secret in (code, other):
        assert not any(secret in answer.text for answer in told), "who has it can take the answer back"
        assert secret not in rows
    assert one.ask("DELETE", f"/api/v1/questionnaires/{ASKED.id}/submissions/{code}").status in (202, 204)
    kept = set(people.followups.all())
    assert withdrawn not in kept, "what was noted of a withdrawn answer goes with it"
    assert left in kept
    subjects = [entry.subject for entry in people.journal.entries() if entry.act == "answers"]
    assert not [told for told in subjects if told.endswith("withdrawn")], "nor is it told when that was"
    assert withdrawn not in {said["id"] for said in one.told("suggestions")}


@pytest.mark.parametrize("next_time", ["listed", "opened"])
def test_what_was_noted_of_a_withdrawn_answer_goes_also_where_the_store_failed_then(
    counter, people, monkeypatch, next_time
):
    one = clerk(counter, people, Role.RESEARCHER)
    withdrawn, left = answered(counter), answered(counter)
    for said in one.told("suggestions"):
        if said["id"].startswith((pseudonym(withdrawn), pseudonym(left))):
            one.told(f"suggestions/{said['id']}", {"state": "done", "note": "Longer by 2 cm"})

    def noted() -> set[str]:
        return {key.partition(".")[0] for key in people.followups.all()} & {
            *map(pseudonym, (withdrawn, left))
        }

    def fails(answer: str) -> None:
        raise StoreError("locked")

    with monkeypatch.context() as broken:
        broken.setattr(people.followups, "forget", fails)
        gone = one.ask("DELETE", f"/api/v1/questionnaires/{ASKED.id}/submissions/{withdrawn}")
        assert gone.status in (202, 204), "it is withdrawn all the same"
    assert noted() == {pseudonym(withdrawn), pseudonym(left)}
    if next_time == "opened":
        follow_withdrawals(counter.survey, people)
    else:
        one.told("suggestions")
    assert noted() == {pseudonym(left)}


def test_what_was_noted_of_answers_that_are_listed_no_more_stays(counter, people, monkeypatch):
    """Their questionnaire has another version by now, say, or its file is gone for a while."""
    one, code = clerk(counter, people, Role.RESEARCHER), answered(counter)
    (said,) = [said for said in one.told("suggestions") if said["id"].startswith(pseudonym(code))]
    one.told(f"suggestions/{said['id']}", {"state": "done"})
    monkeypatch.setattr(counter.house, "survey_suggestions", tuple)
    assert one.told("suggestions") == []
    assert said["id"] in people.followups.all()
