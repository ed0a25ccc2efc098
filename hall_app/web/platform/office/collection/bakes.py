"""What is being baked, what waits, what failed: told, stopped, tried again."""

from __future__ import annotations

from html import escape
from typing import Any
from urllib.parse import quote

from hall_app.content.problems import in_language
from hall_app.house.baking import ROOM
from hall_app.house.people import PeopleError
from hall_app.web.platform.counter import Asking, Shown, button
from hall_app.web.platform.office.collection.desk import Desk, refusal
from hall_app.web.platform.office.table import office_page, rows

__all__ = ["Bakes"]


class Bakes:
    def __init__(self, desk: Desk) -> None:
        self._desk = desk

    def all(self, asking: Asking) -> list[dict[str, Any]]:
        """state: "running", "waiting" or "failed"; line: what it is doing, or why it failed."""
        queue = self._desk.house.queue
        return (
            [{"name": one.name, "state": one.state, "line": one.line} for one in queue.now()] if queue else []
        )

    def stop(self, asking: Asking) -> dict[str, Any]:
        return self._ask(asking, ("running", "waiting"), "stop")

    def again(self, asking: Asking) -> dict[str, Any]:
        return self._ask(asking, ("failed",), "again")

    def _ask(self, asking: Asking, states: tuple[str, ...], what: str) -> dict[str, Any]:
        name, queue = asking.names["key"], self._desk.house.queue
        if queue is None or name not in {one.name for one in queue.now() if one.state in states}:
            raise PeopleError("no-bake")
        self._desk.people.note(asking.person.id, "bake", f"{what} {name}")
        queue.ask(what, name)
        return {"name": name}

    def page(self, asking: Asking) -> Shown:
        word = asking.word
        states = {
            "running": word("进行中", "under way"),
            "waiting": word("等待", "waits"),
            "failed": word("失败", "failed"),
        }
        lines = []
        for one in self.all(asking):
            name = (
                word("展厅灯光", "The room's light")
                if one["name"] == ROOM
                else self._desk.title(one["name"], asking.lang)
            )
            act, words = (
                ("again", word("再试", "Try again"))
                if one["state"] == "failed"
                else ("stop", word("停止", "Stop"))
            )
            deed = button(
                asking, act, f"/office/bakes/{quote(one['name'])}/{act}", words, about=name, hidden={}
            )
            line = escape(in_language(one["line"], asking.lang))
            lines.append((escape(name), states[one["state"]], line, deed))
        heads = (
            word("什么", "What"),
            word("状态", "State"),
            word("进展", "Progress"),
            f'<span class="unseen">{word("操作", "Acts")}</span>',
        )
        title = word("烘焙队列", "Bakes")
        told = word(
            "展品改动后所需的模型与灯光逐一烘焙；展厅期间仍显示上一版本。",
            "What a change asks for is baked one after the other; until then the hall shows the last version.",
        )
        listed = (
            rows(title, heads, lines)
            if lines
            else f"<p>{word('没有烘焙任务。', 'Nothing is being baked.')}</p>"
        )
        again = f'<p class="doors"><a href="{asking.address("/office/bakes")}">{word("刷新", "Look again")}</a></p>'
        inside = refusal(asking) + listed + again
        return office_page(asking, title, inside, path="bakes", lead=told)
