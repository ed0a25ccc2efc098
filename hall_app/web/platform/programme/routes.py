"""The programme's addresses."""

from __future__ import annotations

from hall_app.house.people import PeopleError
from hall_app.web.platform.counter import Asking, Counter, Download, Moved, Shown, leaf_asked
from hall_app.web.platform.programme.calendar import calendar_file
from hall_app.web.platform.programme.lists import LISTED, activities_page, bounds_of, month_of, visit_page
from hall_app.web.platform.programme.occasion import OccasionPages
from survey.store.database import now

__all__ = ["add_programme"]


def add_programme(counter: Counter) -> None:
    """Add /activities, /visit, and what is below them."""
    people, pages = counter.people, OccasionPages(counter)

    def activities(asking: Asking) -> Shown:
        start = (leaf_asked(asking) - 1) * LISTED
        found = people.occasions.to_come("activity", start=start, most=LISTED + 1)
        return activities_page(asking, found[:LISTED], more=len(found) > LISTED)

    def visit(asking: Asking) -> Shown:
        months = tuple(dict.fromkeys(map(month_of, people.occasions.beginnings("visit"))))
        asked = asking.query.get("month", "")
        month = asked if asked in months else months[0] if months else ""
        found = people.occasions.between(*bounds_of(month), "visit") if month else ()
        return visit_page(asking, [one for one in found if one.plan.ends > now()], month, months)

    def all_activities(asking: Asking) -> Download:
        return calendar_file(asking, people.occasions.to_come("activity", off=True), "activities.ics")

    def one(asking: Asking) -> Download:
        occasion = people.occasions.of(asking.names["key"])
        return calendar_file(asking, (occasion,), f"{occasion.id}.ics")

    def booked(asking: Asking) -> Shown | Moved:
        way, _, act = asking.path.rpartition("/")
        try:
            if asking.guest is not None:
                return pages.cancel(asking) if act == "cancel" else pages.book(asking)
        except PeopleError as error:
            if error.key != "no-account":  # who deleted it meanwhile is signed out
                raise
        return Moved(asking.address("/me", next=way))

    counter.page("/activities.ics", all_activities)
    counter.page("/activities", activities)
    counter.page("/visit", visit)
    for part in ("activities", "visit"):
        counter.page(f"/{part}/{{key}}.ics", one)
        counter.page(f"/{part}/{{key}}", pages.page)
        counter.act(f"/{part}/{{key}}/book", booked, pages.page)
        counter.act(f"/{part}/{{key}}/cancel", booked, pages.page)
