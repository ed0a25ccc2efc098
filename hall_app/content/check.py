"""Everything that is wrong with a content folder."""

from __future__ import annotations

from pathlib import Path

from .checks import CHECKS
from .loading import load, load_exhibit_problems
from .problems import ContentError, Problem

__all__ = ["check"]


def check(folder: Path) -> list[Problem]:
    """All problems of the content folder, in the order of its files; an empty list for a good one."""
    try:
        content = load(folder)
    except ContentError as error:
        # Without a floor nothing can be placed on it, but the exhibits' own files can be looked at.
        return [*error.problems, *load_exhibit_problems(folder)]
    found = list(content.problems)
    for look in CHECKS:
        found += look(content)
    return list(dict.fromkeys(found))
