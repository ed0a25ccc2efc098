"""What was published of an exhibit: put in place, told with its differences, taken back."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import Any

from hall_app.house.drafts import TEXT_FILES
from hall_app.house.people import PeopleError
from hall_app.house.people.records import Revision
from hall_app.web.platform.counter import Asking, Shown, button, leaf_asked, leaf_ways, told_time
from hall_app.web.platform.office.collection.desk import Desk, refusal
from hall_app.web.platform.office.collection.exhibit import difference
from hall_app.web.platform.office.deeds import number_in
from hall_app.web.platform.office.table import office_page

__all__ = ["History"]

LISTED = 100  # changes on a page
_LONGEST = 200_000  # [bytes] of a text that is compared


class History:
    def __init__(self, desk: Desk) -> None:
        self._desk = desk

    def publish(self, asking: Asking) -> dict[str, Any]:
        key = self._desk.key(asking)
        self._desk.publication.publish(asking.person.id, key, asking.form.get("seen"))
        return {"id": key}

    def undo(self, asking: Asking) -> dict[str, Any]:
        key, number = self._desk.key(asking), number_in(asking.form.get("revision", ""))
        if self._desk.people.revisions.one(number).exhibit != key:
            raise PeopleError("no-revision")
        self._desk.publication.undo(asking.person.id, number)
        return {"id": key, "undone": number}

    def all(self, asking: Asking) -> list[dict[str, Any]]:
        return [
            {
                "id": one.id,
                "at": one.at.isoformat(),
                "who": one.who,
                "act": one.act,
                "files": {name: list(pair) for name, pair in one.files.items()},
            }
            for one in self._revisions(asking)[0]
        ]

    def _revisions(self, asking: Asking) -> tuple[tuple[Revision, ...], bool]:
        """Those of the page that is asked for, and whether there are more."""
        # Of an exhibit whose publication was taken back the history is there still.
        key = asking.names["key"]
        start = (leaf_asked(asking) - 1) * LISTED
        found = self._desk.people.revisions.of(key[:64], start=start, most=LISTED + 1)
        if not found:
            self._desk.key(asking)
        return found[:LISTED], len(found) > LISTED

    def page(self, asking: Asking) -> Shown:
        word, (found, more), key = asking.word, self._revisions(asking), asking.names["key"]
        at = f"/office/collection/{key}/history"
        pages = leaf_ways(asking, at, leaf_asked(asking), more=more)
        names = {one.id: one.name or one.address for one in self._desk.people.accounts.all(most=10_000)}
        told = "".join(self._one(asking, key, one, names) for one in found)
        none = f"<p>{word('还没有经办公室发布的改动。', 'Nothing has been published here by the office yet.')}</p>"
        known = self._desk.drafts.known(key)
        back = f"/office/collection/{key}" if known else "/office/collection"
        way = f'<p class="doors"><a href="{asking.address(back)}">{word("返回", "Back")}</a></p>'
        title = f"{self._desk.title(key, asking.lang)} · {word('历史', 'History')}"
        inside = (
            f'{refusal(asking)}<ol class="programme kept">{told}</ol>' if told else refusal(asking) + none
        )
        return office_page(asking, title, inside + pages + way, path=f"collection/{key}/history")

    def _one(self, asking: Asking, key: str, one: Revision, names: dict[str, str]) -> str:
        word = asking.word
        act = word("发布", "Published") if one.act == "publish" else word("撤销", "Undone")
        many = word("个文件", "file" if len(one.files) == 1 else "files")
        parts = "".join(self._file(asking, name, *pair) for name, pair in sorted(one.files.items()))
        undo = ""
        if asking.person.may("undo"):
            undo = button(
                asking, "undo", f"/office/collection/{key}/undo", word("撤销此次改动", "Undo this change"),
                about=str(one.id), hidden={"revision": str(one.id)},
            )  # fmt: skip
        return f"""<li><p class="kicker">{told_time(one.at, asking.lang)} · {escape(names.get(one.who, one.who))}</p>
<h2>{act} · {len(one.files)} {many}</h2>{parts}{undo}</li>"""

    def _file(self, asking: Asking, name: str, before: str, after: str) -> str:
        word = asking.word
        how = (
            word("新增", "new")
            if not before
            else word("删除", "removed")
            if not after
            else word("更改", "changed")
        )
        line = f"<code>{escape(name)}</code> <span class='quiet'>{how}</span>"
        if name not in TEXT_FILES:
            return f"<p>{line}</p>"
        texts = [self._text(digest) for digest in (before, after)]
        if None in texts:
            return f"<p>{line}</p>"
        shown = difference(asking, texts[0] or "", texts[1] or "", name)
        return f"<details><summary>{line}</summary>{shown}</details>"

    def _text(self, digest: str) -> str | None:
        """Of a file as it was, None where it is not kept or too long to compare."""
        if not digest:
            return ""
        try:
            path: Path = self._desk.drafts.shelf.path(digest)
        except PeopleError:
            return None
        return path.read_text("utf-8-sig", "replace") if path.stat().st_size <= _LONGEST else None
