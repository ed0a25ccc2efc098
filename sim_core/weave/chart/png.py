"""A drawing as pixels: the same page as the SVG, a whole number of pixels a cell."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from sim_core.weave.chart.furniture import furniture
from sim_core.weave.chart.paper import SMALL, Page
from sim_core.weave.chart.values import BACK, FACE, REPEAT, Block, Chart

__all__ = ["picture_of"]

GRID, FIFTH, TENTH = (211, 215, 220), (167, 173, 181), (109, 116, 125)
DRAWN = 5  # pixels a cell from which lines are drawn between cells
WRITTEN = 16  # pixels a cell from which numbers are written into them
GREY = (77, 84, 92)  # numbers
FONTS = ("NotoSansCJK-Regular.ttc", "NotoSansSC-Regular.otf", "wqy-zenhei.ttc", "msyh.ttc", "PingFang.ttc")


def picture_of(chart: Chart, page: Page, pixels: int) -> Image.Image:
    """The page with so many pixels a cell; `info["dpi"]` holds its resolution on paper."""
    per_mm = pixels / page.cell
    size = round(page.width * per_mm), round(page.height * per_mm)
    left, top = round(page.left * per_mm), round(page.top * per_mm)
    sheet = np.full((size[1], size[0], 3), 255, dtype=np.uint8)
    for block in chart.blocks:
        _paint(sheet, block, left, top, pixels)
    picture = Image.fromarray(sheet)
    picture.info["dpi"] = (per_mm * 25.4, per_mm * 25.4)
    draw = ImageDraw.Draw(picture)
    for line in (np.array([left, top, left, top]) + chart.repeats * pixels).tolist():
        draw.line(line, fill=REPEAT, width=max(1, round(0.4 * per_mm)))
    for kind, rows in chart.lines:
        _mark(draw, np.array([left, top, left, top]) + rows * pixels, kind, pixels)
    if pixels >= WRITTEN:
        for block in chart.blocks:
            _number(draw, block, left, top, pixels)
    _write(draw, chart, page, per_mm, (left, top, pixels))
    return picture


def _paint(sheet: np.ndarray, block: Block, left: int, top: int, pixels: int) -> None:
    rows, columns = block.cells.shape
    x, y = left + round(block.x * pixels), top + round(block.y * pixels)
    colours = block.colours[block.cells]
    part = np.repeat(np.repeat(colours, pixels, axis=0), pixels, axis=1)
    sheet[y : y + rows * pixels, x : x + columns * pixels] = part
    heavy = max(1, pixels // 12)
    if block.grid and pixels >= DRAWN:
        for axis, count in ((0, rows), (1, columns)):
            first = block.counted[axis]
            for k in range(1, count):
                number = abs(first + k) if first < 0 else first + k - 1
                colour = GRID if not first or number % 5 else FIFTH if number % 10 else TENTH
                wide = heavy if colour == TENTH else 1
                if axis == 0:
                    sheet[y + k * pixels : y + k * pixels + wide, x : x + columns * pixels] = colour
                else:
                    sheet[y : y + rows * pixels, x + k * pixels : x + k * pixels + wide] = colour
    if pixels >= DRAWN:
        sheet[y : y + heavy, x : x + columns * pixels] = TENTH
        sheet[y + rows * pixels : y + rows * pixels + heavy, x : x + columns * pixels + heavy] = TENTH
        sheet[y : y + rows * pixels, x : x + heavy] = TENTH
        sheet[y : y + rows * pixels, x + columns * pixels : x + columns * pixels + heavy] = TENTH


def _mark(draw: ImageDraw.ImageDraw, lines: np.ndarray, kind: str, pixels: int) -> None:
    colour = FACE if kind.endswith("face") else BACK
    wide = max(1, round(0.3 * pixels))
    rounded = np.rint(lines).astype(int).tolist()
    dashed = not kind.endswith("face") and pixels >= DRAWN
    if pixels >= DRAWN:
        for line in rounded:
            draw.line(line, fill="white", width=wide + 2 * max(1, pixels // 10))
    for line in rounded:
        for x0, y0, x1, y1 in _dashes(line, pixels) if dashed else (line,):
            draw.line((x0, y0, x1, y1), fill=colour, width=wide)


def _dashes(line: list[int], pixels: int) -> list[list[int]]:
    """A line across or down cut into pieces of half a cell; those of the back are dashed, for black prints."""
    x0, y0, x1, y1 = line
    along = max(abs(x1 - x0), abs(y1 - y0))
    step = max(pixels, 4)
    cuts = range(0, max(along, 1), step)
    across = x0 != x1
    return [
        [x0 + k, y0, x0 + min(k + step // 2, along), y1]
        if across
        else [x0, y0 + k, x1, y0 + min(k + step // 2, along)]
        for k in cuts
    ]


def _number(draw: ImageDraw.ImageDraw, block: Block, left: int, top: int, pixels: int) -> None:
    if block.numbers is None:
        return
    font = ImageFont.load_default(0.56 * pixels)
    for row, column in zip(*np.nonzero(block.numbers), strict=True):
        at = (left + (block.x + column + 0.5) * pixels, top + (block.y + row + 0.5) * pixels)
        draw.text(at, str(block.numbers[row, column]), fill="white", font=font, anchor="mm")


def _write(
    draw: ImageDraw.ImageDraw, chart: Chart, page: Page, per_mm: float, place: tuple[int, int, int]
) -> None:
    left, top, pixels = place
    notes, patches = furniture(chart, page)
    for patch in patches:
        x, y = patch.x * per_mm, patch.y * per_mm
        corner = x + max(patch.width * per_mm, 1), y + max(patch.height * per_mm, 1)
        draw.rectangle((x, y, *corner), fill=patch.fill, outline=TENTH if patch.edged else None)
    for note in notes:
        at, anchor = (note.x * per_mm, note.y * per_mm), "rs" if note.anchor == "end" else "ls"
        draw.text(at, note.text, fill=note.colour, font=_font(note.text, note.size * per_mm), anchor=anchor)
    height = min(max(0.62 * pixels, 1.4 * per_mm), 2.2 * per_mm)
    font = ImageFont.load_default(max(height, 6))
    anchors = {"start": "lm", "middle": "mm", "end": "rm"}
    for label in chart.labels if pixels >= DRAWN else ():
        if label.minor and page.cell < SMALL:
            continue
        at = left + label.x * pixels, top + label.y * pixels
        draw.text(at, label.text, fill=GREY, font=font, anchor=anchors[label.anchor])


def _font(text: str, size: float) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Pillow's own font, or one of the system's that has the letters of a Chinese title."""
    if any(ord(letter) > 0x2FF and letter not in "–·×…" for letter in text):
        for name in FONTS:
            try:
                return ImageFont.truetype(name, size)
            except OSError:
                continue
    return ImageFont.load_default(size)
