"""Putting the survey into a web application: its own or the hall's."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from survey.content import QuestionnaireFolder
from survey.errors import Problem, QuestionnaireError, StoreError
from survey.published import Published
from survey.store import Store

if TYPE_CHECKING:
    from fastapi import FastAPI

    from survey.form.clip import ClipOf

__all__ = ["Mounted", "mount"]

PATIENCE = 0.2  # seconds until a changed questionnaire shows


@dataclass(frozen=True)
class Mounted:
    """What was mounted. `questionnaires` reloads its files; whoever stops the app calls close()."""

    store: Store
    questionnaires: QuestionnaireFolder

    @property
    def problems(self) -> tuple[Problem, ...]:
        """What is wrong now: faulty files, versions changed after their first answer, a store that is lost."""
        try:
            changed = _changed(self.store, self.questionnaires)
        except StoreError as error:
            what, _, fix = error.problem.partition(" – ")
            changed = (Problem(error.place, "", what, fix or "see that the database is there"),)
        return (*self.questionnaires.problems, *changed)

    def close(self) -> None:
        self.store.close()


def mount(
    app: FastAPI,
    *,
    content: Path,
    data: Path | str,
    problems: list[Problem] | None = None,
    per_minute: int | None = None,
    clip_of: ClipOf | None = None,
) -> Mounted:
    """Add the API (/api/v1/…) and the form page (/questionnaires/…) to an app.

    content: folder that holds questionnaires/*.toml. data: data folder, or a database URL.
    problems: where to report what is wrong; the good questionnaires are served then. Without it, the first
    problem raises QuestionnaireError naming file and key. Raises StoreError when the store cannot be opened.
    per_minute: new answers that one address may give in a minute; 0: any number; None: the usual.
    clip_of: the film of an exhibit, shown beside items on motion.
    """
    from survey.api import Limit, router
    from survey.form import form_router

    questionnaires = QuestionnaireFolder(content, patience=PATIENCE)
    if problems is None and questionnaires.problems:
        raise QuestionnaireError(questionnaires.problems)
    mounted = Mounted(Store(data), questionnaires)
    found = mounted.problems
    if problems is not None:
        problems.extend(found)
    elif found:
        mounted.close()
        raise QuestionnaireError(found)
    asked = Published(questionnaires, mounted.store)
    limit = Limit() if per_minute is None else Limit(per_minute)
    app.include_router(router(mounted.store, asked, limit))
    app.include_router(form_router(asked, clip_of))
    return mounted


def _changed(store: Store, questionnaires: QuestionnaireFolder) -> tuple[Problem, ...]:
    return tuple(
        Problem(
            f"{questionnaires.folder.name}/{found.id}.toml",
            "version",
            f"version {found.version} was changed after its first answer",
            f"write version = {found.version + 1}, or take the change back",
        )
        for found in list(questionnaires.values())
        if store.changed(found)
    )
