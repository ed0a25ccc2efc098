"""Files kept by their digest: of drafts, and of what was published before. One of a kind, and a limit for all."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterable
from pathlib import Path

from hall_app.content.files import replace_file
from hall_app.house.people import PeopleError

__all__ = ["QUOTA", "Shelf"]

QUOTA = 2_000_000_000  # [bytes]
_DIGEST = re.compile("[0-9a-f]{64}")


class Shelf:
    """folder: its own alone; quota: [bytes] that all files together may have."""

    def __init__(self, folder: Path, quota: int = QUOTA) -> None:
        self._folder, self._quota = folder, quota

    def put(self, data: bytes) -> str:
        """Keep it; its digest. Raises PeopleError where there is no room, OSError."""
        name = hashlib.sha256(data).hexdigest()
        path = self._folder / name
        if not path.is_file():
            if self.size() + len(data) > self._quota:
                raise PeopleError("quota", most=f"{self._quota / 1e9:g}")
            replace_file(path, data)
            os.chmod(path, 0o644)  # linked into the content folder's likeness, which anybody may read
        return name

    def path(self, digest: str) -> Path:
        """Of a file that is kept. Raises PeopleError."""
        path = self._folder / digest
        if not _DIGEST.fullmatch(digest) or not path.is_file():
            raise PeopleError("no-former")
        return path

    def has(self, digest: str) -> bool:
        return bool(_DIGEST.fullmatch(digest)) and (self._folder / digest).is_file()

    def size(self) -> int:
        """Of all that is kept [bytes]."""
        if not self._folder.is_dir():
            return 0
        return sum(path.stat().st_size for path in self._folder.iterdir() if path.is_file())

    def keep_only(self, wanted: Iterable[str]) -> None:
        """Let go of all others."""
        kept = set(wanted)
        if self._folder.is_dir():
            for path in self._folder.iterdir():
                if _DIGEST.fullmatch(path.name) and path.name not in kept:
                    path.unlink(missing_ok=True)
