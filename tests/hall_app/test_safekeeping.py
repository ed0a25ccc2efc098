"""A house in one file: all of it comes back, a damaged file is refused whole, nothing is ever overwritten."""

from __future__ import annotations

import contextlib
import json
import re
import stat
import uuid
import zipfile
from contextlib import closing
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from sqlalchemy import create_engine, text

from hall_app.cli import main
from hall_app.house.people import People, PeopleError, Role
from hall_app.house.people.records import Plan
from hall_app.house.safekeeping import ArchiveError, Holdings, back_up, check_archive, restore
from survey import Answer, AnswerError, Store, StoreError, read_questionnaire

ASKED = read_questionnaire(Path(__file__).parents[2] / "assets" / "questionnaires" / "garment.toml")
PASSWORD = "a robe of blue ramie"
SOON = (datetime.now(UTC) + timedelta(days=3)).replace(microsecond=0)
PLAN = Plan("activity", "缂丝", "Tapestry", SOON, SOON + timedelta(hours=1), places=1, party=1)


def answer(code: str = "") -> Answer:
    scores = dict.fromkeys(ASKED.item_ids, 4)
    told = {"id": code or str(uuid.uuid4()), "version": ASKED.version, "language": "zh", "consent": True}
    return Answer.of(ASKED, told | {"scores": scores, "suggestions": {}})


def write_content(folder: Path) -> Path:
    (folder / "exhibits" / "襌衣").mkdir(parents=True)
    (folder / "hall.toml").write_text('title.zh = "展厅"\n', "utf-8")
    (folder / "exhibits" / "襌衣" / "text.zh.md").write_text("素纱。", "utf-8")
    (folder / "exhibits" / "襌衣" / "model.glb").write_bytes(bytes(range(256)) * 5000)
    (folder / "empty.txt").touch()
    return folder


def files_in(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()
    }


@pytest.fixture
def house(database, tmp_path) -> Holdings:
    """One with content, three accounts, an occasion that is full, and two answers."""
    if isinstance(database, str):  # a server that stands elsewhere: what is kept is kept in UTC all the same
        engine = create_engine(database)
        with engine.begin() as connection:
            name = engine.url.database
            connection.execute(text(f"ALTER DATABASE {name} SET timezone TO 'Asia/Shanghai'"))
        engine.dispose()
    with closing(People(database)) as people, closing(Store(database)) as store:
        one, two = (people.accounts.sign_up(f"{name}@example.org", PASSWORD) for name in ("one", "two"))
        admin = people.accounts.make("console", "admin@example.org", name="Anna")
        people.roles.set("console", admin.id, frozenset({Role.ADMINISTRATOR}))
        people.keepsakes.keep(one.id, "gown")
        people.keepsakes.set_keeping(two.id, on=True)
        people.keepsakes.note_look(two.id, "gown")
        (occasion,) = people.occasions.plan(admin.id, PLAN)
        for person in (one, two):
            people.bookings.book(person.id, occasion, 1, person.id)
        people.followups.set(admin.id, "a.culture", "done", "larger letters")
        for code in (str(uuid.uuid4()), str(uuid.uuid4())):
            store.submit(ASKED, answer(code))
        people.answer_codes.keep(two.id, code)
        store.audit.note("export", "two answers")
        store.tokens.make("for the paper")
    return Holdings(write_content(tmp_path / "content"), tmp_path / "data", database, database)


@pytest.fixture(params=["sqlite", pytest.param("postgresql", marks=pytest.mark.slow)])
def elsewhere(tmp_path, request) -> Holdings:
    """Where nothing is yet, in a database of the same kind as the house's and of the other."""
    data = tmp_path / "other" / "data"
    other = data if request.param == "sqlite" else request.getfixturevalue("postgres")()
    return Holdings(tmp_path / "other" / "content", data, other, other)


def told(house: Holdings) -> dict[str, object]:
    """All that is kept, as the house's own doors tell it."""
    with closing(People(house.accounts)) as people, closing(Store(house.answers)) as store:
        persons = people.accounts.all()
        occasions = people.occasions.to_come()
        return {
            "persons": sorted(persons, key=lambda one: one.address),
            "favourites": [people.keepsakes.favourites(one.id) for one in persons],
            "visits": [people.keepsakes.looks(one.id) for one in persons],
            "codes": [people.answer_codes.of(one.id) for one in persons],
            "occasions": occasions,
            "bookings": [people.bookings.for_occasion(one.id) for one in occasions],
            "followups": people.followups.all(),
            "answers": sorted(store.rows(ASKED), key=str),
            "tokens": store.tokens.all(),
            "audit": [entry for entry in store.audit.entries() if entry.action not in ("backup", "restore")],
            "journal": [entry for entry in people.journal.entries() if entry.act != "backup"],
            "content": files_in(house.content),
        }


@pytest.mark.slow
def test_all_of_it_comes_back(house, elsewhere, tmp_path):
    file, before = tmp_path / "all.zip", told(house)
    written = back_up(file, house)
    assert (written.people, written.answers) == (3, 2)
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert check_archive(file) == written == restore(file, elsewhere)
    assert before["tokens"]
    assert told(elsewhere) == before | {"tokens": ()}, "a token that was revoked since must not be good again"
    with closing(People(elsewhere.accounts)) as people, closing(Store(elsewhere.answers)) as store:
        new = people.accounts.sign_up("three@example.org", PASSWORD)  # numbers go on after those taken in
        booked = people.bookings.book(new.id, people.occasions.to_come()[0].id, 1, "key")
        assert booked.place == 2
        assert "restored" in " ".join(e.subject for e in people.journal.entries() if e.act == "backup")
        store.submit(ASKED, answer())
        assert len(store.rows(ASKED)) == 3
        (kept,) = people.answer_codes.of(people.accounts.find(address="two@example.org").id)
        assert store.withdraw(ASKED.id, kept.code), "a code leads to its answers there, too"
        assert len(store.rows(ASKED)) == 2


def test_what_was_revoked_since_is_not_good_again(tmp_path):
    data, file = tmp_path / "data", tmp_path / "all.zip"
    with closing(People(data)) as people, closing(Store(data)) as store:
        person = people.accounts.sign_up("one@example.org", PASSWORD)
        _, token = people.sessions.sign_in("one@example.org", PASSWORD, "", office=False)
        code = people.accounts.code_for("console", person.id)
        secret = store.tokens.make("for the paper")
    back_up(file, Holdings(write_content(tmp_path / "content"), data, data, data))
    other = tmp_path / "other"
    restore(file, Holdings(other / "content", other / "data", other / "data", other / "data"))
    with closing(People(other / "data")) as people:
        assert people.sessions.find(token, office=False) is None
        with pytest.raises(PeopleError):
            people.accounts.use_code(code, "another robe of ramie")
        assert people.sessions.sign_in("one@example.org", PASSWORD, "", office=False)
    with closing(Store(other / "data")) as store, pytest.raises(AnswerError, match="no valid token"):
        store.tokens.admit(secret, ASKED.id)


@pytest.fixture
def small(tmp_path) -> tuple[Path, Holdings]:
    """A backup, and where nothing is yet; files only."""
    data, file, other = tmp_path / "data", tmp_path / "all.zip", tmp_path / "other"
    with closing(People(data)) as people, closing(Store(data)):
        people.accounts.make("console", "one@example.org")
    back_up(file, Holdings(write_content(tmp_path / "content"), data, data, data))
    return file, Holdings(other / "content", other / "data", other / "data", other / "data")


def nothing_came(house: Holdings) -> bool:
    assert isinstance(house.accounts, Path)
    return not house.content.exists() and not (house.accounts / "people.sqlite").exists()


def test_a_damaged_file_is_refused_whole(small):
    file, other = small
    whole = file.read_bytes()
    for place in range(0, len(whole), len(whole) // 40):
        file.write_bytes(whole[:place] + bytes([whole[place] ^ 0x40]) + whole[place + 1 :])
        with contextlib.suppress(ArchiveError):
            check_archive(file)
            continue  # some bytes say nothing: times of files, say
        with pytest.raises(ArchiveError, match="no whole backup"):
            restore(file, other)
        assert nothing_came(other)
    for length in (0, 10, len(whole) // 2, len(whole) - 1):
        file.write_bytes(whole[:length])
        with pytest.raises(ArchiveError, match="no whole backup"):
            restore(file, other)
    assert nothing_came(other)


def rewritten(file: Path, change) -> None:
    """The archive with its members changed, and the manifest as it was or as `change` leaves it."""
    with zipfile.ZipFile(file) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    manifest = json.loads(members.pop("backup.json"))
    change(members, manifest)
    with zipfile.ZipFile(file, "w") as archive:
        for name, data in members.items():
            archive.writestr(name, data)
        archive.writestr("backup.json", json.dumps(manifest))


def moved(to: str):
    def change(members, manifest) -> None:
        members[to] = members.pop("content/hall.toml")
        manifest["files"][to] = manifest["files"].pop("content/hall.toml")

    return change


def altered(members, manifest) -> None:
    members["content/hall.toml"] = b"#" * len(members["content/hall.toml"])


def longer(members, manifest) -> None:
    members["content/empty.txt"] = b" " * 9_000_000


def more(members, manifest) -> None:
    members["content/more.txt"] = b"not listed"


def less(members, manifest) -> None:
    del members["people.sqlite"], manifest["files"]["people.sqlite"]


def later(members, manifest) -> None:
    manifest["format"] = 3


@pytest.mark.parametrize(
    "change",
    [
        *map(
            moved,
            (
                "content/../../evil",
                "/evil",
                "content",
                "evil.txt",
                "content\\..\\evil",
                "content//a",
                "c:/a",
                "drafts/../evil",
                "shelf/..",
                "shelf/a/evil",
                "desk/evil",
            ),
        ),
        altered,
        longer,
        more,
        less,
        later,
    ],
)
def test_a_file_that_somebody_made_up_is_refused(small, change):
    file, other = small
    rewritten(file, change)
    with pytest.raises(ArchiveError, match=r"no whole backup \(.+\) – take another copy"):
        restore(file, other)
    assert nothing_came(other)
    assert not list(file.parent.rglob("*evil*"))


def test_nothing_is_overwritten(small, tmp_path):
    file, other = small
    data = tmp_path / "data"
    here = Holdings(tmp_path / "content", data, data, data)
    kept = file.read_bytes()
    with pytest.raises(ArchiveError, match="exists already"):
        back_up(file, here)
    with pytest.raises(ArchiveError, match="is there already"):
        restore(file, here)
    with pytest.raises(StoreError, match="not empty"):
        restore(file, replace(here, content=other.content))
    assert not other.content.exists()
    assert file.read_bytes() == kept
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []


def test_a_newer_house_is_not_taken_in_by_an_older_program(small, tmp_path):
    file, other = small

    def newer(members, manifest) -> None:
        import sqlite3
        from hashlib import sha256

        copy = tmp_path / "newer.sqlite"
        copy.write_bytes(members["people.sqlite"])
        with closing(sqlite3.connect(copy)) as database:
            database.execute("UPDATE alembic_version SET version_num = '9999'")
            database.commit()
        data = members["people.sqlite"] = copy.read_bytes()
        manifest["files"]["people.sqlite"] = {"size": len(data), "sha256": sha256(data).hexdigest()}

    rewritten(file, newer)
    with pytest.raises(StoreError, match="install the newer version"):
        restore(file, other)
    assert not other.content.exists()


def test_a_link_to_a_folder_is_told_and_not_left_out(tmp_path):
    data = tmp_path / "data"
    with closing(People(data)), closing(Store(data)):
        content = write_content(tmp_path / "content")
    (content / "elsewhere").symlink_to(tmp_path)
    with pytest.raises(ArchiveError, match="elsewhere: a link to a folder"):
        back_up(tmp_path / "all.zip", Holdings(content, data, data, data))
    assert not (tmp_path / "all.zip").exists()


def test_the_two_commands(small, tmp_path, capsys):
    file, other = small
    given = ["--content", str(tmp_path / "content"), "--data", str(tmp_path / "data")]
    second = tmp_path / "second.zip"
    assert main(["backup", str(second), *given]) == 0
    told = (
        r".*second\.zip: 6 files, 1\.\d MB, 1 account, 0 answers, made 2\d{3}-\d\d-\d\d \d\d:\d\d:\d\d UTC\n"
    )
    assert re.fullmatch(told, capsys.readouterr().out)
    assert main(["backup", str(second), *given]) == 1
    assert capsys.readouterr().err.startswith("hall backup: ")
    assert main(["restore", str(second), "--check"]) == 0
    assert capsys.readouterr().out.endswith("; whole\n")
    to = ["--content", str(other.content), "--data", str(other.accounts)]
    assert main(["restore", str(second), *to]) == 0
    assert files_in(other.content) == files_in(tmp_path / "content")
    assert main(["restore", str(second), *to]) == 1
    assert main(["backup", str(tmp_path / "third.zip"), *given[:2], "--data", str(tmp_path / "typo")]) == 1
    assert "no accounts there" in capsys.readouterr().err
