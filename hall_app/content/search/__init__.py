"""Search over what a hall tells, in both languages: SQLite's full-text index, in memory, made anew with the content.

Content lies in files whichever database the answers are in, so one index serves beside SQLite and PostgreSQL alike.
terms: what is looked for in a text, Chinese by pairs of characters; marking: found words in an excerpt; entries: what
there is to find; index: the index itself.
"""

from hall_app.content.search.entries import KINDS, Entry, entries_of
from hall_app.content.search.index import MOST, Findings, Found, SearchIndex
from hall_app.content.search.marking import Marked, excerpt, marked
from hall_app.content.search.terms import LONGEST, Query, indexed

__all__ = [
    "KINDS",
    "LONGEST",
    "MOST",
    "Entry",
    "Findings",
    "Found",
    "Marked",
    "Query",
    "SearchIndex",
    "entries_of",
    "excerpt",
    "indexed",
    "marked",
]
