"""Cells of the table: what a spreadsheet would take for a formula is written behind an apostrophe, and read back.

A text that begins with =, +, -, @ (or their full-width forms), also after spaces or apostrophes, or with a tab or line
break, gets one apostrophe more; a cell that begins so loses one. Every text comes back as it was, and a cell somebody
typed without the apostrophe is read as it stands.
"""

from __future__ import annotations

import re

__all__ = ["guarded", "unguarded"]

_FORMULA = re.compile(r"'*(?:[\t\r\n]|\s*[=+\-@＝＋－＠])")


def guarded(text: str) -> str:
    """The text as a cell that no spreadsheet computes."""
    return f"'{text}" if _FORMULA.match(text) else text


def unguarded(cell: str) -> str:
    """The text of a cell."""
    return cell[1:] if cell.startswith("'") and _FORMULA.match(cell) else cell
