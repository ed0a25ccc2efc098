"""The database of people: `tables`, `schema` and its upgrades, and `ledger`, the one way to change anything in it."""

from hall_app.house.people.database import tables
from hall_app.house.people.database.ledger import CONSOLE, NOBODY, PEOPLE_FILE, Ledger
from hall_app.house.people.database.schema import HEAD

__all__ = ["CONSOLE", "HEAD", "NOBODY", "PEOPLE_FILE", "Ledger", "tables"]
