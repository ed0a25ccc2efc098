"""Drawings that were brought look as they did, as far as they draw: cleaned and as they came, pixel by pixel."""

from __future__ import annotations

import base64
import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from svg_drawings import drawing

from hall_app.house.drafts import take_in

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SHEETS = sorted((Path(__file__).parents[1] / "sim_core/sheets").glob("*.svg"))
SHIPPED = Path(__file__).parents[2] / "assets/exhibits"
GIVEN = b'<path id="p" d="M1 1h6v6z"/><rect class="b" x="4" width="4" height="4"/><circle r="3" class="b c"/>'
CLIP = b'<clipPath id="k"><circle cx="4" cy="4" r="3"/></clipPath>'
GRADIENT = (
    b'<linearGradient id="g"><stop stop-color="red"/><stop offset="1" stop-color="blue"/></linearGradient>'
)
PATTERN = b'<pattern id="d" width="2" height="2" patternUnits="userSpaceOnUse"><rect width="1" height="2"/></pattern>'
MASK = b'<mask id="m"><rect width="5" height="9" fill="#fff"/></mask>'


def styled(rules: bytes, inside: bytes = GIVEN) -> bytes:
    return drawing(CLIP + GRADIENT + PATTERN + MASK + b"<style>" + rules + b"</style>" + inside)


# As programs write them.
HONEST = {
    "classes that clip, paint and mask": styled(
        b".b{clip-path:url(#k)} path{fill:url(#d);mask:url(#m)} .c{fill:url(#g)}"
    ),
    "what is nearer to an element wins": styled(
        b"*{stroke:#0a0;stroke-width:.5} g .b{fill:gold} .b{fill:red} #p{fill:tan} rect{fill:blue!important}",
        b"<g>" + GIVEN.replace(b'class="b"', b'class="b" style="fill:green;stroke:none"') + b"</g>",
    ),
    "one bad declaration among good ones": styled(
        b"@import url(https://f/c?a:1;b@2); path{cursor:url(h.cur);fill:#\\66 00} .\\62{fill:green}"
    ),
    "entities and a comment": styled(
        b"<![CDATA[<!-- @media screen, print{path{fill:teal}} .c{opacity:.4} -->]]>"
    ),
    "a shape used, marked and dashed": styled(
        b".b{stroke:#222;stroke-dasharray:1 .4}",
        GIVEN
        + b'<marker id="a" markerWidth="2" markerHeight="2"><circle r="1" fill="red"/></marker>'
        + b'<path d="M1 8h6" style="marker:url(#a);stroke:#00f"/><use href="#%70" x="1" fill="lime"/>',
    ),
    "short and long properties in turn": styled(
        b".t{font-size:1px} .t{font:2px serif} #w{font-size:5px}", b'<text id="w" class="t" y="6">abc</text>'
    ),
    "what later rules say": styled(
        b".b:hover,.b:focus,.b{fill:red} .b{fill:blue} .c.c{fill:tan} .c{fill:teal}"
    ),
    "a coloured ground": drawing(GIVEN).replace(b"<svg", b'<svg style="background-color:gold"'),
    "links": styled(b"a{fill:red} g{fill:blue}", b"<a href='x'>" + GIVEN + b"</a>"),
    "a word": drawing(
        "<text y='6' style=\"font:italic 4px 'Noto Serif CJK SC', serif\">直裾</text>".encode()
    ),
}


def seen(page, data: bytes) -> np.ndarray:
    page.set_content("<body style='margin:0'><img style='width:300px;height:300px'></body>")
    address = f"data:image/svg+xml;base64,{base64.b64encode(data).decode()}"
    page.evaluate(
        "async (there) => { const one = document.images[0]; one.src = there; await one.decode(); }", address
    )
    shot = page.screenshot(clip={"x": 0, "y": 0, "width": 300, "height": 300})
    return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"))


def same(page, data: bytes) -> None:
    before = seen(page, data)
    assert np.ptp(before) > 100, "something is drawn"
    cleaned = take_in("sheet.svg", io.BytesIO(data), len(data), "picture").data
    np.testing.assert_array_equal(seen(page, cleaned), before)


@pytest.fixture(scope="module")
def page(chromium):
    return chromium.new_context(viewport={"width": 320, "height": 320}).new_page()


@pytest.mark.parametrize("name", HONEST)
def test_it_looks_as_it_did(page, name):
    same(page, HONEST[name])


def test_sheets_and_shipped_drawings_look_as_they_did(page):
    for path in (*SHEETS, *sorted(SHIPPED.rglob("media/*.svg"))):
        same(page, path.read_bytes())
