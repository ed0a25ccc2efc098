"""Activities as the search finds them."""

from __future__ import annotations

from hall_app.content.search import Entry
from hall_app.house.people import People
from hall_app.house.people.records import Occasion
from hall_app.web.platform.programme.lists import address_of
from survey.errors import StoreError

__all__ = ["programme_entries"]


def programme_entries(people: People) -> tuple[Entry, ...]:
    """Activities to come, in each language; none while they cannot be read: the rest is found without them.

    Hours for visits are left out: there are many, all called alike, and /visit lists them by day.
    """
    try:
        found = people.occasions.to_come("activity")
    except StoreError:
        return ()
    return tuple(_entry(one, lang) for lang in ("zh", "en") for one in found)


def _entry(one: Occasion, lang: str) -> Entry:
    other = "en" if lang == "zh" else "zh"
    text = " ".join(one.told(what, lang) for what in ("place", "text"))
    address = f"{address_of(one)}?lang={lang}"
    return Entry("activity", one.id, lang, one.told("title", lang), one.told("title", other), text, address)
