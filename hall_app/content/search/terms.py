"""Text and questions as terms: Latin words folded, Chinese by pairs of characters, so that 褙子 is found in 一件褙子.

A run of Chinese characters becomes all pairs of neighbours and its last character: 素纱襌衣 → 素纱 纱襌 襌衣 衣. So a
single character is found as the beginning of a term, and a longer word as pairs that follow each other.
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass

LONGEST = 200  # characters of a question that are looked at
MOST_TERMS = 16
HAN = "\u3400-\u4dbf\u4e00-\u9fff\uf900-\ufaff\U00020000-\U0003134f"
_PART = re.compile(rf"[{HAN}]+|[^\W_{HAN}]+")
_IS_HAN = re.compile(rf"^[{HAN}]")


def folded(text: str) -> str:
    """Small letters without accents, compatibility forms as plain ones: Kāsī → kasi, ＡＢ → ab."""
    apart = unicodedata.normalize("NFKD", text.casefold())
    return unicodedata.normalize("NFC", "".join(c for c in apart if not unicodedata.combining(c)))


def is_han(part: str) -> bool:
    """Whether it is a run of Chinese characters."""
    return bool(_IS_HAN.match(part))


def parts_of(text: str) -> list[str]:
    """The words and the runs of Chinese characters of a text, folded, in order."""
    return _PART.findall(folded(text))


def indexed(text: str) -> str:
    """The text as the index holds it: terms with blanks between."""
    terms: list[str] = []
    for part in parts_of(text):
        if is_han(part):
            terms += [part[k : k + 2] for k in range(len(part))]  # the last one is a single character
        else:
            terms.append(part)
    return " ".join(terms)


@dataclass(frozen=True)
class Query:
    """What somebody looks for. parts: words and runs of Chinese characters, folded, each once."""

    parts: tuple[str, ...]

    @staticmethod
    def of(text: str) -> Query:
        """Of any text whatever: what is no letter and no number asks for nothing; the end of a very long one is cut."""
        return Query(tuple(dict.fromkeys(parts_of(text[:LONGEST])))[:MOST_TERMS])

    def match(self, *, every: bool = True) -> str:
        """The question in the index's language: all parts, or (not every) any of them, also a pair out of a run.

        "" where nothing is asked.

        Parts hold letters and numbers alone and stand between quotation marks, so no word is an operator.
        """
        if every:
            return " AND ".join(_phrase(part) for part in self.parts)
        return " OR ".join(_phrase(piece) for part in self.parts for piece in pairs_of(part))


def pairs_of(part: str) -> list[str]:
    """All pairs of neighbours in a run of Chinese characters; a word, and a single character, as it is."""
    if not is_han(part) or len(part) < 3:
        return [part]
    return [part[k : k + 2] for k in range(len(part) - 1)]


def _phrase(part: str) -> str:
    if is_han(part):
        if len(part) == 1:
            return f'"{part}" *'
        return '"' + " ".join(part[k : k + 2] for k in range(len(part) - 1)) + '"'
    return f'"{part}" *' if len(part) > 1 else f'"{part}"'
