"""A picture of a pattern sheet: every piece with its name, cutting and sewing line, notches, grain and inner lines."""

import numpy as np
import shapely

from sim_core.mesh.sheets.model import Sheet

__all__ = ["sheet_picture"]

WIDE = 1600  # [px]
MOST_HIGH = 2400
CUT, SEW, LINE, NOTCH, GRAIN, HOLE, INK = (
    (40, 40, 40), (30, 90, 190), (150, 150, 150), (200, 40, 40), (20, 130, 70), (170, 90, 20), (20, 20, 20),
)  # fmt: skip
CLOTH = (247, 243, 234)


def sheet_picture(sheet: Sheet) -> np.ndarray:
    """The pieces where they lie on the sheet, (n, m, 3) uint8; black: cutting line, blue: sewing line, grey: inner
    lines, brown: holes, red: notches, green: grain."""
    from PIL import Image, ImageDraw, ImageFont

    points = np.concatenate([piece.outline for piece in sheet.pieces])
    low, size = points.min(axis=0), np.maximum(np.ptp(points, axis=0), 1e-6)
    scale = min((WIDE - 80) / size[0], (MOST_HIGH - 80) / size[1])
    height = int(size[1] * scale) + 80
    image = Image.new("RGB", (WIDE, height), (255, 255, 255))
    pen = ImageDraw.Draw(image)
    font = ImageFont.load_default(18)

    def at(line: np.ndarray) -> list[tuple[float, float]]:
        return [(float(x), float(y)) for x, y in (line - low) * scale + 40]

    for piece in sheet.pieces:
        pen.polygon(at(piece.outline), fill=CLOTH)
    for piece in sheet.pieces:
        for line in piece.lines:
            pen.line(at(line), fill=LINE, width=2)
        for line, colour in ((piece.sew, SEW), (piece.cut, CUT), *((hole, HOLE) for hole in piece.holes)):
            if line is not None:
                pen.line(at(np.vstack([line, line[:1]])), fill=colour, width=2)
        if piece.grain is not None:
            _arrow(pen, np.array(at(piece.grain)))
        for x, y in at(piece.notches):
            pen.polygon([(x, y - 7), (x - 6, y + 5), (x + 6, y + 5)], fill=NOTCH)
        middle = shapely.point_on_surface(shapely.make_valid(shapely.Polygon(at(piece.outline))))
        x, y = middle.x, middle.y
        width, tall = 1000 * np.ptp(piece.outline, axis=0)
        text = f"{piece.name}\n{width:.0f} x {tall:.0f} mm"
        pen.multiline_text((x, y), text, fill=INK, font=font, anchor="mm", align="center")
    return np.asarray(image)


def _arrow(pen, ends: np.ndarray) -> None:
    """A line with a head at both ends. ends: (2, 2) [px]."""
    pen.line([tuple(end) for end in ends], fill=GRAIN, width=2)
    along = (ends[1] - ends[0]) / max(np.hypot(*(ends[1] - ends[0])), 1e-9) * 14
    side = np.array([-along[1], along[0]]) / 3
    for end, back in ((ends[0], along), (ends[1], -along)):
        pen.polygon([tuple(end), tuple(end + back + side), tuple(end + back - side)], fill=GRAIN)
