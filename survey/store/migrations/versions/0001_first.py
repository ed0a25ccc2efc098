"""The tables as version 0.1.0 made them."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None


def upgrade() -> None:
    op.create_table(
        "version",
        sa.Column("questionnaire", sa.String(64), primary_key=True),
        sa.Column("version", sa.Integer, primary_key=True),
        sa.Column("digest", sa.String(64), nullable=False),
        sa.Column("document", sa.JSON, nullable=False),
    )
    op.create_table(
        "submission",
        sa.Column("id", sa.String(36), primary_key=True),
        sa.Column("questionnaire", sa.String(64), nullable=False),
        sa.Column("version", sa.Integer, nullable=False),
        sa.Column("language", sa.String(2), nullable=False),
        sa.Column("exhibit", sa.String(64)),
        sa.Column("digest", sa.String(64), nullable=False),
        sa.Column("received", sa.DateTime(timezone=True), nullable=False),
        sa.Column("withdrawn", sa.DateTime(timezone=True)),
    )
    op.create_index("submission_by_questionnaire", "submission", ["questionnaire", "version"])
    for name, key, value in (
        ("answer", "item", sa.Column("score", sa.Integer)),
        ("suggestion", "module", sa.Column("text", sa.Text, nullable=False)),
    ):
        op.create_table(
            name,
            sa.Column("submission", sa.ForeignKey("submission.id"), primary_key=True),
            sa.Column(key, sa.String(64), primary_key=True),
            value,
        )
    op.create_table(
        "token",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("label", sa.String(200), nullable=False),
        sa.Column("digest", sa.String(64), nullable=False, unique=True),
        sa.Column("made", sa.DateTime(timezone=True), nullable=False),
    )


def downgrade() -> None:
    for name in ("token", "suggestion", "answer", "submission", "version"):
        op.drop_table(name)
