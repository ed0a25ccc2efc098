"""The codebook: what each column means, in both languages, as a CSV table."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from survey.export.cells import safe_cell
from survey.export.csv_file import ANONYMITY, BOM
from survey.questionnaire import META_COLUMNS, NOT_ASKED, Questionnaire, Text, suggestion_column

if TYPE_CHECKING:
    from survey.export.anonymity import Anonymity

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
    "reverse",
)
_META = {
    "submission": (
        "回答的代号，由撤回码单向算出，不能用来撤回",
        "Pseudonym of the answer, made one-way from its withdrawal code; withdraws nothing",
    ),
    "version": ("问卷版本", "Version of the questionnaire"),
    "language": ("作答语言", "Language in which it was answered"),
    "exhibit": ("展品", "Exhibit at which it was asked"),
    "received": ("收到时间（UTC）", "When it was received (UTC)"),
}


_COARSE = {"hour": "精确到小时", "day": "精确到日", "week": "精确到周", "month": "精确到月"}


@dataclass(frozen=True)
class Variable:
    """A column of the export. points: (zh, en) of 1, 2, …, only for items; unseen: the words for a missing score;
    needs: what a place must have for the item to be asked, None: nothing; reverse: worded the other way round."""

    column: str
    kind: str
    label: tuple[str, str]
    module: tuple[str, str] = ("", "")
    tags: tuple[str, ...] = ()
    points: tuple[tuple[str, str], ...] = ()
    unseen: tuple[str, str] | None = None
    needs: str | None = None
    reverse: bool = False


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
            tags, needs = tuple(item.tags), item.needs or module.needs
            title = _both(module.title)
            found.append(
                Variable(
                    item.id,
                    "score",
                    label,
                    title,
                    tags,
                    points,
                    unseen=gap,
                    needs=needs,
                    reverse=item.reverse,
                )
            )
    for module in questionnaire.modules:
        if module.suggestion is not None:
            label, title = _both(module.suggestion), _both(module.title)
            found.append(Variable(suggestion_column(module.id), "text", label, title))
    return found


def write_codebook(questionnaire: Questionnaire, anonymity: Anonymity | None = None) -> str:
    """The codebook as CSV text with a byte order mark. anonymity: what was made coarse of the file it is of."""
    out = io.StringIO(newline="")
    out.write(BOM)
    table = csv.writer(out)
    table.writerow(HEAD)
    for one in _anonymous(questionnaire, anonymity) if anonymity else variables(questionnaire):
        values = [
            "; ".join(f"{at} = {point[side]}" for at, point in enumerate(one.points, 1)) for side in (0, 1)
        ]
        gaps = [] if one.unseen is None else [f"{one.unseen[0]} / {one.unseen[1]}"]
        if one.needs is not None:
            gaps.append(f"{NOT_ASKED} = 未询问 / not asked (needs {one.needs})")
        missing = "; ".join(gaps)
        row = [one.column, one.kind, *one.label, *one.module, " ".join(one.tags), *values, missing]
        row.append("reverse" if one.reverse else "")
        table.writerow([safe_cell(cell) for cell in row])
    return out.getvalue()


def _anonymous(questionnaire: Questionnaire, anonymity: Anonymity) -> list[Variable]:
    """The columns that are left, each with how coarse it is, and one that says what was done."""
    from survey.export.anonymity import LEFT_OUT

    found = []
    for one in variables(questionnaire):
        level = anonymity.levels.get(one.column, "kept" if one.column == "version" else LEFT_OUT)
        if one.kind == "score":
            found.append(one)
        elif one.column in META_COLUMNS and level != LEFT_OUT:
            zh, en = one.label
            coarse = "" if level == "kept" else _COARSE[level]
            found.append(
                replace(one, label=(f"{zh}{coarse and '：' + coarse}", f"{en}{coarse and ': ' + level}"))
            )
    done = (f"k 匿名处理（k = {anonymity.k}）", anonymity.told())
    return [*found, Variable(ANONYMITY, "note", done)]


def _both(text: Text) -> tuple[str, str]:
    return text.zh, text.en
