"""The survey over HTTP: the `api`, the visitors' `form`, the `privacy` page, `mounting` them in an app, the `service`.

Names are handed out late (PEP 562): a check of the content wants no web framework.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from survey.web.mounting import Mounted, mount
    from survey.web.privacy import Running
    from survey.web.service import serve, survey_app

__all__ = ["Mounted", "Running", "mount", "serve", "survey_app"]

_LATE = {
    "Running": "privacy",
    "Mounted": "mounting",
    "mount": "mounting",
    "serve": "service",
    "survey_app": "service",
}


def __getattr__(name: str) -> object:
    if name not in _LATE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_LATE[name]}"), name)
