"""People: visitors with accounts, the staff and their roles. No web, no pages; README.md tells the rules.

acts: who may do what, one table. database: tables, and the ledger, the one way to change anything. credentials:
passwords, codes, the second factor. records: accounts, sessions, roles, journal. people: all of it;
command: `hall admin`.
"""

from hall_app.house.people.acts import ACTS, OWN_ACTS, ROLES, Act, Role, may
from hall_app.house.people.errors import REFUSALS, PeopleError
from hall_app.house.people.people import People, existing_people
from hall_app.house.people.records import Entry, Person, Session

__all__ = [
    "ACTS",
    "OWN_ACTS",
    "REFUSALS",
    "ROLES",
    "Act",
    "Entry",
    "People",
    "PeopleError",
    "Person",
    "Role",
    "Session",
    "existing_people",
    "may",
]
