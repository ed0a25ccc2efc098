"""Pages to read as everybody must be able to: clean to axe, whole on a narrow screen, large enough to touch."""

from typing import Any

from bench.axe import violations

SHOWN = "() => document.querySelectorAll('img').forEach((one) => { one.loading = 'eager'; })"


def read_whole(page: Any, address: str, width: int, small: str) -> None:
    """Opens an address with all its pictures, follows the first link by key. small: script that lists what is too
    small to touch."""
    page.goto(address)
    see_whole(page, width, small)
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")


def see_whole(page: Any, width: int, small: str) -> None:
    """The page as it is open, however one came to it."""
    page.evaluate(SHOWN)
    page.wait_for_load_state("networkidle")
    found = violations(page)
    assert not found, (page.url, found)
    assert page.evaluate("document.documentElement.scrollWidth") <= width, page.url
    assert page.evaluate(small) == [], page.url
