"""Answers as JSON: the questionnaire as it was asked, and every answer."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import asdict
from typing import Any, BinaryIO

from survey.export.sheet import Record, Sheet
from survey.questionnaire import META_COLUMNS, NOT_ASKED

__all__ = ["put_json", "put_rows", "put_suggestions"]


def put_json(sheet: Sheet, out: BinaryIO) -> None:
    """{"questionnaire": its document, "answers": [{submission, …, scores: {…}, suggestions: {…}}, …]}.

    Of answers that were made coarse also "anonymity": {k, levels, answers, suppressed}, and only what is left of them.
    """
    head: dict[str, Any] = {"questionnaire": sheet.questionnaire.document()}
    if sheet.anonymity is not None:
        head["anonymity"] = asdict(sheet.anonymity)
    out.write(_indented(head, 0).removesuffix("\n}").encode() + b',\n "answers": [')
    number = -1
    for number, answer in enumerate(_answers(sheet)):
        out.write((",\n  " if number else "\n  ").encode() + _indented(answer, 2).encode())
    out.write(b"]\n}\n" if number < 0 else b"\n ]\n}\n")


def put_rows(sheet: Sheet, out: BinaryIO) -> None:
    """The answers alone, on one line; times with their zone written out."""
    for answer in _listed(out, _answers(sheet)):
        answer["received"] = answer["received"].removesuffix("Z") + "+00:00"


def put_suggestions(sheet: Sheet, out: BinaryIO) -> None:
    """[{submission, language, module, text}, …] on one line."""
    texts = (
        {"submission": answer["submission"], "language": answer["language"], "module": module, "text": text}
        for answer in _answers(sheet)
        for module, text in answer["suggestions"].items()
    )
    for _ in _listed(out, texts):
        pass


def _listed(out: BinaryIO, values: Iterable[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Hands out each value to be changed, then writes it."""
    out.write(b"[")
    for number, value in enumerate(values):
        yield value
        text = json.dumps(value, ensure_ascii=False, separators=(",", ":"))
        out.write((b"," if number else b"") + text.encode())
    out.write(b"]")


def _indented(value: object, spaces: int) -> str:
    # A line break inside a text is written as \n, so every real one is the file's own.
    return json.dumps(value, ensure_ascii=False, indent=1).replace("\n", "\n" + " " * spaces)


def _answers(sheet: Sheet) -> Iterator[dict[str, Any]]:
    """An answer without an exhibit has null there; an item that was not asked is not among the scores."""
    items, first, last = (
        sheet.questionnaire.item_ids,
        len(sheet.meta),
        len(sheet.meta) + len(sheet.questionnaire.items),
    )
    for record in sheet.records:
        told: dict[str, Any] = dict(zip(sheet.meta, record, strict=False))
        if "exhibit" in told:
            told["exhibit"] = told["exhibit"] or None
        told["scores"] = _there(items, record[first:last], NOT_ASKED)
        if sheet.meta == META_COLUMNS:
            told["suggestions"] = _there(sheet.modules, record[last:], "")
        yield told


def _there(names: Iterable[str], cells: Record, absent: str) -> dict[str, str | int | None]:
    return {name: cell for name, cell in zip(names, cells, strict=True) if cell != absent}
