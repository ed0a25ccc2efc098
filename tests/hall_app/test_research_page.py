"""The research page: all that the READMEs publish, with day, machine, data and plot; papers; the survey's results."""

from __future__ import annotations

import json
import re
import sys
import tomllib
import urllib.request
from html import escape
from importlib import import_module
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hall_app.content.schema import Paper
from hall_app.web.reading import bibliography

ROOT = Path(__file__).parents[2]
words = st.text(max_size=20).map("x{}".format)


def got(address: str) -> bytes:
    with urllib.request.urlopen(address, timeout=60) as answer:
        return answer.read()


@pytest.fixture
def page_of_numbers(monkeypatch):
    """The program that writes the numbers; it imports its neighbours by their bare names."""
    bench = ROOT / "tests" / "bench"
    monkeypatch.syspath_prepend(str(bench))
    before = set(sys.modules)
    yield import_module("research_page")
    for name in set(sys.modules) - before:
        file = getattr(sys.modules[name], "__file__", None)
        if file is not None and Path(file).parent == bench:
            del sys.modules[name]


def kept_numbers() -> list[dict]:
    return json.loads((ROOT / "assets/research/numbers.json").read_text("utf-8"))["section"]


def test_the_numbers_are_those_measured_last(page_of_numbers):
    """A bench whose figures were not carried over fails here: python tests/bench/research_page.py."""
    kept = kept_numbers()
    assert kept == page_of_numbers.numbers()
    for one, section in zip(kept, page_of_numbers.SECTIONS, strict=True):
        written = page_of_numbers.data(section)
        assert list(written) == one["data"]
        for path, text in written.items():
            assert (ROOT / "assets/research" / path).read_bytes() == text


def test_figures_that_change_are_dated_anew_and_others_keep_their_day(page_of_numbers, monkeypatch):
    section = next(one for one in page_of_numbers.SECTIONS if one.id == "walking")
    found = [json.loads((ROOT / "docs/figures/walking.json").read_text("utf-8"))]
    kept = {"walking": {"date": "2001-02-03"}}
    assert page_of_numbers.date_of(section, found, kept) == {"dated": "published", "date": "2001-02-03"}
    monkeypatch.setattr(page_of_numbers, "data", lambda one: {"data/walking.json": b"{}"})
    assert page_of_numbers.date_of(section, found, kept)["date"] > "2001-02-03"


def test_what_benches_sign_is_the_day_and_the_machine_of_each_part(page_of_numbers):
    signature = sys.modules["signature"]
    found = signature.signed({"growth": [1], "panels": [2]}, ["panels"])
    assert signature.days(found) == []  # one part does not tell its day
    found["measured"]["panels"] = "2026-12-01"
    found = signature.signed(found, ["growth"])
    today = found["measured"]["growth"]
    assert signature.days(found) == sorted({"2026-12-01", today})
    assert signature.machines(found) == [signature.machine()]
    assert signature.parts(found) == {"growth": [1], "panels": [2]}
    section = next(one for one in page_of_numbers.SECTIONS if one.id == "mesh")
    told = page_of_numbers.date_of(section, [found, signature.signed({"bad": 0})], {})
    assert told["dated"] == "measured"
    assert {told["date"], told.get("since", told["date"])} == {"2026-12-01", today}
    assert f"{signature.machine()['cores']} cores" in page_of_numbers.machine_of(section, [found])["en"]


def rows_of_readmes() -> list[tuple[str, tuple[str, ...]]]:
    """Every row of every table that a program writes into a README."""
    found = []
    for readme in (ROOT / "README.md", *ROOT.glob("*/**/README.md"), *ROOT.glob("*/**/DETAILS.md")):
        marked = re.findall(r"<!-- (?!end of).*?-->\n(.*?)<!-- end of", readme.read_text("utf-8"), re.DOTALL)
        for line in "\n".join(marked).splitlines():
            if line.startswith("|") and not re.fullmatch(r"[|\s:-]+", line):
                cells = line.strip()[1:-1].split("|")
                row = tuple(re.sub(r"\*\*|`", "", cell.strip()) for cell in cells)
                found.append((readme.relative_to(ROOT).as_posix(), row))
    return found


def test_every_row_that_a_readme_publishes_is_among_the_numbers():
    numbers, held = kept_numbers(), set()
    for one in numbers:
        held |= {(line["what"], line["value"], line["command"]) for line in one["line"]}
        tables = [part for sheet in one["sheet"] for part in sheet["part"] if "row" in part]
        held |= {tuple(row) for table in tables for row in (table["head"], *table["row"])}
    published = rows_of_readmes()
    files = {file for file, _ in published}
    rooms = ("weave", "mesh", "cloth", "learn")
    assert files >= {"README.md", "survey/README.md", *(f"sim_core/{room}/README.md" for room in rooms)}
    head = ("What", "Measured", "Command")
    assert [row for row in published if row[1] not in held and row[1] != head] == []
    for one in numbers:
        assert one["command"]
        assert one["machine"]["zh"]
        assert one["data"]
        assert one["plot"]


@pytest.mark.parametrize(("lang", "named"), [("zh", "发布日期"), ("en", "Published on")])
def test_the_research_page_holds_every_number_and_says_what_its_dates_are_of(shipped_hall, lang, named):
    page = got(f"{shipped_hall.url}/research?lang={lang}").decode()
    for one in kept_numbers():
        assert f'datetime="{one["date"]}"' in page
        for sheet in one["sheet"]:
            assert f"<h3>{sheet['file']}</h3>" in page
            for part in sheet["part"]:
                for row in part.get("row", ()):
                    assert "".join(f"<td>{escape(cell)}</td>" for cell in row) in page
        for path in one["data"]:
            assert got(f"{shipped_hall.url}/research/{path}")
    assert named in page


def test_papers_are_cited_for_reference_managers(shipped_hall):
    text = got(f"{shipped_hall.url}/research/papers.bib").decode()
    papers = tomllib.loads((ROOT / "assets/research/papers.toml").read_text("utf-8"))["paper"]
    cited = [paper["cite"] for paper in papers if "cite" in paper]
    assert len(cited) == text.count("@article{") > 0
    for cite in cited:
        assert f"  doi = {{{cite['doi']}}},\n" in text
        assert f"  author = {{{' and '.join(cite['author'])}}},\n" in text
    assert 'href="/research/papers.bib"' in got(f"{shipped_hall.url}/research?lang=en").decode()


@settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(st.tuples(words, words, st.integers(1600, 2200)), max_size=4))
def test_no_text_breaks_the_bibliography(told):
    """Braces are balanced, names differ, and an entry has its lines and no more."""
    both = {"zh": "文", "en": "text"}
    papers = [
        Paper.model_validate(
            {"title": both, "where": both, "about": both}
            | {"cite": {"author": [name], "title": title, "journal": title, "year": year}}
        )
        for name, title, year in told
    ]
    text = bibliography(papers)
    assert text.count("{") == text.count("}")
    names = re.findall(r"^@article\{([a-z]+\d{4}(?:-\d+)?),$", text, re.MULTILINE)
    assert len(names) == len(set(names)) == len(told)
    assert len(text.splitlines()) == 6 * len(told) + max(len(told) - 1, 0)


def test_the_research_page_tells_what_the_survey_publishes(shipped_hall):
    page = got(f"{shipped_hall.url}/research?lang=en").decode()
    for entry in json.loads(got(f"{shipped_hall.url}/api/v1/questionnaires")):
        told = json.loads(got(f"{shipped_hall.url}/api/v1/questionnaires/{entry['id']}"))
        asked = any(module["items"] for module in told["modules"])
        assert (f"/api/v1/questionnaires/{entry['id']}/results" in page) == asked
    assert "There are fewer than ten answers" in page
