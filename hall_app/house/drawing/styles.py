"""What style sheets and style attributes say of a drawing's elements: the properties that draw, from the file alone.

tinycss2 reads them, escapes and comments included.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence, Set
from typing import Any
from urllib.parse import unquote

import tinycss2
from tinycss2.ast import FunctionBlock, URLToken

__all__ = [
    "LONGEST_VALUE",
    "PROPERTIES",
    "REFERENCE",
    "clean",
    "declared",
    "note",
    "plain",
    "say",
    "target",
    "weighty",
    "written",
]

Token = Any  # a node of tinycss2: its `type` tells what it has
REFERENCE = re.compile(r"url\(#([^()]+)\)")  # as they are written here

PROPERTIES = frozenset(
    "alignment-baseline background background-color baseline-shift clip-path clip-rule color color-interpolation "
    "color-rendering direction "
    "display dominant-baseline fill fill-opacity fill-rule font font-family font-feature-settings font-kerning "
    "font-size font-stretch font-style font-variant font-variant-caps font-variant-east-asian "
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
# Properties that no child takes from its parent: asked for so, each child would draw its parent's target once more.
_ALONE, _TAKEN = frozenset(("clip-path", "mask")), frozenset(("inherit", "unset", "revert", "revert-layer"))
_LENGTHS = re.compile(r"([\d.]+(?:e[+-]?\d+)?)(px|pt|pc|mm|cm|in)?", re.IGNORECASE)
_LEGAL = re.compile(r"[\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]*")  # what XML may hold
_KEY = re.compile(r"[A-Za-z][A-Za-z-]{0,30}")
_MOST_KEYS = 200  # that are told of
LONGEST_VALUE = 2_000
_REFERRING = frozenset("fill stroke marker marker-start marker-mid marker-end mask clip-path".split())
_WEIGHTY = frozenset(
    "stroke-dasharray stroke-width opacity mix-blend-mode isolation transform vector-effect font font-size "
    "text-decoration text-decoration-line".split()
)
# What SVG 2 lets styles say of a shape: left out, since what is drawn is weighed by the attributes.
_OF_SHAPES = frozenset("cx cy d height r rotate rx ry scale translate width x y".split())


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
    kept: list[Token] = [_clean(token) for token in _stripped(tokens)]
    if None in kept:
        return None
    value = tinycss2.serialize(kept)
    if len(value) > LONGEST_VALUE or not _LEGAL.fullmatch(value):
        return None
    if "url(" in value and name not in _REFERRING:
        return None
    # One mask and one clip: each of a list is drawn as large as what it hides.
    if name in _ALONE and (value.count("url(") > 1 or value.lower() in _TAKEN):
        return None
    return None if name == "stroke-dasharray" and not _dashes_known(value) else value


def declared(
    style: str | Sequence[Token], left: Counter[str], known: Set[str]
) -> tuple[dict[str, str], dict[str, str]]:
    """What a style attribute or a rule's block says of known properties, (as it is, as important). left: counts what
    was left out."""
    said: tuple[dict[str, str], dict[str, str]] = ({}, {})
    for one in tinycss2.parse_blocks_contents(style, skip_comments=True, skip_whitespace=True):
        if one.type != "declaration":
            note(left, "style")
        elif one.lower_name not in known:
            drew = one.lower_name in PROPERTIES | _OF_SHAPES or one.lower_name.endswith("filter")
            if drew or any(map(_asks, one.value)):
                note(left, one.lower_name)
        elif not (value := clean(one.lower_name, one.value)):  # nothing is no value, either
            note(left, one.lower_name)
        else:
            say(said[one.important], one.lower_name, value)
    return said


def written(said: Mapping[str, str], stressed: Mapping[str, str]) -> str:
    """As a block or a style attribute has it."""
    lines = [f"{key}:{value}" for key, value in said.items()]
    return ";".join([*lines, *(f"{key}:{value}!important" for key, value in stressed.items())])


def weighty(said: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    """What of it decides how much is drawn."""
    return [
        (key, value)
        for key, value in said
        if key in _WEIGHTY or (key in _REFERRING and ("url(" in value or "context-" in value.lower()))
    ]


def say(said: dict[str, str], key: str, value: str) -> None:
    """After all else: a later `font` speaks of what an earlier `font-size` said, and the other way round."""
    said.pop(key, None)
    said[key] = value


def _stripped(tokens: Iterable[Token]) -> list[Token]:
    """Without blanks at both ends: of their text, one may belong to an escape."""
    left = list(tokens)
    for _ in range(2):
        while left and left[-1].type in ("whitespace", "comment"):
            left.pop()
        left.reverse()
    return left


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
        # A backslash that hides nothing would hide what is written after it here.
        return token if token.type in _TOKENS and token != "\\" else None
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
