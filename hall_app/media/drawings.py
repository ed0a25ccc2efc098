"""Drawings for the panels: a weave with its draft, the mirror's back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw, ImageFont

PAPER, INK, FAINT, ACCENT = "#f6f1e6", "#201c1a", "#b8ad9b", "#9e2b25"
OVER = 3  # drawn so many times larger, then reduced: smooth lines


@dataclass(frozen=True)
class Interlacing:
    """What a weave's picture needs.

    lift: (picks, ends) bool, True where the warp passes over; spacing: of ends and picks [m]; width: of warp
    and weft yarn as seen from above [m]; colours: of warp and weft, "#rrggbb".
    """

    lift: np.ndarray
    spacing: tuple[float, float]
    width: tuple[float, float]
    colours: tuple[str, str]


class Sheet:
    """A sheet of paper of `size` pixels with lines and figures that scale with the supersampling."""

    def __init__(self, size: tuple[int, int]) -> None:
        self.size = size
        self.image = Image.new("RGB", (size[0] * OVER, size[1] * OVER), PAPER)
        self.pen = ImageDraw.Draw(self.image)

    def box(self, corners: Sequence[float], fill: str | None = None, outline: str | None = None) -> None:
        self.pen.rectangle([OVER * c for c in corners], fill=fill, outline=outline, width=OVER)

    def line(self, points: Sequence[tuple[float, float]], fill: str = INK, width: float = 1.5) -> None:
        flat = [(OVER * x, OVER * y) for x, y in points]
        self.pen.line(flat, fill=fill, width=max(1, round(OVER * width)), joint="curve")

    def words(
        self, x: float, y: float, text: str, *, size: int = 22, anchor: str = "mm", fill: str = INK
    ) -> None:
        font = ImageFont.load_default(size * OVER)
        self.pen.text((OVER * x, OVER * y), text, fill=fill, font=font, anchor=anchor)

    def measure(self, start: tuple[float, float], end: tuple[float, float], text: str) -> None:
        """A dimension line with end marks and its figure, horizontal or upright."""
        (x0, y0), (x1, y1) = start, end
        self.line([start, end], ACCENT, 1.2)
        flat = abs(x1 - x0) > abs(y1 - y0)
        for x, y in (start, end):
            self.line([(x, y - 9), (x, y + 9)] if flat else [(x - 9, y), (x + 9, y)], ACCENT, 1.2)
        place = ((x0 + x1) / 2, y0 - 20) if flat else (x0 + 16, (y0 + y1) / 2)
        self.words(*place, text, anchor="mm" if flat else "lm", fill=ACCENT)

    def finished(self) -> Image.Image:
        """The sheet at its true size."""
        return self.image.resize(self.size, Image.Resampling.LANCZOS)


def weave_drawing(weave: Interlacing, *, repeats: int = 8) -> Image.Image:
    """Left the draft (filled: warp over), right the cloth enlarged in true proportion with a scale bar."""
    sheet = Sheet((1200, 640))
    picks, ends = weave.lift.shape
    cell, left, top = 480 / repeats, 70, 70
    for row in range(repeats):
        for column in range(repeats):
            filled = bool(weave.lift[row % picks, column % ends])
            x, y = left + column * cell, top + (repeats - 1 - row) * cell
            sheet.box((x, y, x + cell, y + cell), INK if filled else None, FAINT)
    sheet.box((left, top, left + 480, top + 480), None, INK)
    _cloth(sheet, weave, (640, top, 1130, top + 480))
    return sheet.finished()


def _cloth(sheet: Sheet, weave: Interlacing, frame: tuple[float, float, float, float]) -> None:
    x0, y0, x1, y1 = frame
    scale = (x1 - x0) / (8 * max(weave.spacing))  # [pixels/m]
    step = [spacing * scale for spacing in weave.spacing]
    width = [min(yarn * scale, 0.96 * gap) for yarn, gap in zip(weave.width, step, strict=True)]
    columns, rows = int((x1 - x0) / step[0] + 1e-6), int((y1 - y0) / step[1] + 1e-6)
    right, low = x0 + columns * step[0], y0 + rows * step[1]
    sheet.box((x0, y0, right, low), "#3d4a52")
    for over in (False, True):  # the whole weft first, then the warp where it lies on top
        for row in range(rows):
            y = y0 + (row + 0.5) * step[1]
            if not over:
                _yarn(sheet, (x0, y - width[1] / 2, right, y + width[1] / 2), weave.colours[1], flat=True)
        for column in range(columns):
            x = x0 + (column + 0.5) * step[0]
            for row in range(rows):
                pick = rows - 1 - row  # as in the draft: the first pick lies lowest
                lifted = bool(weave.lift[pick % weave.lift.shape[0], column % weave.lift.shape[1]])
                top, bottom = y0 + row * step[1], y0 + (row + 1) * step[1]
                if over and lifted:
                    _yarn(
                        sheet, (x - width[0] / 2, top, x + width[0] / 2, bottom), weave.colours[0], flat=False
                    )
                elif not over and not lifted:
                    gap = (step[1] - width[1]) / 2
                    for a, b in ((top, top + gap), (bottom - gap, bottom)):
                        _yarn(sheet, (x - width[0] / 2, a, x + width[0] / 2, b), weave.colours[0], flat=False)
    bar = 0.5e-3 * scale
    sheet.line([(x0, low + 26), (x0 + bar, low + 26)], INK, 3)
    sheet.words(x0 + bar + 12, low + 26, "0.5 mm", anchor="lm")


def _yarn(sheet: Sheet, box: tuple[float, float, float, float], colour: str, *, flat: bool) -> None:
    """A piece of yarn, darker to both its edges."""
    x0, y0, x1, y1 = box
    base = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)])
    bands = 9
    for band in range(bands):
        light = 1 - 0.42 * (2 * (band + 0.5) / bands - 1) ** 2
        tone = "#" + "".join(f"{int(value * light):02x}" for value in base)
        a, b = band / bands, (band + 1) / bands
        piece = (x0, y0 + a * (y1 - y0), x1, y0 + b * (y1 - y0))
        sheet.box(piece if flat else (x0 + a * (x1 - x0), y0, x0 + b * (x1 - x0), y1), tone)


def mirror_drawing() -> Image.Image:
    """The mirror's back in line: ink where its relief is steep, with the diameter."""
    from hall_app.media.foreign import RADIUS, back_height

    size, span = 1000, 1.25 * RADIUS
    axis = np.linspace(-span, span, size * 2)
    x, y = np.meshgrid(axis, axis)
    radius = np.hypot(x, y)
    height = np.where(radius <= RADIUS, back_height(radius, np.arctan2(y, x)), 0.0)
    down, across = np.gradient(height, axis, axis)
    ink = np.clip(np.hypot(down, across) / 0.55 - 0.18, 0, 1)[:, :, None] ** 0.8
    paper, line = (np.array([int(c[k : k + 2], 16) for k in (1, 3, 5)], float) for c in (PAPER, INK))
    disc = np.array([240.0, 232.0, 214.0])
    ground = np.where((radius <= RADIUS)[:, :, None], disc, paper)
    picture = Image.fromarray((ground * (1 - ink) + line * ink).astype(np.uint8))
    sheet = Sheet((size, size))
    sheet.image.paste(picture.resize(sheet.image.size, Image.Resampling.LANCZOS))
    edge = size / 2 * RADIUS / span
    low = size / 2 + edge + 44
    sheet.measure((size / 2 - edge, low), (size / 2 + edge, low), f"{2 * RADIUS * 1000:.0f} mm")
    return sheet.finished()
