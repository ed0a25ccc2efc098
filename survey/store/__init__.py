"""Where answers are kept: SQLite by default, PostgreSQL by URL."""

from survey.store.answers.rows import Stored
from survey.store.commit.batch import Receipt
from survey.store.erasure.removal import Overdue
from survey.store.publication.steps import Public
from survey.store.store import PATIENCE, Store
from survey.store.tokens import Tokens

__all__ = ["PATIENCE", "Overdue", "Public", "Receipt", "Store", "Stored", "Tokens"]
