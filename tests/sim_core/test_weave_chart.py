"""Pictures of drafts: what is drawn is the draft; pages, strips, floats, profiles."""

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from sim_core.cli import main
from sim_core.errors import WeaveError
from sim_core.weave.chart import View, Window, chart_of, write_draft
from sim_core.weave.profiles import STRUCTURES, blocked_out, unit_of
from sim_core.weave.sources import blocked_source, source_of
from sim_core.weave.wif_read import read_wif

FOLDER = Path(__file__).parent / "drafts"
TWILL = str(FOLDER / "weaveit-32-shafts.wif")
SVG = "{http://www.w3.org/2000/svg}"


def blocks(source, view=View(), window=None):  # noqa: B008 - frozen
    return {block.name: block for block in chart_of(source, view, window).blocks}


@pytest.mark.parametrize("first", ["right", "left"])
def test_threading_tie_up_and_treadling_weave_the_drawdown_that_is_drawn(first):
    drawn = blocks(source_of(TWILL), View(first=first))
    threading, tieup = drawn["threading"].cells > 0, drawn["tie-up"].cells > 0
    woven = (drawn["treadling"].cells.astype(int) @ tieup.T.astype(int)) @ threading.astype(int) > 0
    np.testing.assert_array_equal(drawn["drawdown"].cells > 0, woven)


def test_the_picture_begins_at_the_tie_up_or_at_the_lower_left():
    source = source_of(TWILL)
    lift = source.factors.lift()
    np.testing.assert_array_equal(blocks(source)["drawdown"].cells, lift[:, ::-1])
    np.testing.assert_array_equal(blocks(source, View(first="left"))["drawdown"].cells, lift[::-1])


def test_colour_and_weave_shows_the_yarn_on_top():
    source = source_of(TWILL)
    block = blocks(source, View(colour=True))["drawdown"]
    shown = block.colours[block.cells][:, ::-1]
    lift = source.factors.lift()
    for pick, end in np.random.default_rng(1).integers(0, 62, (200, 2)):
        yarn = source.warp_colours[end] if lift[pick, end] else source.weft_colours[pick]
        np.testing.assert_array_equal(shown[pick, end], source.palette[yarn])


def test_a_lift_plan_takes_the_place_of_tie_up_and_treadling():
    drawn = blocks(source_of(TWILL), View(plan=True))
    assert "tie-up" not in drawn
    woven = drawn["lift plan"].cells[:, ::-1].astype(int) @ (drawn["threading"].cells > 0).astype(int) > 0
    np.testing.assert_array_equal(drawn["drawdown"].cells > 0, woven)


@pytest.mark.parametrize("first", ["right", "left"])
def test_the_lines_lie_on_every_crossing_of_a_long_float_and_on_no_other(first):
    """Counted again from the drawing: every crossing beneath a line is of its side, and floats are as many."""
    source = source_of(TWILL)
    drawn = blocks(source, View(first=first))
    over = drawn["drawdown"].cells > 0
    top = drawn["drawdown"].y
    chart = chart_of(source, View(floats=3, first=first))
    covered = {}
    for kind, lines in chart.lines:
        mask = np.zeros_like(over)
        for x0, y0, x1, y1 in lines.tolist():
            mask[int(y0 - top) : int(y1 - top) + 1, int(x0) : int(x1) + 1] = True
        covered[kind] = mask
    for kind, on_top in (
        ("warp face", over),
        ("warp back", ~over),
        ("weft face", ~over),
        ("weft back", over),
    ):
        yarns = (on_top.T, covered[kind].T) if kind.startswith("warp") else (on_top, covered[kind])
        for yarn, mask in zip(*yarns, strict=True):
            twice = np.append(yarn, yarn)
            runs = [m.span() for m in re.finditer("1+", "".join(map(str, twice.astype(int))))]
            wanted = np.zeros(len(twice), bool)
            for begin, end in runs:
                wanted[begin:end] = end - begin > 3
            np.testing.assert_array_equal(mask, wanted[: len(yarn)] | wanted[len(yarn) :])


def test_the_svg_is_a_sheet_of_paper_with_all_of_the_draft(tmp_path):
    (path,) = write_draft(source_of(TWILL), tmp_path / "d.svg", View(floats=3))
    root = ElementTree.parse(path).getroot()
    assert (root.get("width"), root.get("height")) in {("210mm", "297mm"), ("297mm", "210mm")}
    titles = [title.text for title in root.iter(f"{SVG}title")]
    assert {"threading", "tie-up", "treadling", "drawdown", "warp face floats", "weft back floats"} <= set(
        titles
    )
    groups = {t.text: g for g in root.iter(f"{SVG}g") if (t := g.find(f"{SVG}title")) is not None}
    filled = sum(int(n) for n in re.findall(r"h(\d+)", groups["drawdown"].find(f"{SVG}path").get("d")))
    assert filled == source_of(TWILL).factors.lift().sum()


def test_a_jacquard_is_drawn_without_its_hooks(tmp_path):
    picture = np.random.default_rng(2).random((90, 120)) < 0.5
    (tmp_path / "motif.json").write_text(
        json.dumps({"name": "jacquard", "lift": picture.astype(int).tolist()})
    )
    source = source_of(str(tmp_path / "motif.json"))
    drawn = blocks(source)
    assert set(drawn) == {"drawdown", "warp colours", "weft colours"}
    np.testing.assert_array_equal(drawn["drawdown"].cells[:, ::-1], picture)
    assert "more than 80 shafts are not drawn" in chart_of(source, View()).foot


def test_larger_drafts_are_pages_that_meet_without_a_gap(tmp_path):
    from sim_core.weave.chart.sheets import windows

    pages = windows(Window((0, 1210), (40, 730)), 500)
    assert all(w.ends[1] - w.ends[0] <= 500 and w.picks[1] - w.picks[0] <= 500 for w in pages)
    seen = np.zeros((730, 1210), int)
    for w in pages:
        seen[slice(*w.picks), slice(*w.ends)] += 1
    assert (seen[40:] == 1).all()
    assert not seen[:40].any()
    with pytest.raises(WeaveError, match="no such part"):
        write_draft(source_of("plain"), tmp_path / "d.svg", View(), Window((0, 3), (0, 2)))


def pixels(path):
    with Image.open(path) as picture:
        return np.asarray(picture.convert("L")) < 128


def test_cards_and_pegs_are_a_pixel_a_crossing(tmp_path, capsys):
    words = ["weave", TWILL, "--cards", str(tmp_path / "c.png"), "--pegs", str(tmp_path / "p.png"), "--json"]
    assert main(words) == 0
    capsys.readouterr()
    source = source_of(TWILL)
    cards, pegs = (pixels(tmp_path / name) for name in ("c.png", "p.png"))
    np.testing.assert_array_equal(cards[::-1], source.factors.lift())
    harness = source.harness
    np.testing.assert_array_equal(pegs[::-1], harness.treadling.astype(int) @ harness.tieup.T.astype(int) > 0)


def test_the_command_draws_a_part_as_picture(tmp_path, capsys):
    path = tmp_path / "part.png"
    words = ["weave", TWILL, "--draft", str(path), "--view", "colour", "--floats", "3", "--part", "1-20,5-30"]
    assert main([*words, "--first", "left"]) == 0
    with Image.open(path) as picture:
        assert min(picture.size) > 300
    assert main(["weave", TWILL, "--draft", str(path), "--part", "1-99,1-4"]) == 1
    assert "ends 1 to 99: no such part" in capsys.readouterr().err
    for words in (["--part", "4"], ["--floats", "0"], ["--draft", "x.gif"], ["--view", "back"]):
        with pytest.raises(SystemExit) as caught:
            main(["weave", TWILL, *words])
        assert caught.value.code == 2
    capsys.readouterr()


PROFILE = """[WIF]
Version=1.1
[WARP]
Threads=6
[WEFT]
Threads=5
[THREADING]
1=1
2=2
3=3
4=3
5=2
6=1
[TIEUP]
1=1
2=2
3=1,3
[TREADLING]
1=1
2=2
3=3
4=2
5=1
"""


@pytest.mark.parametrize("structure", [*STRUCTURES, "twill:3/1", "satin:5/2", "twill:1/2:S"])
def test_a_profile_is_blocked_out_unit_by_unit(structure, tmp_path):
    (tmp_path / "p.wif").write_text(PROFILE)
    profile = read_wif(tmp_path / "p.wif")
    pattern, ground = unit_of(structure)
    filled = profile.factors.lift()
    wanted = np.block([[pattern if cell else ground for cell in row] for row in filled])
    made = blocked_out(profile, structure)
    np.testing.assert_array_equal(made.factors.lift(), wanted)
    assert (made.harness.threading.sum(axis=1) == 1).all()
    blocked = blocked_source(source_of(str(tmp_path / "p.wif")), structure)
    assert blocked.facts.integral


def test_ties_take_two_shafts_and_every_block_its_own(tmp_path):
    (tmp_path / "p.wif").write_text(PROFILE)
    profile = read_wif(tmp_path / "p.wif")
    shafts = {name: blocked_out(profile, name).harness.tieup.shape[0] for name in (*STRUCTURES, "twill:3/1")}
    assert shafts == {"summer-winter": 5, "bronson": 5, "double": 12, "twill:3/1": 12}
    threads = blocked_out(profile, "summer-winter").harness.threading.argmax(axis=1)[:8] + 1
    assert threads.tolist() == [1, 3, 2, 3, 1, 4, 2, 4]
    floats = blocked_source(source_of(str(tmp_path / "p.wif")), "summer-winter").facts
    assert max(floats.warp.longest, floats.weft.longest) == 3


def test_what_is_no_profile_and_no_structure_is_named(tmp_path, capsys):
    assert main(["weave", TWILL, "--floats", "5"]) == 2
    assert "--floats: says how a draft is drawn" in capsys.readouterr().err
    assert main(["weave", TWILL, "--blocks", "overshot"]) == 2
    assert "no such structure – give summer-winter, bronson, double" in capsys.readouterr().err
    assert main(["weave", str(FOLDER / "treadles-with-defaults.wif"), "--blocks", "bronson"]) == 1
    assert "profile: ends 1, 2, 4 – each end of a profile is on one block" in capsys.readouterr().err
