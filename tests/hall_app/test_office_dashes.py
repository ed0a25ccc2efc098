"""Dashes of drawings: kept where they are countable, all left out where they are too many or nobody can tell."""

from __future__ import annotations

import contextlib

import pytest
from svg_drawings import drawing, kept, read, taken

from hall_app.house.people import PeopleError

NARROW = 'vector-effect="non-scaling-stroke"'
COUNTABLE = {
    "beside letters": '<g stroke-dasharray="4 2"><text font-size="12">front, fold %s</text><path d="M0 0h9" /></g>'
    % ("x" * 90),
    "a turned line as wide as a screen has it": '<g transform="matrix(1,0,0,1,9,9)rotate(30)">'
    f'<path {NARROW} stroke-dasharray="4" d="M0 0h9" /></g>',
    "with an arrow": '<marker id="arrow" viewBox="0 0 9 9"><path d="M0 0" /></marker>'
    f'<path {NARROW} stroke-dasharray="4 2" marker-end="url(#arrow)" d="M0 0h9" />',
    "beside many scales": f'<path {NARROW} stroke-dasharray="4 2" d="M0 0h9" />'
    + '<g transform="scale(2)"><path d="M0 0h1" /></g>' * 99,
    "beside a curve as SVGO runs it together": '<path d="M0 0q1 1 2 0t2 0 2 0T9 9" />'
    '<path d="M1 1a5 5 0 01-3 4a1 1 0 1 1.5.5" /><path stroke-dasharray="4 2" d="M0 0h9" />',
    "beside what they do not reach": '<path d="M0 0A1 1 0 0 1" /><rect width="calc(100% - 2px)" height="8em" />'
    '<rect width="1e9" height="1e9" /><path stroke-dasharray="4 2" d="M0 0h9" />',
    "with a dot between": '<path stroke-dasharray="9 3 1 3" d="M0 0h9" />',
    "dots": '<path stroke-dasharray="0 4" d="M0 0h9" />',
    "none of any length": '<path stroke-dasharray="0 0" d="M0 0h1e9" />',
    "far from the middle": '<path stroke-dasharray="5 5" d="M 500000 -4500000 h 100" />'
    * 9
    + '<line stroke-dasharray="5 5" x1="500000" x2="500100" y1="-4500000" y2="-4500000" />'
    '<rect stroke-dasharray="5 5" x="500000" width="9" height="9" />',
    "beside what is used enlarged": f'<path {NARROW} stroke-dasharray="4 2" d="M0 0h9" /><path id="i" d="M0 0h1" />'
    '<use href="#i" transform="scale(2)" />',
    "short ones along a short line": '<path stroke-dasharray=".01 .01" d="M0 0h2" />'
    '<path stroke-dasharray="20 10" d="M0 0h2000000" />',
    "of a wide line": '<path stroke-width="3" stroke-dasharray=".2 .2" d="M0 0h9" />',
    "of letters' measure": '<rect width="8em" height="1em" stroke-dasharray="40" />',
    "long": '<path stroke-dasharray="4 2" d="M0 0%s" />' % ("L100 100" * 900),
}


@pytest.mark.parametrize("case", COUNTABLE)
def test_dashes_that_are_countable_are_kept(case):
    assert kept(COUNTABLE[case]) == (COUNTABLE[case], "9 × 9")


MEAN = "1 " * 500 + "1e8"
COUNTLESS = {
    "short ones": '<g stroke-dasharray=".0004">%s</g>' % ('<path d="M0 0h390"/>' * 99),
    "along a line back to an edge": '<g stroke-dasharray=".5">%s</g>' % ('<path d="M200000 9H0"/>' * 999),
    "many of a list": '<g stroke-dasharray=".01 .01 .01">%s</g>' % ('<path d="M0 0h99"/>' * 9_999),
    "along a line without end": '<path stroke-dasharray="1" d="M0 0h1e999"/>',
    "along a line that is nowhere": '<path stroke-dasharray="1" d="M1e999 0L1e999 0"/>',
    "along a side that is reckoned": '<circle r="calc(100000px)" stroke-dasharray="1"/>',
    "along shares of an unknown frame": "<svg>%s</svg>"
    % ('<rect width="100%" stroke-dasharray=".0015"/>' * 6),
    "along shares of inches": '<svg width="1000in">%s</svg>'
    % ('<rect width="100%" stroke-dasharray=".6"/>' * 600),
    "as wide as a screen has them": '<g stroke-dasharray=".5">%s</g>'
    % (f'<path {NARROW} d="M0 0h9"/>' * 1_600),
    "enlarged from far away": f'<g transform="scale(1e5)"><g style="transform:scale(1,3)"><path {NARROW} '
    'stroke-dasharray="1" d="M0 0h9"/></g></g>',
    "used enlarged": f'<path id="a" {NARROW} stroke-dasharray="1" d="M0 0h9"/><use href="#a" transform="scale(1e5)"/>',
    "in a symbol": f'<symbol id="a" viewBox="0 0 1 1"><path {NARROW} stroke-dasharray="1" d="M0 0h9"/></symbol>',
    "along curves that go on": '<path stroke-dasharray=".1" d="M0 0q9 99 9 0t%s"/>' % ("9 0 " * 9_999),
    "along arcs that are none": '<path stroke-dasharray="1" d="M0 0a1 1 0 2 0 1 1"/>',
    "along arcs whose radii grow": '<path stroke-dasharray="1" d="M0 0A1 1e-7 0 0 1 0 1"/>',
    "along a share of more than all": '<svg width="100000%" height="100000%">'
    '<circle r="100%" stroke-dasharray="1"/></svg>',
    "along a symbol larger than its frame": '<symbol id="s"><circle r="100%" stroke-dasharray="1"/></symbol>'
    '<use href="#s" width="1000000%" height="1000000%"/>',
    "along heights of lines": '<circle r="1lh" style="line-height:3e7px" stroke-dasharray="250"/>',
    "short beside a long gap": f'<path stroke-dasharray="{MEAN}" d="{"M0 0H989" * 20_000}"/>',
    "short beside a long gap, used": f'<path id="a" stroke-dasharray="{MEAN}" d="M0 0H989"/>'
    + '<use href="#a"/>' * 14_000,
    "without any length, with a gap": '<path stroke-dasharray="0 0 0 9" d="M0 0h9"/>',
    "wider than long": '<path d="M0 500h1000" stroke-width="1000" stroke-dasharray=".05"/>',
    "of a width that is handed down": '<g stroke-width="50%"><path d="M0 500h1000" stroke-dasharray="9"/></g>',
    "along letters": '<text stroke-dasharray=".001" font-size="1000">%s</text>' % ("a" * 99),
    "handed to what is used": '<path id="a" d="M0 0h9999"/><g stroke-dasharray=".0001"><use href="#a"/></g>',
    "along letters of a size that is handed down": '<g font-size="10em"><text stroke-dasharray=".01">%s</text></g>'
    % ("a" * 99),
    "along a line below letters": '<text style="text-decoration:underline" stroke-dasharray="1">a</text>',
    "handed to letters that lie elsewhere": '<text id="t">%s</text><use href="#t" stroke-dasharray=".001"/>'
    % ("a" * 999),
    "said by a class": "<style>path{stroke-dasharray:.001;fill:red}</style>%s"
    % ('<path d="M0 0h9999"/>' * 9),
    "said by a style": '<path style="stroke-dasharray:.00001!important;fill:red" d="M0 0h9999"/>',
}


@pytest.mark.parametrize("case", COUNTLESS)
def test_where_dashes_are_countless_there_are_none(case):
    body, told = kept(COUNTLESS[case])
    assert "dash" not in body
    assert "stroke-dasharray" in told
    plain = COUNTLESS[case].count("<path") or 1
    assert body.count("<path") in (plain, 0), "all else is kept"
    assert "non-scaling-stroke" in body or NARROW not in COUNTLESS[case]


ROOTS = {
    b'width="9" height="9"': True,
    b'width=".00001" height=".00001"': False,
    b'viewBox="0 0 4000" width=".00001" height="1"': False,
}


@pytest.mark.parametrize("root", ROOTS)
def test_a_small_root_enlarges_all_it_holds(root):
    line = f'<path {NARROW} stroke-dasharray="1" d="M0 0h9"/>'
    data = drawing(line.encode()).replace(b'viewBox="0 0 9 9"', root)
    assert (b"dash" in taken(data).data) is ROOTS[root]


def test_without_dashes_a_drawing_may_still_draw_too_much():
    with pytest.raises(PeopleError) as refused:
        kept('<g id="a">' + '<path stroke-dasharray="1"/>' * 999 + "</g>" + '<use href="#a"/>' * 999)
    assert refused.value.key == "file-svg-drawn"


# What took seconds for 20 to 90 KB, growing with the square.
SLOW = {
    "lists for many": f"<style>rect{{stroke-dasharray:{'1 ' * 990}}}</style>{'<rect/>' * 20_000}",
    "lists of nothing": f"<style>rect{{stroke-dasharray:{'0 ' * 990}}}</style>{'<rect/>' * 20_000}",
    "arcs run together": '<path stroke-dasharray="1" d="M0 0a%s"/>' % ("1" * 3_900_000),
    "transforms": f'<path {NARROW} stroke-dasharray="1" transform="%s"/>' % ("scale(1 " * 400_000),
    "transforms of many": f'<style>rect{{transform:%s}}</style><path {NARROW} stroke-dasharray="9"/>'
    % ("scale(1)" * 249)
    + "<rect/>" * 40_000,
}


@pytest.mark.parametrize("case", SLOW)
def test_few_bytes_take_no_minutes(case):
    with contextlib.suppress(PeopleError):
        assert len(read(drawing(SLOW[case].encode()))) < 400
