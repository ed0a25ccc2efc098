"""Commands on the store: handing answers out, fixing them, erasing them, copying it, who may read and what was done."""

from survey.commands.storage import audit, backup, export, freeze, purge, token

__all__ = ["audit", "backup", "export", "freeze", "purge", "token"]
