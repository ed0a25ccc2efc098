"""The data folder: answers, bakes and caches. Whoever makes it closes it, before anything lies in it."""

from __future__ import annotations

from pathlib import Path

__all__ = ["make_data_folder"]


def make_data_folder(folder: Path) -> None:
    """Make it for its owner alone; one that was there keeps its rights. Raises OSError naming the option."""
    from survey.store.database import make_private

    try:
        make_private(folder)
    except OSError as error:
        raise OSError(f"--data {folder}: {error.strerror} – choose a folder that can be written") from error
