"""What takes an account, on a port of its own without the hall round it: quickly opened, passwords quickly hashed."""

from __future__ import annotations

import contextlib
import json
import threading
import time
import uuid
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import uvicorn
from content_house import make_house
from fastapi import FastAPI
from form_visitor import Visitor
from running_hall import free_port

from hall_app.content import load
from hall_app.house.people import People
from hall_app.house.safekeeping import Holdings
from hall_app.web.platform import add_platform, follow_withdrawals
from survey import Mounted, mount, read_questionnaire

QUESTIONS = Path(__file__).parents[2] / "assets" / "questionnaires" / "garment.toml"
ASKED = read_questionnaire(QUESTIONS)
SAID = "sleeves a little <b>longer</b>, please"

OPENING = 120  # [s]


@dataclass(frozen=True)
class OpenCounter:
    """Its address, data folder and application; survey: its questionnaires, mounted."""

    url: str
    data: Path
    content: Path
    people: People
    app: FastAPI
    house: Any = None
    survey: Mounted | None = None


@contextlib.contextmanager
def open_counter(
    work: Path,
    accounts: str | None = None,
    around: Callable[[FastAPI], Callable[..., Any]] = lambda app: app,
) -> Iterator[OpenCounter]:
    """accounts: URL of the people's database, else it lies with the data; around: what is put round the application."""
    port, app, data = free_port(), FastAPI(), work / "data"
    content = make_house(work / "content")
    (content / "questionnaires").mkdir()
    (content / "questionnaires" / "garment.toml").write_bytes(QUESTIONS.read_bytes())
    people, survey = People(accounts or data), mount(app, content=content, data=data, problems=[])
    house: Any = SimpleNamespace(
        content=load(content),
        data=data,
        quota=50_000_000,
        queue=None,
        preparing=(),
        own_problems=(),
        bakes=dict,
        given_up=lambda exhibit: False,
        survey_suggestions=survey.suggestions,
        survey_tokens=lambda: survey.store.tokens,
        survey_standing=survey.standing,
        survey_made=survey.made,
        survey_answers=survey,
        holdings=Holdings(content, data, data, data),
    )
    counter = OpenCounter(f"http://127.0.0.1:{port}", data, content, people, app, house, survey)
    add_platform(app, house, people)
    follow_withdrawals(survey, people)
    server = uvicorn.Server(uvicorn.Config(around(app), port=port, log_level="warning"))
    thread = threading.Thread(target=server.run)
    thread.start()
    end = time.monotonic() + OPENING
    while not server.started and time.monotonic() < end:
        time.sleep(0.01)
    try:
        yield counter
    finally:
        server.should_exit = True
        thread.join()
        survey.close()
        people.close()


def answered(counter: OpenCounter, scores: dict[str, int] | None = None) -> str:
    """Somebody has sent the questionnaire, with a suggestion; the code he got. scores: else 4 for each item."""
    code, visitor = str(uuid.uuid4()), Visitor(counter.url)
    told = {"id": code, "version": ASKED.version, "language": "zh", "consent": True}
    module = next(one.id for one in ASKED.modules if one.suggestion)
    told |= {"scores": scores or dict.fromkeys(ASKED.item_ids, 4), "suggestions": {module: SAID}}
    sent = visitor.ask(
        "POST",
        f"/api/v1/questionnaires/{ASKED.id}/submissions",
        json.dumps(told).encode(),
        {"Content-Type": "application/json"},
    )
    assert sent.status == 201, sent.text
    return code
