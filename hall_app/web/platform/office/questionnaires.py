"""The questionnaires for the researcher: how many answered, the analysis, the answers as files."""

from __future__ import annotations

import json
from collections.abc import Iterator
from html import escape
from typing import Any

from hall_app.content.problems import in_language
from hall_app.house.people import PeopleError
from hall_app.web.platform.counter import Asking, Counter, Download, Shown
from hall_app.web.platform.office.deeds import Reading, number_in
from hall_app.web.platform.office.table import office_page, rows
from survey.errors import AnswerError

__all__ = ["questionnaire_readings"]

_FILES = {
    "csv": ("text/csv", "CSV"),
    "xlsx": ("application/vnd.openxmlformats-officedocument.spreadsheetml.sheet", "Excel"),
    "sav": ("application/octet-stream", "SPSS"),
    "json": ("application/json", "JSON"),
    "codebook": ("text/csv", ""),
    "r": ("text/plain", "R"),
}
_ONE = "questionnaires/{key}"


def questionnaire_readings(counter: Counter) -> tuple[Reading, ...]:
    rooms = _Rooms(counter)
    version = {"version": "one that was answered; left out: the current one"}
    kinds = {"kind": " or ".join(_FILES), **version}
    return (
        Reading("questionnaires", "questionnaires", rooms.all, rooms.page),
        Reading(f"{_ONE}/analysis", "analysis", rooms.analysis, rooms.analysis_page, version),
        Reading(f"{_ONE}/export", "export", rooms.export, rooms.file, kinds),
    )


class _Rooms:
    def __init__(self, counter: Counter) -> None:
        self._house, self._people = counter.house, counter.people

    def all(self, asking: Asking) -> list[dict[str, Any]]:
        return self._house.survey_standing()

    def _one(self, asking: Asking) -> tuple[dict[str, Any], int]:
        """Which questionnaire is asked for, in which version. Raises PeopleError, StoreError."""
        for one in self.all(asking):
            if one["id"] == asking.names["key"]:
                return one, number_in(asking.query.get("version", str(one["version"])))
        raise PeopleError("no-questionnaire")

    def _made(
        self, asking: Asking, version: int, task: str, language: str | None = None
    ) -> tuple[str, bytes]:
        """It is made, and handed out once that is written down. Raises PeopleError, StoreError."""
        key, make = asking.names["key"], self._house.survey_made
        if make is None:
            raise PeopleError("no-questionnaire")
        try:
            made = make(key, task, version, language)
        except AnswerError as error:
            raise PeopleError("survey-refused", why=f"{error.problem} – {error.remedy}") from None
        act = "analysis" if task == "analysis" else "export"
        self._people.note(asking.person.id, act, f"{key} version {version} {task}")
        return made

    def analysis(self, asking: Asking) -> dict[str, Any]:
        return json.loads(self._made(asking, self._one(asking)[1], "analysis")[1])

    def export(self, asking: Asking) -> dict[str, Any]:
        """Where the file is: programs fetch it there, with the same session."""
        one, version = self._one(asking)
        at = f"/office/questionnaires/{one['id']}/export?version={version}&kind="
        return {"files": {kind: f"{at}{kind}" for kind in _FILES}}

    def file(self, asking: Asking) -> Download:
        kind = asking.query.get("kind", "csv")
        if kind not in _FILES:
            raise PeopleError("no-file")
        name, data = self._made(asking, self._one(asking)[1], kind)
        return Download(data, name, _FILES[kind][0])

    def _lines(self, asking: Asking, one: dict[str, Any]) -> list[tuple[str, ...]]:
        """Of a questionnaire: its version, then earlier ones that were answered, the newest first."""
        word, at = asking.word, f"/office/questionnaires/{one['id']}"
        name, lines = escape(one["title"][asking.lang]), []
        if one["asked"]:
            name = f'<a href="/questionnaires/{escape(one["id"])}?lang={asking.lang}">{name}</a>'
        for number, answers in sorted({one["version"]: 0, **one["versions"]}.items(), reverse=True):
            now, ways = number == one["version"], []
            if asking.person.may("analysis") and answers:
                way = asking.address(f"{at}/analysis", version=str(number))
                ways.append((way, word("分析", "Analysis")))
            if asking.person.may("export"):
                ways += [
                    (
                        asking.address(f"{at}/export", version=str(number), kind=kind),
                        title or word("编码本", "Codebook"),
                    )
                    for kind, (_, title) in _FILES.items()
                ]
            links = " ".join(f'<a href="{escape(where)}">{escape(title)}</a>' for where, title in ways)
            state = word("开放", "open") if one["asked"] else word("不提问", "asks nothing")
            lines.append(
                (
                    name,
                    str(number),
                    f"<b>{answers}</b>",
                    str(one["items"]) if now else "–",
                    state if now else word("旧版", "earlier"),
                    f'<span class="doors-in">{links}</span>',
                )
            )
        return lines

    def page(self, asking: Asking) -> Shown:
        word = asking.word
        lines = [line for one in self.all(asking) for line in self._lines(asking, one)]
        heads = (
            word("问卷", "Questionnaire"),
            word("版本", "Version"),
            word("答卷", "Answers"),
            word("题目", "Items"),
            word("状态", "State"),
            word("分析与导出", "Analysis, files"),
        )
        title = word("问卷", "Questionnaires")
        told = word(
            "导出与分析都记入日志。答卷不含姓名；文本仍可能透露个人，请妥善保存。",
            "Files and analyses are noted in the journal. Answers name nobody; texts may tell of one: keep them well.",
        )
        none = f"<p>{word('还没有问卷。', 'There is none yet.')}</p>"
        return office_page(
            asking, title, rows(title, heads, lines) if lines else none, path="questionnaires", lead=told
        )

    def analysis_page(self, asking: Asking) -> Shown:
        word, (one, version) = asking.word, self._one(asking)
        found = json.loads(self._made(asking, version, "analysis", asking.lang)[1])
        name = f"{one['title'][asking.lang]} · {word('分析', 'Analysis')} · v{version}"
        facts = (
            (word("答卷", "Answers"), found.get("n")),
            ("KMO", found.get("kmo")),
            ("Cronbach α", found.get("alpha")),
            ("McDonald ω", found.get("omega")),
        )
        listed = "".join(f"<dt>{label}</dt><dd>{_figure(value)}</dd>" for label, value in facts)
        items = found.get("items") or []
        deleted, total = found.get("alpha_if_deleted") or {}, found.get("item_total") or {}
        lines = [(escape(item), _figure(total.get(item)), _figure(deleted.get(item))) for item in items]
        heads = (word("题目", "Item"), word("题总相关", "Item–total"), word("删除后 α", "α if deleted"))
        notes = "".join(f"<li>{escape(one)}</li>" for one in _remarks(found, asking.lang))
        warned = f'<ul class="names">{notes}</ul>' if notes else ""
        more = word(
            "完整分析：survey analyse，或 /api/office/questionnaires/…/analysis。",
            "All of it: survey analyse, or /api/office/questionnaires/…/analysis.",
        )
        back = f'<a href="{asking.address("/office/questionnaires")}">{word("返回", "Back")}</a>'
        inside = f"""<dl class="how">{listed}</dl>{rows(name, heads, lines)}{warned}
<p class="quiet">{more}</p><p class="doors">{back}</p>"""
        where, query = f"questionnaires/{one['id']}/analysis", {"version": str(version)}
        return office_page(asking, name, inside, path=where, query=query)


def _figure(value: Any) -> str:
    """A number as papers print it, a dash for none."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return "–"
    return str(value) if isinstance(value, int) else f"{value:.3f}"


def _remarks(found: dict[str, Any], language: str) -> Iterator[str]:
    """What the analysis warns of. The survey tells why a step failed in the words of the error, which are English."""
    for remark, warning in zip(found["remarks"], found["warnings"], strict=True):
        yield remark.replace(warning["message"], in_language(warning["message"], language))
