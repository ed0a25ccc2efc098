"""The exhibition hall: content, walking, drawing, serving. The only room that joins the other two."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hall_app.content import Content, ContentError, Problem, load
    from hall_app.content.behaviours import BEHAVIOURS, behaviour
    from hall_app.house.house import House
    from hall_app.walk import Floor, Keys, Pose, step
    from hall_app.web.app import create_app

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
    "BEHAVIOURS": "hall_app.content.behaviours",
    "behaviour": "hall_app.content.behaviours",
    "Content": "hall_app.content",
    "ContentError": "hall_app.content",
    "Problem": "hall_app.content",
    "load": "hall_app.content",
    "House": "hall_app.house.house",
    "create_app": "hall_app.web.app",
    "Floor": "hall_app.walk",
    "Keys": "hall_app.walk",
    "Pose": "hall_app.walk",
    "step": "hall_app.walk",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module 'hall_app' has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value
