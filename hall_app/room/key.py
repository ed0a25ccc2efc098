"""The key of a baked room: a hash of everything that decides how it looks."""

from __future__ import annotations

import hashlib
import json
from typing import Any

from ..content.loading import Content, Exhibit

__all__ = ["ROOM_VERSION", "room_key"]

# Raise it whenever geometry, textures, lettering or light change what a bake looks like.
ROOM_VERSION = 1


def room_key(content: Content) -> str:
    """16 hex digits over the plan, the hall's title, the exhibits' labels and places, and ROOM_VERSION."""
    inputs = {
        "version": ROOM_VERSION,
        "plan": content.plan.model_dump(mode="json"),
        "title": content.hall.title.as_json(),
        "labels": {exhibit.id: _label(exhibit) for exhibit in content.exhibits},
    }
    return hashlib.sha256(json.dumps(inputs, sort_keys=True).encode()).hexdigest()[:16]


def _label(exhibit: Exhibit) -> dict[str, Any]:
    """What of an exhibit shows in the room: its title, and where its label stands."""
    place = exhibit.file.place.model_dump(mode="json")
    body = exhibit.file.body.model_dump(mode="json")
    return {"title": exhibit.file.title.as_json(), "place": place, "body": body}
