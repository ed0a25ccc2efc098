"""Activities and visits planned, their reservations, the day's sheet, checking in: curators' and administrators'."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, replace
from datetime import UTC, date, datetime, time, timedelta
from html import escape
from typing import Any

from hall_app.house.people import PeopleError
from hall_app.house.people.records import Booking, Occasion, Plan
from hall_app.web.platform.counter import (
    Asking,
    Counter,
    Field,
    Shown,
    button,
    form,
    leaf_asked,
    leaf_ways,
    told_day,
    told_time,
)
from hall_app.web.platform.office.deeds import Deed, Reading, number_in
from hall_app.web.platform.office.table import office_page, rows
from survey.store.database import now

__all__ = ["programme_deeds", "programme_readings"]

MOST_SLOTS = 60  # planned at once
LISTED = 200  # occasions on a page of the list
_PLAN = {
    "title_zh": "its title in Chinese",
    "title_en": "its title in English",
    "begins": "date and time as of ISO 8601, without an offset on the house's own clock",
    "ends": "the same of its end",
    "places": "how many people it is for",
    "party": "how many one booking may be for",
    "place_zh": "where, or nothing",
    "place_en": "where, or nothing",
    "text_zh": "what is told of it, or nothing",
    "text_en": "what is told of it, or nothing",
    "kind": "activity or visit",
}


def programme_readings(counter: Counter) -> tuple[Reading, ...]:
    rooms = _Rooms(counter)
    listed = {"past": "1: those over or called off, the last first", "page": f"from 1, of {LISTED} each"}
    return (
        Reading("events", "events", rooms.all, rooms.all_page, listed),
        Reading("events/{key}", "reservations", rooms.one, rooms.one_page),
        Reading("day", "reservations", rooms.day, rooms.day_page, {"day": "as of ISO 8601, today for none"}),
    )


def programme_deeds(counter: Counter) -> tuple[Deed, ...]:
    rooms = _Rooms(counter)
    one, booking = "events/{key}", "events/{key}/bookings/{booking}"
    seen = {"turn": "of the booking as it was read; refused where its number is another's by now"}
    hours = {name: words for name, words in _PLAN.items() if name != "kind"}
    slots = {"minutes": f"of each slot, five at least; {MOST_SLOTS} slots at once"}
    change = {"seen": "the plan's mark as it was read; 409 where it is another by now"}
    return (
        Deed("events", "events", rooms.plan, "events/{id}", rooms.all_page, fields=_PLAN),
        Deed("visits", "events", rooms.plan_visits, "events", rooms.all_page, fields=hours | slots),
        Deed(one, "events", rooms.change, one, rooms.one_page, fields=_PLAN | change),
        Deed(
            f"{one}/off",
            "events",
            rooms.call_off,
            one,
            rooms.one_page,
            fields={"sure": "true: nothing undoes it"},
        ),
        Deed(f"{booking}/arrive", "check-in", rooms.arrive, one, rooms.one_page, fields=seen),
        Deed(f"{booking}/leave", "check-in", rooms.leave, one, rooms.one_page, fields=seen),
        Deed(f"{booking}/cancel", "reservations", rooms.cancel, one, rooms.one_page, fields=seen),
    )


class _Rooms:
    def __init__(self, counter: Counter) -> None:
        self._people = counter.people

    def all(self, asking: Asking) -> list[dict[str, Any]]:
        return [_told(one) for one in self._listed(asking)[0]]

    def one(self, asking: Asking) -> dict[str, Any]:
        one = self._people.occasions.of(asking.names["key"])
        return _told(one) | {"bookings": [self._booked(made) for made in self._bookings(one)]}

    def day(self, asking: Asking) -> list[dict[str, Any]]:
        found = self._on(_day(asking))
        return [
            _told(one) | {"bookings": [self._booked(made) for made in self._bookings(one)]} for one in found
        ]

    def plan(self, asking: Asking) -> dict[str, Any]:
        (key,) = self._people.occasions.plan(asking.person.id, _to_come(_plan(asking)))
        return {"id": key}

    def plan_visits(self, asking: Asking) -> dict[str, Any]:
        """Slots of one day, one after the other."""
        given, first = asking.form, _to_come(_plan(asking))
        length = timedelta(minutes=number_in(given.get("minutes", "")))
        if not timedelta(minutes=5) <= length or not (first.ends - first.begins) // length <= MOST_SLOTS:
            raise PeopleError("occasion-slots", most=MOST_SLOTS)
        slots = []
        while first.begins + length * (len(slots) + 1) <= first.ends:
            begins = first.begins + length * len(slots)
            slots.append(replace(first, kind="visit", begins=begins, ends=begins + length))
        if not slots:
            raise PeopleError("occasion-times")
        return {"ids": list(self._people.occasions.plan(asking.person.id, *slots))}

    def change(self, asking: Asking) -> dict[str, Any]:
        key = asking.names["key"]
        plan, seen = _plan(asking), asking.form.get("seen", "")
        before = self._people.occasions.of(key).plan.begins
        if abs(plan.begins - before) >= timedelta(minutes=1):  # a form gives no seconds
            _to_come(plan)
        self._people.occasions.change(asking.person.id, key, plan, seen)
        return {"id": key}

    def call_off(self, asking: Asking) -> dict[str, Any]:
        key = asking.names["key"]
        if not asking.form.get("sure"):
            raise PeopleError("occasion-off")
        self._people.occasions.call_off(asking.person.id, key)
        return {"id": key, "cancelled": True}

    def arrive(self, asking: Asking) -> dict[str, Any]:
        number, place = _seen(asking)
        self._people.bookings.arrive(asking.person.id, number, here=True, place=place)
        return {"id": number, "arrived": True}

    def leave(self, asking: Asking) -> dict[str, Any]:
        number, place = _seen(asking)
        self._people.bookings.arrive(asking.person.id, number, here=False, place=place)
        return {"id": number, "arrived": False}

    def cancel(self, asking: Asking) -> dict[str, Any]:
        number, place = _seen(asking)
        self._people.bookings.cancel(asking.person.id, "reservations", number, place=place)
        return {"id": number, "cancelled": True}

    def all_page(self, asking: Asking) -> Shown:
        word, past = asking.word, "1" if asking.query.get("past") else ""
        found, more = self._listed(asking)
        title = word("活动与参观", "Activities and visits")
        other = asking.address("/office/events", past="" if past else "1")
        others = word("未来的", "To come") if past else word("过去的", "Past")
        ways = f"""<p class="doors"><a href="{other}">{others}</a>
<a href="{asking.address("/office/day")}">{word("今日签到单", "Sheet of the day")}</a></p>"""
        listed = (
            _table(asking, title, found) if found else f"<p>{word('还没有安排。', 'Nothing is planned.')}</p>"
        )
        pages = leaf_ways(asking, "/office/events", leaf_asked(asking), more=more, past=past)
        query = {name: value for name in ("past", "page") if (value := asking.query.get(name, ""))}
        inside = f"{ways}{listed}{pages}{_new(asking)}"
        return office_page(asking, title, inside, path="events", query=query)

    def one_page(self, asking: Asking) -> Shown:
        word, one = asking.word, self._people.occasions.of(asking.names["key"])
        at = f"/office/events/{one.id}"
        sheet = self._sheet(asking, one)
        why = (
            f'<p class="refused" role="alert">{escape(asking.refusal)}</p>'
            if asking.refusal and asking.form.get("of") not in ("event", "off")
            else ""
        )
        changed = ""
        if asking.person.may("events"):
            off = "" if one.cancelled else _off(asking, one)
            words, hidden = word("保存", "Save"), {"seen": one.plan.mark}
            sent = form(asking, "event", at, _fields(asking, one), words, hidden=hidden)
            changed = f'<h2 class="small">{word("更改", "Change")}</h2><div class="desk">{sent}</div>{off}'
        lead = f"{told_time(one.plan.begins, asking.lang)} · {one.taken} / {one.plan.places}"
        lead += f" · {word('已取消', 'called off')}" if one.cancelled else ""
        heading = word("预约", "Reservations")
        inside = f'{why}<h2 class="small">{heading}</h2>{sheet}{changed}'
        return office_page(asking, one.told("title", asking.lang), inside, path=f"events/{one.id}", lead=lead)

    def day_page(self, asking: Asking) -> Shown:
        word, day = asking.word, _day(asking)
        title = word("签到单", "Sheet of the day") + f" · {told_day(day, asking.lang)}"
        near = [
            (day - timedelta(days=1), word("前一天", "The day before")),
            (day + timedelta(days=1), word("后一天", "The day after")),
        ]
        ways = "".join(
            f'<a href="{asking.address("/office/day", day=f"{one:%Y-%m-%d}")}">{name}</a>'
            for one, name in near
        )
        parts = "".join(
            f'<h2 class="small">{told_time(one.plan.begins, asking.lang)} · {escape(one.told("title", asking.lang))}'
            f" · {one.taken} / {one.plan.places}</h2>{self._sheet(asking, one)}"
            for one in self._on(day)
        )
        none = f"<p>{word('这一天没有安排。', 'Nothing takes place on this day.')}</p>"
        inside = f'<p class="doors">{ways}</p>{parts or none}'
        return office_page(asking, title, inside, path="day", query={"day": f"{day:%Y-%m-%d}"})

    def _sheet(self, asking: Asking, one: Occasion) -> str:
        word, lines = asking.word, []
        booked = [(made, self._people.accounts.of(made.person)) for made in self._bookings(one)]
        names = [person.name for _, person in booked]
        for made, person in booked:
            at = f"/office/events/{one.id}/bookings/{made.id}"
            alone = person.name and names.count(person.name) == 1
            name = person.name if alone else f"{person.name} {person.address}".strip()
            here = made.arrived is not None
            seen = {"about": name, "hidden": {"turn": str(made.turn)}}
            act = "leave" if here else "arrive"
            called = word("撤销签到", "Undo") if here else word("签到", "Check in")
            may = asking.person.may("check-in") and not made.place
            check = button(asking, act, f"{at}/{act}", called, **seen) if may else ""
            away = button(asking, "cancel", f"{at}/cancel", word("取消", "Cancel"), **seen)
            waits = word(f"候补第 {made.place} 位", f"waiting, {made.place}")
            state = waits if made.place else word("已签到", "here") if here else word("已约", "booked")
            deeds = f'<div class="deeds">{check}{away}</div>'
            lines.append((escape(name), escape(made.party), str(made.size), state, deeds))
        if not lines:
            return f"<p>{word('还没有预约。', 'Nobody has booked yet.')}</p>"
        heads = [word("姓名", "Name"), word("团体", "Group"), word("人数", "People"), word("状态", "State")]
        heads += [f'<span class="unseen">{word("操作", "Acts")}</span>']
        return rows(one.told("title", asking.lang), heads, lines)

    def _bookings(self, one: Occasion) -> tuple[Booking, ...]:
        return self._people.bookings.for_occasion(one.id)

    def _booked(self, made: Booking) -> dict[str, Any]:
        arrived = made.arrived.isoformat() if made.arrived else None
        kept = {
            "id": made.id,
            "turn": made.turn,
            "person": made.person,
            "size": made.size,
            "party": made.party,
        }
        return kept | {"waiting": made.place, "arrived": arrived}

    def _on(self, day: date) -> tuple[Occasion, ...]:
        """What begins on that day of the house's own clock."""
        first, end = (datetime.combine(one, time()).astimezone() for one in (day, day + timedelta(days=1)))
        return self._people.occasions.between(first, end)

    def _listed(self, asking: Asking) -> tuple[tuple[Occasion, ...], bool]:
        """The occasions of the page asked for, and whether there are more."""
        past, start = bool(asking.query.get("past")), (leaf_asked(asking) - 1) * LISTED
        found = self._people.occasions.to_come(past=past, start=start, most=LISTED + 1)
        return found[:LISTED], len(found) > LISTED


def _table(asking: Asking, title: str, found: Iterable[Occasion]) -> str:
    word = asking.word
    heads = (
        word("标题", "Title"),
        word("类别", "Kind"),
        word("开始", "Begins"),
        word("已约 / 名额", "Booked / places"),
        word("候补", "Waiting"),
    )
    lines = (
        (
            f'<a href="{asking.address(f"/office/events/{one.id}")}">{escape(one.told("title", asking.lang))}</a>',
            _kind(asking, one.plan.kind),
            told_time(one.plan.begins, asking.lang),
            f"{one.taken} / {one.plan.places}",
            str(one.waiting) + (f" · {word('已取消', 'off')}" if one.cancelled else ""),
        )
        for one in found
    )
    return rows(title, heads, lines)


def _new(asking: Asking) -> str:
    """The forms of a new activity and of hours for visits."""
    word = asking.word
    new = form(
        asking, "event", "/office/events", _fields(asking, None), word("发布活动", "Publish the activity")
    )
    slot = _fields(asking, None, title=("讲解参观", "Guided visit"), place=word("展厅", "In the hall"))
    length = Field("minutes", word("每段分钟数", "Minutes a slot"), "number", value="60", given={"min": "5"})
    visits = form(asking, "visits", "/office/visits", (*slot, length), word("发布时段", "Publish the hours"))
    told = word("从开始到结束，分成等长的时段。", "From beginning to end, in slots of one length.")
    return f"""<div class="centre">
<section aria-labelledby="new"><h2 class="small" id="new">{word("新活动", "A new activity")}</h2>{new}</section>
<section aria-labelledby="hours"><h2 class="small" id="hours">{word("参观时段", "Hours for visits")}</h2>
<p class="quiet">{told}</p>{visits}</section></div>"""


def _kind(asking: Asking, kind: str) -> str:
    return asking.word("参观", "Visit") if kind == "visit" else asking.word("活动", "Activity")


def _seen(asking: Asking) -> tuple[int, tuple[str, int]]:
    """Which booking was meant: its number, and the occasion and turn that the sheet showed it with, if it did."""
    turn = asking.form.get("turn", "")
    return number_in(asking.names["booking"]), (asking.names["key"], number_in(turn) if turn else 0)


def _day(asking: Asking) -> date:
    """The day asked for, today for none. It has one before it and one after."""
    try:
        day = date.fromisoformat(asking.query.get("day", ""))
    except ValueError:
        day = date.min
    return day if date.min < day < date.max else datetime.now().astimezone().date()


def _plan(asking: Asking) -> Plan:
    """As the form gives it. Raises PeopleError."""
    given = asking.form
    try:
        # What is typed is the house's own clock; a program may name its offset.
        begins, ends = (
            datetime.fromisoformat(given.get(name, "")).astimezone(UTC) for name in ("begins", "ends")
        )
    except (ValueError, OverflowError):
        raise PeopleError("occasion-times") from None
    texts = {
        name: given.get(name, "")
        for name in ("title_zh", "title_en", "text_zh", "text_en", "place_zh", "place_en")
    }
    places, party = (number_in(given.get(name, "")) for name in ("places", "party"))
    kind = given.get("kind", "activity")
    return Plan(kind=kind, begins=begins, ends=ends, places=places, party=party, **texts)


def _to_come(plan: Plan) -> Plan:
    """The plan, as it is kept. Raises PeopleError, also for what would have begun: nobody could book it."""
    plan = plan.checked()
    if plan.begins <= now():
        raise PeopleError("occasion-past", when=f"{plan.begins.astimezone():%Y-%m-%d %H:%M}")
    return plan


def _off(asking: Asking, one: Occasion) -> str:
    """The form that calls it off, once that is confirmed: nothing puts it back."""
    word, people = asking.word, one.taken + one.waiting
    told = word(
        f"取消后不能恢复。已有 {people} 人预约或候补，须由您通知。",
        f"It cannot be put back. People down for it, to be told by you: {people}.",
    )
    sure = Field("sure", word("确定取消此场", "Yes, call it off"), "check", hint=told)
    sent = form(asking, "off", f"/office/events/{one.id}/off", (sure,), word("取消此场", "Call it off"))
    return f'<h2 class="small">{word("取消", "Call off")}</h2><div class="desk">{sent}</div>'


def _fields(
    asking: Asking, one: Occasion | None, *, title: tuple[str, str] = ("", ""), place: str = ""
) -> tuple[Field, ...]:
    """The form of a plan. one: as it is now; title, place: what stands in a new one."""
    word, plan = asking.word, one.plan if one else None
    times = [f"{at.astimezone():%Y-%m-%dT%H:%M}" for at in (plan.begins, plan.ends)] if plan else ["", ""]
    chinese, english = word("（中文）", " (Chinese)"), word("（英文）", " (English)")
    titles = (plan.title_zh, plan.title_en) if plan else title
    texts = (plan.text_zh, plan.text_en) if plan else ("", "")
    places = (plan.place_zh, plan.place_en) if plan else ("展厅", "In the hall") if place else ("", "")
    kind = Field(
        "kind",
        word("类别", "Kind"),
        "select",
        value=plan.kind if plan else "activity",
        choices={"activity": _kind(asking, "activity"), "visit": _kind(asking, "visit")},
    )
    return (
        Field("title_zh", word("标题", "Title") + chinese, value=titles[0], given={"maxlength": "120"}),
        Field("title_en", word("标题", "Title") + english, value=titles[1], given={"maxlength": "120"}),
        Field("begins", word("开始", "Begins"), "datetime-local", value=times[0]),
        Field("ends", word("结束", "Ends"), "datetime-local", value=times[1]),
        Field(
            "places",
            word("名额", "Places"),
            "number",
            value=str(plan.places if plan else 20),
            given={"min": "1", "max": "1000"},
        ),
        Field(
            "party",
            word("每次预约最多人数", "The most one booking may be for"),
            "number",
            value=str(plan.party if plan else 20 if place else 4),
            given={"min": "1", "max": "1000"},
        ),
        Field("place_zh", word("地点", "Where") + chinese, value=places[0], needed=False),
        Field("place_en", word("地点", "Where") + english, value=places[1], needed=False),
        Field("text_zh", word("说明", "Text") + chinese, "textarea", value=texts[0], needed=False),
        Field("text_en", word("说明", "Text") + english, "textarea", value=texts[1], needed=False),
        *(() if place else (kind,)),  # hours are of visits
    )


def _told(one: Occasion) -> dict[str, Any]:
    plan = asdict(one.plan) | {"begins": one.plan.begins.isoformat(), "ends": one.plan.ends.isoformat()}
    counts = {"taken": one.taken, "waiting": one.waiting, "cancelled": one.cancelled is not None}
    return {"id": one.id, "mark": one.plan.mark} | plan | counts
