"""The first tables of people."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None

ROLES = "role IN ('editor', 'curator', 'researcher', 'administrator')"


def upgrade() -> None:
    op.create_table(
        "user",
        sa.Column("id", sa.String(16), primary_key=True),
        sa.Column("address", sa.String(254), nullable=False, unique=True),
        sa.Column("name", sa.String(80), nullable=False),
        sa.Column("language", sa.String(2), nullable=False),
        sa.Column("password", sa.String(200)),
        sa.Column("made", sa.DateTime(timezone=True), nullable=False),
        sa.Column("verified", sa.DateTime(timezone=True)),
        sa.Column("closed", sa.DateTime(timezone=True)),
        sa.Column("authenticator", sa.String(64)),
        sa.Column("step", sa.Integer),
    )
    op.create_table(
        "role",
        sa.Column("user", sa.String(16), sa.ForeignKey("user.id"), primary_key=True),
        sa.Column("role", sa.String(16), primary_key=True),
        sa.Column("given", sa.DateTime(timezone=True), nullable=False),
        sa.CheckConstraint(ROLES, name="role_known"),
    )
    op.create_table(
        "session",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("digest", sa.String(64), nullable=False, unique=True),
        sa.Column("user", sa.String(16), sa.ForeignKey("user.id"), nullable=False),
        sa.Column("office", sa.Integer, nullable=False),
        sa.Column("made", sa.DateTime(timezone=True), nullable=False),
        sa.Column("expires", sa.DateTime(timezone=True), nullable=False),
    )
    op.create_index("session_by_user", "session", ["user"])
    op.create_table(
        "code",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("digest", sa.String(64), nullable=False, unique=True),
        sa.Column("user", sa.String(16), sa.ForeignKey("user.id"), nullable=False),
        sa.Column("purpose", sa.String(8), nullable=False),
        sa.Column("expires", sa.DateTime(timezone=True)),
    )
    op.create_index("code_by_user", "code", ["user"])
    op.create_table(
        "audit",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("who", sa.String(16), nullable=False),
        sa.Column("act", sa.String(32), nullable=False),
        sa.Column("subject", sa.String(200), nullable=False),
        sa.Column("refused", sa.Integer, nullable=False),
    )


def downgrade() -> None:
    for name in ("audit", "code", "session", "role", "user"):
        op.drop_table(name)
