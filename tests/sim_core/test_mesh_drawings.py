"""Outlines from SVG and DXF: shapes, units, transforms, curves, and files that are none."""

import json

import numpy as np
import pytest

from sim_core import cli
from sim_core.errors import FileProblem, OutlineWarning
from sim_core.mesh.outline import read_size_field, signed_area
from sim_core.mesh.sheets import read_outline

HEAD = '<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="300mm" viewBox="0 0 200 300">'


def svg(tmp_path, body: str, head: str = HEAD):
    path = tmp_path / "drawing.svg"
    path.write_text(head + body + "</svg>")
    return read_outline(path)


def area(contour) -> float:
    return abs(signed_area(np.asarray(contour)))


CIRCLE = np.pi * 0.05**2
SHAPES = {
    '<rect x="10" y="20" width="100" height="50"/>': 0.005,
    '<path d="M10 20h100v50h-100z"/>': 0.005,
    '<path d="M 10,20 L 110,20 110,70 10,70 Z"/>': 0.005,
    '<polygon points="10,20 110,20 110,70 10,70"/>': 0.005,
    '<g transform="translate(5,5) rotate(30) scale(2)"><rect width="50" height="25"/></g>': 0.005,
    '<rect width="50" height="25" transform="matrix(0 2 -2 0 7 7)"/>': 0.005,
    '<circle cx="60" cy="60" r="50"/>': CIRCLE,
    '<ellipse cx="60" cy="60" rx="100" ry="25"/>': CIRCLE,
    '<path d="M10,60 a50,50 0 1 0 100,0 a50,50 0 1 0 -100,0 z"/>': CIRCLE,
    '<path d="M10,60 A50,50 0 0 1 110,60 A50 50 0 0 1 10 60Z"/>': CIRCLE,
    '<path d="M0,0 Q100,0 100,100 T200,200 L0,200 z"/>': 0.02,
    '<path d="M10 60a50 50 0 11100 0a50 50 0 1 1-100 0z"/>': CIRCLE,
    '<path d="M10,60 a50,50,0,1,0,100,0 50 50 0 10-100,0z"/>': CIRCLE,
    '<path d="M10 20 H110 V70 H10 L10 20"/>': 0.005,
    '<polyline points="10,20 110,20 110,70 10,70 10,20"/>': 0.005,
    '<rect x="10" width="100" height="100" rx="50"/>': CIRCLE,
    '<rect width="100" height="50" rx="10" ry="5"/>': 0.005 - (4 - np.pi) * 5e-5,
    '<path d="M0,0 C50,0 50,0 100,0 S 100,50 100,100 L 0 100 z"/>': 0.011125,
}


@pytest.mark.parametrize("body", SHAPES)
def test_svg_shapes_have_their_area(tmp_path, body):
    drawing = svg(tmp_path, body)
    assert area(drawing.outline) == pytest.approx(SHAPES[body], rel=1e-3)
    assert drawing.holes == []
    assert drawing.constraints == []


def test_svg_sorts_outline_holes_and_lines_and_leaves_out_definitions(tmp_path):
    drawing = svg(
        tmp_path,
        '<defs><rect width="190" height="290"/></defs><circle cx="50" cy="50" r="10"/><rect width="100" height="100"/>'
        '<polyline points="20,0 20,100"/><line x1="80" y1="0" x2="80" y2="100"/>',
    )
    assert area(drawing.outline) == pytest.approx(0.01)
    assert [area(hole) for hole in drawing.holes] == [pytest.approx(np.pi * 1e-4, rel=1e-3)]
    assert sorted(float(line[0][0]) for line in drawing.constraints) == pytest.approx([0.02, 0.08])


def test_svg_with_a_document_type_but_no_entities_is_read(tmp_path):
    kind = (
        '<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd">'
    )
    assert area(svg(tmp_path, '<rect width="100" height="50"/>', kind + HEAD).outline) == pytest.approx(0.005)


def test_svg_without_units_is_in_css_pixels(tmp_path):
    drawing = svg(tmp_path, '<rect width="96" height="96"/>', '<svg xmlns="http://www.w3.org/2000/svg">')
    assert area(drawing.outline) == pytest.approx(0.0254**2)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<svg", "not valid SVG"),
        ("<html></html>", "its root is <html>"),
        ("<svg></svg>", "no closed line"),
        ('<svg><path d="M0 0 L 1"/></svg>', "no closed line"),
        ('<svg><path d="0 0 1"/></svg>', "no closed line"),
        ('<svg><rect width="1e" height="1"/></svg>', "only closed lines of less"),
        ('<svg><svg width="1e"/></svg>', "length '1e' is not a number"),
        ('<!DOCTYPE svg [<!ENTITY a "b"><!ENTITY c "&a;&a;">]><svg>&c;</svg>', "declares entities"),
        ('<!DOCTYPE svg [<!ENTITY a SYSTEM "file:///etc/hostname">]><svg>&a;</svg>', "declares entities"),
        ("<svg>" + "<g>" * 3000 + "</g>" * 3000 + "</svg>", "nested too deep"),
        ('<svg><path d="M0 0 L1e200 0 0 1e200z"/></svg>', "leaves the range"),
        ('<svg><path d="M0 0 L1e999 0 0 1z"/></svg>', "leaves the range"),
        ('<svg><path d="M0 0 A1e308 1e308 0 0 1 9 9 L0 9z"/></svg>', "leaves the range"),
        ('<svg><g transform="scale(1e10)"><path d="M0 0 L1e308 0 0 1z"/></g></svg>', "leaves the range"),
        ('<svg width="0mm" viewBox="0 0 9 9"><rect width="9" height="9"/></svg>', "not positive"),
        ("", "empty"),
    ],
)
def test_bad_svg_is_one_line(tmp_path, text, message):
    path = tmp_path / "bad.svg"
    path.write_text(text)
    with pytest.raises(FileProblem, match=message):
        read_outline(path)


PANEL = '<rect id="p" width="100" height="50"/>'
USED = {
    f'<defs>{PANEL}</defs><use href="#p" x="7" y="9"/>': [0.007, 0.009, 0.107, 0.059],
    f'<defs>{PANEL}</defs><use xlink:href="#p" transform="scale(2)" x="1"/>': [0.002, 0, 0.202, 0.1],
    f'<defs><g id="g" transform="translate(3)">{PANEL}</g></defs><use href="#g" y="1"/>': [0.003, 0.001, 0.103, 0.051],
    f'<defs>{PANEL}<g id="g"><use href="#p" x="3"/></g></defs><use href="#g" x="2"/>': [0.005, 0, 0.105, 0.05],
    f'<symbol id="s" viewBox="10 0 200 100">{PANEL}</symbol><use href="#s" x="9" width="20mm" height="10mm"/>': None,
    f'<svg x="5" y="6">{PANEL}</svg>': [0.005, 0.006, 0.105, 0.056],
    f'<svg x="5%" y="1cm" width="50%" height="300" viewBox="0 0 200 600">{PANEL}</svg>': [0.01, 0.01, 0.06, 0.035],
    f'<svg x="5" width="50" height="50" viewBox="0 0 100 50">{PANEL}</svg>': [0.005, 0.0125, 0.055, 0.0375],
    f'<svg width="50" height="50" viewBox="0 0 100 50" preserveAspectRatio="xMinYMax">{PANEL}</svg>': [
        0, 0.025, 0.05, 0.05
    ],
    f'<svg width="50" height="50" viewBox="0 0 100 50" preserveAspectRatio="none">{PANEL}</svg>': [0, 0, 0.05, 0.05],
    f'<svg width="50" height="50" viewBox="0 0 100 50" preserveAspectRatio="xMidYMid slice">{PANEL}</svg>': [
        -0.025, 0, 0.075, 0.05
    ],
}  # fmt: skip
HEAD_PIXELS = (
    '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="200mm" '
)
HEAD_PIXELS += 'height="300mm" viewBox="0 0 200 300">'


@pytest.mark.parametrize("body", USED)
def test_svg_draws_what_is_used_and_what_stands_in_a_nested_drawing(tmp_path, body):
    """Units in a nested drawing are CSS pixels of the drawing around it, whose own here is a millimetre."""
    found = np.asarray(svg(tmp_path, body, HEAD_PIXELS).outline)
    pixel = 96 / 25.4  # user units of a "mm"
    wanted = USED[body] or [0.009 - 0.001 * pixel, 0, 0.009 + 0.009 * pixel, 0.005 * pixel]
    if "1cm" in body:
        wanted = [wanted[0], 10 * pixel / 1000, wanted[2], wanted[3] + 10 * pixel / 1000 - 0.01]
    np.testing.assert_allclose([*found.min(axis=0), *found.max(axis=0)], wanted, atol=1e-12)


LEFT_OUT = {
    '<rect width="9" height="9" display="none"/>': "1 hidden .display: none",
    '<g style="fill:red; display : none"><rect width="9" height="9"/></g>': "1 hidden .display: none",
    '<g visibility="hidden"><rect width="9" height="9"/></g>': "1 hidden .visibility",
    "<text>hem</text><text>cuff</text><image/>": "2 <text>, 1 <image>",
    '<use href="#none"/>': "1 <use> of #none",
}


@pytest.mark.parametrize("body", LEFT_OUT)
def test_svg_names_what_it_leaves_out(tmp_path, body):
    with pytest.warns(OutlineWarning, match=f"left out of drawing.svg: {LEFT_OUT[body]}"):
        drawing = svg(tmp_path, '<rect x="10" width="100" height="50"/>' + body)
    assert area(drawing.outline) == pytest.approx(0.005)
    assert drawing.holes == []


def test_svg_applies_style_sheets(tmp_path):
    sheet = "<style>.a { display: none }</style>"
    drawing = svg(tmp_path, sheet + '<rect width="100" height="50"/><rect class="a" width="9" height="9"/>')
    assert area(drawing.outline) == pytest.approx(0.005)
    assert drawing.holes == []


def test_svg_shows_what_is_visible_within_what_is_not(tmp_path):
    with pytest.warns(OutlineWarning, match="1 hidden"):
        drawing = svg(
            tmp_path,
            '<g visibility="hidden"><rect width="9" height="9"/>'
            '<rect width="100" height="50" style="visibility:visible"/></g>',
        )
    assert area(drawing.outline) == pytest.approx(0.005)


def many_uses() -> str:
    """Ten of ten of ten …: a small file that would draw a thousand million rectangles."""
    levels = [f'<g id="g{k}">' + f'<use href="#g{k - 1}"/>' * 10 + "</g>" for k in range(1, 10)]
    return f'<g id="g0">{PANEL}</g>{"".join(levels)}'


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ('<g id="a"><use href="#a"/></g>', "<use> of #a within itself"),
        ('<g id="a"><use href="#b"/></g><g id="b"><use href="#a"/></g>', "within itself"),
        (many_uses(), "more than 200000 elements"),
        ('<svg width="5" height="0" viewBox="0 0 0 5"/>', "viewBox .* without a size"),
    ],
)
def test_svg_that_multiplies_itself_is_one_line(tmp_path, body, message):
    with pytest.raises(FileProblem, match=message):
        svg(tmp_path, body)


def dxf_text(entities: str, unit: int | None = 4) -> str:
    head = "" if unit is None else f"0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n{unit}\n0\nENDSEC\n"
    return head + "0\nSECTION\n2\nENTITIES\n" + entities.replace(" ", "\n") + "\n0\nENDSEC\n0\nEOF\n"


def dxf(tmp_path, entities: str, unit: int | None = 4):
    path = tmp_path / "drawing.dxf"
    path.write_text(dxf_text(entities, unit))
    return read_outline(path)


DRAWN = {
    "0 LWPOLYLINE 70 1 10 0 20 0 10 100 20 0 10 100 20 50 10 0 20 50": 0.005,
    "0 LWPOLYLINE 70 1 10 0 20 0 42 1 10 100 20 0 42 1": CIRCLE,
    "0 POLYLINE 70 1 0 VERTEX 10 0 20 0 0 VERTEX 10 100 20 0 0 VERTEX 10 100 20 50 0 VERTEX 10 0 20 50 0 SEQEND": 0.005,
    "0 LINE 10 0 20 0 11 100 21 0 0 LINE 10 100 20 50 11 100 21 0 "
    "0 LINE 10 100 20 50 11 0 21 50 0 LINE 10 0 20 0 11 0 21 50": 0.005,
    "0 CIRCLE 10 5 20 5 40 50": CIRCLE,
    "0 ARC 10 0 20 0 40 50 50 0 51 180 0 ARC 10 0 20 0 40 50 50 180 51 360": CIRCLE,
    "0 ELLIPSE 10 0 20 0 11 0 21 100 40 0.25 41 0 42 6.283185307179586": CIRCLE,
}


@pytest.mark.parametrize("entities", DRAWN)
def test_dxf_shapes_have_their_area(tmp_path, entities):
    assert area(dxf(tmp_path, entities).outline) == pytest.approx(DRAWN[entities], rel=1e-3)


def test_dxf_joins_thousands_of_lines_in_any_order_and_direction(tmp_path):
    rng = np.random.default_rng(3)
    t = np.arange(8001) * 2 * np.pi / 8000
    places = [f"{50 * np.cos(a):.9f} {50 * np.sin(a):.9f}".split() for a in t % (2 * np.pi)]
    lines = []
    for k in rng.permutation(8000):
        (ax, ay), (bx, by) = (places[k + i] for i in (rng.permutation(2)))
        lines.append(f"0 LINE 10 {ax} 20 {ay} 11 {bx} 21 {by}")
    drawing = dxf(tmp_path, " ".join(lines))
    assert len(drawing.outline) == 8000
    assert area(drawing.outline) == pytest.approx(CIRCLE, rel=1e-5)


@pytest.mark.parametrize("place", range(5))
def test_dxf_line_that_ends_at_a_corner_is_an_inner_line(tmp_path, place):
    sides = ["0 0 9 0", "9 0 9 9", "9 9 0 9", "0 9 0 0"]
    sides.insert(place, "9 9 4 4")
    drawn = ("0 LINE 10 {} 20 {} 11 {} 21 {}".format(*side.split()) for side in sides)
    drawing = dxf(tmp_path, " ".join(drawn))
    assert area(drawing.outline) == pytest.approx(81e-6)
    assert [np.round(line, 9).tolist() for line in drawing.constraints] == [
        [[0.009, -0.009], [0.004, -0.004]]
    ]


def test_dxf_spline_passes_its_ends_and_y_is_turned(tmp_path):
    spline = "0 SPLINE 70 8 71 3 " + " ".join(f"40 {k}" for k in (0, 0, 0, 0, 1, 1, 1, 1))
    spline += " 10 0 20 0 10 0 20 40 10 100 20 40 10 100 20 0"
    drawing = dxf(tmp_path, spline + " 0 LINE 10 100 20 0 11 0 21 0")
    assert area(drawing.outline) == pytest.approx(0.0024, rel=2e-3)  # a Bézier arch: 3/5 of 100 x 40
    assert np.asarray(drawing.outline)[:, 1].min() == pytest.approx(-0.03)


@pytest.mark.parametrize(
    "circle",
    [
        "0 CIRCLE 10 50 20 0 40 10 210 0 220 0 230 -1",
        "0 LWPOLYLINE 70 1 210 0 220 0 230 -1 10 40 20 0 42 1 10 60 20 0 42 1",
    ],
)
def test_dxf_extruded_downwards_is_mirrored(tmp_path, circle):
    """Mirrored parts of a drawing are written in axes of their own, whose x runs the other way."""
    drawing = dxf(tmp_path, circle + " 0 LWPOLYLINE 70 1 10 -100 20 -20 10 0 20 -20 10 0 20 20 10 -100 20 20")
    np.testing.assert_allclose(np.mean(drawing.holes[0], axis=0), (-0.05, 0), atol=1e-12)


BLOCK = "0 BLOCK 2 P 10 1 20 2 0 LWPOLYLINE 8 0 70 1 10 1 20 2 10 101 20 2 10 101 20 52 10 1 20 52 0 ENDBLK "
INSERTED = {
    "0 INSERT 2 P 10 10 20 0": [0.01, -0.05, 0.11, 0],
    "0 INSERT 2 P 10 0 20 0 41 2 42 0.5": [0, -0.025, 0.2, 0],
    "0 INSERT 2 P 10 0 20 0 50 90": [-0.05, -0.1, 0, 0],
    "0 INSERT 2 P 10 0 20 0 41 -1": [-0.1, -0.05, 0, 0],
    "0 INSERT 2 P 10 5 20 0 210 0 220 0 230 -1": [-0.105, -0.05, -0.005, 0],
    "0 INSERT 2 Q 10 5 20 0": [0.012, -0.051, 0.112, -0.001],
}


def blocks_text(blocks: str, entities: str, layers: str = "") -> str:
    """A DXF text with layers, blocks and entities."""
    parts = [("TABLES", layers), ("BLOCKS", blocks)]
    head = "".join(
        f"0\nSECTION\n2\n{name}\n" + "".join(f"{word}\n" for word in text.split()) + "0\nENDSEC\n"
        for name, text in parts
    )
    return head + dxf_text(entities)


@pytest.mark.parametrize("entities", INSERTED)
def test_dxf_blocks_are_drawn_where_they_are_inserted(tmp_path, entities):
    path = tmp_path / "drawing.dxf"
    nested = BLOCK + "0 BLOCK 2 Q 10 -3 20 -1 0 INSERT 2 P 10 4 20 0 0 ENDBLK"
    path.write_text(blocks_text(nested, entities))
    found = np.asarray(read_outline(path).outline)
    np.testing.assert_allclose([*found.min(axis=0), *found.max(axis=0)], INSERTED[entities], atol=1e-12)


def test_dxf_blocks_are_repeated_in_columns_and_rows(tmp_path):
    path = tmp_path / "drawing.dxf"
    around = " 0 LWPOLYLINE 70 1 10 -9 20 -9 10 999 20 -9 10 999 20 999 10 -9 20 999"
    path.write_text(blocks_text(BLOCK, "0 INSERT 2 P 10 0 20 0 70 3 71 2 44 200 45 100" + around))
    drawing = read_outline(path)
    corners = sorted(
        (round(h[:, 0].min(), 9), round(-h[:, 1].max(), 9)) for h in map(np.array, drawing.holes)
    )
    assert corners == [(x, y) for x in (0, 0.2, 0.4) for y in (0, 0.1)]


DARK = "0 LAYER 2 OFF 70 0 62 -7 0 LAYER 2 FROZEN 70 1 62 7 0 LAYER 2 ON 70 0 62 7"
SMALL = " 70 1 10 0 20 0 10 9 20 0 10 9 20 9"
DXF_LEFT_OUT = {
    "0 LWPOLYLINE 8 OFF" + SMALL: "1 on layer OFF, off or frozen",
    "0 LWPOLYLINE 8 FROZEN" + SMALL: "1 on layer FROZEN, off or frozen",
    "0 INSERT 8 OFF 2 P 10 0 20 0": "1 on layer OFF",
    "0 LWPOLYLINE 67 1" + SMALL: "1 in paper space",
    "0 LWPOLYLINE 60 1" + SMALL: "1 invisible",
    "0 TEXT 1 hem 0 TEXT 1 cuff 0 SOLID 10 0 20 0": "2 TEXT, 1 SOLID",
    "0 INSERT 2 NONE 10 0 20 0": "1 INSERT of no block",
}


@pytest.mark.parametrize("entities", DXF_LEFT_OUT)
def test_dxf_names_what_it_leaves_out(tmp_path, entities):
    path = tmp_path / "drawing.dxf"
    shown = "0 LWPOLYLINE 8 ON 70 1 10 0 20 0 10 100 20 0 10 100 20 50 10 0 20 50 "
    path.write_text(blocks_text(BLOCK, shown + entities, DARK))
    with pytest.warns(OutlineWarning, match=f"left out of drawing.dxf: {DXF_LEFT_OUT[entities]}"):
        drawing = read_outline(path)
    assert area(drawing.outline) == pytest.approx(0.005)
    assert drawing.holes == []
    assert drawing.constraints == []


@pytest.mark.parametrize(
    ("blocks", "message"),
    [
        ("0 BLOCK 2 P 10 0 20 0 0 INSERT 2 P 10 0 20 0 0 ENDBLK", "block P within itself"),
        (
            "0 BLOCK 2 P 10 0 20 0 0 INSERT 2 Q 10 0 20 0 70 9999 71 9999 0 ENDBLK 0 BLOCK 2 Q 0 ENDBLK",
            "more than 200000",
        ),
    ],
)
def test_dxf_that_multiplies_itself_is_one_line(tmp_path, blocks, message):
    path = tmp_path / "drawing.dxf"
    path.write_text(blocks_text(blocks, "0 INSERT 2 P 10 0 20 0"))
    with pytest.raises(FileProblem, match=message):
        read_outline(path)


def told(capsys) -> list[str]:
    """Its lines, but for that of a machine that meshes for the first time."""
    return [line for line in capsys.readouterr().err.splitlines() if "making machine code" not in line]


def test_the_command_names_what_was_left_out_in_one_line(tmp_path, capsys):
    path = tmp_path / "drawing.svg"
    path.write_text(HEAD + '<rect width="100" height="50"/><text>hem</text></svg>')
    assert cli.main(["mesh", str(path), "--edge", "0.05"]) == 0
    assert told(capsys) == [f"simcore mesh: {path}: left out of drawing.svg: 1 <text>"]


@pytest.mark.parametrize(("unit", "metres"), [(None, 1e-3), (1, 0.0254), (5, 0.01), (6, 1.0)])
def test_dxf_units(tmp_path, unit, metres):
    square = "0 LWPOLYLINE 70 1 10 0 20 0 10 2 20 0 10 2 20 2 10 0 20 2"
    assert area(dxf(tmp_path, square, unit).outline) == pytest.approx(4 * metres**2)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("hello\nworld\n", "not a DXF"),
        ("0\nEOF\n", "no section"),
        ("AutoCAD Binary DXF\r\n\x1a", "not a DXF file"),
        ("0\nSECTION\n2\nENTITIES\n0\nENDSEC\n0\nEOF\n", "no closed line"),
        ("0\nSECTION\n2\nENTITIES\n0\nCIRCLE\n10\nx\n20\n0\n40\n1\n0\nENDSEC\n", "Invalid floating point"),
        ("0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n99\n0\nENDSEC\n", "INSUNITS 99"),
        (dxf_text("0 LWPOLYLINE 70 1 10 0 20 0 10 1e308 20 0 10 1e308 20 1e308"), "leaves the range"),
        (
            dxf_text("0 LWPOLYLINE 70 1 10 0 20 0 42 inf 10 5 20 0 10 1 20 1"),
            "leaves the range|cannot be read",
        ),
        (dxf_text("0 LINE 10 0 20 0 11 nan 21 1"), "leaves the range"),
        ("", "empty"),
    ],
)
def test_bad_dxf_is_one_line(tmp_path, text, message):
    path = tmp_path / "bad.dxf"
    path.write_text(text)
    with pytest.raises(FileProblem, match=message):
        read_outline(path)


NUMBERLESS = {
    '{"outline": [[0, 0], ["1", 0], [1, 1]]}': r"outline: point 1 is \['1', 0\] – give numbers",
    '{"outline": [[0, 0], [1, true], [1, 1]]}': r"outline: point 1 is \[1, True\] – give numbers",
    '{"outline": [[0, 0], [1, 0], null]}': "outline: point 2 is None",
    '{"outline": [[0, 0], [1, 0], [1, 1]], "holes": [[], [["a", 1]]]}': "hole 1: point 0 is",
    '{"outline": [[0, 0], [1, 0], [1, 1]], "constraints": [[[false, 1]]]}': "constraint 0: point 0 is",
}


@pytest.mark.parametrize("text", NUMBERLESS)
def test_texts_and_truths_are_no_coordinates(tmp_path, text):
    path = tmp_path / "panel.json"
    path.write_text(text)
    with pytest.raises(FileProblem, match=NUMBERLESS[text]):
        read_outline(path)


@pytest.mark.parametrize("point", ['["0", 0, 0.1]', "[0, 0, true]"])
def test_texts_and_truths_are_no_sizes(tmp_path, point):
    path = tmp_path / "field.json"
    path.write_text('{"points": [[0, 0, 0.1], ' + point + "]}")
    with pytest.raises(FileProblem, match="points: point 1 is .* – give numbers"):
        read_size_field(path)


@pytest.mark.parametrize("kind", ["fair", "best"])
def test_the_command_reads_all_kinds_and_tells_its_keys(tmp_path, capsys, kind):
    made = tmp_path / "panel.json"
    made.write_text(
        json.dumps(
            {
                "outline": [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]],
                "constraints": [[[0.3, 0], [0.3, 1]]],
                "holes": [],
            }
        )
    )
    field = tmp_path / "field.json"
    field.write_text('{"points": [[0, 0, 0.03]]}')
    out = tmp_path / "mesh.npz"
    words = [
        "mesh",
        str(made),
        "--edge",
        "0.1",
        "--quality",
        kind,
        "--size-field",
        str(field),
        "--out",
        str(out),
        "--json",
    ]
    assert cli.main(words) == 0
    summary = json.loads(capsys.readouterr().out)
    wanted = "vertices faces seconds compile_seconds min_angle_deg quality edge_ratio conformity area_error"
    assert list(summary) == [*wanted.split(), "outline_deviation"]
    assert set(summary["quality"]) == set(summary["edge_ratio"]) == {"mean", "worst"}
    with np.load(out) as found:
        assert found["vertices"].dtype == np.float64
        assert found["faces"].dtype == found["boundary"].dtype == np.int32
        assert found["boundary_start"].tolist() == [0, len(found["boundary"])]
        line = found["vertices"][found["lines"]]
        assert found["lines_start"].tolist() == [0, len(line)]
        np.testing.assert_allclose(line[:, 0], 0.3, atol=1e-12)
    drawing = tmp_path / "panel.svg"
    drawing.write_text(HEAD + '<rect width="100" height="100"/><circle cx="50" cy="10" r="10"/></svg>')
    assert cli.main(["mesh", str(drawing), "--edge", "0.02", "--quality", kind]) == 0
    (line,) = told(capsys)
    assert "hole 0: touches the outline" in line
