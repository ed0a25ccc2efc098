"""Cells that no spreadsheet takes for a formula."""

from __future__ import annotations

__all__ = ["safe_cell"]

# What a spreadsheet takes for the beginning of a formula, the full-width forms of Chinese keyboards included.
_FORMULA = ("=", "+", "-", "@", "＝", "＋", "－", "＠")
# A tab or a line break at the front moves what follows into a cell of its own when the text is pasted.
_BREAK = ("\t", "\r", "\n")


def safe_cell(text: str) -> str:
    """The text, with an apostrophe in front where a spreadsheet would run it as a formula.

    White space before the sign, the ideographic space included, is skipped by spreadsheets, so it hides nothing.
    """
    return "'" + text if text.startswith(_BREAK) or text.lstrip().startswith(_FORMULA) else text
