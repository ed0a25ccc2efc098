"""Where answers are kept: SQLite by default, PostgreSQL by URL."""

from survey.store.committing import Receipt
from survey.store.store import Store, Stored
from survey.store.tokens import Tokens

__all__ = ["Receipt", "Store", "Stored", "Tokens"]
