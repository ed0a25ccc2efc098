"""What is kept of people and how it changes: accounts, sessions, roles, the journal, a person's own copy."""

from hall_app.house.people.records.accounts import CODE_DAYS, RECOVERY_CODES, Accounts
from hall_app.house.people.records.answer_codes import MOST_CODES, AnswerCodes, KeptCode, checked_code
from hall_app.house.people.records.bookings import Booking, Bookings
from hall_app.house.people.records.copy import own_copy
from hall_app.house.people.records.followups import FOLLOWED, FollowUp, FollowUps
from hall_app.house.people.records.journal import Entry, Journal
from hall_app.house.people.records.keepsakes import Favourite, Keepsakes, Look
from hall_app.house.people.records.occasions import Occasion, Occasions, Plan
from hall_app.house.people.records.person import Person, checked_address
from hall_app.house.people.records.revisions import Revision, Revisions
from hall_app.house.people.records.roles import Roles
from hall_app.house.people.records.sessions import OFFICE_HOURS, VISITOR_DAYS, Session, Sessions

__all__ = [
    "CODE_DAYS",
    "FOLLOWED",
    "MOST_CODES",
    "OFFICE_HOURS",
    "RECOVERY_CODES",
    "VISITOR_DAYS",
    "Accounts",
    "AnswerCodes",
    "Booking",
    "Bookings",
    "Entry",
    "Favourite",
    "FollowUp",
    "FollowUps",
    "Journal",
    "Keepsakes",
    "KeptCode",
    "Look",
    "Occasion",
    "Occasions",
    "Person",
    "Plan",
    "Revision",
    "Revisions",
    "Roles",
    "Session",
    "Sessions",
    "checked_address",
    "checked_code",
    "own_copy",
]
