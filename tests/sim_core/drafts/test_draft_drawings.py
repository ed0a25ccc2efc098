"""Motifs drawn as SVG: colours become numbers, the frame the repeat; what no loom can weave ends in one line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from sim_core import cli
from sim_core.errors import SimCoreError, WeaveError
from sim_core.weave import Weave
from sim_core.weave.draft.motifs import cut, read_motif

ASSETS = Path(__file__).parents[3] / "assets"
SPACES = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
HEAD = f'<svg {SPACES} width="40mm" height="20mm" viewBox="0 0 80 40">'
COLOURS = 'colours = { "#FFFFFF" = 0, "#ff0000" = 1, "#0000ff" = 2 }\n'


@pytest.fixture
def drawn(tmp_path: Path):
    def made(body: str, *, head: str = HEAD, colours: str = COLOURS, rest: str = "", tail: str = "</svg>"):
        (tmp_path / "mine.svg").write_text(head + body + tail, "utf-8")
        path = tmp_path / "mine.toml"
        path.write_text(f'name = "mine"\nsvg = "mine.svg"\n{colours}{rest}', "utf-8")
        return path

    return made


def rows(path: Path, **changes: float) -> list[str]:
    """One place a millimetre, the top row first."""
    return ["".join(map(str, row)) for row in cut(read_motif(path, changes or None), 1000, 1000)[::-1]]


def test_fills_become_numbers_in_the_order_of_painting(drawn) -> None:
    path = drawn(
        '<style>.b{fill:blue}</style><rect x="4" y="0" width="16" height="8" fill="red"/>'
        '<g transform="translate(8 4)"><rect class="b" width="4" height="20"/></g>'
        '<rect y="32" width="80" height="8" fill="#fff"/>'
        '<rect x="40" y="36" width="80" height="4" style="fill:rgb(255,0,0)"/>'
    )
    found = rows(path)
    assert len(found) == 20
    assert found[0] == "0011111111" + "0" * 30
    assert found[2] == "0011221111" + "0" * 30
    assert found[5] == "0000220000" + "0" * 30
    assert found[18] == "1" * 40  # what leaves the frame comes in at the other side
    assert set(found[16]) == {"0"}


def test_the_size_comes_from_the_file_the_key_or_the_weave(drawn) -> None:
    body = '<path d="M0 0h40v40h-40z" fill="red"/>'
    assert read_motif(drawn(body)).size == pytest.approx((0.04, 0.02))
    assert read_motif(drawn(body, rest="repeat = [60, 30]\n")).size == pytest.approx((0.06, 0.03))
    assert read_motif(drawn(body), {"width": 80}).size == pytest.approx((0.08, 0.04))
    assert read_motif(drawn(body), {"height": 10, "width": 80}).size == pytest.approx((0.08, 0.01))
    inches = HEAD.replace("40mm", "2in").replace("20mm", "2.54cm")
    assert read_motif(drawn(body, head=inches)).size == pytest.approx((0.0508, 0.0254))
    with pytest.raises(SimCoreError, match="parameters.petals: unknown – a drawing has width, height"):
        read_motif(drawn(body), {"petals": 3})
    for head in (HEAD.replace("40mm", "40"), HEAD.replace('width="40mm" height="20mm" ', "")):
        with pytest.raises(SimCoreError, match="is no length – state width and height in mm, or `repeat`"):
            read_motif(drawn(body, head=head))
        assert read_motif(drawn(body, head=head, rest="repeat = [60, 30]\n")).size == pytest.approx(
            (0.06, 0.03)
        )


@pytest.mark.parametrize("rule", ["nonzero", "evenodd"])
def test_windings_count_by_their_rule(drawn, rule: str) -> None:
    """Two squares of one sense, one within the other, and a third against it: a hole by each rule where it is one."""
    path = drawn(
        f'<path fill="red" fill-rule="{rule}" d="M8 8h48v24h-48z M16 12h8v16h-8z M40 12v16h8v-16z"/>'
    )
    row = rows(path)[9]
    assert row[8:12] == ("1111" if rule == "nonzero" else "0000")
    assert row[20:24] == "0000"
    assert row[4:8] + row[12:20] + row[24:28] == "1" * 16


def test_a_path_that_crosses_itself_is_filled_by_its_rule(drawn) -> None:
    star = "M40 2L52 38L20 15H60L28 38Z"
    middle = [
        rows(drawn(f'<path fill="red" fill-rule="{rule}" d="{star}"/>'))[10][20]
        for rule in ("nonzero", "evenodd")
    ]
    assert middle == ["1", "0"]


def test_lines_are_as_wide_as_their_stroke(drawn) -> None:
    path = drawn('<path transform="scale(2)" d="M2 10H38" fill="none" stroke="red" stroke-width="2"/>')
    found = rows(path)
    assert [row.count("1") for row in found] == [0] * 9 + [36, 36] + [0] * 9


def test_a_hidden_layer_and_what_cannot_be_seen_are_not_woven(drawn) -> None:
    path = drawn(
        '<rect width="8" height="4" fill="red"/><g style="display:none">'
        '<rect width="80" height="40" fill="green"/></g>'
        '<rect width="80" height="40" fill="green" visibility="hidden"/>'
        '<rect width="80" height="40" fill="green" opacity="0"/>'
        '<rect width="80" height="40" fill="none"/>'
    )
    assert sum(row.count("1") for row in rows(path)) == 8


BOMB = '<!DOCTYPE svg [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>'
OUTSIDE = '<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/passwd">]>'
ZIGZAG = "M" + " ".join(f"{k % 79} {39 * (k % 2)}" for k in range(9000)) + "z"
KNOT = "M" + " ".join(f"{(k * 7919) % 79} {(k * 104729) % 39}" for k in range(400)) + "Z"
SCRIBBLE = "M" + " ".join(f"{(k * 7919) % 79} {(k * 104729) % 39}" for k in range(3000)) + "Z"
HOSTILE = {
    "entities within entities": {"body": "<desc>&b;</desc>", "head": BOMB + HEAD},
    "declares entities": {"body": "<desc>&x;</desc>", "head": OUTSIDE + HEAD},
    "<image>: nothing that can be woven": {
        "body": '<image xlink:href="http://example.org/a.png" width="3" height="3"/>'
    },
    "<text>: nothing that can be woven": {"body": "<text>鹤</text>"},
    "<use> of http": {"body": '<use xlink:href="http://example.org/a.svg#b"/>'},
    "clip-path: nothing that can be woven": {
        "body": '<rect clip-path="url(#c)" width="9" height="9" fill="red"/>'
    },
    "within itself": {"body": '<g id="a"><use xlink:href="#a"/></g>'},
    "is no plain colour": {"body": '<rect width="9" height="9" fill="url(#g)"/>'},
    "fill #008000 has no number – add it to `colours`": {"body": '<rect width="9" height="9" fill="green"/>'},
    "fill #000000 has no number": {"body": '<rect width="9" height="9"/>'},
    "leaves the frame of 40 x 20 mm by more than a repeat": {
        "body": '<path fill="red" d="M0 0L1e30 5L3 9z"/>'
    },
    "mine.svg: ": {
        "body": '<path fill="red" d="M0 0LNaN NaNL9 9z"/><path fill="red" d="M1e400 0L1 1L2 5z"/>'
    },
    "a path of 3,000 points that crosses itself": {"body": f'<path fill="red" d="{SCRIBBLE}"/>'},
    "a path of 400 points that crosses itself too often": {"body": f'<path fill="red" d="{KNOT}"/>'},
    "simplify its paths": {
        "body": '<path fill="red" d="M' + " ".join(f"{k % 79} {39 * (k % 2)}" for k in range(9000)) + 'z"/>'
    },
    "nested too deep": {"body": "<g>" * 500 + "</g>" * 500},
    "not valid SVG": {"body": "<rect", "tail": ""},
    "nothing is drawn": {"body": '<rect width="0" height="5" fill="red"/>'},
    "4000 mm": {"body": '<rect width="5" height="5" fill="red"/>', "head": HEAD.replace("40mm", "1e9mm")},
    "its frame has no size": {
        "body": '<rect width="5" height="5" fill="red"/>',
        "head": HEAD.replace("80 40", "0 40"),
    },
    "its root is <html>": {"body": "", "head": "<html>", "tail": "</html>"},
    "colours: missing": {"body": '<rect width="5" height="5" fill="red"/>', "colours": ""},
    "colours.#f00": {"body": "", "colours": 'colours = { "#f00" = 1 }\n'},
    "parameters: a drawing has none": {"body": "", "rest": "parameters = { width = 3 }\n"},
    "give a program, or svg, or [[part]] tables": {"body": "", "rest": 'program = "frets"\n'},
}


@pytest.mark.parametrize("words", list(HOSTILE))
def test_what_cannot_be_woven_ends_in_one_line(drawn, words: str) -> None:
    with pytest.raises(SimCoreError) as told:
        read_motif(drawn(**HOSTILE[words]))
    assert words in str(told.value)
    assert "mine" in str(told.value)
    assert len(str(told.value).splitlines()) == 1
    assert len(str(told.value)) < 500


def test_a_drawing_that_is_not_there_and_colours_without_one(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text('name = "x"\nsvg = "none.svg"\n' + COLOURS, "utf-8")
    with pytest.raises(SimCoreError, match=r"none\.svg"):
        read_motif(path)
    path.write_text('name = "x"\nprogram = "frets"\n' + COLOURS, "utf-8")
    with pytest.raises(WeaveError, match="colours: of a drawing"):
        read_motif(path)


def test_a_drawing_fills_a_part_of_a_layout_and_goes_with_its_weave(drawn, tmp_path: Path) -> None:
    drawn('<rect x="20" y="10" width="40" height="20" fill="red"/>')
    layout = tmp_path / "layout.toml"
    layout.write_text(
        'name = "layout"\nrepeat = [80, 40]\n[[part]]\nmotif = "mine.toml"\nwithin = [0, 0, 80, 20]\n'
        "parameters = { width = 20 }\n",
        "utf-8",
    )
    assert sum(row.count("1") for row in rows(layout)) == 80 * 20 // 4
    told = (ASSETS / "weaves" / "crane-duan.toml").read_text("utf-8")
    for motif in ("mine", "layout"):
        text = told.replace("../motifs/cranes.toml", f"{motif}.toml").replace(
            '["satin:5/2:weft", "twill:2/3"]', '"satin:5/2:weft"'
        )
        (tmp_path / "weave.toml").write_text(text, "utf-8")
        weave = Weave.load(tmp_path / "weave.toml")
        kept = json.loads(json.dumps(weave.to_dict()))
        (tmp_path / "mine.svg").rename(tmp_path / "away.svg")
        again = Weave.from_dict(kept)
        (tmp_path / "away.svg").rename(tmp_path / "mine.svg")
        assert again == weave
        assert (np.asarray(again.numbers) == weave.numbers).all()
    kept["figure"]["parts"][0]["areas"] = [[1, "POLYGON ((0 0"]]
    with pytest.raises(WeaveError, match="areas that cannot be read"):
        Weave.from_dict(kept)


def test_the_cranes_are_woven() -> None:
    weave = Weave.load(ASSETS / "weaves" / "crane-duan.toml")
    assert weave.draft.lift.shape == (800, 1280)
    assert len(weave.cells) == 3
    shares = [(weave.numbers == number).mean() for number in range(3)]
    assert 0.6 < shares[0] < 0.8
    assert min(shares[1:]) > 0.08


def test_the_command_tells_a_drawn_weave(drawn, tmp_path: Path, capsys) -> None:
    drawn('<rect x="4" y="2" width="8" height="4" fill="red"/>', rest="repeat = [6, 4]\n")
    told = (ASSETS / "weaves" / "crane-duan.toml").read_text("utf-8")
    (tmp_path / "weave.toml").write_text(told.replace("../motifs/cranes.toml", "mine.toml"), "utf-8")
    assert cli.main(["weave", str(tmp_path / "weave.toml"), "--json"]) == 0
    cells = json.loads(capsys.readouterr().out)["cells"]
    assert [cell["share"] for cell in cells] == pytest.approx([0.99, 0.01], abs=0.005)
    (tmp_path / "mine.svg").write_text(HEAD + "<text>鹤</text></svg>", "utf-8")
    assert cli.main(["weave", str(tmp_path / "weave.toml")]) == 1
    said = capsys.readouterr().err
    assert "mine.svg: <text>: nothing that can be woven" in said
    assert len(said.splitlines()) == 1
