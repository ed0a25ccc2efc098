"""The tables of people: who has an account, who is signed in, who is what, who did what.

They stand apart from the answers: a copy of the answers names nobody, and no key leads from one to the other.
"""

from __future__ import annotations

from sqlalchemy import (
    CheckConstraint,
    Column,
    Date,
    DateTime,
    ForeignKey,
    Index,
    Integer,
    MetaData,
    String,
    Table,
)

__all__ = ["audit", "code", "favourite", "look", "metadata", "role", "session", "user"]

metadata = MetaData()

# `id` is random and names the person in the journal; the address stands here and nowhere else.
user = Table(
    "user",
    metadata,
    Column("id", String(16), primary_key=True),
    Column("address", String(254), nullable=False, unique=True),  # as compared: case folded
    Column("name", String(80), nullable=False),
    Column("language", String(2), nullable=False),
    Column("password", String(200)),  # argon2 hash; null: none yet, a code opens the account
    Column("made", DateTime(timezone=True), nullable=False),
    Column("verified", DateTime(timezone=True)),
    Column("closed", DateTime(timezone=True)),  # by an administrator
    Column("authenticator", String(64)),  # the secret shared with an app; null: no second factor
    Column("step", Integer),  # the last half minute whose code was used: none is good twice
    Column("keeps_looks", Integer, nullable=False, server_default="0"),  # 1: asked that visits be kept
)

role = Table(
    "role",
    metadata,
    Column("user", ForeignKey("user.id"), primary_key=True),
    Column("role", String(16), primary_key=True),
    Column("given", DateTime(timezone=True), nullable=False),
    CheckConstraint("role IN ('editor', 'curator', 'researcher', 'administrator')", name="role_known"),
)

session = Table(
    "session",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("digest", String(64), nullable=False, unique=True),
    Column("user", ForeignKey("user.id"), nullable=False),
    Column("office", Integer, nullable=False),  # 1: of the office, 0: of a visitor
    Column("made", DateTime(timezone=True), nullable=False),
    Column("expires", DateTime(timezone=True), nullable=False),
)
Index("session_by_user", session.c.user)

# One-time codes: "open" opens the account (verifies it, sets a password), "recovery" stands in for the authenticator.
code = Table(
    "code",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("digest", String(64), nullable=False, unique=True),
    Column("user", ForeignKey("user.id"), nullable=False),
    Column("purpose", String(8), nullable=False),
    Column("expires", DateTime(timezone=True)),
)
Index("code_by_user", code.c.user)

# What a person keeps for himself. `exhibit` is its id in the content folder, which may lose it: so it is no key.
favourite = Table(
    "favourite",
    metadata,
    Column("user", ForeignKey("user.id"), primary_key=True),
    Column("exhibit", String(64), primary_key=True),
    Column("made", DateTime(timezone=True), nullable=False),
)

# That an exhibit was looked at closely, by the day and no finer; only of who asked for it.
look = Table(
    "look",
    metadata,
    Column("user", ForeignKey("user.id"), primary_key=True),
    Column("exhibit", String(64), primary_key=True),
    Column("day", Date, primary_key=True),
)

# `who` and `subject` are ids, never addresses: once an account is gone they lead to nobody. So they are no keys.
audit = Table(
    "audit",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("at", DateTime(timezone=True), nullable=False),
    Column("who", String(16), nullable=False),
    Column("act", String(32), nullable=False),
    Column("subject", String(200), nullable=False),
    Column("refused", Integer, nullable=False),
)
