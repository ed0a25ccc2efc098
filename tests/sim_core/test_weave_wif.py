"""WIF: every trap, strict writing, identity, fuzz."""

from dataclasses import replace
from pathlib import Path
from time import perf_counter

import numpy as np
import pytest
from wif_fuzz import damaged, generated

from sim_core.errors import SimCoreError, WeaveError
from sim_core.weave import Draft, Weave, facts_of, plain, satin
from sim_core.weave.draft import (
    Harness,
    brocade,
    four_end_gauze,
    gauze,
    tapestry,
    warp_compound,
    weft_compound,
)
from sim_core.weave.files import source_of, weave_of
from sim_core.weave.files.wif import PRIVATE, Wif, decoded, parse_wif, read_wif, wif_of, wif_text, write_wif
from sim_core.weave.yarns import main_picks, solve, strands

FOLDER = Path(__file__).parents[2] / "assets" / "weaves"
BASE = """[WIF]
Version=1.1
Date=April 20, 1997
[CONTENTS]
THREADING=true
[WEAVING]
Shafts=2
Treadles=2
Rising Shed=true
[WARP]
Threads=4
Color=1
[WEFT]
Threads=2
Color=2
[COLOR TABLE]
1=255,0,0
2=0,0,255
[THREADING]
1=1
2=2
3=1
4=2
[TIEUP]
1=1
2=2
[TREADLING]
1=1
2=2
"""
TABBY = [[1, 0, 1, 0], [0, 1, 0, 1]]
# each trap: text, the lift it must give
TRAPS = {
    "plain": (BASE, TABBY),
    "blanks round =": (BASE.replace("=", " = "), TABBY),
    "any case": (BASE.upper().replace("TRUE", "True"), TABBY),
    "old Mac line ends": (BASE.replace("\n", "\r"), TABBY),
    "Windows line ends": (BASE.replace("\n", "\r\n"), TABBY),
    "byte order mark": ("\ufeff" + BASE, TABBY),
    "comments": (BASE.replace("1=1\n", "; note\n1=1 ; first\n", 1), TABBY),
    "yes": (BASE.replace("Rising Shed=true", "Rising Shed=yes"), TABBY),
    "on": (BASE.replace("Rising Shed=true", "Rising Shed=ON"), TABBY),
    "1": (BASE.replace("Rising Shed=true", "Rising Shed=1"), TABBY),
    "sinking shed": (BASE.replace("Rising Shed=true", "Rising Shed=false"), [[0, 1, 0, 1], [1, 0, 1, 0]]),
    "no contents": (BASE.replace("[CONTENTS]\nTHREADING=true\n", ""), TABBY),
    "any date": (BASE.replace("April 20, 1997", "3.4.2021"), TABBY),
    "1.0": (BASE.replace("Version=1.1", "Version=1.0"), TABBY),
    "no version": (BASE.replace("Version=1.1\n", ""), TABBY),
    "surplus treadles": (BASE.replace("Treadles=2", "Treadles=10"), TABBY),
    "treadle beyond what was announced": (BASE.replace("Treadles=2", "Treadles=1"), TABBY),
    "threads beyond what was announced": (BASE.replace("Threads=4", "Threads=3"), TABBY),
    "threads without a line": (BASE.replace("4=2\n[TIEUP]", "[TIEUP]"), [[1, 0, 1, 0], [0, 1, 0, 0]]),
    "several treadles": (
        BASE.replace("[TREADLING]\n1=1", "[TREADLING]\n1=1,2"),
        [[1, 1, 1, 1], [0, 1, 0, 1]],
    ),
    "several shafts": (BASE.replace("[THREADING]\n1=1", "[THREADING]\n1=1, 2"), [[1, 0, 1, 0], [1, 1, 0, 1]]),
    "0 is none": (BASE.replace("2=2\n", "2=0\n", 1), [[1, 0, 1, 0], [0, 0, 0, 1]]),
    "empty is none": (BASE.replace("[TREADLING]\n1=1", "[TREADLING]\n1="), [[0, 0, 0, 0], [0, 1, 0, 1]]),
    "lift plan": (BASE.split("[TIEUP]")[0] + "[LIFTPLAN]\n1=1\n2=1,2\n", [[1, 0, 1, 0], [1, 1, 1, 1]]),
    "lift plan beside treadling": (BASE + "[LIFTPLAN]\n1=1\n2=1,2\n", [[1, 0, 1, 0], [1, 1, 1, 1]]),
    "empty lift plan beside treadling": (BASE + "[LIFTPLAN]\n", TABBY),
    "unknown sections": (BASE + "[WARP SYMBOLS]\n1=x\n[PRIVATE Other Program]\na=b;c\n", TABBY),
    "repeated section": (BASE + "[WEFT]\nThickness=0.1\n", TABBY),
    "end of file mark of DOS": (BASE + "\x1a\n", TABBY),
}


@pytest.mark.parametrize("name", TRAPS)
def test_each_trap_gives_its_drawdown_and_survives_a_round_trip(name, tmp_path):
    text, lift = TRAPS[name]
    path = tmp_path / "trap.wif"
    path.write_bytes(text.encode("utf-8"))
    wif = read_wif(path)
    np.testing.assert_array_equal(wif.draft.lift, lift)
    assert parse_wif(wif_text(wif)) == replace(wif, remarks=())


def test_a_range_of_one_number_is_the_highest_value():
    wif = parse_wif(BASE.replace("1=255,0,0", "1=999,0,500") + "[COLOR PALETTE]\nRange=999\n")
    assert wif.top == 999
    np.testing.assert_array_equal(wif.palette[0], [999, 0, 500])


def test_a_bracket_in_a_text_is_no_section():
    wif = parse_wif(BASE + "[NOTES]\n1=woven\n[not yet washed\n")
    assert wif.notes == ("woven", "[not yet washed")


def test_lift_plan_that_differs_is_remarked_and_one_that_agrees_is_not():
    assert "lift plan was taken" in parse_wif(TRAPS["lift plan beside treadling"][0]).remarks[0]
    both = parse_wif(BASE + "[LIFTPLAN]\n1=1\n2=2\n")
    assert both.remarks == ()
    assert not both.plan


def test_colours_defaults_ranges_and_surplus():
    wif = parse_wif(BASE + "[WARP COLORS]\n2=2\n9=2\n")
    assert wif.warp_colours.tolist() == [1, 2, 1, 1]  # absent lines mean the default
    assert wif.weft_colours.tolist() == [2, 2]
    wide = parse_wif(
        BASE.replace("[COLOR TABLE]\n1=255,0,0", "[COLOR PALETTE]\nRange=0,999\n[COLOR TABLE]\n1=999,0,500")
    )
    assert (wide.top, wide.palette[0].tolist()) == (999, [999, 0, 500])
    assert parse_wif(wif_text(wide)) == wide
    assert parse_wif(BASE.replace("Color=1\n", "")).warp_colours.tolist() == [1] * 4


@pytest.mark.parametrize(
    ("unit", "metres"), [("Centimeters", 0.01), ("Inches", 0.0254), ("decipoints", 0.0254 / 720)]
)
def test_units(unit, metres):
    wif = parse_wif(BASE.replace("[WEFT]\n", f"[WEFT]\nUnits={unit}\nSpacing=.212\n"))
    assert wif.spacing == (None, pytest.approx(0.212 * metres, rel=1e-12))


def test_old_windows_letters():
    data = BASE.replace("[WEAVING]", "[TEXT]\nTitle=Köper\n[WEAVING]").encode("cp1252")
    assert parse_wif(decoded(data)).title == "Köper"


UNITS = BASE.replace("[WARP]\n", "[WARP]\nUnits={unit}\nSpacing={length}\n")


@pytest.mark.parametrize(
    ("unit", "length"), [("Inches", ".05"), ("decipoints", "29"), ("Centimeters", "0.21200001234567")]
)
def test_lengths_survive_whatever_their_unit(unit, length):
    wif = parse_wif(UNITS.format(unit=unit, length=length) + f"[WARP SPACING]\n2={length}\n")
    again = parse_wif(wif_text(wif))
    assert again == wif
    (_, ((key, value),)) = again.other[0]  # written beside Units=Centimeters
    assert key == "2"
    assert float(value) / 100 == pytest.approx(wif.spacing[0], rel=1e-12)


@pytest.mark.parametrize(("text", "metres"), [("0,212", 0.00212), ("2.5E-02", 0.00025), ("", None)])
def test_lengths_as_programs_of_other_countries_write_them(text, metres):
    spacing = parse_wif(UNITS.format(unit="Centimeters", length=text)).spacing[0]
    assert spacing == (metres if metres is None else pytest.approx(metres, rel=1e-12))


def test_letters_beyond_ascii_come_back_and_the_file_stays_ascii():
    notes = "[NOTES]\n1=Größe &#38; &#10; Maß\ngoes on\n[TEXT]\nTitle=四经绞罗\nAuthor=Müller\n"
    wif = parse_wif(BASE + notes + "[PRIVATE OTHER]\nfree words\nschön=wörtlich\n")
    assert wif.title == "四经绞罗"
    assert wif.notes == ("Größe & &#10; Maß", "goes on")
    assert wif.other == (("PRIVATE OTHER", (("schön", "wörtlich"),)),)
    assert wif_text(wif).isascii()
    assert parse_wif(wif_text(wif)) == wif


BAD = {
    r"\[WIF\]: missing": BASE.replace("[WIF]", "[WAF]"),
    r"\[WIF\] Version: '2.0'": BASE.replace("1.1", "2.0"),
    r"line 1: .*begins with \[WIF\]": "hello\n",
    r"\[THREADING\]: missing": BASE.replace("[THREADING]", "[THREADS]"),
    r"\[LIFTPLAN\]: missing": BASE.replace("[TIEUP]", "[TIE]"),
    r"\[THREADING\] 3: 'x'": BASE.replace("3=1", "3=x"),
    r"\[THREADING\] 99999: line number": BASE.replace("3=1", "99999=1"),
    r"\[WARP\] Threads: 99999999": BASE.replace("Threads=4", "Threads=99999999"),
    r"\[WEAVING\] Rising Shed: 'up'": BASE.replace("Rising Shed=true", "Rising Shed=up"),
    r"\[TIEUP\] line \d+: .*key=value": BASE.replace("[TIEUP]\n", "[TIEUP]\nnonsense\n"),
    r"close the section": BASE.replace("[TIEUP]", "[TIEUP"),
}  # fmt: skip


# what no lift needs: replaced or left out, and told
REPLACED = {
    "[WARP] Spacing: '9e9'": UNITS.format(unit="Inches", length="9e9"),
    "[WARP SPACING] 1: 'x' is not a length": BASE + "[WARP SPACING]\n1=x\n",
    "[WEFT] Spacing: 'wide' is not a length": BASE.replace("[WEFT]\n", "[WEFT]\nSpacing=wide\n"),
    "[WEFT] Units: 'furlongs'": BASE.replace("[WEFT]\n", "[WEFT]\nUnits=furlongs\nSpacing=1\n"),
    "[COLOR TABLE] 1: no red,green,blue": BASE.replace("1=255,0,0", "1=1,2"),
    "[COLOR TABLE] 2: outside the range 0,255": BASE.replace("2=0,0,255", "2=0,0,256"),
    "[COLOR TABLE]: missing": BASE.replace("[COLOR TABLE]", "[COLOURS]") + "[WARP COLORS]\n1=1\n",
    "[COLOR PALETTE] Range: 'all' is no range": BASE + "[COLOR PALETTE]\nRange=all\n",
    "[COLOR TABLE]: its colours are numbered from 0": BASE.replace("[COLOR TABLE]", "[COLOR TABLE]\n0=9,9,9"),
    "[WARP] Color: '9999' is no colour – colour 1 was taken": BASE.replace("Color=1\n", "Color=9999\n"),
    "[WARP] Color: no colour – colour 1 was taken": BASE.replace("Color=1\n", ""),
    "[WEFT] Color: '-1' is no colour – colour 2 was taken": BASE.replace("Color=2\n", "Color=-1\n"),
    "[WARP COLORS] 1, 3: colour 7 is not among the 2": BASE + "[WARP COLORS]\n1=7\n3=7\n",
    "[WARP COLORS] 4: no colour – colour 1 was taken": BASE + "[WARP COLORS]\n4=\n",
    "[WEFT COLORS] 9: no such thread": BASE + "[WEFT COLORS]\n9=1\n",
    "[TEXT] line 32: 'of a scarf' says nothing": BASE + "[TEXT]\nTitle=a\nof a scarf\n",
    "line 1: 'saved by hand' says nothing": "saved by hand\n" + BASE,
    "[WARP] Color: said twice": BASE.replace("Color=1\n", "Color=2\nColor=1\n"),
    "[WEFT] Threads: missing – there are lines for 2": BASE.replace("Threads=2\n", ""),
    "[WARP] Threads: empty – there are lines for 4": BASE.replace("Threads=4", "Threads="),
    "[WARP] Threads: 3, but there are lines for 4": BASE.replace("Threads=4", "Threads=3"),
    "[THREADING] 5: on no shaft": BASE.replace("Threads=4", "Threads=5"),
    "[WEAVING] Treadles: 1, but [TREADLING] uses 2": BASE.replace("Treadles=2", "Treadles=1"),
    "[WEAVING] Shafts: 'some' – not a number": BASE.replace("Shafts=2", "Shafts=some"),
    "[WEAVING] Treadles: '' – not a number": BASE.replace("Treadles=2", "Treadles="),
    "[WEAVING] Treadles: '99999' – not a number": BASE.replace("Treadles=2", "Treadles=99999"),
    "[WEAVING] Rising Shed: empty": BASE.replace("Rising Shed=true", "Rising Shed="),
    "[WEAVING] Rising Shed: false": BASE.replace("Rising Shed=true", "Rising Shed=false"),
    "[TIEUP] 2: trodden, but tied to no shaft": BASE.replace("1=1\n2=2\n[TREADLING]", "1=1\n[TREADLING]"),
    "[COLOR PALETTE] Range: '255' – taken for 0,255": BASE + "[COLOR PALETTE]\nRange=255\n",
    "[WARP COLORS] 1: colour 3 has no line": BASE.replace("2=0,0,255", "2=0,0,255\n4=9,9,9") + "[WARP COLORS]\n1=3\n",
    "[WARP COLORS] one, 0: no such thread": BASE + "[WARP COLORS]\none=1\n0=1\n4=1\n",
    "[WEFT COLORS]: its threads are numbered from 0": BASE + "[WEFT COLORS]\n0=1\n1=2\n",
    "[WEFT] Spacing: '0' is no length": BASE.replace("[WEFT]\n", "[WEFT]\nSpacing=0\n"),
    "[CONTENTS] warp colors, NOTES: announced": BASE + "[CONTENTS]\nwarp colors=yes\nTEXT=no\nNOTES=1\nMINE=1\n",
    "[WEFT COLOURS]: no section of WIF": BASE + "[WEFT COLOURS]\n1=1\n",
    "line 30: '[TEXT' has no ]": BASE + "[TEXT\nTitle=a\n",
    "[WIF]: missing – read as version 1.1": BASE.replace("[WIF]\nVersion=1.1\n", ""),
    "[WIF] Version: empty": BASE.replace("1.1", ""),
    "[TIEUP] 1: what follows ; is a comment": BASE.replace("[TIEUP]\n1=1\n", "[TIEUP]\n1=1;\n1=1; 2\n"),
    "[LIFTPLAN] 2: lifts no shaft": BASE.replace("[TREADLING]", "[LIFTPLAN]\n1=1\n2=0\n[TREADLING]"),
    "[LIFTPLAN] 2: no line, though trodden – [TIEUP] and [TREADLING] were taken": BASE.replace(
        "[TREADLING]", "[LIFTPLAN]\n1=1,2\n[TREADLING]"
    ),
    "[WARP] Threads: 'four' is no number of threads – there are lines for 4": BASE.replace(
        "Threads=4", "Threads=four"
    ),
    "[WEFT] Threads: '-2' is no number of threads": BASE.replace("Threads=2", "Threads=-2"),
    "[THREADING]: its threads are numbered from 0": BASE.replace(
        "[THREADING]\n1=1\n2=2\n3=1\n4=2", "[THREADING]\n0=1\n1=2\n2=1\n3=2"
    ),
    "[PRIVATE HALL WEAVE]: damaged": BASE + f'[{PRIVATE}]\n1="{{"\n',
    "[PRIVATE HALL WEAVE]: draft": BASE + f'[{PRIVATE}]\n1="{{"draft":{{}}}}"\n',
}  # fmt: skip


@pytest.mark.parametrize("remark", REPLACED)
def test_what_no_draft_needs_is_replaced_and_every_replacement_is_told(remark):
    wif = parse_wif(REPLACED[remark])
    assert any(told.startswith(remark) for told in wif.remarks), wif.remarks
    ends = wif.harness.threading.shape[0]
    if not any(word in remark for word in ("Rising", "tied to no shaft", "lifts no shaft")):
        np.testing.assert_array_equal(wif.draft.lift, np.pad(TABBY, ((0, 0), (0, ends - 4))))
    assert parse_wif(BASE).remarks == ()


@pytest.mark.parametrize("message", BAD)
def test_bad_files_give_one_line_with_section_and_key(message, tmp_path):
    path = tmp_path / "bad.wif"
    path.write_text(BAD[message], "utf-8")
    with pytest.raises(SimCoreError, match=message) as caught:
        read_wif(path)
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith(str(path))


def test_writing_is_strict():
    text = wif_text(wif_of(Draft("缎 \n x", satin(8, 3).lift)))
    lines = text.split("\r\n")
    assert text.isascii()
    assert "\n" not in text.replace("\r\n", "")
    assert lines[0] == "[WIF]"
    assert "Version=1.1" in lines
    assert "Date=April 20, 1997" in lines
    named = [line[1:-1] for line in lines if line.startswith("[")]
    contents = lines[lines.index("[CONTENTS]") + 1 :]
    announced = [line.removesuffix("=true") for line in contents[: contents.index("")]]
    assert announced == named[2:]
    assert not any(" =" in line or "= " in line for line in lines if not line.startswith(tuple("0123456789")))


CHANNELLED = [
    gauze(2),
    four_end_gauze(),
    warp_compound(np.eye(4, dtype=int), 2),
    weft_compound(np.eye(4, dtype=int), 2),
    tapestry(np.indices((4, 6))[1] // 3),
    brocade(np.pad(np.zeros((2, 4), int), 2, constant_values=-1)),
]


@pytest.mark.parametrize("draft", CHANNELLED, ids=lambda d: d.name)
def test_what_wif_cannot_say_is_kept(draft):
    again = parse_wif(wif_text(wif_of(draft)))
    assert again.draft == draft
    assert again == wif_of(draft)


# Of those with a motif file the smallest alone: a lift plan of two million crossings is a long text.
SMALL = [
    path
    for path in sorted(FOLDER.glob("*.toml"))
    if path.stem in ("lozenge-qi", "cup-luo") or 'motif = "' not in path.read_text("utf-8")
]


@pytest.mark.parametrize("path", SMALL, ids=lambda p: p.stem)
def test_every_shipped_weave_survives_wif_whole(path, tmp_path):
    weave = Weave.load(path)
    file = tmp_path / "w.wif"
    write_wif(wif_of(weave), file)
    assert read_wif(file).weave == weave


def test_a_draft_changed_by_another_program_beats_the_private_section():
    text = wif_text(wif_of(plain()))
    changed = text.replace("[TREADLING]\r\n1=1", "[TREADLING]\r\n1=2")
    assert changed != text
    assert parse_wif(changed).draft.lift.tolist() == [[0, 1], [0, 1]]


def test_a_thousand_generated_files_come_back_identical():
    rng = np.random.default_rng(11)
    plans = 0
    for _ in range(1000):
        wif = generated(rng)
        plans += wif.plan
        again = parse_wif(wif_text(wif))
        assert again == wif
        np.testing.assert_array_equal(again.draft.lift, wif.harness.lift)
    assert 100 < plans < 900


def test_a_thousand_damaged_files_are_answered_in_one_line():
    rng = np.random.default_rng(12)
    answers = []
    for _ in range(1000):
        text = damaged(rng)
        begin = perf_counter()
        try:
            wif = parse_wif(text)
            assert wif.draft.lift.size > 0
        except WeaveError as error:
            answers.append(str(error))
        assert perf_counter() - begin < 5  # a hang, not a speed
    assert 100 < len(answers) < 950
    assert not [answer for answer in answers if "\n" in answer or not ("[" in answer or "line" in answer)]


def test_wif_values_that_do_not_fit_are_named():
    harness = Harness(np.eye(2), np.eye(2), np.eye(2))
    with pytest.raises(WeaveError, match="2 are wanted"):
        Wif("x", harness, warp_colours=np.array([1]))
    with pytest.raises(WeaveError, match="outside the palette"):
        Wif("x", harness, warp_colours=np.array([1, 9]))


def wide(ends: int, extra: str = "") -> str:
    head, rest = BASE.replace("Threads=4", f"Threads={ends}").split("[THREADING]\n")
    threading = "".join(f"{k + 1}={k % 2 + 1}\n" for k in range(ends))
    return head + "[THREADING]\n" + threading + "[TIEUP]" + rest.split("[TIEUP]")[1] + extra


def test_a_warp_of_thousands_is_read_whole_and_relaxed_by_its_repeat(tmp_path):
    (tmp_path / "wide.wif").write_text(
        wide(3001, "[WARP COLORS]\n" + "".join(f"{k}=2\n" for k in range(1, 3002, 3)))
    )
    source = source_of(str(tmp_path / "wide.wif"))
    assert (source.factors.ends, source.factors.picks) == (3001, 2)
    weave, origin = source.weave
    np.testing.assert_array_equal(weave.draft.lift, np.tile(TABBY, 2)[:, :6])  # structure 2, colours 3
    assert weave.draft.channels.end_series.tolist() == [1, 0, 0] * 2
    assert "cut to its repeat of 6 of 3001 ends" in origin


def test_a_colour_that_does_not_repeat_is_left_out_of_the_relaxed_repeat(tmp_path):
    weave, origin = cloth_in(wide(2000, "[WARP COLORS]\n7=2\n"), tmp_path)
    assert weave.draft.lift.shape == (2, 2)
    assert "the colours of its ends do not repeat and were left out" in origin


@pytest.mark.parametrize(
    ("text", "warp"),
    [
        (BASE.replace("Color=1", "Color=0"), [1, 1, 1, 1]),
        (BASE + "[WARP COLORS]\n2=0\n3=2\n", [1, 1, 2, 1]),
        (BASE.replace("[COLOR TABLE]\n1=255,0,0\n2=0,0,255\n", "") + "[WARP COLORS]\n1=5\n", [5, 1, 1, 1]),
        (BASE + "[WARP COLORS]\n4=9\n", [1, 1, 1, 9]),
    ],
)
def test_colours_that_no_table_has_do_not_hide_the_draft(text, warp):
    wif = parse_wif(text)
    assert wif.warp_colours.tolist() == warp
    assert len(wif.palette) >= max(warp)
    np.testing.assert_array_equal(wif.draft.lift, TABBY)
    assert parse_wif(wif_text(wif)) == wif


def cloth_in(text, folder):
    (folder / "given.wif").write_text(text)
    return weave_of(str(folder / "given.wif"))


def test_a_wif_is_woven_in_its_colours_sett_and_sizes(tmp_path):
    text = BASE.replace("[WARP]\n", "[WARP]\nSpacing=.05\nThickness=.02\n")
    text = text.replace("[WEFT]\n", "[WEFT]\nSpacing=.04\nThickness=.015\n") + "[WARP COLORS]\n2=2\n4=2\n"
    weave, origin = cloth_in(text, tmp_path)
    assert (weave.end_spacing, weave.pick_spacing) == pytest.approx((5e-4, 4e-4))
    assert (weave.warp.diameter, weave.weft.diameter) == pytest.approx((2e-4, 1.5e-4))
    assert weave.warp.tex == pytest.approx(weave.weft.tex * (2 / 1.5) ** 2)
    assert weave.warp_colours == ((1, 0, 0), (0, 0, 1))
    assert weave.weft.colour == (0, 0, 1)
    assert origin.startswith("sett and thickness and colours of given.wif")
    ends = strands(weave, solve(weave))[0]
    assert [tuple(ends.palette[c]) for c in ends.colour[:, 0]] == [(1, 0, 0), (0, 0, 1)] * 2
    assert facts_of(source_of(str(tmp_path / "given.wif")))["repeat"] == {"ends": 2, "picks": 2}


def test_sizes_of_the_screen_keep_the_spacing(tmp_path):
    same = BASE.replace("[WARP]\n", "[WARP]\nSpacing=.2\nThickness=.2\n")
    weave, origin = cloth_in(same.replace("[WEFT]\n", "[WEFT]\nSpacing=.2\nThickness=.2\n"), tmp_path)
    assert weave.end_spacing == weave.pick_spacing == pytest.approx(2e-3)
    assert "its thickness does not fit its sett" in origin
    far = BASE.replace("[WARP]\n", "[WARP]\nSpacing=90000\n")
    assert "of no cloth" in cloth_in(far, tmp_path)[1]


@pytest.mark.parametrize("name", ["jin", "weijin", "kesi", "zhuanghua"])
def test_colours_of_every_thread_are_written(name):
    weave = Weave.load(FOLDER / f"{name}.toml")
    wif = parse_wif(wif_text(wif_of(weave)))
    warp, weft = strands(weave, solve(weave))[:2]
    for colours, system, numbers in (
        (wif.warp_colours, warp, range(weave.draft.ends)),
        (wif.weft_colours, weft, main_picks(weave)),
    ):
        for k, number in enumerate(numbers):
            shown = system.colour[k][system.colour[k] >= 0]
            if weave.draft.channels.region is not None and system is weft:
                row = weave.draft.channels.region[number]
                shown = row[row >= 0]
            usual = system.palette[np.bincount(shown).argmax()]
            assert np.abs(wif.palette[colours[number] - 1] / 255 - usual).max() <= 0.5 / 255 + 1e-9
    assert len(np.unique(np.append(wif.warp_colours, wif.weft_colours))) > 2
