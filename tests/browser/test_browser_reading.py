"""The pages to read in a browser: clean to axe, whole on a phone, words explained by mouse, key and touch."""

import urllib.parse
from pathlib import Path

import pytest
from bench.axe import violations
from full_matrix import by_day
from read_pages import read_whole, see_whole

ROOT = Path(__file__).parents[2]
pytestmark = [pytest.mark.browser, pytest.mark.slow]

ARTICLES = tuple(sorted(f"/culture/{one.name}" for one in (ROOT / "assets" / "articles").iterdir()))
QUESTIONNAIRES = tuple(
    sorted(f"/questionnaires/{one.stem}" for one in (ROOT / "assets" / "questionnaires").glob("*.toml"))
)
PAGES = (
    "/culture",
    *ARTICLES,
    "/culture/glossary",
    "/culture/weaves",
    "/research",
    "/search?q=褙子",
    "/search?q=nothing-of-the-kind",
    "/culture/not-there",
    "/not-there",
)
# What the survey shows has a frame of its own, without the way past the navigation, of which it has none.
ASKING = ("/questionnaires", *QUESTIONNAIRES, "/questionnaires/not-there", "/privacy")
# Targets that stand by themselves; links within sentences are as high as their line (WCAG 2.5.8).
SMALL = """
() => [...document.querySelectorAll(".site a, .site input, .site button, footer a, .cards a, .beside a, summary")]
  .map((one) => [one.textContent.trim() || one.id, one.getBoundingClientRect()])
  .filter(([, box]) => box.height && (box.height < 43.9 || box.width < 43.9)).map(([text]) => text)
"""


def address(hall, path: str, lang: str) -> str:
    mark = "&" if "?" in path else "?"
    return hall.url + urllib.parse.quote(path, safe="/?=") + f"{mark}lang={lang}"


@pytest.mark.parametrize("width", by_day([390], [320, 390, 1280]))
@pytest.mark.parametrize("lang", by_day(["zh"], ["zh", "en"]))
@pytest.mark.parametrize("path", PAGES)
def test_a_page_is_clean_and_fits(shipped_hall, chromium, path, lang, width):
    page = chromium.new_page(viewport={"width": width, "height": 800})
    read_whole(page, address(shipped_hall, path, lang), width, SMALL)
    assert page.evaluate("document.activeElement.id") == "main"
    page.close()


@pytest.mark.parametrize("width", by_day([390], [320, 390, 1280]))
@pytest.mark.parametrize("lang", by_day(["zh"], ["zh", "en"]))
@pytest.mark.parametrize("path", ASKING)
def test_what_is_asked_is_clean_and_fits(shipped_hall, chromium, path, lang, width):
    page = chromium.new_page(viewport={"width": width, "height": 800})
    page.goto(address(shipped_hall, path, lang))
    see_whole(page, width, SMALL)
    page.close()


def test_a_word_is_explained_by_mouse_and_key(shipped_hall, chromium):
    page = chromium.new_page(viewport={"width": 1000, "height": 800})
    page.goto(address(shipped_hall, "/culture/gauze-gown", "en"))
    tip, word = page.locator("#tip"), page.locator("a.word").first
    assert tip.is_hidden()
    word.hover()
    tip.wait_for()
    assert "single layer" in tip.inner_text()
    tip.hover()
    page.wait_for_timeout(400)
    assert tip.is_visible(), "one may move onto it"
    page.keyboard.press("Escape")
    assert tip.is_hidden()
    page.mouse.move(5, 5)
    word.focus()
    tip.wait_for()
    assert violations(page) == []
    box = tip.bounding_box()
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= 1000
    page.keyboard.press("Enter")
    page.wait_for_url("**/culture/glossary?lang=en#word-danyi")
    page.close()


def test_the_first_touch_explains_and_the_second_leads_on(shipped_hall, chromium):
    context = chromium.new_context(viewport={"width": 390, "height": 800}, has_touch=True, is_mobile=True)
    page = context.new_page()
    page.goto(address(shipped_hall, "/culture/gauze-gown", "zh"))
    word = page.locator("a.word").first
    word.tap()
    page.locator("#tip").wait_for()
    assert "/culture/gauze-gown" in page.url
    word.tap()
    page.wait_for_url("**/culture/glossary?lang=zh#word-sha")
    context.close()


def test_without_scripts_words_are_links_and_their_meaning_is_below(shipped_hall, chromium):
    context = chromium.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(address(shipped_hall, "/culture/gauze-gown", "en"))
    assert page.locator("#said-sha").is_visible()
    page.locator("a.word").first.click()
    assert page.url.endswith("/culture/glossary?lang=en#word-danyi")
    context.close()


def test_the_head_s_form_finds(shipped_hall, chromium):
    page = chromium.new_page()
    page.goto(address(shipped_hall, "/culture", "zh"))
    page.fill("#site-q", "褙子")
    page.keyboard.press("Enter")
    page.locator(".found").wait_for()
    assert page.locator("mark").first.inner_text() == "褙子"
    page.locator(".found a").first.click()
    page.wait_for_url("**/culture/**")
    page.close()
