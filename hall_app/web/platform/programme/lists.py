"""What there is: activities one below the other, visits by day with their slots."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import UTC, datetime, timedelta
from html import escape

from hall_app.house.people.records import Occasion
from hall_app.web.platform.counter import (
    Asking,
    Page,
    Shown,
    clock_line,
    leaf_asked,
    leaf_ways,
    told_day,
    told_hours,
    told_time,
)

__all__ = ["LISTED", "activities_page", "address_of", "bounds_of", "left_of", "month_of", "visit_page"]

LISTED = 60  # activities on a page


def address_of(occasion: Occasion) -> str:
    part = "visit" if occasion.plan.kind == "visit" else "activities"
    return f"/{part}/{occasion.id}"


def left_of(asking: Asking, occasion: Occasion) -> str:
    """What is left, in words."""
    word, plan = asking.word, occasion.plan
    if occasion.cancelled:
        return word("已取消", "Called off")
    if occasion.left:
        return word(
            f"余 {occasion.left} 位（共 {plan.places} 位）", f"{occasion.left} of {plan.places} places left"
        )
    waiting = word(f"候补 {occasion.waiting} 人", f"{occasion.waiting} waiting") if occasion.waiting else ""
    return word("已满", "Full") + (word("，", ", ") + waiting if waiting else "")


def month_of(at: datetime) -> str:
    """2026-12 on the house's own clock."""
    return f"{at.astimezone():%Y-%m}"


def bounds_of(month: str) -> tuple[datetime, datetime]:
    """Its first moment on the house's own clock, and the next month's."""
    first = datetime.fromisoformat(f"{month}-01")
    if month == "9999-12":
        return first.astimezone(), datetime.max.replace(tzinfo=UTC)
    return first.astimezone(), (first + timedelta(days=32)).replace(day=1).astimezone()


def activities_page(asking: Asking, found: Iterable[Occasion], *, more: bool) -> Shown:
    """found: those of the page that is asked for; more: whether there is a next one."""
    word = asking.word
    title = word("活动", "Activities")
    lead = word(
        "讲座、工作坊与导览。名额满后可以候补：有人取消，就按报名先后递补。",
        "Talks, workshops and tours. Where all places are taken there is a waiting list: what is given back goes to "
        "who asked first.",
    )
    cards = "".join(_card(asking, one) for one in found)
    calendar = f'<a href="{asking.address("/activities.ics")}">{word("日历文件（.ics）", "Calendar file (.ics)")}</a>'
    visit = f'<a href="{asking.address("/visit")}">{word("预约参观", "Book a visit")}</a>'
    none = word(
        "目前没有活动安排，请过些时候再来看看。", "Nothing is planned at present: look in again later."
    )
    listed = f'<ol class="programme">{cards}</ol>' if cards else f"<p>{none}</p>"
    ways = f'<p class="doors">{calendar if cards else ""}{visit}</p>'
    page = leaf_asked(asking)
    pages = leaf_ways(asking, "/activities", page, more=more)
    clock = clock_line(listed, asking.lang)
    main = f'<header><h1>{title}</h1><p class="lead">{lead}</p></header>{ways}{clock}{listed}{pages}'
    query = {"page": str(page)} if page > 1 else {}
    return Shown(Page(title, main, "activities", query), path="/activities")


def _card(asking: Asking, one: Occasion) -> str:
    place = escape(one.told("place", asking.lang))
    where = f" · {place}" if place else ""
    text = escape(one.told("text", asking.lang).partition("\n")[0])
    way = escape(asking.address(address_of(one)))
    return f"""<li><p class="kicker">{told_time(one.plan.begins, asking.lang)}{where}</p>
<h2><a href="{way}">{escape(one.told("title", asking.lang))}</a></h2><p>{text}</p>
<p class="quiet">{left_of(asking, one)}</p></li>"""


def visit_page(asking: Asking, found: Iterable[Occasion], month: str, months: Iterable[str]) -> Shown:
    """month: 2026-12, whose slots are found, "" for none; months: those that have any."""
    word = asking.word
    title = word("预约参观", "Book a visit")
    lead = word(
        "线上展厅随时开放，无需预约。这里预约的是有讲解员陪同的时段；学校班级与团体请填写名称与人数。",
        "The hall on this site is always open. What is booked here are hours with a guide; schools and groups give "
        "their name and number.",
    )
    days: dict[str, list[Occasion]] = {}
    for one in found:
        days.setdefault(told_day(one.plan.begins.astimezone(), asking.lang), []).append(one)
    listed = "".join(
        f'<section aria-labelledby="day-{at}"><h2 class="small" id="day-{at}">{day}</h2>'
        f'<ol class="slots">{"".join(_slot(asking, one) for one in slots)}</ol></section>'
        for at, (day, slots) in enumerate(days.items())
    )
    none = word(
        "目前没有可预约的时段，请过些时候再来看看。", "No hours are offered at present: look in again later."
    )
    others = "".join(
        f'<a href="{asking.address("/visit", month=one)}"{" aria-current=page" if one == month else ""}>{one}</a>'
        for one in months
    )
    ways = f'<nav class="doors" aria-label="{word("月份", "Months")}">{others}</nav>' if others else ""
    ways += clock_line(listed, asking.lang)
    main = f'<header><h1>{title}</h1><p class="lead">{lead}</p></header>{ways}{listed or f"<p>{none}</p>"}'
    query = {"month": month} if asking.query.get("month") and month else {}
    return Shown(Page(title, main, "visit", query), path="/visit")


def _slot(asking: Asking, one: Occasion) -> str:
    hours = told_hours(one.plan.begins, one.plan.ends, asking.lang)
    way, left = escape(asking.address(address_of(one))), left_of(asking, one)
    return f"""<li><a href="{way}"><b>{hours}</b>
<span>{escape(one.told("title", asking.lang))}</span> <span class="quiet">{left}</span></a></li>"""
