"""Where answers are kept: SQLite by default, PostgreSQL by URL.

From below: `database`, `answers` as they are read, `commit` as they are written, the `audit` of what was done,
`tokens`, what is public (`publication`), `erasure`, and the `Store` that brings them together. `migrations` is the
schema's history.
"""

from survey.store.answers import Archive, Given, Stored
from survey.store.audit import Audit
from survey.store.commit import Receipt
from survey.store.erasure import Overdue
from survey.store.publication import Public
from survey.store.store import PATIENCE, Store, existing_store
from survey.store.tokens import TOKEN_DAYS, Token, Tokens

__all__ = [
    "PATIENCE",
    "TOKEN_DAYS",
    "Archive",
    "Audit",
    "Given",
    "Overdue",
    "Public",
    "Receipt",
    "Store",
    "Stored",
    "Token",
    "Tokens",
    "existing_store",
]
