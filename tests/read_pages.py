"""Pages to read as everybody must be able to: clean to axe, whole on a narrow screen, large enough to touch."""

from typing import Any

from bench.axe import violations

SHOWN = "() => document.querySelectorAll('img').forEach((one) => { one.loading = 'eager'; })"

# Controls of forms that are seen and that Tab passes by, or takes out of their turn.
UNREACHED = """() => {
  const controls = "main form :is(button, input:not([type=hidden]), select, textarea)";
  const seen = [...document.querySelectorAll(controls)].filter((one) => one.checkVisibility());
  return seen.filter((one) => one.disabled || one.tabIndex !== 0 || one.closest("[inert]"))
    .map((one) => one.id || one.textContent);
}"""


def read_whole(page: Any, address: str, width: int, small: str) -> None:
    """Opens an address with all its pictures, follows the first link by key. small: script that lists what is too
    small to touch."""
    page.goto(address)
    page.evaluate(SHOWN)
    page.wait_for_load_state("networkidle")
    found = violations(page)
    assert not found, found
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.evaluate(small) == []
    assert page.evaluate(UNREACHED) == [], "every control of every form by key"
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
