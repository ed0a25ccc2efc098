"""Alembic's door: the steps run on the connection, and in the transaction, that `database.schema` hands over."""

from alembic import context

context.configure(connection=context.config.attributes["connection"], transaction_per_migration=False)
context.run_migrations()
