"""Signing in, signing up, opening an account by a code from the desk: there is no mail server."""

from __future__ import annotations

from html import escape

from hall_app.house.people import PeopleError
from hall_app.web.platform.counter import (
    Asking,
    Counter,
    Field,
    Moved,
    Page,
    Shown,
    address_field,
    form,
    sign_in_fields,
    signed_in,
)

__all__ = ["Entrance"]


class Entrance:
    """Pages and acts of who is not signed in."""

    def __init__(self, counter: Counter) -> None:
        self._counter, self._people, self._pace = counter, counter.people, counter.pace

    def sign_in_page(self, asking: Asking) -> Shown:
        word, after = asking.word, asking.afterwards
        sent = form(
            asking,
            "sign-in",
            "/me/sign-in",
            sign_in_fields(
                asking, code_hint=word("六位数字，或一个恢复码", "Six digits, or a recovery code")
            ),
            word("登录", "Sign in"),
            hidden={"next": after},
        )
        register = asking.address("/me/register", next=after)
        return _shown(
            asking,
            "/me",
            word("登录", "Sign in"),
            word(
                "展厅、文章与研究无需账户即可使用。账户用来保存收藏、参观记录与预约。",
                "The hall, the articles and the research need no account. An account keeps favourites, visits and "
                "reservations.",
            ),
            sent,
            f"""<p class="doors"><a href="{escape(register)}">{word("注册账户", "Make an account")}</a>
<a href="{asking.address("/me/open")}">{word("忘记密码或有代码", "Password lost, or a code to use")}</a></p>""",
        )

    def sign_in(self, asking: Asking) -> Moved:
        came = signed_in(self._counter, asking)
        lang = asking.form.get("lang") or came.person.language
        return Moved(asking.afterwards or f"/me?lang={lang}", came.token, came.mark)

    def register_page(self, asking: Asking) -> Shown | Moved:
        if asking.guest:
            return Moved(asking.address("/me"))
        word = asking.word
        sent = form(
            asking,
            "register",
            "/me/register",
            (
                address_field(asking),
                Field(
                    "name",
                    word("称呼（可不填）", "What to call you (may stay empty)"),
                    needed=False,
                    given={"autocomplete": "name", "maxlength": "80"},
                ),
                *new_password(asking),
            ),
            word("注册", "Make the account"),
            hidden={"next": asking.afterwards},
        )
        return _shown(
            asking,
            "/me/register",
            word("注册账户", "Make an account"),
            word(
                "只需邮箱与密码。本馆不发送邮件；忘记密码时，前台可给您一个一次性代码。您可随时导出或删除全部资料。",
                "An address and a password are all it takes. The house sends no mail: where a password is lost, the "
                "desk hands out a one-time code. You can take a copy of everything, and delete it, at any time.",
            ),
            sent,
            f'<p class="doors"><a href="{escape(asking.address("/me", next=asking.afterwards))}">'
            f"{word('已有账户，去登录', 'I have an account: sign in')}</a>"
            f'<a href="{asking.address("/me/privacy")}">{word("保存哪些资料", "What is kept of you")}</a></p>',
        )

    def register(self, asking: Asking) -> Moved:
        given = asking.form
        self._pace.take("sign up", asking.network)
        password = given_password(asking)
        person = self._people.accounts.sign_up(
            given.get("address", ""), password, name=given.get("name", ""), language=asking.lang
        )
        sessions, after = self._people.sessions, asking.afterwards or asking.address("/me", done="registered")
        return Moved(after, sessions.open(person), sessions.mark(person.id))

    def open_page(self, asking: Asking) -> Shown:
        word, code = asking.word, asking.form.get("code", asking.query.get("code", ""))
        sent = form(
            asking,
            "open",
            "/me/open",
            (
                Field(
                    "code",
                    word("一次性代码", "One-time code"),
                    value=code,
                    hint=word("形如 ABCD-EFGH-JKMN，大小写均可", "Such as ABCD-EFGH-JKMN, in any case"),
                    given={"autocomplete": "off", "maxlength": "100", "spellcheck": "false"},
                ),
                *new_password(asking),
            ),
            word("设置密码并登录", "Set the password and sign in"),
        )
        return _shown(
            asking,
            "/me/open",
            word("用一次性代码开启账户", "Open an account by a one-time code"),
            word(
                "请向前台或管理员索取代码或链接。它只能用一次，三天内有效；设置新密码后，其他设备上的登录都会结束。",
                "Ask the desk or an administrator for a code or a link. It is good once, for three days. With the new "
                "password you are signed out everywhere else.",
            ),
            sent,
            f'<p class="doors"><a href="{asking.address("/me")}">{word("去登录", "Sign in")}</a></p>',
            query={"code": code} if code else None,
        )

    def open(self, asking: Asking) -> Moved:
        self._pace.take("code", asking.network)
        person = self._people.accounts.use_code(asking.form.get("code", ""), given_password(asking))
        if person.second_factor:  # a code stands in for the password, not for the phone
            return Moved(asking.address("/me", done="opened"))
        sessions = self._people.sessions
        return Moved(asking.address("/me", done="opened"), sessions.open(person), sessions.mark(person.id))


def new_password(asking: Asking) -> tuple[Field, Field]:
    """A new password, typed twice."""
    word, kept = asking.word, {"autocomplete": "new-password"}
    hint = word(
        "至少 10 个字符；几个词连起来最好记", "At least 10 characters: a few words in a row are easy to keep"
    )
    return (
        Field("password", word("新密码", "New password"), "password", hint=hint, given=kept),
        Field("again", word("再输入一次", "The same again"), "password", given=kept),
    )


def given_password(asking: Asking) -> str:
    """Raises PeopleError where the two differ."""
    password = asking.form.get("password", "")
    if password != asking.form.get("again", ""):
        raise PeopleError("again-differs")
    return password


def _shown(
    asking: Asking,
    path: str,
    title: str,
    lead: str,
    sent: str,
    below: str,
    *,
    query: dict[str, str] | None = None,
) -> Shown:
    from hall_app.web.platform.me.notices import notice

    main = f"""<header><h1>{title}</h1><p class="lead">{lead}</p></header>{notice(asking)}
<div class="desk">{sent}{below}</div>"""
    kept = query or ({"next": asking.afterwards} if asking.afterwards else {})
    return Shown(Page(title, main, "me", kept), path=path)
