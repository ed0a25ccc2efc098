"""The codebook: what each column means, in both languages, as a CSV table."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass

from survey.export.cells import safe_cell
from survey.export.csv_file import BOM
from survey.questionnaire import Questionnaire, Text, suggestion_column

__all__ = ["HEAD", "Variable", "variables", "write_codebook"]

HEAD = (
    "column",
    "kind",
    "label_zh",
    "label_en",
    "module_zh",
    "module_en",
    "tags",
    "values_zh",
    "values_en",
    "missing",
)
_META = {
    "submission": ("回答的编号（即撤回码）", "Id of the answer, its withdrawal code"),
    "version": ("问卷版本", "Version of the questionnaire"),
    "language": ("作答语言", "Language in which it was answered"),
    "exhibit": ("展品", "Exhibit at which it was asked"),
    "received": ("收到时间（UTC）", "When it was received (UTC)"),
}


@dataclass(frozen=True)
class Variable:
    """A column of the export. points: (zh, en) of 1, 2, …, only for items; unseen: the words for a missing score."""

    column: str
    kind: str
    label: tuple[str, str]
    module: tuple[str, str] = ("", "")
    tags: tuple[str, ...] = ()
    points: tuple[tuple[str, str], ...] = ()
    unseen: tuple[str, str] | None = None


def variables(questionnaire: Questionnaire) -> list[Variable]:
    """Every column of the export, in its order."""
    points = tuple(_both(anchor) for anchor in questionnaire.scale.anchors)
    unseen = questionnaire.scale.not_seen
    found = [Variable(column, "meta", label) for column, label in _META.items()]
    for module in questionnaire.modules:
        for item in questionnaire.items_of(module):
            label = _both(item.label)
            if item.dimension is not None:  # the same six labels stand in every module
                label = (f"{module.title.zh} · {label[0]}", f"{module.title.en} · {label[1]}")
            gap = None if unseen is None else _both(unseen)
            found.append(
                Variable(item.id, "score", label, _both(module.title), tuple(item.tags), points, gap)
            )
    for module in questionnaire.modules:
        if module.suggestion is not None:
            label, title = _both(module.suggestion), _both(module.title)
            found.append(Variable(suggestion_column(module.id), "text", label, title))
    return found


def write_codebook(questionnaire: Questionnaire) -> str:
    """The codebook as CSV text with a byte order mark."""
    out = io.StringIO(newline="")
    out.write(BOM)
    table = csv.writer(out)
    table.writerow(HEAD)
    for one in variables(questionnaire):
        values = [
            "; ".join(f"{at} = {point[side]}" for at, point in enumerate(one.points, 1)) for side in (0, 1)
        ]
        missing = "" if one.unseen is None else f"{one.unseen[0]} / {one.unseen[1]}"
        row = [one.column, one.kind, *one.label, *one.module, " ".join(one.tags), *values, missing]
        table.writerow([safe_cell(cell) for cell in row])
    return out.getvalue()


def _both(text: Text) -> tuple[str, str]:
    return text.zh, text.en
