"""Pattern sheets: pieces of SVG and DXF with many, their lines, notches and grain, and GarmentCode in and out."""

import json
from pathlib import Path

import ezdxf.filemanagement
import numpy as np
import pytest

from sim_core import cli
from sim_core.errors import FileProblem
from sim_core.garment.pattern import Pattern
from sim_core.mesh import panel_mesh
from sim_core.mesh.outline import signed_area
from sim_core.mesh.sheets import Choice, panel_of, read_garment_code, read_sheet

SHEETS = Path(__file__).parent / "sheets"
HEAD = '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
SIZED = HEAD + 'width="900mm" height="600mm" viewBox="0 0 900 600">'
DEFINED = '<defs><g id="notch"><circle r="2" class="fill-note"/></g><g id="logo"><path d="M0 0h30v30h-30z"/></g></defs>'
STYLED = "<style>.sa { stroke-dasharray: 0.4, 0.8 } .hidden { stroke: none }</style>"
FRONT = """<g id="fs-stack-shirt.front" transform="translate(100,50)"><g id="fs-stack-shirt.front-part-shirt.front">
<path class="fabric" d="M0 0 L0 400 L200 400 C200 300 250 200 200 100 L120 0 z"/>
<path class="fabric sa" d="M0 410 L210 410 C210 305 262 195 209 95 L126 -10 L0 -10"/>
<path class="note" marker-start="url(#grainlineFrom)" d="M40 380 L40 40"/>
<path class="lining dashed" d="M10 150 L180 150"/><text>front</text>
<path class="hidden" d="M10 10 L90 10 L90 90 z"/><path class="fabric help" d="M20 200 L100 200"/>
<use x="120" y="0" xlink:href="#notch" transform="translate(0,0)"/><use x="60" y="200" xlink:href="#logo"/></g></g>"""
POCKET = """<g id="pocket" transform="translate(500,50) rotate(90)"><path class="lining" d="M0 0h160v-120h-160z"/>
<circle class="hole" cx="80" cy="-60" r="20"/></g>"""
SHIRT = (
    SIZED
    + DEFINED
    + STYLED
    + FRONT
    + POCKET
    + '<rect class="scalebox" x="5" y="5" width="50" height="20"/></svg>'
)

pytestmark = pytest.mark.filterwarnings("ignore:left out of:sim_core.errors.OutlineWarning")


def sheet(tmp_path, text: str, **how):
    path = tmp_path / "sheet.svg"
    path.write_text(text)
    return read_sheet(path, **how)


def area(contour) -> float:
    return abs(signed_area(np.asarray(contour)))


def test_pieces_have_their_names_lines_and_marks(tmp_path):
    found = sheet(tmp_path, SHIRT)
    assert [piece.name for piece in found.pieces] == ["shirt.front", "pocket-lining"]
    front, pocket = found.pieces
    assert front.layer == "fabric"
    assert area(front.cut) > area(front.sew) > 0.079
    assert len(front.lines) == 1  # drawn inside, not cut
    np.testing.assert_allclose(front.notches, [[0.22, 0.05]], atol=1e-12)
    np.testing.assert_allclose(front.grain, [[0.14, 0.43], [0.14, 0.09]], atol=1e-12)
    assert pocket.cut is None
    assert area(pocket.sew) == pytest.approx(0.16 * 0.12)
    np.testing.assert_allclose(pocket.sew.min(axis=0), (0.5, 0.05), atol=1e-12)
    assert [area(hole) for hole in pocket.holes] == [pytest.approx(np.pi * 4e-4, rel=1e-3)]
    assert found.left_out["scalebox"] == 1
    assert any("shirt.front: its cut line is open" in remark for remark in found.remarks)


@pytest.mark.parametrize(("units", "metres"), [(None, 0.0254 / 96), ("mm", 1e-3), ("in", 0.0254)])
def test_a_drawing_without_a_size_has_the_unit_that_is_said(tmp_path, units, metres):
    text = HEAD + 'viewBox="0 0 900 600"><rect id="cuff" width="100" height="50"/></svg>'
    (piece,) = sheet(tmp_path, text, units=units).pieces
    assert piece.name == "cuff"
    np.testing.assert_allclose(np.ptp(piece.outline, axis=0), (100 * metres, 50 * metres))


def test_layers_that_say_their_lines_make_no_pieces_of_their_names(tmp_path):
    """Inkscape: pieces in one layer, grain and notches in others; a page frame around everything."""
    body = """<rect width="890" height="590"/>
    <g inkscape:label="Cut lines"><path id="back" d="M20 20h200v300h-200z"/>
    <path id="yoke" d="M300 20h200v100h-200z"/></g>
    <g inkscape:label="Sew lines"><path d="M30 30h180v280h-180z"/></g>
    <g inkscape:label="Grainlines"><path d="M100 50v200"/><path d="M400 40v50"/></g>
    <g inkscape:label="Notches"><path d="M20 100h5"/></g></svg>"""
    head = SIZED.replace("<svg ", '<svg xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" ')
    found = sheet(tmp_path, head + body)
    assert [(piece.name, piece.sew is not None) for piece in found.pieces] == [
        ("back", True),
        ("yoke", False),
    ]
    back, yoke = found.pieces
    np.testing.assert_allclose(back.notches, [[0.02, 0.1]])
    assert back.grain is not None
    assert yoke.grain is not None
    assert back.holes == yoke.holes == ()


@pytest.mark.parametrize("name", ["valentina-r12-astm.dxf", "valentina-r10-aama.dxf", "valentina.svg"])
def test_files_of_valentina_hold_both_pieces_as_drafted(name):
    found = read_sheet(SHEETS / name)
    front, godet = found.pieces
    if name.endswith(".dxf"):
        assert [piece.name for piece in found.pieces] == ["FRONT", "GODET"]
    assert area(front.cut) == pytest.approx(0.32 * 0.22, rel=1e-4)
    assert area(front.sew) == pytest.approx(0.3 * 0.2, rel=1e-4)
    assert area(godet.sew) == pytest.approx(0.3 * 0.2 / 2, rel=1e-4)
    assert len(front.notches) == 1
    assert len(front.lines) == 1
    assert front.holes == godet.holes == ()
    for piece, length in ((front, 0.15), (godet, 0.05)):
        assert np.hypot(*(piece.grain[1] - piece.grain[0])) == pytest.approx(length, rel=1e-3)


def test_binary_dxf_is_the_same_sheet(tmp_path):
    made = ezdxf.filemanagement.readfile(SHEETS / "valentina-r12-astm.dxf")
    made.saveas(tmp_path / "binary.dxf", fmt="bin")
    text, binary = (read_sheet(path) for path in (SHEETS / "valentina-r12-astm.dxf", tmp_path / "binary.dxf"))
    for a, b in zip(text.pieces, binary.pieces, strict=True):
        assert a.name == b.name
        np.testing.assert_allclose(a.outline, b.outline, atol=1e-9)


def test_a_drawing_of_another_code_page_is_read(tmp_path):
    path = tmp_path / "sheet.dxf"
    text = (SHEETS / "valentina-r10-aama.dxf").read_bytes().replace(b"FRONT", b"\xc4RMEL")
    path.write_bytes(text)
    assert [piece.name[1:] for piece in read_sheet(path).pieces] == ["RMEL", "ODET"]


@pytest.mark.parametrize(
    ("choice", "wanted"),
    [
        (Choice("FRONT"), 0.32 * 0.22),
        (Choice("FRONT", "sew"), 0.3 * 0.2),
    ],
)
def test_a_piece_is_meshed_along_the_line_that_is_chosen(choice, wanted):
    path = SHEETS / "valentina-r12-astm.dxf"
    piece, remark = panel_of(path, read_sheet(path), choice)
    mesh = panel_mesh(piece.outline, edge=0.02, constraints=piece.lines)
    assert sum(area(mesh.vertices[loop]) for loop in mesh.boundary) == pytest.approx(wanted, rel=1e-4)
    assert not remark


@pytest.mark.parametrize(("line", "wanted"), [("cut", 0.12 * 0.07), ("sew", 0.08 * 0.03)])
def test_an_allowance_makes_the_line_that_is_not_drawn(tmp_path, line, wanted):
    path = tmp_path / "sheet.svg"
    path.write_text(SIZED + '<rect width="100" height="50"/></svg>')
    piece, remark = panel_of(path, read_sheet(path), Choice(line=line, allowance=0.01))
    assert area(piece.outline) == pytest.approx(wanted)
    assert not remark


def test_small_loops_of_an_offset_line_are_left_out_and_a_bow_is_not(tmp_path):
    loop = '<path d="M0 0 H200 V95 L198 97 L202 97 L200 95 V200 H0 z"/></svg>'
    found = sheet(tmp_path, SIZED + loop)
    assert area(found.pieces[0].outline) == pytest.approx(0.04, rel=1e-3)
    assert "crosses itself" in found.remarks[0]
    bow = sheet(tmp_path, SIZED + '<path d="M0 0 L100 100 L100 0 L0 100 z"/></svg>')
    with pytest.raises(ValueError, match="crosses or touches itself"):
        panel_mesh(bow.pieces[0].outline, edge=0.02)


def test_the_command_lists_chooses_and_draws(tmp_path, capsys):
    path, picture = tmp_path / "shirt.svg", tmp_path / "shirt.png"
    path.write_text(SHIRT)
    assert cli.main(["mesh", str(path), "--list", "--json", "--picture", str(picture)]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [row["piece"] for row in told["pieces"]] == ["shirt.front", "pocket-lining"]
    assert told["pieces"][0]["lines"] == ["cut", "sew"]
    assert told["pieces"][0]["grain_deg"] == 90
    assert told["left_out"]["scalebox"] == 1
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert cli.main(["mesh", str(path), "--list", "--layer", "lining"]) == 0
    assert "1 piece\n" in capsys.readouterr().out
    assert cli.main(["mesh", str(path), "--piece", "pocket-lining", "--edge", "0.02"]) == 0
    assert "only its sew line is drawn" in capsys.readouterr().err


REFUSED = {
    "--edge 0.02": (1, "2 pieces – choose one with --piece NAME: shirt.front, pocket-lining"),
    "--edge 0.02 --piece sleeve": (1, "piece 'sleeve': no such piece – pieces: shirt.front"),
    "--list --layer velvet": (1, "layer 'velvet': no piece on it – layers: fabric, lining"),
    "--piece pocket-lining": (2, "--edge: missing"),
    "--pattern shirt.svg": (2, "end the name with .toml or .json"),
    "--piece pocket-lining --line cut --allowance 300 --edge 0.02": (2, "--allowance"),
}


@pytest.mark.parametrize("words", REFUSED)
def test_what_a_sheet_does_not_hold_is_one_line(tmp_path, capsys, words):
    path = tmp_path / "shirt.svg"
    path.write_text(SHIRT)
    status, message = REFUSED[words]
    command = ["mesh", str(path), *words.split()]
    if words in ("--pattern shirt.svg", "--piece pocket-lining --line cut --allowance 300 --edge 0.02"):
        with pytest.raises(SystemExit, match="2"):  # what no sheet could make right
            cli.main(command)
    else:
        assert cli.main(command) == status
    assert message in capsys.readouterr().err


def test_pieces_become_a_pattern_file_within_a_fifth_of_a_millimetre(tmp_path):
    path, out = tmp_path / "shirt.svg", tmp_path / "shirt.toml"
    path.write_text(SHIRT)
    assert cli.main(["mesh", str(path), "--pattern", str(out), "--line", "sew"]) == 0
    made = Pattern.load(out)
    assert [panel.name for panel in made.panels] == ["shirt_front", "pocket_lining"]
    given = {piece.name: piece for piece in read_sheet(path).pieces}
    for panel, name in zip(made.panels, given, strict=True):
        drawn = panel.outline()
        assert area(drawn) == pytest.approx(area(given[name].sew), rel=2e-3)
        steps = np.diff(np.vstack([drawn, drawn[:1]]), axis=0)
        for point in given[name].sew:
            along = np.clip(((point - drawn) * steps).sum(axis=1) / (steps * steps).sum(axis=1), 0, 1)
            assert np.hypot(*(point - drawn - along[:, None] * steps).T).min() < 2.5e-4


def test_garment_code_is_written_back_as_it_was(tmp_path):
    path, out = SHEETS / "garmentcode-lapel.json", tmp_path / "out.json"
    assert cli.main(["mesh", str(path), "--pattern", str(out)]) == 0
    assert json.loads(out.read_text()) == json.loads(path.read_text())


def test_panels_of_garment_code_mesh_and_their_arc_bulges_to_its_side():
    path = SHEETS / "garmentcode-lapel.json"
    code = read_garment_code(path, json.loads(path.read_text()))
    arc = code.leg("left_btorso", 1) * (1, -1)
    radius, chord = 0.18181667037263562, arc[-1] - arc[0]
    side = chord[0] * (arc - arc[0])[:, 1] - chord[1] * (arc - arc[0])[:, 0]
    assert side.min() < -1e-4  # a true third number: to the right of the edge
    assert side.max() < 1e-9
    turns = np.diff(np.unwrap(np.arctan2(*np.diff(arc, axis=0).T[::-1])))
    assert np.hypot(*np.diff(arc, axis=0).T).mean() / turns.mean() == pytest.approx(radius, rel=1e-2)
    for piece in read_sheet(path).pieces:
        assert panel_mesh(piece.outline, edge=0.01).report.conformity == 1


def test_stitches_of_garment_code_become_seams_with_their_direction(tmp_path):
    path, out = SHEETS / "garmentcode-lapel.json", tmp_path / "lapel.toml"
    assert cli.main(["mesh", str(path), "--pattern", str(out)]) == 0
    made = Pattern.load(out)
    seams = {(str(seam.a), str(seam.b)) for seam in made.seams}
    assert (
        "left_ftorso: p3 > p4",
        "left_btorso: p3 < p2",
    ) in seams  # beginning to end: right side on right side
    text = out.read_text()
    assert (
        'sewn = ["left_ftorso: p4 > p5", "left_collar_front: p1 > p2"]' in text
    )  # right_wrong: beginning to beginning
    panels = {panel.name: panel for panel in made.panels}
    for seam in made.seams:
        lengths = [way.length(panels[way.panel]) for way in (seam.a, seam.b)]
        assert abs(lengths[0] - lengths[1]) <= 0.02 * max(lengths)


BROKEN = {
    "vertices": (["pattern", "panels", "left_btorso", "vertices"], [[0, 0], [1, "2"]], "vertex 1"),
    "endpoints": (
        ["pattern", "panels", "left_btorso", "edges", 0, "endpoints"],
        [0, 99],
        "edge 0: endpoints",
    ),
    "order": (
        ["pattern", "panels", "left_btorso", "edges", 0, "endpoints"],
        [0, 2],
        "do not follow each other",
    ),
    "curve": (
        ["pattern", "panels", "left_btorso", "edges", 1, "curvature", "type"],
        "spiral",
        "edge 1: curvature",
    ),
    "radius": (
        ["pattern", "panels", "left_btorso", "edges", 1, "curvature", "params"],
        [0, 0, 1],
        "edge 1: circle",
    ),
    "stitch": (["pattern", "stitches", 0, 0, "panel"], "sleeve", "stitch 0"),
    "word": (["pattern", "stitches", 1, 2], "wrong_right", "stitch 1"),
    "units": (["properties", "units_in_meter"], 0, "units_in_meter"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_specification_is_one_line(tmp_path, name):
    where, value, message = BROKEN[name]
    values = json.loads((SHEETS / "garmentcode-lapel.json").read_text())
    held = values
    for key in where[:-1]:
        held = held[key]
    held[where[-1]] = value
    path = tmp_path / "broken.json"
    path.write_text(json.dumps(values))
    with pytest.raises(FileProblem, match=message) as told:
        read_sheet(path)
    assert "–" in str(told.value)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("name", ["valentina.svg", "valentina-r12-astm.dxf", "garmentcode-lapel.json"])
def test_a_damaged_file_is_a_sheet_or_one_line(tmp_path, name):
    rng = np.random.default_rng(20)
    given = (SHEETS / name).read_bytes()
    path = tmp_path / name
    for _ in range(60):
        text = bytearray(given)
        for place in rng.integers(0, len(text), 8).tolist():
            damage = (b"", b"1e308", b"nan", b"-1", b"\xff", b"<", b"0\n")[int(rng.integers(7))]
            text[place : place + int(rng.integers(1, 12))] = damage
        path.write_bytes(text)
        try:
            assert read_sheet(path).pieces
        except FileProblem as error:
            said = str(error)  # noqa: PT017 - either is right, so `raises` does not fit
            assert said.startswith(f"{path}: ")  # noqa: PT017
            assert "\n" not in said  # noqa: PT017
