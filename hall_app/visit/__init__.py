"""Who is in the hall.

visitors: one visitor a page, and the marks that tie him to viser's client; places: who is inside and who waits.
"""

from hall_app.visit.places import AWAY, KEPT, MOST_VISITORS, WAITING_OF_ONE_ADDRESS, Places, Ticket
from hall_app.visit.visitors import Marks, Visitor, Visitors

__all__ = [
    "AWAY",
    "KEPT",
    "MOST_VISITORS",
    "WAITING_OF_ONE_ADDRESS",
    "Marks",
    "Places",
    "Ticket",
    "Visitor",
    "Visitors",
]
