"""Where answers are kept: SQLite by default, PostgreSQL by URL."""

from survey.store.store import Receipt, Store, Stored
from survey.store.tokens import Tokens

__all__ = ["Receipt", "Store", "Stored", "Tokens"]
