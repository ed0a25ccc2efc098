"""The hall's own media: in tune, loud enough, as drawn, and the same on every run."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from hall_app.content.models import read_glb
from hall_app.media import (
    ARCS,
    FALLING_GAUZE,
    FINENESS,
    HALL_PIECE,
    RADIUS,
    RATE,
    Touch,
    View,
    back_height,
    bar_notes,
    cutting_plan,
    falling_gauze,
    mirror_glb,
    outfit_plan,
    plan_picture,
    plan_svg,
    pluck,
    weave_drawing,
)
from sim_core.garment import Pattern
from sim_core.garment.pattern import Panel, Seam, Spot, Tie
from sim_core.garment.pattern import Path as Path_

ASSETS = Path(__file__).parents[2] / "assets"


@pytest.mark.parametrize("pitch", [87.31, 130.81, 174.61, 261.63, 349.23, 698.46])
def test_strings_are_in_tune(pitch: float):
    note = pluck(pitch, 3.0, Touch(), np.random.default_rng(3))
    sound = note[int(0.3 * RATE) : int(2.3 * RATE)]
    spectrum = np.abs(np.fft.rfft(sound * np.hanning(len(sound)), 8 * len(sound)))
    frequency = np.fft.rfftfreq(8 * len(sound), 1 / RATE)
    near = (frequency > 0.92 * pitch) & (frequency < 1.08 * pitch)
    found = frequency[near][spectrum[near].argmax()]
    assert abs(1200 * np.log2(found / pitch)) < 2.5  # [cents], half of what a good ear tells apart


def test_a_note_dies_away():
    note = pluck(174.61, 3.5, Touch(), np.random.default_rng(3))
    loud = [np.sqrt(np.mean(note[int(t * RATE) : int((t + 0.2) * RATE)] ** 2)) for t in (0.0, 1.0, 2.0, 3.0)]
    assert all(later < earlier for earlier, later in zip(loud, loud[1:], strict=False))


def test_a_glide_begins_below_its_pitch():
    straight = pluck(220.0, 3.0, Touch(), np.random.default_rng(3))
    slid = pluck(220.0, 3.0, Touch(glide=2.0), np.random.default_rng(3))
    begin = slice(int(0.01 * RATE), int(0.06 * RATE))

    def crossings(sound: np.ndarray) -> int:
        return int(np.sum(np.diff(np.signbit(sound).astype(int)) != 0))

    assert crossings(slid[begin]) < crossings(straight[begin])
    assert len(slid) == len(straight)


def test_every_beat_of_the_pieces_is_written():
    for piece in (HALL_PIECE, FALLING_GAUZE):
        for bar in piece:
            assert len(bar.split()) == 4, bar
            assert bar_notes(bar, 0.0), bar


def test_music_is_the_same_every_time_and_fades_out():
    first, second = falling_gauze(), falling_gauze()
    assert np.array_equal(first, second)
    assert np.abs(first).max() == pytest.approx(0.7)
    assert np.abs(first[-RATE // 10 :]).max() < 0.005


def test_sounds_can_be_read_back_and_stay_small():
    av = pytest.importorskip("av", reason="the extra bake is not installed")
    files = [*ASSETS.glob("media/music.*"), *ASSETS.glob("exhibits/pibo/media/listening.*")]
    assert len(files) == 4
    assert sum(path.stat().st_size for path in ASSETS.glob("media/music.*")) <= 1_500_000
    for path in files:
        with av.open(str(path)) as container:
            seconds = container.duration / 1e6
            frame = next(container.decode(audio=0))
        assert frame.layout.name == "stereo"
        assert (60 < seconds < 90) if path.stem == "music" else (20 < seconds < 40)


def test_mirror_is_shipped_as_made():
    for name, afar in (("hall", FINENESS["afar"]), ("close", None)):
        path = ASSETS / f"exhibits/mirror/media/mirror_{name}.glb"
        made = mirror_glb(FINENESS[name], afar)
        assert len(made) == path.stat().st_size
        info = read_glb(path)
        assert info.afar < 0.3 * (info.triangles - info.afar)
        assert info.low[1] == pytest.approx(0.0, abs=1e-6)
        assert 0.5 < info.high[1] < 0.7


def test_few_rings_follow_the_relief_better_than_many_even_ones():
    radius, angle = np.linspace(0, RADIUS, 2000), np.linspace(0, 2 * np.pi / ARCS, 40)

    def mean_error(shares) -> float:
        rings = RADIUS * np.array([0.0, *shares])
        found = [np.interp(radius, rings, back_height(rings, one)) for one in angle]
        true = [back_height(radius, one) for one in angle]
        return float((np.abs(np.subtract(found, true)) * radius).sum() / radius.sum() / len(angle))

    shares = FINENESS["hall"].back
    assert list(shares) == sorted(shares)
    assert shares[-1] == 1.0
    assert mean_error(shares) < mean_error(np.arange(1, 27) / 26)


def test_back_of_the_mirror_has_sixteen_equal_arcs():
    angle = np.linspace(0, 2 * np.pi, 1600, endpoint=False)
    height = back_height(np.full(1600, 0.62 * RADIUS), angle)
    assert np.allclose(height, np.roll(height, 100))
    assert np.ptp(height) > 0.001


def test_weave_drawing_shows_the_draft():
    lift = np.array([[True, False], [False, True]])
    cloth = View(Image.new("RGB", (64, 64), "#c4624f"), 2.4e-3)
    pixels = np.asarray(weave_drawing(lift, [cloth]))
    squares = [
        [pixels[70 + 480 - 30 - 60 * row, 102 + 30 + 60 * column].max() < 128 for column in range(8)]
        for row in range(8)
    ]
    assert np.array_equal(squares, np.tile(lift, (4, 4)))
    assert np.abs(pixels[80:540, 640:1080].astype(int) - (0xC4, 0x62, 0x4F)).max() <= 1
    bar = (pixels[576, 600:724].max(axis=1) < 60).sum()
    assert bar == pytest.approx(480 * 0.5 / 2.4, abs=3)  # half a millimetre


def strip(length: float) -> Pattern:
    return Pattern("strip", np.array([[0, 0], [0.4, 0], [0.4, length], [0, length]]), 0.05)


def half(*, length: float = 0.7) -> Pattern:
    """Two rectangles, joined and sewn, tied at one corner."""
    corners = [("a", (0.0, -length)), ("b", (0.3, -length)), ("c", (0.3, length)), ("d", (0.0, length))]

    def panel(name: str, away: float) -> Panel:
        points = [np.array([x + away, y]) for _, (x, y) in corners]
        legs = tuple(np.array([p, q]) for p, q in zip(points, [*points[1:], points[0]], strict=True))
        return Panel(name, tuple(name for name, _ in corners), legs)

    panels = (panel("body", 0.0), panel("sleeve", 0.3))
    seams = (
        Seam("joined", Path_.read("body: b > c"), Path_.read("sleeve: a < d")),
        Seam("middle", Path_.read("body: d > a")),
    )
    tie = Tie("belt", Spot("body", (0.0, length), "left"), Spot("sleeve", (0.6, length), "right"), 0.02)
    title = {"zh": "衣", "en": "Coat"}
    return Pattern("coat", panels[0].outline(), 0.05, title, None, panels, seams, True, (tie,))


def outlines(svg: str) -> list[np.ndarray]:
    """Corners (n, 2) [mm] of every outline of a sheet."""
    paths = [path for path in ElementTree.fromstring(svg).iter() if path.get("class") == "outline"]
    return [
        np.array([[float(c) for c in pair.split()] for pair in path.attrib["d"].strip("MZ").split("L")])
        for path in paths
    ]


def test_a_pattern_sheet_is_at_true_size_and_says_what_a_cutter_asks():
    svg = plan_svg(cutting_plan([half(), strip(2.4)], ("衣与帔", "Coat and scarf")))
    sheet = ElementTree.fromstring(svg)
    assert sheet.attrib["width"] == f"{sheet.attrib['viewBox'].split()[2]}mm"
    sizes = [sorted(np.ptp(outline, axis=0).round(1).tolist()) for outline in outlines(svg)]
    assert sizes == [[300.0, 1400.0], [300.0, 1400.0], [400.0, 2400.0]]
    width, height = (float(value) for value in sheet.attrib["viewBox"].split()[2:])
    for outline in outlines(svg):
        assert outline.min() > 0
        assert (outline.max(0) < [width, height]).all()
    words = [text.text for text in sheet.iter() if text.tag.endswith("text")]
    assert "衣与帔 Coat and scarf" in words
    for asked in ("1400", "300", "2400", "400", "body", "sleeve", "A 平缝 joined flat: body + sleeve, 1400"):
        assert asked in words
    assert words.count("A") == 2, "at both of its sides"
    assert words.count("B") == 1, "to its own mirror image"
    assert "系带 tie belt: body left + sleeve right, 20" in words
    assert "衣，毫米，一半，翻转再裁一次" in words
    kinds = [path.get("class") for path in sheet.iter() if path.get("class")]
    assert kinds.count("fold") == 2, "the shoulder of both panels, none of a scarf"
    assert kinds.count("tie") == 2
    assert kinds.count("grain") == 9, "three strokes an arrow"


def test_a_sheet_says_which_panel_is_cut_for_one_side_alone():
    coat = half()
    body, *others = coat.panels
    plan = cutting_plan([replace(coat, panels=(replace(body, side="left"), *others))], ("衣", "Coat"))
    told = {word.text: word.latin for word in plan.words}
    assert told["body，只裁左身 left only"] == "body, left only"
    assert "sleeve" in told


@pytest.mark.parametrize("length", [0.3, 1.0])  # the second is turned on the sheet
def test_what_one_side_has_alone_is_drawn_as_it_is_cut(length):
    """A sheet is printed at true size and cut along its lines: an image of such a panel would be of the other side."""
    leg = np.array([[0.0, -length], [0.3, length], [0.0, length]])
    legs = tuple(np.array([p, q]) for p, q in zip(leg, [*leg[1:], leg[0]], strict=True))

    def turns(side: str) -> float:
        pattern = Pattern(
            "point", leg, 0.05, panels=(Panel("point", tuple("abc"), legs, side=side),), mirror=True
        )
        (drawn,) = (s.points for s in cutting_plan([pattern], ("角", "Point")).strokes if s.kind == "outline")
        (ax, ay), (bx, by) = drawn[1] - drawn[0], drawn[2] - drawn[0]
        return float(ax * by - ay * bx)

    as_drawn = 0.3 * 2 * length * 1e6
    assert turns("left") == pytest.approx(as_drawn)
    assert turns("right") == pytest.approx(-as_drawn)


def test_panels_of_a_sheet_lie_apart():
    found = outlines(plan_svg(cutting_plan([half(), half(length=0.2), strip(2.4)], ("衣", "Coat"))))
    boxes = [(outline.min(0), outline.max(0)) for outline in found]
    for number, (low, high) in enumerate(boxes):
        for other_low, other_high in boxes[:number]:
            assert (high < other_low).any() or (other_high < low).any()


def test_no_tie_of_a_shipped_sheet_is_written_over_other_words():
    plan = outfit_plan(ASSETS, "outfits/gown.toml")
    boxes = []
    for word in plan.words:
        wide, left = 0.5 * word.size * len(word.text), 0.0 if word.anchor == "start" else 0.5
        size = np.array([wide, 0.8 * word.size])[:: -1 if word.upright else 1]
        low = np.array([word.x - left * size[0], word.y - (0.5 if word.upright else 1.0) * size[1]])
        boxes.append((word.text, low, low + size))
    ties = [box for box in boxes if box[0].endswith((" (L)", " (R)"))]
    assert len(ties) == 8
    for name, low, high in ties:
        over = [text for text, a, b in boxes if (a < high).all() and (b > low).all() and text != name]
        assert not over, (name, over)


def test_the_picture_of_a_sheet_measures_what_it_is_given():
    small, other = (plan_picture(cutting_plan([strip(length)], ("帔", "Scarf"))) for length in (2.4, 2.3))
    assert max(small.size) == max(other.size) == 1500
    assert np.asarray(small).tobytes() != np.asarray(other).tobytes()


@pytest.mark.door
def test_shipped_sheets_are_of_the_patterns_as_they_are():
    for sheet in ASSETS.glob("exhibits/*/media/pattern.svg"):
        table = tomllib.loads((sheet.parents[1] / "exhibit.toml").read_text("utf-8"))
        assert plan_svg(outfit_plan(ASSETS, table["outfit"])) == sheet.read_text("utf-8"), (
            "hall build --pattern"
        )
