"""What style sheets and style attributes say of a drawing's elements: the properties that draw, from the file alone.

tinycss2 reads them, escapes and comments included. A sheet is written anew, one class for all elements it tells the
same: so every reference belongs to known elements, and no browser has selectors to weigh.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from urllib.parse import unquote
from xml.etree.ElementTree import Element

import tinycss2
from tinycss2.ast import FunctionBlock, URLToken

__all__ = [
    "LONGEST_VALUE",
    "PROPERTIES",
    "REFERENCE",
    "TooMuch",
    "clean",
    "declared",
    "note",
    "plain",
    "target",
    "told_by_sheets",
    "weighty",
    "written",
]

Token = Any  # a node of tinycss2: its `type` tells what it has
REFERENCE = re.compile(r"url\(#([^()]+)\)")  # as they are written here

PROPERTIES = frozenset(
    "alignment-baseline background background-color baseline-shift clip-path clip-rule color color-interpolation "
    "color-rendering direction "
    "display dominant-baseline fill fill-opacity fill-rule font font-family font-feature-settings font-kerning "
    "font-size font-size-adjust font-stretch font-style font-variant font-variant-caps font-variant-east-asian "
    "font-variant-ligatures font-variant-numeric font-variation-settings font-weight image-rendering isolation "
    "letter-spacing line-height marker marker-end marker-mid marker-start mask mask-type mix-blend-mode opacity "
    "overflow paint-order shape-rendering stop-color stop-opacity stroke stroke-dasharray stroke-dashoffset "
    "stroke-linecap stroke-linejoin stroke-miterlimit stroke-opacity stroke-width text-align text-anchor "
    "text-decoration text-decoration-color text-decoration-line text-decoration-style text-decoration-thickness "
    "text-indent text-orientation text-rendering text-transform transform transform-box transform-origin "
    "unicode-bidi vector-effect visibility white-space word-spacing writing-mode".split()
)
_FUNCTIONS = frozenset(
    "calc circle clamp color color-mix ellipse hsl hsla hwb inset lab lch light-dark matrix max min oklab oklch "
    "polygon rgb rgba rotate scale scalex scaley skewx skewy translate translatex translatey".split()
)
_TOKENS = frozenset(
    "comment dimension hash ident literal number percentage string unicode-range whitespace".split()
)
_NAMED = re.compile(r"#[^\s'\"()\\%<>;{}]+")
_LINKED = re.compile(r"#[^\s'\"\\%<>;{}]+")  # by an attribute of its own, which nothing follows
_SCREENS = frozenset(("", "all", "screen", "only screen"))
# Properties that no child takes from its parent: asked for so, each child would draw its parent's target once more.
_ALONE = frozenset(("clip-path", "mask"))
_LENGTHS = re.compile(r"([\d.]+(?:e[+-]?\d+)?)(px|pt|pc|mm|cm|in)?", re.IGNORECASE)
# Letters that programs bring with them; what is never closed goes to the end, so nothing is looked at twice.
_DATA = re.compile(r"url\(\s*+[\"']?+data:[^)\"']*+", re.IGNORECASE)
_LEGAL = re.compile(r"[\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]*")  # what XML may hold
_KEY = re.compile(r"[A-Za-z][A-Za-z-]{0,30}")
_MOST_KEYS = 200  # that are told of
LONGEST_VALUE = 2_000
_WEIGHTY = frozenset("stroke-dasharray opacity mix-blend-mode isolation transform vector-effect".split())
# What SVG 2 lets styles say of a shape: left out, since what is drawn is weighed by the attributes.
_OF_SHAPES = frozenset("cx cy d height r rotate rx ry scale translate width x y".split())
_MOST_READ = 300_000  # characters of all sheets
_MOST_WEIGHED = 500_000  # parts of selectors, each for each element
_MOST_TOLD = 2_000_000  # characters of all classes


class TooMuch(Exception):
    """Few rules, but more work than any drawing is worth."""


@dataclass(frozen=True)
class Compound:
    """`path.seam#one`: a part of a selector; kind: "" for any."""

    kind: str = ""
    key: str = ""
    classes: frozenset[str] = frozenset()
    child: bool = False  # of the part before, not only somewhere below it

    def fits(self, element: Element, classes: frozenset[str]) -> bool:
        return (
            self.kind in ("", element.tag)
            and self.key in ("", element.get("id", ""))
            and self.classes <= classes
        )


@dataclass(frozen=True)
class Selected:
    """A rule by one selector. weight: specificity and place in the file."""

    parts: tuple[Compound, ...]
    weight: tuple[int, int, int, int]
    said: Mapping[str, str]  # property -> value
    stressed: Mapping[str, str]  # !important


def target(reference: str, *, linked: bool = False) -> str | None:
    """The name that "#name" refers to; None where it leads out of the file, or browsers would read it otherwise.

    linked: it stands alone, as href has it, where brackets end nothing.
    """
    name, names = unquote(reference.strip()), _LINKED if linked else _NAMED
    return name[1:] if names.fullmatch(name) and _LEGAL.fullmatch(name) else None


def note(left: Counter[str], key: str) -> None:
    """One more of what was left out, by a name that a page can show."""
    key = key[:20] if _KEY.fullmatch(key) else "…"
    left[key if key in left or len(left) < _MOST_KEYS else "…"] += 1


def plain(value: str) -> bool:
    """Whether an attribute's value asks for nothing, seen without reading it as CSS."""
    if "\\" in value or "/*" in value:
        return False
    return all(_called(before).lower() in _FUNCTIONS for before in value.split("(")[:-1])


def clean(name: str, tokens: Iterable[Token]) -> str | None:
    """A property's value; None: it asks for something beyond the file, or does what no drawing needs."""
    kept: list[Token] = [_clean(token) for token in tokens]
    if None in kept:
        return None
    value = tinycss2.serialize(kept).strip()
    if len(value) > LONGEST_VALUE or not _LEGAL.fullmatch(value):
        return None
    if name.startswith("background") and "url(" in value:  # nothing that draws; a plain colour is seen
        return None
    if name in _ALONE and value.lower() in ("inherit", "unset", "revert", "revert-layer"):
        return None
    return None if name == "stroke-dasharray" and not _dashes_known(value) else value


def declared(style: str | Sequence[Token], left: Counter[str]) -> tuple[dict[str, str], dict[str, str]]:
    """What a style attribute or a rule's block says, (as it is, as important). left: counts what was left out."""
    said: tuple[dict[str, str], dict[str, str]] = ({}, {})
    for one in tinycss2.parse_blocks_contents(style, skip_comments=True, skip_whitespace=True):
        if one.type != "declaration":
            note(left, "style")
        elif one.lower_name not in PROPERTIES:
            drew = one.lower_name in _OF_SHAPES or one.lower_name.endswith("filter")
            if drew or any(map(_asks, one.value)):
                note(left, one.lower_name)
        elif (value := clean(one.lower_name, one.value)) is None:
            note(left, one.lower_name)
        else:
            _say(said[one.important], one.lower_name, value)
    return said


def told_by_sheets(
    sheets: Iterable[tuple[str, str]], root: Element, left: Counter[str]
) -> tuple[dict[Element, list[tuple[str, str]]], str]:
    """What style sheets, (media, text), say of each element, and the sheet that says it by classes, which the elements
    now have. Raises TooMuch."""
    rules: list[Selected] = []
    read = number = 0
    for media, text in sheets:
        if _shown(media):
            text = _DATA.sub("url()", text)
            read += len(text)
            if read > _MOST_READ:
                raise TooMuch
            for rule in _rules(tinycss2.parse_stylesheet(text, True, True), left):
                rules += _selected(rule, number := number + 1, left)
    told: dict[Element, list[tuple[str, str]]] = {}
    classes: dict[str, str] = {}  # block -> class
    merged: dict[tuple[int, ...], tuple[str, list[tuple[str, str]]]] = {}  # rules -> class and what they say
    size = 0
    for element, matched in _Matches(rules).walk(root):
        element.attrib.pop("class", None)
        if not matched:
            continue
        key = tuple(sorted(map(id, matched)))
        if key not in merged:
            block, said = _merged(matched)
            size += 0 if block in classes else len(block)
            if size > _MOST_TOLD:
                raise TooMuch
            merged[key] = (block and classes.setdefault(block, f"c{len(classes) + 1}"), weighty(said))
        name, said = merged[key]
        if name:
            element.set("class", name)
            told[element] = said
    return told, "".join(f".{name}{{{block}}}\n" for block, name in classes.items())


def written(said: Mapping[str, str], stressed: Mapping[str, str]) -> str:
    """As a block or a style attribute has it."""
    lines = [f"{key}:{value}" for key, value in said.items()]
    return ";".join([*lines, *(f"{key}:{value}!important" for key, value in stressed.items())])


def weighty(said: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    """What of it decides how much is drawn."""
    return [
        (key, value)
        for key, value in said
        if key in _WEIGHTY or "url(" in value or "context-" in value.lower()
    ]


def _merged(matched: Iterable[Selected]) -> tuple[str, list[tuple[str, str]]]:
    said, stressed = dict[str, str](), dict[str, str]()
    for rule in sorted(matched, key=lambda one: one.weight):
        for whole, more in ((said, rule.said), (stressed, rule.stressed)):
            for key, value in more.items():
                _say(whole, key, value)
    return written(said, stressed), [*said.items(), *stressed.items()]


def _say(said: dict[str, str], key: str, value: str) -> None:
    """After all else: a later `font` speaks of what an earlier `font-size` said, and the other way round."""
    said.pop(key, None)
    said[key] = value


class _Matches:
    """The rules, by what the last part of their selector asks for, and how much has been weighed."""

    def __init__(self, rules: Iterable[Selected]) -> None:
        self.weighed = 0
        self.of: dict[str, list[Selected]] = defaultdict(list)
        for rule in rules:
            last = rule.parts[-1]
            one = next(iter(sorted(last.classes)), "")
            key = f"#{last.key}" if last.key else f".{one}" if one else last.kind or "*"
            self.of[key].append(rule)

    def walk(self, root: Element) -> Iterator[tuple[Element, list[Selected]]]:
        """Each element with the rules that are meant for it."""
        above: list[tuple[Element, frozenset[str]]] = []

        def visit(element: Element) -> Iterator[tuple[Element, list[Selected]]]:
            classes = frozenset(element.get("class", "").split())
            above.append((element, classes))
            keys = ("*", element.tag, f"#{element.get('id', '')}", *(f".{one}" for one in classes))
            rules = (rule for key in keys for rule in self.of.get(key, ()))
            matched = [
                rule for rule in rules if self._fits(rule.parts, len(rule.parts) - 1, above, len(above) - 1)
            ]
            # Below the element its classes are still asked for: it loses them when all below is seen.
            for child in element:
                yield from visit(child)
            above.pop()
            yield element, matched

        if self.of:
            yield from visit(root)
        else:
            yield from ((element, []) for element in root.iter())

    def _fits(
        self,
        parts: tuple[Compound, ...],
        k: int,
        above: Sequence[tuple[Element, frozenset[str]]],
        at: int,
    ) -> bool:
        self.weighed += 1
        if self.weighed > _MOST_WEIGHED:
            raise TooMuch
        if not parts[k].fits(*above[at]):
            return False
        if k == 0:
            return True
        reach = range(at - 1, at - 2, -1) if parts[k].child else range(at - 1, -1, -1)
        return any(self._fits(parts, k - 1, above, one) for one in reach if one >= 0)


def _shown(media: str) -> bool:
    return any(" ".join(one.lower().split()) in _SCREENS for one in media.split(","))


def _rules(rules: Iterable[Token], left: Counter[str]) -> Iterator[Token]:
    """Those of @media that mean a screen included."""
    for rule in rules:
        if rule.type == "qualified-rule":
            yield rule
        elif (
            rule.type == "at-rule"
            and rule.lower_at_keyword == "media"
            and rule.content is not None
            and _shown(tinycss2.serialize(rule.prelude))
        ):
            yield from _rules(tinycss2.parse_rule_list(rule.content, True, True), left)
        else:
            note(left, "at-rule" if rule.type == "at-rule" else "style")


def _selected(rule: Token, number: int, left: Counter[str]) -> Iterator[Selected]:
    said, stressed = declared(rule.content, left)
    selectors: list[list[Token]] = [[]]
    for token in rule.prelude:
        if token == ",":
            selectors.append([])
        elif token.type != "comment":
            selectors[-1].append(token)
    for selector in selectors:
        parts = _parts(selector)
        if parts is None:
            note(left, "style")
            continue
        keys = sum(bool(part.key) for part in parts)
        classes = sum(token == "." for token in selector)
        kinds = sum(bool(part.kind) for part in parts)
        yield Selected(parts, (keys, classes, kinds, number), said, stressed)


def _parts(selector: Sequence[Token]) -> tuple[Compound, ...] | None:
    """None: it selects by more than elements, classes and names, and what they lie in."""
    found: list[Compound] = []
    kind, key, classes, child, any_kind = "", "", set[str](), False, False
    tokens: list[Token] = [*selector, None]
    k = 0
    while k < len(tokens):
        token = tokens[k]
        if _ends(token) and (kind or key or classes or any_kind):
            found.append(Compound(kind, key, frozenset(classes), child))
            kind, key, classes, child, any_kind = "", "", set[str](), False, False
        if token is None or token.type == "whitespace":
            pass
        elif token == ">":
            if child or not found:
                return None
            child = True
        elif token == "*":
            any_kind = True
        elif token.type == "ident" and not (kind or key or classes):
            kind = token.value
        elif token.type == "hash" and token.is_identifier:
            key = token.value
        elif token == "." and getattr(tokens[k + 1], "type", "") == "ident":
            k += 1
            classes.add(tokens[k].value)
        else:
            return None
        k += 1
    return None if child or not found else tuple(found)


def _ends(token: Token | None) -> bool:
    return token is None or token.type == "whitespace" or token == ">"


def _clean(token: Token) -> Token | None:
    if token.type == "url":
        name = target(token.value)
    elif token.type == "function" and token.lower_name == "url":
        given = [one for one in token.arguments if one.type not in ("whitespace", "comment")]
        name = target(given[0].value) if len(given) == 1 and given[0].type == "string" else None
    elif token.type == "function":
        kept: list[Token] = [_clean(one) for one in token.arguments]
        if token.lower_name not in _FUNCTIONS or None in kept:
            return None
        return FunctionBlock(token.source_line, token.source_column, token.name, kept)
    else:
        return token if token.type in _TOKENS else None
    return None if name is None else URLToken(token.source_line, token.source_column, name, f"url(#{name})")


def _called(before: str) -> str:
    """The name that a bracket after these words calls; SVG lets blanks stand between them."""
    words = before.rstrip()
    k = len(words)
    while k and (words[k - 1].isalnum() or words[k - 1] in "_-"):
        k -= 1
    return words[k:]


def _asks(token: Token) -> bool:
    return token.type == "url" or (token.type == "function" and token.lower_name not in _FUNCTIONS)


def _dashes_known(value: str) -> bool:
    """Whether it is told how long dashes are: a share of a frame or of a letter may be of any length."""
    if value.lower() in ("none", "inherit", "initial"):
        return True
    return all(_LENGTHS.fullmatch(one) for one in value.replace(",", " ").split())
