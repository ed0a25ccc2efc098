"""What hangs from a rod: calligraphy and pictures, mounted on silk.

A picture comes from a curator's folder: its size is looked at before it is opened, it is turned as its camera says, and
what is transparent in it shows the paper.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from hall_app.content.models.pictures import LARGEST, in_eight_bits

if TYPE_CHECKING:
    from PIL.Image import Image
    from PIL.ImageDraw import ImageDraw

__all__ = ["PAPER", "hung_picture", "mount"]

PAPER, _SILK = "#EFE6D2", "#5E7276"
_FORMATS = ("JPEG", "PNG", "WEBP")
Size = tuple[int, int]


def mount(draw: ImageDraw, size: Size, side: int, above: int, below: int) -> None:
    """The frame of silk round the paper of a scroll, as wide as told [pixels]."""
    wide, high = size
    for frame in (
        (0, 0, wide, above),
        (0, high - below, wide, high),
        (0, 0, side, high),
        (wide - side, 0, wide, high),
    ):
        draw.rectangle(frame, fill=_SILK)


def hung_picture(sheet: Image, draw: ImageDraw, file: Path | None) -> None:
    """Mounts a picture: on paper, in a frame of silk that is widest above.

    One that is not there or cannot be read leaves the paper empty; `hall check` names it.
    """
    wide, high = sheet.size
    side, above, below = round(0.07 * wide), round(0.12 * high), round(0.08 * high)
    mount(draw, sheet.size, side, above, below)
    room = (max(1, wide - 2 * side), max(1, high - above - below))
    try:
        shown = _within(file, file.stat().st_mtime_ns, room) if file is not None else None
    except Exception:  # a reader of foreign files may fail in any way
        return
    if shown is not None:
        sheet.paste(shown, (side + (room[0] - shown.width) // 2, above + (room[1] - shown.height) // 2))


@lru_cache(maxsize=64)
def _within(file: Path, _changed: int, room: Size) -> Image | None:
    """The picture as large as fits into `room`, on paper; None for one too large to be opened."""
    from PIL import Image, ImageOps

    with Image.open(file, formats=_FORMATS) as held:
        if max(held.size) > LARGEST:
            return None
        held.draft("RGB", (2 * room[0], 2 * room[1]))  # a JPEG of a camera need not be read whole
        upright = ImageOps.exif_transpose(in_eight_bits(held))
        share = min(room[0] / upright.width, room[1] / upright.height)
        size = max(1, round(share * upright.width)), max(1, round(share * upright.height))
        if not upright.has_transparency_data:
            return upright.convert("RGB").resize(size, Image.Resampling.LANCZOS)
        seen = upright.convert("RGBA").resize(size, Image.Resampling.LANCZOS)
    paper = Image.new("RGBA", size, PAPER)
    return Image.alpha_composite(paper, seen).convert("RGB")
