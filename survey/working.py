"""What the commands read: a questionnaire with its store, a table of scores, the items to drop."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from survey.content import content_folder, read_questionnaire
from survey.errors import SurveyError
from survey.questionnaire import Questionnaire
from survey.reading import read_scores, scores_of
from survey.store import Store

__all__ = ["dropped", "find_questionnaire_file", "load_scores", "open_stored"]


def find_questionnaire_file(content: Path | None, key: str) -> Questionnaire:
    """The questionnaire of that id. Raises SurveyError naming those there are."""
    folder = content_folder(content) / "questionnaires"
    path = folder / f"{key}.toml"
    if not path.is_file():
        known = ", ".join(found.stem for found in sorted(folder.glob("*.toml"))) or "none"
        raise SurveyError(f"{key}: no such questionnaire in {folder} – choose one of: {known}")
    return read_questionnaire(path)


@contextmanager
def open_stored(where: Path | str, content: Path | None, key: str) -> Iterator[tuple[Questionnaire, Store]]:
    """A questionnaire and the store with its answers. Raises SurveyError where there is no data folder yet."""
    questionnaire = find_questionnaire_file(content, key)
    if isinstance(where, Path) and not where.is_dir():
        # Reading must not make an empty store: a mistyped folder would look like a survey without answers.
        raise SurveyError(f"{where}: no such data folder – give --data the one that was served")
    store = Store(where)
    try:
        yield questionnaire, store
    finally:
        store.close()


def load_scores(
    file: Path | None, where: Path | str, content: Path | None, key: str | None
) -> tuple[NDArray[np.float64], Sequence[str], Questionnaire | None]:
    """Scores (n, p), items and questionnaire, from a CSV file or else from the store."""
    if file is not None:
        questionnaire = None if key is None else find_questionnaire_file(content, key)
        scores, items = read_scores(file, None if questionnaire is None else questionnaire.item_ids)
        return scores, items, questionnaire
    if key is None:
        raise SurveyError("no questionnaire named – give --questionnaire ID")
    with open_stored(where, content, key) as (questionnaire, store):
        answers = [row.answer for row in store.rows(questionnaire)]
    return scores_of(answers, questionnaire.item_ids), questionnaire.item_ids, questionnaire


def dropped(what: str, questionnaire: Questionnaire | None) -> tuple[str, ...]:
    """Items to leave out: "none", the items of a tag, or a comma-separated list."""
    if what == "none":
        return ()
    tagged = questionnaire.tagged(what) if questionnaire is not None else ()
    return tagged or tuple(part.strip() for part in what.split(",") if part.strip())
