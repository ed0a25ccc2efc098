"""Questionnaires: can each be asked, and is there one of every name that hall and exhibits give?"""

from __future__ import annotations

from pathlib import Path

from hall_app.content.folder import Content
from hall_app.content.problems import Problem
from survey.questionnaire import QUESTIONNAIRES, QuestionnaireFolder
from survey.web.privacy import read_controller


def questionnaire_problems(content: Content) -> list[Problem]:
    """Faulty questionnaire files, faults in who answers for them, and names of questionnaires that are not there."""
    asked = QuestionnaireFolder(content.folder)
    faults = (*asked.problems, *read_controller(content.folder).faults)
    found = [Problem(fault.file, fault.key, fault.what, fault.fix) for fault in faults]
    # A faulty one has its own line.
    there = {path.stem for path in (content.folder / QUESTIONNAIRES).glob("*.toml")}
    named = [("hall.toml", content.hall.questionnaire)]
    named += [(exhibit.toml, exhibit.file.questionnaire) for exhibit in content.exhibits]
    for toml, name in named:
        if name is None or name in there:
            continue
        known = ", ".join(sorted(there)) or "none"
        what, fix = f"there is no questionnaire {name[:60]!r}", f"write one of {QUESTIONNAIRES}/: {known}"
        found.append(Problem(toml, "questionnaire", what, fix))
    return found


def unstated(folder: Path) -> list[Problem]:
    """Who answers for the questionnaires, where the folder asks any and does not say; no fault of the folder."""
    if not any((folder / QUESTIONNAIRES).glob("*.toml")):
        return []
    return [Problem(gap.file, gap.key, gap.what, gap.fix) for gap in read_controller(folder).gaps]
