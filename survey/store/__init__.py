"""Where answers are kept: SQLite by default, PostgreSQL by URL."""

from survey.store.committing import Receipt
from survey.store.publishing import Public
from survey.store.removal import Overdue
from survey.store.store import PATIENCE, Store
from survey.store.stored import Stored
from survey.store.tokens import Tokens

__all__ = ["PATIENCE", "Overdue", "Public", "Receipt", "Store", "Stored", "Tokens"]
