"""Occasions as a calendar file that phones and offices read (RFC 5545)."""

from __future__ import annotations

from collections.abc import Iterable

from hall_app.house.people.records import Occasion
from hall_app.web.platform.counter import Asking, Download
from hall_app.web.platform.programme.lists import address_of
from survey.store.database import now

__all__ = ["calendar_file"]


def calendar_file(asking: Asking, found: Iterable[Occasion], name: str) -> Download:
    """In the visitor's language; one that was called off says so, which takes it out of calendars that had it."""
    from icalendar import Calendar, Event

    calendar = Calendar()
    calendar.add("prodid", "-//hall//programme//ZH")
    calendar.add("version", "2.0")
    for one in found:
        event = Event()
        event.add("uid", f"{one.id}-hall")  # by whatever name the site is reached
        event.add("dtstamp", now())
        event.add("dtstart", one.plan.begins)
        event.add("dtend", one.plan.ends)
        event.add("summary", one.told("title", asking.lang))
        event.add("url", asking.site + asking.address(address_of(one)))
        for key, what in (("description", "text"), ("location", "place")):
            if one.told(what, asking.lang):
                event.add(key, one.told(what, asking.lang))
        event.add("status", "CANCELLED" if one.cancelled else "CONFIRMED")
        calendar.add_component(event)
    return Download(calendar.to_ical(), name, "text/calendar; charset=utf-8")
