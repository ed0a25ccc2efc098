"""Labels, plaque, banners, name boards and hung pictures on one sheet, set with Pillow in Noto Serif CJK."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from hall_app.content.models.pictures import in_eight_bits

if TYPE_CHECKING:
    from PIL.Image import Image
    from PIL.ImageDraw import ImageDraw
    from PIL.ImageFont import FreeTypeFont

__all__ = ["MissingFontError", "Sheet", "Writing", "font_file", "write"]

WIDTH = 2048  # [pixels], and the most it is high: a side that every telephone has
SMALLEST = 0.02  # of their size writings are made, however many there are
_GAP = 8  # [pixels] each picture's rim is drawn on round it: no neighbour shows at a distance
_SC = 2  # index of the simplified Chinese face in Noto's collections
_PAPER, _INK, _FADED = "#CFC5AF", "#15110F", "#241D18"  # labels lie in the light of the spots
_GROUND, _GOLD, _SEAL, _SILK = "#241512", "#CFA85A", "#9E2B25", "#5E7276"
_SCROLL = "#EFE6D2"


class MissingFontError(RuntimeError):
    """Noto Serif CJK is not on this machine."""


@dataclass(frozen=True, slots=True)
class Writing:
    """What stands on one board: its kind, a Chinese and an English line, width and height in pixels; of a picture its
    file."""

    kind: Literal["label", "plaque", "banner", "board", "picture"]
    zh: str
    en: str
    size: tuple[int, int]
    picture: Path | None = None


@dataclass(frozen=True, slots=True)
class Sheet:
    """picture: (H, 2048, 3) uint8 sRGB, H ≤ 2048; places: of each writing (x0, y0, x1, y1) in 0..1, y down."""

    picture: NDArray[np.uint8]
    places: tuple[tuple[float, float, float, float], ...]


def write(writings: Sequence[Writing], *, blank: bool = False) -> Sheet:
    """Set all writings on one sheet. blank: leave the letters out, for a machine without the font.

    Raises MissingFontError naming the package to install.
    """
    from PIL import Image

    writings, spots, height = _fitting(writings)
    sheet = Image.new("RGB", (WIDTH, height), _PAPER)
    places = []
    for writing, (x, y) in zip(writings, spots, strict=True):
        picture = _drawn(writing, blank)
        wide, high = writing.size
        rim = picture.resize((wide + 2 * _GAP, high + 2 * _GAP))
        sheet.paste(rim, (x - _GAP, y - _GAP))
        sheet.paste(picture, (x, y))
        places.append((x / WIDTH, y / height, (x + wide) / WIDTH, (y + high) / height))
    return Sheet(np.asarray(sheet), tuple(places))


def _fitting(writings: Sequence[Writing]) -> tuple[list[Writing], list[tuple[int, int]], int]:
    """What is wider than the sheet smaller by itself, and all of them a little, where they would not lie on one sheet
    otherwise; where each lies, and the sheet's height."""
    narrow = [_smaller(one, min(1.0, (WIDTH - 2 * _GAP) / one.size[0])) for one in writings]
    share = 1.0
    while True:
        fitting = [_smaller(one, share) for one in narrow]
        spots, height = _packed([one.size for one in fitting])
        if height <= WIDTH or share < SMALLEST:
            return fitting, spots, height
        share *= 0.97


def _smaller(writing: Writing, share: float) -> Writing:
    wide, high = (max(1, round(share * side)) for side in writing.size)
    return replace(writing, size=(wide, high))


def _packed(sizes: Sequence[tuple[int, int]]) -> tuple[list[tuple[int, int]], int]:
    """Upper left corners, the tallest first and each as high up as there is room, and the sheet's height (a multiple
    of 64)."""
    spots, filled = [(0, 0)] * len(sizes), np.zeros(WIDTH, int)
    for index in sorted(range(len(sizes)), key=lambda k: (-sizes[k][1], k)):
        wide, high = (side + 2 * _GAP for side in sizes[index])
        below = np.lib.stride_tricks.sliding_window_view(filled, wide).max(axis=1)
        x = int(np.argmin(below))
        spots[index] = x + _GAP, int(below[x]) + _GAP
        filled[x : x + wide] = below[x] + high
    return spots, max(64, -(-int(filled.max()) // 64) * 64)


def font_file(bold: bool = False) -> Path:
    """The font's file on this machine. Raises MissingFontError naming the package to install."""
    wanted = "NotoSerifCJK-Bold.ttc" if bold else "NotoSerifCJK-Regular.ttc"
    for folder in font_folders():
        for path in sorted(folder.rglob(wanted)) if folder.is_dir() else ():
            return path
    raise MissingFontError(
        f"font {wanted} not found – install Noto Serif CJK (Debian, Ubuntu: apt-get install fonts-noto-cjk;"
        " elsewhere: put the file into ~/.fonts) and run hall build --room again"
    )


@lru_cache(maxsize=64)
def _font(size: int, bold: bool) -> FreeTypeFont:
    from PIL import ImageFont

    return ImageFont.truetype(str(font_file(bold)), size, index=_SC)


def font_folders() -> list[Path]:
    """Where fonts lie on this machine, most particular first; HALL_FONTS names one more."""
    own = [Path(os.environ["HALL_FONTS"])] if os.environ.get("HALL_FONTS") else []
    home = Path.home()
    if sys.platform == "darwin":
        return [*own, home / "Library/Fonts", Path("/Library/Fonts"), Path("/System/Library/Fonts")]
    if sys.platform == "win32":
        return [*own, Path(os.environ.get("WINDIR", r"C:\Windows")) / "Fonts"]
    return [
        *own,
        home / ".fonts",
        home / ".local/share/fonts",
        Path("/usr/local/share/fonts"),
        Path("/usr/share/fonts"),
    ]


def _drawn(writing: Writing, blank: bool):
    from PIL import Image, ImageDraw

    ground = {"label": _PAPER, "plaque": _GROUND, "board": _GROUND}.get(writing.kind, _SCROLL)
    picture = Image.new("RGB", writing.size, ground)
    draw = ImageDraw.Draw(picture)
    if writing.picture is not None:
        _scroll(picture, draw, writing.picture)
    else:
        {"label": _label, "plaque": _board, "board": _board, "banner": _banner}[writing.kind](
            draw, writing, blank
        )
    return picture


def _scroll(sheet: Image, draw: ImageDraw, file: Path) -> None:
    """A picture as it is mounted to hang: on paper, in a frame of silk that is widest above. One that cannot be read
    leaves the paper empty; `hall check` names it."""
    from PIL import Image, ImageOps

    wide, high = sheet.size
    side, above, below = round(0.07 * wide), round(0.12 * high), round(0.08 * high)
    _mount(draw, sheet.size, side, above, below)
    room = (wide - 2 * side, high - above - below)
    try:
        with Image.open(file) as held:
            shown = ImageOps.contain(in_eight_bits(held).convert("RGB"), room, Image.Resampling.LANCZOS)
    except Exception:  # a reader of foreign files may fail in any way
        return
    sheet.paste(shown, (side + (room[0] - shown.width) // 2, above + (room[1] - shown.height) // 2))


def _mount(draw: ImageDraw, size: tuple[int, int], side: int, above: int, below: int) -> None:
    """The frame of silk round the paper of a scroll, as wide as told [pixels]."""
    wide, high = size
    for frame in (
        (0, 0, wide, above),
        (0, high - below, wide, high),
        (0, 0, side, high),
        (wide - side, 0, wide, high),
    ):
        draw.rectangle(frame, fill=_SILK)


def _fitted(draw: ImageDraw, text: str, size: int, width: float, bold: bool) -> FreeTypeFont:
    """The font of at most `size` pixels in which `text` is no wider than `width`."""
    while size > 12 and draw.textlength(text, font=_font(size, bold)) > width:
        size -= 1
    return _font(size, bold)


def _label(draw: ImageDraw, writing: Writing, blank: bool) -> None:
    wide, high = writing.size
    draw.rectangle((0, 0, round(0.018 * wide), high), fill=_SEAL)
    if blank:
        return
    left, room = 0.06 * wide, 0.90 * wide
    font = _fitted(draw, writing.zh, round(0.34 * high), room, True)
    draw.text((left, 0.36 * high), writing.zh, _INK, font, anchor="lm")
    font = _fitted(draw, writing.en, round(0.20 * high), room, False)
    draw.text((left, 0.72 * high), writing.en, _FADED, font, anchor="lm")


def _board(draw: ImageDraw, writing: Writing, blank: bool) -> None:
    wide, high = writing.size
    for inset, thick in ((0.035, 0.020), (0.075, 0.006)):
        at = inset * high
        draw.rectangle((at, at, wide - at, high - at), outline=_GOLD, width=max(1, round(thick * high)))
    if blank:
        return
    letters = len(writing.zh)
    middle = 0.42 if writing.en else 0.5
    size = min(round((0.52 if writing.en else 0.62) * high), round(0.8 * wide / max(letters, 1)))
    font = _fitted(draw, writing.zh, size, 0.86 * wide, True)
    gap = min(0.5 * size, (0.86 * wide - letters * size) / max(letters, 1))
    start = wide / 2 - (letters * size + (letters - 1) * gap) / 2 + size / 2
    for k, letter in enumerate(writing.zh):
        draw.text((start + k * (size + gap), middle * high), letter, _GOLD, font, anchor="mm")
    if writing.en:
        font = _fitted(draw, writing.en, round(0.15 * high), 0.8 * wide, False)
        draw.text((wide / 2, 0.82 * high), writing.en, _GOLD, font, anchor="mm")


def _banner(draw: ImageDraw, writing: Writing, blank: bool) -> None:
    wide, high = writing.size
    mount = round(0.10 * high)
    _mount(draw, writing.size, round(0.05 * wide), mount, mount)
    if blank:
        return
    letters = len(writing.zh)
    room = high - 3.5 * mount
    size = min(round(0.62 * wide), round(0.86 * room / max(letters, 1)))
    font = _font(size, True)
    for k, letter in enumerate(writing.zh):
        y = 1.3 * mount + room * (k + 0.5) / letters
        draw.text((wide / 2, y), letter, _INK, font, anchor="mm")
    seal = 0.17 * wide
    at = (0.5 * wide, high - 1.65 * mount)
    draw.rectangle((at[0] - seal / 2, at[1] - seal / 2, at[0] + seal / 2, at[1] + seal / 2), fill=_SEAL)
