"""One activity or slot: told, booked, cancelled."""

from __future__ import annotations

import secrets
from html import escape

from hall_app.house.people.records import Booking, Occasion
from hall_app.web.platform.counter import (
    Asking,
    Counter,
    Field,
    Moved,
    Page,
    Shown,
    button,
    clock_line,
    form,
    told_time,
)
from hall_app.web.platform.programme.lists import address_of, left_of
from survey.store.database import now

__all__ = ["OccasionPages"]

_DONE = {
    "booked": ("已预约，期待您的到来。", "It is booked: we look forward to seeing you."),
    "waiting": ("名额已满，您在候补名单上。", "All places are taken: you are on the waiting list."),
    "cancelled": ("预约已取消。", "The reservation is cancelled."),
}


class OccasionPages:
    """Its page and its acts; a form sent twice books once, by the key that stands in it."""

    def __init__(self, counter: Counter) -> None:
        self._people, self._pace = counter.people, counter.pace

    def page(self, asking: Asking) -> Shown:
        word, one = asking.word, self._people.occasions.of(asking.names["key"])
        place, title = escape(one.told("place", asking.lang)), one.told("title", asking.lang)
        paragraphs = "".join(
            f"<p>{escape(part)}</p>" for part in one.told("text", asking.lang).split("\n") if part
        )
        part = "visit" if one.plan.kind == "visit" else "activities"
        back = word("全部时段", "All hours") if part == "visit" else word("全部活动", "All activities")
        calendar = word("加入日历（.ics）", "Add to a calendar (.ics)")
        kept = f'<a href="{asking.address(address_of(one) + ".ics")}">{calendar}</a>'
        ways = f'<p class="doors"><a href="{asking.address(f"/{part}")}">{back}</a>{kept}</p>'
        facts = (
            (word("开始", "Begins"), told_time(one.plan.begins, asking.lang)),
            (word("结束", "Ends"), told_time(one.plan.ends, asking.lang)),
            (word("地点", "Where"), place),
            (word("名额", "Places"), left_of(asking, one)),
        )
        listed = "".join(f"<dt>{name}</dt><dd>{value}</dd>" for name, value in facts if value)
        said = _DONE.get(asking.query.get("done", ""))
        told = f'<p class="done" role="status">{asking.word(*said)}</p>' if said else ""
        clock = clock_line(listed, asking.lang)
        main = f"""<header><h1>{escape(title)}</h1></header>{told}<dl class="how">{listed}</dl>{clock}
<div class="text">{paragraphs}</div><div class="desk">{self._booking(asking, one)}{ways}</div>"""
        return Shown(Page(title, main, part), path=address_of(one))

    def _booking(self, asking: Asking, one: Occasion) -> str:
        word, at, begun = asking.word, address_of(one), one.plan.begins <= now()
        closed = word("已开始，不再接受预约。", "It has begun, and nothing can be booked.") if begun else ""
        if asking.guest is None:
            if begun or one.cancelled:
                return f"<p>{closed}</p>" if closed else ""
            told = word(
                "预约需要账户，以便您查看与取消。",
                "A booking needs an account, so that you can see and cancel it.",
            )
            way = escape(asking.address("/me", next=at))
            sign_in = word("登录或注册", "Sign in, or make an account")
            return f'<p>{told}</p><p class="doors"><a href="{way}">{sign_in}</a></p>'
        for mine in self._people.bookings.of(asking.person.id):
            if mine.occasion == one.id:
                cancel = button(asking, "cancel", f"{at}/cancel", word("取消预约", "Cancel it"), hidden={})
                why = (
                    f'<p class="refused" role="alert">{escape(asking.refusal)}</p>' if asking.refusal else ""
                )
                stays = mine.arrived or one.plan.ends <= now()
                return f"{why}<p><b>{told_booking(asking, mine)}</b></p>{'' if stays else cancel}"
        if begun or one.cancelled:
            return f"<p>{closed}</p>" if closed else ""
        party = Field(
            "party",
            word("班级或团体名称（个人不填）", "Name of the class or group (none for yourself)"),
            needed=False,
            given={"maxlength": "80"},
        )
        size = Field(
            "size",
            word("人数", "How many"),
            "number",
            value="1",
            hint=word(f"最多 {one.plan.party} 人", f"{one.plan.party} at most"),
            given={"min": "1", "max": str(one.plan.party), "inputmode": "numeric"},
        )
        words = word("预约", "Book") if one.left else word("加入候补", "Join the waiting list")
        fields = (size, party) if one.plan.kind == "visit" else (size,)
        return form(asking, "book", f"{at}/book", fields, words, hidden={"key": secrets.token_urlsafe(24)})

    def book(self, asking: Asking) -> Moved:
        self._pace.take("book", asking.person.id)
        given, key = asking.form, asking.names["key"]
        told = given.get("size", "")
        size = int(told) if told.isascii() and told.isdigit() and len(told) < 6 else 0
        sent = f"{asking.person.id[:16]}-{given.get('key', '')[:40]}"  # of this person: nobody else's form is the same
        made = self._people.bookings.book(asking.person.id, key, size, sent, party=given.get("party", ""))
        way = address_of(self._people.occasions.of(key))
        return Moved(asking.address(way, done="waiting" if made.place else "booked"))

    def cancel(self, asking: Asking) -> Moved:
        key, person = asking.names["key"], asking.person.id
        mine = [one.id for one in self._people.bookings.of(person) if one.occasion == key]
        self._people.bookings.cancel(person, "cancel booking", mine[0] if mine else 0, person=person)
        return Moved(asking.address(address_of(self._people.occasions.of(key)), done="cancelled"))


def told_booking(asking: Asking, mine: Booking) -> str:
    """What one has, in words."""
    people = asking.word(f"{mine.size} 人", f"{mine.size} {'person' if mine.size == 1 else 'people'}")
    party = f" · {escape(mine.party)}" if mine.party else ""
    if mine.place:
        state = asking.word(f"候补第 {mine.place} 位", f"number {mine.place} on the waiting list")
    elif mine.arrived:
        state = asking.word("已签到", "checked in")
    else:
        state = asking.word("已预约", "booked")
    return f"{state} · {people}{party}"
