"""Drawings for the panels: a weave with its draft, the mirror's back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, log10

import numpy as np
from PIL import Image, ImageDraw, ImageFont

PAPER, INK, FAINT, ACCENT = "#f6f1e6", "#201c1a", "#b8ad9b", "#9e2b25"
OVER = 3  # drawn so many times larger, then reduced: smooth lines


@dataclass(frozen=True)
class View:
    """A square piece of cloth as it looks. picture: as large as one likes; across: [m] it is wide."""

    picture: Image.Image
    across: float


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


def weave_drawing(lift: np.ndarray, views: Sequence[View], *, repeats: int = 8) -> Image.Image:
    """Left the draft, lift (picks, ends) bool (filled: warp over), then pieces of the cloth, each with a scale bar."""
    sheet = Sheet((1200, 640))
    count = 1 + len(views)
    gap = 36
    side = min(480, (1200 - 2 * 50 - (count - 1) * gap) // count)
    left, top = (1200 - count * side - (count - 1) * gap) // 2, (620 - side) // 2
    cell = side / repeats
    picks, ends = lift.shape
    for row in range(repeats):
        for column in range(repeats):
            filled = bool(lift[row % picks, column % ends])
            x, y = left + column * cell, top + (repeats - 1 - row) * cell
            sheet.box((x, y, x + cell, y + cell), INK if filled else None, FAINT)
    sheet.box((left, top, left + side, top + side), None, INK)
    for number, view in enumerate(views, 1):
        x = left + number * (side + gap)
        piece = view.picture.resize((side * OVER, side * OVER), Image.Resampling.LANCZOS)
        sheet.image.paste(piece, (x * OVER, top * OVER))
        length = _round_length(view.across / 3)
        bar = side * length / view.across
        sheet.line([(x, top + side + 26), (x + bar, top + side + 26)], INK, 3)
        told = f"{length * 1e3:g} mm" if length < 0.01 else f"{length * 1e2:g} cm"
        sheet.words(x + bar + 12, top + side + 26, told, anchor="lm")
    return sheet.finished()


def _round_length(length: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is no longer."""
    power = 10.0 ** floor(log10(length))
    return max(step * power for step in (1, 2, 5) if step * power <= length * (1 + 1e-9))


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
