"""The doors of the store: who may read its files, what a token opens and how long, what is written down, purging."""

from __future__ import annotations

import os
import pty
import select
import sqlite3
import stat
import subprocess
import sys
from contextlib import closing
from datetime import UTC, date, datetime, timedelta
from pathlib import Path

import pytest
from sqlalchemy import create_engine, text
from survey_samples import ASSETS, looked_up, submission

from survey import Answer, Store, read_questionnaire
from survey.cli import main
from survey.questionnaire import Questionnaire
from survey.store import migrations
from survey.store.database import HEAD

GARMENT = read_questionnaire(ASSETS / "questionnaires" / "garment.toml")
BASE = "/api/v1/questionnaires"
NIL, MAX = "00000000-0000-0000-0000-000000000000", "ffffffff-ffff-ffff-ffff-ffffffffffff"


@pytest.fixture
def place(database) -> list[str]:
    """The arguments by which a command finds the store."""
    return ["--db", database] if isinstance(database, str) else ["--data", str(database)]


@pytest.fixture(params=[0o000, 0o022, 0o777])
def umask(request):
    before = os.umask(request.param)
    yield request.param
    os.umask(before)


def rights(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def an_answer(asked: Questionnaire = GARMENT, **changes) -> Answer:
    return Answer.of(asked, submission(asked, **changes))


def filled(where: Path | str, asked: Questionnaire = GARMENT, number: int = 3) -> list[Answer]:
    answers = [an_answer(asked) for _ in range(number)]
    with closing(Store(where)) as store:
        for answer in answers:
            store.submit(asked, answer)
    return answers


def behind(where: Path | str, statement: str, **values) -> None:
    """Change the database behind the product's back."""
    if isinstance(where, Path):
        url = f"sqlite:///{where / 'survey.sqlite'}"
        values = {
            key: f"{at:%Y-%m-%d %H:%M:%S}.000000" if isinstance(at, datetime) else at
            for key, at in values.items()
        }
    else:
        url = where
    engine = create_engine(url)
    with engine.begin() as connection:
        connection.execute(text(statement), values)
    engine.dispose()


def ended(capsys, status: int, *arguments) -> str:
    """What a command that fails says: one line with a remedy."""
    assert main(list(map(str, arguments))) == status
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert " – " in err
    return err


# ---- files ---------------------------------------------------------------------------------------------------


def test_what_is_made_is_for_its_owner_alone_whatever_the_umask(tmp_path, umask):
    folder = tmp_path / "data"
    with closing(Store(folder)) as store:
        store.submit(GARMENT, an_answer())
        files = {path.name: rights(path) for path in folder.iterdir()}
        assert files == dict.fromkeys(("survey.sqlite", "survey.sqlite-wal", "survey.sqlite-shm"), 0o600)
        store.copy_to(tmp_path / "copy.sqlite")
    assert (rights(folder), rights(tmp_path / "copy.sqlite")) == (0o700, 0o600)


def test_a_backup_is_for_its_owner_alone_while_it_is_written(tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr(
        "survey.store.database.backup._check", lambda part, schema: seen.append(rights(part)) or 0
    )
    with closing(Store(tmp_path / "data")) as store:
        store.copy_to(tmp_path / "copy.sqlite")
    assert seen == [0o600]


def test_files_that_an_earlier_release_left_open_are_closed_and_that_is_told(tmp_path, caplog):
    folder = tmp_path / "data"
    filled(folder)
    folder.chmod(0o755)
    (folder / "survey.sqlite").chmod(0o644)
    (folder / "survey.sqlite-wal").touch(0o644)
    with closing(Store(folder)):
        assert rights(folder) == 0o700
        assert {rights(path) for path in folder.iterdir()} == {0o600}
    told = "\n".join(record.getMessage() for record in caplog.records)
    assert f"{folder}: was open to others (0755), now to its owner alone (0700)" in told
    assert "survey.sqlite: was open to others (0644), now to its owner alone (0600)" in told
    caplog.clear()
    with closing(Store(folder)):
        assert caplog.records == []


@pytest.mark.parametrize("kind", ["csv", "xlsx", "json"])
def test_an_exported_file_is_for_its_owner_alone_and_one_that_is_there_keeps_its_rights(
    tmp_path, umask, kind
):
    filled(tmp_path / "data")
    fresh, there = tmp_path / f"fresh.{kind}", tmp_path / f"there.{kind}"
    there.touch()
    there.chmod(0o640)
    for file in (fresh, there):
        where = ["--data", str(tmp_path / "data"), "--content", str(ASSETS)]
        assert main(["export", "--questionnaire", "garment", "--out", str(file), *where]) == 0
        assert file.stat().st_size > 100
    assert (rights(fresh), rights(there)) == (0o600, 0o640)


def test_a_link_given_as_out_stays_a_link(tmp_path):
    filled(tmp_path / "data")
    (tmp_path / "real").mkdir()
    link = tmp_path / "link.csv"
    link.symlink_to(tmp_path / "real" / "a.csv")
    where = ["--data", str(tmp_path / "data"), "--content", str(ASSETS)]
    for _ in range(2):
        assert main(["export", "--questionnaire", "garment", "--out", str(link), *where]) == 0
        assert link.is_symlink()
        assert [file.name for file in (tmp_path / "real").iterdir()] == ["a.csv"]


@pytest.mark.parametrize("beside", ["thumbnails", None])
def test_a_folder_that_others_use_keeps_its_rights(tmp_path, beside):
    folder = tmp_path / "data"
    folder.mkdir()
    folder.chmod(0o775)
    if beside:
        (folder / beside).mkdir()
    with closing(Store(folder)) as store:
        store.submit(GARMENT, an_answer())
        assert rights(folder) == 0o775
        assert rights(folder / "survey.sqlite") == 0o600
    if beside:
        with closing(Store(folder)):
            assert rights(folder) == 0o775


def test_a_backup_put_in_its_place_is_closed_too(tmp_path):
    folder = tmp_path / "data"
    with closing(Store(folder)) as store:
        store.submit(GARMENT, an_answer())
        store.copy_to(tmp_path / "copy.sqlite")
        for file in folder.iterdir():
            file.unlink()
        (folder / "survey.sqlite").write_bytes((tmp_path / "copy.sqlite").read_bytes())
        (folder / "survey.sqlite").chmod(0o644)
        store.submit(GARMENT, an_answer())
        assert rights(folder / "survey.sqlite") == 0o600


# ---- tokens --------------------------------------------------------------------------------------------------


def asked_with(hall, token: str, path: str = "garment/rows"):
    return hall.client.get(f"{BASE}/{path}", headers={"authorization": f"Bearer {token}"})


def made(capsys, *arguments) -> str:
    assert main(["token", *map(str, arguments), "--content", str(ASSETS)]) == 0
    return capsys.readouterr().out.strip()


def listed(capsys, place) -> list[str]:
    assert main(["token", "--list", *place]) == 0
    return capsys.readouterr().out.splitlines()


def test_a_token_ends_on_its_day_and_says_so(hall, place, capsys):
    token = made(capsys, "--label", "Dr Lin", "--days", 1, *place)
    today = datetime.now(UTC).date()
    assert asked_with(hall, token).status_code == 200
    (line,) = listed(capsys, place)
    assert f"good until {today + timedelta(days=1)}" in line
    behind(hall.data, "UPDATE token SET expires = :day", day=str(today))
    assert asked_with(hall, token).status_code == 200  # the last day is one of its days
    behind(hall.data, "UPDATE token SET expires = :day", day=str(today - timedelta(days=1)))
    refused = asked_with(hall, token)
    assert refused.status_code == 401
    assert refused.headers["www-authenticate"] == "Bearer"
    assert refused.json()["problem"] == f"the token expired on {today - timedelta(days=1)}"
    (line,) = listed(capsys, place)
    assert f"expired on {today - timedelta(days=1)}" in line


@pytest.mark.parametrize(("given", "days"), [((), 90), (("--days", 7), 7), (("--never",), None)])
def test_how_long_a_token_is_good(tmp_path, capsys, given, days):
    made(capsys, *given, "--data", tmp_path)
    (line,) = listed(capsys, ["--data", str(tmp_path)])
    today = datetime.now(UTC).date()
    assert ("never expires" if days is None else f"good until {today + timedelta(days=days)}") in line


def test_a_token_for_one_questionnaire_opens_no_other(hall, place, capsys):
    token = made(capsys, "--questionnaire", "garment", *place)
    assert asked_with(hall, token).status_code == 200
    for path in ("platform-user/rows", "platform-user/export/csv", "nonsense/rows", "nonsense/analysis"):
        refused = asked_with(hall, token, path)
        assert refused.status_code == 403
        assert refused.json()["field"] == "authorization"
        assert refused.json()["problem"] == "the token opens garment only"
        assert "www-authenticate" not in refused.headers
    (line,) = listed(capsys, place)
    assert "garment only" in line


def test_a_token_for_a_questionnaire_that_there_is_not_is_not_made(tmp_path, capsys):
    here = ["--content", ASSETS, "--data", tmp_path / "data"]
    said = ended(capsys, 1, "token", "--questionnaire", "garmet", *here)
    assert "garmet: no such questionnaire" in said
    assert "garment" in said
    assert not (tmp_path / "data").exists()


@pytest.mark.nightly
def test_the_day_of_the_last_use_is_kept_and_costs_one_write_a_day(hall, place, capsys):
    token = made(capsys, *place)
    assert "never used" in listed(capsys, place)[0]
    today = datetime.now(UTC).date()
    assert asked_with(hall, token).status_code == 200
    assert f"last used {today}" in listed(capsys, place)[0]
    behind(hall.data, "UPDATE token SET used = :day", day="2020-02-02")
    assert "last used 2020-02-02" in listed(capsys, place)[0]
    for _ in range(3):
        assert asked_with(hall, token, "garment/analysis").status_code == 422  # no answers: it was let in
    assert looked_up(hall.data, "SELECT used FROM token") == [(date_as_stored(hall.data, today),)]


def date_as_stored(where: Path | str, day: date) -> date | str:
    return day if isinstance(where, str) else str(day)


WRONG_TOKENS = [
    ["--days", "0"],
    ["--days", "4000"],
    ["--days", "x"],
    ["--days", "5", "--never"],
    ["--list", "--never"],
    ["--revoke", "1", "--days", "5"],
    ["--list", "--questionnaire", "garment"],
]


@pytest.mark.parametrize("arguments", WRONG_TOKENS)
def test_wrong_arguments_of_token_end_with_2(arguments, tmp_path, capsys):
    with pytest.raises(SystemExit) as stopped:
        main(["token", *arguments, "--data", str(tmp_path / "data")])
    assert stopped.value.code == 2
    assert not (tmp_path / "data").exists()


def test_tokens_of_an_earlier_release_go_on_and_are_told_apart(tmp_path, capsys):
    with closing(sqlite3.connect(tmp_path / "survey.sqlite")) as database:
        database.executescript((Path(__file__).parent / "first_store.sql").read_text("utf-8"))
    (line,) = listed(capsys, ["--data", str(tmp_path)])
    assert "never expires\tall questionnaires\tnever used" in line


# ---- the audit -----------------------------------------------------------------------------------------------


def audited(capsys, place) -> list[list[str]]:
    """[when, action, subject, …] of each entry."""
    capsys.readouterr()
    assert main(["audit", *place]) == 0
    return [[cell.strip() for cell in line.split("\t")] for line in capsys.readouterr().out.splitlines()]


def test_exports_tokens_and_withdrawals_are_in_the_audit(hall, place, capsys):
    bodies = [submission(GARMENT, suggestions={"form": "unmistakable"}) for _ in range(4)]
    for body in bodies:
        assert hall.client.post(hall.url, json=body).status_code == 201
    token = made(capsys, "--label", "Dr Lin", *place)
    for _ in range(3):
        assert asked_with(hall, token).status_code == 200
        assert asked_with(hall, token, "garment/export/csv").status_code == 200
    assert asked_with(hall, token, f"garment/export/xlsx?version={GARMENT.version}").status_code == 200
    assert asked_with(hall, token, "garment/export/codebook").status_code == 200
    assert asked_with(hall, token + "x", "garment/export/csv").status_code == 401
    for body in bodies[:3]:
        assert hall.client.delete(f"{hall.url}/{body['id']}").status_code == 204
        assert hall.client.delete(f"{hall.url}/{body['id']}").status_code == 204  # again: no second one
    assert main(["token", "--revoke", "1", *place]) == 0
    entries = audited(capsys, place)
    told, version = (
        [entry[1:] for entry in entries if entry[1] != "withdraw"],
        f"garment version {GARMENT.version}",
    )
    assert told == [
        ["token made", "1 Dr Lin"],
        ["read", f"{version} rows, token 1"],
        *[["export", f"{version} csv, token 1"]] * 3,
        ["export", f"{version} xlsx, token 1"],
        ["token revoked", "1 Dr Lin"],
    ]
    today = f"{datetime.now(UTC):%Y-%m-%d}"
    withdrawn = [entry for entry in entries if entry[1] == "withdraw"]
    assert withdrawn == [[today, "withdraw", "garment", "3 answers"]]  # the day alone
    whole = str(looked_up(hall.data, "SELECT * FROM audit"))
    for body in bodies:
        assert body["id"] not in whole
    assert token not in whole
    assert "unmistakable" not in whole


def test_what_a_command_did_is_in_the_audit(database, place, capsys, tmp_path):
    asked = kept_until("2001-01-01")
    filled(database, asked)
    assert main(["freeze", "garment", *place]) == 0
    assert main(["backup", str(tmp_path / "copy.sqlite"), *place]) == 0
    assert main(["export", "--questionnaire", "garment", "--content", str(ASSETS), *place]) == 0
    assert main(["purge", "--yes", *place]) == 0
    assert main(["purge", *place]) == 0
    assert [entry[1:] for entry in audited(capsys, place)] == [
        ["freeze", "garment", "3 answers"],
        ["backup", "copy.sqlite", "3 answers"],
        ["export", f"garment version {GARMENT.version} csv, command line"],
        ["purge", f"garment version {GARMENT.version}", "3 answers"],
        ["purge", "nothing to erase", "0 answers"],
    ]


@pytest.mark.nightly
def test_the_audit_tells_of_what_was_handed_out_and_of_nothing_else(hall, place, capsys, tmp_path):
    for _ in range(5):
        assert hall.client.post(hall.url, json=submission(GARMENT)).status_code == 201
    token = made(capsys, *place)
    refused = ["csv?foo=1", "csv?k=50", "xlsx?version=9", "sav?k=1", "nonsense"]
    for path in (
        *(f"garment/export/{one}" for one in refused),
        "nonsense/export/csv",
        "garment/rows?version=9",
    ):
        assert asked_with(hall, token, path).status_code in (404, 422), path
    command = ["export", "--questionnaire", "garment", "--content", str(ASSETS), *place]
    ended(capsys, 1, *command, "--k", "50")
    ended(capsys, 1, *command, "--version", "9")
    ended(capsys, 1, *command, "--out", tmp_path / "absent" / "a.csv")
    ended(capsys, 1, *command, "--out", tmp_path)
    assert [entry[1] for entry in audited(capsys, place)] == ["token made"]
    assert asked_with(hall, token, "garment/export/csv?k=5").status_code == 200
    assert asked_with(hall, token, "garment/export/csv").status_code == 200
    assert main([*command, "--k", "5"]) == 0
    version = f"garment version {GARMENT.version}"
    assert [entry[1:] for entry in audited(capsys, place)][1:] == [
        ["export", f"{version} csv k=5, token 1"],
        ["export", f"{version} csv, token 1"],
        ["export", f"{version} csv k=5, command line"],
    ]


def test_an_export_that_cannot_be_written_down_is_not_handed_out(hall, place, capsys, tmp_path):
    filled(hall.data)
    token, out = made(capsys, *place), tmp_path / "a.csv"
    out.write_text("earlier")
    behind(hall.data, "ALTER TABLE audit RENAME TO lost")
    refused = asked_with(hall, token, "garment/export/csv")
    assert refused.status_code == 503
    assert "submission" not in refused.text
    before = set(tmp_path.iterdir())
    command = ["export", "--questionnaire", "garment", "--content", str(ASSETS), *place]
    ended(capsys, 1, *command, "--out", out)
    assert out.read_text() == "earlier"
    assert set(tmp_path.iterdir()) == before
    ended(capsys, 1, *command)
    behind(hall.data, "ALTER TABLE lost RENAME TO audit")
    assert asked_with(hall, token, "garment/export/csv").status_code == 200


def test_a_codebook_is_had_where_no_score_can_be_read(hall, place, capsys):
    filled(hall.data)
    token = made(capsys, *place)
    whole = asked_with(hall, token, "garment/export/codebook")
    behind(hall.data, "ALTER TABLE answer RENAME TO lost")
    assert asked_with(hall, token, "garment/export/csv").status_code == 503
    assert asked_with(hall, token, "garment/export/codebook").content == whole.content
    command = ["export", "--questionnaire", "garment", "--content", str(ASSETS), "--format", "codebook"]
    assert main([*command, *place]) == 0
    behind(hall.data, "ALTER TABLE lost RENAME TO answer")


def test_without_a_store_there_is_no_audit(tmp_path, capsys):
    assert "no such store" in ended(capsys, 1, "audit", "--data", tmp_path / "typo")
    assert not (tmp_path / "typo").exists()


# ---- ids -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("key", [NIL, MAX, MAX.upper()])
def test_an_id_that_everybody_knows_is_refused(hall, key):
    refused = hall.client.post(hall.url, json=submission(GARMENT, id=key))
    assert refused.status_code == 422
    assert refused.json()["field"] == "id"
    assert "all zeros or all ones" in refused.json()["problem"]
    assert "make a fresh one" in refused.json()["remedy"]
    assert hall.client.delete(f"{hall.url}/{key}").status_code == 422
    assert looked_up(hall.data, "SELECT count(*) FROM submission") == [(0,)]


@pytest.mark.parametrize("key", [NIL, MAX, MAX.upper()])
def test_the_published_schema_refuses_it_too(hall, key):
    import jsonschema_rs  # schemathesis brings it along

    found = hall.client.get(f"{BASE}/garment/submission.schema.json").json()
    whole = hall.client.get("/openapi.json").json()
    post = whole["paths"][BASE + "/{key}/submissions"]["post"]
    general = post["requestBody"]["content"]["application/json"]["schema"]
    for described in (found, general):
        check = jsonschema_rs.validator_for(described)
        assert check.is_valid(submission(GARMENT))
        assert not check.is_valid(submission(GARMENT, id=key))


# ---- purging -------------------------------------------------------------------------------------------------


def kept_until(day: str) -> Questionnaire:
    return Questionnaire.model_validate(GARMENT.document() | {"retain_until": day})


def standing(where: Path | str) -> int:
    return looked_up(where, "SELECT count(*) FROM submission WHERE withdrawn IS NULL")[0][0]


def test_purge_shows_what_it_would_erase_and_without_a_terminal_wants_yes(database, place, capsys):
    with closing(Store(database)):
        assert main(["purge", *place]) == 0  # of nothing yet, so that the clock is known
    filled(database, kept_until("2001-01-01"), 5)
    early, late = datetime(2000, 3, 4, tzinfo=UTC), datetime(2000, 11, 30, tzinfo=UTC)
    behind(database, "UPDATE submission SET received = :at", at=early)
    ids = looked_up(database, "SELECT id FROM submission")
    behind(database, "UPDATE submission SET received = :at WHERE id = :id", at=late, id=ids[0][0])
    capsys.readouterr()
    assert main(["purge", *place]) == 1
    out, err = capsys.readouterr()
    assert out.splitlines() == [
        f"garment version {GARMENT.version}: 5 answers, received 2000-03-04 to 2000-11-30, kept until 2001-01-01"
    ]
    assert err == "survey: 5 answers are to be erased and nobody can be asked – add --yes\n"
    assert standing(database) == 5
    assert main(["purge", "--yes", *place]) == 0
    assert "5 answers erased" in capsys.readouterr().out
    assert standing(database) == 0


@pytest.mark.parametrize(("typed", "status", "left"), [("y", 0, 0), ("n", 1, 3), ("", 1, 3), ("\x04", 1, 3)])
def test_on_a_terminal_purge_asks(tmp_path, typed, status, left):
    filled(tmp_path, kept_until("2001-01-01"))
    told, ours = pty.openpty()
    command = [sys.executable, "-m", "survey.cli", "purge", "--data", str(tmp_path)]
    with subprocess.Popen(command, stdin=ours, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        os.close(ours)
        assert process.stdout is not None
        said = b""
        while b"[y/N]" not in said:
            assert select.select([process.stdout], [], [], 60)[0], said
            more = os.read(process.stdout.fileno(), 4096)
            assert more, said
            said += more
        os.write(told, (typed if typed == "\x04" else typed + "\n").encode())
        rest, err = process.communicate(timeout=60)
    os.close(told)
    assert process.returncode == status, err
    assert ("nothing was erased" in (said + rest).decode()) == (status == 1)
    assert standing(tmp_path) == left


@pytest.mark.parametrize(
    ("days", "told"), [(-70, "days after the last purge"), (30, "before the last purge on"), (-59, None)]
)
def test_a_clock_that_jumped_since_the_last_purge_is_asked_about(database, place, capsys, days, told):
    filled(database, kept_until("2001-01-01"))
    assert main(["purge", "--yes", *place]) == 0
    filled(database, kept_until("2001-01-01"))
    last = datetime.now(UTC).replace(microsecond=0) + timedelta(days=days)
    behind(database, "UPDATE audit SET at = :at WHERE action = 'purge'", at=last)
    capsys.readouterr()
    if told is None:
        assert main(["purge", "--yes", *place]) == 0
        assert standing(database) == 0
        return
    for arguments in ([], ["--yes"]):
        said = ended(capsys, 1, "purge", *arguments, *place)
        assert told in said
        assert f"{last:%Y-%m-%d}" in said
        assert "survey purge --yes --clock-is-right" in said
        assert standing(database) == 3
    assert main(["purge", "--yes", "--clock-is-right", *place]) == 0
    assert standing(database) == 0
    assert main(["purge", *place]) == 0  # and that was the last purge now


def test_a_purge_that_finds_nothing_is_remembered(database, place, capsys):
    filled(database, kept_until("9000-01-01"))
    assert main(["purge", *place]) == 0
    assert "nothing to erase" in capsys.readouterr().out
    long_ago = datetime.now(UTC).replace(microsecond=0) - timedelta(days=61)
    behind(database, "UPDATE audit SET at = :at", at=long_ago)
    assert "61 days after the last purge" in ended(capsys, 1, "purge", *place)


def test_a_first_purge_measures_the_clock_by_the_last_answer(database, place, capsys):
    filled(database, kept_until("2001-01-01"))
    ahead = datetime.now(UTC).replace(microsecond=0) + timedelta(days=2)
    behind(database, "UPDATE submission SET received = :at", at=ahead)
    assert "before the last answer on" in ended(capsys, 1, "purge", "--yes", *place)
    assert standing(database) == 3


def test_a_first_purge_by_a_clock_that_runs_ahead_of_the_last_answer_is_asked_about(database, place, capsys):
    filled(database, kept_until("2001-01-01"))
    last = datetime.now(UTC).replace(microsecond=0) - timedelta(days=61)
    behind(database, "UPDATE submission SET received = :at", at=last)
    for arguments in ([], ["--yes"]):
        said = ended(capsys, 1, "purge", *arguments, *place)
        assert f"61 days after the last answer on {last:%Y-%m-%d}, and nothing was purged yet" in said
        assert "survey purge --yes --clock-is-right" in said
        assert standing(database) == 3
    assert main(["purge", "--yes", "--clock-is-right", *place]) == 0
    assert standing(database) == 0
    assert main(["purge", "--yes", *place]) == 0  # from now on the last purge tells the time


def test_a_first_purge_within_sixty_days_of_the_last_answer_asks_for_no_more(database, place, capsys):
    filled(database, kept_until("2001-01-01"))
    last = datetime.now(UTC).replace(microsecond=0) - timedelta(days=59)
    behind(database, "UPDATE submission SET received = :at", at=last)
    assert main(["purge", "--yes", *place]) == 0
    assert standing(database) == 0


def test_the_clock_s_word_goes_with_yes(tmp_path, capsys):
    filled(tmp_path)
    with pytest.raises(SystemExit) as stopped:
        main(["purge", "--clock-is-right", "--data", str(tmp_path)])
    assert stopped.value.code == 2


def test_the_newest_step_is_the_head():
    files = sorted((Path(migrations.__file__).parent / "versions").glob("0*.py"))
    assert files[-1].name.startswith(HEAD)
