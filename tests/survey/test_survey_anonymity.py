"""Files without withdrawal codes, and k-anonymous files: nobody is alone in what is told beside the scores."""

from __future__ import annotations

import csv
import io
import json
import uuid
import zipfile
from collections import Counter
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pyreadstat
import pytest
from full_matrix import by_day
from hypothesis import given as drawn
from hypothesis import settings
from hypothesis import strategies as st
from openpyxl import load_workbook
from survey_samples import ASSETS, submission

from survey import Answer, read_questionnaire
from survey.cli import main
from survey.export import FORMATS, LEFT_OUT, LEVELS, TooFew, anonymous, hide, pseudonym, put
from survey.store.answers import ABSENT, Columns, Heads

GARMENT = read_questionnaire(ASSETS / "questionnaires" / "garment.toml")
USER = read_questionnaire(ASSETS / "questionnaires" / "platform-user.toml")
BASE = "/api/v1/questionnaires/garment"
START = datetime(2026, 2, 27, 9, 58, 13, tzinfo=UTC)


@pytest.fixture
def researcher(hall):
    return {"authorization": f"Bearer {hall.store.tokens.make('researcher')}"}


def read_sav(path: Path) -> tuple[Any, Any]:
    """pyreadstat names pandas' class by a path that the checker does not know."""
    return pyreadstat.read_sav(path)


def visited(hall, number: int, **changes) -> list[dict]:
    bodies = [submission(hall.garment, exhibit="pibo", **changes) for _ in range(number)]
    for body in bodies:
        assert hall.client.post(hall.url, json=body).status_code == 201
    return bodies


def readable(kind: str, content: bytes, folder: Path) -> str:
    """All that a file tells, as text."""
    if kind == "xlsx":
        with zipfile.ZipFile(io.BytesIO(content)) as book:
            return "\n".join(book.read(name).decode() for name in book.namelist())
    if kind == "sav":
        (folder / "a.sav").write_bytes(content)
        table, meta = read_sav(folder / "a.sav")
        return table.to_csv() + str(meta.notes)
    return content.decode()


@pytest.mark.parametrize("database", ["sqlite"], indirect=True)
@pytest.mark.parametrize(
    "path", by_day(["rows", "export/csv"], ["rows", "suggestions", *(f"export/{kind}" for kind in FORMATS)])
)
def test_no_withdrawal_code_leaves_the_store_and_the_pseudonym_withdraws_nothing(
    hall, researcher, path, tmp_path
):
    [body] = visited(hall, 1, suggestions={"fabric": "soft"})
    reply = hall.client.get(f"{BASE}/{path}", headers=researcher)
    told = readable(path.rpartition("/")[2], reply.content, tmp_path)
    assert body["id"] not in told
    assert body["id"].replace("-", "") not in told
    if path not in ("export/codebook", "export/r"):
        assert pseudonym(body["id"]) in told
    assert hall.client.delete(f"{hall.url}/{pseudonym(body['id'])}").status_code == 422


def test_pseudonyms_are_stable_and_differ():
    ids = [str(uuid.uuid4()) for _ in range(500)]
    assert len({pseudonym(one) for one in ids}) == 500
    assert pseudonym(ids[0]) == pseudonym(ids[0])


def of_visits(visits: list[tuple[str, str, int, bool]], questionnaire=USER) -> tuple[Columns, Heads]:
    """Columns of (language, exhibit, minutes since START, whether the first items were asked)."""
    rng, p = np.random.default_rng(0), len(questionnaire.items)
    scores = rng.integers(0, 6, (len(visits), p)).astype(np.int8)
    for row, (_, _, _, asked) in enumerate(visits):
        if not asked:
            scores[row, :6] = ABSENT
    ids = np.array([str(uuid.uuid4()).encode() for _ in visits], dtype="S36")
    times = [(START + timedelta(minutes=minutes)).replace(tzinfo=None) for _, _, minutes, _ in visits]
    heads = Heads(
        np.array([visit[0] for visit in visits], dtype=np.str_),
        np.array([visit[1] for visit in visits], dtype=np.str_),
        np.array(times, dtype="datetime64[s]"),
    )
    return Columns(questionnaire, ids, scores), heads


def written(
    columns: Columns, heads: Heads, k: int, seed: int = 0
) -> tuple[list[dict[str, str]], dict[str, str]]:
    """The lines of the CSV file, and the level of each column."""
    out = io.BytesIO()
    hidden = hide(columns, heads, k, np.random.default_rng(seed))
    put("csv", anonymous(columns, heads, hidden), out, Path())
    text = out.getvalue().decode("utf-8-sig")
    return list(csv.DictReader(io.StringIO(text, newline=""))), hidden.anonymity.levels


def known_of(line: dict[str, str]) -> tuple:
    """What stands in a line beside points and gaps: who knows when somebody came knows what was asked then."""
    told = {name: line[name] for name in ("language", "exhibit", "received") if name in line}
    return (*told.items(), *(item for item in USER.item_ids if line.get(item) == "."))


def fits(line: dict[str, str], visit: tuple[str, str, int, bool]) -> bool:
    """Whether a line may be the visit of somebody whose language, exhibit and minute are known."""
    language, exhibit, minutes, asked = visit
    when = START + timedelta(minutes=minutes)
    year, week, _ = when.isocalendar()
    texts = {f"{when:%Y-%m-%dT%H}", f"{when:%Y-%m-%d}", f"{year}-W{week:02}", f"{when:%Y-%m}"}
    gaps = {item for item in USER.item_ids if line.get(item) == "."}
    return (
        line.get("language", language) == language
        and line.get("exhibit", exhibit) == exhibit
        and line.get("received", f"{when:%Y-%m}") in texts
        and gaps <= (set() if asked else set(USER.item_ids[:6]))
        and (asked or len(gaps) == 6 or USER.item_ids[0] not in line)
    )


VISITS = st.lists(
    st.tuples(
        st.sampled_from(["zh", "en"]),
        st.sampled_from(["", "pibo", "mirror"]),
        st.integers(0, 200_000),
        st.booleans(),
    ),
    min_size=2,
    max_size=120,
)


@settings(max_examples=80, deadline=None)
@drawn(visits=VISITS, k=st.integers(2, 12), crowd=st.booleans())
def test_every_combination_of_what_is_told_stands_in_at_least_k_rows(visits, k, crowd):
    if crowd:  # many at a few moments, so that little need be made coarse
        visits = [(a, b, minutes % 3 * 40_000, c) for a, b, minutes, c in visits] * 3
    columns, heads = of_visits(visits)
    if len(visits) < k:
        with pytest.raises(TooFew):
            hide(columns, heads, k, np.random.default_rng(0))
        return
    lines, levels = written(columns, heads, k)
    assert min(Counter(map(known_of, lines)).values()) >= k
    assert 0 <= len(visits) - len(lines) <= len(visits) // 100
    # The attacker knows language, exhibit and minute of one visitor whose answer is in the file.
    for visit in set(visits):
        candidates = sum(fits(line, visit) for line in lines)
        assert candidates == 0 or candidates >= k, (visit, levels)
        if len(lines) == len(visits):
            assert candidates >= k


def test_what_many_share_stays_as_fine_as_an_hour_and_no_finer():
    visits = [("zh", "pibo", minute, True) for minute in (3, 4, 5, 6)] * 5
    lines, levels = written(*of_visits(visits), k=5)
    assert levels == {"received": "hour", "exhibit": "kept", "language": "kept", "asked": "kept"}
    assert {line["received"] for line in lines} == {"2026-02-27T10"}


@pytest.mark.parametrize(
    ("apart", "level", "told"),
    [
        (60, "day", "2026-02-27"),
        (24 * 60, "week", "2026-W09"),
        (8 * 24 * 60 // 4, "month", None),
        (60 * 24 * 60, LEFT_OUT, None),
    ],
)
def test_times_are_made_coarse_step_by_step(apart, level, told):
    visits = [("zh", "pibo", at * apart, True) for at in range(3)] * 2
    if level == "month":  # three days of March, in two weeks
        visits = [("zh", "pibo", (2 + at * 4) * 24 * 60, True) for at in range(3)] * 2
    lines, levels = written(*of_visits(visits), k=6)
    assert levels["received"] == level
    assert levels["exhibit"] == levels["language"] == "kept"
    if told is not None:
        assert {line["received"] for line in lines} == {told}
    if level == LEFT_OUT:
        assert "received" not in lines[0]


def test_one_in_a_hundred_is_suppressed_before_a_column_is_left_out_and_the_file_says_so():
    visits = [("zh", "pibo", minute, True) for minute in range(200)] + [("en", "mirror", 150_000, True)]
    lines, levels = written(*of_visits(visits), k=5)
    assert len(lines) == 200
    assert LEFT_OUT not in levels.values()
    assert "suppressed: 1 of 201 answers" in lines[0]["_anonymity"]
    assert {line["language"] for line in lines} == {"zh"}


def test_items_that_were_asked_at_times_only_are_left_out_where_they_would_tell_who_came_then():
    visits = [("zh", "pibo", 0, True)] * 30 + [("zh", "pibo", 0, False)] * 3
    lines, levels = written(*of_visits(visits), k=5)
    assert levels["asked"] == LEFT_OUT
    assert not set(USER.item_ids[:6]) & set(lines[0])
    assert set(USER.item_ids[6:]) <= set(lines[0])


def test_rows_are_shuffled_and_keep_their_scores_together():
    visits = [("zh", "pibo", minute, True) for minute in range(40)]
    columns, heads = of_visits(visits)
    columns.scores[:, 0] = 1
    columns.scores[np.arange(40), 1 + np.arange(40) % 5] = 3
    rows = [tuple(line[item] for item in USER.item_ids) for line in written(columns, heads, 5)[0]]
    as_received = [tuple(str(point) if point else "" for point in row) for row in columns.scores.tolist()]
    assert rows != as_received
    assert sorted(rows) == sorted(as_received)
    again = [tuple(line[item] for item in USER.item_ids) for line in written(columns, heads, 5, seed=1)[0]]
    assert again != rows


def test_there_is_a_level_between_everything_and_nothing_for_times_alone():
    assert all(levels[-1] == LEFT_OUT for levels in LEVELS.values())


@pytest.mark.parametrize("kind", by_day(["sav"], FORMATS))
@pytest.mark.parametrize("database", ["sqlite"], indirect=True)
def test_over_http_every_format_tells_k_and_neither_code_nor_pseudonym_nor_text(
    hall, researcher, kind, tmp_path
):
    bodies = visited(hall, 6, suggestions={"fabric": "unmistakable"})
    reply = hall.client.get(f"{BASE}/export/{kind}?k=5", headers=researcher)
    assert reply.status_code == 200
    told = reply.headers["survey-anonymity"]
    assert told.startswith("k = 5; ")
    assert "received: " in told
    assert "suppressed: 0 of 6 answers" in told
    assert f'filename="garment-v{hall.garment.version}-k5' in reply.headers["content-disposition"]
    text = readable(kind, reply.content, tmp_path)
    assert "unmistakable" not in text
    for body in bodies:
        assert body["id"] not in text
        assert pseudonym(body["id"]) not in text
    if kind == "json":
        assert json.loads(text)["anonymity"]["k"] == 5
        assert set(json.loads(text)["answers"][0]) == {"version", "language", "exhibit", "received", "scores"}
    elif kind == "xlsx":
        book = load_workbook(io.BytesIO(reply.content))
        assert any("k = 5" in str(cell.value) for cell in book["codebook"]["D"])
    elif kind == "sav":
        assert "k = 5" in " ".join(pyreadstat.read_sav(tmp_path / "a.sav")[1].notes)
    elif kind != "r":
        assert told in text


def test_too_few_answers_are_refused_and_so_is_a_k_that_hides_nobody(hall, researcher):
    visited(hall, 4)
    refused = hall.client.get(f"{BASE}/export/csv?k=5", headers=researcher)
    assert (refused.status_code, refused.json()["field"]) == (422, "k")
    assert "4 answers cannot be hidden among 5" in refused.json()["problem"]
    for k in ("1", "0", "1001", "many", "２"):
        refused = hall.client.get(f"{BASE}/export/csv?k={k}", headers=researcher)
        assert (refused.status_code, refused.json()["field"]) == (422, "k")


@pytest.mark.parametrize("database", ["sqlite"], indirect=True)
def test_the_command_makes_the_same_and_its_file_can_be_analysed(hall, tmp_path, capsys):
    for row in np.random.default_rng(3).integers(1, 6, (30, len(hall.garment.items))):
        scores = dict(zip(hall.garment.item_ids, map(int, row), strict=True))
        hall.store.submit(hall.garment, Answer.of(hall.garment, submission(hall.garment, scores=scores)))
    where = ["--questionnaire", "garment", "--content", str(ASSETS)]
    out = tmp_path / "a.csv"
    command = ["export", *where, "--data", str(hall.data), "--out", str(out)]
    assert main([*command, "--k", "5"]) == 0
    said = capsys.readouterr()
    assert "30 answers" in said.out
    assert "k = 5; received: hour" in said.err
    means = []
    for source in ([str(out)], ["--data", str(hall.data)]):
        assert main(["analyse", *source, *where, "--json"]) == 0
        means.append(json.loads(capsys.readouterr().out)["correlation"])
    np.testing.assert_allclose(means[0]["values"], means[1]["values"], atol=1e-12)
    assert main([*command, "--k", "31"]) == 1
    assert "30 answers cannot be hidden among 31" in capsys.readouterr().err
    for k in ("1", "1001", "２", "२"):  # ASCII's digits alone
        with pytest.raises(SystemExit) as ended:
            main([*command, "--k", k])
        assert ended.value.code == 2
