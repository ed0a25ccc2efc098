"""Backups, questionnaires and bakes from the office."""

from __future__ import annotations

import json
import random
import re
import shlex
from html import unescape
from pathlib import Path
from urllib.parse import quote

import event_loop
import pytest
from office_clerk import clerk
from office_stock import Slow
from open_counter import ASKED, answered, open_counter

from hall_app.content import load
from hall_app.house.baking import ROOM, Bake, BakingQueue
from hall_app.house.people import People, Role
from hall_app.house.safekeeping import check_archive, tidy
from hall_app.web.answers import HeadToo
from survey import Store


@pytest.fixture
def administrator(counter):
    return clerk(counter, counter.people, Role.ADMINISTRATOR)


def test_the_command_of_a_restored_house_can_be_pasted(tmp_path):
    with open_counter(tmp_path / "my house") as counter:
        one = clerk(counter, counter.people, Role.ADMINISTRATOR)
        name = one.told("backups", {})["name"]
        done = one.send("/office/backups?lang=en", "form-restore-0", name=name)
        command = shlex.split(unescape(re.findall(r"<code>(hall serve .*?)</code>", done.text)[0]))
        home = counter.data / "restored" / name.removesuffix(".zip")
    assert command == ["hall", "serve", "--content", str(home / "content"), "--data", str(home / "data")]


def test_a_backup_is_made_fetched_and_restored_beside(counter, administrator, tmp_path):
    one = administrator
    for other in one.told("backups"):  # of tests that share the house
        one.told(f"backups/{other['name']}/remove", {})
    assert "There is none yet" in one.get("/office/backups?lang=en").text
    page = one.send("/office/backups?lang=en", "form-make")
    assert page.status == 200
    (told,) = one.told("backups")
    fetched = one.ask("GET", f"/office/backups/{told['name']}/file")
    assert fetched.headers["Content-Type"] == "application/zip"
    assert fetched.headers["Cache-Control"] == "no-store"
    file = tmp_path / "fetched.zip"
    file.write_bytes(fetched.body)
    assert check_archive(file).people == len(counter.people.accounts.all(most=10_000))
    assert len(fetched.body) == told["size"]
    wrong = one.send(page, "form-restore-0", name="something else")
    assert wrong.status == 400
    assert not (counter.data / "restored").exists()
    done = one.send(page, "form-restore-0", name=told["name"])
    assert "hall serve --content" in done.text
    assert "one-time codes and tokens are void" in done.text
    home = counter.data / "restored" / told["name"].removesuffix(".zip")
    assert load(home / "content").exhibit("chest") is not None
    people = People(home / "data")
    try:
        assert people.accounts.of(one.person).roles == {Role.ADMINISTRATOR}
    finally:
        people.close()
    assert home.name in [house["name"] for house in one.told("restored")]
    page = one.get("/office/backups?lang=en")
    at = f"/office/restored/{home.name}/remove"
    wrong = one.send(page, at, name="another")
    assert wrong.status == 400
    assert "Type the name of the house" in wrong.text
    assert home.is_dir()
    assert home.name not in one.send(wrong, at, name=home.name).text.partition("Restored houses")[2]
    assert not home.exists()
    for name in ("..", "backups", "hall-20200101-000000"):
        assert one.api(f"restored/{name}/remove", {"name": name}).status == 404
    acts = [entry["subject"] for entry in one.told("audit") if entry["act"] == "backup"]
    assert any(subject.startswith("fetch ") for subject in acts)
    one.told(f"backups/{told['name']}/remove", {})
    assert one.told("backups") == []


@pytest.mark.parametrize("name", ["..", "hall.zip", "..%2f..%2fpeople.sqlite", "people.sqlite"])
def test_nothing_but_backups_is_handed_out(administrator, name):
    assert administrator.ask("GET", f"/office/backups/{name}/file").status == 404
    assert administrator.api(f"backups/{name}/file").status == 404


@pytest.fixture
def unasked(tmp_path, quick_hashes):
    """A counter of its own: nobody has answered anything there."""
    with open_counter(tmp_path) as found:
        yield found


def leave(folder: Path) -> set[Path]:
    """What a backup leaves that is killed."""
    copy = folder / ".backup-killed"
    copy.mkdir(parents=True)
    (copy / "people.sqlite").write_bytes(b"addresses")
    (folder / "hall-20200101-000000.zip.part").write_bytes(b"half of it")
    return {copy, folder / "hall-20200101-000000.zip.part"}


def test_what_killed_backups_left_is_tidied_away(tmp_path, quick_hashes):
    left = leave(tmp_path / "data" / "backups")
    with open_counter(tmp_path) as counter:
        assert not any(path.exists() for path in left), "when the house is opened"
        one = clerk(counter, counter.people, Role.ADMINISTRATOR)
        left = leave(counter.data / "backups")
        kept = counter.data / "backups" / "notes.txt"
        kept.write_text("of the administrator's own")
        name = one.told("backups", {})["name"]
        assert {path.name for path in kept.parent.iterdir()} == {name, kept.name}, "and before a backup"


def test_a_backup_that_is_at_work_is_none_of_the_leavings(tmp_path, quick_hashes, monkeypatch):
    seen, copy_to = [], Store.copy_to

    def copied(store: Store, path: Path) -> int:
        tidy(path.parents[1])  # as another house would that is opened meanwhile
        seen.append(path.parent.is_dir())
        return copy_to(store, path)

    monkeypatch.setattr(Store, "copy_to", copied)
    with open_counter(tmp_path) as counter:
        clerk(counter, counter.people, Role.ADMINISTRATOR).told("backups", {})
    assert seen == [True]


def test_what_was_refused_is_not_told_as_done(unasked):
    """Nor is it an attempt of somebody who may not: the journal has no row of it."""
    one = clerk(unasked, unasked.people, Role.ADMINISTRATOR)

    def own() -> list[tuple[str, str]]:
        return [
            (entry.act, entry.subject)
            for entry in unasked.people.journal.entries()
            if entry.who == one.person and entry.act not in ("sign up", "sign in")
        ]

    assert one.api("tokens/7/revoke", {}).status == 404
    assert one.api("collection/chest/text", {"file": "text.en.md", "text": "x", "tag": "a-b"}).status == 409
    assert one.api("collection/chest/drop", {}).status == 404
    assert one.api("questionnaires/garment/analysis").status == 400
    (unasked.content / "exhibits" / "linked").symlink_to(unasked.content / "exhibits" / "chest")
    assert one.api("backups", {}).status == 400
    (unasked.content / "exhibits" / "linked").unlink()
    assert own() == []
    name = one.told("backups", {})["name"]
    file = unasked.data / "backups" / name
    whole = file.read_bytes()
    file.write_bytes(whole[:-9])
    assert one.api(f"backups/{name}/restore", {"name": name}).status == 400
    assert not list((unasked.data / "restored").glob("*"))
    assert own() == [("backup", f"make {name}")]
    one.told("tokens", {"label": "for the paper"})
    one.told("tokens/1/revoke", {})
    one.told("collection/chest/text", {"file": "text.en.md", "text": "A chest.\n"})
    one.drop("chest")
    assert [act for act, _ in own()] == ["draft", "draft", "tokens", "tokens", "backup"]


def test_answers_are_counted_and_handed_out(unasked):
    one = clerk(unasked, unasked.people, Role.RESEARCHER)
    (told,) = one.told("questionnaires")
    assert (told["id"], told["answers"]) == ("garment", 0)
    page = one.get("/office/questionnaires?lang=en").text
    assert "/office/questionnaires/garment/export" in page
    csv = one.ask("GET", "/office/questionnaires/garment/export?kind=codebook")
    assert csv.status == 200
    assert "attachment" in csv.headers["Content-Disposition"]
    assert csv.body
    refused = one.api("questionnaires/garment/analysis")
    assert refused.status == 400, "nobody has answered yet"
    assert json.loads(refused.body)["error"] == "survey-refused"
    assert one.api("questionnaires/nothing/analysis").status == 404
    assert one.ask("GET", "/office/questionnaires/garment/export?kind=exe").status == 404


def test_who_asks_only_whether_it_is_there_leaves_no_row(tmp_path, quick_hashes):
    """HEAD has no body: the journal must not tell of a file that nobody got."""
    with open_counter(tmp_path, around=HeadToo) as house:
        answered(house)
        one = clerk(house, house.people, Role.ADMINISTRATOR)
        name = one.told("backups", {})["name"]
        token = house.survey.store.tokens.make("for the paper")
        before, audit = house.people.journal.entries(), house.survey.store.audit
        noted, asked = audit.entries(), "questionnaires/garment"
        for path in (f"{asked}/export?kind=csv", f"{asked}/analysis", f"backups/{name}/file", "people"):
            for door in ("/office", "/api/office"):
                told = one.ask("HEAD", f"{door}/{path}")
                assert (told.status, told.headers["Allow"]) == (405, "GET"), path
        rows = f"/api/v1/{asked}/rows"
        known = {"Authorization": f"Bearer {token}"}
        assert one.ask("HEAD", rows, headers=known).status == 405
        assert house.people.journal.entries() == before
        assert audit.entries() == noted
        assert one.ask("GET", f"/office/{asked}/export?kind=csv").status == 200
        assert one.ask("GET", rows, headers=known).status == 200
        assert (len(house.people.journal.entries()), len(audit.entries())) == (
            len(before) + 1,
            len(noted) + 2,
        )
        assert one.ask("HEAD", "/office").status == one.ask("HEAD", "/me").status == 200


@pytest.mark.parametrize(
    ("answers", "codes"),
    [
        (0, None),
        (6, {"constant_item", "too_few_rows"}),
        (len(ASKED.item_ids) + 8, {"constant_item", "dependent_items"}),
    ],
)
def test_what_an_analysis_warns_of_is_told_in_the_language_of_the_page(unasked, answers, codes):
    """Also why a step failed, and why there is no analysis. Programs are told what they always were."""
    one, draw = clerk(unasked, unasked.people, Role.RESEARCHER), random.Random(7)
    first, second, third, *_ = ASKED.item_ids
    for _ in range(answers):
        scores = {item: draw.randint(1, 5) for item in ASKED.item_ids}
        answered(
            unasked, scores=scores | {first: 4, second: scores[third]}
        )  # all judge alike, two say the same
    pages = {}
    for lang in ("zh", "en"):
        page = one.get(f"/office/questionnaires/garment/analysis?lang={lang}")
        assert page.status == (200 if answers else 400)
        (listed,) = re.findall(r'<(?:ul class="names"|p class="refused").*?</(?:ul|p)>', page.text, re.DOTALL)
        pages[lang] = unescape(re.sub("<[^>]+>", "\n", listed))
    names = "|".join((*ASKED.item_ids, "KMO|Bartlett|Kaiser|MAP|HTTP", r"(--)?reverse\b( = true)?"))
    assert not re.search("[A-Za-z]{2,}", re.sub(names, "", pages["zh"])), pages["zh"]
    assert not re.search(r"[\u4e00-\u9fff]", pages["en"]), pages["en"]
    if codes:
        analysed, label = one.told("questionnaires/garment/analysis"), ASKED.items[0].label
        assert label.zh in pages["zh"]
        assert label.en in pages["en"]
        assert codes <= {warning["code"] for warning in analysed["warnings"]}
        assert "remarks" not in analysed


def test_a_bake_is_told_stopped_and_tried_again(counter):
    one, builds = clerk(counter, counter.people, Role.CURATOR), []

    def begin(bake: Bake) -> Slow:
        builds.append(Slow())
        return builds[-1]

    queue, wanted = BakingQueue(begin), (Bake("chest", "1"), Bake(ROOM, "2", patient=True))
    counter.house.queue = queue
    try:
        event_loop.run(queue.want(wanted))
        assert [bake["state"] for bake in one.told("bakes")] == ["running", "waiting"]
        page = one.get("/office/bakes?lang=en")
        assert "40% cloth &lt;b&gt;" in page.text
        one.send(page, "/office/bakes/chest/stop")
        assert [bake.name for bake in queue.stopped()] == ["chest"]
        event_loop.run(queue.want(wanted))
        assert builds[0].ended
        assert {bake["name"]: bake["state"] for bake in one.told("bakes")} == {
            ROOM: "running",
            "chest": "failed",
        }
        one.told("bakes/chest/again", {})
        queue.stopped()
        event_loop.run(queue.want(wanted))
        assert {bake["name"]: bake["state"] for bake in one.told("bakes")}["chest"] == "running"
        assert one.api("bakes/nothing/stop", {}).status == 404
        page = one.get("/office/bakes")
        assert "展厅灯光" in page.text
        one.send(page, f"/office/bakes/{quote(ROOM)}/stop")
        assert [bake.name for bake in queue.stopped()] == [ROOM]
    finally:
        counter.house.queue = None
