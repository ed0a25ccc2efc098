"""What visitors suggested, followed up by the researcher: open, answered, done, by whom. Tokens of programs."""

from __future__ import annotations

from contextlib import suppress
from html import escape
from typing import Any

from hall_app.house.people import PeopleError
from hall_app.house.people.records import FollowUp
from hall_app.web.platform.counter import Asking, Counter, Field, Shown, button, form, told_time
from hall_app.web.platform.office.deeds import Deed, Reading, number_in
from hall_app.web.platform.office.table import office_page, rows
from survey.errors import StoreError

__all__ = ["opinion_deeds", "opinion_readings"]

LONGEST_LABEL = 80


def opinion_readings(counter: Counter) -> tuple[Reading, ...]:
    rooms = _Rooms(counter)
    return (
        Reading("suggestions", "answers", rooms.suggestions, rooms.suggestions_page),
        Reading("tokens", "tokens", rooms.tokens, rooms.tokens_page),
    )


def opinion_deeds(counter: Counter) -> tuple[Deed, ...]:
    rooms = _Rooms(counter)
    after = {"state": "open, answered or done", "note": "what was done, or nothing"}
    label = {"label": f"what it is for, {LONGEST_LABEL} characters at most"}
    return (
        Deed(
            "suggestions/{key}",
            "answers",
            rooms.follow_up,
            "suggestions",
            rooms.suggestions_page,
            fields=after,
        ),
        Deed(
            "tokens", "tokens", rooms.make_token, "tokens", rooms.tokens_page, rooms.token_page, fields=label
        ),
        Deed("tokens/{key}/revoke", "tokens", rooms.revoke_token, "tokens", rooms.tokens_page),
    )


class _Rooms:
    def __init__(self, counter: Counter) -> None:
        self._house, self._people = counter.house, counter.people

    def suggestions(self, asking: Asking) -> list[dict[str, Any]]:
        known = self._people.followups.all()
        said, found = list(self._house.survey_suggestions()), []
        survey = self._house.survey_answers
        if survey is not None and known.keys() - {one["id"] for one in said}:
            # Of an answer whose withdrawal could not be followed then, or that was purged.
            with suppress(StoreError):
                self._people.followups.forget_all(survey.withdrawn)
        for one in said:
            after = known.get(one["id"], FollowUp(one["id"], "open", "", "", None))
            told = {"state": after.state, "note": after.note, "by": after.by}
            found.append(one | told | {"at": after.at.isoformat() if after.at else None})
        return found

    def follow_up(self, asking: Asking) -> dict[str, Any]:
        key, given = asking.names["key"], asking.form
        if key not in {one["id"] for one in self._house.survey_suggestions()}:
            raise PeopleError("no-suggestion")
        self._people.followups.set(asking.person.id, key, given.get("state", ""), given.get("note", ""))
        return {"id": key, "state": given.get("state", "")}

    def tokens(self, asking: Asking) -> list[dict[str, Any]]:
        return [
            {
                "id": one.id,
                "label": one.label,
                "questionnaire": one.questionnaire,
                "expires": one.expires.isoformat() if one.expires else None,
                "used": one.used.isoformat() if one.used else None,
            }
            for one in self._house.survey_tokens().all()
        ]

    def make_token(self, asking: Asking) -> dict[str, Any]:
        label = " ".join(asking.form.get("label", "").split())
        if not 0 < len(label) <= LONGEST_LABEL:
            raise PeopleError("token-label", most=LONGEST_LABEL)
        # Where the row cannot be written the secret is shown to nobody.
        with self._people.noting(asking.person.id, "tokens", "make"):
            return {"token": self._house.survey_tokens().make(label)}

    def revoke_token(self, asking: Asking) -> dict[str, Any]:
        number = number_in(asking.names["key"])
        with self._people.noting(asking.person.id, "tokens", f"revoke {number}"):
            if not self._house.survey_tokens().revoke(number):
                raise PeopleError("no-token")
        return {"id": number, "revoked": True}

    def suggestions_page(self, asking: Asking) -> Shown:
        word, lang = asking.word, asking.lang
        names = {one.id: one.name or one.address for one in self._people.accounts.all(most=10_000)}
        states = {
            "open": word("待处理", "Open"),
            "answered": word("已答复", "Answered"),
            "done": word("已完成", "Done"),
        }
        parts = []
        for number, one in enumerate(self.suggestions(asking)):
            fields = (
                Field("state", word("状态", "State"), "select", value=one["state"], choices=states),
                Field(
                    "note",
                    word("处理说明", "What was done"),
                    value=one["note"],
                    needed=False,
                    given={"maxlength": "400"},
                ),
            )
            who: str = one["by"]
            by = f" · {escape(names.get(who, who))}" if who else ""
            sent = form(
                asking,
                f"follow-{number}",
                f"/office/suggestions/{one['id']}",
                fields,
                word("保存", "Save"),
                style="inline",
            )
            about = " · ".join(escape(one[part][lang]) for part in ("title", "module"))
            parts.append(
                f'<li><p class="quiet">{about}</p><p class="said">{escape(one["text"])}</p>'
                f'<p class="quiet">{states[one["state"]]}{by}</p>{sent}</li>'
            )
        none = f"<p>{word('还没有意见。', 'Nobody has suggested anything yet.')}</p>"
        title = word("意见与建议", "Suggestions")
        inside = f'<ul class="programme">{"".join(parts)}</ul>' if parts else none
        return office_page(asking, title, inside, path="suggestions")

    def tokens_page(self, asking: Asking) -> Shown:
        word = asking.word
        lines = [
            (
                escape(one.label),
                told_time(one.made, asking.lang),
                f"{one.expires}" if one.expires else word("长期", "for ever"),
                f"{one.used}" if one.used else word("从未", "never"),
                button(
                    asking,
                    "revoke",
                    f"/office/tokens/{one.id}/revoke",
                    word("撤销", "Revoke"),
                    about=one.label,
                    hidden={},
                ),
            )
            for one in self._house.survey_tokens().all()
        ]
        heads = (
            word("名称", "Label"),
            word("建立", "Made"),
            word("有效至", "Good until"),
            word("上次使用", "Last used"),
            f'<span class="unseen">{word("操作", "Acts")}</span>',
        )
        title = word("令牌", "Tokens")
        label = Field("label", word("名称", "Label"), given={"maxlength": str(LONGEST_LABEL)})
        told = word("程序用令牌经 /api/v1 读取答卷。", "By a token programs read answers at /api/v1.")
        new = form(asking, "token", "/office/tokens", (label,), word("新建令牌", "Make a token"))
        listed = rows(title, heads, lines) if lines else f"<p>{word('还没有令牌。', 'There is none.')}</p>"
        return office_page(asking, title, f'{listed}<div class="desk">{new}</div>', path="tokens", lead=told)

    def token_page(self, asking: Asking, came: dict[str, Any]) -> Shown:
        told = asking.word("只显示这一次，请妥善保存。", "It is shown this once: keep it well.")
        inside = f'<p role="status">{told}</p><p><code>{escape(came["token"])}</code></p>'
        return office_page(asking, asking.word("新令牌", "A new token"), inside, path="tokens")
