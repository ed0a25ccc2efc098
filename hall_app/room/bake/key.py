"""The key of a baked room: a hash of everything that decides how it looks."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

from hall_app.content.bakes.models import models_of
from hall_app.content.files import digest, plan_files
from hall_app.content.folder import Content, Exhibit
from hall_app.content.schema.plan import PlanFile

__all__ = ["ROOM_VERSION", "built_key", "room_key"]

# Raise it whenever geometry, textures, lettering or light change what a bake looks like.
ROOM_VERSION = 5


def room_key(content: Content, data: Path | None = None) -> str:
    """16 hex digits over plan and its pictures, title, the exhibits' labels, places and hall models, and ROOM_VERSION.

    The models stand in the light, so that a garment baked again takes the old shadows with it. data: the data folder,
    where garments' own bakes may lie.
    """
    inputs = {
        "version": ROOM_VERSION,
        "plan": content.plan.model_dump(mode="json"),
        "title": content.hall.title.as_json(),
        "labels": {exhibit.id: _label(exhibit) for exhibit in content.exhibits},
        "models": {exhibit.id: _model(content, exhibit, data) for exhibit in content.exhibits},
    }
    if hung := [_whole(content.folder / path) for _, path in plan_files(content.plan)]:
        inputs["pictures"] = hung
    return _hash(inputs)


def built_key(plan: PlanFile) -> str:
    """16 hex digits over all that is built after the plan, whatever is written on it.

    Two rooms of one key differ in letters, in the exhibits' spots and shadows, and in nothing that a visitor could
    walk into: the one may stand in for the other.
    """
    built = plan.model_dump(
        mode="json",
        exclude={
            "sign": {"__all__": {"text", "picture"}},
            "bay": {"__all__": {"name"}},
            "solid": {"__all__": {"label"}},
        },
    )
    return _hash({"version": ROOM_VERSION, "plan": built})


def _hash(inputs: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(inputs, sort_keys=True).encode()).hexdigest()[:16]


def _label(exhibit: Exhibit) -> dict[str, Any]:
    """What of an exhibit shows in the room: its title, and where its label stands."""
    place = exhibit.file.place.model_dump(mode="json", exclude={"lamp"})  # it lights the exhibit alone
    body = exhibit.file.body.model_dump(mode="json")
    return {"title": exhibit.file.title.as_json(), "place": place, "body": body}


def _model(content: Content, exhibit: Exhibit, data: Path | None) -> str | None:
    """Digest of the model that casts the exhibit's shadow, None while it has none."""
    models = models_of(content, exhibit, data)
    return _whole(models.hall) if models is not None else None


def _whole(path: Path) -> str | None:
    """A file's digest; None where it is not there, or not ours to read: nothing is drawn of it."""
    try:
        return digest(path)
    except OSError:
        return None
