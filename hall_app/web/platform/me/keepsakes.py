"""Favourites and visits: shown, kept, taken out."""

from __future__ import annotations

from html import escape

from hall_app.content.views.scene import thumbnail
from hall_app.house.people import PeopleError
from hall_app.web.platform.counter import Asking, Counter, Moved, Page, Shown, button, form, told_day
from hall_app.web.platform.me.notices import notice

__all__ = ["Shelf"]


class Shelf:
    """What one keeps for oneself."""

    def __init__(self, counter: Counter) -> None:
        self._house, self._people = counter.house, counter.people

    def favourites(self, asking: Asking) -> str:
        word, kept = asking.word, self._people.keepsakes.favourites(asking.person.id)
        if not kept:
            told = word(
                "还没有收藏。在展品目录中每件展品下都有“收藏”。",
                "None yet. Each exhibit in the catalogue can be kept.",
            )
            way = f'<a href="/catalogue?lang={asking.lang}">{word("打开目录", "Open the catalogue")}</a>'
            return f'<p class="quiet">{told}</p><p class="doors">{way}</p>'
        return f'<ul class="rows">{"".join(self._favourite(asking, one.exhibit) for one in kept)}</ul>'

    def _favourite(self, asking: Asking, key: str) -> str:
        name = self._name(asking, key)
        drop = button(
            asking,
            "drop",
            "/me/drop",
            asking.word("移除", "Take out"),
            about=name,
            hidden={"exhibit": key},
        )
        return f"<li>{self._picture(key)}<span>{self._ways(asking, key)}</span>{drop}</li>"

    def visits(self, asking: Asking) -> str:
        word, on = asking.word, asking.person.keeps_looks
        told = word(
            "只有在您开启后，本馆才记下您细看过哪些展品（只记日期）。关闭即删除全部记录。",
            "Only when you turn this on does the house keep which exhibits you looked at closely, and on which day. "
            "Turned off, all of it is deleted.",
        )
        words = (
            word("关闭并删除记录", "Turn off and delete") if on else word("开启参观记录", "Keep my visits")
        )
        switch = button(asking, "visits", "/me/visits", words, hidden={"on": "" if on else "on"})
        days: dict[str, list[str]] = {}
        for one in self._people.keepsakes.looks(asking.person.id):
            days.setdefault(told_day(one.day, asking.lang), []).append(self._ways(asking, one.exhibit))
        mark = word("、", ", ")
        lines = "".join(
            f"<li><span><b>{day}</b><br>{mark.join(names)}</span></li>" for day, names in days.items()
        )
        return f'<p class="quiet">{told}</p>{f"<ul class={chr(34)}rows{chr(34)}>{lines}</ul>" if lines else ""}{switch}'

    def keep_page(self, asking: Asking) -> Shown:
        """Asked by a link from the catalogue, which is one page for all: here it is known who asks."""
        word, key = asking.word, asking.form.get("exhibit", asking.query.get("exhibit", ""))
        if self._house.content.exhibit(key) is None:
            raise PeopleError("no-exhibit")
        kept = any(one.exhibit == key for one in self._people.keepsakes.favourites(asking.person.id))
        title = word("收藏展品", "Keep an exhibit")
        sent = (
            f"<p>{word('已在收藏中。', 'It is among your favourites.')}</p>"
            if kept
            else form(asking, "keep", "/me/keep", (), word("加入收藏", "Keep it"), hidden={"exhibit": key})
        )
        back = f"/catalogue?lang={asking.lang}#exhibit-{escape(key)}"
        main = f"""<header><h1>{title}</h1></header>{notice(asking)}<div class="desk">
<ul class="rows"><li>{self._picture(key)}<span>{self._ways(asking, key)}</span></li></ul>{sent}
<p class="doors"><a href="/?exhibit={escape(key)}&amp;lang={asking.lang}">{word("回到展厅", "Back to the hall")}</a>
<a href="{back}">{word("回到目录", "Back to the catalogue")}</a>
<a href="{asking.address("/me")}#favourites">{word("我的收藏", "My favourites")}</a></p></div>"""
        return Shown(Page(title, main, "me", {"exhibit": key}), path="/me/keep")

    def keep(self, asking: Asking) -> Moved:
        key = asking.form.get("exhibit", "")
        if self._house.content.exhibit(key) is None:
            raise PeopleError("no-exhibit")
        self._people.keepsakes.keep(asking.person.id, key)
        return Moved(asking.address("/me/keep", exhibit=key, done="kept"))

    def drop(self, asking: Asking) -> Moved:
        self._people.keepsakes.drop(asking.person.id, asking.form.get("exhibit", ""))
        return Moved(asking.address("/me#favourites", done="dropped"))

    def set_keeping(self, asking: Asking) -> Moved:
        on = asking.form.get("on") == "on"
        self._people.keepsakes.set_keeping(asking.person.id, on=on)
        return Moved(asking.address("/me#visits", done="visits-on" if on else "visits-off"))

    def _name(self, asking: Asking, key: str) -> str:
        exhibit = self._house.content.exhibit(key)
        return key if exhibit is None else getattr(exhibit.file.title, asking.lang)

    def _ways(self, asking: Asking, key: str) -> str:
        """The exhibit's name, which leads to it; alone where it is no longer in the hall."""
        name = escape(self._name(asking, key))
        if self._house.content.exhibit(key) is None:
            return f"{name} ({asking.word('已不在展厅', 'no longer in the hall')})"
        return f'<a href="/?exhibit={escape(key)}&amp;lang={asking.lang}">{name}</a>'

    def _picture(self, key: str) -> str:
        exhibit = self._house.content.exhibit(key)
        url = thumbnail(exhibit, self._house.bakes().get(key)) if exhibit else None
        small = escape(url.replace("/media/", "/thumbnails/", 1)) if url else ""
        return f'<img src="{small}" alt="" loading="lazy" decoding="async">' if small else ""
