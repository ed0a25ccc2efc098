"""Everything that is wrong with a content folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from hall_app.content.checks import CHECKS
from hall_app.content.checks.questionnaires import unstated
from hall_app.content.folder import Content
from hall_app.content.loading import load, load_exhibit_problems
from hall_app.content.problems import ContentError, Problem

__all__ = ["check", "hints"]


def check(folder: Path) -> list[Problem]:
    """All problems of the content folder, in the order of its files; an empty list for a good one."""
    try:
        content = load(folder)
    except ContentError as error:
        # Without a floor nothing can be placed on it, but the exhibits' own files can be looked at.
        return [*error.problems, *load_exhibit_problems(folder)]
    found = list(content.problems)
    for look in CHECKS:
        found += _looked(look, content)
    return list(dict.fromkeys(found))


def hints(folder: Path) -> list[Problem]:
    """What is not wrong, but should be done before the hall opens to visitors."""
    return unstated(folder)


def _looked(look: Callable[[Content], list[Problem]], content: Content) -> list[Problem]:
    """What one check finds; a fault that nobody foresaw is a problem of its own, and the other checks go on."""
    try:
        return look(content)
    except Exception as error:
        what = f"{look.__name__.replace('_', ' ')}: cannot be checked ({' '.join(str(error).split())[:200]})"
        return [Problem(".", "", what, "undo the last change, and report it with the folder")]
