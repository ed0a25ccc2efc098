"""What is wrong in a content folder.

files: whether they hold what they should; hall: whether what they hold stands well; garments: whether what was baked
keeps its limits; folder: all of it; likeness: the folder as it would be; command: `hall check`. Names are handed out
when they are asked for (PEP 562), so that a command's --help reads no check.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hall_app.check.folder import CHECKS, EDITED, QUICK, STANDING, check, hints
    from hall_app.check.likeness import Changed, likeness_of, new_problems

__all__ = [
    "CHECKS",
    "EDITED",
    "QUICK",
    "STANDING",
    "Changed",
    "check",
    "hints",
    "likeness_of",
    "new_problems",
]

_HOME = {
    "CHECKS": "folder",
    "Changed": "likeness",
    "EDITED": "folder",
    "QUICK": "folder",
    "check": "folder",
    "STANDING": "folder",
    "hints": "folder",
    "likeness_of": "likeness",
    "new_problems": "likeness",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
