"""The hall's web application, and `hall serve`.

limits: what strangers may ask for; answers: made once, packed once; pages: the door, the catalogue and their files;
sockets: viser's and the walk's; collection: the exhibits' records in the formats museums use; platform: what takes an
account; app: all of them on one port; memory: given back after visitors; port, progress_line, command: `hall serve`.
Names are handed out when they are asked for (PEP 562).
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hall_app.web.app import create_app
    from hall_app.web.command import OFFERS
    from hall_app.web.progress_line import ProgressLine

__all__ = ["OFFERS", "ProgressLine", "create_app"]

_HOME = {
    "OFFERS": "command",
    "ProgressLine": "progress_line",
    "create_app": "app",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
