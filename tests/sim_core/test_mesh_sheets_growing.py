"""Sheets that grow: four times as many lines or outlines are about four times the work."""

import sys
import tracemalloc
from time import perf_counter

import numpy as np
import pytest
import shapely

from sim_core.errors import FileProblem
from sim_core.mesh.sheets import Choice, panel_of, read_sheet

HEAD = '<svg xmlns="http://www.w3.org/2000/svg" width="4000mm" height="4000mm" viewBox="0 0 4000 4000">'
PAGE = '<rect x="100" y="100" width="1800" height="1800"/>'

pytestmark = pytest.mark.filterwarnings("ignore:left out of:sim_core.errors.OutlineWarning")


def read(tmp_path, *drawn: str):
    path = tmp_path / "sheet.svg"
    path.write_text(HEAD + "".join(drawn) + "</svg>")
    return read_sheet(path)


def around(count: int, radius: float = 800.0) -> np.ndarray:
    turns = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return 1000 + radius * np.column_stack([np.cos(turns), np.sin(turns)])


def fan(count: int) -> str:
    """Lines that all begin in one point."""
    return PAGE + "".join(f'<path d="M1000 1000 L{x:.4f} {y:.4f}"/>' for x, y in around(count))


def wheel(count: int) -> str:
    """The same with a rim."""
    rim = around(count)
    steps = np.column_stack([rim, np.roll(rim, -1, axis=0)])
    return "".join(
        f'<path d="M1000 1000 L{a:.4f} {b:.4f}"/><path d="M{a:.4f} {b:.4f} L{c:.4f} {d:.4f}"/>'
        for a, b, c, d in steps
    )


def stairs(count: int) -> str:
    """Outlines that all lie on each other, none in another."""
    return "".join(
        f'<rect x="{10 + 0.7 * k:.1f}" y="{10 + 0.7 * k:.1f}" width="1500" height="1500"/>'
        for k in range(count)
    )


def nest(count: int) -> str:
    """Outlines that all lie in each other."""
    return "".join(
        f'<rect x="{10 + k}" y="{10 + k}" width="{3900 - 2 * k}" height="{3900 - 2 * k}"/>'
        for k in range(count)
    )


def same(count: int) -> str:
    return '<rect x="10" y="10" width="500" height="400"/>' * count


def calls(tmp_path, text: str) -> int:
    """Functions called, ours and those of libraries, while a sheet is read."""
    found = 0

    def count(_frame, event, _argument):
        nonlocal found
        found += event in ("call", "c_call")

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        read(tmp_path, text)
    finally:
        sys.setprofile(before)
    return found


def held(tmp_path, text: str) -> int:
    """Bytes held at most while a sheet is read."""
    tracemalloc.start()
    try:
        read(tmp_path, text)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("shape", [fan, wheel])
def test_any_number_of_lines_meets_in_one_point(tmp_path, shape):
    read(tmp_path, shape(400))  # what is imported and compiled once does not count
    assert held(tmp_path, shape(2000)) < 6 * held(tmp_path, shape(500))


@pytest.mark.parametrize("shape", [stairs, nest, same])
def test_any_number_of_outlines_lies_on_each_other(tmp_path, shape):
    read(tmp_path, shape(10))
    assert calls(tmp_path, shape(800)) < 6 * calls(tmp_path, shape(200))


def test_lines_that_meet_in_one_point_are_read_as_before(tmp_path):
    assert len(read(tmp_path, fan(500)).pieces[0].lines) == 500
    (piece,) = read(tmp_path, wheel(500)).pieces
    assert len(piece.lines) == 500
    assert len(piece.outline) == 500
    assert len(read(tmp_path, stairs(300)).pieces) == 300
    assert read(tmp_path, same(300)).left_out == {"outlines drawn twice": 299}


def test_slivers_without_end_are_refused_with_a_remedy(tmp_path):
    """Each box holds a quarter of the others, and none of the outlines another."""
    rng = np.random.default_rng(0)
    ends = rng.uniform(100, 3000, (600, 2))
    slivers = "".join(f'<path d="M5 5L{x:.3f} {y:.3f}L{x - 3:.3f} {y + 3:.3f}z"/>' for x, y in ends)
    with pytest.raises(FileProblem, match=r"sheet\.svg: too many outlines lie on each other – "):
        read(tmp_path, slivers)


@pytest.mark.parametrize("count", [200, 1000, 10_000])
def test_a_scribble_is_no_outline(tmp_path, count):
    """The areas of one of 1,000 random corners would take hours."""
    corners = np.random.default_rng(0).uniform(0, 1900, (count, 2))
    scribble = '<path d="M' + "L".join(f"{x:.3f} {y:.3f}" for x, y in corners) + 'z"/>'
    with pytest.raises(FileProblem, match=r"only lines that cross themselves all over – draw outlines"):
        read(tmp_path, scribble)
    sheet = read(tmp_path, scribble, '<rect x="2000" width="900" height="900"/>')
    assert len(sheet.pieces) == 1
    assert sheet.left_out == {"lines that cross themselves all over": 1}


def test_many_small_loops_are_left_out_of_an_outline_still(tmp_path):
    turns = np.linspace(0, 2 * np.pi, 300 * 24, endpoint=False)
    ring = 1000 + 900 * np.exp(1j * turns) + 4 * np.exp(301j * turns)
    outline = "L".join(f"{z.real:.4f} {z.imag + 100:.4f}" for z in ring)
    sheet = read(tmp_path, f'<path d="M{outline}z"/>')
    assert len(sheet.pieces) == 1
    assert any("small loops are left out" in remark for remark in sheet.remarks)


def teeth(count: int) -> np.ndarray:
    """A star of so many spikes (2 count, 2) [mm]."""
    spikes = np.stack([around(count, 900.0), around(2 * count, 500.0)[1::2]], axis=1)
    return spikes.reshape(-1, 2)


def allowed(tmp_path, outline: np.ndarray, millimetres: float) -> tuple[np.ndarray, float]:
    """The outline with an allowance (n, 2) [m] and the seconds that took."""
    sheet = read(tmp_path, '<path d="M' + "L".join(f"{x:.4f} {y:.4f}" for x, y in outline) + 'z"/>')
    line = "cut" if millimetres > 0 else "sew"
    start = perf_counter()
    piece, _ = panel_of(tmp_path, sheet, Choice(line=line, allowance=abs(millimetres) / 1000))
    return piece.cut, perf_counter() - start


@pytest.mark.parametrize("millimetres", [12.0, -4.0])
@pytest.mark.parametrize("clockwise", [False, True])
def test_an_allowance_around_many_teeth_is_that_of_shapely(tmp_path, millimetres, clockwise):
    outline = teeth(700)[:: -1 if clockwise else 1]
    found, _ = allowed(tmp_path, outline, millimetres)
    wanted = shapely.buffer(shapely.Polygon(outline.round(4)), millimetres, join_style="mitre", mitre_limit=3)
    apart = shapely.symmetric_difference(shapely.Polygon(1000 * found), shapely.Polygon(wanted.exterior))
    assert apart.area < 1e-3  # [mm2] of half a million


@pytest.mark.nightly
@pytest.mark.parametrize("millimetres", [10.0, -10.0])
def test_an_allowance_around_teeth_grows_with_them(tmp_path, millimetres):
    """shapely's own takes 22 times as long."""
    few, many = (
        min(allowed(tmp_path, teeth(count), millimetres)[1] for _ in range(2)) for count in (2500, 10_000)
    )
    assert many < 14 * few
