"""The key of a bake: a hash of everything that decides what comes out of it."""

from __future__ import annotations

import hashlib
import json

from hall_app.content.bakes.inputs import motif_files, outfit_files, scan_files
from hall_app.content.bakes.steps import chosen_steps
from hall_app.content.files import is_there, whole_digest
from hall_app.content.folder import Content, Exhibit

__all__ = ["BAKE_VERSION", "KEY_DIGITS", "bake_key", "dressing_key"]

# Raise it whenever models, clips or their writers change what a bake looks like, and the other as well where an engine
# or the film does: garments, film and pictures are then made anew, which costs most of a bake.
BAKE_VERSION = 17
DRESSING_VERSION = 12
# The same of scans, which no engine of garments changes.
SCAN_VERSION = 1

KEY_DIGITS = 16


def bake_key(content: Content, exhibit: Exhibit) -> str:
    """16 hex digits over the outfit file and every file it names, how it is shown, and BAKE_VERSION; of a scan over it
    and what lies beside it, how it was saved and is shown, and SCAN_VERSION.

    Raises ValueError for an exhibit without either, and what `outfit_files` and `scan_files` raise where files cannot
    be read.
    """
    if exhibit.file.scan is not None:
        return _scan_key(content, exhibit, exhibit.file.scan)
    shown = json.dumps(exhibit.file.show.model_dump(), sort_keys=True)
    return _hash(content, exhibit, f"bake {BAKE_VERSION}\n{shown}")


def dressing_key(content: Content, exhibit: Exhibit) -> str:
    """Of garments, film and pictures alone, whatever the models: without how the exhibit is shown."""
    edges = [step.edge for step in chosen_steps(content, exhibit)]  # by how near it is seen, if a study says
    return _hash(content, exhibit, f"dressing {DRESSING_VERSION}\n{edges or ''}")


def _scan_key(content: Content, exhibit: Exhibit, scan: str) -> str:
    file = exhibit.file
    told = {"show": file.show.model_dump(), "scanned": file.scanned.model_dump(), "size": file.size_range}
    total = hashlib.sha256(f"scan {SCAN_VERSION}\n{json.dumps(told, sort_keys=True)}".encode())
    for path in scan_files(content.folder, exhibit.folder, scan):
        state = whole_digest(path) if is_there(path) else "missing"
        total.update(f"\0{path.name}\0{state}".encode())
    return total.hexdigest()[:KEY_DIGITS]


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
