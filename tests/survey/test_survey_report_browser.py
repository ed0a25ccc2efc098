"""The report in Chromium: nothing is cut, on a desk or on a phone, and what must scroll says so."""

from __future__ import annotations

import numpy as np
import pytest
from full_matrix import by_day
from survey_samples import ASSETS

from survey.analysis import Context, Settings, analyse
from survey.questionnaire import read_questionnaire
from survey.report import Part, write_report
from survey.scores import ScoreTable, sample_scores, stated_groups

pytestmark = pytest.mark.browser


def answered(name: str, n: int, seed: int) -> ScoreTable:
    """Scores of a platform survey whose means and intervals have two decimals everywhere."""
    asked = read_questionnaire(ASSETS / "questionnaires" / f"{name}.toml")
    scores = np.clip(np.rint(4 + np.random.default_rng(seed).normal(size=(n, len(asked.items)))), 1, 5)
    return ScoreTable(scores, asked.item_ids, questionnaire=asked, source=name)


@pytest.fixture(scope="module")
def reports(tmp_path_factory):
    """Name → address of the platform's and the garment's report."""
    folder = tmp_path_factory.mktemp("reports")
    user, admin = answered("platform-user", 60, 1), answered("platform-admin", 30, 2)
    garment = sample_scores("primary-200", ASSETS)
    for name, table, beside in (("platform", user, [admin]), ("garment", garment, [])):
        found = analyse(
            table.scores,
            table.items,
            settings=Settings(bootstrap=100),
            context=Context(groups=stated_groups(table.questionnaire)),
        )
        parts = [Part(one, one.questionnaire) for one in beside if one.questionnaire is not None]
        write_report(folder / name, table, found, parts)
    return {name: (folder / name / "report.html").as_uri() for name in ("platform", "garment")}


@pytest.fixture
def page(chromium):
    """Opens an address in a window of some width; a script error fails the test."""
    contexts, faults = [], []

    def opened(address: str, width: int):
        context = chromium.new_context(viewport={"width": width, "height": 900})
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.goto(address)
        return page

    yield opened
    for context in contexts:
        context.close()
    assert not faults


WIDE = """() => [...document.querySelectorAll('.scroll')].filter(one => one.offsetParent)
    .map(one => ({over: one.scrollWidth - one.clientWidth, table: !!one.querySelector('table'),
        hint: getComputedStyle(one.parentNode.querySelector('.hint')).display,
        keys: one.getAttribute('tabindex'), text: one.parentNode.innerText.slice(0, 60)}))"""
PAGE = "() => document.documentElement.scrollWidth - document.documentElement.clientWidth"


@pytest.mark.nightly
@pytest.mark.parametrize("language", by_day(["zh"], ["en", "zh"]))
@pytest.mark.parametrize("width", by_day([1100], [1100, 1280]))
@pytest.mark.parametrize("name", by_day(["garment"], ["platform", "garment"]))
def test_nothing_is_cut_on_a_desk(reports, page, name, width, language):
    shown = page(f"{reports[name]}#{language}", width)
    assert shown.evaluate(PAGE) <= 0
    found = shown.evaluate(WIDE)
    assert len(found) > 8
    assert [one["text"] for one in found if one["over"] > 1] == []
    assert {one["hint"] for one in found} == {"none"}


@pytest.mark.nightly
@pytest.mark.parametrize("language", by_day(["zh"], ["en", "zh"]))
@pytest.mark.parametrize("name", by_day(["garment"], ["platform", "garment"]))
def test_on_a_phone_the_page_stands_still_and_what_scrolls_says_so(reports, page, name, language):
    shown = page(f"{reports[name]}#{language}", 390)
    assert shown.evaluate(PAGE) <= 0
    found = shown.evaluate(WIDE)
    wide = [one for one in found if one["over"] > 1]
    assert wide
    for one in found:
        assert (one["hint"] != "none") == (one["over"] > 1), one
        assert (one["keys"] == "0") == (one["over"] > 1), one


@pytest.mark.nightly
def test_turning_the_language_measures_again(reports, page):
    shown = page(f"{reports['platform']}#en", 390)
    shown.get_by_role("button", name="中文").click()
    for one in shown.evaluate(WIDE):
        assert (one["hint"] != "none") == (one["over"] > 1), one
