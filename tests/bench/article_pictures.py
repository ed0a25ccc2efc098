"""The drawings of the shipped articles, from the numbers that they tell, and the picture of the hall, made small.

python tests/bench/article_pictures.py
"""

import sys
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).parents[2]
ARTICLES = ROOT / "assets" / "articles"
PAPER, INK, QUIET, RED, CLOTH, UNDER = "#fbf8f1", "#201c1a", "#6b6055", "#9e2b25", "#eadfc8", "#d8c9a8"


def svg(wide: float, high: float, *parts: str) -> str:
    """A drawing so many units wide and high; labels are numbers alone, so that it serves both languages."""
    style = (
        f".i{{fill:none;stroke:{INK};stroke-width:2}}.d{{fill:none;stroke:{RED};stroke-width:2;stroke-dasharray:9 6}}"
        f".q{{fill:none;stroke:{QUIET};stroke-width:1}}.c{{fill:{CLOTH};stroke:{INK};stroke-width:2}}"
        f".u{{fill:{UNDER};stroke:{INK};stroke-width:2}}text{{font:20px Georgia,serif;fill:{INK};text-anchor:middle}}"
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide:g} {high:g}" width="{wide:g}" height="{high:g}">'
        f'<style>{style}</style><rect width="{wide:g}" height="{high:g}" fill="{PAPER}"/>{"".join(parts)}</svg>\n'
    )


def path(kind: str, *points: tuple[float, float], closed: bool = True) -> str:
    line = " ".join(f"{x:g},{y:g}" for x, y in points)
    return f'<{"polygon" if closed else "polyline"} class="{kind}" points="{line}"/>'


def label(x: float, y: float, words: object) -> str:
    return f'<text x="{x:g}" y="{y:g}">{words}</text>'


def span(x0: float, x1: float, y: float, words: object) -> str:
    """A measure with its two ends marked."""
    ends = "".join(path("q", (x, y - 7), (x, y + 7), closed=False) for x in (x0, x1))
    return path("q", (x0, y), (x1, y), closed=False) + ends + label((x0 + x1) / 2, y - 8, words)


def layout() -> str:
    """Four widths of 47.5 cm beside each other, folded at the shoulder; a body 48 cm wide below, the front open."""
    scale, left, top = 4.6, 63.0, 70.0
    width, sleeve, body, upper = 47.5 * scale, 29 * scale, 24 * scale, 56 * scale
    middle, parts = left + 2 * width, []
    for k in range(4):
        x = left + k * width
        parts.append(path("c", (x, top), (x + width, top), (x + width, top + sleeve), (x, top + sleeve)))
        parts.append(span(x, x + width, top - 18, "47.5"))
    parts.append(
        path(
            "c",
            (middle - body, top + sleeve),
            (middle - body, top + upper),
            (middle + body, top + upper),
            (middle + body, top + sleeve),
        )
    )
    parts.append(
        f'<rect x="{middle - body + 1:g}" y="{top + sleeve - 3:g}" width="{2 * body - 2:g}" height="6" fill="{CLOTH}"/>'
    )
    parts.append(path("d", (left, top), (left + 4 * width, top), closed=False))
    for x in (middle - width, middle, middle + width):
        parts.append(path("i", (x, top), (x, top + (upper if x == middle else sleeve)), closed=False))
    neck = 9 * scale
    parts.append(
        f'<polygon points="{middle - neck:g},{top:g} {middle:g},{top + 25 * scale:g} {middle + neck:g},{top:g}" '
        f'fill="{PAPER}" stroke="{INK}" stroke-width="2"/>'
    )
    parts.append(span(middle - body, middle, top + upper + 34, "24"))
    parts.append(span(middle, middle + body, top + upper + 34, "24"))
    parts.append(span(left, left + 4 * width, top + upper + 74, "190 cm"))
    return svg(1000, top + upper + 100, *parts)


def collars() -> str:
    """Both ways to cross a collar, seen from opposite."""

    def one(x: float, turn: int) -> str:
        def at(dx: float, y: float) -> tuple[float, float]:
            return x + turn * dx, y

        shoulders = path("u", at(-150, 90), at(-40, 50), at(40, 50), at(150, 90), at(150, 380), at(-150, 380))
        inner = path("c", at(-40, 50), at(-22, 50), at(60, 226), at(44, 240))  # ends beneath the outer front
        front = path("u", at(40, 50), at(150, 90), at(150, 380), at(-120, 380), at(-120, 330))
        outer = path("c", at(40, 50), at(62, 58), at(-100, 345), at(-120, 330))
        knot = f'<circle cx="{at(-122, 340)[0]:g}" cy="340" r="9" fill="{RED}"/>'
        mark = path("d", at(48, 62), at(-106, 336), closed=False) + path(
            "d", at(-30, 56), at(8, 128), closed=False
        )
        return shoulders + inner + front + outer + mark + knot

    letter = '<text style="font-size:64px;font-style:italic" y="440">y</text>'
    letters = (
        f'<g transform="translate(220)">{letter}</g><g transform="translate(580) scale(-1 1)">{letter}</g>'
    )
    return svg(800, 480, one(220, 1), one(580, -1), letters)


def pleats() -> str:
    """A piece of 220 cm with two doors of 38, and both pieces folded on a band of 126 as the article works it out."""
    scale, left = 4.1, 49.0
    door, high, piece = 38 * scale, 150.0, 220 * scale
    parts = [path("c", (left, 60), (left + piece, 60), (left + piece, 60 + high), (left, 60 + high))]
    for x in (left + door, left + piece - door):
        parts.append(path("i", (x, 60), (x, 60 + high), closed=False))
    field = piece - 2 * door
    for k in range(1, 12):
        x = left + door + k * field / 12
        parts.append(path("d" if k % 2 else "q", (x, 60), (x, 60 + high), closed=False))
    parts += [span(left, left + door, 42, 38), span(left + door, left + piece - door, 42, 144)]
    parts += [
        span(left + piece - door, left + piece, 42, 38),
        span(left, left + piece, 60 + high + 40, "220 cm"),
    ]
    top, bottom = 330.0, 620.0
    wide, step, flare = (
        7.0,
        6 * 7.0 / 6,
        1.9,
    )  # units a centimetre on the band, of a pleat, and how the hem spreads
    start = 500 - 126 * wide / 2
    at, hem = start, [500 + flare * 0.56 * (x - 500) for x in (start, start + 126 * wide)]
    edges = [38.0, *(1.0,) * 6, 38.0, *(1.0,) * 6, 38.0]
    shares = [38.0, *(8.0,) * 6, 38.0, *(8.0,) * 6, 38.0]
    below, total = hem[0], sum(shares)
    for edge, share in zip(edges, shares, strict=True):
        x1, b1 = at + edge * step, below + share / total * (hem[1] - hem[0])
        kind = "c" if edge > 1 else "u"
        parts.append(path(kind, (at, top), (x1, top), (b1, bottom), (below, bottom)))
        at, below = x1, b1
    parts.append(
        path("u", (start, top - 34), (start + 126 * wide, top - 34), (start + 126 * wide, top), (start, top))
    )
    parts.append(label(500, top - 11, "126 cm"))
    for x, words in ((start + 19 * wide, 38), (500, 38), (start + 107 * wide, 38)):
        parts.append(label(x, (top + bottom) / 2, words))
    for x in (start + 41 * wide, start + 85 * wide):
        parts.append(label(x, bottom + 28, "6 × 1"))
    return svg(1000, 665, *parts)


def main() -> int:
    drawings = {"narrow-cloth/media/layout.svg": layout(), "right-over-left/media/y.svg": collars()}
    drawings["pleats/media/plan.svg"] = pleats()
    for name, drawing in drawings.items():
        (ARTICLES / name).parent.mkdir(parents=True, exist_ok=True)
        (ARTICLES / name).write_text(drawing, "utf-8")
    hall = ARTICLES / "this-hall/media/hall.jpg"
    hall.parent.mkdir(parents=True, exist_ok=True)
    with Image.open(ROOT / "docs/pictures/hall.jpg") as picture:
        picture.resize((960, 540), Image.Resampling.LANCZOS).save(hall, quality=80, optimize=True)
    print(f"{len(drawings)} drawings, {hall.stat().st_size / 1000:.0f} kB of hall")
    return 0


if __name__ == "__main__":
    sys.exit(main())
