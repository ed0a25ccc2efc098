"""The index: SQLite FTS5 in memory."""

from __future__ import annotations

import sqlite3
import threading
from collections.abc import Iterable
from dataclasses import dataclass

from hall_app.content.search.entries import KINDS, Entry
from hall_app.content.search.terms import Query, indexed

MOST = 50  # things that are told of
_TITLE, _WORDS, _TEXT = 8.0, 8.0, 1.0  # what a find weighs where it stands
_SCHEMA = "CREATE VIRTUAL TABLE entry USING fts5(title, words, text, tokenize='porter unicode61 remove_diacritics 2')"
_ASK = f"SELECT rowid, bm25(entry, {_TITLE}, {_WORDS}, {_TEXT}) FROM entry WHERE entry MATCH ? ORDER BY 2"


@dataclass(frozen=True)
class Found:
    """A thing that was found: as it is called in the asked language, and the entry in which it was found."""

    shown: Entry
    entry: Entry


@dataclass(frozen=True)
class Findings:
    """best: MOST of what was found; number: of all that was."""

    best: tuple[Found, ...] = ()
    number: int = 0


class SearchIndex:
    """An index of entries that do not change. Any thread may ask."""

    def __init__(self, entries: Iterable[Entry]) -> None:
        self._entries = tuple(entries)
        self._of = {(e.kind, e.id, e.lang): e for e in self._entries}
        self._asking = threading.Lock()
        self._base = sqlite3.connect(":memory:", check_same_thread=False)
        self._base.execute(_SCHEMA)
        rows = ((k, indexed(e.title), indexed(e.words), indexed(e.text)) for k, e in enumerate(self._entries))
        self._base.executemany("INSERT INTO entry(rowid, title, words, text) VALUES (?, ?, ?, ?)", rows)

    def find(self, query: Query, lang: str) -> Findings:
        """What holds all that is asked for, the best first; where nothing does, what holds any of it.

        A thing is found in either language and told once, in `lang` where the two serve alike.
        """
        if not query.parts:
            return Findings()
        ranked = self._ranked(query.match()) or self._ranked(query.match(every=False))
        best: dict[tuple[str, str], tuple[float, Entry]] = {}
        for row, score in ranked:
            entry = self._entries[row]
            score -= 0.5 if entry.lang == lang else 0.0  # bm25: the smaller, the better
            key = (entry.kind, entry.id)
            if key not in best or score < best[key][0]:
                best[key] = (score, entry)
        ordered = sorted(best.values(), key=lambda one: (one[0], KINDS.index(one[1].kind), one[1].id))
        shown = tuple(Found(self._of.get((e.kind, e.id, lang), e), e) for _, e in ordered[:MOST])
        return Findings(shown, len(ordered))

    def _ranked(self, match: str) -> list[tuple[int, float]]:
        with self._asking:
            return self._base.execute(_ASK, (match,)).fetchall()

    def close(self) -> None:
        self._base.close()
