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

from hall_app.room.surface.packing import packed
from hall_app.room.surface.scrolls import PAPER, hung_picture, mount

if TYPE_CHECKING:
    from PIL.Image import Image
    from PIL.ImageDraw import ImageDraw
    from PIL.ImageFont import FreeTypeFont

__all__ = ["SCROLLS", "MissingFontError", "Sheet", "Writing", "font_file", "letter_size", "shrunk", "write"]

WIDTH = 2048  # [pixels], and the most it is high: a side that every telephone has
SCROLLS = ("banner", "picture")  # hang from a rod; larger than what is read, they give way first
ALL = (*SCROLLS, "label", "plaque", "board")
# What gets smaller where there is too much for a sheet, and to what share of what it was: labels are to be read.
GIVE_WAY = ((SCROLLS, 0.9), (ALL, 0.94), (SCROLLS, 0.5), (ALL, 0.02))
LEAST = 12  # [pixels] letters are high, where their board is large enough
# Silk at each end of a banner, of its length; and how many times as much of it bears no letters.
_RODS, _NOT_WRITTEN = 0.10, 3.5
_GAP = 8  # [pixels] each picture's rim is drawn on round it: no neighbour shows at a distance
_SC = 2  # index of the simplified Chinese face in Noto's collections
_PAPER, _INK, _FADED = "#CFC5AF", "#15110F", "#241D18"  # labels lie in the light of the spots
_GROUND, _GOLD, _SEAL = "#241512", "#CFA85A", "#9E2B25"


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
    from PIL import ImageColor

    fitting, spots, height = _fitting(writings)
    sheet = np.full((height, WIDTH, 3), ImageColor.getrgb(_PAPER), np.uint8)
    places = []
    for writing, (x, y) in zip(fitting, spots, strict=True):
        wide, high = writing.size
        picture = np.pad(
            np.asarray(_drawn(writing, blank)), ((_GAP, _GAP), (_GAP, _GAP), (0, 0)), mode="edge"
        )
        sheet[y - _GAP : y + high + _GAP, x - _GAP : x + wide + _GAP] = picture
        places.append((x / WIDTH, y / height, (x + wide) / WIDTH, (y + high) / height))
    return Sheet(sheet, tuple(places))


def shrunk(writings: Sequence[Writing]) -> tuple[float, float]:
    """Of what they ask for, how large scrolls and all others are drawn on one sheet, 0 to 1: the smallest of each.

    What is larger than the sheet by itself does not count: it takes nothing from the others.
    """
    least = [1.0, 1.0]
    for asked, drawn in zip(_by_themselves(writings), _fitting(writings)[0], strict=True):
        which = asked.kind not in SCROLLS
        least[which] = min(least[which], max(drawn.size) / max(asked.size))
    return least[0], least[1]


def _by_themselves(writings: Sequence[Writing]) -> list[Writing]:
    """What is larger than the sheet smaller by itself."""
    return [_smaller(one, min(1.0, (WIDTH - 2 * _GAP) / max(one.size))) for one in writings]


def _fitting(writings: Sequence[Writing]) -> tuple[list[Writing], list[tuple[int, int]], int]:
    """The writings as large as they lie on one sheet, scrolls smaller than they ask before labels are; where each lies,
    and the sheet's height (a multiple of 64)."""
    shown = _by_themselves(writings)
    spots, filled = _spots(shown)
    for kinds, smallest in GIVE_WAY:
        room = [one.size[0] * one.size[1] for one in shown if one.kind in kinds]
        others = sum(one.size[0] * one.size[1] for one in shown) - sum(room)
        if filled <= WIDTH or not room:
            continue
        before, share = shown, min(1.0, max(smallest, (max(0, WIDTH**2 - others) / sum(room)) ** 0.5))
        while filled > WIDTH and share >= smallest:
            shown = [_smaller(one, share) if one.kind in kinds else one for one in before]
            spots, filled = _spots(shown)
            share *= 0.985
    return shown, spots, max(64, -(-filled // 64) * 64)


def _spots(writings: Sequence[Writing]) -> tuple[list[tuple[int, int]], int]:
    return packed([one.size for one in writings], WIDTH, _GAP)


def _smaller(writing: Writing, share: float) -> Writing:
    wide, high = (max(1, round(share * side)) for side in writing.size)
    return replace(writing, size=(wide, high))


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


def _drawn(writing: Writing, blank: bool) -> Image:
    from PIL import Image, ImageDraw

    ground = {"label": _PAPER, "plaque": _GROUND, "board": _GROUND}.get(writing.kind, PAPER)
    picture = Image.new("RGB", writing.size, ground)
    draw = ImageDraw.Draw(picture)
    if writing.kind == "picture":
        hung_picture(picture, draw, writing.picture)
    else:
        one_line = replace(writing, zh=" ".join(writing.zh.split()), en=" ".join(writing.en.split()))
        {"label": _label, "plaque": _board, "board": _board, "banner": _banner}[writing.kind](
            draw, one_line, blank
        )
    return picture


def _fitted(draw: ImageDraw, text: str, size: int, width: float, bold: bool) -> FreeTypeFont:
    """The font of at most `size` pixels in which `text` is no wider than `width`; letters end where they are as small
    as can be read."""
    size = max(1, size)
    while size > LEAST and draw.textlength(text, font=_font(size, bold)) > width:
        size -= 1
    return _font(size, bold)


def letter_size(writing: Writing) -> int:
    """How high the Chinese letters of a plaque, board or banner are at most, in the unit of its size, 1 or more."""
    (wide, high), letters = writing.size, max(1, len(writing.zh))
    if writing.kind == "banner":
        long, short = max(wide, high), min(wide, high)
        most, each = 0.62 * short, 0.86 * (1 - _NOT_WRITTEN * _RODS) * long / letters
    else:
        most, each = (0.52 if writing.en else 0.62) * high, 0.8 * wide / letters
    return max(1, min(round(most), round(each)))


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
    side = min(wide, high)
    for inset, thick in ((0.035, 0.020), (0.075, 0.006)):
        at = inset * side
        draw.rectangle((at, at, wide - at, high - at), outline=_GOLD, width=max(1, round(thick * side)))
    if blank:
        return
    letters = len(writing.zh)
    middle = 0.42 if writing.en else 0.5
    size = letter_size(writing)
    font = _fitted(draw, writing.zh, size, 0.86 * wide, True)
    gap = min(0.5 * size, (0.86 * wide - letters * size) / max(letters, 1))
    start = wide / 2 - (letters * size + (letters - 1) * gap) / 2 + size / 2
    for k, letter in enumerate(writing.zh):
        draw.text((start + k * (size + gap), middle * high), letter, _GOLD, font, anchor="mm")
    if writing.en:
        font = _fitted(draw, writing.en, round(0.15 * high), 0.8 * wide, False)
        draw.text((wide / 2, 0.82 * high), writing.en, _GOLD, font, anchor="mm")


def _banner(draw: ImageDraw, writing: Writing, blank: bool) -> None:
    """Letters down a scroll, or along one that is wider than high, and a seal after the last."""
    (wide, high), along = writing.size, int(writing.size[1] >= writing.size[0])
    long, short = max(writing.size), min(writing.size)
    rods, sides = round(_RODS * long), round(0.05 * short)
    mount(draw, writing.size, *((sides, rods, rods) if along else (rods, sides, sides)))
    if blank:
        return
    room, font = long - _NOT_WRITTEN * rods, _font(letter_size(writing), True)
    for k, letter in enumerate(writing.zh):
        at = 1.3 * rods + room * (k + 0.5) / len(writing.zh)
        draw.text((wide / 2, at) if along else (at, high / 2), letter, _INK, font, anchor="mm")
    seal, end = 0.17 * short, long - 1.65 * rods
    x, y = (wide / 2, end) if along else (end, high / 2)
    draw.rectangle((x - seal / 2, y - seal / 2, x + seal / 2, y + seal / 2), fill=_SEAL)
