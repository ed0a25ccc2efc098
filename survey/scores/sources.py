"""Where scores come from: a file, a questionnaire with its store, a sample; and which items to drop, turn or group."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import replace
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING

from survey.demonstration import intermediate, merged, questionnaire_id, sample_file, sample_name
from survey.errors import SurveyError
from survey.questionnaire import Questionnaire, content_folder, find_questionnaire_file, read_questionnaire
from survey.scores.columns import Choice
from survey.scores.csv_table import ScoreTable, read_scores
from survey.store import Store, existing_store

if TYPE_CHECKING:
    from survey.analysis import Context, Group
    from survey.store.answers import Archive

__all__ = [
    "context_of",
    "dropped",
    "listed",
    "load_scores",
    "open_stored",
    "other_roles",
    "other_versions",
    "reverse_keyed",
    "sample_scores",
    "stated_groups",
    "stored_scores",
]


@contextmanager
def open_stored(
    where: Path | str, content: Path | None, key: str, version: int | None = None
) -> Iterator[tuple[Questionnaire, Store]]:
    """A questionnaire as it was asked and the store with its answers.

    version: an earlier one; None: the file's. Raises SurveyError where there is no store yet, or no such version.
    """
    questionnaire = find_questionnaire_file(content, key)
    with closing(existing_store(where)) as store:
        yield _as_asked(questionnaire, version, store), store


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
    file: Path | None,
    where: Path | str,
    content: Path | None,
    key: str | None,
    version: int | None = None,
    *,
    choice: Choice | None = None,
    texts: bool = True,
    labels: bool = False,
) -> ScoreTable:
    """Scores from a CSV file, or else from the store.

    choice: of a foreign file's columns. texts: whether the stored suggestions are wanted as well; labels: what
    the stored answers can be told apart by.
    """
    if file is not None:
        table = read_scores(file, None if key is None else find_questionnaire_file(content, key), choice)
        return replace(table, beside=unevenly_asked(table))
    if key is None:
        raise SurveyError("no questionnaire named – give --questionnaire ID")
    from survey.store.answers import Archive

    with open_stored(where, content, key, version) as (questionnaire, store):
        table = stored_scores(questionnaire, Archive(where), texts=texts, labels=labels)
        notes = (other_versions(store, questionnaire), unevenly_asked(table))
        return replace(table, beside="; ".join(filter(None, notes)))


def stored_scores(whole: Questionnaire, archive: Archive, *, texts: bool, labels: bool = False) -> ScoreTable:
    """All standing answers to one version: (n, p) of the items that were asked, NaN where one was not, or not seen."""
    import numpy as np

    from survey.store.answers import UNSCORED, read_columns, read_heads, read_texts

    with archive.snapshot() as connection:
        columns = read_columns(connection, whole)
        written = tuple(read_texts(connection, whole)) if texts else ()
        heads = read_heads(connection, whole) if labels else None
    asked = dict(zip(whole.item_ids, columns.asked.tolist(), strict=True))
    # Where nobody answered yet, everything is as good as asked.
    questionnaire = whole.asked({item for item, n in asked.items() if n}) if any(asked.values()) else whole
    points, n = columns.of(questionnaire).scores, len(columns.ids)
    return ScoreTable(
        np.where(points > UNSCORED, points, np.nan),
        questionnaire.item_ids,
        suggestions=_in_order(whole, written),
        questionnaire=questionnaire,
        source=f"{questionnaire.id} v{questionnaire.version}",
        unasked={item: gone for item in whole.item_ids if (gone := n - asked[item])},
        labels={}
        if heads is None
        else {"language": tuple(heads.language.tolist()), "exhibit": tuple(heads.exhibit.tolist())},
    )


def _in_order(
    questionnaire: Questionnaire, written: tuple[tuple[bytes, str, str], ...]
) -> tuple[tuple[str, str], ...]:
    """(module, text) of the answers one after the other, within one as the questionnaire asks."""
    order = {module.id: at for at, module in enumerate(questionnaire.modules)}
    found: list[tuple[str, str]] = []
    for _, texts in groupby(written, key=itemgetter(0)):
        mine = [(module, text) for _, module, text in texts if module in order]
        found += sorted(mine, key=lambda one: order[one[0]])
    return tuple(found)


def unevenly_asked(table: ScoreTable) -> str:
    """A sentence on items that were asked in some answers and not in others, empty where there are none."""
    some, total = [table.unasked[item] for item in table.items if item in table.unasked], len(table.scores)
    return (
        f"{len(some)} items were not asked in all {total} answers, in {total - max(some)} at least"
        if some
        else ""
    )


def other_roles(where: Path | str, content: Path | None, asked: Questionnaire) -> list[ScoreTable]:
    """Stored answers to the other questionnaires with the same dimensions: the platform's other role."""
    from survey.store.answers import Archive

    folder, found = content_folder(content) / "questionnaires", []
    sides = [side.id for side in asked.dimensions]
    for path in sorted(folder.glob("*.toml")):
        other = read_questionnaire(path)
        if other.id != asked.id and [side.id for side in other.dimensions] == sides:
            with open_stored(where, content, other.id) as (questionnaire, _):
                table = stored_scores(questionnaire, Archive(where), texts=True)
            if len(table.scores):
                found.append(table)
    return found


def dropped(what: str, questionnaire: Questionnaire | None) -> tuple[str, ...]:
    """Items to leave out: "none", the items of a tag, or a comma-separated list."""
    if what == "none":
        return ()
    tagged = questionnaire.tagged(what) if questionnaire is not None else ()
    return tagged or listed(what)


def reverse_keyed(what: str, table: ScoreTable) -> tuple[str, ...]:
    """Items to turn: those that the questionnaire says, and those of a comma-separated list; "none": none at all."""
    if what == "none":
        return ()
    own = () if table.questionnaire is None else table.questionnaire.reverse_keyed
    return tuple(dict.fromkeys((*own, *listed(what))))


def listed(what: str) -> tuple[str, ...]:
    """The parts of a comma-separated list."""
    return tuple(part.strip() for part in what.split(",") if part.strip())


def sample_scores(name: str, content: Path | None) -> ScoreTable:
    """A synthetic sample as answers to the garment questionnaire; that of the primary indicators merged into its items.

    Raises KeyError for a name that is none.
    """
    asked = find_questionnaire_file(content, questionnaire_id())
    if name != sample_name():
        return replace(read_scores(sample_file(name), asked), source=name)
    table = read_scores(sample_file(name))
    items = tuple(item for item in asked.item_ids if item in intermediate())
    scores = merged(table.scores, table.items, items)
    return replace(
        table, scores=scores, items=items, questionnaire=asked.asked(items), source=name, synthetic=True
    )


def context_of(table: ScoreTable, points: int | None) -> Context:
    """What is known of a table's scores beside them. points: of the scale, None: any number is a score."""
    from survey.analysis import Context

    return Context(table.seconds, points, table.unasked, stated_groups(table.questionnaire), table.aside)


def stated_groups(questionnaire: Questionnaire | None) -> tuple[Group, ...]:
    """The items of each module, and of each dimension across the modules, in the order in which they are stated."""
    from survey.analysis import Group

    if questionnaire is None:
        return ()
    modules = [
        Group("module", module.id, tuple(item.id for item in questionnaire.items_of(module)))
        for module in questionnaire.modules
    ]
    sides = [
        Group(
            "dimension", side.id, tuple(item.id for item in questionnaire.items if item.dimension == side.id)
        )
        for side in questionnaire.dimensions
    ]
    return (*modules, *sides)
