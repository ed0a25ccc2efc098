"""Public figures published in steps, and kept.

Earlier releases showed exact means of all that stood. A first step over all of it and one answer more, against the
last exact mean, would tell that answer: so what stands is published here and now, as that release showed it.
"""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"

INDEX, TABLE = "submission_by_questionnaire", "submission"
LEAST = 10  # scores from which on a figure is seen


def upgrade() -> None:
    op.add_column(TABLE, sa.Column("counted", sa.Integer))
    op.drop_index(INDEX, TABLE)
    op.create_index(INDEX, TABLE, ["questionnaire", "version", "counted"])
    publication = op.create_table(
        "publication",
        sa.Column("questionnaire", sa.String(64), primary_key=True),
        sa.Column("version", sa.Integer, primary_key=True),
        sa.Column("step", sa.Integer, nullable=False),
        sa.Column("n", sa.Integer, nullable=False),
    )
    figure = op.create_table(
        "figure",
        sa.Column("questionnaire", sa.String(64), primary_key=True),
        sa.Column("version", sa.Integer, primary_key=True),
        sa.Column("item", sa.String(64), primary_key=True),
        sa.Column("step", sa.Integer, nullable=False),
        sa.Column("judged", sa.Integer, nullable=False),
        sa.Column("n", sa.Integer, nullable=False),
        sa.Column("units", sa.Integer, nullable=False),
        sa.Column("decimals", sa.Integer, nullable=False),
        sa.Column("withheld", sa.String(8)),
    )
    publish(op.get_bind(), publication, figure)


def publish(connection: sa.Connection, publication: sa.Table, figure: sa.Table) -> None:
    key = ("questionnaire", "version")
    connection.exec_driver_sql(f"UPDATE {TABLE} SET counted = 1 WHERE withdrawn IS NULL")
    counted = connection.exec_driver_sql(
        f"SELECT questionnaire, version, COUNT(*) FROM {TABLE} WHERE withdrawn IS NULL GROUP BY questionnaire, version"
    )
    op.bulk_insert(publication, [dict(zip((*key, "n"), row, strict=True)) | {"step": 1} for row in counted])
    scored = connection.exec_driver_sql(
        "SELECT s.questionnaire, s.version, a.item, COUNT(*), SUM(a.score) "
        f"FROM answer a JOIN {TABLE} s ON s.id = a.submission WHERE s.withdrawn IS NULL AND a.score IS NOT NULL "
        "GROUP BY s.questionnaire, s.version, a.item"
    )
    op.bulk_insert(
        figure,
        [
            dict(zip(key, row[:2], strict=True))
            | {"item": row[2], "step": 1, "judged": 1}
            | rounded(*row[3:])
            for row in scored
        ],
    )


def rounded(n: int, total: int) -> dict[str, object]:
    decimals = 1
    while 100**decimals < n:
        decimals += 1
    units = (2 * total * 10**decimals + n) // (2 * n)
    return {"n": n, "units": units, "decimals": decimals, "withheld": None if n >= LEAST else "few"}


def downgrade() -> None:
    op.drop_table("figure")
    op.drop_table("publication")
    op.drop_index(INDEX, TABLE)
    op.create_index(INDEX, TABLE, ["questionnaire", "version"])
    op.drop_column(TABLE, "counted")
