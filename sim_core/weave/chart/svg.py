"""A drawing as SVG, in millimetres, to print: cells as vectors, texts as texts."""

from __future__ import annotations

from xml.sax.saxutils import escape

import numpy as np

from sim_core.weave.chart.furniture import Patch, furniture
from sim_core.weave.chart.paper import SMALL, Page
from sim_core.weave.chart.values import BACK, FACE, REPEAT, Block, Chart

__all__ = ["svg_of"]

FONT = "Helvetica, Arial, 'Noto Sans', 'Noto Sans CJK SC', sans-serif"
GRID, FIFTH, TENTH = "#d3d7dc", "#a7adb5", "#6d747d"
WRITTEN = 3.0  # cells [mm] from which numbers are written into them


def svg_of(chart: Chart, page: Page) -> str:
    """The drawing on its page."""
    notes, patches = furniture(chart, page)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{page.width:g}mm" height="{page.height:g}mm" '
        f'viewBox="0 0 {page.width:g} {page.height:g}" font-family="{FONT}" fill="#1f2328">',
        f"<title>{escape(chart.title)}</title>",
        # a browser prints on this sheet, at its size, instead of cutting the drawing at the paper it is set to
        f"<style>@page {{ size: {page.width:g}mm {page.height:g}mm; margin: 0 }}</style>",
        '<rect width="100%" height="100%" fill="#fff"/>',
        *(_patch(patch) for patch in patches),
        *(
            _text(
                n.x, n.y, n.text, n.size, n.anchor, f'fill="{_hex(n.colour)}"' + ' font-weight="600"' * n.bold
            )
            for n in notes
        ),
        f'<g transform="translate({page.left:g} {page.top:g}) scale({page.cell:.6g})">',
        *(part for block in chart.blocks for part in _block(block, page.cell)),
        *_repeats(chart.repeats, page.cell),
        *(_line(kind, rows) for kind, rows in chart.lines if len(rows)),
    ]
    height = min(max(0.62, 1.4 / page.cell), 2.2 / page.cell)
    for label in chart.labels:
        if page.cell >= SMALL or not label.minor:
            parts.append(_text(label.x, label.y + 0.36 * height, label.text, height, label.anchor))
    return "\n".join([*parts, "</g>", "</svg>", ""])


def _text(x: float, y: float, text: str, size: float, anchor: str, more: str = "") -> str:
    return f'<text x="{x:.4g}" y="{y:.4g}" font-size="{size:.3g}" text-anchor="{anchor}" {more}>{escape(text)}</text>'


def _hex(colour: tuple[int, int, int]) -> str:
    return "#{:02x}{:02x}{:02x}".format(*colour)


def _patch(patch: Patch) -> str:
    fill = _hex(patch.fill) if patch.fill else "none"
    edge = f' stroke="{TENTH}" stroke-width=".15"' if patch.edged else ""
    return (
        f'<rect x="{patch.x:.5g}" y="{patch.y:.5g}" width="{patch.width:.4g}" height="{patch.height:.4g}" '
        f'fill="{fill}"{edge}/>'
    )


def _repeats(rows: np.ndarray, cell: float):
    """Lines between repeats."""
    if len(rows):
        path = "".join(f"M{a:.6g} {b:.6g}L{c:.6g} {d:.6g}" for a, b, c, d in rows.tolist())
        yield (
            f'<g fill="none"><title>repeats</title><path d="{path}" stroke="{_hex(REPEAT)}" '
            f'stroke-width="{0.4 / cell:.3g}"/></g>'
        )


def _block(block: Block, cell: float):
    """Runs of cells of one colour as lines as wide as a cell, then the lines between cells, then the numbers."""
    rows, columns = block.cells.shape
    yield f'<g transform="translate({block.x:g} {block.y:g})"><title>{block.name}</title>'
    for number in np.unique(block.cells):
        if number:
            red, green, blue = block.colours[number].tolist()
            path = _runs(block.cells == number)
            yield (
                f'<path d="{path}" stroke="#{red:02x}{green:02x}{blue:02x}" stroke-width="1" fill="none" '
                'shape-rendering="crispEdges"/>'
            )
    if block.grid:
        yield from _grid(block, cell)
    yield (
        f'<rect width="{columns}" height="{rows}" fill="none" stroke="{TENTH}" stroke-width="{0.18 / cell:.3g}"/>'
    )
    if block.numbers is not None and cell >= WRITTEN:
        for row, column in zip(*np.nonzero(block.numbers), strict=True):
            yield _text(
                column + 0.5, row + 0.7, str(block.numbers[row, column]), 0.56, "middle", 'fill="#fff"'
            )
    yield "</g>"


def _runs(on: np.ndarray) -> str:
    """One path through the middle of all runs, row by row, in steps from run to run."""
    edges = np.diff(np.pad(on.astype(np.int8), ((0, 0), (1, 1))), axis=1)
    row, begin = np.nonzero(edges == 1)
    end = np.nonzero(edges == -1)[1]
    parts, last = [], -1
    x = 0
    for y, b, e in zip(row.tolist(), begin.tolist(), end.tolist(), strict=True):
        parts.append(f"M{b} {y}.5h{e - b}" if y != last else f"m{b - x} 0h{e - b}")
        last, x = y, e
    return "".join(parts)


def _grid(block: Block, cell: float):
    """Lines between cells; a heavier one after every fifth and tenth yarn, counted as the yarns are."""
    rows, columns = block.cells.shape
    layers: dict[str, list[str]] = {GRID: [], FIFTH: [], TENTH: []}
    for count, first, along, form in (
        (rows, block.counted[0], columns, "M0 {}h{}"),
        (columns, block.counted[1], rows, "M{} 0v{}"),
    ):
        for k in range(1, count):
            number = abs(first + k) if first < 0 else first + k - 1  # yarns passed before this line
            colour = GRID if not first or number % 5 else FIFTH if number % 10 else TENTH
            if colour != GRID or cell >= SMALL:
                layers[colour].append(form.format(k, along))
    for colour, paths in layers.items():
        if paths:
            width = {GRID: 0.06, FIFTH: 0.1, TENTH: 0.16}[colour] / cell
            yield f'<path d="{"".join(paths)}" stroke="{colour}" stroke-width="{width:.3g}" fill="none"/>'


def _line(kind: str, rows: np.ndarray) -> str:
    """Long floats, cased in white so that they can be seen on any colour; those of the back dashed."""
    path = "".join(f"M{a:.6g} {b:.6g}L{c:.6g} {d:.6g}" for a, b, c, d in rows.tolist())
    face = kind.endswith("face")
    dashed = "" if face else ' stroke-dasharray=".5 .55"'
    return (
        f'<g fill="none" stroke-linecap="round"><title>{kind} floats</title><path d="{path}" stroke="#fff" '
        f'stroke-width=".5"/><path d="{path}" stroke="{_hex(FACE if face else BACK)}" stroke-width=".3"{dashed}/></g>'
    )
