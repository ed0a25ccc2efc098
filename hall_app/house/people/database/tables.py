"""The tables of people: who has an account, who is signed in, who is what, who did what.

They stand apart from the answers: a copy of the answers names nobody, and nothing leads from a person to an answer but
the codes in `answer_code`, which he asked to have kept.
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
    Text,
    UniqueConstraint,
)

__all__ = [
    "answer_code",
    "audit",
    "booking",
    "code",
    "favourite",
    "followup",
    "look",
    "metadata",
    "occasion",
    "revision",
    "role",
    "session",
    "spent_form",
    "user",
]

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
    # The name as people are searched: SQLite's own `lower` knows A to Z, PostgreSQL's what its locale does, none ß.
    Column("name_folded", Text, nullable=False, server_default=""),
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

# That an exhibit was looked at closely, by the day and no finer; only of who asked for it. No row of the journal tells
# of it, and the order of rows is none of looking: `Keepsakes.note_look` writes a day's rows anew, by exhibit.
look = Table(
    "look",
    metadata,
    Column("user", ForeignKey("user.id"), primary_key=True),
    Column("exhibit", String(64), primary_key=True),
    Column("day", Date, primary_key=True),
)

# The withdrawal code of an answer; only of who asked in so many words that the account keep it, since it links the two.
answer_code = Table(
    "answer_code",
    metadata,
    Column("user", ForeignKey("user.id"), primary_key=True),
    Column("code", String(36), primary_key=True),
    Column("made", DateTime(timezone=True), nullable=False),
)

# What has places: an activity, or a slot of a day for visits. `taken` counts the places that are booked; `turns` is the
# number given last, so that the order of the waiting list is that of the lock on this row and of nothing else.
occasion = Table(
    "occasion",
    metadata,
    Column("id", String(16), primary_key=True),
    Column("kind", String(8), nullable=False),
    Column("title_zh", String(120), nullable=False),
    Column("title_en", String(120), nullable=False),
    Column("text_zh", Text, nullable=False),
    Column("text_en", Text, nullable=False),
    Column("place_zh", String(120), nullable=False),
    Column("place_en", String(120), nullable=False),
    Column("begins", DateTime(timezone=True), nullable=False),
    Column("ends", DateTime(timezone=True), nullable=False),
    Column("places", Integer, nullable=False),
    Column("party", Integer, nullable=False),  # the most that one booking may be for
    Column("taken", Integer, nullable=False),
    Column("turns", Integer, nullable=False),
    Column("cancelled", DateTime(timezone=True)),
    CheckConstraint("taken >= 0 AND taken <= places", name="occasion_not_overbooked"),
    CheckConstraint("kind IN ('activity', 'visit')", name="occasion_kind_known"),
)

booking = Table(
    "booking",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("occasion", ForeignKey("occasion.id"), nullable=False),
    Column("user", ForeignKey("user.id"), nullable=False),
    Column("size", Integer, nullable=False),
    Column("party", String(80), nullable=False),  # name of a class or group; "" for none
    Column("waiting", Integer, nullable=False),  # 1: on the waiting list, 0: has its places
    Column("turn", Integer, nullable=False),
    Column("key", String(64), nullable=False),  # of the form: sent twice it is the same booking
    Column("made", DateTime(timezone=True), nullable=False),
    Column("arrived", DateTime(timezone=True)),
    UniqueConstraint("occasion", "user", name="booking_once"),
)

# Keys of forms whose booking was cancelled: sent again, such a form books nothing.
spent_form = Table(
    "spent_form",
    metadata,
    Column("user", ForeignKey("user.id"), primary_key=True),
    Column("occasion", ForeignKey("occasion.id"), primary_key=True),
    Column("key", String(64), primary_key=True),
)

# What became of a suggestion of the questionnaires. `id` is its answer's pseudonym and the module: never the withdrawal
# code, by which whoever reads this could take the answer back; `by` is a person's id.
followup = Table(
    "followup",
    metadata,
    Column("id", String(110), primary_key=True),
    Column("state", String(8), nullable=False),
    Column("note", String(400), nullable=False),
    Column("by", String(16), nullable=False),
    Column("at", DateTime(timezone=True), nullable=False),
)

# What was published of the collection. `files` is JSON, name -> digests before and after; the files lie in the data
# folder, named by these digests, and a restored house without them has the table all the same.
revision = Table(
    "revision",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("exhibit", String(64), nullable=False),
    Column("at", DateTime(timezone=True), nullable=False),
    Column("who", String(16), nullable=False),
    Column("act", String(8), nullable=False),
    Column("files", Text, nullable=False),
)
Index("revision_by_exhibit", revision.c.exhibit)

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
