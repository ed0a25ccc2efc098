"""Putting the survey into a web application, its own or the hall's: every version as it was first asked."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import wait
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from survey.errors import AnswerError, Problem, QuestionnaireError, StoreError
from survey.questionnaire import Language, Offers, Questionnaire, QuestionnaireFolder, submission_id
from survey.store import PATIENCE as ERASED_WITHIN
from survey.store import Given, Store
from survey.web.privacy import Record, Running, read_controller, record_of

if TYPE_CHECKING:
    from fastapi import FastAPI

    from survey.web.api import Jobs
    from survey.web.form import ClipOf, Ways

__all__ = ["Mounted", "mount"]

PATIENCE = 0.2  # seconds until a changed questionnaire shows


class Published(Mapping[str, Questionnaire]):
    """The questionnaires of `files` by id; one that was edited without raising its version stays as it was asked.

    Answers to it can so be given, counted and exported; that the file differs is told among the problems.
    """

    def __init__(self, files: Mapping[str, Questionnaire], store: Store) -> None:
        self._files, self._store = files, store
        self._same: set[tuple[str, int, str]] = set()  # versions seen to be frozen as their file reads

    def __getitem__(self, key: str) -> Questionnaire:
        return self.as_asked(self._files[key])

    def __iter__(self) -> Iterator[str]:
        return iter(self._files)

    def __len__(self) -> int:
        return len(self._files)

    def as_asked(self, current: Questionnaire) -> Questionnaire:
        """The frozen form of the file's version, else the file's."""
        name = (current.id, current.version, current.digest)
        if name in self._same:
            return current
        frozen = self._store.frozen(current.id, current.version)
        if frozen is None:
            return current
        if frozen.digest == current.digest:
            self._same.add(name)
        return frozen


@dataclass(frozen=True)
class Mounted:
    """What was mounted. `questionnaires` reloads its files; whoever stops the app calls close()."""

    store: Store
    questionnaires: QuestionnaireFolder
    jobs: Jobs
    content: Path
    offers: Offers = None
    running: Running = field(default_factory=Running)

    def asks(self, key: str) -> bool:
        """Whether there is a questionnaire of that id that has anything to ask here."""
        found = self.questionnaires.get(key)
        return found is not None and bool(found.asking(self.offers).items)

    @property
    def problems(self) -> tuple[Problem, ...]:
        """What is wrong now: faulty files, versions changed after their first answer, a store that is lost."""
        try:
            changed = _changed(self.store, self.questionnaires)
        except StoreError as error:
            what, _, fix = error.problem.partition(" – ")
            changed = (Problem(error.place, "", what, fix or "see that the database is there"),)
        return (*self.questionnaires.problems, *read_controller(self.content).faults, *changed)

    @property
    def hints(self) -> tuple[Problem, ...]:
        """What is not stated yet, and should be before visitors answer."""
        return read_controller(self.content).gaps if self.questionnaires else ()

    def results(self) -> list[dict[str, Any]]:
        """What everybody may see of each questionnaire that asks anything here, with its title. Raises StoreError."""
        from survey.web.api.results import public_results

        found = (
            Published(self.questionnaires, self.store).as_asked(one)
            for one in list(self.questionnaires.values())
        )
        asked = [one for one in found if one.asking(self.offers).items]
        return [
            {"title": one.title.model_dump(), **public_results(one, self.store.public(one))} for one in asked
        ]

    def suggestions(self) -> list[dict[str, Any]]:
        """What visitors suggested, the newest first: id, questionnaire, its title, the module's, text, received.

        Of every version that was answered, also of a questionnaire that has left the hall. id: by the answer's
        pseudonym, never by the withdrawal code that is its name in the store. Raises StoreError.
        """
        from survey.export import pseudonym

        found = []
        for asked in self.store.all_frozen():
            modules = {module.id: module.title.model_dump() for module in asked.modules}
            for row in self.store.rows(asked):
                found += [
                    {
                        "id": f"{pseudonym(row.answer.id)}.{module}",
                        "questionnaire": asked.id,
                        "title": asked.title.model_dump(),
                        "module": modules[module],
                        "text": text,
                        "received": row.received.isoformat(),
                    }
                    for module, text in row.answer.suggestions
                ]
        return sorted(found, key=lambda one: one["received"], reverse=True)

    def when_withdrawn(self, act: Callable[[str], None]) -> None:
        """Have `act` told the pseudonym of each answer that is taken back here, whichever door it is done by."""
        from survey.export import pseudonym

        self.store.withdrawn = lambda code: act(pseudonym(code))

    def withdrawn(self) -> frozenset[str]:
        """The pseudonyms of all answers that were withdrawn or purged. Raises StoreError."""
        from survey.export import pseudonym

        return frozenset(map(pseudonym, self.store.tombstones()))

    def standing(self) -> list[dict[str, Any]]:
        """Every questionnaire with its versions that have answers: id, title, version, asked (whether it asks anything
        here), items, answers of this version, versions {number: answers}. One that has left the hall is told by its
        last version that was answered. Raises StoreError.
        """
        published = Published(self.questionnaires, self.store)
        current = {one.id: published.as_asked(one) for one in list(self.questionnaires.values())}
        found = []
        for one in ({one.id: one for one in self.store.all_frozen()} | current).values():
            versions = {number: self.store.count(one.id, number) for number in self.store.versions(one.id)}
            found.append(
                {
                    "id": one.id,
                    "title": one.title.model_dump(),
                    "version": one.version,
                    "asked": one.id in current and bool(one.asking(self.offers).items),
                    "items": len(one.items),
                    "answers": versions.get(one.version, 0),
                    "versions": versions,
                }
            )
        return sorted(found, key=lambda one: one["id"])

    def of_codes(self, codes: Sequence[str]) -> dict[str, Given]:
        """What was answered under these withdrawal codes; what is no code is left out. Raises StoreError."""
        return self.store.of_codes(codes)

    def take_back(self, code: str) -> bool:
        """Withdraw the answer of a code. False: it is deleted, and its traces will be gone from the files shortly.

        Raises AnswerError: 404 no such answer, 409 fixed for evaluation; StoreError.
        """
        known = submission_id(code)
        given = self.store.of_codes([known]).get(known)
        gone = self.store.take_back(given.questionnaire, known) if given is not None else None
        if gone is None:
            raise AnswerError(
                "id", "no such answer", "check the code that was shown after sending", status=404
            )
        wait([gone], ERASED_WITHIN)
        return gone.done() and gone.result()

    def made(
        self, key: str, task: str, version: int | None = None, language: Language | None = None
    ) -> tuple[str, bytes]:
        """An export ("csv", "xlsx", "sav", "json", "codebook", "r") or the "analysis" of a version of a questionnaire,
        the current one where None: the file's name and what it holds, made by a process of its own and noted in the
        survey's journal.

        language: in which an analysis tells its warnings as well: its "remarks", one for each of its "warnings".
        Raises AnswerError, StoreError.
        """
        from survey.export import file_name
        from survey.web.api import Wanted, find_version

        asked = find_version(Published(self.questionnaires, self.store), self.store, key, version)
        usual = Wanted.model_validate({}).model_dump()
        job = {
            "task": task,
            "questionnaire": asked.document(),
            "k": None,
            "settings": usual,
            "language": language,
        }
        data = self.jobs.made(job)
        self.store.audit.note("export", f"{asked.id} version {asked.version} {task}, office")
        return file_name(task, asked) if task != "analysis" else f"{key}-analysis.json", data

    def record(self) -> Record:
        """What is processed here, and how, as of now. Raises StoreError."""
        asked = tuple(found for found in self.questionnaires.values() if found.asking(self.offers).items)
        return record_of(self.content, self.store, asked, self.running, datetime.now(UTC).date())

    def close(self) -> None:
        """End exports and analyses under way, then write what waits."""
        self.jobs.close()
        self.store.close()


def mount(
    app: FastAPI,
    *,
    content: Path,
    data: Path | str,
    problems: list[Problem] | None = None,
    running: Running | None = None,
    clip_of: ClipOf | None = None,
    offers: Offers = None,
    ways: Ways | None = None,
) -> Mounted:
    """Add the API (/api/v1/…), the form page (/questionnaires/…) and the record of processing (/privacy) to an app.

    content: folder that holds questionnaires/*.toml. data: data folder, or a database URL.
    problems: where to report what is wrong; the good questionnaires are served then. Without it, the first
    problem raises QuestionnaireError naming file and key. Raises StoreError when the store cannot be opened.
    running: how the app is started: new answers that one address may give in a minute, None: the usual; proxies whose
    word on visitors' addresses it believes, for the record alone.
    clip_of: the film of an exhibit, shown beside items on motion. offers: which of questionnaire.NEEDS the place has;
    what needs another is not asked, None: everything is. ways: where a visitor goes on from the thanks.
    """
    from survey.web.api import Jobs, Limit, router
    from survey.web.form import form_router
    from survey.web.privacy import privacy_router

    questionnaires = QuestionnaireFolder(content, patience=PATIENCE)
    if problems is None and questionnaires.problems:
        raise QuestionnaireError(questionnaires.problems)
    started = running or Running()
    limit = Limit() if started.per_minute is None else Limit(started.per_minute)
    started = replace(started, per_minute=limit.per_minute)
    mounted = Mounted(Store(data), questionnaires, Jobs(data), content, offers, started)
    found = mounted.problems
    if problems is not None:
        problems.extend(found)
    elif found:
        mounted.close()
        raise QuestionnaireError(found)
    asked = Published(questionnaires, mounted.store)
    app.include_router(router(mounted.store, asked, limit, offers, mounted.jobs))
    app.include_router(form_router(asked, clip_of, offers=offers, ways=ways, privacy=True))
    app.include_router(privacy_router(mounted.record))
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
