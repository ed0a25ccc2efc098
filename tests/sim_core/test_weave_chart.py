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
from sim_core.weave.files import STRUCTURES, blocked_out, blocked_source, source_of, unit_of
from sim_core.weave.files.wif import read_wif

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
    size = " ".join(root.get(side) for side in ("width", "height"))
    assert (
        root.find(f"{SVG}style").text == f"@page {{ size: {size}; margin: 0 }}"
    )  # a browser prints it whole
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


def test_no_page_weaves_out_a_plan_that_it_does_not_draw(monkeypatch, tmp_path):
    """A jacquard of thousands of hooks has dozens of pages; their lift plan took seconds on each of them."""
    from sim_core.weave.chart import layout

    lift = np.random.default_rng(3).random((120, 90)) < 0.5
    sizes = []

    def counted(tieup, treadling):
        sizes.append(len(treadling))
        return (treadling.astype(int) @ tieup.T.astype(int)) > 0

    monkeypatch.setattr(layout, "lift_plan", counted)
    (tmp_path / "j.json").write_text(json.dumps({"name": "jacquard", "lift": lift.astype(int).tolist()}))
    chart_of(source_of(str(tmp_path / "j.json")), View(plan=True), Window((0, 9), (0, 7)))
    assert sizes == []
    chart_of(source_of(TWILL), View(plan=True), Window((0, 9), (0, 7)))
    assert sizes == [7]


def test_larger_drafts_are_pages_that_meet_without_a_gap(tmp_path):
    from sim_core.weave.chart import windows

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


def hearts(tmp_path, **told):
    """A point threading of ten ends, three times and one more, in two colours."""
    threading = [1, 2, 3, 4, 5, 6, 5, 4, 3, 2] * 3 + [1]
    lines = {
        "WIF": "Version=1.1",
        "TEXT": f"Title={told.get('title', 'hearts')}\nAuthor=A. Weaver",
        "WARP": f"Threads=31\nColor=1\nUnits=centimeters\nSpacing={told.get('spacing', 0.1)}",
        "WEFT": "Threads=8\nColor=2\nUnits=centimeters\nSpacing=.125",
        "COLOR TABLE": "1=200,0,0\n2=0,0,200\n3=9,9,9",
        "WARP COLORS": "4=2",
        "THREADING": "\n".join(f"{k}={shaft}" for k, shaft in enumerate(threading, 1)),
        "TIEUP": "1=1,2,4\n2=2,3,5\n3=3,4,6\n4=1,5,6",
        "TREADLING": "\n".join(f"{k}={1 + (k - 1) % 4}" for k in range(1, 9)),
    }
    path = tmp_path / "hearts.wif"
    path.write_text("".join(f"[{name}]\n{text}\n" for name, text in lines.items()), "utf-8")
    return path


@pytest.mark.parametrize("first", ["right", "left"])
def test_repeats_are_marked_between_the_last_yarn_of_one_and_the_first_of_the_next(first, tmp_path):
    source = source_of(str(hearts(tmp_path)))
    assert source.factors.periods == (4, 10)
    chart = chart_of(source, View(first=first))
    across = sorted(x0 for x0, _, x1, _ in chart.repeats.tolist() if x0 == x1)
    top = blocks(source)["drawdown"].y
    along = [y0 - top for _, y0, _, y1 in chart.repeats.tolist() if y0 == y1]
    assert across == ([1, 11, 21] if first == "right" else [10, 20, 30])
    assert along == [4]
    assert "repeat 10 (3 times + 1) x 4 (2 times)" in chart.facts
    assert "green: repeats" in chart.foot
    part = chart_of(source, View(first=first), Window((5, 15), (0, 3)))
    assert [x0 for x0, _, x1, _ in part.repeats.tolist() if x0 == x1] == [5]


def test_a_draft_that_does_not_repeat_is_not_marked():
    chart = chart_of(source_of(TWILL), View())
    assert not len(chart.repeats)
    assert "repeat 62 x 62 ·" in chart.facts


def test_heddles_colours_sett_and_author_stand_on_the_page(tmp_path):
    source = source_of(str(hearts(tmp_path)))
    chart = chart_of(source, View(), Window((0, 10), (0, 4)))  # counted over the whole draft on every page
    heddles = [label.text for label in chart.labels if label.x < 0]
    assert heddles == ["4", "6", "6", "6", "6", "3", "heddles"]
    assert chart.swatches == (((200, 0, 0), "colour 1: 30 ends"), ((0, 0, 200), "colour 2: 1 end, 8 picks"))
    assert chart.credits == (
        "A. Weaver · hearts.wif · sett 10 x 8 per cm (25.4 x 20.3 per inch) · 3.1 cm in the reed"
    )
    svg = write_draft(source, tmp_path / "h.svg", View())[0].read_text("utf-8")
    assert chart.credits in svg
    assert "50 mm" in svg


def test_a_path_in_the_title_is_its_last_name(tmp_path):
    path = hearts(tmp_path, title="C:\\Users\\anna\\Desktop\\shawl.dbw")
    assert chart_of(source_of(str(path)), View()).title == "shawl.dbw"
    path = hearts(tmp_path, title="twill 2/2 / tabby")
    assert chart_of(source_of(str(path)), View()).title == "twill 2/2 / tabby"


def test_a_profile_by_name_has_no_file(tmp_path):
    assert chart_of(blocked_source(source_of("twill:1/3"), "summer-winter"), View()).credits == ""


@pytest.mark.parametrize("paper", ["A4", "letter"])
def test_on_a_paper_that_was_asked_for_the_draft_has_as_many_pages_as_readable_cells_need(paper, tmp_path):
    from sim_core.weave.chart import PAPERS, repeated

    source = repeated(source_of(TWILL), 3, 4)  # 186 x 248
    paths = write_draft(source, tmp_path / "d.svg", View(floats=3), paper=paper)
    assert len(paths) > 1
    crossings = 0
    for path in paths:
        root = ElementTree.parse(path).getroot()
        size = tuple(float(root.get(side).removesuffix("mm")) for side in ("width", "height"))
        assert size in {PAPERS[paper], PAPERS[paper][::-1]}
        texts = [text.text for text in root.iter(f"{SVG}text")]
        assert f"page {paths.index(path) + 1} of {len(paths)}" in texts
        cell = next(
            float(found[1]) for text in texts if (found := re.search(r"a cell ([\d.]+) mm", text or ""))
        )
        assert cell >= 1.6
        groups = {t.text: g for g in root.iter(f"{SVG}g") if (t := g.find(f"{SVG}title")) is not None}
        box = groups["drawdown"].find(f"{SVG}rect")
        crossings += int(box.get("width")) * int(box.get("height"))
    assert crossings == 186 * 248
    assert len(write_draft(source_of(TWILL), tmp_path / "one.svg", View(), paper=paper)) == 1


def test_a_png_on_paper_has_the_size_of_the_paper(tmp_path):
    (path,) = write_draft(source_of(TWILL), tmp_path / "d.png", View(floats=3), paper="letter")
    with Image.open(path) as picture:
        inches = [side / picture.info["dpi"][0] for side in picture.size]
    assert sorted(inches) == pytest.approx([8.5, 11.0], abs=0.02)


@pytest.mark.parametrize("words", [TWILL, "satin:5/2"])
def test_a_draft_is_drawn_several_times_side_by_side(words):
    from sim_core.weave.chart import repeated

    source = source_of(words)
    twice = repeated(source, 3, 2)
    np.testing.assert_array_equal(twice.factors.lift(), np.tile(source.factors.lift(), (2, 3)))
    np.testing.assert_array_equal(twice.harness.lift, twice.factors.lift())
    np.testing.assert_array_equal(
        twice.palette[twice.warp_colours], np.tile(source.palette[source.warp_colours], (3, 1))
    )
    assert twice.facts == source.facts
    with pytest.raises(WeaveError, match="at most 20,000 picks"):
        repeated(source, 1, 9999)


@pytest.mark.parametrize("words", [["--times", "0,2"], ["--times", "3"], ["--paper", "A5"]])
def test_repeats_and_papers_that_are_none_are_wrong_arguments(words, tmp_path, capsys):
    with pytest.raises(SystemExit) as caught:
        main(["weave", TWILL, "--draft", str(tmp_path / "d.svg"), *words])
    assert caught.value.code == 2
    capsys.readouterr()
    assert main(["weave", TWILL, "--times", "2,2"]) == 2
    assert "add --draft" in capsys.readouterr().err


def test_the_command_names_the_pages_that_it_drew(tmp_path, capsys):
    words = ["weave", TWILL, "--draft", str(tmp_path / "d.svg"), "--paper", "A4", "--times", "3,4"]
    assert main([*words, "--json"]) == 0
    drawn = json.loads(capsys.readouterr().out)["drawn"]
    assert len(drawn) > 1
    assert sorted(drawn) == sorted(str(path) for path in tmp_path.iterdir())
    assert main(words) == 0
    assert f"drawn: {drawn[0]}" in capsys.readouterr().out


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
