"""Small pictures for lists: made once with Pillow, kept in the data folder, named after what they were made from."""

from __future__ import annotations

import os
import threading
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from hall_app.content.files import digest
from hall_app.content.models.pictures import LARGEST, in_eight_bits

__all__ = ["EDGE", "Thumbnails"]

EDGE = 480  # [pixels] of the longer side: twice what a list shows, for sharp screens
_QUALITY = 80
_TURNED = (5, 6, 7, 8)  # EXIF orientations that swap width and height
_ORIENTATION = 0x0112


@dataclass(frozen=True)
class Thumbnails:
    """Thumbnails kept in `folder`. For threads beside the event loop: opening and scaling pictures takes a while."""

    folder: Path

    def size(self, picture: Path) -> tuple[int, int] | None:
        """(width, height) [pixels] of the picture's thumbnail, None for what cannot be shown."""
        try:
            stat = picture.stat()
        except OSError:
            return None
        return _size(picture, stat.st_mtime_ns, stat.st_size)

    def file(self, picture: Path) -> Path:
        """The thumbnail, made if it is not there yet; the picture itself where none can be made or kept."""
        size = self.size(picture)
        if size is None:
            return picture
        try:
            kept = self._place(picture)
            if not kept.is_file():
                with _ONE_AT_A_TIME:
                    _make(picture, kept, size)
        except Exception:  # a picture that fails while it is decoded, a full disk: the large one is as good
            return picture
        return kept

    def made(self, picture: Path) -> Path | None:
        """The thumbnail if it is there already."""
        try:
            kept = self._place(picture)
            return kept if kept.is_file() else None
        except OSError:
            return None

    def _place(self, picture: Path) -> Path:
        return self.folder / f"{digest(picture)}-{picture.stat().st_size}-{EDGE}.webp"


_ONE_AT_A_TIME = (
    threading.Lock()
)  # a page asks for dozens at once; they must not take all cores from the walkers


@lru_cache(maxsize=4096)
def _size(picture: Path, _mtime: int, _bytes: int) -> tuple[int, int] | None:
    from PIL import Image

    try:
        with Image.open(picture) as opened:
            width, height = opened.size
            if opened.getexif().get(_ORIENTATION) in _TURNED:
                width, height = height, width
    except Exception:  # a reader of foreign files may fail in any way
        return None
    if max(width, height) > LARGEST:
        return None
    scale = min(1.0, EDGE / max(width, height))
    return max(1, round(width * scale)), max(1, round(height * scale))


def _make(picture: Path, kept: Path, size: tuple[int, int]) -> None:
    from PIL import Image, ImageOps

    if kept.is_file():  # made by who was before us
        return
    kept.parent.mkdir(parents=True, exist_ok=True)
    part = kept.with_name(f".{kept.name}.{os.getpid()}.part")
    try:
        with Image.open(picture) as opened:
            opened.draft("RGB", (2 * EDGE, 2 * EDGE))  # a JPEG is decoded no larger than needed
            upright = in_eight_bits(ImageOps.exif_transpose(opened))
            clear = "A" in upright.getbands() or "transparency" in upright.info
            small = upright.convert("RGBA" if clear else "RGB").resize(size, Image.Resampling.LANCZOS)
            small.save(part, "WEBP", quality=_QUALITY, method=4)
        part.replace(kept)
    finally:
        part.unlink(missing_ok=True)  # half of a picture, on a full disk
