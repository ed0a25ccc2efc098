"""Reservations of who is signed in, for the user centre."""

from __future__ import annotations

from html import escape

from hall_app.house.people import People
from hall_app.web.platform.counter import Asking, told_time
from hall_app.web.platform.programme.lists import address_of
from hall_app.web.platform.programme.occasion import told_booking

__all__ = ["reservations"]


def reservations(asking: Asking, people: People) -> str:
    """Each with the way to its page, where it is cancelled."""
    word, lines = asking.word, []
    for mine in people.bookings.of(asking.person.id):
        one = people.occasions.of(mine.occasion)
        way = f'<a href="{escape(asking.address(address_of(one)))}">{escape(one.told("title", asking.lang))}</a>'
        off = f" · <b>{word('已取消', 'called off')}</b>" if one.cancelled else ""
        at = told_time(one.plan.begins, asking.lang)
        lines.append(
            f"<li><span>{way}{off}<br>{at}<br><span class='quiet'>{told_booking(asking, mine)}</span></span></li>"
        )
    ways = f"""<p class="doors"><a href="{asking.address("/activities")}">{word("活动", "Activities")}</a>
<a href="{asking.address("/visit")}">{word("预约参观", "Book a visit")}</a></p>"""
    if not lines:
        return f'<p class="quiet">{word("还没有预约。", "None yet.")}</p>{ways}'
    return f'<ul class="rows">{"".join(lines)}</ul>{ways}'
