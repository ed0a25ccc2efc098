"""What the commands read: a questionnaire with its store, a table of scores, the items to drop."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from survey.content import content_folder, read_questionnaire
from survey.errors import SurveyError
from survey.questionnaire import Questionnaire
from survey.reading import ScoreTable, read_scores, scores_of
from survey.slug import is_slug
from survey.store import Store, Stored, tables

__all__ = [
    "dropped",
    "find_questionnaire_file",
    "load_scores",
    "open_stored",
    "other_roles",
    "other_versions",
    "scores_table",
    "stored_scores",
]


def find_questionnaire_file(content: Path | None, key: str) -> Questionnaire:
    """The questionnaire of that id. Raises SurveyError naming those there are."""
    folder = content_folder(content) / "questionnaires"
    path = folder / f"{key}.toml"
    if not is_slug(key) or not path.is_file():
        known = ", ".join(found.stem for found in sorted(folder.glob("*.toml"))) or "none"
        raise SurveyError(f"{key[:60]}: no such questionnaire in {folder} – choose one of: {known}")
    return read_questionnaire(path)


@contextmanager
def open_stored(
    where: Path | str, content: Path | None, key: str, version: int | None = None
) -> Iterator[tuple[Questionnaire, Store]]:
    """A questionnaire as it was asked and the store with its answers.

    version: an earlier one; None: the file's. Raises SurveyError where there is no store yet, or no such version.
    """
    questionnaire = find_questionnaire_file(content, key)
    # Reading must not make an empty store: a mistyped folder would look like a survey without answers.
    file = tables.sqlite_file(where)
    if file is not None and not file.is_file():
        raise SurveyError(f"{file}: no such store – give --data (or --db) the one that was served")
    store = Store(where)
    try:
        yield _as_asked(questionnaire, version, store), store
    finally:
        store.close()


def _as_asked(questionnaire: Questionnaire, version: int | None, store: Store) -> Questionnaire:
    if version is None or version == questionnaire.version:
        return store.frozen(questionnaire.id, questionnaire.version) or questionnaire
    found = store.frozen(questionnaire.id, version)
    if found is None:
        known = ", ".join(str(number) for number in store.versions(questionnaire.id)) or "none"
        raise SurveyError(
            f"{questionnaire.id}: version {version} has no answers – those with answers: {known}"
        )
    return found


def other_versions(store: Store, questionnaire: Questionnaire) -> str:
    """A sentence on answers to other versions of the same questionnaire, empty where there are none."""
    counts = {
        version: store.count(questionnaire.id, version)
        for version in store.versions(questionnaire.id)
        if version != questionnaire.version
    }
    told = ", ".join(f"{count} to version {version}" for version, count in counts.items() if count)
    return f"version {questionnaire.version}; there are also {told} (--version)" if told else ""


def load_scores(
    file: Path | None, where: Path | str, content: Path | None, key: str | None, version: int | None = None
) -> ScoreTable:
    """Scores from a CSV file, or else from the store."""
    if file is not None:
        return read_scores(file, None if key is None else find_questionnaire_file(content, key))
    if key is None:
        raise SurveyError("no questionnaire named – give --questionnaire ID")
    with open_stored(where, content, key, version) as (questionnaire, store):
        return replace(stored_scores(questionnaire, store), beside=other_versions(store, questionnaire))


def stored_scores(questionnaire: Questionnaire, store: Store) -> ScoreTable:
    """All standing answers to one version."""
    return scores_table(questionnaire, store.rows(questionnaire))


def scores_table(questionnaire: Questionnaire, rows: Sequence[Stored]) -> ScoreTable:
    """Stored answers as an (n, p) table of scores, NaN where an item was not seen."""
    answers = [row.answer for row in rows]
    return ScoreTable(
        scores_of(answers, questionnaire.item_ids),
        questionnaire.item_ids,
        suggestions=tuple(written for answer in answers for written in answer.suggestions),
        questionnaire=questionnaire,
        source=f"{questionnaire.id} v{questionnaire.version}",
    )


def other_roles(where: Path | str, content: Path | None, asked: Questionnaire) -> list[ScoreTable]:
    """Stored answers to the other questionnaires with the same dimensions: the platform's other role."""
    folder, found = content_folder(content) / "questionnaires", []
    sides = [side.id for side in asked.dimensions]
    for path in sorted(folder.glob("*.toml")):
        other = read_questionnaire(path)
        if other.id != asked.id and [side.id for side in other.dimensions] == sides:
            with open_stored(where, content, other.id) as (questionnaire, store):
                table = stored_scores(questionnaire, store)
            if len(table.scores):
                found.append(table)
    return found


def dropped(what: str, questionnaire: Questionnaire | None) -> tuple[str, ...]:
    """Items to leave out: "none", the items of a tag, or a comma-separated list."""
    if what == "none":
        return ()
    tagged = questionnaire.tagged(what) if questionnaire is not None else ()
    return tagged or tuple(part.strip() for part in what.split(",") if part.strip())
