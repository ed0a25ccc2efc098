"""The office's addresses: every reading and deed at both doors."""

from __future__ import annotations

from typing import Any

from fastapi import FastAPI

from hall_app.web.platform.counter import Asking, Counter
from hall_app.web.platform.office.access import Access
from hall_app.web.platform.office.backups import backup_deeds, backup_readings
from hall_app.web.platform.office.collection import collection_rooms
from hall_app.web.platform.office.description import description
from hall_app.web.platform.office.entering import Reception
from hall_app.web.platform.office.opinions import opinion_deeds, opinion_readings
from hall_app.web.platform.office.people import people_deeds, people_readings
from hall_app.web.platform.office.programme import programme_deeds, programme_readings
from hall_app.web.platform.office.questionnaires import questionnaire_readings

__all__ = ["add_office"]


def add_office(app: FastAPI, counter: Counter) -> None:
    """Add /office and /api/office. counter: of sessions of the office."""
    reception, access = Reception(counter), Access(app, counter)
    counter.page("/office", reception.page)
    counter.act("/office/sign-in", reception.sign_in, reception.sign_in_page)
    counter.act("/office/sign-out", reception.sign_out, reception.page)
    access.own("me", _me)
    collection, changing = collection_rooms(counter)
    readings = (
        *collection,
        *people_readings(counter),
        *programme_readings(counter),
        *questionnaire_readings(counter),
        *opinion_readings(counter),
        *backup_readings(counter),
    )
    deeds = (
        *changing,
        *people_deeds(counter),
        *programme_deeds(counter),
        *opinion_deeds(counter),
        *backup_deeds(counter),
    )
    document = description(readings, deeds)
    access.own("openapi.json", lambda _: document)
    for reading in readings:
        access.reading(reading)
    for deed in deeds:
        access.deed(deed)


def _me(asking: Asking) -> dict[str, Any]:
    """Who asks, and the seal that the API takes with every POST."""
    person = asking.person
    return {"id": person.id, "roles": sorted(person.roles), "seal": asking.seal}
