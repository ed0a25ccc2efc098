"""A questionnaire as its TOML file states it: two languages, modules of items, anchors of the scale, consent."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Collection
from datetime import date
from functools import cached_property
from typing import Annotated, Any, Literal, Self, get_args

from pydantic import BaseModel, ConfigDict, Field, StringConstraints, model_validator

from survey.questionnaire.keys import COLUMN_KEY, SLUG

__all__ = [
    "LANGUAGES",
    "META_COLUMNS",
    "NEEDS",
    "NOT_ASKED",
    "UNASKED",
    "UNSEEN",
    "Item",
    "Language",
    "Module",
    "Need",
    "Offers",
    "Questionnaire",
    "Text",
    "suggestion_column",
]

Language = Literal["zh", "en"]
LANGUAGES: tuple[Language, ...] = ("zh", "en")

# Columns of an export beside the items; an item of that name would hide one.
META_COLUMNS = ("submission", "version", "language", "exhibit", "received")

UNSEEN = (
    9  # "not seen" where a file needs a number for it: above every scale, which have at most seven points
)

UNASKED = 8  # "not asked" where a file needs a number for it: the place had nothing of what the item is about
NOT_ASKED = (
    "."  # the same in a table of text, as statistics programs write what is missing; "not seen" is empty
)

# Parts of a platform that a place may have or not have yet.
Need = Literal["culture", "research", "activities", "visit", "user-centre", "office"]
NEEDS: tuple[str, ...] = get_args(Need)
Offers = frozenset[str] | None  # what of them a place has; None: whatever is asked about, everything is asked

SUGGESTION = "suggestion_"


def suggestion_column(module: str) -> str:
    """Name of the export column that holds a module's suggestions."""
    return SUGGESTION + module


Words = Annotated[
    str, StringConstraints(strip_whitespace=True, min_length=1, max_length=4000, pattern=r"^[^\x00]*$")
]
Key = Annotated[str, StringConstraints(pattern=f"^{COLUMN_KEY}$")]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Text(_Part):
    """The same words in both languages."""

    zh: Words
    en: Words

    def in_language(self, language: Language) -> str:
        return self.zh if language == "zh" else self.en


class Scale(_Part):
    """What the points 1, 2, … mean, lowest first, and the words for an item the visitor did not see."""

    anchors: Annotated[list[Text], Field(min_length=3, max_length=7)]
    not_seen: Text | None = None


class Dimension(_Part):
    """A side from which every module is judged; with dimensions, a module's items are made from them.

    reverse: as an item's, for all items made from it.
    """

    id: Key
    label: Text
    hint: Text | None = None
    reverse: bool = False


class Item(_Part):
    """One question. `tags` mark groups that an analysis may drop together, such as "static".

    needs: what the place must have for it to be asked, None: nothing. reverse: whether it is worded the other way
    round, so that an analysis turns its scores; what is stored, exported and shown stays as it was answered.
    """

    id: Key
    label: Text
    hint: Text | None = None
    tags: list[Key] = []
    required: bool = True
    dimension: Key | None = None
    needs: Need | None = None
    reverse: bool = False


class Module(_Part):
    """Items that stand together, with one free field for suggestions. needs: as an item's, for all of them."""

    id: Key
    title: Text
    intro: Text | None = None
    suggestion: Text | None = None
    needs: Need | None = None
    items: list[Item] = Field(default=[], alias="item")


class Questionnaire(_Part):
    """A questionnaire in one version. Anchors and consent belong to the version, so they are stored with it."""

    id: Annotated[str, StringConstraints(pattern=f"^{SLUG}$")]
    version: Annotated[int, Field(ge=1, le=10_000)]
    title: Text
    intro: Text
    consent: Text
    # Until when answers are kept; not strict, because a frozen version comes back from JSON.
    retain_until: Annotated[date | None, Field(strict=False)] = None
    scale: Scale
    dimensions: list[Dimension] = Field(default=[], alias="dimension")
    modules: Annotated[list[Module], Field(min_length=1, alias="module")]

    @model_validator(mode="after")
    def _keys_are_unique(self) -> Self:
        if self.dimensions and any(module.items for module in self.modules):
            raise ValueError("a questionnaire has either [[dimension]] or [[module.item]], not both")
        for what, keys in (
            ("module", [module.id for module in self.modules]),
            ("dimension", [dimension.id for dimension in self.dimensions]),
            ("item", list(self.item_ids)),
        ):
            twice = sorted({key for key in keys if keys.count(key) > 1})
            if twice:
                raise ValueError(f"{what} id {twice[0]!r} stands twice; every id must be its own")
        for module in self.modules:
            if not self.dimensions and not module.items:
                raise ValueError(f"module {module.id!r} has no items; add [[module.item]] or a [[dimension]]")
        taken = {*META_COLUMNS, *(suggestion_column(module.id) for module in self.modules)} & set(
            self.item_ids
        )
        if taken:
            raise ValueError(f"item id {min(taken)!r} is a column of the export; choose another")
        return self

    def items_of(self, module: Module) -> tuple[Item, ...]:
        """The module's own items, or one for each dimension."""
        if not self.dimensions:
            return tuple(module.items)
        return tuple(
            Item(
                id=f"{module.id}_{side.id}",
                label=side.label,
                hint=side.hint,
                dimension=side.id,
                reverse=side.reverse,
            )
            for side in self.dimensions
        )

    @cached_property
    def items(self) -> tuple[Item, ...]:
        """All items in the order in which they are asked."""
        return tuple(item for module in self.modules for item in self.items_of(module))

    def asking(self, offers: Offers) -> Questionnaire:
        """What is asked of it in a place that offers just this; without any items where nothing of it is there.

        The version that is frozen, and that says which items there are, is the whole one.
        """
        if offers is None:
            return self
        if offers not in self.narrowed:
            self.narrowed[offers] = self._part(lambda part, _: part.needs is None or part.needs in offers)
        return self.narrowed[offers]

    def asked(self, items: Collection[str]) -> Questionnaire:
        """What of it was asked where these items were asked."""
        return self._part(lambda _, ids: any(item in items for item in ids))

    def _part(self, kept: Callable[[Item | Module, tuple[str, ...]], bool]) -> Questionnaire:
        """Of modules and items that `kept` (part, ids of its items) admits."""
        modules = []
        for module in self.modules:
            ids = tuple(item.id for item in self.items_of(module))
            items = [item for item in module.items if kept(item, (item.id,))]
            if kept(module, ids) and (items or self.dimensions):
                modules.append(module.model_copy(update={"items": items}))
        part = self.model_copy(update={"modules": modules})
        for name in ("items", "digest", "narrowed"):  # a copy takes along what was computed of the whole
            vars(part).pop(name, None)
        return part

    @cached_property
    def narrowed(self) -> dict[frozenset[str], Questionnaire]:
        """What `asking` has given, kept: it is asked for with every submission."""
        return {}

    @property
    def item_ids(self) -> tuple[str, ...]:
        return tuple(item.id for item in self.items)

    @property
    def points(self) -> int:
        """The highest point of the scale; the lowest is 1."""
        return len(self.scale.anchors)

    def tagged(self, tag: str) -> tuple[str, ...]:
        """Ids of the items that carry a tag."""
        return tuple(item.id for item in self.items if tag in item.tags)

    @property
    def reverse_keyed(self) -> tuple[str, ...]:
        """Ids of the items that are worded the other way round."""
        return tuple(item.id for item in self.items if item.reverse)

    def document(self) -> dict[str, Any]:
        """The version as plain data with the keys of its file, as the store freezes it."""
        document = self.model_dump(mode="json", by_alias=True)
        if self.retain_until is None:  # versions frozen before this key existed keep their digest
            del document["retain_until"]
        for module in document["module"]:
            for part in (module, *module["item"]):
                if part["needs"] is None:  # as above
                    del part["needs"]
        for part in (
            *document["dimension"],
            *(item for module in document["module"] for item in module["item"]),
        ):
            if not part["reverse"]:  # as above
                del part["reverse"]
        return document

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the document, hexadecimal: two versions are the same when it is."""
        text = json.dumps(self.document(), ensure_ascii=False, sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()
