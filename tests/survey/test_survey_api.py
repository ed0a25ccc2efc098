"""The API through its door: what is taken, what is refused and why, who may read what."""

from __future__ import annotations

import csv
import io
import json
import sqlite3
import uuid
from concurrent.futures import Future

import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient
from survey_samples import looked_up, submission

import survey
from survey.errors import StoreError
from survey.export import pseudonym
from survey.questionnaire import TEXT_LIMIT
from survey.web.api import Limit

BASE = "/api/v1/questionnaires"


def count(hall) -> int:
    return looked_up(hall.data, "SELECT count(*) FROM submission")[0][0]


def test_an_answer_is_committed_before_it_is_acknowledged(hall):
    body = submission(hall.garment, exhibit="pibo", suggestions={"fabric": "  更亮一些\r\n谢谢 "})
    reply = hall.client.post(hall.url, json=body)
    assert reply.status_code == 201
    assert reply.json() == {"id": body["id"], "questionnaire": "garment", "version": hall.garment.version}
    (row,) = hall.store.rows(hall.garment)
    assert row.answer.id == body["id"]
    assert dict(row.answer.scores) == body["scores"]
    assert row.answer.suggestions == (("fabric", "更亮一些\n谢谢"),)
    assert row.answer.exhibit == "pibo"


def test_a_replay_gives_the_same_answer_and_one_row(hall):
    body = submission(hall.garment)
    first = hall.client.post(hall.url, json=body)
    shuffled = dict(reversed(body.items())) | {"id": body["id"].upper()}
    again = hall.client.post(
        hall.url, content=json.dumps(shuffled), headers={"content-type": "application/json"}
    )
    assert (first.status_code, again.status_code) == (201, 200)
    assert first.json() == again.json()
    assert count(hall) == 1


def test_the_same_id_with_another_body_is_refused_and_changes_nothing(hall):
    body = submission(hall.garment)
    hall.client.post(hall.url, json=body)
    other = body | {"language": "en"}
    refused = hall.client.post(hall.url, json=other)
    assert refused.status_code == 409
    assert refused.json()["field"] == "id"
    user = hall.mounted.questionnaires["platform-user"]
    elsewhere = hall.client.post(f"{BASE}/platform-user/submissions", json=submission(user, id=body["id"]))
    assert elsewhere.status_code == 409
    assert hall.store.rows(hall.garment)[0].answer.language == "zh"
    assert count(hall) == 1


WRONG = {
    "unknown field": ({"colour": "red"}, "colour", "unknown field"),
    "no uuid": ({"id": "42"}, "id", "not a UUID"),
    "empty id": ({"id": ""}, "id", "not a UUID"),
    "uuid in braces": ({"id": "{0b2c7e7e-8f0e-4e1c-9d0a-3f5b6a7c8d9e}"}, "id", "not a UUID"),
    "number as uuid": ({"id": 42}, "id", "not a UUID"),
    "old version": ({"version": 7}, "version", "not the current one"),
    "version true": ({"version": True}, "version", "not the current one"),
    "version 1.5": ({"version": 1.5}, "version", "not the current one"),
    "version text": ({"version": "1"}, "version", "not the current one"),
    "language": ({"language": "fr"}, "language", "not offered"),
    "language list": ({"language": ["zh"]}, "language", "not offered"),
    "consent false": ({"consent": False}, "consent", "not given"),
    "consent one": ({"consent": 1}, "consent", "not given"),
    "consent text": ({"consent": "true"}, "consent", "not given"),
    "scores list": ({"scores": [4]}, "scores", "not an object"),
    "suggestions text": ({"suggestions": "x"}, "suggestions", "not an object"),
    "unknown module": ({"suggestions": {"shoes": "x"}}, "suggestions.shoes", "no such module"),
    "suggestion number": ({"suggestions": {"fabric": 4}}, "suggestions.fabric", "not a text"),
    "NUL": ({"suggestions": {"fabric": "a\0b"}}, "suggestions.fabric", "NUL"),
    "half a surrogate": ({"suggestions": {"fabric": "\ud83d"}}, "suggestions.fabric", "surrogate"),
    "too long": ({"suggestions": {"fabric": "字" * (TEXT_LIMIT + 1)}}, "suggestions.fabric", "too many"),
    "exhibit path": ({"exhibit": "../../etc"}, "exhibit", "not an exhibit's id"),
    "exhibit newline": ({"exhibit": "pibo\n"}, "exhibit", "not an exhibit's id"),
    "exhibit empty": ({"exhibit": ""}, "exhibit", "not an exhibit's id"),
}


@pytest.mark.parametrize("case", WRONG)
def test_each_wrong_field_has_its_own_refusal_and_nothing_is_stored(hall, case):
    change, field, problem = WRONG[case]
    raw = json.dumps(submission(hall.garment) | change)  # escapes what UTF-8 cannot carry
    refused = hall.client.post(hall.url, content=raw, headers={"content-type": "application/json"})
    assert refused.status_code == 422
    said = refused.json()
    assert set(said) == {"field", "problem", "remedy"}
    assert said["field"] == field
    assert problem in said["problem"]
    assert said["remedy"]
    assert count(hall) == 0


@pytest.mark.parametrize("value", [0, 6, -1, 3.5, True, False, "4", [4], {}, 1e300, 10**30])
def test_a_score_off_the_scale_is_refused(hall, value):
    body = submission(hall.garment)
    body["scores"]["pleat"] = value
    refused = hall.client.post(hall.url, json=body)
    assert refused.status_code == 422
    assert refused.json()["field"] == "scores.pleat"
    assert count(hall) == 0


@pytest.mark.parametrize(("value", "stored"), [(1, 1), (5, 5), (3.0, 3), (None, None)])
def test_every_point_an_integral_float_and_not_seen_are_taken(hall, value, stored):
    body = submission(hall.garment)
    body["scores"]["pleat"] = value
    assert hall.client.post(hall.url, json=body).status_code == 201
    assert dict(hall.store.rows(hall.garment)[0].answer.scores)["pleat"] == stored


@pytest.mark.parametrize("key", ["id", "version", "language", "consent", "scores"])
def test_a_missing_field_is_named(hall, key):
    body = submission(hall.garment)
    del body[key]
    refused = hall.client.post(hall.url, json=body)
    assert (refused.status_code, refused.json()["field"]) == (422, key)


def test_items_must_be_exactly_those_of_the_version(hall):
    short, long, empty = (submission(hall.garment) for _ in range(3))
    del short["scores"]["pleat"]
    long["scores"]["shoes"] = 3
    empty["scores"][""] = 3
    fields = [hall.client.post(hall.url, json=body).json()["field"] for body in (short, long, empty)]
    assert fields == ["scores.pleat", "scores.shoes", "scores."]
    assert count(hall) == 0


@pytest.mark.parametrize(
    "raw",
    [
        b"", b"{", b"\xff\xfe", b'{"id": NaN}', b'{"id": Infinity}', b'{"id": 1, "id": 2}', b"[" * 100_000,
        b'{"version": ' + b"9" * 10_000 + b"}",
    ],
)  # fmt: skip
def test_what_is_no_json_is_400(hall, raw):
    refused = hall.client.post(hall.url, content=raw, headers={"content-type": "application/json"})
    assert refused.status_code == 400
    assert set(refused.json()) == {"field", "problem", "remedy"}


@pytest.mark.parametrize("raw", [b"[]", b"null", b'"x"', b"3"])
def test_json_that_is_no_object_is_422(hall, raw):
    assert (
        hall.client.post(hall.url, content=raw, headers={"content-type": "application/json"}).status_code
        == 422
    )


def test_another_content_type_is_415(hall):
    refused = hall.client.post(hall.url, content=b"{}", headers={"content-type": "text/plain"})
    assert refused.status_code == 415


def test_a_body_over_one_megabyte_is_413(hall):
    body = submission(hall.garment, suggestions={"fabric": "x" * 1_100_000})
    assert hall.client.post(hall.url, json=body).status_code == 413
    assert count(hall) == 0


def test_an_unknown_questionnaire_is_404_and_names_those_there_are(hall):
    for method, path in (("get", ""), ("get", "/results"), ("post", "/submissions")):
        refused = getattr(hall.client, method)(f"{BASE}/shoes{path}")
        assert refused.status_code == 404
        assert "garment" in refused.json()["remedy"]


def test_results_need_ten_answers_and_count_only_seen_items(hall):
    for score in (1, 2, 3, 4, 5, 1, 2, 3, 4):
        body = submission(hall.garment, score=score)
        body["scores"]["dynamic_swing"] = None
        hall.client.post(hall.url, json=body)
    few = hall.client.get(f"{BASE}/garment/results").json()
    assert (few["n"], few["items"], few["modules"]) == (0, None, None)
    hall.client.post(hall.url, json=submission(hall.garment, score=5))
    items = {item["id"]: item for item in hall.client.get(f"{BASE}/garment/results").json()["items"]}
    assert items["pleat"] == items["pleat"] | {"n": 10, "mean": 3.0, "decimals": 1, "withheld": None}
    assert items["dynamic_swing"] == items["dynamic_swing"] | {"n": None, "mean": None}
    assert items["dynamic_swing"]["withheld"]["reason"] == "few"


def test_rows_suggestions_and_export_need_a_token(hall):
    hall.client.post(hall.url, json=submission(hall.garment, suggestions={"form": "好看"}))
    token = hall.store.tokens.make("test")
    bad = [None, "Bearer ", "Bearer nonsense", f"Basic {token}", f"Bearer {token}x", "Bearer \xff", token]
    for path in ("rows", "suggestions", "export/csv"):
        url = f"{BASE}/garment/{path}"
        for header in bad:
            raw = {} if header is None else {"authorization": header.encode("latin-1")}
            refused = hall.client.get(url, headers=raw)
            assert refused.status_code == 401
            assert refused.headers["www-authenticate"] == "Bearer"
            assert "好看" not in refused.text
        assert hall.client.get(url, headers={"authorization": f"Bearer {token}"}).status_code == 200
    said = hall.client.get(f"{BASE}/garment/suggestions", headers={"authorization": f"Bearer {token}"}).json()
    assert [(row["module"], row["text"]) for row in said] == [("form", "好看")]
    (number,) = [entry.id for entry in hall.store.tokens.all()]
    assert hall.store.tokens.revoke(number)
    assert (
        hall.client.get(f"{BASE}/garment/rows", headers={"authorization": f"Bearer {token}"}).status_code
        == 401
    )


def test_nothing_public_shows_a_suggestion_or_a_code(hall):
    bodies = [submission(hall.garment, suggestions={"form": "confidential"}) for _ in range(6)]
    for body in bodies:
        hall.client.post(hall.url, json=body)
    for path in ("", "/garment", "/garment/results"):
        text = hall.client.get(BASE + path).text
        assert "confidential" not in text
        assert bodies[0]["id"] not in text


@pytest.mark.parametrize("database", ["sqlite"], indirect=True)
def test_neither_address_nor_browser_nor_the_token_itself_is_stored(hall):
    agent = "Unmistakable/1.0"
    hall.client.post(hall.url, json=submission(hall.garment), headers={"user-agent": agent})
    token = hall.store.tokens.make("label")
    hall.mounted.close()
    stored = b"".join(path.read_bytes() for path in hall.data.iterdir())
    for secret in (agent, "testclient", token):
        assert secret.encode() not in stored


def test_the_export_opens_in_excel_without_running_anything(hall):
    evil = ["=cmd|' /C calc'!A0", "+1", "-1", "@SUM(A1)", "＝1+1", " =1", 'say "hi", 你好', "two\nlines"]
    bodies = [submission(hall.garment, suggestions={"fabric": text}, exhibit="pibo") for text in evil]
    bodies[0]["scores"]["pleat"] = None
    for body in bodies:
        hall.client.post(hall.url, json=body)
    headers = {"authorization": f"Bearer {hall.store.tokens.make('x')}"}
    reply = hall.client.get(f"{BASE}/garment/export/csv", headers=headers)
    assert reply.content.startswith("\ufeff".encode())
    rows = list(csv.DictReader(io.StringIO(reply.content.decode("utf-8-sig"), newline="")))
    assert list(rows[0])[5:17] == list(hall.garment.item_ids)
    by_id = {row["submission"]: row for row in rows}
    cells = [by_id[pseudonym(body["id"])]["suggestion_fabric"] for body in bodies]
    assert cells == [
        "'=cmd|' /C calc'!A0",
        "'+1",
        "'-1",
        "'@SUM(A1)",
        "'＝1+1",
        "'=1",
        'say "hi", 你好',
        "two\nlines",
    ]
    assert by_id[pseudonym(bodies[0]["id"])]["pleat"] == ""
    assert by_id[pseudonym(bodies[1]["id"])]["pleat"] == "4"
    assert {row["exhibit"] for row in rows} == {"pibo"}


def test_a_withdrawn_answer_is_gone_and_cannot_come_back(hall):
    body = submission(hall.garment, suggestions={"form": "regretted"})
    hall.client.post(hall.url, json=body)
    wrong_place = hall.client.delete(f"{BASE}/platform-user/submissions/{body['id']}")
    assert wrong_place.status_code == 404
    assert hall.client.delete(f"{hall.url}/{body['id']}").status_code == 204
    assert hall.client.delete(f"{hall.url}/{body['id']}").status_code == 204
    assert hall.client.post(hall.url, json=body).status_code == 410
    assert hall.store.rows(hall.garment) == ()
    assert hall.client.delete(f"{hall.url}/{uuid.uuid4()}").status_code == 404
    assert hall.client.delete(f"{hall.url}/nonsense").status_code == 422
    for table in ("answer", "suggestion"):
        assert looked_up(hall.data, f"SELECT count(*) FROM {table}") == [(0,)]


@pytest.mark.parametrize("database", ["sqlite"], indirect=True)
def test_a_locked_or_broken_store_answers_503_and_recovers(hall, monkeypatch):
    from survey.store.database import tables

    with sqlite3.connect(hall.data / "survey.sqlite") as database:
        database.execute("PRAGMA busy_timeout=0")
        monkeypatch.setattr(tables, "BUSY_SECONDS", 0.05)
        hall.mounted.close()  # connections opened from here on wait only briefly
        database.execute("BEGIN EXCLUSIVE")
        body = submission(hall.garment)
        refused = hall.client.post(hall.url, json=body)
        assert refused.status_code == 503
        assert "locked" in refused.json()["problem"]
        assert refused.headers["retry-after"]
        database.rollback()
    database.close()
    assert hall.client.get("/api/v1/healthz").json() == {"status": "ok"}
    assert hall.client.post(hall.url, json=body).status_code == 201


def test_the_router_works_under_a_prefix(hall):
    app = FastAPI()
    app.include_router(survey.router(hall.store, hall.mounted.questionnaires), prefix="/museum")
    with TestClient(app) as client:
        assert client.get("/museum/api/v1/healthz").status_code == 200
        body = submission(hall.garment)
        assert client.post("/museum" + hall.url, json=body).status_code == 201


def test_the_openapi_document_describes_the_submission(hall):
    document = hall.client.get("/openapi.json").json()
    post = document["paths"]["/api/v1/questionnaires/{key}/submissions"]["post"]
    schema = post["requestBody"]["content"]["application/json"]["schema"]
    assert set(schema["required"]) == {"id", "version", "language", "consent", "scores"}
    assert schema["additionalProperties"] is False


def test_a_replay_after_the_version_was_raised_gives_the_stored_answer(hall, monkeypatch):
    body = submission(hall.garment)
    first = hall.client.post(hall.url, json=body)
    folder = hall.mounted.questionnaires
    path = folder.folder / "garment.toml"
    raised = hall.garment.model_copy(update={"version": 7})
    raised.__dict__.pop("digest", None)
    monkeypatch.setitem(folder._good, path, raised)
    again = hall.client.post(hall.url, json=body)
    assert (first.status_code, again.status_code, again.json()) == (201, 200, first.json())
    other = hall.client.post(hall.url, json=body | {"language": "en"})
    assert (other.status_code, other.json()["field"]) == (409, "id")
    fresh = hall.client.post(hall.url, json=submission(hall.garment))
    assert (fresh.status_code, fresh.json()["field"]) == (422, "version")
    assert hall.client.delete(f"{hall.url}/{body['id']}").status_code == 204
    assert hall.client.post(hall.url, json=body).status_code == 410
    monkeypatch.delitem(folder._good, path)
    assert hall.client.post(hall.url, json=body).status_code == 410
    assert hall.client.post(hall.url, json=submission(hall.garment)).status_code == 404
    assert count(hall) == 1


def test_an_answer_frozen_for_evaluation_cannot_be_withdrawn(hall):
    body = submission(hall.garment)
    hall.client.post(hall.url, json=body)
    assert hall.store.freeze("garment") == 1
    refused = hall.client.delete(f"{hall.url}/{body['id']}")
    assert refused.status_code == 409
    assert refused.json()["remedy"]
    assert len(hall.store.rows(hall.garment)) == 1


def test_too_many_new_answers_from_one_address_wait_and_replays_do_not(hall):
    app = FastAPI()
    app.include_router(survey.router(hall.store, hall.mounted.questionnaires, Limit(3)))
    with TestClient(app) as client:
        bodies = [submission(hall.garment) for _ in range(4)]
        assert [client.post(hall.url, json=body).status_code for body in bodies] == [201, 201, 201, 429]
        refused = client.post(hall.url, json=bodies[3])
        assert set(refused.json()) == {"field", "problem", "remedy"}
        assert int(refused.headers["retry-after"]) >= 1
        assert [client.post(hall.url, json=body).status_code for body in bodies[:3]] == [200] * 3
        assert (
            client.post(hall.url, json=bodies[3]).status_code == 429
        )  # replays do not fill the bucket either
    assert count(hall) == 3


def test_what_the_store_refuses_does_not_count_against_the_address(hall, monkeypatch):
    app, full = FastAPI(), Future()
    full.set_exception(StoreError("the disk is full"))
    app.include_router(survey.router(hall.store, hall.mounted.questionnaires, Limit(3)))
    with TestClient(app) as client:
        bodies = [submission(hall.garment) for _ in range(3)]
        with monkeypatch.context() as broken:
            broken.setattr(hall.store, "enqueue", lambda *_: full)
            assert [client.post(hall.url, json=body).status_code for body in bodies * 2] == [503] * 6
        assert [client.post(hall.url, json=body).status_code for body in bodies] == [201] * 3


def test_replays_leave_the_new_answers_of_an_address_their_room(hall):
    app = FastAPI()
    app.include_router(survey.router(hall.store, hall.mounted.questionnaires, Limit(3)))
    with TestClient(app) as client:
        bodies = [submission(hall.garment) for _ in range(3)]
        assert [client.post(hall.url, json=bodies[0]).status_code for _ in range(9)] == [201] + [200] * 8
        assert [client.post(hall.url, json=body).status_code for body in bodies[1:]] == [201] * 2


def test_a_bucket_fills_again_evenly_and_each_address_has_its_own():
    clock = [0.0]
    limit = Limit(60, clock=lambda: clock[0])
    assert [limit.take("a") for _ in range(60)] == [0] * 60
    assert limit.take("a") == 1
    assert limit.take("b") == 0
    clock[0] = 2.0
    assert [limit.take("a") for _ in range(3)] == [0, 0, 1]
    assert [Limit(0).take("a") for _ in range(1000)] == [0] * 1000


def test_who_waits_as_long_as_told_is_let_in_and_not_before():
    clock = [0.0]
    limit = Limit(3, clock=lambda: clock[0])
    assert [limit.take("a") for _ in range(4)] == [0, 0, 0, 20]
    clock[0] = 19.0
    assert limit.take("a") == 1
    clock[0] = 20.0
    assert limit.take("a") == 0
