"""The catalogue as a table, out and in: what is not changed in it changes not one byte of the files.

cells: apostrophes before formulas; columns: their names; sheet: the CSV; difference: what it would change; toml_text:
the rewritten file; acceptance: checked and put in place; command: `hall collection`. Names are handed out when they are
asked for (PEP 562), so that a command's --help reads no check.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hall_app.web.collection.table.acceptance import Acceptance, accept
    from hall_app.web.collection.table.cells import guarded, unguarded
    from hall_app.web.collection.table.columns import column_names
    from hall_app.web.collection.table.difference import Change, changes
    from hall_app.web.collection.table.sheet import Fault, Row, Sheet, read_sheet, table
    from hall_app.web.collection.table.toml_text import EditError, edited, read_toml_text

__all__ = [
    "Acceptance",
    "Change",
    "EditError",
    "Fault",
    "Row",
    "Sheet",
    "accept",
    "changes",
    "column_names",
    "edited",
    "guarded",
    "read_sheet",
    "read_toml_text",
    "table",
    "unguarded",
]

_HOME = {
    "Acceptance": "acceptance",
    "Change": "difference",
    "EditError": "toml_text",
    "Fault": "sheet",
    "Row": "sheet",
    "Sheet": "sheet",
    "accept": "acceptance",
    "changes": "difference",
    "column_names": "columns",
    "edited": "toml_text",
    "guarded": "cells",
    "read_sheet": "sheet",
    "read_toml_text": "toml_text",
    "table": "sheet",
    "unguarded": "cells",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
