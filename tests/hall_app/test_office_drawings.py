"""Drawings brought as SVG: what draws is kept to the letter, all else is left out, and little text draws little."""

from __future__ import annotations

import base64
import contextlib
import io
import re
from pathlib import Path
from urllib.parse import quote
from xml.etree import ElementTree

import pytest
from content_house import png_of
from PIL import Image
from svg_drawings import doubled, drawing, kept, read, taken

from hall_app.content.models import picture_fault
from hall_app.house.drafts import intake
from hall_app.house.people import PeopleError

ROOT = Path(__file__).parents[2]
SHIPPED = sorted((*(ROOT / "assets").rglob("media/*.svg"), *(ROOT / "tests/sim_core/sheets").glob("*.svg")))
SVG = "{http://www.w3.org/2000/svg}"
NO_SHAPES = (SVG + "metadata", SVG + "style")


def drawn_by(data: bytes) -> list[tuple[str, tuple[tuple[str, str], ...], str]]:
    """What draws in a tree but for sheets and classes, in order: element, plain attributes, text."""
    found = []
    for one in ElementTree.fromstring(data).iter():
        if isinstance(one.tag, str) and one.tag.startswith(SVG) and one.tag not in NO_SHAPES:
            plain = {key: value for key, value in one.attrib.items() if "}" not in key and key != "class"}
            if "style" in plain:
                plain["style"] = re.sub(r"\s*([:;])\s*", r"\1", plain["style"].strip()).rstrip(";")
            found.append((one.tag, tuple(sorted(plain.items())), (one.text or "").strip()))
    return found


@pytest.mark.parametrize("path", SHIPPED, ids=[f"{p.parents[1].name}-{p.name}" for p in SHIPPED])
def test_an_honest_drawing_is_kept_to_the_letter(tmp_path, path):
    one = taken(path.read_bytes())
    assert (one.kind, one.name[-4:]) == ("picture", ".svg")
    assert "−" not in one.told, "nothing was left out"
    assert drawn_by(one.data) == drawn_by(path.read_bytes())
    target = tmp_path / "kept.svg"
    target.write_bytes(one.data)
    assert picture_fault(target) is None
    assert taken(one.data).data == one.data, "cleaned again it is the same"


ONE = "<style>.c1{%s}\n</style>"
# What comes -> what of it is kept. A path draws all the while.
LEFT_OUT = {
    '<script>x()</script><path d="M0 0"/>': '<path d="M0 0" />',
    '<path d="M0 0" onclick="x()" ONLOAD="x()"/>': '<path d="M0 0" />',
    '<a href="javascript:x()"><path d="M0 0"/></a>': '<g><path d="M0 0" /></g>',
    '<text>to <a href="http://x">here</a> and on</text>': "<text>to <tspan>here</tspan> and on</text>",
    '<use href="other.svg#a"/>': "<use />",
    '<path fill="url(http://x/#a)" d="M0 0"/>': '<path d="M0 0" />',
    '<path style="fill:\\75rl(http://x)" d="M0 0"/>': '<path d="M0 0" />',
    '<path style="fill:u/**/rl(http://x)" d="M0 0"/>': '<path d="M0 0" />',
    '<path fill="url(#a)" d="M0 0"/>': '<path fill="url(#a)" d="M0 0" />',
    '<path style="fill:red;fill:url(http://x);q:y" d="M0 0"/>': '<path style="fill:red" d="M0 0" />',
    '<path style="fill:u\\72l(\'#a\') \\72 ed" d="M0 0"/>': '<path style="fill:url(#a) red" d="M0 0" />',
    '<rect style="mask:inherit;stroke-dasharray:1%"/><rect mask="inherit"/>': "<rect /><rect />",
    "<style>@font-face{src:url(http://x)} rect{fill:red}</style><rect/>": f'{ONE % "fill:red"}<rect class="c1" />',
    "<style>rect{fill:url(http://x)}</style><rect/>": "<rect />",
    '<style>.x{fill:"url(\n#;}rect{mask-image:url(http://h/x)}</style><rect/>': "<rect />",
    "<rect style='x:\"url(&#10;#;mask-image:url(http://h/x)'/>": "<rect />",
    '<rect style="filter//**/**/:blur(30px)"/>': "<rect />",
    "<style>@import url(//f/c?f=R:400;700@1); rect{fill:#0f0}</style><rect/>": (
        f'{ONE % "fill:#0f0"}<rect class="c1" />'
    ),
    "<style><![CDATA[<!-- g:hover{fill:red} rect{-webkit-backdrop-filter:blur(3px);fill:red} -->]]></style><rect/>": (
        f'{ONE % "fill:red"}<rect class="c1" />'
    ),
    '<style media="print">path{display:none}</style><style type="x">path{display:none}</style><path/>': "<path />",
    '<style media="print, screen">@media all{g>.a{fill:red}}</style><g><rect class="a b"/></g><rect class="a"/>': (
        f'{ONE % "fill:red"}<g><rect class="c1" /></g><rect />'
    ),
    '<style>.a{clip-path:url("#c")}</style><clipPath id="c"/><rect class="a"/>': (
        f'{ONE % "clip-path:url(#c)"}<clipPath id="c" /><rect class="c1" />'
    ),
    "<style>rect{fill:red;color:red} #o{fill:blue} * {fill:tan;opacity:1!important}</style><rect id='o'/>": (
        "<style>.c1{color:red;fill:blue;opacity:1!important}\n.c2{fill:tan;opacity:1!important}\n</style>"
        '<rect id="o" class="c1" />'
    ),
    '<style>.b:hover,.b:focus,.a{fill:red} .a{fill:blue}</style><rect class="a"/>': (
        f'{ONE % "fill:blue"}<rect class="c1" />'
    ),
    '<style>.a{font-size:1px} .a{font:2px serif} .b{font-size:9px}</style><text class="a b"/>': (
        f'{ONE % "font:2px serif;font-size:9px"}<text class="c1" />'
    ),
    '<style>.a.a{fill:red} .a{fill:tan} a{stroke:red} g{stroke:tan}</style><a><rect class="a"/></a>': (
        '<style>.c1{fill:red}\n.c2{stroke:red}\n</style><g class="c2"><rect class="c1" /></g>'
    ),
    '<g id="image (1)"/><use href="#%61"/><use href="#a&#10;b"/>': '<g id="image (1)" /><use href="#a" /><use />',
    '<text xml:space="preserve">m<sup>2</sup> of <set/>silk</text>': '<text xml:space="preserve">m of silk</text>',
    "<animate attributeName='href' to='javascript:x()'/><path d='M0 0'/>": '<path d="M0 0" />',
    '<filter id="f"><feImage href="http://x"/></filter><path filter="url(#f)" d="M0 0"/>': '<path d="M0 0" />',
    '<image href="data:image/svg+xml;base64,PHN2Zy8+"/><path d="M0 0"/>': '<path d="M0 0" />',
    '<g transform="translate (1 2)"/><g fill="url (#a)"/><g d="(aa"/><g d="foo (1)"/>': (
        '<g transform="translate (1 2)" /><g /><g /><g />'
    ),
    '<use href="#bullet-char-template(57356)"/><g id="bullet-char-template(57356)"/>': (
        '<use href="#bullet-char-template(57356)" /><g id="bullet-char-template(57356)" />'
    ),
    '<text xml:lang="zh-Hant">a</text><text xml:lang="a b"/>': '<text xml:lang="zh-Hant">a</text><text />',
    '<text dx="1">a<i/>b<i/>c<tspan>d</tspan>e<i/>f</text>': '<text dx="1">abc<tspan>d</tspan>ef</text>',
    '<path stroke-dasharray="%s"/>' % ("1 " * 2_000): "<path />",
    '<path style="fill:\\&#10;;stroke:red"/>': '<path style="stroke:red" />',
    '<path style="fill:red;fill:;stroke:tan"/>': '<path style="fill:red;stroke:tan" />',
    '<rect style="mask:url(#m),url(#m);clip-path:url(#m)"/>': '<rect style="clip-path:url(#m)" />',
    "<text>a&#13;b</text>": "<text>a\nb</text>",
    '<style>@font-face{src:url("data:font/woff2;base64,AA") format("a")}rect{fill:red}</style><rect/>': (
        f'{ONE % "fill:red"}<rect class="c1" />'
    ),
    '<rect font-family="url(#a)" style="color:url(#a);stroke:url(#a)"/>': '<rect style="stroke:url(#a)" />',
    '<path style="font-family:a\\ ;stroke:red"/>': '<path style="font-family:a\\ ;stroke:red" />',
    "<style>path{fill:\\\n} rect{stroke:red}</style><path/><rect/>": f'{ONE % "stroke:red"}<path /><rect class="c1" />',
    '<e:note xmlns:e="urn:editor" e:by="me"/><path xmlns:e="urn:editor" e:at="home" d="M0 0"/>': '<path d="M0 0" />',
}


@pytest.mark.parametrize("inside", LEFT_OUT)
def test_what_does_not_draw_is_left_out(inside):
    assert kept(inside)[0] == LEFT_OUT[inside]


def test_the_page_says_what_was_left_out():
    assert kept("<script/><script/><path onclick='x()' d='M0 0'/>")[1] == "9 × 9 · − onclick 1, script 2"
    shaped = "<style>circle{r:4px}</style><circle style='cx:3px;translate:1px;a:b'/>"
    assert kept(shaped)[1] == "9 × 9 · − cx 1, r 1, translate 1"


def test_a_picture_within_is_drawn_anew():
    source = io.BytesIO()
    Image.new("RGB", (20, 10), "#7a4b2e").save(source, "JPEG", comment=b"taken at home")
    within = base64.b64encode(source.getvalue()).decode()
    body, _ = kept(f'<image width="9" height="9" href="data:image/jpeg;base64,{within}"/>')
    assert kept(f'<image width="9" height="9" href="data:image/jpeg;base64,{quote(within)}"/>')[0] == body
    (found,) = re.findall(r"data:image/jpeg;base64,([^\"]+)", body)
    again = base64.b64decode(found)
    assert b"taken at home" in source.getvalue()
    assert b"taken at home" not in again
    assert Image.open(io.BytesIO(again)).size == (20, 10)


SAID = b"fill stroke color font-family opacity display direction overflow mask marker font visibility".split()
ENDLESS = {
    "uses of uses": doubled(40),
    "a circle": b'<g id="a"><use href="#a"/></g>',
    "patterns in patterns": b"".join(
        b'<pattern id="p%d">%s</pattern>' % (n, b'<path fill="url(#p%d)" d="M0 0"/>' % (n + 1) * 20)
        for n in range(8)
    )
    + b'<path fill="url(#p0)" d="M0 0"/>',
    "a deep nest": b"<g>" * 9_000 + b"</g>" * 9_000,
    "very many": b"<path/>" * 60_001,
    "markers handed down": b'<marker id="m">%s</marker><g marker-end="url(#m)">%s</g>'
    % (b"<path/>" * 2_000, b'<path d="M0 0h1"/>' * 2_000),
    "a marker at every corner": b'<marker id="m">%s</marker><path marker-mid="url(#m)" d="M0 0%s"/>'
    % (b"<path/>" * 4_000, b"h1" * 40_000),
    "a long line used often": b'<path id="a" d="M0 0%s"/>%s' % (b"h1" * 40_000, b'<use href="#a"/>' * 2_000),
    "the first of one name": b'<g id="a">%s</g>%s<g id="a"/>'
    % (b"<path/>" * 99, b'<use href="#a"/>' * 9_999),
    "a long namespace": b'<g xmlns:a="%s"/>' % (b"x" * 9_999),
    "a name with a line in it": doubled(40).replace(b"#a", b"#&#10;a"),
    "text after text": b'<text id="a"><tspan/>%s</text>%s' % (b"x" * 99_999, b'<use href="#a"/>' * 99),
    "markers along what is within": b'<marker id="m">%s</marker><g marker-mid="url(#m)"><path d="M0 0%s"/></g>'
    % (b"<path/>" * 99, b"h1" * 9_999),
    "stops": b'<linearGradient id="g">%s</linearGradient>%s'
    % (b"<stop/>" * 9_999, b'<rect fill="url(#g)"/>' * 999),
    "gradients in a row": b"".join(
        b'<linearGradient id="g%d" href="#g%d"/>' % (n, n - 1) for n in range(2_000)
    ),
    "groups laid over": b'<g style="mix-blend-mode:darken"><path/></g>' * 9_999,
    "selectors": b"<style>%s</style>%s" % (b"* * * * * *{x:1}" * 999, b"<g>" * 100 + b"</g>" * 100),
    "rules": b"<style>" + b"*{x:1}" * 99_999 + b"</style>",
    "what rules say": b"<style>%s</style>%s"
    % (
        b"".join(b".a%d{%s:%s}" % (n, key, b"x" * 1_999) for n, key in enumerate(SAID)),
        b"".join(
            b'<g class="%s"/>' % b" ".join(b"a%d" % n for n in range(len(SAID)) if one >> n & 1)
            for one in range(400)
        ),
    ),
    "patterns that lie in what they paint": b'<rect fill="url(#p0)"/>'
    + b"".join(
        b'<g fill="url(#p%d)" stroke="url(#p%d)"><pattern id="p%d"/></g>' % (n + 1, n + 1, n)
        for n in range(40)
    ),
    "a line that its kind has not": b'<polyline d="M" id="a" points="%s"/>%s'
    % (b"1 1 " * 40_000, b'<use href="#a"/>' * 2_000),
    "markers of a line that its kind has not": b'<marker id="m">%s</marker>'
    b'<polyline d="M" marker-mid="url(#m)" points="%s"/>' % (b"<path/>" * 900, b"1 1 " * 40_000),
    "markers of closings": b'<marker id="m">%s</marker><path marker-mid="url(#m)" d="M0 0%s"/>'
    % (b"<path/>" * 900, b"z" * 40_000),
    "gradients of nothing": b'<linearGradient id="a"/><style>rect{fill:%s}</style>%s'
    % (b"url(#a)" * 285, b"<rect/>" * 8_000),
    "masks of leaves": b'<mask id="m"/>' + b'<rect mask="url(#m)"/>' * 300,
    "letters that clip": b'<clipPath id="c"><text>a</text></clipPath>'
    + b'<rect clip-path="url(#c)"/>' * 9_999,
    "paint that markers take over": b'<pattern id="p">%s</pattern><marker id="m">%s</marker>%s'
    % (
        b"<rect/>" * 99,
        b'<rect fill="context-fill"/>' * 99,
        b'<path fill="url(#p)" style="marker:url(#m)" d="M0 0%s"/>' % (b"h1" * 99),
    ),
    "attributes": b"<g %s/>" % b" ".join(b'a%d=""' % n for n in range(300_001)),
    "many pictures": b"".join(
        b'<image href="data:image/png;base64,%s"/>' % base64.b64encode(png_of(1, 1, 99) + bytes([n]))
        for n in range(201)
    ),
    "a large picture": b'<image href="data:image/png;base64,%s"/>'
    % base64.b64encode(png_of(7_000, 7_000, 7_000)),
}


@pytest.mark.parametrize("case", ENDLESS)
def test_little_text_does_not_draw_without_end(case):
    with pytest.raises(PeopleError) as refused:
        read(drawing(ENDLESS[case]))
    assert refused.value.key == "file-svg-drawn"


HANDED = b"fill stroke marker marker-start marker-mid marker-end".split()
RULE = b";".join(b"%s:a;%s:a!important" % (key, key) for key in SAID * 9)
# What took minutes to days, or gigabytes.
SLOW = {
    "comments": b"<style>" + b"/* " * 900_000 + b"</style>",
    "comments in an attribute": b'<path style="' + b"/* " * 900_000 + b'"/>',
    "references": b'<path fill="' + b"url(#" * 700_000 + b'"/>',
    "rules": b"<style>" + b"@a " * 900_000 + b"</style>",
    "rules in a rule": b"<style>@a{" + b"@a " * 900_000 + b"</style>",
    "a long rule": b"<style>@" + b"a" * 3_900_000 + b"</style>",
    "encodings": b"<?xml " + b' encoding="a"' * 300_000 + b"?>",
    "letters brought along": b"<style>" + b"url(data:" * 400_000 + b"</style>",
    "attributes left out": b"<g %s/>" % b" ".join(b'on%d=""' % n for n in range(99_999))
    + b'<g style="x"/>' * 6_000,
    "a long value": b'<style>*{font-family:"%s"}</style>' % (b"x" * 290_000) + b"<g/>" * 50_000,
    "short values": b"<style>*{%s}</style>" % b"".join(b"%s:%s;" % (key, b"x" * 1_999) for key in SAID)
    + b"<g/>" * 50_000,
    "a nest of rules": b"<style>" + b"@media screen{" * 20_000 + b"</style>",
    "a nest of blocks": b"<style>" + b"{" * 900_000 + b"</style>",
    "a nest of functions": b'<path style="fill:' + b"calc(" * 200_000 + b'"/>',
    "brackets": b'<path d="(' + b"a" * 3_900_000 + b'"/>',
    "references in words": b"<style>rect{%s}</style>%s"
    % (
        b";".join(b'%s:"%s"' % (key, b"url(#" * 395) for key in SAID),
        b"<rect/>" * 8_000,
    ),
    "clips of many": b'<clipPath id="c">%s</clipPath>%s'
    % (b"<rect/>" * 20_000, b'<rect clip-path="url(#c)"/>' * 20_000),
    "commas": b'<path clip-path="' + b"," * 3_900_000 + b'"/>',
    "words between": b"<text>%s</text>" % (b"<i/>%s" % (b"x" * 62) * 50_000),
    "many figures": b'<path d="M%s"/>' % (b"1" * 3_900_000),
    "rules told anew": b"<style>%s</style>%s"
    % (
        b"".join(b"%s{%s}" % (b",".join([b".a%d" % n] * 99), RULE) for n in range(10)),
        b"".join(
            b'<g class="%s"/>' % b" ".join(b"a%d" % n for n in range(10) if one >> n & 1)
            for one in range(999)
        ),
    ),
    "markers handed down far": b"<style>g{%s}</style>%s%s%s%s"
    % (
        b";".join(
            b"%s:url(#z)" % key for key in b"fill stroke marker marker-start marker-mid marker-end".split()
        ),
        b"<g>" * 115,
        b"".join(b'<path id="a%d"/>' % n for n in range(9_000)),
        b"</g>" * 115,
        b"".join(b'<use href="#a%d"/>' % n for n in range(9_000)),
    ),
    "paints handed down far": b"<style>.a{%s}</style><g>%s</g><linearGradient id='z'/>%s%s%s"
    % (
        b";".join(b"%s:url(#z);%s:url(#z)!important" % (key, key) for key in HANDED),
        b"".join(b'<use href="#a%d"/>' % n for n in range(9_000)),
        b'<g class="a">' * 110,
        b"".join(b'<path id="a%d"/>' % n for n in range(9_000)),
        b"</g>" * 110,
    ),
    "references of many": b"<style>*{%s}</style>%s"
    % (b";".join(b"%s:url(#a);%s:url(#a)!important" % (key, key) for key in SAID), b"<g/>" * 40_000),
    "names": b"".join(b"<n%s%d/>" % (b"o" * 2_000, n) for n in range(1_500)),
}


@pytest.mark.parametrize("case", SLOW)
def test_few_bytes_take_no_minutes(case):
    """Who looks at every byte for every other does not come to this test's end: no clock stops him here."""
    with contextlib.suppress(PeopleError):
        assert len(read(drawing(SLOW[case]))) < 400


def test_a_large_drawing_is_read_beside_and_ended_when_it_takes_too_long(monkeypatch):
    large = drawing(b"<path/>" * 40_000)
    assert taken(large).data.count(b"<path />") == 40_000
    with pytest.raises(PeopleError) as refused:
        taken(large + b"<")
    assert (refused.value.key, "sheet.svg" in str(refused.value)) == ("file-broken", True)
    monkeypatch.setattr(intake, "_DRAWN_WITHIN", 0.01)
    with pytest.raises(PeopleError) as refused:
        taken(large)
    assert refused.value.key == "file-svg-drawn"


def test_a_picture_used_often_may_not_fill_the_memory():
    tile, whole, source = Image.effect_noise((16, 16), 90), Image.new("RGB", (1_008, 1_008)), io.BytesIO()
    for k in range(63 * 63):
        whole.paste(tile, (k % 63 * 16, k // 63 * 16))
    whole.save(source, "WEBP", lossless=True)
    one = b'<image href="data:image/webp;base64,%s"/>' % base64.b64encode(source.getvalue())
    assert len(one) < 9_000
    with pytest.raises(PeopleError) as refused:
        taken(drawing(one * 20))
    assert refused.value.key == "file-size"


@pytest.mark.parametrize("said", ['<path style="%s"/>', "<style>path{%s}</style><path/>"])
def test_numbers_of_thousands_of_figures_are_refused_with_a_reason(said):
    with pytest.raises(PeopleError) as refused:
        kept(said % f"stroke-width:{'1' * 5_000}")
    assert refused.value.key == "file-broken"


REFUSED = {
    "file-svg": b'<!DOCTYPE svg [<!ENTITY a "<g/>">]>' + drawing(b"&a;"),
    "file-svg from elsewhere": b'<!DOCTYPE svg [<!ENTITY a SYSTEM "file:///etc/hostname">]>'
    + drawing(b"&a;"),
    "file-svg that unfolds": b'<!DOCTYPE svg [<!ENTITY a "%s">]>' % (b"x" * 200) + drawing(b"&a;" * 999),
    "file-svg of an attribute": b'<!DOCTYPE svg [<!ATTLIST g class CDATA "x">]>' + drawing(b"<g/>"),
    "file-broken": drawing(b"<path"),
    "file-broken of sixteen bits": b"<svg" + drawing(b"<path/>").decode().encode("utf-16"),
    "file-kind": drawing(b"<svg/>", root=b"html"),
    "file-size": drawing(b" " * 4_000_001),
}


@pytest.mark.parametrize("key", REFUSED)
def test_what_is_no_drawing_is_refused_with_a_reason(key):
    with pytest.raises(PeopleError) as refused:
        taken(REFUSED[key])
    assert refused.value.key == key.partition(" ")[0]
    for language in ("zh", "en"):
        assert "sheet.svg" in refused.value.text(language)


def test_a_drawing_is_no_model():
    with pytest.raises(PeopleError) as refused:
        taken(drawing(b"<path/>"), use="hall")
    assert refused.value.key == "file-use"


def test_a_plain_document_type_goes():
    told = (
        b'<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd">'
    )
    assert b"DOCTYPE" not in taken(told + drawing(b"<path/>")).data


def test_a_declared_name_of_the_language_is_no_hindrance():
    told = b'<!DOCTYPE svg [<!ATTLIST svg xmlns:xlink CDATA #FIXED "http://www.w3.org/1999/xlink">]>'
    assert b'<use href="#a" />' in taken(told + drawing(b'<use xlink:href="#a"/>')).data


def test_a_plain_short_name_is_unfolded():
    """As Illustrator calls its own namespaces."""
    told = b'<!DOCTYPE svg [<!ENTITY ns_ai "http://ns.adobe.com/AdobeIllustrator/10.0/">]>'
    one = taken(told + drawing(b'<g xmlns:i="&ns_ai;" i:layer="yes"><path d="M0 0"/></g>'))
    assert b'<g><path d="M0 0" /></g>' in one.data


@pytest.mark.parametrize("encoding", ["gb2312", "gbk", "big5", "utf-16", "iso-8859-1"])
def test_other_encodings_are_read(encoding):
    word = "Rock" if encoding == "iso-8859-1" else "直裾"
    head = f'<?xml version="1.0" encoding="{encoding}"?>'
    one = taken((head + drawing(f"<text>{word}</text>".encode()).decode()).encode(encoding))
    assert f"<text>{word}</text>" in one.data.decode()


def test_a_prefix_and_a_long_head_are_no_hindrance():
    prefixed = drawing(b"<s:path/>", root=b"s:svg").replace(b"xmlns=", b"xmlns:s=")
    assert b"<path />" in taken(b"<!-- " + b"by me " * 999 + b"-->" + prefixed).data


def test_pictures_that_lie_beside_the_file_are_no_pictures_within():
    linked = "".join(f'<image href="icon{n}.svg"/>' for n in range(300))
    tiny = base64.b64encode(png_of(2, 2, 2)).decode()
    body, told = kept(f'{linked}<image href="data:image/png;base64,{tiny}"/>')
    assert told.endswith("image 300")
    assert body.count("<image") == 1


def test_few_bytes_that_hold_a_large_picture_are_read_beside(monkeypatch):
    source = io.BytesIO()
    Image.new("RGBA", (2_000, 2_000)).save(source, "WEBP", lossless=True)
    one = drawing(b'<image href="data:image/webp;base64,%s"/>' % base64.b64encode(source.getvalue()))
    assert len(one) < 1_000
    monkeypatch.setattr(intake, "_DRAWN_WITHIN", 0.01)
    with pytest.raises(PeopleError) as refused:
        taken(one)
    assert refused.value.key == "file-svg-drawn"


def test_names_of_entities_are_counted_as_they_are_written():
    told = '<?xml version="1.0" encoding="iso-8859-1"?><!DOCTYPE svg [<!ENTITY é "x">]>'
    with pytest.raises(PeopleError) as refused:
        taken((told + drawing("<text>&é;</text>".encode()).decode()).encode("iso-8859-1"))
    assert refused.value.key == "file-svg"


@pytest.mark.parametrize("data", ["é", "AAAA", base64.b64encode(png_of(9, 9, 9)[:45]).decode()])
def test_a_broken_picture_within_is_left_out(data):
    body, told = kept(f'<image href="data:image/png;base64,{data}"/><path/>')
    assert body == "<path />"
    assert told.endswith("image 1")


def test_a_long_line_with_an_arrow_is_no_great_work():
    line = b"M0 0" + b"L100 100" * 900
    marked = b'<marker id="m"><path d="M0 0"/></marker><path marker-end="url(#m)" d="%s"/>' % line
    none = b'<pattern id="p"><path d="M0 0"/></pattern><path style="fill:url(#p);marker:none" d="%s"/>' % line
    dashed = b'<path stroke-dasharray="4 2" d="%s"/>' % line
    for one in (marked, none, dashed):
        assert "−" not in taken(drawing(one)).told


ILLEGAL = {
    "a name": '<rect style="fill:\\1 "/>',
    "words": "<style>rect{font-family:'\\b'}</style><rect/>",
    "an address": "<rect fill=\"url('#a\\8 ')\"/>",
    "a reference": '<use href="#%01"/>',
    "half a character": '<rect style="fill:\\d800 "/>',
    "no character": '<rect style="fill:\\fffe "/>',
    "what is told": '<rect style="\\d800 x:url(http://x);\\1 y:url(http://x)"/>',
}


@pytest.mark.parametrize("case", ILLEGAL)
def test_what_no_xml_may_hold_is_not_written(case):
    one = taken(drawing(ILLEGAL[case].encode()))
    ElementTree.fromstring(one.data)
    assert one.told.encode().decode().isprintable()


def test_a_clip_may_lie_in_what_it_clips():
    clip = '<g clip-path="url(#c)"><clipPath id="c"><rect /></clipPath></g><g clip-path="url(#c)" />'
    assert kept(clip)[0] == clip
