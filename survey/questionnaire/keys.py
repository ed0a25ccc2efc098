"""What may stand as a key: in a file name, an address, a column of a table."""

from __future__ import annotations

import re

__all__ = ["COLUMN_KEY", "SLUG", "is_slug"]

SLUG = r"[a-z0-9][a-z0-9_-]{0,63}"
COLUMN_KEY = r"[a-z][a-z0-9_]{0,63}"  # statistics programs take such a name as a variable unchanged


def is_slug(text: str) -> bool:
    """True for lower-case letters, digits, '-' and '_', at most 64, the first one a letter or digit."""
    return re.fullmatch(SLUG, text) is not None
