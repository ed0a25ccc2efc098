"""The office's own door: a session of twelve hours, apart from that of a visitor; and its first page."""

from __future__ import annotations

from hall_app.house.people import ROLES
from hall_app.web.platform.counter import Asking, Counter, Moved, Page, Shown, form, sign_in_fields, signed_in
from hall_app.web.platform.office.table import office_page

__all__ = ["Reception"]


class Reception:
    """Signing in and out."""

    def __init__(self, counter: Counter) -> None:
        self._counter, self._people = counter, counter.people

    def page(self, asking: Asking) -> Shown:
        return self._first(asking) if asking.guest else self.sign_in_page(asking)

    def sign_in_page(self, asking: Asking) -> Shown:
        word = asking.word
        title = word("办公室", "Office")
        lead = word(
            "供本馆工作人员使用。第一位管理员由命令 hall admin create 任命。",
            "For the staff of the house. Its first administrator is named by the command hall admin create.",
        )
        sent = form(asking, "sign-in", "/office/sign-in", sign_in_fields(asking), word("登录", "Sign in"))
        main = f'<header><h1>{title}</h1><p class="lead">{lead}</p></header><div class="desk">{sent}</div>'
        return Shown(Page(title, main), path="/office")

    def sign_in(self, asking: Asking) -> Moved:
        came = signed_in(self._counter, asking)
        return Moved(asking.address("/office"), came.token, came.mark)

    def sign_out(self, asking: Asking) -> Moved:
        if asking.guest is not None:
            person = asking.person.id
            self._people.sessions.end(person, "sign out", person, asking.guest.session.id)
        return Moved(asking.address("/office"), "")

    def _first(self, asking: Asking) -> Shown:
        word, person = asking.word, asking.person
        roles = word("、", ", ").join(ROLES[role][asking.lang == "en"] for role in sorted(person.roles))
        told = word(
            f"您是：{roles}。上方列出您可以使用的部分。",
            f"You are here as: {roles}. What you may use stands above.",
        )
        warned = (
            ""
            if person.second_factor
            else word(
                "您的账户尚未开启两步验证，请在“账户”页开启。",
                "Your account has no second factor yet: set it up on the page of your account.",
            )
        )
        at, name = asking.address("/me/second-factor"), word("两步验证", "Second factor")
        way = f'<p class="doors"><a href="{at}">{name}</a></p>'
        return office_page(
            asking,
            word("办公室", "Office"),
            f"<p>{told}</p>" + (f"<p>{warned}</p>{way}" if warned else ""),
            path="",
        )
