"""The platform round the hall: what takes an account, or gives one.

counter: what all pages with forms have in common; me: signing in, and the user centre;
programme: activities and visits, booked; office: what the staff have.
"""

from hall_app.web.platform.me import KEEP_CODE
from hall_app.web.platform.programme import programme_entries
from hall_app.web.platform.routes import NoteLook, add_platform, follow_withdrawals

__all__ = ["KEEP_CODE", "NoteLook", "add_platform", "follow_withdrawals", "programme_entries"]
