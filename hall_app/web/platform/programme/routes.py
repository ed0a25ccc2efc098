"""The programme's addresses."""

from __future__ import annotations

from hall_app.web.platform.counter import Asking, Counter, Download, Moved, Shown
from hall_app.web.platform.programme.calendar import calendar_file
from hall_app.web.platform.programme.lists import activities_page, visit_page
from hall_app.web.platform.programme.occasion import OccasionPages

__all__ = ["add_programme"]


def add_programme(counter: Counter) -> None:
    """Add /activities, /visit, and what is below them."""
    people, pages = counter.people, OccasionPages(counter)

    def activities(asking: Asking) -> Shown:
        return activities_page(asking, people.occasions.to_come("activity"))

    def visit(asking: Asking) -> Shown:
        return visit_page(asking, people.occasions.to_come("visit"))

    def all_activities(asking: Asking) -> Download:
        return calendar_file(asking, people.occasions.to_come("activity", off=True), "activities.ics")

    def one(asking: Asking) -> Download:
        occasion = people.occasions.of(asking.names["key"])
        return calendar_file(asking, (occasion,), f"{occasion.id}.ics")

    def booked(asking: Asking) -> Shown | Moved:
        if asking.guest is None:
            return Moved(
                asking.address("/me", next=asking.path.removesuffix("/book").removesuffix("/cancel"))
            )
        return pages.cancel(asking) if asking.path.endswith("/cancel") else pages.book(asking)

    counter.page("/activities.ics", all_activities)
    counter.page("/activities", activities)
    counter.page("/visit", visit)
    for part in ("activities", "visit"):
        counter.page(f"/{part}/{{key}}.ics", one)
        counter.page(f"/{part}/{{key}}", pages.page)
        counter.act(f"/{part}/{{key}}/book", booked, pages.page)
        counter.act(f"/{part}/{{key}}/cancel", booked, pages.page)
