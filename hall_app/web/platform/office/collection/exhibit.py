"""One exhibit: its forms, its files, what its draft lacks; the editor of a text file with both versions beside."""

from __future__ import annotations

from difflib import unified_diff
from html import escape
from typing import Any

from hall_app.content.files import TEXTS
from hall_app.house.drafts import TEXT_FILES
from hall_app.house.people import PeopleError
from hall_app.web.pages.frame import part
from hall_app.web.platform.counter import Asking, Field, Shown, button, form
from hall_app.web.platform.office.collection.desk import (
    TOML,
    Desk,
    language_of,
    listed_problems,
    publish_form,
    refusal,
)
from hall_app.web.platform.office.collection.files import TURN, media_part
from hall_app.web.platform.office.collection.keys import Key, changes_of, fields_of, keys_of, media_keys
from hall_app.web.platform.office.table import office_page

__all__ = ["Exhibits", "difference"]

_RECORD = ("record",)
_SHOWN = ("licence", "thumbnail", "questionnaire", "behaviours")
_STANDS = ("body", "models", "show", "size_range")


class Exhibits:
    def __init__(self, desk: Desk) -> None:
        self._desk = desk

    def one(self, asking: Asking) -> dict[str, Any]:
        key, drafts = self._desk.key(asking), self._desk.drafts
        draft, names = drafts.of(key), drafts.files(key)
        return {
            "id": key,
            "draft": {"by": draft.by, "at": draft.at, "files": dict(draft.files)} if draft else None,
            "mark": drafts.mark(key),
            "stale": list(drafts.stale(key)),
            "problems": [one.as_json() for one in self._desk.problems(key)],
            "files": {
                name: {"sha256": digest, "tag": drafts.tag(key, name)} for name, digest in names.items()
            },
        }

    def text(self, asking: Asking) -> dict[str, Any]:
        """A text file as it is to be, and as the hall has it."""
        key, name = self._desk.key(asking), _text_name(asking.query.get("file", ""))
        drafts = self._desk.drafts
        return {
            "file": name,
            "text": drafts.text(key, name),
            "hall": drafts.hall_text(key, name),
            "tag": drafts.tag(key, name),
        }

    def save_fields(self, asking: Asking) -> dict[str, Any]:
        desk, key = self._desk, self._desk.key(asking)
        table = desk.table(key)
        changes = changes_of(asking.form, self._keys(table), table)
        desk.change(asking, key, changes, tag=asking.form.get("tag"))
        return {"id": key, "changed": [".".join(map(str, one.path)) for one in changes]}

    def save_text(self, asking: Asking) -> dict[str, Any]:
        desk, key, given = self._desk, self._desk.key(asking), asking.form
        name = _text_name(given.get("file", ""))
        try:
            desk.write_text(asking, key, name, given.get("text", ""), given.get("tag"))
        except PeopleError as error:
            if error.key == "changed":
                told = {"now": desk.drafts.text(key, name), "yours": given.get("text", "")}
                raise PeopleError("changed", name=name, tag=desk.drafts.tag(key, name), **told) from None
            raise
        return {"id": key, "file": name, "tag": desk.drafts.tag(key, name)}

    def drop(self, asking: Asking) -> dict[str, Any]:
        key = self._desk.key(asking)
        with self._desk.drafts.lock, self._desk.people.noting(asking.person.id, "draft", key):
            self._desk.drafts.drop(key)
        self._desk.publication.tidy()
        return {"id": key}

    def _keys(self, table: dict[str, Any]) -> tuple[Key, ...]:
        media = table.get("media")
        many = range(len(media) if isinstance(media, list) else 0)
        plain = keys_of("title", "caption", *_RECORD, *_SHOWN, *_STANDS, "place")
        return (*plain, *(key for number in many for key in media_keys(number)))

    def page(self, asking: Asking) -> Shown:
        desk, key, word = self._desk, self._desk.key(asking), asking.word
        table, tag = desk.table(key), desk.drafts.tag(key, TOML)
        at = f"/office/collection/{key}"

        def keyed(name: str, title: str, names: tuple[str, ...], style: str = "pairs") -> str:
            keys = tuple(
                one
                for one in keys_of(*names)
                if one.path[0] not in ("models", "show") or one.path[0] in table
            )
            hidden = {"tag": tag} | ({"behaviours.form": "on"} if "behaviours" in names else {})
            sent = form(
                asking, name, f"{at}/fields", fields_of(asking, keys, table), word("保存", "Save"),
                hidden=hidden, style=style,
            )  # fmt: skip
            return part(name, title, sent)

        texts = "".join(self._text_form(asking, key, name) for name in TEXTS.values())
        forms = ("words", "shown", "record", "stands", "upload", *(f"text-{x}" for x in TEXTS))
        inside = f"""{refusal(asking, *forms)}{self._state(asking, key)}
{keyed("words", word("名称与说明", "Title and caption"), ("title", "caption"))}
{part("texts", word("介绍文字（Markdown）", "Text (Markdown)"), f'<div class="twins">{texts}</div>')}
{media_part(desk, asking, key, table, tag)}
{keyed("record", word("藏品资料", "Catalogue record"), _RECORD)}
{keyed("shown", word("展示", "How it is shown"), _SHOWN)}
{keyed("stands", word("形体与模型", "Body and models"), _STANDS)}
{self._files(asking, key)}"""
        return office_page(
            asking,
            desk.title(key, asking.lang),
            inside,
            path=f"collection/{key}",
            lead=escape(key),
            script=TURN,
        )

    def _text_form(self, asking: Asking, key: str, name: str) -> str:
        drafts, language = self._desk.drafts, language_of(name)
        label = asking.word(
            "中文" if language == "zh" else "英文", "Chinese" if language == "zh" else "English"
        )
        more = {"rows": "12", "lang": language, "class": "prose-in"}
        field = Field("text", label, "textarea", drafts.text(key, name), needed=False, given=more)
        hidden = {"file": name, "tag": drafts.tag(key, name)}
        at = f"/office/collection/{key}/text"
        return form(asking, f"text-{language}", at, (field,), asking.word("保存", "Save"), hidden=hidden)

    def _state(self, asking: Asking, key: str) -> str:
        """Where the exhibit is between draft and hall, and what can be done about it."""
        desk, word, at = self._desk, asking.word, f"/office/collection/{key}"
        draft = desk.drafts.of(key)
        ways = [("preview", word("预览", "Preview"))]
        ways += [("place", word("在平面图上布置", "Place on the plan"))] if asking.person.may("place") else []
        ways += [("history", word("历史", "History"))]
        links = "".join(
            f'<a class="way" href="{asking.address(f"{at}/{way}")}">{name}</a>' for way, name in ways
        )
        wrong = listed_problems(asking, desk.problems(key))
        if draft is None:
            told = word("展厅中即为此版本，没有草稿。", "The hall shows just this; there is no draft.")
            return f'<div class="state"><p>{told}</p><div class="deeds">{links}</div>{wrong}</div>'
        names = "".join(
            f"<li><code>{escape(name)}</code>{'' if digest else word('（删除）', ' (goes)')}</li>"
            for name, digest in sorted(draft.files.items())
        )
        stale = desk.drafts.stale(key)
        warned = "".join(
            f'<p class="refused">{escape(PeopleError("changed", name=name).text(asking.lang))} '
            f'<a href="{escape(asking.address(f"{at}/text", file=name))}">{word("并排查看", "See both")}</a></p>'
            for name in stale
            if name in TEXT_FILES
        )
        deeds = button(asking, "drop", f"{at}/drop", word("放弃草稿", "Drop the draft"), hidden={})
        if asking.person.may("publish"):
            deeds = publish_form(desk, asking, key) + deeds
        told = word("草稿，尚未在展厅中显示：", "A draft, not in the hall yet:")
        return f"""<div class="state drafted"><p><b>{told}</b></p><ul class="names">{names}</ul>{warned}{wrong}
<div class="deeds">{deeds}{links}</div></div>"""

    def _files(self, asking: Asking, key: str) -> str:
        word, at = asking.word, f"/office/collection/{key}"
        lines = []
        for name in sorted(self._desk.drafts.files(key)):
            query = {"file": name} if name in TEXT_FILES else {"name": name}
            way = asking.address(f"{at}/{'text' if name in TEXT_FILES else 'file'}", **query)
            size = self._desk.drafts.path(key, name).stat().st_size
            goes = ""
            if name not in TEXT_FILES:
                goes = button(
                    asking,
                    "remove",
                    f"{at}/remove",
                    word("删除", "Remove"),
                    about=name,
                    hidden={"file": name},
                )
            named = f'<a href="{escape(way)}">{escape(name)}</a><br><span class="quiet">{size / 1000:,.1f} kB</span>'
            lines.append(f"<li><span>{named}</span>{goes}</li>")
        title = word("文件", "Files")
        told = word(
            "文本文件可整份编辑，注释与次序保留。",
            "A text file opens whole in an editor; comments and order stay.",
        )
        return part("files", title, f'<p class="quiet">{told}</p><ul class="rows">{"".join(lines)}</ul>')

    def text_page(self, asking: Asking) -> Shown:
        desk, key, word = self._desk, self._desk.key(asking), asking.word
        name = _text_name(asking.form.get("file") or asking.query.get("file", ""))
        mine, hall = desk.drafts.text(key, name), desk.drafts.hall_text(key, name)
        yours = asking.form.get("text", "").replace("\r\n", "\n") if asking.refusal else mine
        at = f"/office/collection/{key}"
        more = {
            "rows": "26",
            "class": "code-in",
            "spellcheck": "false",
            "wrap": "off" if name == TOML else "soft",
        }
        field = Field("text", name, "textarea", mine, needed=False, given=more)
        hidden = {"file": name, "tag": desk.drafts.tag(key, name)}
        sent = form(
            asking, "text", f"{at}/text", (field,), word("存入草稿", "Save to the draft"), hidden=hidden
        )
        others = []
        if asking.refusal and mine != yours:
            others.append((word("现在的草稿", "The draft as it is now"), mine))
        if hall != mine or (asking.refusal and hall != yours):
            others.append((word("展厅中的版本", "In the hall"), hall))
        shown = "".join(
            f'<section><h2 class="small">{title}</h2>{difference(asking, text, yours, title)}</section>'
            for title, text in others
        )
        back = f'<p class="doors"><a href="{asking.address(at)}">{word("回到展品", "Back to the exhibit")}</a></p>'
        title = f"{desk.title(key, asking.lang)} · {name}"
        inside = f"{refusal(asking, 'text')}{sent}{shown}{back}"
        return office_page(asking, title, inside, path=f"collection/{key}/text", query={"file": name})


def _text_name(name: str) -> str:
    if name not in TEXT_FILES:
        raise PeopleError("no-file")
    return name


def difference(asking: Asking, before: str, after: str, name: str) -> str:
    """Lines that differ, with those about them; first the words where there are none."""
    lines = list(unified_diff(before.splitlines(), after.splitlines(), n=2, lineterm=""))[2:]
    if not lines:
        return f'<p class="quiet">{asking.word("没有差别。", "No difference.")}</p>'
    kinds = {"+": "plus", "-": "minus", "@": "at"}
    words = {"+": asking.word("新增", "added"), "-": asking.word("删去", "removed")}
    shown = "".join(
        f'<span class="{kinds.get(line[:1], "same")}">'
        + (f'<span class="unseen">{words[line[0]]} </span>' if line[:1] in words else "")
        + f"{escape(line)}\n</span>"
        for line in lines
    )
    return f'<pre class="diff" tabindex="0" role="group" aria-label="{escape(name)}">{shown}</pre>'
