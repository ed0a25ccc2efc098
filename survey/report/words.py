"""The report's words in one language, and how it writes numbers."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np

from survey.analysis.screening import Note
from survey.questionnaire import Language, Questionnaire

__all__ = ["Words", "coefficient", "decimal", "probability", "whole"]


@lru_cache(maxsize=1)
def _texts() -> dict[str, dict[str, str]]:
    return tomllib.loads((Path(__file__).parent / "texts.toml").read_text("utf-8"))


class Words:
    """`say("key", name=value)` in one language, and the labels of a questionnaire's items and modules.

    turned: items whose scores were turned; their labels say so.
    """

    def __init__(
        self, language: Language, questionnaire: Questionnaire | None, turned: Sequence[str] = ()
    ) -> None:
        self.language: Language = language
        self._words = _texts()[language]
        self._items = {} if questionnaire is None else {item.id: item.label for item in questionnaire.items}
        modules = [] if questionnaire is None else questionnaire.modules
        self._turned = frozenset(turned)
        sides = [] if questionnaire is None else questionnaire.dimensions
        self._sides = {side.id: side.label for side in sides}
        self._modules = {module.id: module.title for module in modules}
        self._in_module = {}
        if questionnaire is not None and questionnaire.dimensions:
            homes = {item.id: module for module in modules for item in questionnaire.items_of(module)}
            self._in_module = {key: module.title for key, module in homes.items()}

    def __call__(self, key: str, **values: object) -> str:
        return self._words[key].format(**values) if values else self._words[key]

    def item(self, key: str) -> str:
        """The item's label, with its module's where every module has the same labels; a dimension's; else its key."""
        return self._label(key) + (self("turned_mark") if key in self._turned else "")

    def _label(self, key: str) -> str:
        label = self._items.get(key)
        if label is None:
            return self.dimension(key)
        module = self._in_module.get(key)
        text = label.in_language(self.language)
        return text if module is None else f"{module.in_language(self.language)} · {text}"

    def module(self, key: str) -> str:
        """The module's title, else its key."""
        title = self._modules.get(key)
        return key if title is None else title.in_language(self.language)

    def dimension(self, key: str) -> str:
        """The dimension's label, else its key."""
        label = self._sides.get(key)
        return key if label is None else label.in_language(self.language)

    def items(self, keys: Iterable[str]) -> str:
        """Their labels one after the other."""
        return ("、" if self.language == "zh" else ", ").join(map(self.item, keys))

    def remark(self, note: Note) -> str:
        """What a note says as a sentence of its own, beginning with the items it is about."""
        said = self.note(note)
        said = f"{self.items(note.items)}{self('colon')}{said}" if note.items else said
        end = "" if said[-1] in ".。" else "." if self.language == "en" else "。"
        return said[0].upper() + said[1:] + end

    def way_apart(self, by: str) -> str:
        """What groups differ in, in words; of a table the column's name."""
        return self._words.get(f"by_{by}", f"“{by}”" if self.language == "zh" else by)

    def group(self, by: str, key: str) -> str:
        """A group's name: of languages their own, of everything else its key."""
        return self._words.get(f"language_{key}", key) if by == "language" else key

    def note(self, note: Note) -> str:
        """What a note says; of an error in Chinese its kind, and its own words in brackets."""
        if self.language == "en":
            return note.message
        sentences = _texts()["notes"]
        if note.told is None:
            kind = sentences.get(f"{note.code}_error") or sentences[note.code]
            return f"{kind.rstrip('。')}（{note.message}）"
        return sentences["_".join(filter(None, (note.code, note.form)))].format(**note.told)

    def either(self, texts: tuple[str, str]) -> str:
        """Of (zh, en) the one that is spoken."""
        return texts[0] if self.language == "zh" else texts[1]


def coefficient(value: float | None, digits: int = 3) -> str:
    """−.032 as journals print what cannot exceed 1: a true minus, and no zero before the point."""
    return re.sub(r"^(−?)0\.", r"\1.", decimal(value, digits))


def decimal(value: float | None, digits: int = 3) -> str:
    """A figure with a true minus, "–" where there is none."""
    if value is None or not np.isfinite(value):
        return "–"
    return f"{value:.{digits}f}".replace("-", "−")


def whole(value: float) -> str:
    """A count."""
    return f"{int(value):,}".replace(",", "\u202f")


def probability(p: float) -> str:
    """ "< .001" or "= .023", as after the letter p."""
    return "< .001" if p < 0.001 else f"= {p:.3f}".replace("0.", ".")
