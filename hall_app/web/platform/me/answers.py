"""Withdrawal codes of answers: kept in the account by who asks for it in so many words, and by nobody else."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import TYPE_CHECKING

from hall_app.house.people import PeopleError
from hall_app.house.people.records import KeptCode, checked_code
from hall_app.web.platform.counter import (
    Asking,
    Counter,
    Field,
    Moved,
    Page,
    Shown,
    button,
    form,
    told_time,
)
from hall_app.web.platform.me.notices import notice
from survey import AnswerError, StoreError

if TYPE_CHECKING:
    from survey.store import Given

__all__ = ["KEEP_CODE", "AnswerShelf"]

KEEP_CODE = "/me/answers/new"  # where the thanks of a questionnaire hand a code to, for who asks
_STATES = {  # zh, en
    "standing": ("", ""),
    "frozen": ("已定稿用于评估，不能再撤回", "fixed for evaluation, can no longer be withdrawn"),
    "withdrawn": ("已撤回", "withdrawn"),
    "gone": ("本馆没有这个撤回码的回答", "the house has no answers of this code"),
}
_LOST = (
    "问卷现在读不到，请稍后再试。",
    "The questionnaires cannot be reached just now: try again in a minute.",
)


class AnswerShelf:
    """The codes that an account keeps."""

    def __init__(self, counter: Counter) -> None:
        self._house, self._people, self._pace = counter.house, counter.people, counter.pace

    def section(self, asking: Asking) -> str:
        """Of the page of all that one has."""
        word, kept = asking.word, self._people.answer_codes.of(asking.person.id)
        told = word(
            "问卷的撤回码平时只在您手里。只有您要求时，账户才保管它，账户也就与那份回答连在一起。",
            "Withdrawal codes of questionnaires are yours alone. The account keeps one only where you ask for that, "
            "and then it leads to those answers.",
        )
        try:
            found = self._found(kept)
            lines = "".join(self._line(asking, one, found.get(one.code)) for one in kept)
        except StoreError:
            lines = f"<li><span>{word(*_LOST)}</span></li>"
        listed = f'<ul class="rows">{lines}</ul>' if kept else ""
        way = f'<a href="{asking.address(KEEP_CODE)}">{word("保管一个撤回码", "Keep a code")}</a>'
        return f'<p class="quiet">{told}</p>{listed}<p class="doors">{way}</p>'

    def _line(self, asking: Asking, one: KeptCode, given: Given | None) -> str:
        word = asking.word
        told = word(*_STATES["gone" if given is None else given.state])
        name = word("回答", "Answers") if given is None else self._title(asking, given.questionnaire)
        about = {"about": f"{name} {one.code[:8]}", "hidden": {"code": one.code}}
        way = "/me/answers"
        acts = button(asking, "forget", f"{way}/forget", word("忘记撤回码", "Forget this code"), **about)
        if given is not None and given.state == "standing":
            back = word("撤回我的回答", "Withdraw my answers")
            acts = button(asking, "withdraw", f"{way}/withdraw", back, **about) + acts
        since = f"{word('保管于', 'kept since')} {told_time(one.made, asking.lang)}"
        return f"""<li class="code-kept"><span><b>{escape(name)}</b><br><code>{one.code}</code><br>
<span class="quiet">{since}{f"<br>{told}" if told else ""}</span></span><span class="deeds">{acts}</span></li>"""

    def offer(self, asking: Asking) -> Shown:
        """Asks before a code is kept: what that means, and a box that nobody has ticked."""
        word = asking.word
        title = word("让账户保管撤回码", "Keep a withdrawal code in the account")
        lead = word(
            "撤回码平时只在您手里，本馆不知道哪份回答是谁的。由账户保管之后，账户就与这份回答连在一起："
            "能读取本馆数据库的人可以看出，这份回答出自您。",
            "As a rule nobody but you has the code, and the house cannot tell whose answers are whose. A code in the "
            "account links the account to these answers: whoever can read the house's database can then tell that "
            "they are yours.",
        )
        inside = self._form(asking) if asking.guest else _sign_in_first(asking)
        main = f"""<header><h1>{title}</h1><p class="lead">{lead}</p></header>{notice(asking)}
<div class="desk">{inside}</div>"""
        return Shown(Page(title, main, "me"), path=KEEP_CODE)

    def _form(self, asking: Asking) -> str:
        word = asking.word
        yes = word("是的，请把我的账户与这份回答连在一起", "Yes, link my account to these answers")
        after = word(
            "您可以随时让账户忘记它，或凭它撤回回答。删除账户时它一并删除；回答则留下，不再与任何人相连。",
            "You can have it forgotten, or withdraw the answers by it, at any time. Deleted with the account it leads "
            "nowhere: the answers stay, and are nobody's.",
        )
        sent = form(
            asking,
            "keep-code",
            "/me/answers/keep",
            (
                Field(
                    "code",
                    word("撤回码", "Withdrawal code"),
                    value=asking.form.get("code", ""),
                    given={"autocomplete": "off", "maxlength": "60", "spellcheck": "false"},
                ),
                Field("consent", yes, "check", hint=after),
            ),
            word("保管撤回码", "Keep the code"),
        )
        back = f'<a href="{asking.address("/me")}#answers">{word("我的账户", "Your account")}</a>'
        return f'{sent}<p class="doors">{back}</p>'

    def keep(self, asking: Asking) -> Moved:
        self._pace.take("code", asking.network)
        code = checked_code(asking.form.get("code", ""))
        given = self._house.survey_answers and self._house.survey_answers.of_codes([code]).get(code)
        if not given:
            raise PeopleError("no-answer")
        if given.state == "withdrawn":
            raise PeopleError("answer-withdrawn")
        if asking.form.get("consent") != "on":
            raise PeopleError("answer-consent")
        self._people.answer_codes.keep(asking.person.id, code)
        return Moved(asking.address("/me#answers", done="code-kept"))

    def forget(self, asking: Asking) -> Moved:
        self._people.answer_codes.forget(asking.person.id, asking.form.get("code", ""))
        return Moved(asking.address("/me#answers", done="code-forgotten"))

    def withdraw(self, asking: Asking) -> Moved:
        """First the answers go, then the code: broken off between the two, it can be done again."""
        code, person = checked_code(asking.form.get("code", "")), asking.person.id
        if code not in {one.code for one in self._people.answer_codes.of(person)}:
            raise PeopleError("no-answer")
        survey = self._house.survey_answers
        try:
            if survey is None:
                raise PeopleError("no-answer")
            wholly = survey.take_back(code)
        except AnswerError as error:
            raise PeopleError("answer-frozen" if error.status == 409 else "no-answer") from None
        self._people.answer_codes.forget(person, code)
        return Moved(asking.address("/me#answers", done="withdrawn" if wholly else "withdrawn-soon"))

    def _found(self, kept: tuple[KeptCode, ...]) -> Mapping[str, Given]:
        survey = self._house.survey_answers
        return survey.of_codes([one.code for one in kept]) if survey is not None and kept else {}

    def _title(self, asking: Asking, questionnaire: str) -> str:
        survey = self._house.survey_answers
        found = survey.questionnaires.get(questionnaire) if survey is not None else None
        return questionnaire if found is None else getattr(found.title, asking.lang)


def _sign_in_first(asking: Asking) -> str:
    word = asking.word
    told = word(
        "请先登录，再回到问卷的致谢页按一次“存入我的账户”；它仍开着，撤回码就在那里。也可以登录后在这里填写撤回码。",
        "Sign in first. The page with the thanks is still open beside this one and shows the code: press the button "
        "there again, or come here once you are signed in and type the code.",
    )
    ways = (
        (asking.address("/me", next=asking.address(KEEP_CODE)), word("登录", "Sign in")),
        (
            asking.address("/me/register", next=asking.address(KEEP_CODE)),
            word("注册账户", "Make an account"),
        ),
    )
    listed = "".join(f'<a href="{escape(to)}">{name}</a>' for to, name in ways)
    return f'<p>{told}</p><p class="doors">{listed}</p>'
