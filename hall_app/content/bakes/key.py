"""The key of a bake: a hash of everything that decides what comes out of it."""

from __future__ import annotations

import hashlib
import json

from hall_app.content.folder import Content, Exhibit

__all__ = ["BAKE_VERSION", "KEY_DIGITS", "bake_key"]

# Raise it whenever an engine, the film or the GLB writer changes what a bake looks like.
BAKE_VERSION = 7

KEY_DIGITS = 16


def bake_key(content: Content, exhibit: Exhibit) -> str:
    """16 hex digits over recipe, settings, patterns, weaves, mannequin and BAKE_VERSION.

    Raises ValueError for an exhibit without a garment.
    """
    recipe = exhibit.file.garment
    if recipe is None:
        raise ValueError(f"exhibit {exhibit.id} has no garment to bake")
    digest = hashlib.sha256(f"bake {BAKE_VERSION}\n".encode())
    digest.update(json.dumps(recipe.model_dump(), sort_keys=True).encode())
    for path in filter(
        None, (recipe.pattern, recipe.weave, recipe.mannequin, recipe.robe_pattern, recipe.robe_weave)
    ):
        digest.update(f"\0{path}\0".encode())
        digest.update((content.folder / path).read_bytes())
    return digest.hexdigest()[:KEY_DIGITS]
