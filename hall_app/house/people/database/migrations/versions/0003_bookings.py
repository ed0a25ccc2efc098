"""Activities, visits, who booked them; what became of suggestions."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade() -> None:
    op.create_table(
        "occasion",
        sa.Column("id", sa.String(16), primary_key=True),
        sa.Column("kind", sa.String(8), nullable=False),
        sa.Column("title_zh", sa.String(120), nullable=False),
        sa.Column("title_en", sa.String(120), nullable=False),
        sa.Column("text_zh", sa.Text, nullable=False),
        sa.Column("text_en", sa.Text, nullable=False),
        sa.Column("place_zh", sa.String(120), nullable=False),
        sa.Column("place_en", sa.String(120), nullable=False),
        sa.Column("begins", sa.DateTime(timezone=True), nullable=False),
        sa.Column("ends", sa.DateTime(timezone=True), nullable=False),
        sa.Column("places", sa.Integer, nullable=False),
        sa.Column("party", sa.Integer, nullable=False),
        sa.Column("taken", sa.Integer, nullable=False),
        sa.Column("turns", sa.Integer, nullable=False),
        sa.Column("cancelled", sa.DateTime(timezone=True)),
        sa.CheckConstraint("taken >= 0 AND taken <= places", name="occasion_not_overbooked"),
        sa.CheckConstraint("kind IN ('activity', 'visit')", name="occasion_kind_known"),
    )
    op.create_table(
        "booking",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("occasion", sa.String(16), sa.ForeignKey("occasion.id"), nullable=False),
        sa.Column("user", sa.String(16), sa.ForeignKey("user.id"), nullable=False),
        sa.Column("size", sa.Integer, nullable=False),
        sa.Column("party", sa.String(80), nullable=False),
        sa.Column("waiting", sa.Integer, nullable=False),
        sa.Column("turn", sa.Integer, nullable=False),
        sa.Column("key", sa.String(64), nullable=False),
        sa.Column("made", sa.DateTime(timezone=True), nullable=False),
        sa.Column("arrived", sa.DateTime(timezone=True)),
        sa.UniqueConstraint("occasion", "user", name="booking_once"),
    )
    op.create_table(
        "followup",
        sa.Column("id", sa.String(110), primary_key=True),
        sa.Column("state", sa.String(8), nullable=False),
        sa.Column("note", sa.String(400), nullable=False),
        sa.Column("by", sa.String(16), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
    )


def downgrade() -> None:
    op.drop_table("followup")
    op.drop_table("booking")
    op.drop_table("occasion")
