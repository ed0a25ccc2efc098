"""What takes an account, on a port of its own without the hall round it: quickly opened, passwords quickly hashed."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import uvicorn
from content_house import make_house
from fastapi import FastAPI
from running_hall import free_port

from hall_app.content import load
from hall_app.house.people import People
from hall_app.house.safekeeping import Holdings
from hall_app.web.platform import add_platform
from survey import mount

OPENING = 120  # [s]


@dataclass(frozen=True)
class OpenCounter:
    """Its address, data folder and application; suggestions: what the questionnaires' visitors wrote."""

    url: str
    data: Path
    content: Path
    people: People
    app: FastAPI
    house: Any = None
    suggestions: list[dict[str, Any]] = field(default_factory=list)


@contextlib.contextmanager
def open_counter(work: Path, accounts: str | None = None) -> Iterator[OpenCounter]:
    """accounts: URL of the people's database, else it lies with the data."""
    port, app, data = free_port(), FastAPI(), work / "data"
    content = make_house(work / "content")
    (content / "questionnaires").mkdir()
    asked = Path(__file__).parents[2] / "assets" / "questionnaires" / "garment.toml"
    (content / "questionnaires" / "garment.toml").write_bytes(asked.read_bytes())
    people, survey = People(accounts or data), mount(app, content=content, data=data, problems=[])
    suggestions: list[dict[str, Any]] = []
    house: Any = SimpleNamespace(
        content=load(content),
        data=data,
        quota=50_000_000,
        queue=None,
        preparing=(),
        own_problems=(),
        bakes=dict,
        given_up=lambda exhibit: False,
        survey_suggestions=lambda: suggestions,
        survey_tokens=lambda: survey.store.tokens,
        survey_standing=survey.standing,
        survey_made=survey.made,
        survey_answers=survey,
        holdings=Holdings(content, data, data, data),
    )
    counter = OpenCounter(f"http://127.0.0.1:{port}", data, content, people, app, house, suggestions)
    add_platform(app, house, people)
    server = uvicorn.Server(uvicorn.Config(app, port=port, log_level="warning"))
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
