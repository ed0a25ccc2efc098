"""Texts in Chinese: the English text of a problem is the key by which its Chinese one is found, as gettext does."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

__all__ = ["catalogue", "in_language"]

_FILE = Path(__file__).with_name("zh.toml")
_GAP, _FIRST = "{}", "around"
_FILLED = re.compile(r"\{(\d)(:zh)?\}")
_DEEPEST = 8  # texts in texts; what somebody wrote in a file could look like any number of them


@dataclass(frozen=True)
class _Template:
    """letters: what stands before, between and after the gaps of the English text; chinese: with {0}, {1:zh}."""

    letters: tuple[str, ...]
    chinese: str

    def values(self, text: str) -> list[str] | None:
        """What fills the gaps where the whole text is one of these, each as short as can be; None where it is not.

        Looking for one piece after the other takes time in proportion to the text, whatever somebody wrote in a file.
        """
        first, *more = self.letters
        if not more:
            return [] if text == first else None
        *between, last = more
        at, end = len(first), len(text) - len(last)
        if at > end or not (text.startswith(first) and text.endswith(last)):
            return None
        found = []
        for piece in between:
            begin = text.find(piece, at, end)
            if begin < 0:
                return None
            found.append(text[at:begin])
            at = begin + len(piece)
        return [*found, text[at:end]]


def in_language(text: str, language: str) -> str:
    """A problem's text or remedy, or one that was put together of such; what the catalogue does not know is English."""
    return _chinese(text) if language == "zh" else text


@cache
def catalogue() -> Mapping[str, Mapping[str, str]]:
    """The tables of zh.toml: English text -> Chinese text."""
    return tomllib.loads(_FILE.read_text("utf-8"))


@cache
def _templates() -> tuple[tuple[_Template, ...], Mapping[str, str]]:
    """Those with gaps in the order in which they are tried; the whole texts."""
    tables, gaps, whole = catalogue(), [], {}
    for name, table in tables.items():
        for english, chinese in table.items():
            letters = tuple(english.split(_GAP))
            if len(letters) == 1:
                whole[english] = chinese
            else:
                gaps.append((name != _FIRST, -sum(map(len, letters)), _Template(letters, chinese)))
    return tuple(template for *_, template in sorted(gaps, key=lambda one: one[:2])), whole


def _chinese(text: str, depth: int = 0) -> str:
    gaps, whole = _templates()
    if text in whole:
        return whole[text]
    for template in gaps if depth < _DEEPEST else ():
        if (values := template.values(text)) is not None:
            return _filled(template.chinese, values, depth)
    return text


def _filled(chinese: str, values: list[str], depth: int) -> str:
    def value(gap: re.Match[str]) -> str:
        found = values[int(gap[1])]
        return _chinese(found, depth + 1) if gap[2] else found

    return _FILLED.sub(value, chinese)
