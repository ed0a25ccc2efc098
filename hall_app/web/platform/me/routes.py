"""The user centre's addresses."""

from __future__ import annotations

from hall_app.web.platform.counter import Act, Asking, Counter, Moved, Shown, View
from hall_app.web.platform.me.answers import KEEP_CODE, AnswerShelf
from hall_app.web.platform.me.centre import Centre
from hall_app.web.platform.me.entering import Entrance
from hall_app.web.platform.me.keepsakes import Shelf
from hall_app.web.platform.me.privacy import privacy_page
from hall_app.web.platform.me.safety import Safety

__all__ = ["add_me"]


def add_me(counter: Counter) -> None:
    """Add /me and what is below it."""
    entrance, centre = Entrance(counter), Centre(counter)
    shelf, safety, answers = Shelf(counter), Safety(counter), AnswerShelf(counter)

    def me(asking: Asking) -> Shown | Moved:
        return centre.page(asking) if asking.guest else entrance.sign_in_page(asking)

    counter.page("/me", me)
    counter.act("/me/sign-in", entrance.sign_in, entrance.sign_in_page)
    counter.page("/me/privacy", privacy_page)
    counter.page("/me/register", entrance.register_page)
    counter.act("/me/register", entrance.register, entrance.register_page)
    counter.page("/me/open", entrance.open_page)
    counter.act("/me/open", entrance.open, entrance.open_page)

    def own(path: str, act: Act, page: View = me) -> None:
        counter.act(f"/me/{path}", _signed_in(act), page)

    own("sign-out", safety.sign_out)
    own("profile", centre.set_profile)
    own("password", safety.set_password)
    counter.page("/me/second-factor", _signed_in(safety.second_factor_page))
    own("second-factor", safety.begin_second_factor, _signed_in(safety.second_factor_page))
    own("second-factor/end", safety.end_second_factor)
    own("sessions/end", safety.end_session)
    own("copy", safety.copy)
    counter.page("/me/delete", _signed_in(safety.delete_page))
    own("delete", safety.delete, _signed_in(safety.delete_page))
    counter.page("/me/keep", _signed_in(shelf.keep_page))
    own("keep", shelf.keep, _signed_in(shelf.keep_page))
    own("drop", shelf.drop)
    own("visits", shelf.set_keeping)
    counter.page(KEEP_CODE, answers.offer)
    counter.handed(KEEP_CODE, answers.offer)
    own("answers/keep", answers.keep, answers.offer)
    own("answers/forget", answers.forget)
    own("answers/withdraw", answers.withdraw)


def _signed_in(act: Act) -> Act:
    """Who is not signed in is led there first, and back afterwards."""

    def asked(asking: Asking):
        if asking.guest is not None:
            return act(asking)
        way = asking.path + (f"?exhibit={asking.query['exhibit']}" if "exhibit" in asking.query else "")
        return Moved(asking.address("/me", next=way if not asking.form else ""))

    return asked
