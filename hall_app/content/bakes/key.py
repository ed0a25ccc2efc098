"""The key of a bake: a hash of everything that decides what comes out of it."""

from __future__ import annotations

import hashlib
import json

from hall_app.content.bakes.inputs import outfit_files
from hall_app.content.folder import Content, Exhibit

__all__ = ["BAKE_VERSION", "KEY_DIGITS", "bake_key"]

# Raise it whenever an engine, the film or the GLB writer changes what a bake looks like.
BAKE_VERSION = 8

KEY_DIGITS = 16


def bake_key(content: Content, exhibit: Exhibit) -> str:
    """16 hex digits over the outfit file and every file it names, how it is shown, and BAKE_VERSION.

    Raises ValueError for an exhibit without an outfit, and what `outfit_files` raises for one that cannot be read.
    """
    outfit = exhibit.file.outfit
    if outfit is None:
        raise ValueError(f"exhibit {exhibit.id} has no outfit to bake")
    digest = hashlib.sha256(f"bake {BAKE_VERSION}\n".encode())
    digest.update(json.dumps(exhibit.file.show.model_dump(), sort_keys=True).encode())
    for path in dict.fromkeys([outfit, *(path for _, path in outfit_files(content.folder, outfit))]):
        digest.update(f"\0{path}\0".encode())
        digest.update((content.folder / path).read_bytes())
    return digest.hexdigest()[:KEY_DIGITS]
