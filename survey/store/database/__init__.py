"""The database itself: `tables` and how it is opened, `schema` and the `lineage` that leads to it, its `place` on the
disk, `backup`.

`permissions` sees that what is written is its owner's alone, `sessions` are what the store's parts work with; `tables`
is handed out as a whole: `tables.answer`, …
"""

from survey.store.database import tables
from survey.store.database.backup import ANSWERS, Schema, see_that_it_takes, take_copy, write_copy
from survey.store.database.lineage import Lineage
from survey.store.database.permissions import make_private, take_rights
from survey.store.database.place import Place, explained
from survey.store.database.schema import HEAD
from survey.store.database.sessions import Session, in_utc, now
from survey.store.database.tables import open_engine

__all__ = [
    "ANSWERS",
    "HEAD",
    "Lineage",
    "Place",
    "Schema",
    "Session",
    "explained",
    "in_utc",
    "make_private",
    "now",
    "open_engine",
    "see_that_it_takes",
    "tables",
    "take_copy",
    "take_rights",
    "write_copy",
]
