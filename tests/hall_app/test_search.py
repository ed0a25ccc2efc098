"""Search: Chinese by pairs, Latin by beginnings, both languages at once; no question is an error."""

from __future__ import annotations

import json
import urllib.parse
import urllib.request
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hall_app.content import load
from hall_app.content.search import MOST, Entry, Query, SearchIndex, entries_of, excerpt, indexed, marked

ASSETS = Path(__file__).parents[2] / "assets"
CONTENT = load(ASSETS)
INDEX = SearchIndex(entries_of(CONTENT))


def found(asked: str, lang: str = "zh") -> list[tuple[str, str]]:
    return [(one.shown.kind, one.shown.id) for one in INDEX.find(Query.of(asked), lang).best]


def test_a_run_of_chinese_is_all_its_pairs_and_its_last_character():
    assert indexed("素纱襌衣, Gauze") == "素纱 纱襌 襌衣 衣 gauze"
    assert indexed("Kèsī") == "kesi"


@pytest.mark.parametrize(
    ("asked", "wanted"),
    [
        ("褙子", ("exhibit", "beizi")),
        ("三件褙子", ("exhibit", "beizi")),
        ("beizi", ("article", "beizi")),
        ("bèizi", ("word", "beizi")),
        ("mamianqun", ("word", "mamian")),
        ("马面裙", ("article", "pleats")),
        ("缂", ("word", "kesi")),
        ("gowns", ("exhibit", "gown")),
        ("pleat", ("article", "pleats")),
        ("PLEATS", ("article", "pleats")),
        ("四经绞罗", ("weave", "luo")),
        ("披帛 摩擦", ("article", "pibo")),
    ],
)
@pytest.mark.parametrize("lang", ["zh", "en"])
def test_what_is_asked_for_is_found_in_either_language(asked: str, wanted: tuple[str, str], lang: str):
    assert wanted in found(asked, lang)[:12]


def test_a_thing_is_told_once_and_as_the_page_speaks():
    both = INDEX.find(Query.of("披帛"), "en").best
    assert len({(one.shown.kind, one.shown.id) for one in both}) == len(both)
    assert all(one.shown.lang == "en" for one in both)
    assert {one.entry.lang for one in both} >= {"zh"}, "found in the other language's text"


def test_all_that_was_found_is_counted_and_the_best_are_listed():
    many = SearchIndex(Entry("word", f"w{n}", "zh", f"裙{n}", "", "裙的一种", "/w") for n in range(80))
    asked = Query.of("裙")
    found = many.find(asked, "zh")
    assert (found.number, len(found.best)) == (80, MOST)
    few = INDEX.find(Query.of("褙子"), "zh")
    assert few.number == len(few.best)


def test_pairs_must_follow_each_other():
    apart = SearchIndex([Entry("article", "a", "zh", "子褙", "", "褙，子", "/a")])
    assert not apart.find(Query.of("褙子"), "zh").best


def test_all_words_first_and_any_of_them_where_nothing_holds_all():
    assert found("gauze zzzzzz", "en") == found("gauze", "en")
    assert found("zzzzzz") == []
    assert found("") == []


HOSTILE = [
    '"',
    "'",
    "*",
    '" OR 1=1 --',
    "NEAR(a b)",
    "title:x",
    "a AND",
    "(((",
    "^a",
    "{}",
    "\x00",
    "a\x00b",
    "'; DROP TABLE entry",
    "%",
    "纱*",
    "-a",
    "褙" * 10_000,
    '"' * 10_000,
    "a " * 5_000,
]


@pytest.mark.parametrize("asked", HOSTILE, ids=range(len(HOSTILE)))
def test_no_question_is_an_error(asked: str):
    INDEX.find(Query.of(asked), "zh")


@settings(max_examples=150, deadline=None)
@given(st.text(max_size=300))
def test_any_text_may_be_asked_and_marking_keeps_every_letter(asked: str):
    query = Query.of(asked)
    INDEX.find(query, "en")
    assert marked(asked, query).text == asked
    assert excerpt(asked, query).text.strip("… ") in asked.replace("…", " … ") or asked.count("…")


def test_an_excerpt_shows_what_was_found():
    text = "前面的话。" * 60 + "这里有一件褙子，敞着。" + "后面的话。" * 60
    shown = excerpt(text, Query.of("褙子"))
    assert ("褙子", True) in shown.pieces
    assert len(shown.text) < 250
    assert [words for words, hit in marked("The Gowns of Kèsī", Query.of("gown kesi")).pieces if hit] == [
        "Gowns",
        "Kèsī",
    ]


def asked_of(hall, path: str, **query: str) -> tuple[int, str]:
    url = f"{hall.url}{path}?{urllib.parse.urlencode(query)}"
    with urllib.request.urlopen(url, timeout=60) as answer:
        return answer.status, answer.read().decode()


@pytest.mark.parametrize("lang", ["zh", "en"])
def test_page_and_api_tell_the_same_escaped(plain_hall, lang: str):
    status, page = asked_of(plain_hall, "/search", q="box", lang=lang)
    told = json.loads(asked_of(plain_hall, "/api/search", q="box", lang=lang)[1])
    assert status == 200
    assert [one["id"] for one in told["found"]] == ["box"]
    assert told["number"] == 1
    assert "#exhibit-box" in page
    status, page = asked_of(plain_hall, "/search", q='<script>alert("x")</script>', lang=lang)
    assert status == 200
    assert "<script>alert" not in page
    assert "&lt;script&gt;" in page


@pytest.mark.parametrize("asked", ["", "zzzz", '"', "NEAR(", "a" * 10_000, "褙" * 3_000, "\x00\x1b"])
def test_hostile_questions_are_answered(plain_hall, asked: str):
    for path in ("/search", "/api/search"):
        assert asked_of(plain_hall, path, q=asked)[0] == 200
