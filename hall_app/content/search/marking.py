"""The words that were looked for, marked in a title or in an excerpt of a text."""

from __future__ import annotations

import re
from dataclasses import dataclass

from hall_app.content.search.terms import Query, folded, is_han, pairs_of

AROUND = 70  # characters ahead of the first found word; three times as many after it
STEM = 3  # letters that stay of an English word whose ending is taken off: gowns, woven cloths
_ENDING = re.compile(r"(?:ing|ed|es|s)$")


@dataclass(frozen=True)
class Marked:
    """A text in pieces: (words, whether they are what was looked for)."""

    pieces: tuple[tuple[str, bool], ...]

    @property
    def text(self) -> str:
        return "".join(words for words, _ in self.pieces)


def marked(text: str, query: Query) -> Marked:
    """The whole text with all that was found in it."""
    return Marked(tuple(_pieces(text, _spans(text, query))))


def excerpt(text: str, query: Query) -> Marked:
    """A part of the text round the first thing found in it; its beginning where nothing is found literally."""
    spans = _spans(text, query)
    wide = (
        1 if re.search(r"[a-z]{4}", text[:200]) is None else 2
    )  # Chinese says as much in half the characters
    first = spans[0][0] if spans else 0
    start = max(0, first - wide * AROUND // 2)
    end = min(len(text), start + 2 * wide * AROUND)
    start, end = _at_blanks(text, start, end)
    inside = [(max(a, start) - start, min(b, end) - start) for a, b in spans if a < end and b > start]
    pieces = list(_pieces(text[start:end], inside))
    if start > 0:
        pieces.insert(0, ("… ", False))
    if end < len(text):
        pieces.append((" …", False))
    return Marked(tuple(pieces))


def _at_blanks(text: str, start: int, end: int) -> tuple[int, int]:
    """The window moved inwards to blanks, a few characters at most, so that no word is cut."""
    if start > 0 and (blank := text.find(" ", start, start + 15)) >= 0:
        start = blank + 1
    if end < len(text) and (blank := text.rfind(" ", max(start, end - 15), end)) > start:
        end = blank
    return start, end


def _spans(text: str, query: Query) -> list[tuple[int, int]]:
    """Where parts of the question stand in the text as it is written, in order, none within another."""
    plain, origin = _with_origin(text)
    found: list[tuple[int, int]] = []
    for part in query.parts:
        if is_han(part):
            pattern = re.escape(part) if part in plain else "|".join(map(re.escape, pairs_of(part)))
        else:
            pattern = rf"(?<![^\W_]){re.escape(_stem(part))}[^\W_]*"
        for match in re.finditer(pattern, plain):
            if match.end() > match.start():
                found.append((origin[match.start()], origin[match.end() - 1] + 1))
    merged: list[tuple[int, int]] = []
    for start, end in sorted(found):
        if merged and start < merged[-1][1]:
            merged[-1] = (merged[-1][0], max(end, merged[-1][1]))
        else:
            merged.append((start, end))
    return merged


def _stem(word: str) -> str:
    short = _ENDING.sub("", word)
    return short if len(short) >= STEM else word


def _with_origin(text: str) -> tuple[str, list[int]]:
    """The text folded, and of each of its characters the place of the one it came from."""
    plain: list[str] = []
    origin: list[int] = []
    for place, character in enumerate(text):
        for one in folded(character):
            plain.append(one)
            origin.append(place)
    return "".join(plain), origin


def _pieces(text: str, spans: list[tuple[int, int]]) -> list[tuple[str, bool]]:
    pieces: list[tuple[str, bool]] = []
    done = 0
    for start, end in spans:
        if start > done:
            pieces.append((text[done:start], False))
        pieces.append((text[start:end], True))
        done = end
    if done < len(text):
        pieces.append((text[done:], False))
    return pieces
