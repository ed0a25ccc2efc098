"""Where answers are kept: SQLite by default, PostgreSQL by URL."""

from survey.store.committing import Receipt
from survey.store.store import Store, Stored
from survey.store.tally import Count, Tally
from survey.store.tokens import Tokens

__all__ = ["Count", "Receipt", "Store", "Stored", "Tally", "Tokens"]
