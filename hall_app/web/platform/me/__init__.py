"""The user centre, /me and below.

entering: sign in, sign up, codes; centre: what one has; keepsakes: favourites, visits; safety: password, second factor,
sessions, copy, deletion; answers: withdrawal codes that are kept for who asks; notices: what was done; routes:
their addresses.
"""

from hall_app.web.platform.me.answers import KEEP_CODE
from hall_app.web.platform.me.routes import add_me

__all__ = ["KEEP_CODE", "add_me"]
