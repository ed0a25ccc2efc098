"""The record of processing (GDPR Art. 30) and what visitors are told (Art. 13), as a page made from the settings.

`controller` reads who answers for the survey, `record` gathers what is so, `page` writes it and `routes` hands it out.
Names are handed out late (PEP 562): a check of the content wants no web framework and no database.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from survey.web.privacy.controller import CONTROLLER_FILE, Controller, read_controller
    from survey.web.privacy.page import privacy_page
    from survey.web.privacy.record import Record, Running, record_of
    from survey.web.privacy.routes import privacy_router

__all__ = [
    "CONTROLLER_FILE",
    "Controller",
    "Record",
    "Running",
    "privacy_page",
    "privacy_router",
    "read_controller",
    "record_of",
]

_LATE = {
    "CONTROLLER_FILE": "controller",
    "Controller": "controller",
    "read_controller": "controller",
    "privacy_page": "page",
    "Record": "record",
    "Running": "record",
    "record_of": "record",
    "privacy_router": "routes",
}


def __getattr__(name: str) -> object:
    if name not in _LATE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_LATE[name]}"), name)
