"""What is wrong in a content folder.

files: whether they hold what they should; hall: whether what they hold stands well; garments: whether what was baked
keeps its limits; folder: all of it; command: `hall check`. Names are handed out when they are asked for (PEP 562), so
that a command's --help reads no check.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hall_app.check.folder import CHECKS, QUICK, check, hints

__all__ = ["CHECKS", "QUICK", "check", "hints"]

_HOME = {
    "CHECKS": "folder",
    "QUICK": "folder",
    "check": "folder",
    "hints": "folder",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
