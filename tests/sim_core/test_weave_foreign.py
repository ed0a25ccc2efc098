"""Drafts of other programs through the command: what needs no physics is always answered, and replacements are told."""

import json
from pathlib import Path

import numpy as np
import pytest

from sim_core.cli import main
from sim_core.errors import WeaveError
from sim_core.weave import facts_of
from sim_core.weave.files import parse_dtx, read_dtx, source_of_wif
from sim_core.weave.files.wif import read_wif

FOLDER = Path(__file__).parent / "drafts"
READABLE = sorted(p for p in FOLDER.iterdir() if p.suffix in (".wif", ".dtx") and p.stem != "missing-tieup")
FACTS = {
    "repeat",
    "face",
    "floats",
    "interlacings",
    "integral",
    "draft",
    "loose",
    "colours",
    "drawdown",
    "remarks",
}


def told(capsys, *words: object) -> tuple[int, dict, str]:
    status = main(["weave", *(str(word) for word in words), "--json"])
    out, err = capsys.readouterr()
    return status, json.loads(out) if out else {}, err


@pytest.mark.parametrize("path", READABLE, ids=lambda p: p.name)
def test_every_readable_draft_is_answered(path, capsys):
    status, summary, err = told(capsys, path)
    assert (status, err) == (0, "")
    assert set(summary) >= FACTS
    lift = np.array([[int(place) for place in row] for row in summary["drawdown"]])
    assert lift.shape == (summary["draft"]["picks"], summary["draft"]["ends"])
    for side, yarns in (("ends", lift.T), ("picks", lift)):
        loose = [k for k, yarn in enumerate(yarns, 1) if len(set(yarn.tolist())) == 1]
        assert summary["loose"][side] == loose
    for side, count in (("warp", lift.shape[1]), ("weft", lift.shape[0])):
        assert sum(entry["yarns"] for entry in summary["colours"][side]) == count
    assert ("crimp" in summary) != ("note" in summary)
    if summary["loose"]["ends"] or summary["loose"]["picks"]:
        assert not summary["integral"]


def test_what_cannot_be_relaxed_is_told_once_behind_the_summary(tmp_path, capsys):
    path = FOLDER / "many-color-single-treadles.wif"
    status, summary, err = told(
        capsys, path, "--relax", "--maps", tmp_path / "maps", "--yarns", tmp_path / "y.glb"
    )
    assert status == 1
    assert err.count("\n") == 1
    assert "never interlace" in err
    assert summary["repeat"] == {"ends": 12, "picks": 13}
    assert "never interlace" in summary["note"]
    assert not (tmp_path / "y.glb").exists()


def test_replacements_are_remarks_or_lines_on_stderr(capsys):
    path = FOLDER / "weft-colour-too-big.wif"
    _, summary, _ = told(capsys, path)
    assert any("[WEFT COLORS] 1: colour 11 is not among the 10" in remark for remark in summary["remarks"])
    assert main(["weave", str(path)]) == 0
    out, err = capsys.readouterr()
    assert [line.split(": ", 2)[2] for line in err.splitlines()] == summary["remarks"]
    assert "FALLS APART" in out


def test_a_draft_without_a_tie_up_is_refused_in_one_line(capsys):
    assert main(["weave", str(FOLDER / "missing-tieup.wif")]) == 1
    assert capsys.readouterr().err.count("\n") == 1


PAIRS = sorted(p for p in FOLDER.glob("*.dtx"))


@pytest.mark.parametrize("path", PAIRS, ids=lambda p: p.name)
def test_a_dtx_says_what_the_wif_of_the_same_program_says(path):
    dtx, wif = read_dtx(path), read_wif(path.with_suffix(".wif"))
    np.testing.assert_array_equal(dtx.factors.lift(), wif.factors.lift())
    assert (dtx.title, dtx.spacing) == (wif.title, wif.spacing)
    if path.stem != "many-color-multiple-treadles-and-zeros":  # made with another palette
        np.testing.assert_array_equal(dtx.palette[dtx.warp_colours - 1], wif.palette[wif.warp_colours - 1])
        np.testing.assert_array_equal(dtx.palette[dtx.weft_colours - 1], wif.palette[wif.weft_colours - 1])


DTX = (FOLDER / "two-color-single-treadles-sinking-shed.dtx").read_text("utf-8")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (DTX.replace("@@StartDTX", "@@Start"), "@@StartDTX: missing"),
        (DTX.replace("@@Threading", "@@Threads"), "@@Threading: missing"),
        (DTX.replace("@@Tieup", "@@Tie"), "[LIFTPLAN]: missing"),
        (DTX.replace("@@Treadling", "@@Treadling\nx"), "[TREADLING] 1: 'x'"),
        (DTX.replace("@@Tieup", "@@Tieup\n012"), "[TIEUP] row 1: '012'"),
    ],
)
def test_a_damaged_dtx_is_named_by_section(text, message):
    with pytest.raises(WeaveError) as caught:
        parse_dtx(text)
    assert str(caught.value).startswith(message)


def test_a_dtx_without_its_end_is_told_to_be_cut_off():
    cut = DTX.partition("@@EndDTX")[0]
    assert parse_dtx(cut).remarks == (
        "@@EndDTX: missing – the file seems to be cut off",
        *parse_dtx(DTX).remarks,
    )


@pytest.mark.parametrize(
    ("text", "remark"),
    [
        (DTX.replace("@@Info", "@@Inform"), "@@Info: missing"),
        (DTX.replace("Weft Colors", "Weft Colours"), "[WEFT] Color: no colour"),
        (DTX.replace("@@Weft Colors", "@@Weft Colours"), "@@Contents Weft Colors: announced"),
        (DTX.replace("@@Weft Colors", "@@Weft Colors\n1 1\n@@Other"), "@@Weft Colors: 2 of "),
        (DTX.replace("@@Threading", "@@Threading\n32"), "@@Tieup: "),
    ],
)
def test_what_a_damaged_dtx_lacks_is_told(text, remark):
    assert not any(told.startswith(remark) for told in parse_dtx(DTX).remarks)
    assert any(told.startswith(remark) for told in parse_dtx(text).remarks), parse_dtx(text).remarks


@pytest.mark.parametrize("name", ["scarf.wpo", "folder"])
def test_files_of_other_kinds_are_named_as_such(name, tmp_path, capsys):
    path = tmp_path / name
    if path.suffix:
        path.write_bytes(b"WPO")
    else:
        path.mkdir()
    status, _, err = told(capsys, path)
    assert (status, err.count("\n")) == (1, 1)
    assert ".wif" in err
    assert "no such weave" not in err


def large(tmp_path: Path, ends: int, picks: int) -> Path:
    """A point twill of that size, as a WIF file."""
    rows = {"THREADING": ends, "TREADLING": picks}
    lines = [f"[WIF]\nVersion=1.1\n[WARP]\nThreads={ends}\nColor=1\n[WEFT]\nThreads={picks}\nColor=2\n"]
    lines.append(
        "[COLOR TABLE]\n1=200,30,30\n2=250,240,220\n[TIEUP]\n"
        + "".join(f"{k}={k},{k % 8 + 1}\n" for k in range(1, 9))
    )
    for name, count in rows.items():
        lines.append(
            f"[{name}]\n" + "".join(f"{k}={abs((k - 1) % 14 - 7) % 8 + 1}\n" for k in range(1, count + 1))
        )
    path = tmp_path / "large.wif"
    path.write_text("".join(lines))
    return path


def test_a_treadled_draft_of_twenty_thousand_is_answered_and_relaxed_only_by_its_repeat(tmp_path, capsys):
    path = large(tmp_path, 19_600, 140)
    status, summary, _ = told(capsys, path)
    assert status == 0
    assert summary["repeat"] == {"ends": 14, "picks": 14}
    assert summary["drawdown"] is None
    assert "only with --relax" in summary["note"]
    status, summary, _ = told(capsys, path, "--maps", tmp_path / "maps", "--size", 64)
    assert status == 0
    assert "cut to its repeat of 14 of 19600 ends" in summary["parameters"]["yarns_from"]
    assert (tmp_path / "maps" / "lit.png").exists()


def test_the_wif_that_is_written_keeps_the_harness_of_the_file(tmp_path, capsys):
    path = FOLDER / "many-color-multiple-treadles-and-zeros.dtx"
    assert main(["weave", str(path), "--wif", str(tmp_path / "out.wif"), "--json"]) == 0
    capsys.readouterr()
    given, written = read_dtx(path), read_wif(tmp_path / "out.wif")
    for part in ("threading", "tieup", "treadling"):
        np.testing.assert_array_equal(getattr(written.harness, part), getattr(given.harness, part))
    np.testing.assert_array_equal(written.weft_colours, given.weft_colours)


def hurt(text: str, rng: np.random.Generator) -> str:
    """A good file with a letter changed, a line lost, doubled or replaced, or cut short."""
    for _ in range(int(rng.integers(1, 5))):
        lines = text.split("\n")
        at, kind = int(rng.integers(len(lines))), int(rng.integers(5))
        if kind == 0:
            place = int(rng.integers(len(text) + 1))
            text = text[:place] + chr(int(rng.integers(0x250))) + text[place + 1 :]
        elif kind == 1:
            text = "\n".join(lines[:at] + lines[at + 1 :])
        elif kind == 2:
            text = "\n".join([*lines, lines[at]])
        elif kind == 3:
            lines[at] = str(
                rng.choice(["-1", "1e9", "99999999999", "0", "", "1,,2", "%%ends 9", "%%", "@@", "٣"])
            )
            text = "\n".join(lines)
        else:
            text = text[: int(rng.integers(len(text) + 1))]
    return text


def test_damaged_dtx_files_are_answered_or_refused_in_one_line():
    rng = np.random.default_rng(8)
    texts = [path.read_text("utf-8") for path in PAIRS]
    refused = []
    for k in range(600):
        try:
            wif = parse_dtx(hurt(texts[k % len(texts)], rng))
        except WeaveError as error:
            refused.append(str(error))
        else:
            json.dumps(facts_of(source_of_wif(wif, Path("hurt.dtx"))))
    assert 60 < len(refused) < 540
    assert not [line for line in refused if "\n" in line]


SHORT = """@@StartDTX
@@Info
%%shafts 2
%%treadles 2
%%ends 4
%%picks 2
@@Threading
1 2 1 2
@@Tieup
01
10
@@Treadling
1 2
@@Color Palet
255,255,255
0,0,0
@@Warp Colors
0 1 0 7
@@Weft Colors
1 1
@@EndDTX
"""


def test_a_dtx_counts_its_colours_from_nought_also_in_remarks():
    wif = parse_dtx(SHORT)
    assert wif.remarks == ("[WARP COLORS] 4: colour 7 is not among the 2 of [COLOR TABLE] – white was taken",)
    assert wif.warp_colours.tolist()[:3] == [1, 2, 1]
    (remark,) = parse_dtx(SHORT.replace("0,0,0", "black").replace("0 7", "0 0")).remarks[:1]
    assert remark.startswith("[COLOR TABLE] 1: no red,green,blue")


@pytest.mark.parametrize("told", ["four", "²", "-4", "4.0"])
def test_a_dtx_whose_ends_are_no_number_is_counted(told):
    wif = parse_dtx(SHORT.replace("%%ends 4", f"%%ends {told}").replace("0 7", "0 0"))
    assert wif.remarks == (f"[WARP] %%ends: '{told}' is no number of threads – there are lines for 4",)
    assert wif.harness.threading.shape == (4, 2)
