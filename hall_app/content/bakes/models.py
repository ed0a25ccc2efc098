"""Which GLBs an exhibit is drawn with: its own files, or the newest bake of its garment."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from hall_app.content.bakes.store import bake_folder
from hall_app.content.folder import Content, Exhibit

__all__ = ["ExhibitModels", "models_of"]


@dataclass(frozen=True, slots=True)
class ExhibitModels:
    """Paths of both precisions; `baked` is the folder its baked media lie in, None for a ready-made model."""

    hall: Path
    close: Path
    baked: Path | None

    def whole(self) -> bool:
        """Whether both files are (still) there."""
        return self.hall.is_file() and self.close.is_file()


def models_of(
    content: Content, exhibit: Exhibit, data: Path | None, *, stale: bool = True
) -> ExhibitModels | None:
    """What to draw `exhibit` with, or None while its garment or scan has not been baked.

    data: the data folder, where a bake of its own may lie; None looks beside the exhibit alone. stale: whether a bake
    of earlier inputs will do.
    """
    if exhibit.file.baked_key is None:
        hall, close = exhibit.model_path("hall"), exhibit.model_path("close")
        return ExhibitModels(hall, close or hall, None) if hall is not None else None
    folder = bake_folder(content, exhibit, data, stale=stale)
    if folder is None:
        return None
    return ExhibitModels(folder / "hall.glb", folder / "close.glb", folder)
