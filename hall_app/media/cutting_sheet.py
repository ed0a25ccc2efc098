"""A cutting plan as sheets: SVG at true size, to print or to show, and a picture."""

from __future__ import annotations

from xml.sax.saxutils import escape

from PIL import Image

from hall_app.media.cutting_plan import ACCENT, FAINT, INK, Plan, Stroke, Words
from hall_app.media.drawings import OVER, Sheet

__all__ = ["plan_picture", "plan_svg"]

FONT = "'Noto Sans', 'Noto Sans CJK SC', 'PingFang SC', 'Microsoft YaHei', Helvetica, Arial, sans-serif"
PAGE = "#f6f1e6"
LONGEST = 1500  # [pixels] of a picture's longer side
THICK = 700  # the sheet's longer side is so many times an outline's stroke
COLOURS = {"outline": INK, "fold": FAINT, "measure": ACCENT, "grain": FAINT, "tie": ACCENT}
THIN = {"outline": 1.0, "fold": 0.8, "measure": 0.5, "grain": 0.8, "tie": 0.8}  # of an outline's stroke


def plan_svg(plan: Plan) -> str:
    """The drawing at true size: a millimetre of cloth is one of the sheet."""
    width, height = plan.size
    pen = max(plan.size) / THICK
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.1f}mm" height="{height:.1f}mm" '
        f'viewBox="0 0 {width:.1f} {height:.1f}" font-family="{FONT}">',
        f"<title>{escape(' '.join(plan.title))}</title>",
        f'<rect width="100%" height="100%" fill="{PAGE}"/>',
        *(_path(stroke, pen) for stroke in plan.strokes),
        *(_text(words) for words in plan.words),
        "</svg>",
        "",
    ]
    return "\n".join(parts)


def _path(stroke: Stroke, pen: float) -> str:
    way = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in stroke.points) + "Z" * (stroke.kind == "outline")
    dashed = f' stroke-dasharray="{6 * pen:.1f} {4 * pen:.1f}"' if stroke.kind == "fold" else ""
    return (
        f'<path class="{stroke.kind}" d="{way}" fill="{stroke.fill or "none"}" stroke="{COLOURS[stroke.kind]}" '
        f'stroke-width="{pen * THIN[stroke.kind]:.2f}"{dashed}/>'
    )


def _text(words: Words) -> str:
    turned = f' transform="rotate(-90 {words.x:.1f} {words.y:.1f})"' if words.upright else ""
    return (
        f'<text x="{words.x:.1f}" y="{words.y:.1f}" font-size="{words.size:.1f}" text-anchor="{words.anchor}" '
        f'fill="{words.colour}"{turned}>{escape(words.text)}</text>'
    )


def plan_picture(plan: Plan) -> Image.Image:
    """The drawing as a picture, its words without Chinese letters: no font of the machine is asked for."""
    scale = LONGEST / max(plan.size)
    sheet = Sheet((round(plan.size[0] * scale), round(plan.size[1] * scale)))
    pen = LONGEST / THICK
    for stroke in plan.strokes:
        points = [(float(x) * scale, float(y) * scale) for x, y in stroke.points]
        if stroke.kind == "outline":
            points.append(points[0])
            sheet.pen.polygon([(OVER * x, OVER * y) for x, y in points], fill=stroke.fill)
        for line in _dashes(points) if stroke.kind == "fold" else [points]:
            sheet.line(line, COLOURS[stroke.kind], pen * THIN[stroke.kind])
    anchors = {"start": "ls", "middle": "ms"}
    for words in plan.words:
        # Pillow turns no words: an upright figure stands beside its line.
        anchor = "rm" if words.upright else anchors[words.anchor]
        size = max(8, round(words.size * scale))
        sheet.words(
            words.x * scale,
            words.y * scale,
            words.text if words.latin is None else words.latin,
            size=size,
            anchor=anchor,
            fill=words.colour,
        )
    return sheet.finished()


def _dashes(points: list[tuple[float, float]]) -> list[list[tuple[float, float]]]:
    """A straight line in pieces of 12 pixels, 8 apart."""
    (x0, y0), (x1, y1) = points
    length = max(((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5, 1e-9)
    pieces = []
    for begin in range(0, int(length), 20):
        ends = (begin / length, min(begin + 12.0, length) / length)
        pieces.append([(x0 + share * (x1 - x0), y0 + share * (y1 - y0)) for share in ends])
    return pieces
