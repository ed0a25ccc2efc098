"""A picture of a pattern sheet: every piece with its name, cutting and sewing line, notches, grain, fold and holes."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import shapely

from sim_core.mesh.sheets.model import Piece, Sheet

__all__ = ["apart", "sheet_picture"]

WIDE = 1600  # [px]
MOST_HIGH = 2400
MARGIN = 40
OVERSAMPLE = 2
CUT, SEW, LINE, NOTCH, GRAIN, HOLE, INK = (
    (40, 40, 40), (30, 90, 190), (160, 160, 160), (200, 40, 40), (20, 130, 70), (170, 90, 20), (20, 20, 20),
)  # fmt: skip
CLOTH, PAPER = (247, 243, 234), (255, 255, 255)
LETTERS = 20  # [px] high
MOST_MOVES, MOST_NAMES = 4, 60  # of a name that others stand in the way of
DASH = 9  # [px] of a fold line
OVERLAP = 0.2  # of the smaller one's area: pieces that lie on each other more than this are laid apart
GAP = 0.03  # [m] between pieces laid apart
FONTS = ("NotoSansCJK-Regular.ttc", "SourceHanSansSC-Regular.otf", "wqy-zenhei.ttc", "DejaVuSans.ttf")


def sheet_picture(sheet: Sheet) -> np.ndarray:
    """The pieces where they lie on the sheet, laid apart where they lie on each other; (n, m, 3) uint8.

    Black: cutting line, blue: sewing line, grey: inner lines, brown: holes, red: notches, green: grain, red and dashed:
    the fold that half a piece is cut on.
    """
    from PIL import Image, ImageDraw

    pieces = apart(sheet.pieces)
    points = np.concatenate([piece.outline for piece in pieces])
    low, size = points.min(axis=0), np.maximum(np.ptp(points, axis=0), 1e-6)
    scale = OVERSAMPLE * min((WIDE - 2 * MARGIN) / size[0], (MOST_HIGH - 2 * MARGIN) / size[1])
    width, height = (int(v) + 2 * MARGIN * OVERSAMPLE for v in size * scale)
    image = Image.new("RGB", (width, height), PAPER)
    pen = ImageDraw.Draw(image)
    placed = [_scaled(piece, low, scale) for piece in pieces]
    for piece in placed:
        pen.polygon(_pairs(piece.outline), fill=CLOTH)
    for piece in placed:
        _draw_lines(pen, piece)
    font = _font("".join(piece.name for piece in pieces))
    taken: list[tuple[float, float, float, float]] = []
    for piece, drawn in zip(pieces, placed, strict=True):
        wide, tall = 1000 * np.ptp(piece.outline, axis=0)
        _write_name(pen, drawn, f"{piece.name}\n{wide:.0f} x {tall:.0f} mm", font, taken)
    return np.asarray(image.resize((width // OVERSAMPLE, height // OVERSAMPLE), Image.Resampling.LANCZOS))


def apart(pieces: tuple[Piece, ...]) -> list[Piece]:
    """Pieces as they lie, or in rows where some lie on each other, as sizes of one piece do."""
    shapes = [shapely.make_valid(shapely.Polygon(piece.outline)) for piece in pieces]
    if not _lie_on_each_other(shapes):
        return list(pieces)
    sizes = np.array([np.ptp(piece.outline, axis=0) for piece in pieces]) + GAP
    across = max(float(sizes[:, 0].max()), 1.4 * float(np.sqrt(sizes.prod(axis=1).sum())))
    x = y = tall = 0.0
    laid = []
    for piece, (wide, high) in zip(pieces, sizes.tolist(), strict=True):
        if x and x + wide > across:
            x, y, tall = 0.0, y + tall, 0.0
        laid.append(_scaled(piece, piece.outline.min(axis=0) - (x, y), 1.0))
        x, tall = x + wide, max(tall, high)
    return laid


def _lie_on_each_other(shapes: list) -> bool:
    """Whether two areas share more than a little; looked at one by one, since the first such pair decides."""
    every = np.array(shapes, object)
    areas = shapely.area(every)
    tree = shapely.STRtree(every)
    for k, shape in enumerate(shapes):
        others = tree.query(shape, predicate="intersects")
        others = others[(others > k) & (np.minimum(areas[others], areas[k]) > 0)]
        shared = shapely.area(shapely.intersection(shape, every[others]))
        if (shared > OVERLAP * np.minimum(areas[others], areas[k])).any():
            return True
    return False


def _scaled(piece: Piece, low: np.ndarray, scale: float) -> Piece:
    """The piece with all its lines moved and enlarged; scale 1: moved only."""
    shift = MARGIN * OVERSAMPLE if scale != 1.0 else 0.0

    def at(line: np.ndarray | None) -> np.ndarray | None:
        return None if line is None else (line - low) * scale + shift

    many = {
        key: tuple((line - low) * scale + shift for line in getattr(piece, key)) for key in ("holes", "lines")
    }
    notches = (piece.notches - low) * scale + shift
    return replace(
        piece,
        cut=at(piece.cut),
        sew=at(piece.sew),
        grain=at(piece.grain),
        fold=at(piece.fold),
        notches=notches,
        **many,
    )


def _pairs(line: np.ndarray) -> list[tuple[float, float]]:
    return [(float(x), float(y)) for x, y in line]


def _draw_lines(pen, piece: Piece) -> None:
    """All lines and marks of a piece in pixels."""
    thick = 2 * OVERSAMPLE
    for line in piece.lines:
        pen.line(_pairs(line), fill=LINE, width=OVERSAMPLE)
    for line, colour in ((piece.sew, SEW), (piece.cut, CUT), *((hole, HOLE) for hole in piece.holes)):
        if line is not None:
            pen.line(_pairs(np.vstack([line, line[:2]])), fill=colour, width=thick, joint="curve")
    if piece.fold is not None:
        _dashed(pen, piece.fold)
    if piece.grain is not None:
        _arrow(pen, piece.grain)
    for place in piece.notches:
        _notch(pen, place, piece)


def _notch(pen, place: np.ndarray, piece: Piece) -> None:
    """A small triangle that stands on the outline and points into the piece."""
    ring = np.vstack([piece.outline, piece.outline[:1]])
    a, along = ring[:-1], np.diff(ring, axis=0)
    square = np.maximum((along * along).sum(axis=1), 1e-12)
    share = np.clip(((place - a) * along).sum(axis=1) / square, 0, 1)
    away = np.hypot(*(place - a - share[:, None] * along).T)
    k = int(away.argmin())
    side = along[k] / np.sqrt(square[k]) * 6 * OVERSAMPLE
    foot = a[k] + share[k] * along[k] if away[k] < 40 * OVERSAMPLE else place
    inward = np.array([-side[1], side[0]]) * 2
    if not shapely.contains_xy(shapely.Polygon(piece.outline).buffer(0), *(foot + 0.3 * inward)):
        inward = -inward
    pen.polygon(_pairs(np.array([foot - side, foot + side, foot + inward])), fill=NOTCH)


def _dashed(pen, ends: np.ndarray) -> None:
    """A line in dashes. ends: (2, 2) [px]."""
    length = float(np.hypot(*(ends[1] - ends[0])))
    marks = np.arange(0, length, DASH * OVERSAMPLE)
    steps = np.append(marks, length) / max(length, 1e-9)
    for k, (a, b) in enumerate(pairwise(steps.tolist())):
        if k % 2 == 0:
            line = np.array([ends[0] + t * (ends[1] - ends[0]) for t in (a, b)])
            pen.line(_pairs(line), fill=NOTCH, width=2 * OVERSAMPLE)


def _arrow(pen, ends: np.ndarray) -> None:
    """A line with a head at both ends. ends: (2, 2) [px]."""
    pen.line(_pairs(ends), fill=GRAIN, width=2 * OVERSAMPLE)
    along = (ends[1] - ends[0]) / max(np.hypot(*(ends[1] - ends[0])), 1e-9) * 14 * OVERSAMPLE
    side = np.array([-along[1], along[0]]) / 3
    for end, back in ((ends[0], along), (ends[1], -along)):
        pen.polygon(_pairs(np.array([end, end + back + side, end + back - side])), fill=GRAIN)


def _font(text: str):
    """A font with the signs of a text, where the system has one; Pillow's own has Latin letters only."""
    from PIL import ImageFont

    for name in FONTS if not text.isascii() else ():
        try:
            return ImageFont.truetype(name, LETTERS * OVERSAMPLE)
        except OSError:
            continue
    return ImageFont.load_default(LETTERS * OVERSAMPLE)


def _write_name(pen, piece: Piece, text: str, font, taken: list[tuple[float, float, float, float]]) -> None:
    """The name inside the piece, beside its grain and below names that stand there already; a low piece has it behind
    its end."""
    low, high = piece.outline.min(axis=0), piece.outline.max(axis=0)
    if high[1] - low[1] < 4 * LETTERS * OVERSAMPLE < high[0] - low[0]:
        place = (high[0] + 10 * OVERSAMPLE, (low[1] + high[1]) / 2)
        pen.text(place, text.replace("\n", "  "), fill=INK, font=font, anchor="lm")
        return
    shape = shapely.make_valid(shapely.Polygon(piece.outline))
    middle = shapely.point_on_surface(shape)
    x, y = middle.x, middle.y
    left, top, right, bottom = pen.multiline_textbbox((x, y), text, font=font, anchor="mm", align="center")
    if (
        piece.grain is not None
        and (left < piece.grain[:, 0].mean() < right)
        and np.ptp(piece.grain[:, 0]) < 20
    ):
        gap = piece.grain[:, 0].mean() + 8 * OVERSAMPLE - left
        fits = shapely.contains_xy(shape, right + gap, y)
        x, left, right = (x + gap, left + gap, right + gap) if fits else (x, left, right)
    tall = bottom - top
    if piece.grain is not None and np.ptp(piece.grain[:, 1]) < 20 and top < piece.grain[0, 1] < bottom:
        gap = piece.grain[:, 1].max() + 8 * OVERSAMPLE - top
        y, top, bottom = y + gap, top + gap, bottom + gap
    for _ in range(MOST_MOVES):
        if not any(left < r and right > a and top < b and bottom > t for a, t, r, b in taken[-MOST_NAMES:]):
            break
        y, top, bottom = y + tall, top + tall, bottom + tall
    taken.append((left, top, right, bottom))
    pen.multiline_text(
        (x, y),
        text,
        fill=INK,
        font=font,
        anchor="mm",
        align="center",
        stroke_width=2 * OVERSAMPLE,
        stroke_fill=CLOTH,
    )
