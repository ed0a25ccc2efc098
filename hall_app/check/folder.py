"""Everything that is wrong with a content folder."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from hall_app.check.files.bakes import bake_problems
from hall_app.check.files.budget import budget_problems
from hall_app.check.files.clips import clip_problems
from hall_app.check.files.mannequins import figure_problems
from hall_app.check.files.media import media_problems
from hall_app.check.files.models import scale_problems
from hall_app.check.files.scans import scan_problems, scan_remarks
from hall_app.check.files.unused import unused_problems
from hall_app.check.files.words import word_problems
from hall_app.check.files.writing import writing_problems
from hall_app.check.hall.backdrops import backdrop_problems
from hall_app.check.hall.fittings import fitting_problems
from hall_app.check.hall.questionnaires import questionnaire_problems, unstated
from hall_app.check.hall.reach import reach_problems
from hall_app.check.hall.room import room_problems
from hall_app.check.hall.signs import sign_remarks
from hall_app.content.folder import Content
from hall_app.content.loading import load, load_exhibit_problems
from hall_app.content.problems import ContentError, Problem

__all__ = ["CHECKS", "EDITED", "QUICK", "STANDING", "check", "hints"]

# What is looked at beyond loading: each function takes the content and returns problems.
CHECKS: tuple[Callable[[Content], list[Problem]], ...] = (
    word_problems,
    writing_problems,
    media_problems,
    scale_problems,
    budget_problems,
    clip_problems,
    reach_problems,
    backdrop_problems,
    bake_problems,
    scan_problems,
    figure_problems,
    questionnaire_problems,
    fitting_problems,
    room_problems,
    unused_problems,
)

# What changed words can bring about: seconds less than all of it, which measures bakes and walks through the hall.
QUICK = (word_problems, media_problems, questionnaire_problems, unused_problems)

# What an exhibit's changed files can bring about, its place aside: what is baked follows by itself, halls stay.
EDITED = (*QUICK, writing_problems, scale_problems, budget_problems, clip_problems, scan_problems)

# And its place: whether everything is still reached on foot, seconds of work.
STANDING = (reach_problems,)


def check(folder: Path, looks: Iterable[Callable[[Content], list[Problem]]] | None = None) -> list[Problem]:
    """All problems of the content folder, in the order of its files; an empty list for a good one.

    looks: what is looked at beyond loading, all of CHECKS where it is left out.
    """
    try:
        content = load(folder)
    except ContentError as error:
        # Without a floor nothing can be placed on it, but the exhibits' own files can be looked at.
        return [*error.problems, *load_exhibit_problems(folder)]
    found = list(content.problems)
    for look in CHECKS if looks is None else looks:
        found += _looked(look, content)
    return list(dict.fromkeys(found))


def hints(folder: Path) -> list[Problem]:
    """What is not wrong, but should be done before the hall opens to visitors."""
    try:
        content = load(folder)
    except ContentError:
        return unstated(folder)  # what is wrong is said by the check
    return [*unstated(folder), *scan_remarks(content), *_looked(sign_remarks, content)]


def _looked(look: Callable[[Content], list[Problem]], content: Content) -> list[Problem]:
    """What one check finds; a fault that nobody foresaw is a problem of its own, and the other checks go on."""
    try:
        return look(content)
    except Exception as error:
        what = f"{look.__name__.replace('_', ' ')}: cannot be checked ({' '.join(str(error).split())[:200]})"
        return [Problem(".", "", what, "undo the last change, and report it with the folder")]
