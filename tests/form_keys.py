"""Every form of a page filled in and sent by keyboard alone, and nothing of it reaching the hall."""

from __future__ import annotations

import re
import time
from contextlib import suppress
from dataclasses import dataclass
from typing import Any
from urllib.parse import parse_qs, urlsplit

from bench.browser import soon

__all__ = ["Sent", "send_all_forms"]

# Opens all that is folded, then numbers what the Tab key has to reach, in the order of the document. Of buttons of
# one name to choose one from the key reaches the chosen one or the first; arrows lead on from there.
CONTROLS = """() => {
  document.querySelectorAll("details").forEach((one) => { one.open = true; });
  const all = "form :is(button, input:not([type=hidden]), select, textarea)";
  const groups = new Set();
  const forms = [...document.forms];
  const found = [...document.querySelectorAll(all)].filter((one) => {
    if (!one.checkVisibility({visibilityProperty: true})) return false;
    if (one.type !== "radio") return true;
    const mine = [...one.form.querySelectorAll("input[type=radio]")].filter((other) => other.name === one.name);
    const reached = mine.find((other) => other.checked) ?? mine[0];
    return one === reached;
  });
  return found.map((one, n) => {
    one.dataset.nth = n;
    return {
      n, form: forms.indexOf(one.form), name: one.name, id: one.id, kind: one.type, value: one.value,
      needed: one.required || one.type === "radio" || (one.type === "checkbox" && !one.checked),
      told: one.textContent.trim().slice(0, 30),
    };
  });
}"""
# Where the focus is, and whether it is seen: on the thing itself, or on what stands for it.
FOCUS = """() => {
  const one = document.activeElement;
  if (!one || one === document.body) return {n: -1};
  const shown = [one, one.nextElementSibling, one.parentElement].filter(Boolean).some((part) => {
    const style = getComputedStyle(part);
    return style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 2;
  });
  const box = one.getBoundingClientRect();
  const within = box.bottom > 0 && box.top < innerHeight && box.right > 0 && box.left < innerWidth;
  const n = one.closest("form") && one.dataset.nth !== undefined ? Number(one.dataset.nth) : -1;
  return {n, shown, within};
}"""
FORMS = """() => [...document.forms].map((one) => ({
  to: new URL(one.action, location.href).pathname, how: one.method.toUpperCase(),
  hidden: [...one.querySelectorAll("input[type=hidden]")].map((field) => field.name),
}))"""
TYPED = {
    "text": "a",
    "search": "a",
    "email": "a@example.org",
    "password": "a robe of blue ramie",
    "number": "1",
    "textarea": "a",
}
MOST_KEYS = 900  # on one page
SCROLLED = 10.0  # [s] a page that scrolls smoothly is there by then, on a machine that has much else to do


@dataclass
class Sent:
    """What left the page. how, to: method and path; body: what it holds, or the question; kind: its type;
    by_script: a script of the page sent it, and not the form."""

    how: str
    to: str
    body: str
    kind: str
    by_script: bool


def send_all_forms(page: Any, file: str) -> list[Sent]:
    """Tabs through the page as it is open, types what is needed, presses Enter on every button of a form; what is sent
    is kept from the hall and told. file: what is brought where a file is asked for.

    Asserts that the key reaches every control, in the order of the document, and that each is seen to have the focus.
    """
    controls, forms, caught = page.evaluate(CONTROLS), page.evaluate(FORMS), []
    page.route("**/*", lambda route: _keep(route, caught))
    reached: list[int] = []
    for _ in range(MOST_KEYS):
        if len(reached) == len(controls):
            break
        page.keyboard.press("Tab")
        at = page.evaluate(FOCUS)
        n = at["n"]
        if n < 0 or (reached and reached[-1] == n):
            continue
        control = controls[n]
        assert n not in reached, f"{_named(control)} twice: {_missed(controls, reached)} is never reached"
        _see(page, at, _named(control))
        reached.append(n)
        if control["kind"] == "submit":
            _press(page, control, forms[control["form"]], controls, caught)
        else:
            _fill(page, control, file)
    assert reached == [one["n"] for one in controls], _missed(controls, reached)
    page.unroute_all(behavior="ignoreErrors")
    return caught


def _see(page: Any, at: dict, name: str) -> None:
    """The page may scroll to it at its leisure."""
    end = time.monotonic() + SCROLLED
    while not (at["shown"] and at["within"]) and time.monotonic() < end:
        page.wait_for_timeout(50)
        at = page.evaluate(FOCUS)
    assert at["shown"], f"nothing shows that {name} has the focus"
    assert at["within"], f"{name} has the focus beside what is seen"


def _keep(route: Any, caught: list[Sent]) -> None:
    """Pictures and scripts come as ever; what a form sends gets no answer that would change the page."""
    asked = route.request
    if asked.method == "GET" and not asked.is_navigation_request():
        route.continue_()
        return
    where = urlsplit(asked.url)
    body = (
        (asked.post_data_buffer or b"").decode("utf-8", "replace") if asked.method == "POST" else where.query
    )
    kind = asked.headers.get("content-type", "")
    caught.append(Sent(asked.method, where.path, body, kind, not asked.is_navigation_request()))
    if asked.is_navigation_request():
        route.fulfill(status=204)
    # A script waits for its answer, and leaves the page as it is meanwhile.


def _press(page: Any, control: dict, form: dict, controls: list[dict], caught: list[Sent]) -> None:
    before = len(caught)
    page.keyboard.press("Enter")
    soon(page, lambda: len(caught) > before)
    (sent,) = caught[before:]
    if sent.by_script:  # which chooses where to
        return
    if "multipart" in sent.kind:
        names = set(re.findall('name="([^"]+)"', sent.body))
    else:
        names = set(parse_qs(sent.body, keep_blank_values=True))
    # Of ticks and choices those are sent that are set.
    unsure = ("submit", "button", "checkbox", "radio")
    mine = {one["name"] for one in controls if one["form"] == control["form"] and one["kind"] not in unsure}
    assert (sent.how, sent.to) == (form["how"], form["to"])
    assert names >= mine | set(form["hidden"]), f"{form['to']}: fields are missing"


def _fill(page: Any, control: dict, file: str) -> None:
    """By key: what is asked for and empty, and whatever a tick is needed for."""
    kind, keys = control["kind"], page.keyboard
    if kind == "file":
        _choose(page, file)
    elif kind in ("checkbox", "radio"):
        if control["needed"]:
            keys.press("Space")
    elif kind == "datetime-local":
        if control["needed"] and not control["value"]:
            keys.type("11282031")
            keys.press("ArrowRight")
            keys.type("0900AM")
            typed = page.evaluate("document.activeElement.value")
            assert typed == "2031-11-28T09:00", typed
    elif control["needed"] and not control["value"] and kind in TYPED:
        keys.type(TYPED[kind])


def _choose(page: Any, file: str) -> None:
    """Press again where nothing opened: a browser that is kept waiting takes a key for no longer meant."""
    chosen: list[Any] = []
    page.once("filechooser", lambda opened: chosen.append(opened))
    for _ in range(6):
        page.keyboard.press("Space")
        with suppress(AssertionError):
            soon(page, lambda: chosen, SCROLLED)
            break
    assert chosen, "nothing opens to choose a file from"
    chosen[0].set_files(file)


def _named(control: dict) -> str:
    return control["id"] or control["name"] or control["told"]


def _missed(controls: list[dict], reached: list[int]) -> str:
    """The first control out of its turn."""
    for turn, control in enumerate(controls):
        if turn >= len(reached) or reached[turn] != control["n"]:
            return f"{_named(control)} of form {control['form']}"
    return "nothing"
