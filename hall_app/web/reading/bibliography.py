"""The papers of the research page as BibTeX, which every reference manager reads."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable

from hall_app.content.schema.research import Citation, Paper

__all__ = ["bibliography"]

_SPECIAL = {letter: f"\\{letter}" for letter in "&%$#_"} | {
    "{": r"\textbraceleft{}",  # an escaped brace would still count as one
    "}": r"\textbraceright{}",
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
}
_PLAIN = ("doi", "url")  # an address is taken as it stands


def bibliography(papers: Iterable[Paper]) -> str:
    """An entry for each paper whose citation is known, in UTF-8."""
    entries, names = [], set[str]()
    for paper in papers:
        if paper.cite is not None:
            name = _free(_name(paper.cite), names)
            names.add(name)
            entries.append(_entry(name, paper.cite, paper.url))
    return "\n".join(entries)


def _entry(name: str, cite: Citation, url: str | None) -> str:
    told = {
        "author": " and ".join(cite.author),
        "title": cite.title,
        "journal": cite.journal,
        "year": str(cite.year),
        "volume": cite.volume,
        "number": cite.number,
        "pages": cite.pages,
        "doi": cite.doi,
        "url": url,
    }
    lines = "".join(
        f"  {key} = {{{text if key in _PLAIN else _escaped(text)}}},\n" for key, text in told.items() if text
    )
    return f"@article{{{name},\n{lines}}}\n"


def _escaped(text: str) -> str:
    return "".join(_SPECIAL.get(letter, letter) for letter in " ".join(text.split()))


def _name(cite: Citation) -> str:
    """The first author's family name in ASCII letters, and the year."""
    family = unicodedata.normalize("NFKD", cite.author[0].partition(",")[0])
    letters = "".join(letter for letter in family if letter.isascii() and letter.isalpha())
    return f"{letters.lower() or 'paper'}{cite.year}"


def _free(name: str, names: set[str]) -> str:
    number = 1
    while (found := f"{name}-{number}" if number > 1 else name) in names:
        number += 1
    return found
