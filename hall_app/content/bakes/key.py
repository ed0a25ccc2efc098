"""The key of a bake: a hash of everything that decides what comes out of it."""

from __future__ import annotations

import hashlib
import json

from hall_app.content.bakes.inputs import motif_files, outfit_files
from hall_app.content.bakes.steps import chosen_steps
from hall_app.content.folder import Content, Exhibit

__all__ = ["BAKE_VERSION", "KEY_DIGITS", "bake_key", "dressing_key"]

# Raise it whenever models, clips or their writers change what a bake looks like, and the other as well where an engine
# or the film does: garments, film and pictures are then made anew, which costs most of a bake.
BAKE_VERSION = 13
DRESSING_VERSION = 12

KEY_DIGITS = 16


def bake_key(content: Content, exhibit: Exhibit) -> str:
    """16 hex digits over the outfit file and every file it names, how it is shown, and BAKE_VERSION.

    Raises ValueError for an exhibit without an outfit, and what `outfit_files` raises for one that cannot be read.
    """
    shown = json.dumps(exhibit.file.show.model_dump(), sort_keys=True)
    return _hash(content, exhibit, f"bake {BAKE_VERSION}\n{shown}")


def dressing_key(content: Content, exhibit: Exhibit) -> str:
    """Of garments, film and pictures alone, whatever the models: without how the exhibit is shown."""
    edges = [step.edge for step in chosen_steps(content, exhibit)]  # by how near it is seen, if a study says
    return _hash(content, exhibit, f"dressing {DRESSING_VERSION}\n{edges or ''}")


def _hash(content: Content, exhibit: Exhibit, begin: str) -> str:
    outfit = exhibit.file.outfit
    if outfit is None:
        raise ValueError(f"exhibit {exhibit.id} has no outfit to bake")
    digest = hashlib.sha256(begin.encode())
    named = [outfit, *(path for _, path in outfit_files(content.folder, outfit))]
    motifs = [motif for path in named for motif in motif_files(content.folder, path)]
    for path in dict.fromkeys([*named, *motifs]):
        digest.update(f"\0{path}\0".encode())
        digest.update((content.folder / path).read_bytes())
    return digest.hexdigest()[:KEY_DIGITS]
