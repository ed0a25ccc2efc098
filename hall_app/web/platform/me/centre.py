"""The user centre: all that one has here on one page, each part with its own small forms."""

from __future__ import annotations

from html import escape

from hall_app.web.pages.frame import part
from hall_app.web.platform.counter import (
    Asking,
    Counter,
    Field,
    Moved,
    Page,
    Shown,
    button,
    clock_line,
    form,
    told_time,
)
from hall_app.web.platform.me.answers import AnswerShelf
from hall_app.web.platform.me.keepsakes import Shelf
from hall_app.web.platform.me.notices import notice
from hall_app.web.platform.me.safety import password_form, present_code
from hall_app.web.platform.programme import reservations

__all__ = ["Centre"]


class Centre:
    """The page of who is signed in."""

    def __init__(self, counter: Counter) -> None:
        self._people, self._shelf, self._answers = counter.people, Shelf(counter), AnswerShelf(counter)

    def page(self, asking: Asking) -> Shown:
        word, person = asking.word, asking.person
        title = word("我的账户", "Your account")
        out = button(asking, "sign-out", "/me/sign-out", word("退出登录", "Sign out"), hidden={})
        parts = (*self._kept(asking), *self._account(asking))
        ways = "".join(f'<a href="#{key}">{name}</a>' for key, name, _ in parts)
        if person.roles:
            ways += f'<a href="{asking.address("/office")}">{word("办公室", "Office")}</a>'
        bodies = "".join(part(key, name, inside) for key, name, inside in parts)
        main = f"""<header class="who"><div><h1>{title}</h1>
<p class="lead">{escape(person.name or person.address)}</p></div>{out}</header>{notice(asking)}
<nav class="doors" aria-label="{word("本页", "On this page")}">{ways}</nav>{clock_line(bodies, asking.lang)}
<div class="centre">{bodies}</div>"""
        return Shown(Page(title, main, "me"), path="/me")

    def _kept(self, asking: Asking) -> tuple[tuple[str, str, str], ...]:
        word = asking.word
        return (
            ("reservations", word("预约", "Reservations"), reservations(asking, self._people)),
            ("favourites", word("收藏", "Favourites"), self._shelf.favourites(asking)),
            ("visits", word("参观记录", "Visits"), self._shelf.visits(asking)),
            ("answers", word("问卷回答", "Your answers"), self._answers.section(asking)),
        )

    def _account(self, asking: Asking) -> tuple[tuple[str, str, str], ...]:
        word = asking.word
        return (
            ("profile", word("资料", "Profile"), self._profile(asking)),
            ("password", word("密码", "Password"), password_form(asking)),
            ("second-factor", word("两步验证", "Second factor"), _second_factor(asking)),
            ("sessions", word("登录的设备", "Where you are signed in"), self._sessions(asking)),
            ("data", word("我的资料", "Your data"), _data(asking)),
        )

    def _profile(self, asking: Asking) -> str:
        word, person = asking.word, asking.person
        verified = (
            word("邮箱已由前台确认。", "The desk has confirmed your address.")
            if person.verified
            else word(
                "邮箱未经确认，不影响使用。", "Your address is not confirmed, which changes nothing for you."
            )
        )
        sent = form(
            asking,
            "profile",
            "/me/profile",
            (
                Field(
                    "name",
                    word("称呼", "What to call you"),
                    value=person.name,
                    needed=False,
                    given={"autocomplete": "name", "maxlength": "80"},
                ),
                Field(
                    "language",
                    word("语言", "Language"),
                    "select",
                    value=person.language,
                    choices={"zh": "中文", "en": "English"},
                ),
            ),
            word("保存", "Save"),
        )
        return f'<p class="quiet">{escape(person.address)}<br>{verified}</p>{sent}'

    def set_profile(self, asking: Asking) -> Moved:
        given = asking.form
        language = given.get("language", "zh")
        self._people.accounts.set_profile(asking.person.id, name=given.get("name", ""), language=language)
        return Moved(f"/me?lang={'en' if language == 'en' else 'zh'}&done=profile#profile")

    def _sessions(self, asking: Asking) -> str:
        word = asking.word
        assert asking.guest is not None
        lines = []
        for one in self._people.sessions.of(asking.person.id):
            here = one.id == asking.guest.session.id
            place = word("办公室", "the office") if one.office else word("参观者", "as a visitor")
            name = word("本设备", "this device") if here else place
            until = told_time(one.expires, asking.lang)
            ended = button(
                asking,
                "session",
                "/me/sessions/end",
                word("结束", "End"),
                about=f"{one.made.astimezone():%Y-%m-%d %H:%M}",
                hidden={"session": str(one.id)},
            )
            lines.append(
                f"<li><span>{told_time(one.made, asking.lang)} · {name}<br>"
                f'<span class="quiet">{word("有效至", "until")} {until}</span></span>{"" if here else ended}</li>'
            )
        others = button(
            asking,
            "sessions",
            "/me/sessions/end",
            word("结束其他所有登录", "End all others"),
            hidden={"session": "others"},
        )
        return f'<ul class="rows">{"".join(lines)}</ul>{others if len(lines) > 1 else ""}'


def _second_factor(asking: Asking) -> str:
    word = asking.word
    if not asking.person.second_factor:
        told = word(
            "登录时除密码外，再输入手机验证器显示的六位数字。",
            "Beside the password, signing in then takes six digits that an app on your phone shows.",
        )
        way = asking.address("/me/second-factor")
        return (
            f'<p class="quiet">{told}</p><p class="doors"><a href="{way}">{word("开启", "Set it up")}</a></p>'
        )
    field = Field(
        "password",
        word("当前密码", "Current password"),
        "password",
        given={"autocomplete": "current-password"},
    )
    told = word("两步验证已开启。", "The second factor is on.")
    way = f'<a href="{asking.address("/me/second-factor")}">{word("更换验证器", "Replace the authenticator")}</a>'
    sent = form(
        asking,
        "factor-off",
        "/me/second-factor/end",
        (present_code(asking, "code"), field),
        word("关闭两步验证", "Turn it off"),
    )
    return f'<p class="quiet">{told}</p><p class="doors">{way}</p>{sent}'


def _data(asking: Asking) -> str:
    word = asking.word
    told = word(
        "导出的压缩包含本馆保存的关于您的全部资料，包括您让账户保管的撤回码。问卷的回答本身不在账户里，不在其中。",
        "The archive holds all that the house keeps about you, withdrawal codes that you had kept among it. Answers "
        "to questionnaires do not lie in the account and are not in it.",
    )
    copy = button(asking, "copy", "/me/copy", word("导出全部资料（ZIP）", "Take a copy (ZIP)"), hidden={})
    away = f'<a href="{asking.address("/me/delete")}">{word("删除账户", "Delete the account")}</a>'
    kept = f'<a href="{asking.address("/me/privacy")}">{word("账户与隐私", "Accounts and privacy")}</a>'
    return f'<p class="quiet">{told}</p>{copy}<p class="doors">{kept}{away}</p>'
