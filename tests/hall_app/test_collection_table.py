"""The catalogue as a table: what is not changed changes not one byte, what is changed is changed faithfully."""

from __future__ import annotations

import contextlib
import csv
import io
import tomllib
from pathlib import Path

import pytest
from content_house import add_exhibit, make_house
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from museum import HOSTILE, RECORD, both, exhibit, read

from hall_app.cli import main
from hall_app.content.schema import Bilingual
from hall_app.web.collection.table import (
    Acceptance,
    Change,
    EditError,
    accept,
    changes,
    edited,
    guarded,
    read_sheet,
    table,
    unguarded,
)

ASSETS = Path(__file__).parents[2] / "assets"
PAIRS = st.tuples(HOSTILE, HOSTILE)

# As curators write: comments, keys with dots, inline tables, literal and long texts, tables in an odd order.
WRITTEN = '''# The chest. 箱
title = { zh = '箱', en = "Chest" } # inline
caption.zh = """
一只
箱子"""
caption.en = "A chest"   # dotted
licence = "CC0-1.0"
behaviours = [
  "open_on_click", # comment in a list
  "glow_when_near",
]

[[media]]
kind = "picture"
file = "media/front.jpg"
alt = { zh = "正面", en = "The front" }

[record] # of wood
# before the material
material = { zh = "木", en = "Wood" }  # after it
wear.zh = "无"
wear.en = "none"

[record.date]
zh = "今"
en = "now"

[[record.line]]
label = { zh = "数", en = "Count" }
value = { zh = "一", en = "one" }

[models]
hall = "media/chest.glb"

[place]
x = 0.0
z = -1.0

[body]
shape = "round"
radius = 0.4
# the end
'''


def comments(text: str) -> list[str]:
    return [line[line.index("#") :] for line in text.splitlines() if "#" in line]


# Cells


@given(HOSTILE)
def test_a_guarded_text_is_no_formula_and_comes_back(text):
    cell = guarded(text)
    assert unguarded(cell) == text
    assert cell.lstrip()[:1] not in set("=+-@＝＋－＠")
    assert cell[:1] not in set("\t\r\n")


@pytest.mark.parametrize("text", ["'tis", "plain", "a=b", "3-4", ""])
def test_what_is_no_formula_stays_as_it_is(text):
    assert guarded(text) == text
    assert unguarded(text) == text


def test_a_cell_somebody_typed_is_read_as_it_stands():
    assert unguarded("=1+1") == "=1+1"
    assert unguarded("'s-Hertogenbosch") == "'s-Hertogenbosch"


# Out and in again


@settings(max_examples=120, deadline=None)
@given(
    texts=st.lists(PAIRS, min_size=len(RECORD), max_size=len(RECORD)),
    title=PAIRS,
    lines=st.lists(st.tuples(PAIRS, PAIRS), max_size=3),
)
def test_a_table_that_nobody_touched_changes_nothing(texts, title, lines):
    record = {name: both(*pair) for name, pair in zip(RECORD, texts, strict=True)}
    line = [{"label": both(*label), "value": both(*value)} for label, value in lines]
    exhibits = [exhibit("one", title=both(*title), record={**record, "line": line}), exhibit("two")]
    found, faults = changes(read_sheet(table(exhibits)), exhibits)
    assert faults == []
    assert found == {}


@settings(max_examples=120, deadline=None)
@given(before=PAIRS, after=PAIRS, licence=HOSTILE)
def test_what_a_spreadsheet_saves_is_what_is_taken_over(before, after, licence):
    """Through a reader and a writer of CSV that are not ours, with another separator and without our mark."""
    old = [exhibit(record={"material": both(*before)})]
    new = [exhibit(record={"material": both(*after)}, licence=licence)]
    rows = list(csv.reader(io.StringIO(table(new).decode("utf-8-sig"), newline="")))
    saved = io.StringIO(newline="")
    csv.writer(saved, delimiter=";", quoting=csv.QUOTE_ALL).writerows(rows)
    found, faults = changes(read_sheet(saved.getvalue().encode()), old)
    assert faults == []
    told = {change.path: change.value for change in found.get("chest", ())}
    same = [lines(a) == lines(b) for a, b in zip(before, after, strict=True)]
    if all(same):
        assert ("record", "material") not in told
    else:
        meant = [
            b if keep else a.replace("\r\n", "\n") for a, b, keep in zip(after, before, same, strict=True)
        ]
        assert told["record", "material"] == Bilingual(zh=meant[0], en=meant[1])
    if licence != "CC0-1.0":
        assert told["licence",] == licence


def lines(text: str) -> str:
    return text.replace("\r\n", "\n").replace("\r", "\n")


def test_the_shipped_folder_comes_back_byte_for_byte(tmp_path):
    before = {path: path.read_bytes() for path in ASSETS.glob("exhibits/*/exhibit.toml")}
    assert len(before) >= 5
    done = accept(ASSETS, table(read(ASSETS).exhibits))
    assert done == Acceptance({}, (), False)
    assert {path: path.read_bytes() for path in before} == before


# The rewritten file


@settings(max_examples=150, deadline=None)
@given(
    pair=PAIRS,
    path=st.sampled_from(
        ["title", "caption", "record.material", "record.date", "record.wear", "record.maker"]
    ),
)
def test_a_changed_text_is_the_only_change(pair, path):
    where = tuple(path.split("."))
    before = tomllib.loads(WRITTEN)
    meant = tomllib.loads(WRITTEN)
    inside = meant
    for key in where[:-1]:
        inside = inside[key]
    inside[where[-1]] = both(*pair)
    new = edited(WRITTEN, [Change(where, None, Bilingual(zh=pair[0], en=pair[1]))])
    assert tomllib.loads(new) == meant
    assert [c for c in comments(WRITTEN) if c not in new] == []
    assert list(tomllib.loads(new)) == list(before), "tables stay in their order"


def test_an_edit_touches_its_line_alone():
    change = Change(("record", "material"), None, Bilingual(zh="木", en="Oak"))
    old, new = WRITTEN.splitlines(), edited(WRITTEN, [change]).splitlines()
    assert [(a, b) for a, b in zip(old, new, strict=True) if a != b] == [
        (
            'material = { zh = "木", en = "Wood" }  # after it',
            'material = { zh = "木", en = "Oak" }  # after it',
        )
    ]


def test_line_ends_of_windows_stay():
    text = WRITTEN.replace("\n", "\r\n")
    new = edited(text, [Change(("record", "maker"), None, Bilingual(zh="匠", en="a joiner"))])
    assert new.count("\n") == new.count("\r\n")
    assert tomllib.loads(new)["record"]["maker"] == both("匠", "a joiner")


def test_a_new_line_of_a_record_and_a_text_that_goes():
    made = [
        Change(("record", "line", 1, "label"), None, Bilingual(zh="藏", en="Kept")),
        Change(("record", "line", 1, "value"), None, Bilingual(zh="库", en="in a store")),
        Change(("record", "material"), None, None),
        Change(("caption",), None, None),
    ]
    told = tomllib.loads(edited(WRITTEN, made))
    assert told["record"]["line"][1] == {"label": both("藏", "Kept"), "value": both("库", "in a store")}
    assert len(told["record"]["line"]) == 2
    assert "material" not in told["record"]
    assert "caption" not in told


@pytest.mark.parametrize("record", ["", '[record]\nmaker = { zh = "匠", en = "joiner" }\n', "[record]\n"])
def test_the_first_line_of_a_record(record):
    made = [
        Change(("record", "line", 0, "label"), None, Bilingual(zh="藏", en="Kept")),
        Change(("record", "line", 0, "value"), None, Bilingual(zh="库", en="store")),
    ]
    text = f"x = 1\n{record}\n[body]\ny = 2\n"
    told = tomllib.loads(edited(text, made))
    assert told["record"]["line"] == [{"label": both("藏", "Kept"), "value": both("库", "store")}]
    assert told["body"] == {"y": 2}


def test_what_tomlkit_cannot_write_is_refused_not_written():
    """Known of 0.15: beside keys written with dots, a new table takes the keys that follow into itself. Whatever comes
    out elsewhere than it was meant is no result."""
    text = "record.maker.zh = '甲'\nrecord.maker.en = 'a'\nz = 2\n"
    change = [Change(("record", "line", 0, "label"), None, Bilingual(zh="乙", en="b"))]
    meant = {"record": {"maker": both("甲", "a"), "line": [{"label": both("乙", "b")}]}, "z": 2}
    told = None
    with contextlib.suppress(EditError):
        told = tomllib.loads(edited(text, change))
    assert told in (None, meant)


def test_a_text_that_a_program_would_spoil_is_refused(monkeypatch):
    """Whatever tomlkit brings out elsewhere: here it loses a key."""
    import tomlkit

    real = tomlkit.dumps
    monkeypatch.setattr(
        tomlkit, "dumps", lambda document: real(document).replace("# before the material", "x = 1")
    )
    with pytest.raises(EditError, match="it would say something else"):
        edited(WRITTEN, [Change(("title",), None, Bilingual(zh="甲", en="a"))])


# Into a folder


@pytest.fixture
def house(tmp_path) -> Path:
    folder = make_house(tmp_path / "house")
    (folder / "exhibits/chest/exhibit.toml").write_text(WRITTEN, "utf-8")
    add_exhibit(folder, "box", WRITTEN.replace("z = -1.0", "z = 1.0"))
    return folder


def cell(data: bytes, row: int, column: str, text: str) -> bytes:
    """The table with another text in one cell."""
    rows = list(csv.reader(io.StringIO(data.decode("utf-8-sig"), newline="")))
    rows[row][rows[0].index(column)] = text
    saved = io.StringIO(newline="")
    csv.writer(saved).writerows(rows)
    return saved.getvalue().encode()


@settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(text=HOSTILE)
def test_a_table_goes_in_and_comes_out_again(house, text):
    changed = cell(table(read(house).exhibits), 1, "record.material.en", guarded(text))
    done = accept(house, changed)
    assert done.faults == ()
    file = house / "exhibits/box/exhibit.toml"
    kept = tomllib.loads(file.read_text("utf-8"))["record"]["material"]["en"]
    assert lines(kept) == lines(text)
    assert accept(house, table(read(house).exhibits)) == Acceptance({}, (), False)
    assert not list(file.parent.glob(".exhibit.toml.*")), "nothing is left beside it"


def test_a_dry_run_writes_nothing(house):
    before = {path: path.read_bytes() for path in house.rglob("*") if path.is_file()}
    done = accept(house, cell(table(read(house).exhibits), 2, "title.en", "Trunk"), dry_run=True)
    assert [str(change) for change in done.changes["chest"]] == ["title: en “Chest” → “Trunk”"]
    assert not done.written
    assert {path: path.read_bytes() for path in house.rglob("*") if path.is_file()} == before


def test_a_byte_order_mark_and_the_files_rights_stay(house):
    file = house / "exhibits/chest/exhibit.toml"
    file.write_bytes(b"\xef\xbb\xbf" + WRITTEN.encode())
    file.chmod(0o640)
    assert accept(house, cell(table(read(house).exhibits), 2, "title.en", "Trunk")).written
    assert file.read_bytes() == b"\xef\xbb\xbf" + WRITTEN.replace('en = "Chest"', 'en = "Trunk"').encode()
    assert file.stat().st_mode & 0o777 == 0o640


def test_one_fault_keeps_everything_out(house):
    data = cell(table(read(house).exhibits), 1, "title.en", "Trunk")
    data = cell(data, 2, "title.en", "")
    before = {path: path.read_bytes() for path in house.rglob("*.toml")}
    done = accept(house, data)
    assert done.faults == (
        "row 3, column title.en: the cell is empty, while zh is not – write it in both languages, or empty both cells",
    )
    assert {path: path.read_bytes() for path in before} == before


def test_what_the_content_check_refuses_is_not_written(house, monkeypatch):
    """Whatever gets past the table's own rules: a problem that was not there before keeps the change out."""
    from hall_app.content import Problem

    def strict(content):
        return [
            Problem(e.toml, "title", "too long", "shorten it")
            for e in content.exhibits
            if len(e.file.title.en) > 9
        ]

    monkeypatch.setattr("hall_app.web.collection.table.acceptance.QUICK", (strict,))
    before = (house / "exhibits/chest/exhibit.toml").read_bytes()
    done = accept(house, cell(table(read(house).exhibits), 2, "title.en", "A very large trunk"))
    assert done.faults == ("exhibits/chest/exhibit.toml: title: too long – shorten it",)
    assert (house / "exhibits/chest/exhibit.toml").read_bytes() == before


def test_a_file_that_changes_meanwhile_is_not_overwritten(house, monkeypatch):
    file = house / "exhibits/chest/exhibit.toml"
    data = cell(table(read(house).exhibits), 2, "title.en", "Trunk")

    def somebody(folder, files, looks):
        file.write_text(WRITTEN + "# somebody else\n", "utf-8")
        return []

    monkeypatch.setattr("hall_app.web.collection.table.acceptance.new_problems", somebody)
    done = accept(house, data)
    assert "changed meanwhile" in done.faults[0]
    assert file.read_text("utf-8").endswith("# somebody else\n")


AT_HEAD = {
    "no id": ("title.zh\nx\n", "id: there is no such column – add it"),
    "a misspelt column": (
        "id,title.xh\n",
        "title.xh: there is no such key in exhibit.toml – did you mean title.zh?",
    ),
    "an odd column": (
        "id,qq\n",
        "qq: there is no such key in exhibit.toml – delete it: hall collection export",
    ),
    "a column twice": ("id,licence,licence\n", "licence: the column is there twice – delete one of them"),
    "a column without a name": ("id,,licence\n", "number 2: the column has no name – name it, or delete it"),
}
IN_ROWS = {
    "nobody's row": (
        "id,licence\nlamp,x\n",
        "id: there is no such exhibit, or hall check has something to say",
    ),
    "a row of nobody": ("id,licence\n,x\n", "id: the cell is empty – write the name of the exhibit's folder"),
    "no licence": ("id,licence\nchest,\n", "licence: the cell is empty – write the licence, e.g. CC0-1.0"),
    "no title": (
        "id,title.zh,title.en\nchest,,\n",
        "title.zh: the cell is empty – write it in both languages",
    ),
    "half a text": (
        "id,record.maker.zh\nchest,匠\n",
        "record.maker.en: the cell is empty, while zh is not – write it in both languages, or empty both cells",
    ),
    "a line that goes": (
        "id,record.line[1].label.zh,record.line[1].label.en\nchest,,\n",
        "record.line[1].label.zh: a line cannot be removed by the table – remove its [[record.line]] in"
        " exhibits/chest/exhibit.toml",
    ),
    "a line far off": (
        "id,record.line[3].label.zh,record.line[3].label.en,record.line[3].value.zh,record.line[3].value.en\n"
        "chest,a,b,c,d\n",
        "record.line[3].label.zh: a new line needs label and value, and 1 is there before it – fill all of"
        " record.line[2] first",
    ),
    "half a line": (
        "id,record.line[2].label.zh,record.line[2].label.en\nchest,a,b\n",
        "record.line[2].label.zh: a new line needs label and value",
    ),
}
ELSEWHERE = {
    "nothing": ("", "row 1: the file is empty – begin with what hall collection export writes"),
    "a row twice": (
        "id\nchest\nchest\n",
        "row 3, column id: row 2 is of this exhibit already (got 'chest') – delete",
    ),
    "a row too long": (
        "id,licence\nchest,x,y\n",
        "row 2: the row has 3 cells, the head 2 – put texts that hold",
    ),
    "an open quotation": ('id,licence\nchest,"x\n', "row 1: the file is no CSV"),
}
FAULTS = {
    **{name: (text, f"row 1, column {said}") for name, (text, said) in AT_HEAD.items()},
    **{name: (text, f"row 2, column {said}") for name, (text, said) in IN_ROWS.items()},
    **ELSEWHERE,
}


@pytest.mark.parametrize("case", FAULTS)
def test_faults_name_row_column_value_and_remedy(house, case):
    text, said = FAULTS[case]
    done = accept(house, text.encode())
    assert done.faults
    assert done.faults[0].startswith(said)
    assert " – " in done.faults[0]
    assert not done.written


def test_another_encoding_is_said(house):
    done = accept(house, "id,licence\nchest,许可\n".encode("gb18030"))
    assert done.faults == ("row 1: the file is not UTF-8 at byte 17 – save it as CSV UTF-8",)


@settings(max_examples=60, deadline=None)
@given(st.binary(max_size=200))
def test_no_file_breaks_the_reader(data):
    read_sheet(data)
    read_sheet(b"id,title.zh,title.en\n" + data)


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_columns_may_be_few_and_in_any_order(house, separator):
    text = f"licence{separator}id\r\nCC-BY-4.0{separator}chest\r\n\r\n{separator}\r\n"
    done = accept(house, text.encode())
    assert done.faults == ()
    assert list(done.changes) == ["chest"]
    assert 'licence = "CC-BY-4.0"' in (house / "exhibits/chest/exhibit.toml").read_text("utf-8")


# The command


def test_the_command(house, tmp_path, capsys):
    file = tmp_path / "all.csv"
    assert main(["collection", "export", str(file), "--content", str(house)]) == 0
    assert capsys.readouterr().out == f"{file}: 2 exhibits\n"
    assert file.read_bytes().startswith(b"\xef\xbb\xbfid,title.zh")
    file.write_bytes(cell(file.read_bytes(), 1, "record.wear.en", "=never"))
    assert main(["collection", "import", str(file), "--content", str(house), "--dry-run"]) == 0
    said = capsys.readouterr().out
    assert said == "box: record.wear: en “none” → “=never”\n1 text would change in 1 exhibit\n"
    assert main(["collection", "import", str(file), "--content", str(house)]) == 0
    assert capsys.readouterr().out.endswith("1 text changed in 1 exhibit\n")
    assert main(["collection", "import", str(file), "--content", str(house)]) == 0
    assert capsys.readouterr().out == "0 texts changed in 0 exhibits\n"
    file.write_text("id\nlamp\n")
    assert main(["collection", "import", str(file), "--content", str(house)]) == 1
    said = capsys.readouterr().err.splitlines()
    assert said[0].startswith(f"{file}: row 2, column id: there is no such exhibit")
    assert said[-1] == f"{file}: nothing was changed"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["export", "/nowhere/at/all.csv"], "give a file that can be written"),
        (["import", "/nowhere/at/all.csv"], "give a table that hall collection export wrote"),
    ],
)
def test_the_command_names_a_file_it_cannot_use(house, capsys, words, said):
    assert main(["collection", *words, "--content", str(house)]) == 1
    assert said in capsys.readouterr().err
