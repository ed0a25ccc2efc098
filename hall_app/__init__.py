"""The exhibition hall: content, walking, drawing, serving. The only room that joins the other two."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hall_app.behaviours import BEHAVIOURS, behaviour
    from hall_app.content import Content, ContentError, Problem, load
    from hall_app.house import House
    from hall_app.server.app import create_app
    from hall_app.walking import Floor, Keys, Pose, step

__all__ = [
    "BEHAVIOURS",
    "Content",
    "ContentError",
    "Floor",
    "House",
    "Keys",
    "Pose",
    "Problem",
    "behaviour",
    "create_app",
    "load",
    "step",
]

_HOME = {
    "BEHAVIOURS": "hall_app.behaviours",
    "behaviour": "hall_app.behaviours",
    "Content": "hall_app.content",
    "ContentError": "hall_app.content",
    "Problem": "hall_app.content",
    "load": "hall_app.content",
    "House": "hall_app.house",
    "create_app": "hall_app.server.app",
    "Floor": "hall_app.walking",
    "Keys": "hall_app.walking",
    "Pose": "hall_app.walking",
    "step": "hall_app.walking",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module 'hall_app' has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value
