"""What is wrong, told in Chinese: every text of the sources has one, and a curator's Chinese page shows them."""

from __future__ import annotations

import ast
import inspect
import io
import json
import re
import shutil
import tomllib._parser
import uuid
import wave
from collections.abc import Iterator
from functools import cache
from html import unescape
from typing import Any, get_args

import pytest
from content_house import EXHIBIT, add_exhibit
from office_clerk import Clerk, clerk
from problem_texts import PASSED_ON, Said, said
from pydantic import ValidationError
from pydantic_core import PydanticKnownError

from hall_app.content import schema
from hall_app.content.problems import Problem, Problems, catalogue, in_language
from hall_app.house.people import PeopleError, Role

SOURCES = (
    "hall_app",
    "sim_core/gltf.py",
    "sim_core/mesh/scan",
    "survey/analysis/checks.py",
    "survey/analysis/components",
    "survey/analysis/consistency",
    "survey/analysis/screening/preparation.py",
    "survey/questionnaire",
    "survey/web/mounting.py",
    "survey/web/privacy",
)
ELSEWHERE = {"around", "composed", "pydantic", "system", "toml"}  # not, or not all, said by our sources
FILLED = re.compile(r"\{(\d)(?::zh)?\}")
HAN = re.compile(r"[\u4e00-\u9fff]")

# What pydantic says of a value, by the kind of its schema; what one of these tables may hold besides, says nothing.
KINDS: dict[str, tuple[tuple[Any, dict[str, Any]], ...]] = {
    "str": (
        ("string_type", {}),
        ("string_pattern_mismatch", {"pattern": "^[a-z]+$"}),
        ("string_too_short", {"min_length": 1}),
        ("string_too_short", {"min_length": 2}),
        ("string_too_long", {"max_length": 1}),
        ("string_too_long", {"max_length": 40}),
    ),
    "float": (
        ("float_type", {}),
        ("float_parsing", {}),
        ("finite_number", {}),
        ("greater_than", {"gt": 0.0}),
        ("greater_than_equal", {"ge": 0.0}),
        ("less_than", {"lt": 3.0}),
        ("less_than_equal", {"le": 3.0}),
    ),
    "int": (("int_type", {}), ("int_parsing", {}), ("int_from_float", {}), ("int_parsing_size", {})),
    "tuple": (
        ("tuple_type", {}),
        *(("too_short", {"field_type": "Tuple", "min_length": n, "actual_length": 0}) for n in (1, 3)),
        *(("too_long", {"field_type": "Tuple", "max_length": n, "actual_length": 9}) for n in (1, 3)),
    ),
    "literal": (
        ("literal_error", {"expected": "'round'"}),
        ("literal_error", {"expected": "'a', 'b' or 'c'"}),
    ),
    "date": (
        ("date_type", {}),
        ("date_from_datetime_inexact", {}),
        ("date_from_datetime_parsing", {"error": "input is too short"}),
        ("date_parsing", {"error": "input is too short"}),
    ),
    "model": (("model_type", {"class_name": "Place"}),),
}
SILENT = {
    "default", "definition-ref", "definitions", "function-after", "model-field", "model-fields", "no-info", "nullable",
}  # fmt: skip
TABLES = (
    schema.ArticleFile,
    schema.ExhibitFile,
    schema.GlossaryFile,
    schema.HallFile,
    schema.NumbersFile,
    schema.PapersFile,
    schema.PlanFile,
)


def words() -> set[str]:
    """Kinds of things, which stand inside texts."""
    tables = (schema.Media, schema.Opening, schema.Sign, schema.Solid, schema.Wall)
    kinds = {one for table in tables for one in get_args(table.model_fields["kind"].annotation)}
    backdrops = set(get_args(schema.Solid.model_fields["backdrop"].annotation)) - {"none"}
    return kinds | backdrops | {"exhibit", "weave", "article", "word"}


def known() -> dict[str, str]:
    return {english: chinese for table in catalogue().values() for english, chinese in table.items()}


@cache
def all_said() -> tuple[Said, ...]:
    return tuple(said(SOURCES))


@pytest.mark.door
def test_every_text_of_the_sources_has_its_chinese():
    there = known()
    missing = {(one.text, f"{one.file}:{one.line}") for one in all_said() if one.text not in (None, *there)}
    assert sorted(missing) == [], "write them into hall_app/content/problems/zh.toml"
    assert words() <= set(known())


@pytest.mark.door
def test_no_text_comes_from_where_nobody_looks():
    """Who hands on what others say is written down, so that a new one is thought about."""
    assert {(one.file, one.function) for one in all_said() if one.text is None} == PASSED_ON


@pytest.mark.door
def test_nothing_is_translated_that_nobody_says():
    told = {one.text for one in all_said()} | words()
    unsaid = [
        english
        for name, table in catalogue().items()
        for english in table
        if name not in ELSEWHERE and english not in told
    ]
    assert unsaid == []


def test_every_chinese_text_is_one_and_keeps_what_is_filled_in():
    texts = [english for table in catalogue().values() for english in table]
    assert len(texts) == len(set(texts)), "a text stands in two tables"
    for name, table in catalogue().items():
        for english, chinese in table.items():
            gaps, filled = set(range(english.count("{}"))), {int(one) for one in FILLED.findall(chinese)}
            assert filled <= gaps if name == "pydantic" else filled == gaps, english
            assert HAN.search(chinese) or ":zh}" in chinese, english


def test_no_text_hides_another():
    for english, chinese in known().items():
        parts = english.split("{}")
        text = parts[0] + "".join(f"<{number}>{part}" for number, part in enumerate(parts[1:]))
        assert in_language(text, "zh") == FILLED.sub(r"<\1>", chinese)
        assert in_language(text, "en") == text


@pytest.mark.parametrize(
    "why",
    [
        "x.zip: exists already – give another name, a backup never overwrites one",
        "x.zip: no whole backup (people.sqlite is not what was written) – take another copy of it",
        "x.zip: no whole backup (File is not a zip file) – take another copy of it",
        "a/b: a link to a folder – put the folder itself in its place",
        "a/b: no plain file, or a link to none – take it out of the content",
        "x.zip: the backup failed (No space left on device) – see that the place is there and free",
        "hall serve did not say where the house's databases are",
        "a/b: no accounts there – give --data (or --accounts) as `hall serve` has it",
        "a/b: an office has worked there already – give --data another folder",
        "Permission denied",
    ],
)
def test_why_a_backup_failed_is_told_in_chinese(why):
    told = PeopleError("backup-failed", why=why).text("zh")
    names = r"people\.sqlite|x\.zip|ZIP|hall (serve|backup)|--\w+"
    assert not re.search("[A-Za-z]{3,}", re.sub(names, "", told)), told
    assert PeopleError("backup-failed", why=why).text("en").endswith(why)


def schema_kinds(part: object) -> Iterator[str]:
    if isinstance(part, dict):
        if isinstance(part.get("type"), str):
            yield part["type"]
        yield from (kind for value in part.values() for kind in schema_kinds(value))
    elif isinstance(part, list | tuple):
        yield from (kind for value in part for kind in schema_kinds(value))


def test_what_pydantic_says_has_its_chinese():
    kinds = {kind for table in TABLES for kind in schema_kinds(table.__pydantic_core_schema__)} - SILENT
    assert kinds <= set(KINDS)
    for kind in kinds:
        for error, context in KINDS[kind]:
            message = PydanticKnownError(error, context or None).message()
            for got in ("", " (got 'x')"):
                chinese = in_language(message[:1].lower() + message[1:] + got, "zh")
                rest = re.sub(r"'[^']*'|\^\S+|YYYY-MM-DD|（所写为 .*|\btrue\b|\bfalse\b", "", chinese)
                assert not re.search("[A-Za-z]", rest), chinese


@pytest.mark.parametrize("text", ["[]", "{", '{"section": 3}', '{"section": [3]}'])
def test_what_pydantic_says_of_json_has_its_chinese(text):
    with pytest.raises(ValidationError) as refused:
        schema.NumbersFile.model_validate_json(text)
    for problem in schema.schema_problems("research/numbers.json", schema.NumbersFile, refused.value):
        assert not re.search("[A-Za-z]{3}", in_language(problem.what, "zh").replace("JSON", "")), problem


def test_what_is_wrong_with_a_toml_has_its_chinese():
    """All that the library says, as its source has it."""
    for node in ast.walk(ast.parse(inspect.getsource(tomllib._parser))):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "suffixed_err":
            text = node.args[-1]
            parts = text.values if isinstance(text, ast.JoinedStr) else [text]
            message = "".join(str(one.value) if isinstance(one, ast.Constant) else "{}" for one in parts)
            assert message in known(), message


def test_texts_inside_texts_are_put_into_chinese_and_names_stay():
    def told(what: str, fix: str = "check the file") -> str:
        return Problem("exhibits/a/exhibit.toml", "media[1].file", what, fix).text("zh")

    assert told("media/a.jpg: it is no picture, or broken") == (
        "exhibits/a/exhibit.toml：media[1].file：media/a.jpg：不是图片，或已损坏 —— 检查该文件"
    )
    texture = "one of its textures cannot be read: it is no picture, or broken"
    assert "：a.glb 无法绘出：有一张贴图无法读取：不是图片，或已损坏 ——" in told(
        f"a.glb cannot be drawn: {texture}"
    )
    assert "位于展位 'booth' 之内" in told("stands inside booth 'booth'")
    fix = 'move it with place.x, place.z, or write place.on = "booth" if it stands on top'
    assert '写 place.on = "booth"' in told("stands inside booth 'booth'", fix)
    assert "应为 'round' 或 'box'（所写为 'cone'）" in told("input should be 'round' or 'box' (got 'cone')")
    assert "无法读取（没有权限）" in told("cannot be read (Permission denied)")
    failed = "exhibits/a/exhibit.toml: scan: a.ply: it is no PLY file – export the scan as PLY, or correct its ending"
    assert "烘焙失败" in told(f"baking failed: {failed}")
    assert "不是 PLY 文件 —— 把扫描导出为 PLY，或改正扩展名" in told(f"baking failed: {failed}")
    assert (
        told("of another engine", "ask it")
        == "exhibits/a/exhibit.toml：media[1].file：of another engine —— ask it"
    )


def test_a_text_of_any_length_is_told():
    """Whatever somebody wrote into a file may stand in a text."""
    for odd in ("a: " * 50_000, "' or '" * 50_000, " MB, at most " * 20_000, "{0:zh}{9}" * 1000):
        assert in_language(f"unknown {odd}", "zh")
        assert odd in in_language(f"there is no questionnaire {odd}", "zh")


def test_a_refusal_is_told_in_either_language():
    one = Problem("plan.toml", "", "has not been baked", "run hall build")
    error = PeopleError("content-check", problems=Problems((one, one, one), 2))
    assert str(error) == f"The hall's check says: {one}; {one} (+1)"
    assert error.text("zh") == (
        "展厅检查指出：plan.toml：尚未烘焙 —— 运行 hall build；plan.toml：尚未烘焙 —— 运行 hall build (+1)"
    )


@pytest.fixture
def curator(counter) -> Clerk:
    return clerk(counter, counter.people, Role.CURATOR)


@pytest.fixture
def chest(counter) -> Iterator[str]:
    key = f"z{uuid.uuid4().hex[:10]}"
    home = add_exhibit(counter.content, key, EXHIBIT.replace("z = -1.0", "z = 2.0"))
    yield key
    shutil.rmtree(home, ignore_errors=True)


def faults(page: str) -> list[str]:
    """The lines under the check's heading."""
    found = re.search(r'<div class="faults">.*?</div>', page, re.DOTALL)
    return [unescape(one) for one in re.findall(r"<li>(.*?)</li>", found[0] if found else "", re.DOTALL)]


def foreign(line: str) -> list[str]:
    """Words in it that are no paths, keys, values in quotes or code."""
    plain = re.sub(r"'[^']*'|\"[^\"]*\"|[\w\[\].-]+ =|[\w-]*[./_][\w./\[\]_-]*", " ", line)
    return re.findall(r"[A-Za-z]{2,}", plain)


def test_a_draft_that_fails_the_check_is_told_in_chinese(curator, chest):
    wrong = {
        "body.radius": "-1",
        "place.x": "90",
        "models.hall": "media/nothing.glb",
        "questionnaire": "nobody",
    }
    curator.told(f"collection/{chest}/fields", wrong)
    at = f"/office/collection/{chest}"
    chinese, english = (faults(curator.get(f"{at}?lang={lang}").text) for lang in ("zh", "en"))
    assert len(chinese) == len(english) > 0
    assert [line for line in chinese if foreign(line) or not HAN.search(line)] == []
    told = curator.told(f"collection/{chest}")["problems"]
    assert english == [str(Problem(**one)) for one in told], (
        "the API and the English page say what they always did"
    )
    assert [line for line in english if HAN.search(line)] == []
    refused = curator.send(f"{at}?lang=zh", "form-publish")
    said_why = unescape(re.findall(r'<p class="refused"[^>]*>(.*?)</p>', refused.text, re.DOTALL)[0])
    assert said_why == f"展厅检查指出：{'；'.join(chinese)}"
    assert "body.radius：应大于 0（所写为 -1" in said_why
    answer = curator.api(f"collection/{chest}/publish", {})
    assert f"The hall's check says: {english[0]}" in answer.text.replace('\\"', '"')


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"body.radius": "wide"}, "文件不能这样保存：body.radius：'wide' 不是数 —— 写成 1.5 这样"),
        ({"title.en": ""}, "文件不能这样保存：title：中英文须都填写，或都不填"),
    ],
)
def test_a_form_that_cannot_be_saved_is_told_in_chinese(curator, chest, given, told):
    answer = curator.api(f"collection/{chest}/fields?lang=zh", given)
    assert answer.status == 400
    assert told in answer.text


def test_a_recording_that_is_cut_off_is_told_in_chinese(curator, chest):
    data = io.BytesIO()
    with wave.open(data, "wb") as sound:
        sound.setparams((1, 2, 8000, 0, "NONE", ""))
        sound.writeframes(bytes(32_000))
    refused = curator.bring(chest, [("bell.wav", data.getvalue()[:9_000])], use="sound")
    assert refused.status == 400
    english = json.loads(refused.body)["text"]
    why = re.findall(r"\((.*)\)", english)[0]
    assert not re.search("[A-Za-z]{3}", in_language(why, "zh")), why
    for why in ("it holds no picture", "it says 12 s and ends before", "sound: 3 of 9 cannot be decoded"):
        told = PeopleError("file-broken", name="bell.wav", why=why).text("zh")
        assert foreign(told) == [], told


def test_a_file_that_is_no_toml_is_told_in_chinese(curator, chest):
    at = f"/office/collection/{chest}/text?file=exhibit.toml&lang=zh"
    refused = curator.send(at, "form-text", text="title = ")
    assert "文件不能这样保存：exhibit.toml：值无效（" in refused.text
