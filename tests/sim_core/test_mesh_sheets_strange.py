"""Sheets as strangers draw them: ends that miss each other, sizes on layers, test squares, names of any kind."""

import json
import re
import tomllib
from pathlib import Path

import ezdxf.filemanagement
import numpy as np
import pytest

from sim_core import cli
from sim_core.errors import FileProblem
from sim_core.garment.pattern import Pattern
from sim_core.mesh.sheets import read_garment_code, read_sheet, toml_text

SHEETS = Path(__file__).parent / "sheets"
HEAD = '<svg xmlns="http://www.w3.org/2000/svg" width="2000mm" height="1000mm" viewBox="0 0 2000 1000">'

pytestmark = pytest.mark.filterwarnings("ignore:left out of:sim_core.errors.OutlineWarning")


def svg(tmp_path, *drawn: str, **how):
    path = tmp_path / "sheet.svg"
    path.write_text(HEAD + "".join(drawn) + "</svg>")
    return read_sheet(path, **how)


def test_ends_that_miss_each_other_by_a_rounding_are_joined(tmp_path):
    sides = ["M0 0H300", "M300.003 0V200", "M300 200.002H0", "M0 200V0.001"]
    sheet = svg(tmp_path, *(f'<path d="{side}"/>' for side in sides))
    (piece,) = sheet.pieces
    assert len(piece.outline) == 4
    np.testing.assert_allclose(np.ptp(piece.outline, axis=0), (0.3, 0.2), atol=4e-6)
    assert "ends up to 0.0036 mm apart were joined" in sheet.remarks


def test_lines_as_short_as_a_rounding_stay_a_curve(tmp_path):
    """A circle of 0.03 mm steps has both ends of every line within reach of the next ones."""
    turns = np.linspace(0, 2 * np.pi, 2001)
    ring = 100 + 9.5 * np.column_stack([np.cos(turns), np.sin(turns)])
    sides = np.hstack([ring[:-1], ring[1:]])
    sheet = svg(tmp_path, *(f'<path d="M{a:.6f} {b:.6f}L{c:.6f} {d:.6f}"/>' for a, b, c, d in sides))
    (piece,) = sheet.pieces
    assert len(piece.outline) == 2000
    assert sheet.remarks == ()


def test_ends_a_tenth_of_a_millimetre_apart_are_a_gap(tmp_path):
    sheet = svg(
        tmp_path, '<rect width="90" height="90"/>', '<path d="M100 0h50"/>', '<path d="M150.1 0v50"/>'
    )
    assert len(sheet.pieces) == 1
    assert not any("apart were joined" in remark for remark in sheet.remarks)


CIRCLES = ['<circle cx="50" cy="70" r="20"/>', '<path d="M30 70a20 20 0 0 1 40 0a20 20 0 0 1 -40 0z"/>']
AFFINE = [
    (1, 0, 0.3, 1, 400, 0),  # skewed
    (2, 0, 1, 1.5, 0, 0),
    (1.5, 0.4, -0.8, 1.1, 300, 300),
    (-1, 0.2, 0.5, 1, 400, 0),  # turned over as well
    (1.4, 0.35, -1.4, 0.35, 400, 200),  # stretched after it was turned
]


@pytest.mark.parametrize("matrix", AFFINE)
@pytest.mark.parametrize("circle", CIRCLES)
def test_a_round_piece_in_a_leaning_group_is_the_ellipse_it_is_drawn_as(tmp_path, circle, matrix):
    a, b, c, d, e, f = matrix
    sheet = svg(tmp_path, f'<g transform="matrix({a} {b} {c} {d} {e} {f})">{circle}</g>')
    (piece,) = sheet.pieces
    given = np.linalg.solve(np.array([[a, c], [b, d]]), (1000 * piece.outline - (e, f)).T).T
    np.testing.assert_allclose(np.hypot(*(given - (50, 70)).T), 20, atol=1e-6)
    assert len(piece.outline) >= 100
    assert sheet.remarks == ()


@pytest.mark.parametrize("bulge", [0, 0.5])
def test_a_turned_block_in_a_stretched_one_is_skewed(tmp_path, bulge):
    drawing = ezdxf.filemanagement.new("R2018", units=4)
    part = drawing.blocks.new("part")
    part.add_lwpolyline([(0, 0, 0), (300, 0, bulge), (300, 500, 0), (0, 500, 0)], format="xyb", close=True)
    part.add_circle((150, 250), 40)
    drawing.blocks.new("turned").add_blockref("part", (70, 0), dxfattribs={"rotation": 30})
    drawing.modelspace().add_blockref("turned", (4000, 100), dxfattribs={"xscale": 2, "yscale": -0.5})
    drawing.saveas(tmp_path / "sheet.dxf")
    (piece,) = read_sheet(tmp_path / "sheet.dxf").pieces
    turn = np.radians(30)
    across, down = (2 * np.cos(turn), -0.5 * np.sin(turn)), (-2 * np.sin(turn), -0.5 * np.cos(turn))
    matrix = np.column_stack([across, down])
    given = [
        np.linalg.solve(matrix, (1000 * line * (1, -1) - (4000 + 140, 100)).T).T
        for line in (piece.outline, *piece.holes)
    ]
    np.testing.assert_allclose(np.hypot(*(given[1] - (150, 250)).T), 40, atol=0.05)
    corners = np.array([(0, 0), (300, 0), (300, 500), (0, 500)], float)
    assert max(np.linalg.norm(given[0] - corner, axis=1).min() for corner in corners) < 1e-6
    np.testing.assert_allclose(given[0].max(axis=0), (300 + 250 * bulge, 500), atol=0.05)


SIGNS = [
    *map(chr, range(0x20)),
    "\x7f",
    '"',
    "\\",
    "'",
    "#",
    "]",
    "\x85",
    "\u2028",
    "\ud800",
    "短衫",
    "\U0001f9f5",
]


def test_a_name_with_any_sign_in_it_is_valid_toml(tmp_path, capsys):
    square = {
        "vertices": [[0, 0], [10, 0], [10, 10], [0, 10]],
        "edges": [{"endpoints": [k, (k + 1) % 4]} for k in range(4)],
    }
    names = [f"front{sign}\nname = 3" for sign in SIGNS]
    sheet, made = tmp_path / "shirt.json", tmp_path / 'shirt "\\\x7f\x1b.toml'
    sheet.write_text(json.dumps({"pattern": {"panels": dict.fromkeys(names, square), "stitches": []}}))
    assert cli.main(["mesh", str(sheet), "--list", "--pattern", str(made)]) == 0
    tables = tomllib.loads(made.read_text("utf-8"))
    assert tables["name"] == made.stem
    assert len(tables["panel"]) == len(SIGNS)
    assert len(Pattern.load(made).panels) == len(SIGNS)
    assert len(capsys.readouterr().out.splitlines()) == 2 + len(SIGNS)


def test_texts_with_any_sign_in_them_come_back():
    tables = {sign: {"name": f"a{sign}b"} for sign in SIGNS if sign != "\ud800"}
    assert tomllib.loads(toml_text(tables)) == tables


def places(values, within=()):
    """The way to every value in a JSON file."""
    held = (
        values.items() if isinstance(values, dict) else enumerate(values) if isinstance(values, list) else ()
    )
    for key, value in held:
        yield (*within, key)
        yield from places(value, (*within, key))


RAW = re.compile(
    r"unpack|subscript|NoneType|iterable|attribute|argument|indices|unhashable|not supported|KeyError|\('"
)


@pytest.mark.parametrize("value", [None, 3, -1.5, "x", [], {}, [1], [[0, 1], 2], {"panel": 1}, True, "gone"])
def test_whatever_a_specification_says_it_is_a_sheet_or_one_line_that_names_the_place(tmp_path, value):
    given = (SHEETS / "garmentcode-lapel.json").read_text()
    path = tmp_path / "code.json"
    for where in places(json.loads(given)):
        values = json.loads(given)
        held = values
        for key in where[:-1]:
            held = held[key]
        if value == "gone":
            del held[where[-1]]
        else:
            held[where[-1]] = value
        path.write_text(json.dumps(values))
        try:
            read_garment_code(path, values)
        except FileProblem as error:
            said = str(error).removeprefix(f"{path}: ")  # noqa: PT017 - either is right, so `raises` does not fit
            assert not RAW.search(said), said  # noqa: PT017
            assert " – " in said  # noqa: PT017
            assert re.match(r"pattern|panel \w+: |stitch \d+: |properties|the file: ", said), said  # noqa: PT017


def test_a_specification_without_edges_says_of_which_panel(tmp_path):
    values = json.loads((SHEETS / "garmentcode-lapel.json").read_text())
    del values["pattern"]["panels"]["left_btorso"]["edges"]
    with pytest.raises(FileProblem, match="panel left_btorso: edges: missing – give a specification"):
        read_garment_code(tmp_path, values)


# --- names of layers, blocks and groups


def dxf(tmp_path, *drawn, blocks=None, **how):
    """A drawing of rectangles (layer, x, y, width, height) [mm] and of blocks: name -> texts and rectangles."""
    drawing = ezdxf.filemanagement.new("R2010", units=4)
    for name, held in {"": drawn, **(blocks or {})}.items():
        space = drawing.blocks.new(name) if name else drawing.modelspace()
        for what in held:
            if isinstance(what, str):
                space.add_text(what, dxfattribs={"layer": "1"})
            else:
                layer, x, y, width, height = what
                corners = [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]
                space.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})
        if name:
            drawing.modelspace().add_blockref(name, (0, 0))
    drawing.saveas(tmp_path / "sheet.dxf")
    return read_sheet(tmp_path / "sheet.dxf", **how)


def names(sheet) -> list[str]:
    return [piece.name for piece in sheet.pieces]


def test_a_named_layer_leaves_the_numbers_of_the_others_what_they_are(tmp_path):
    front = [
        ("1", 0, 0, 300, 400),
        ("14", 10, 10, 280, 380),
        ("11", 100, 100, 30, 30),
        ("TEXT", 5, 5, 40, 10),
        ("8", 200, 200, 30, 30),
    ]
    sheet = dxf(tmp_path, blocks={"FRONT": front})
    (piece,) = sheet.pieces
    assert np.ptp(piece.sew, axis=0).round(6).tolist() == [0.28, 0.38]
    assert len(piece.holes) == len(piece.lines) == 1
    assert sheet.left_out == {"TEXT": 1}


def test_pieces_on_numbered_layers_of_a_plain_drawing_are_pieces(tmp_path):
    sheet = dxf(tmp_path, *((str(k), 400 * k, 0, 300, 200 + k) for k in range(1, 5)))
    assert len(sheet.pieces) == 4
    assert sheet.left_out == {}


def test_texts_of_an_apparel_drawing_name_its_pieces(tmp_path):
    blocks = {
        f"BLOCK{k}": [f"Piece Name: {name}", f"Size: {size}", "Quantity: 2", ("1", 400 * k, 0, 300, 200)]
        for k, (name, size) in enumerate([("FRONT", "M"), ("FRONT", "L"), ("Lining", "M"), ("领缘", "M")])
    }
    assert names(dxf(tmp_path, blocks=blocks)) == ["FRONT-M", "FRONT-L", "Lining", "领缘"]


@pytest.mark.parametrize(
    "layer", ["BUTTON PLACKET", "NotchCollar", "fold_facing", "LABEL POCKET", "hole-panel"]
)
def test_a_piece_is_not_lost_by_a_word_in_the_name_of_its_layer(tmp_path, layer):
    assert names(dxf(tmp_path, (layer, 0, 0, 60, 400), ("BACK", 100, 0, 300, 400))) == [layer, "BACK"]


@pytest.mark.parametrize("layer", ["BUTTON", "notes", "Hidden lines", "LABEL", "Grid 10 mm"])
def test_a_mark_is_none_by_its_size(tmp_path, layer):
    assert names(dxf(tmp_path, (layer, 0, 0, 60, 400), ("BACK", 100, 0, 300, 400))) == ["BACK"]


def test_a_mark_named_after_a_piece_is_no_hole_in_it(tmp_path):
    sheet = dxf(tmp_path, ("BACK", 0, 0, 300, 400), ("label position", 50, 50, 60, 40))
    (piece,) = sheet.pieces
    assert piece.holes == ()
    assert sheet.left_out == {"label position": 1}


def test_pieces_are_named_by_their_layers_where_those_tell_them_apart(tmp_path):
    apart = [("Front", 0, 0, 300, 400), ("Sleeve", 400, 0, 200, 300), ("Sleeve", 700, 0, 200, 300)]
    assert names(dxf(tmp_path, *apart)) == ["Front", "Sleeve", "Sleeve-2"]
    assert names(dxf(tmp_path, *(("Layer 1", *rest) for _, *rest in apart))) == [
        "piece-1",
        "piece-2",
        "piece-3",
    ]
    styled = "".join(f'<path class="st{k}" d="M{100 * k} 0h90v90h-90z"/>' for k in range(2))
    assert names(svg(tmp_path, styled)) == ["piece-1", "piece-2"]


def test_no_two_pieces_have_one_name(tmp_path):
    drawn = "".join(f'<path id="{n}" d="M{100 * k} 0h90v90h-90z"/>' for k, n in enumerate(["a-2", "a", "b"]))
    twice = f'{drawn}<g id="a"><path d="M500 0h90v90h-90z"/></g>'
    assert sorted(names(svg(tmp_path, twice))) == ["a", "a-2", "a-3", "b"]


FURNITURE = [
    "ScaleBox", "scale box", "Test square", "test-square", "TESTSQUARE", "test_square_5cm", "Page border", "page-frame",
    "legend", "Watermark", "title block", "Gauge square", "测试方块", "图框",
]  # fmt: skip


@pytest.mark.parametrize("name", FURNITURE)
def test_what_belongs_to_the_sheet_is_no_piece(tmp_path, name):
    piece = '<path id="back" d="M100 100h300v400h-300z"/>'
    for what in (
        f'<rect id="{name}" width="50" height="50"/>',
        f'<g id="{name}"><rect width="50" height="50"/></g>',
        f'<rect class="{name}" width="50" height="50"/>',
    ):
        assert names(svg(tmp_path, what, piece)) == ["back"]
    square = (0, 0, 50, 50)
    assert names(dxf(tmp_path, (name, *square), ("BACK", 100, 0, 300, 400))) == ["BACK"]
    blocks = {name: [("0", *square)], "BACK": [("0", 100, 0, 300, 400)]}
    assert names(dxf(tmp_path, blocks=blocks)) == ["BACK"]


def test_a_border_around_one_piece_is_no_piece(tmp_path):
    border = '<rect id="border" width="900" height="900"/>'
    assert names(svg(tmp_path, border, '<path id="back" d="M100 100h300v400h-300z"/>')) == ["back"]
    assert names(svg(tmp_path, '<rect id="border" width="900" height="60"/>')) == ["border"]  # of a hem


# --- sizes in each other


def graded(*layers: str, step: float = 7.0):
    """Front and back on each layer, each a little smaller than on the one before, from one corner."""
    return [
        (layer, x, 0, width - step * k, 400 - 2 * step * k)
        for k, layer in enumerate(layers)
        for x, width in ((0, 300), (500, 200))
    ]


@pytest.mark.parametrize(
    "layers",
    [
        ("L", "M"),
        ("XXL", "XL", "L", "M", "S", "XS"),
        ("Size 40", "Size 38"),
        ("Cut_42", "Cut_40", "Cut_38"),
        ("42", "40"),
        ("175-92A", "165-84A"),
        ("3", "2", "1"),
        ("nest c", "nest b", "nest a"),
    ],
)
def test_sizes_on_layers_are_pieces_and_no_holes(tmp_path, layers):
    sheet = dxf(tmp_path, *graded(*layers))
    assert len(sheet.pieces) == 2 * len(layers)
    assert all(piece.holes == () and piece.sew is None for piece in sheet.pieces)
    chosen = dxf(tmp_path, *graded(*layers), layer=layers[-1])
    assert {piece.layer for piece in chosen.pieces} == {layers[-1]}
    least = 300 - 7 * (len(layers) - 1)
    assert [round(1000 * np.ptp(p.outline, axis=0)[0]) for p in chosen.pieces] == [least, least - 100]


def test_a_size_keeps_its_own_seam_hole_and_grain(tmp_path):
    drawn = []
    for k, size in enumerate(("L", "M")):
        inset = 12 * k
        drawn.append((f"Cut {size}", inset, inset, 300 - 2 * inset, 400 - 2 * inset))
        drawn.append((f"Sew {size}", inset + 10, inset + 10, 280 - 2 * inset, 380 - 2 * inset))
        drawn.append((f"Hole {size}", 100 + k, 100, 30, 30))
    for how in ({}, {"layer": "cut m"}):
        sheet = dxf(tmp_path, *drawn, **how)
        assert len(sheet.pieces) == (1 if how else 2)
        for piece in sheet.pieces:
            assert (np.ptp(piece.cut, axis=0) - np.ptp(piece.sew, axis=0)).round(6).tolist() == [0.02, 0.02]
            assert len(piece.holes) == 1


def test_sizes_on_one_layer_are_told(tmp_path):
    sheet = dxf(tmp_path, *((("outline", 0, 0, 300 - 9 * k, 400 - 9 * k)) for k in range(5)))
    assert len(sheet.pieces) == 5
    assert "5 outlines lie in each other – taken for sizes of one piece" in sheet.remarks


def test_a_seam_and_a_hole_on_layers_of_their_own_are_what_they_were(tmp_path):
    lines = [("a", 0, 0, 300, 400), ("b", 10, 10, 280, 380), ("c", 100, 100, 40, 40)]
    for called in ("abc", ("40", "41", "43"), ("T1", "T2", "T3")):
        named = [(layer, *rest) for layer, (_, *rest) in zip(called, lines, strict=True)]
        (piece,) = dxf(tmp_path, *named).pieces
        assert piece.sew is not None
        assert len(piece.holes) == 1


def test_groups_named_after_sizes_name_their_pieces_with_them(tmp_path):
    group = '<g id="{0}"><path id="front-{0}" d="M0 0h{1}v300h-{1}z"/></g>'
    nested = f'<g id="front">{group.format("M", 200)}{group.format("L", 220)}</g>'
    assert names(svg(tmp_path, nested)) == ["front-M", "front-L"]


def test_a_layer_that_is_none_names_those_that_are(tmp_path):
    with pytest.raises(FileProblem, match=r"layer 'XS': no piece on it – layers: L, M"):
        dxf(tmp_path, *graded("L", "M"), layer="XS")
