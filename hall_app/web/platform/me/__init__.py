"""The user centre, /me and below.

entering: sign in, sign up, codes; centre: what one has; keepsakes: favourites, visits; safety: password, second factor,
sessions, copy, deletion; notices: what was done; routes: their addresses.
"""

from hall_app.web.platform.me.routes import add_me

__all__ = ["add_me"]
