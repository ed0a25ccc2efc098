"""Pattern sheets as other programs write them: units, encodings, dialects of AAMA and ASTM, letters, hostile files."""

import io
import json
import struct
import tomllib
from pathlib import Path

import ezdxf.filemanagement
import numpy as np
import pytest

from sim_core import cli
from sim_core.errors import FileProblem
from sim_core.garment.pattern import Pattern
from sim_core.mesh import panel_mesh
from sim_core.mesh.outline import signed_area
from sim_core.mesh.sheets import apart, read_garment_code, read_sheet, sheet_picture, toml_text

SHEETS = Path(__file__).parent / "sheets"
PATTERNS = Path(__file__).parents[2] / "assets" / "patterns"
HEAD = '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
SIZED = HEAD + 'width="900mm" height="600mm" viewBox="0 0 900 600">'
FRONT = '<path id="front" d="M10 10h200v300h-200z"/>'

pytestmark = pytest.mark.filterwarnings("ignore:left out of:sim_core.errors.OutlineWarning")


def svg(tmp_path, text, encoding="utf-8"):
    path = tmp_path / "sheet.svg"
    path.write_bytes(text if isinstance(text, bytes) else text.encode(encoding))
    return read_sheet(path)


def sizes(sheet) -> dict[str, tuple[float, float]]:
    """Width and height of the pieces [mm]."""
    return {p.name: tuple((1000 * np.ptp(p.outline, axis=0)).round(1).tolist()) for p in sheet.pieces}


def tags(*pairs) -> str:
    return "".join(f"  {code}\n{value}\n" for code, value in pairs)


def text_tag(text: str) -> str:
    return tags((0, "TEXT"), (8, "1"), (10, 0), (20, 0), (40, 0.25), (1, text), (7, "STANDARD"))


def polyline(points, layer="1", *, closed=0) -> str:
    vertices = "".join(tags((0, "VERTEX"), (8, layer), (10, x), (20, y)) for x, y in points)
    return (
        tags((0, "POLYLINE"), (8, layer), (66, 1), (70, closed)) + vertices + tags((0, "SEQEND"), (8, layer))
    )


def line(a, b, layer) -> str:
    return tags((0, "LINE"), (8, layer), (10, a[0]), (20, a[1]), (11, b[0]), (21, b[1]))


def aama(tmp_path, blocks: dict[str, str], said: str, *, inserted=True):
    """A DXF as apparel programs write it: a block for each piece, texts that say the style."""
    body = "".join(
        tags((0, "BLOCK"), (8, "0"), (2, name), (70, 64), (10, 0), (20, 0)) + held + tags((0, "ENDBLK"))
        for name, held in blocks.items()
    )
    inserts = "".join(tags((0, "INSERT"), (8, "1"), (2, n), (10, 0), (20, 0)) for n in blocks if inserted)
    parts = [
        tags((0, "SECTION"), (2, "HEADER"), (0, "ENDSEC"), (0, "SECTION"), (2, "BLOCKS")),
        body,
        tags((0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES")),
        text_tag(said),
        inserts,
        tags((0, "ENDSEC"), (0, "EOF")),
    ]
    path = tmp_path / "sheet.dxf"
    path.write_text("".join(parts))
    return path


BOX = [(0, 0), (0, 80), (120, 80), (120, 0)]


@pytest.mark.parametrize(
    ("said", "metres"),
    [
        ("UNITS: ENGLISH", 0.0254),
        ("UNITS: METRIC", 1e-3),
        ("Units: Metric", 1e-3),
        ("UNITS=MM (DXF R12)", 1e-3),
        ("UNITS: CM", 1e-2),
        ("STYLE NAME: BOX", 1e-3),
    ],
)
def test_an_apparel_dxf_has_the_units_that_its_text_says(tmp_path, said, metres):
    path = aama(tmp_path, {"BOX_M": polyline(BOX, closed=1)}, said)
    (piece,) = read_sheet(path).pieces
    np.testing.assert_allclose(np.ptp(piece.outline, axis=0), (120 * metres, 80 * metres))
    (piece,) = read_sheet(path, "cm").pieces  # what the user says counts most
    np.testing.assert_allclose(np.ptp(piece.outline, axis=0), (1.2, 0.8))


def test_legs_points_and_the_mirror_line_of_a_graded_nest(tmp_path, capsys):
    legs = (
        polyline([*BOX[:2]])
        + polyline([BOX[1], (60, 85), BOX[2]])
        + polyline(BOX[2:])
        + polyline([BOX[3], BOX[0]])
    )
    marks = tags((0, "POINT"), (8, "2"), (10, 0), (20, 0)) + line((10, 40), (110, 40), "7")
    half = legs + marks + line(BOX[0], BOX[1], "6") + tags((0, "POINT"), (8, "13"), (10, 50), (20, 50))
    path = aama(tmp_path, {"FR_42": half, "FR_44": half}, "UNITS: METRIC")
    found = read_sheet(path)
    assert [piece.name for piece in found.pieces] == ["FR_42", "FR_44"]
    for piece in found.pieces:
        np.testing.assert_allclose(np.abs(piece.fold), [[0, 0], [0, 0.08]], atol=1e-12)
        assert piece.lines == ()  # the mirror line is no inner line
        np.testing.assert_allclose(np.ptp(piece.grain, axis=0), (0.1, 0))
    assert found.left_out["on layer 13 (drill holes)"] == 2
    assert found.left_out["on layer 2 (turn points)"] == 2
    assert cli.main(["mesh", str(path), "--list"]) == 0
    told = capsys.readouterr()
    assert told.out.count("half") == 2
    assert told.err.count("left out of") == 1  # in one line
    assert "half of it is drawn: FR_42, FR_44" in told.err


def test_blocks_that_nothing_inserts_are_the_pieces(tmp_path):
    path = aama(tmp_path, {"BACK": polyline(BOX, closed=1)}, "UNITS: METRIC", inserted=False)
    found = read_sheet(path)
    assert sizes(found) == {"BACK": (120, 80)}
    assert "nothing is inserted" in found.remarks[0]


def test_layers_in_chinese_say_their_lines(tmp_path):
    drawing = ezdxf.filemanagement.new("R2010", units=5)
    space = drawing.modelspace()
    for layer, low in (("毛样", 0), ("净样", 1)):
        corners = [(low, low), (30 - low, low), (30 - low, 50 - low), (low, 50 - low)]
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})
    space.add_line((15, 5), (15, 45), dxfattribs={"layer": "纱向线"})
    space.add_line((0, 25), (0.5, 25), dxfattribs={"layer": "刀口"})
    drawing.saveas(tmp_path / "sheet.dxf")
    (piece,) = read_sheet(tmp_path / "sheet.dxf").pieces
    np.testing.assert_allclose(np.ptp(piece.cut, axis=0), (0.3, 0.5))
    np.testing.assert_allclose(np.ptp(piece.sew, axis=0), (0.28, 0.48))
    assert piece.grain is not None
    assert len(piece.notches) == 1


def test_a_drawing_with_the_line_ends_of_old_macintoshes(tmp_path):
    path = aama(tmp_path, {"BOX": polyline(BOX, closed=1)}, "UNITS: METRIC")
    path.write_bytes(path.read_bytes().replace(b"\n", b"\r"))
    assert sizes(read_sheet(path)) == {"BOX": (120, 80)}


@pytest.mark.parametrize(
    ("name", "encoding"),
    [
        ("前片_M码", "gb18030"),
        ("前片", "gb18030"),
        ("前片_M码", "utf-8"),
        ("Rücken", "utf-8"),
        ("Перед", "utf-8"),
    ],
)
def test_names_are_read_without_a_code_page(tmp_path, name, encoding):
    path = aama(tmp_path, {"FRONT": polyline(BOX, closed=1)}, "UNITS: METRIC")
    path.write_bytes(path.read_bytes().replace(b"FRONT", name.encode(encoding)))
    assert sizes(read_sheet(path)) == {name: (120, 80)}
    path.write_bytes(path.read_bytes().replace(name.encode(encoding), b"\xc4RMEL"))
    assert sizes(read_sheet(path)) == {"ÄRMEL": (120, 80)}


def test_a_binary_drawing_cut_off_is_one_line(tmp_path):
    ezdxf.filemanagement.new("R2010").saveas(tmp_path / "sheet.dxf", fmt="bin")
    whole = (tmp_path / "sheet.dxf").read_bytes()
    for end in (2999, 3000, 3001, 3003, 3007):
        (tmp_path / "sheet.dxf").write_bytes(whole[:end])
        with pytest.raises(FileProblem, match="not a DXF file|no closed line"):
            read_sheet(tmp_path / "sheet.dxf")
    assert issubclass(struct.error, Exception)


def test_a_circle_beyond_the_range_ends_before_it_is_cut_into_steps(tmp_path):
    drawing = ezdxf.filemanagement.new("R2010", units=4)
    drawing.modelspace().add_circle((0, 0), 1e30)
    drawing.saveas(tmp_path / "sheet.dxf")
    with pytest.raises(FileProblem, match="leaves the range"):
        read_sheet(tmp_path / "sheet.dxf")


@pytest.mark.parametrize("encoding", ["iso-8859-1", "utf-16", "utf-8", "gb2312", "cp1251"])
def test_an_svg_is_decoded_as_it_says(tmp_path, encoding):
    name = {"gb2312": "前片", "cp1251": "Перед", "iso-8859-1": "Ärmel"}.get(encoding, "前片 Ärmel")
    text = f'<?xml version="1.0" encoding="{encoding}"?>' + SIZED + FRONT.replace("front", name) + "</svg>"
    assert sizes(svg(tmp_path, text, encoding)) == {name: (200, 300)}


ONE_LINE = {
    "no encoding that is known": (
        '<?xml version="1.0" encoding="klingon"?>' + SIZED + "</svg>",
        "encoding 'klingon'",
    ),
    "an encoding of bytes": ('<?xml version="1.0" encoding="hex"?>' + SIZED + "</svg>", "hex"),
    "compressed": (b"\x1f\x8b\x08" + bytes(40), "compressed"),
    "latin without a word": ((SIZED + "<!-- \xc4 --></svg>").encode("latin-1"), "not UTF-8"),
    "entities": ('<!DOCTYPE s [<!ENTITY a "x"><!ENTITY b "&a;&a;">]>' + SIZED + "</svg>", "entities within"),
    "a file from outside": (
        '<!DOCTYPE s [<!ENTITY x SYSTEM "file:///etc/passwd">]>' + SIZED + "</svg>",
        "entities",
    ),
    "letters high": (HEAD + 'width="90em" viewBox="0 0 9 9">' + FRONT + "</svg>", "--units"),
}


@pytest.mark.parametrize("what", ONE_LINE)
def test_what_cannot_be_read_is_one_line_with_one_remedy(tmp_path, what):
    text, message = ONE_LINE[what]
    with pytest.raises(FileProblem, match=message) as told:
        svg(tmp_path, text)
    assert str(told.value).count("sheet.svg") == 1
    assert str(told.value).count(" – ") == 1


@pytest.mark.parametrize(
    ("head", "millimetres", "guessed"),
    [
        ('width=" 900 MM " height="600MM" viewBox="0,0,900,600"', 1, False),
        ('width="3600Q" viewBox="0 0 900 600"', 1, False),
        ('freesewing="4.10.2" viewBox="0 0 900 600"', 1, False),
        ('viewBox="0 0 900 600"', 25.4 / 96, True),
        ('width="100%" height="100%" viewBox="0 0 900 600"', 25.4 / 96, True),
        ('width="900" height="600"', 25.4 / 96, True),
    ],
)
def test_a_size_that_is_a_guess_is_told(tmp_path, head, millimetres, guessed):
    found = svg(tmp_path, HEAD + head + ">" + FRONT + "</svg>")
    np.testing.assert_allclose(sizes(found)["front"], (200 * millimetres, 300 * millimetres), atol=0.06)
    assert any("CSS pixel" in note for note in found.notes) == guessed


@pytest.mark.parametrize(
    ("size", "millimetres"),
    [
        ('width="800mm" height="300mm"', (200.0, 300.0)),  # as it fits, in the middle
        ('width="800mm" height="300mm" preserveAspectRatio="none"', (400.0, 300.0)),
        ('width="800mm" height="300mm" preserveAspectRatio="xMinYMin slice"', (400.0, 600.0)),
        ('width="400mm" height="299mm"', (200.0, 300.0)),  # rounded
        ('width="400mm" height="100%"', (200.0, 300.0)),
        ('style="width: 40cm; height: 30cm"', (200.0, 300.0)),
    ],
)
def test_a_drawing_has_the_size_at_which_a_browser_shows_it(tmp_path, size, millimetres):
    sheet = svg(
        tmp_path, f'{HEAD} {size} viewBox="0 0 400 300"><path id="front" d="M0 0h200v300h-200z"/></svg>'
    )
    assert sizes(sheet) == {"front": millimetres}
    assert not sheet.notes


def test_an_ampersand_that_is_no_entity_is_one(tmp_path):
    """FreeSewing 4.10 (bruce) writes texts into attributes as they are."""
    text = '<path id="note" class="hidden" data-text="1 & 2 &#160;&amp;" d="M1 1"/>'
    assert sizes(svg(tmp_path, f"{SIZED}{text}{FRONT}</svg>")) == {"front": (200.0, 300.0)}


def test_a_largest_piece_of_a_hand_or_a_hall_is_asked_about(tmp_path):
    small = SIZED + '<path d="M0 0h9v9h-9z"/></svg>'
    large = small.replace("900mm", "900m").replace("600mm", "600m")
    assert "9 mm" in svg(tmp_path, small).notes[0]
    assert "9000" in svg(tmp_path, large.replace("900 600", "0.9 0.6")).notes[0]


def test_what_paints_is_no_piece(tmp_path):
    painting = '<mask id="m"><rect width="800" height="500"/></mask><pattern><rect width="50" height="50"/></pattern>'
    marker = '<marker id="k"><path d="M0 0h90v90h-90z"/></marker>'
    found = svg(tmp_path, SIZED + painting + marker + FRONT.replace(" d=", ' mask="url(#m)" d=') + "</svg>")
    assert sizes(found) == {"front": (200, 300)}
    assert found.pieces[0].holes == ()


LETTERS = {
    "Inkscape": '<g aria-label="L" style="font-size:20px;font-family:Sans"><path d="M60 60h5v30h15v5h-20z"/></g>',
    "cairo": '<defs><g id="glyph-0-1"><path d="M0 0h5v30h15v5h-20z"/></g></defs><use href="#glyph-0-1" x="60" y="60"/>',
    "MuPDF": '<symbol id="font_1_7"><path d="M0 0h5v30h15v5h-20z"/></symbol><use href="#font_1_7" x="60" y="60"/>',
}


@pytest.mark.parametrize("program", LETTERS)
def test_letters_drawn_as_outlines_are_text(tmp_path, program):
    found = svg(tmp_path, SIZED + FRONT + LETTERS[program] + "</svg>")
    (piece,) = found.pieces
    assert piece.holes == ()
    assert found.left_out["text drawn as outlines"] == 1


def test_a_letter_is_no_grain_line_and_a_filled_arrow_is(tmp_path):
    letter = '<path style="fill:#000" d="M60 60h1v12h-1z"/>'
    arrow = '<path style="fill:#000" d="M100 60h2v200h-2z"/>'
    assert svg(tmp_path, SIZED + FRONT + letter + "</svg>").pieces[0].grain is None
    assert svg(tmp_path, SIZED + FRONT + letter + arrow + "</svg>").pieces[0].grain is not None


def test_a_frame_and_a_piece_of_another_file_are_left_out_by_name(tmp_path):
    frame = (
        '<rect width="890" height="590"/><use href="other.svg#x"/><path id="back" d="M310 10h200v300h-200z"/>'
    )
    found = svg(tmp_path, SIZED + frame + FRONT + "</svg>")
    assert set(sizes(found)) == {"back", "front"}
    assert found.left_out["frame around pieces"] == 1
    assert found.left_out["<use> of other.svg#x"] == 1


def test_an_open_line_around_a_piece_is_its_cutting_line_on_the_fold(tmp_path):
    """As a drawing that went through PDF has them: no classes, no groups, the cutting line open at the fold."""
    seam = '<path d="M100 100V400H300V250Q250 150 180 100z"/>'
    cut = '<path d="M100 90H183Q260 145 310 250V410H100"/>'
    (piece,) = svg(tmp_path, SIZED + seam + cut + "</svg>").pieces
    np.testing.assert_allclose(np.ptp(piece.cut, axis=0), (0.21, 0.32), atol=1e-9)
    np.testing.assert_allclose(np.ptp(piece.sew, axis=0), (0.2, 0.3), atol=1e-9)
    assert piece.lines == ()
    pocket = '<path d="M50 60V450H600V60"/>'  # too far away to be an allowance
    (piece,) = svg(tmp_path, SIZED + seam + pocket + "</svg>").pieces
    assert piece.sew is None


def lines_of(*runs) -> str:
    """A line of its own for each step of a run of points."""
    return "".join(
        f'<line x1="{a[0]}" y1="{a[1]}" x2="{b[0]}" y2="{b[1]}"/>'
        for run in runs
        for a, b in zip(run[:-1], run[1:], strict=True)
    )


RIM = [(0, 0), (150, 0), (300, 0), (300, 200), (150, 200), (0, 200), (0, 0)]


@pytest.mark.parametrize(
    ("inner", "count"),
    [
        ([[(150, 0), (150, 200)]], 1),
        ([[(150, 0), (170, 90), (150, 200)], [(0, 0), (60, 60)]], 2),
        ([[(150, 0), (150, 100), (150, 200)], [(0, 200), (150, 100), (300, 200)]], 4),
    ],
    ids=["from side to side", "bent, and one that hangs", "a star of lines"],
)
def test_an_outline_in_steps_keeps_lines_that_end_at_its_corners(tmp_path, inner, count):
    sheet = svg(tmp_path, f"{SIZED}<g id='front'>{lines_of(RIM, *inner)}</g></svg>")
    assert sizes(sheet) == {"front": (300.0, 200.0)}
    (piece,) = sheet.pieces
    assert len(piece.outline) == 6
    assert len(piece.lines) == count
    assert not piece.holes
    assert "three and more lines meet" in sheet.remarks[0]
    panel_mesh(piece.outline, edge=0.02, constraints=piece.lines)


def test_pieces_in_steps_may_touch_at_a_corner_or_lie_on_each_other(tmp_path):
    other = [(300 + x, 200 + y) for x, y in RIM]
    touching = svg(tmp_path, f"{SIZED}{lines_of(RIM, other)}</svg>")
    assert sorted(sizes(touching).values()) == [(300.0, 200.0)] * 2
    across = [(0, 0), (400, 100), (150, 200), (0, 0)]  # leaves the first where neither has a corner
    with pytest.raises(FileProblem, match="no closed line"):
        svg(tmp_path, f"{SIZED}{lines_of(RIM, across)}</svg>")


def test_a_line_drawn_twice_is_one_and_an_inner_line_ends_at_a_hole(tmp_path, capsys):
    rim = FRONT.replace("front", "rim")
    hole, line = '<path d="M80 100h40v40h-40z"/>', '<path d="M20 120h180"/>'
    (tmp_path / "sheet.svg").write_text(SIZED + FRONT + rim + hole + line + "</svg>")
    found = read_sheet(tmp_path / "sheet.svg")
    assert [len(piece.holes) for piece in found.pieces] == [1]
    assert found.left_out["outlines drawn twice"] == 1
    assert cli.main(["mesh", str(tmp_path / "sheet.svg"), "--edge", "0.02", "--json"]) == 0
    told = capsys.readouterr()
    assert json.loads(told.out)["conformity"] == 1
    assert "1 inner lines are cut off" in told.err


@pytest.mark.nightly
def test_an_outline_of_a_hundred_thousand_teeth_and_a_line_in_it(tmp_path):
    """Growing it by half a millimetre, to see what lies in it, took minutes."""
    teeth = "".join(f"L{10 + k * 0.004:.3f} {10 + (k % 2) * 0.5}" for k in range(100_000))
    comb = f'<path id="front" d="M10 10{teeth}L410 400L10 400z"/><path d="M50 50h50v50h-50z"/>'
    (piece,) = svg(tmp_path, SIZED + comb + "</svg>").pieces
    assert len(piece.holes) == 1


@pytest.mark.parametrize("out", [0.0, 0.3, 0.45])
def test_a_line_inside_may_leave_its_outline_by_half_a_millimetre(tmp_path, out):
    inner = f'<path d="M{10 - out} 50h50v50h-50z"/>'
    assert len(svg(tmp_path, SIZED + FRONT + inner + "</svg>").pieces) == 1
    beyond = f'<path d="M{9.4 - out} 50h50v50h-50z"/>'
    assert len(svg(tmp_path, SIZED + FRONT + beyond + "</svg>").pieces) == 2


def test_the_sheet_of_the_beizi_holds_its_pieces_as_drafted():
    found = read_sheet(SHEETS / "beizi.svg")
    drafted = {panel.name: panel.outline() for panel in Pattern.load(PATTERNS / "beizi.toml").panels}
    assert [piece.name for piece in found.pieces] == ["body", "sleeve", "cuff", "band"]
    for piece in found.pieces:
        assert abs(signed_area(piece.sew)) == pytest.approx(abs(signed_area(drafted[piece.name])), rel=1e-3)
        assert piece.grain is not None
        assert (piece.fold is not None) == (piece.name == "band")
        assert panel_mesh(piece.cut, edge=0.04).report.conformity == 1
    assert [len(piece.notches) for piece in found.pieces] == [4, 1, 0, 0]
    assert found.left_out["scalebox"] == found.left_out["frame around pieces"] == 1


def test_pieces_that_lie_on_each_other_are_drawn_apart():
    found = read_sheet(SHEETS / "garmentcode-lapel.json")
    boxes = [(p.outline.min(axis=0), p.outline.max(axis=0)) for p in apart(found.pieces)]
    for k, (low, high) in enumerate(boxes):
        assert all((high <= a).any() or (low >= b).any() for a, b in boxes[:k])
    beizi = read_sheet(SHEETS / "beizi.svg")
    assert apart(beizi.pieces) == list(beizi.pieces)
    picture = sheet_picture(beizi)
    assert picture.shape[1] == 1600
    for colour in ((200, 40, 40), (20, 130, 70), (30, 90, 190)):  # notches, grain, seams
        assert (np.abs(picture.astype(int) - colour).sum(axis=2) < 12).sum() > 40


def test_the_list_is_drawn_as_jpeg_too(tmp_path):
    out = tmp_path / "sheet.jpg"
    assert cli.main(["mesh", str(SHEETS / "beizi.svg"), "--list", "--picture", str(out)]) == 0
    assert out.read_bytes().startswith(b"\xff\xd8")
    assert out.stat().st_size < 150_000


# --- GarmentCode and pattern files


def code(tmp_path, change) -> Path:
    values = json.loads((SHEETS / "garmentcode-lapel.json").read_text())
    change(values["pattern"]["panels"]["left_btorso"], values)
    (tmp_path / "code.json").write_text(json.dumps(values))
    return tmp_path / "code.json"


def twice(panel, _):
    panel["edges"] += panel["edges"]


def nowhere(panel, _):
    panel["vertices"] = [[1, 1] for _ in panel["vertices"]]


def to_itself(_, values):
    values["pattern"]["stitches"].append([{"panel": "left_btorso", "edge": 0}] * 2)


@pytest.mark.parametrize(
    ("change", "message"),
    [(twice, "twice through a vertex"), (nowhere, "in one place"), (to_itself, "to itself – name two edges")],
)
def test_a_panel_that_is_none_is_one_line(tmp_path, change, message):
    with pytest.raises(FileProblem, match=message):
        read_sheet(code(tmp_path, change))


def test_absolute_control_points_of_old_files_are_the_same_curves(tmp_path):
    def panels(curvature, coords):
        edges = [{"endpoints": [k, (k + 1) % 4]} for k in range(4)]
        edges[1]["curvature"] = curvature
        panel = {"vertices": [[0, 0], [0, 50], [30, 50], [30, 0]], "edges": edges}
        values = {
            "pattern": {"panels": {"front": panel}, "stitches": []},
            "properties": {"curvature_coords": coords},
        }
        made = read_garment_code(tmp_path, values)
        assert made.to_dict() == values
        return made.outline("front")

    np.testing.assert_allclose(panels([0.5, -0.2], "relative"), panels([15, 44], "absolute"), atol=1e-12)


@pytest.mark.parametrize("radius", [66.0, 66.3, 66.394, 66.5, 67.0, 70.0])
def test_a_seam_that_is_written_is_one_that_can_be_read(tmp_path, capsys, radius):
    """A waistband on an arc of 135 degrees (GarmentCode's flared skirt): 2 % ease in arcs are 2.1 % in cubics."""

    def arc(start, end, radius, right):
        return {"endpoints": [start, end], "curvature": {"type": "circle", "params": [radius, 0, right]}}

    def panel(vertices, edges):
        return {"translation": [0, 0, 0], "rotation": [0, 0, 0], "vertices": vertices, "edges": edges}

    plain = [{"endpoints": ends} for ends in ([1, 2], [2, 3], [3, 0])]
    skirt = panel([[-0.5, 0], [32.567, 0], [70, -15.5], [-38, -15.5]], [arc(0, 1, 17.896, 1), *plain])
    band = panel([[0, 0], [40.664, 0], [40.664, 30], [0, 30]], [arc(0, 1, radius, 1), *plain])
    stitch = [{"panel": "skirt", "edge": 0}, {"panel": "band", "edge": 0}]
    written = {
        "pattern": {"panels": {"skirt": skirt, "band": band}, "stitches": [stitch]},
        "properties": {"curvature_coords": "relative", "units_in_meter": 100},
    }
    source, pattern, back = (tmp_path / name for name in ("skirt.json", "skirt.toml", "back.json"))
    source.write_text(json.dumps(written))
    assert cli.main(["mesh", str(source), "--pattern", str(pattern)]) == 0
    gathered = "gathered" in capsys.readouterr().err
    assert cli.main(["mesh", str(pattern), "--pattern", str(back)]) == 0
    assert len(json.loads(back.read_text())["pattern"]["stitches"]) == (0 if gathered else 1)


@pytest.mark.parametrize("path", sorted(PATTERNS.glob("*.toml")), ids=lambda path: path.stem)
def test_a_pattern_file_comes_back_from_garment_code_as_it_was(tmp_path, path):
    there, back, again = tmp_path / "a.json", tmp_path / "b.toml", tmp_path / "c.json"
    for source, out in ((path, there), (there, back), (back, again)):
        assert cli.main(["mesh", str(source), "--pattern", str(out)]) == 0
    assert tomllib.loads(back.read_text()) == tomllib.loads(path.read_text())
    assert Pattern.load(back).to_dict() == Pattern.load(path).to_dict()
    assert json.loads(again.read_text()) == json.loads(there.read_text())


@pytest.mark.parametrize("name", ["beizi", "robe", "pibo-long"])
def test_the_stitches_of_a_pattern_file_join_what_its_seams_join(tmp_path, name):
    """Every stitch joins lengths that fit, and its ends are ends of the seam's legs, first point to first point."""
    path, out = PATTERNS / f"{name}.toml", tmp_path / "code.json"
    assert cli.main(["mesh", str(path), "--pattern", str(out)]) == 0
    made = read_garment_code(out, json.loads(out.read_text()))
    pattern = Pattern.load(path)
    panels = {panel.name: panel for panel in pattern.panels}
    for panel_name, panel in made.panels.items():
        assert signed_area(made.outline(panel_name)) * signed_area(made.outline(next(iter(made.panels)))) > 0
        assert len(panel.edges) >= 4
        read_back = made.outline(panel_name) * ((-1, 1) if panel_name.endswith("_other") else (1, 1))
        drafted = panels[panel_name.removesuffix("_other")].outline()
        assert abs(signed_area(read_back)) == pytest.approx(abs(signed_area(drafted)), rel=1e-4)
    joined = []
    for stitch in made.stitches:
        a, b = made.leg(*stitch.a), made.leg(*stitch.b)
        b = b if stitch.right_wrong else b[::-1]
        lengths = [np.hypot(*np.diff(leg, axis=0).T).sum() for leg in (a, b)]
        assert lengths[0] == pytest.approx(lengths[1], rel=0.05)  # of a whole seam 0.02
        joined.append((stitch.a[0], stitch.b[0], a[0], b[0], a[-1], b[-1]))
    for seam in pattern.seams:
        legs = seam.a.legs(panels[seam.a.panel])
        start_a, end_a = legs[0][0], legs[-1][-1]
        if seam.b is None:
            names, start_b, end_b = (
                (seam.a.panel, f"{seam.a.panel}_other"),
                start_a * (-1, 1),
                end_a * (-1, 1),
            )
        else:
            other = seam.b.legs(panels[seam.b.panel])
            names, start_b, end_b = (seam.a.panel, seam.b.panel), other[0][0], other[-1][-1]
        for point, mate in ((start_a, start_b), (end_a, end_b)):
            assert any(
                names == row[:2]
                and np.allclose(row[k], point, atol=1e-9)
                and np.allclose(row[k + 1], mate, atol=1e-9)
                for row in joined
                for k in (2, 4)
            )


def test_what_somebody_changed_is_a_pattern_file_of_its_own(tmp_path, capsys):
    there, back = tmp_path / "a.json", tmp_path / "b.toml"
    assert cli.main(["mesh", str(PATTERNS / "pibo-long.toml"), "--pattern", str(there)]) == 0
    values = json.loads(there.read_text())
    for panel in values["pattern"]["panels"].values():
        panel["vertices"] = [[x, 1.5 * y] for x, y in panel["vertices"]]
    there.write_text(json.dumps(values))
    capsys.readouterr()
    assert cli.main(["mesh", str(there), "--pattern", str(back)]) == 0
    assert "changed since it was a pattern file" in capsys.readouterr().err
    made = Pattern.load(back)
    assert np.ptp(made.panels[0].outline(), axis=0)[1] == pytest.approx(1.5 * 0.42)
    assert len(made.seams) == 1


def test_hostile_tables_are_not_written(tmp_path, capsys):
    there, back = tmp_path / "a.json", tmp_path / "b.toml"
    for tables in (
        [],
        None,
        {"a": None},
        {"a": [1, {"b": 2}], "c": {"d": [{"e": None}]}},
        {"\n": float("nan")},
    ):
        assert cli.main(["mesh", str(PATTERNS / "pibo.toml"), "--pattern", str(there)]) == 0
        values = json.loads(there.read_text())
        values["pattern_file"]["tables"] = tables
        there.write_text(json.dumps(values))
        assert cli.main(["mesh", str(there), "--pattern", str(back)]) == 0
        assert len(Pattern.load(back).panels) == 1
    capsys.readouterr()


def test_a_pattern_file_is_listed_and_its_panel_meshed(capsys):
    path = str(PATTERNS / "beizi.toml")
    assert cli.main(["mesh", path, "--list", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["pieces"]
    assert [row["piece"] for row in rows][:5] == ["body", "sleeve", "cuff", "band", "body_other"]
    assert cli.main(["mesh", path, "--piece", "sleeve", "--edge", "0.04", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["conformity"] == 1


def test_tables_become_toml_and_the_same_tables():
    tables = {
        "name": 'a "b" \\ \x7f\n前',
        "edge": 1e-05,
        "mirror": True,
        "title": {"zh": "褙子", "en-GB x": "coat"},
        "measures": {"a": 1, "b": "2 * a"},
        "panel": [
            {"name": "p", "outline": [{"name": "q", "at": [0, "a"], "curve": [[1.5, 2], [3, 4]]}]},
            {"name": "r"},
        ],
        "none": [],
    }
    assert tomllib.load(io.BytesIO(toml_text(tables).encode())) == tables
