"""The catalogue in a browser: clean to axe, and whole on a phone."""

import pytest
from full_matrix import by_day
from read_pages import read_whole

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SMALL = """
() => [...document.querySelectorAll(".doors a, .contents a, .ways a, summary, article a.plate")]
  .map((one) => [one.textContent.trim(), one.getBoundingClientRect()])
  .filter(([, box]) => box.height < 43.9 || box.width < 43.9).map(([text]) => text)
"""


@pytest.mark.nightly
@pytest.mark.parametrize("width", by_day([320], [320, 768, 1280]))
@pytest.mark.parametrize("lang", by_day(["zh"], ["zh", "en"]))
def test_the_catalogue_is_clean_and_fits(shipped_hall, chromium, lang, width):
    page = chromium.new_page(viewport={"width": width, "height": 700})
    read_whole(page, f"{shipped_hall.url}/catalogue?lang={lang}", width, SMALL)
    assert page.evaluate("location.hash") == "#exhibits"
    page.close()


@pytest.mark.nightly
def test_a_picture_leads_to_the_large_one_and_print_leaves_the_doors_out(shipped_hall, chromium):
    page = chromium.new_page(viewport={"width": 800, "height": 600})
    page.goto(f"{shipped_hall.url}/catalogue?lang=en")
    plate = page.locator("article a.plate").first
    assert plate.get_attribute("href").startswith("/media/")
    page.emulate_media(media="print")
    assert not page.locator(".doors").is_visible()
    assert page.locator("article h2").first.is_visible()
    page.close()
