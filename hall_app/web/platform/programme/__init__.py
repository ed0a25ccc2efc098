"""Activities and visits: lists (what there is, by day), occasion (one of them, booked and cancelled), calendar (.ics),
reservations (of who is signed in), found (by the search). routes puts them at /activities and /visit."""

from hall_app.web.platform.programme.found import programme_entries
from hall_app.web.platform.programme.reservations import reservations
from hall_app.web.platform.programme.routes import add_programme

__all__ = ["add_programme", "programme_entries", "reservations"]
