"""The exhibits as the office sees them: in the hall, drafts, problems, bakes; and a new one."""

from __future__ import annotations

from html import escape
from typing import Any

from hall_app.content.views.scene import thumbnail
from hall_app.house.drafts import LONGEST_ID
from hall_app.house.people import PeopleError
from hall_app.web.platform.counter import Asking, Field, Shown, form
from hall_app.web.platform.office.collection.desk import TOML, Desk
from hall_app.web.platform.office.table import office_page

__all__ = ["Listing"]

_NEW = """\
title = {{ zh = {zh}, en = {en} }}
behaviours = ["open_on_click", "glow_when_near"]
licence = "CC0-1.0"

[place]
x = {x}
z = {z}
facing = {facing}

[models]
hall = "media/model.glb"

[body]
shape = "round"
radius = 0.5
height = 1.8
"""


class Listing:
    def __init__(self, desk: Desk) -> None:
        self._desk = desk

    def all(self, asking: Asking) -> list[dict[str, Any]]:
        desk, drafts = self._desk, self._desk.drafts.all()
        home = desk.drafts.content / "exhibits"
        published = {path.name for path in home.iterdir() if path.is_dir()} if home.is_dir() else set()
        wrong = [one.file for one in desk.house.own_problems]
        return [
            {
                "id": key,
                "title": {lang: desk.title(key, lang) for lang in ("zh", "en")},
                "published": key in published,
                "draft": {"by": drafts[key].by, "at": drafts[key].at} if key in drafts else None,
                "problems": sum(name.startswith(f"exhibits/{key}/") for name in wrong),
                "bake": self._bake(key),
            }
            for key in sorted(published | set(drafts))
            if _sound(key)
        ]

    def _bake(self, key: str) -> str:
        """ "none" to bake, "ready", "coming" or "failed"."""
        house = self._desk.house
        exhibit = house.content.exhibit(key)
        if exhibit is None or exhibit.file.baked_key is None:
            return "none"
        return "coming" if key in house.preparing else "failed" if house.given_up(exhibit) else "ready"

    def make(self, asking: Asking) -> dict[str, Any]:
        desk, given = self._desk, asking.form
        key = given.get("id", "").strip()
        titles = {lang: given.get(f"title.{lang}", "").strip() for lang in ("zh", "en")}
        if not all(titles.values()) or max(map(len, titles.values())) > 200:
            raise PeopleError("content-file", why="title: needs both languages, 200 characters each at most")
        place = {name: repr(value) for name, value in desk.first_place().items()}
        quoted = {lang: _quoted(text) for lang, text in titles.items()}
        table = _NEW.format(**quoted, **place)
        texts = {f"text.{lang}.md": f"{text}\n".encode() for lang, text in titles.items()}
        with desk.drafts.lock:  # of two who want the same name at once one has it
            if desk.drafts.known(key):
                raise PeopleError("exhibit-taken")
            with desk.people.noting(asking.person.id, "draft", key):
                desk.drafts.set(asking.person.id, key, {TOML: table.encode(), **texts}, {})
        return {"id": key}

    def page(self, asking: Asking) -> Shown:
        word = asking.word
        cards = "".join(self._card(asking, one) for one in self.all(asking))
        fields = (
            Field(
                "id",
                word("文件夹名", "Name of its folder"),
                hint=word("小写字母、数字与连字符，如 song-robe", "a-z, 0-9 and hyphens: song-robe"),
                given={"maxlength": str(LONGEST_ID), "autocomplete": "off", "spellcheck": "false"},
            ),
            Field(
                "title.zh", word("名称（中文）", "Title (Chinese)"), given={"maxlength": "200", "lang": "zh"}
            ),
            Field(
                "title.en", word("名称（英文）", "Title (English)"), given={"maxlength": "200", "lang": "en"}
            ),
        )
        new = form(asking, "exhibit", "/office/collection", fields, word("新建草稿", "Begin a draft"))
        told = word(
            "改动先成草稿，检查无误后由策展人发布；展厅在两秒内更新。",
            "Changes are a draft first; a curator publishes them, checked, and the hall shows them within two seconds.",
        )
        by_hand = word(
            "这里只编辑展品。文章、词语、论文与全馆设置请直接改内容文件夹里的 articles/、glossary.toml、"
            "research/papers.toml 与 hall.toml，写法见同一文件夹 README.md 里以文件名为题的各节；存盘即见。",
            "Exhibits alone are edited here. Articles, glossary, papers and the hall's settings are edited by hand, in "
            "the content folder: articles/, glossary.toml, research/papers.toml and hall.toml. Its README.md has a "
            "section under each file's name; what is saved is shown at once.",
        )
        bakes = (
            f'<p class="doors"><a href="{asking.address("/office/bakes")}">{word("烘焙队列", "Bakes")}</a></p>'
            if asking.person.may("bake")
            else ""
        )
        inside = f"""<ul class="pieces">{cards}</ul>{bakes}<h2 class="small">{word("新展品", "A new exhibit")}</h2>
<div class="desk">{new}</div><p class="quiet">{by_hand}</p>"""
        return office_page(asking, word("藏品", "Collection"), inside, path="collection", lead=told)

    def _card(self, asking: Asking, one: dict[str, Any]) -> str:
        word, key = asking.word, one["id"]
        states = []
        if one["draft"]:
            states.append(f'<span class="mark draft">{word("草稿", "Draft")}</span>')
        if not one["published"]:
            states.append(f'<span class="mark">{word("未发布", "Not in the hall")}</span>')
        if one["problems"]:
            wrong = word(f"{one['problems']} 处问题", f"{one['problems']} to put right")
            states.append(f'<span class="mark wrong">{wrong}</span>')
        bake = {
            "coming": word("正在烘焙", "Being baked"),
            "failed": word("烘焙失败", "Bake failed"),
        }.get(one["bake"])
        if bake:
            states.append(f'<span class="mark {"wrong" if one["bake"] == "failed" else ""}">{bake}</span>')
        at = escape(asking.address(f"/office/collection/{key}"))
        told = "".join(states) or f'<span class="mark good">{word("在展", "In the hall")}</span>'
        return f"""<li>{self._picture(key)}<div><h2><a href="{at}">{escape(one["title"][asking.lang])}</a></h2>
<p class="quiet">{escape(key)}</p><p class="marks">{told}</p></div></li>"""

    def _picture(self, key: str) -> str:
        exhibit = self._desk.house.content.exhibit(key)
        url = thumbnail(exhibit, self._desk.house.bakes().get(key)) if exhibit else None
        small = escape(url.replace("/media/", "/thumbnails/", 1)) if url else ""
        return f'<img src="{small}" alt="" loading="lazy">' if small else '<span class="blank"></span>'


def _sound(key: str) -> bool:
    """Whether a folder's name can be an exhibit's: others are the check's affair."""
    return len(key) <= LONGEST_ID and all(c in "abcdefghijklmnopqrstuvwxyz0123456789-" for c in key)


def _quoted(text: str) -> str:
    """As a TOML string of one line."""
    import tomlkit

    return tomlkit.item(" ".join(text.split())).as_string()
