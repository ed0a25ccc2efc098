"""What keeps an account one's own: password, second factor, sessions; and what takes it away: copy, deletion."""

from __future__ import annotations

from contextlib import AbstractContextManager
from html import escape

from hall_app.house.people.credentials import authenticator_address, new_authenticator
from hall_app.web.platform.counter import Asking, Counter, Download, Field, Moved, Page, Shown, form
from hall_app.web.platform.me.entering import given_password, new_password

__all__ = ["Safety", "password_form", "present_code"]


class Safety:
    """Acts of who is signed in. What asks for the password again is counted as signing in is."""

    def __init__(self, counter: Counter) -> None:
        self._house, self._people, self._pace = counter.house, counter.people, counter.pace

    def sign_out(self, asking: Asking) -> Moved:
        assert asking.guest is not None
        self._people.sessions.end(asking.person.id, "sign out", asking.person.id, asking.guest.session.id)
        return Moved(asking.address("/me", done="signed-out"), "")

    def set_password(self, asking: Asking) -> Moved:
        assert asking.guest is not None
        keep, person = asking.guest.session.id, asking.person
        new = given_password(asking)
        with self._counted(asking):
            self._people.accounts.set_password(person, asking.form.get("old", ""), new, keep=keep)
        mark = self._people.sessions.mark(person.id)  # the former went with the former password
        return Moved(asking.address("/me#password", done="password"), mark=mark)

    def second_factor_page(self, asking: Asking) -> Shown:
        import segno

        word, on = asking.word, asking.person.second_factor
        secret = asking.form.get("secret", "") or new_authenticator()
        house = getattr(self._house.content.hall.title, asking.lang)
        square = segno.make(authenticator_address(secret, asking.person.address, house), error="m")
        picture = square.svg_data_uri(scale=5, dark="#201c1a", light="#fff")
        alt = word(
            "供验证器扫描的二维码，与下面的密钥相同", "Square code for the app, the same as the key below"
        )
        spaced = " ".join(secret[at : at + 4] for at in range(0, len(secret), 4))
        title = (
            word("更换验证器", "Replace the authenticator")
            if on
            else word("开启两步验证", "Set up the second factor")
        )
        lead = word(
            "用任何验证器应用扫描此码，或手工输入密钥。",
            "Scan the square with any authenticator app, or type the key in by hand.",
        )
        main = f"""<header><h1>{title}</h1><p class="lead">{lead}</p></header><div class="desk">
<img class="square" src="{escape(picture)}" alt="{alt}" width="245" height="245">
<p>{word("密钥", "Key")}: <code>{spaced}</code></p>{_factor_form(asking, secret)}
<p class="doors"><a href="{asking.address("/me")}">{word("返回", "Back")}</a></p></div>"""
        return Shown(Page(title, main, "me"), path="/me/second-factor")

    def begin_second_factor(self, asking: Asking) -> Shown:
        given, word, secret = asking.form, asking.word, _secret(asking.form.get("secret", ""))
        with self._counted(asking):
            codes = self._people.accounts.begin_second_factor(
                asking.person,
                given.get("password", ""),
                secret,
                given.get("code", ""),
                given.get("present", ""),
            )
        title = word("恢复码", "Recovery codes")
        lead = word(
            "两步验证已开启。请抄下或打印这些恢复码：手机不在时，每个可代替验证码一次。它们不会再显示。",
            "The second factor is on. Write these down or print them: without the phone each stands in for its digits "
            "once. They are not shown again.",
        )
        listed = "".join(f"<li><code>{code}</code></li>" for code in codes)
        main = f"""<header><h1>{title}</h1><p class="lead" role="status">{lead}</p></header><div class="desk">
<ol class="codes">{listed}</ol>
<p class="doors"><a href="{asking.address("/me")}">{word("我已抄好", "I have them")}</a></p></div>"""
        return Shown(Page(title, main, "me"), path="/me")

    def end_second_factor(self, asking: Asking) -> Moved:
        given = asking.form
        with self._counted(asking):
            self._people.accounts.end_second_factor(
                asking.person, given.get("password", ""), given.get("code", "")
            )
        return Moved(asking.address("/me#second-factor", done="factor-off"))

    def end_session(self, asking: Asking) -> Moved:
        assert asking.guest is not None
        person, session = asking.person.id, asking.form.get("session", "")
        if session == "others":
            self._people.sessions.end_all(person, "sign out", person, but=asking.guest.session.id)
            return Moved(asking.address("/me#sessions", done="sessions"))
        number = int(session) if session.isascii() and session.isdigit() and len(session) < 10 else 0
        self._people.sessions.end(person, "sign out", person, number)
        return Moved(asking.address("/me#sessions", done="session"))

    def copy(self, asking: Asking) -> Download:
        self._pace.take("copy", asking.person.id)
        from hall_app.house.drafts import Drafts, Shelf

        content, data, person = self._house.content.folder, self._house.data, asking.person
        drafts = Drafts(content, data, Shelf(data / "shelf", self._house.quota)).all().values()
        mine = [{"exhibit": one.exhibit, "at": one.at} for one in drafts if one.by == person.id]
        return Download(self._people.copy_of(person, mine), "my-data.zip", "application/zip")

    def delete_page(self, asking: Asking) -> Shown:
        word = asking.word
        title = word("删除账户", "Delete the account")
        lead = word(
            "账户、收藏、参观记录与预约将立即删除，无法恢复；此前所做的备份由本馆另行保管与销毁。请先导出需要保留的资料。",
            "The account, favourites, visits and reservations go at once and cannot be brought back; backups made "
            "before are kept and destroyed by the house. Take a copy first of what you want to keep.",
        )
        kept = len(self._people.answer_codes.of(asking.person.id))
        codes = word(
            f"账户保管的 {kept} 个撤回码一并删除；那些回答仍会留下，不再与任何人相连，本馆也无法再替您撤回。"
            "要删除回答，请先撤回。",
            f"Withdrawal codes that the account keeps go with it ({kept}). Those answers stay, are nobody's from then "
            "on, and the house cannot withdraw them for you any more: withdraw first what should go.",
        )
        way = f'<a href="{asking.address("/me")}#answers">{word("我的问卷回答", "My answers")}</a>'
        told = f'<p>{codes}</p><p class="doors">{way}</p>' if kept else ""
        sent = form(
            asking,
            "delete",
            "/me/delete",
            (_current(asking),),
            word("永久删除", "Delete for good"),
            style="grave",
        )
        main = f"""<header><h1>{title}</h1><p class="lead">{lead}</p></header><div class="desk">{told}{sent}
<p class="doors"><a href="{asking.address("/me")}">{word("保留账户", "Keep the account")}</a></p></div>"""
        return Shown(Page(title, main, "me"), path="/me/delete")

    def delete(self, asking: Asking) -> Moved:
        with self._counted(asking):
            self._people.accounts.delete(asking.person, asking.form.get("password", ""))
        return Moved(asking.address("/me", done="deleted"), "")

    def _counted(self, asking: Asking) -> AbstractContextManager[None]:
        """By the session: whoever guesses at the account elsewhere takes nothing from who is signed in."""
        assert asking.guest is not None
        session = f"session {asking.guest.session.id}"
        return self._pace.failures(
            ("account from here", asking.person.id, session), ("account", asking.person.id, session)
        )


def _factor_form(asking: Asking, secret: str) -> str:
    word, on = asking.word, asking.person.second_factor
    shown = Field(
        "code",
        word("新验证器显示的六位数字", "Six digits that the new app shows")
        if on
        else word("验证器显示的六位数字", "Six digits that the app shows"),
        given={"autocomplete": "one-time-code", "inputmode": "numeric", "maxlength": "10"},
    )
    fields = (shown, *((present_code(asking, "present"),) if on else ()), _current(asking))
    words = word("更换", "Replace it") if on else word("开启", "Turn it on")
    return form(asking, "second-factor", "/me/second-factor", fields, words, hidden={"secret": secret})


def present_code(asking: Asking, name: str) -> Field:
    """A code of the second factor that is on."""
    word = asking.word
    return Field(
        name,
        word("现用验证器的验证码", "Code of the authenticator that is on"),
        hint=word("六位数字，或一个恢复码", "Six digits, or a recovery code"),
        given={"autocomplete": "one-time-code", "maxlength": "40"},
    )


def password_form(asking: Asking) -> str:
    word = asking.word
    return form(
        asking,
        "password",
        "/me/password",
        (_current(asking, "old"), *new_password(asking)),
        word("更改密码", "Change the password"),
    )


def _current(asking: Asking, name: str = "password") -> Field:
    label = asking.word("当前密码", "Current password")
    return Field(name, label, "password", given={"autocomplete": "current-password"})


def _secret(given: str) -> str:
    """The key as the page that set it up showed it; anything else is no key of ours, and no code fits it."""
    from hall_app.house.people import PeopleError

    if len(given) != 32 or not set(given) <= set("ABCDEFGHIJKLMNOPQRSTUVWXYZ234567"):
        raise PeopleError("authenticator")
    return given
