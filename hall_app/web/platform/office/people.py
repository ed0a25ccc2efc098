"""People and roles, and the journal of what was done: the administrator's."""

from __future__ import annotations

from dataclasses import asdict
from html import escape
from typing import Any

from hall_app.house.people import ACTS, OWN_ACTS, ROLES, PeopleError, Person, Role
from hall_app.web.platform.counter import Asking, Counter, Field, Shown, button, form, told_time
from hall_app.web.platform.office.deeds import Deed, Reading, number_in
from hall_app.web.platform.office.table import office_page, rows

__all__ = ["people_deeds", "people_readings"]

ENTRIES = 100  # of the journal on a page
LISTED = 200  # people on a page: others are found by their address or name


def people_readings(counter: Counter) -> tuple[Reading, ...]:
    rooms = _Rooms(counter)
    return (
        Reading("people", "people", rooms.everybody, rooms.everybody_page),
        Reading("people/{key}", "people", rooms.one, rooms.one_page),
        Reading("audit", "audit", rooms.audit, rooms.audit_page),
    )


def people_deeds(counter: Counter) -> tuple[Deed, ...]:
    rooms = _Rooms(counter)
    one = "people/{key}"
    account = {"address": "its e-mail address", "name": "how its owner is called, or nothing"}
    typed = {"address": "of the account once more, to confirm"}
    roles = {"roles": f"all that it is to have: {', '.join(Role)}; none for a visitor"}
    return (
        Deed("people", "people", rooms.make, "people/{id}", rooms.everybody_page, fields=account),
        Deed(f"{one}/roles", "roles", rooms.set_roles, one, rooms.one_page, fields=roles),
        Deed(f"{one}/code", "people", rooms.code, one, rooms.one_page, rooms.code_page),
        Deed(f"{one}/close", "people", rooms.close, one, rooms.one_page),
        Deed(f"{one}/open", "people", rooms.reopen, one, rooms.one_page),
        Deed(f"{one}/delete", "people", rooms.remove, "people", rooms.one_page, fields=typed),
        Deed(f"{one}/sign-out", "people", rooms.end_sessions, one, rooms.one_page),
        Deed(f"{one}/second-factor", "people", rooms.drop_factor, one, rooms.one_page),
    )


class _Rooms:
    def __init__(self, counter: Counter) -> None:
        self._people = counter.people

    def everybody(self, asking: Asking) -> list[dict[str, Any]]:
        return [_told(one) for one in self._people.accounts.all(asking.query.get("q", ""), LISTED)]

    def one(self, asking: Asking) -> dict[str, Any]:
        person = self._people.accounts.of(asking.names["key"])
        return _told(person) | {"sessions": len(self._people.sessions.of(person.id))}

    def audit(self, asking: Asking) -> list[dict[str, Any]]:
        found = self._people.journal.entries(before=_before(asking), most=ENTRIES)
        return [asdict(one) | {"at": one.at.isoformat()} for one in found]

    def make(self, asking: Asking) -> dict[str, Any]:
        given = asking.form
        made = self._people.accounts.make(
            asking.person.id, given.get("address", ""), name=given.get("name", ""), language=asking.lang
        )
        return {"id": made.id}

    def set_roles(self, asking: Asking) -> dict[str, Any]:
        wanted = set(asking.form.get("roles", "").split())
        wanted |= {role.value for role in Role if asking.form.get(role.value)}  # ticked on the page
        if unknown := wanted - set(Role):
            raise PeopleError("role", roles=", ".join(Role), given=sorted(unknown))
        key, roles = asking.names["key"], frozenset(Role(name) for name in wanted)
        self._people.roles.set(asking.person.id, key, roles)
        return {"id": key, "roles": sorted(roles)}

    def code(self, asking: Asking) -> dict[str, Any]:
        person = self._people.accounts.of(asking.names["key"])
        return {"id": person.id, "code": self._people.accounts.code_for(asking.person.id, person.id)}

    def close(self, asking: Asking) -> dict[str, Any]:
        self._people.accounts.close(asking.person.id, asking.names["key"], closed=True)
        return {"id": asking.names["key"], "closed": True}

    def reopen(self, asking: Asking) -> dict[str, Any]:
        self._people.accounts.close(asking.person.id, asking.names["key"], closed=False)
        return {"id": asking.names["key"], "closed": False}

    def remove(self, asking: Asking) -> dict[str, Any]:
        person = self._people.accounts.of(asking.names["key"])
        if asking.form.get("address", "").strip().casefold() != person.address:
            raise PeopleError("delete-confirm")
        self._people.accounts.remove(asking.person.id, person.id)
        return {"id": person.id, "deleted": True}

    def end_sessions(self, asking: Asking) -> dict[str, Any]:
        key = self._people.accounts.of(asking.names["key"]).id  # of nobody none is ended
        return {"id": key, "ended": self._people.sessions.end_all(asking.person.id, "people", key)}

    def drop_factor(self, asking: Asking) -> dict[str, Any]:
        self._people.accounts.drop_second_factor(asking.person.id, asking.names["key"])
        return {"id": asking.names["key"], "second_factor": False}

    def everybody_page(self, asking: Asking) -> Shown:
        word, wanted = asking.word, asking.query.get("q", "")
        found = self._people.accounts.all(wanted, LISTED)
        lines = [
            (
                f'<a href="{asking.address(f"/office/people/{one.id}")}">{escape(one.address)}</a>',
                escape(one.name),
                _roles(asking, one) or word("参观者", "Visitor"),
                word("已关闭", "Closed") if one.closed else word("有", "on") if one.second_factor else "–",
            )
            for one in found
        ]
        heads = (
            word("邮箱", "Address"),
            word("称呼", "Name"),
            word("角色", "Roles"),
            word("两步验证", "Second factor"),
        )
        fields = (
            Field("address", word("电子邮箱", "E-mail address"), "email", given={"maxlength": "254"}),
            Field("name", word("称呼", "Name"), needed=False, given={"maxlength": "80"}),
        )
        new = form(asking, "person", "/office/people", fields, word("新建账户", "Make an account"))
        told = word(
            "新账户没有密码：在其页面给出一次性代码，本人在 /me/open 设置密码。",
            "A new account has no password: its page gives a one-time code, by which its owner sets one at /me/open.",
        )
        title = word("人员与角色", "People and roles")
        listed = self._search(asking, wanted) + rows(title, heads, lines)
        inside = f"""{listed}<h2 class="small">{word("新建", "New")}</h2>
<div class="desk"><p class="quiet">{told}</p>{new}</div>"""
        return office_page(asking, title, inside, path="people", query={"q": wanted} if wanted else None)

    def _search(self, asking: Asking, wanted: str) -> str:
        """The form by which people are found, and how many there are."""
        word, whole = asking.word, self._people.accounts.count()
        count = self._people.accounts.count(wanted) if wanted else whole
        told = word(f"共 {whole} 个账户", f"{whole} accounts in all")
        if wanted:
            told = word(f"共 {whole} 个账户，符合的有 {count} 个", f"{count} of {whole} accounts")
        if count > LISTED:
            told += word(
                f"，只列出前 {LISTED} 个，其余请查找", f": the first {LISTED} are listed, search for others"
            )
        return f"""<form class="find large" action="/office/people" id="form-search">
<input type="hidden" name="lang" value="{asking.lang}">
<label class="unseen" for="people-q">{word("邮箱或称呼", "Address or name")}</label>
<input type="search" id="people-q" name="q" value="{escape(wanted)}" maxlength="200" autocomplete="off">
<button>{word("查找", "Find")}</button></form><p class="quiet" role="status">{told}</p>"""

    def one_page(self, asking: Asking) -> Shown:
        word, person = asking.word, self._people.accounts.of(asking.names["key"])
        at = f"/office/people/{person.id}"
        ticks = tuple(
            Field(
                role.value,
                ROLES[role][asking.lang == "en"],
                "check",
                value="on" if role in person.roles else "",
            )
            for role in Role
        )
        shut = (
            ("open", word("重新开放账户", "Open the account again"))
            if person.closed
            else (
                "close",
                word("关闭账户", "Close the account"),
            )
        )
        deeds = [
            ("code", word("给出一次性代码", "Hand out a one-time code")),
            ("sign-out", word("结束全部登录", "End all sessions")),
            shut,
        ]
        deeds += (
            [("second-factor", word("取消两步验证", "Drop the second factor"))]
            if person.second_factor
            else []
        )
        buttons = "".join(button(asking, key, f"{at}/{key}", words, hidden={}) for key, words in deeds)
        sessions = len(self._people.sessions.of(person.id))
        facts = (
            (word("称呼", "Name"), escape(person.name or "–")),
            (word("建立", "Made"), told_time(person.made, asking.lang)),
            (word("登录中", "Signed in"), word(f"{sessions} 处", f"at {sessions} places")),
            (word("状态", "State"), word("已关闭", "closed") if person.closed else word("开放", "open")),
        )
        listed = "".join(f"<dt>{name}</dt><dd>{value}</dd>" for name, value in facts)
        why = _why(asking) if asking.form.get("of") not in ("roles", "delete") else ""
        inside = f"""{why}<dl class="how">{listed}</dl><h2 class="small">{word("角色", "Roles")}</h2>
<div class="desk">{form(asking, "roles", f"{at}/roles", ticks, word("保存角色", "Save the roles"))}</div>
<h2 class="small">{word("账户", "Account")}</h2><div class="deeds">{buttons}</div>{_deletion(asking, at)}"""
        return office_page(asking, person.address, inside, path=f"people/{person.id}")

    def code_page(self, asking: Asking, came: dict[str, Any]) -> Shown:
        word = asking.word
        told = word(
            "只显示这一次，三天内有效，只能用一次。请在 /me/open 输入，或打开此链接：",
            "It is shown this once, good once, for three days: to be typed in at /me/open, or by this link:",
        )
        link = f"{asking.site}/me/open?code={came['code']}"
        inside = f"""<div class="desk"><p role="status">{told}</p><p class="code"><code>{came["code"]}</code></p>
<p><code>{escape(link)}</code></p></div>"""
        title = word("一次性代码", "One-time code")
        return office_page(asking, title, inside, path=f"people/{came['id']}")

    def audit_page(self, asking: Asking) -> Shown:
        word = asking.word
        entries = self._people.journal.entries(before=_before(asking), most=ENTRIES)
        names = {one.id: one.address for one in self._people.accounts.all(most=10_000)}
        lines = [
            (
                told_time(one.at, asking.lang),
                escape(names.get(one.who, one.who or word("陌生人", "a stranger"))),
                _act(asking, one.act) + (f" · <b>{word('被拒', 'refused')}</b>" if one.refused else ""),
                escape(" ".join(names.get(part, part) for part in one.subject.split())),
            )
            for one in entries
        ]
        heads = (word("时间", "When"), word("谁", "Who"), word("做了什么", "What"), word("对象", "To what"))
        title = word("审计记录", "Audit")
        more = asking.address("/office/audit", before=str(entries[-1].id)) if len(entries) == ENTRIES else ""
        older = (
            f'<p class="doors"><a href="{escape(more)}">{word("更早的", "Earlier")}</a></p>' if more else ""
        )
        return office_page(asking, title, rows(title, heads, lines) + older, path="audit")


def _deletion(asking: Asking, at: str) -> str:
    word = asking.word
    field = Field(
        "address",
        word("照抄邮箱以确认", "Type the address to confirm"),
        hint=word(
            "账户及其收藏、参观记录与预约当即删除，无法恢复；审计记录只留编号。",
            "The account goes at once with favourites, visits and reservations, and cannot be brought back; the "
            "journal keeps a number.",
        ),
        given={"autocomplete": "off", "spellcheck": "false", "maxlength": "254"},
    )
    sent = form(
        asking, "delete", f"{at}/delete", (field,), word("永久删除", "Delete for good"), style="grave"
    )
    opened = " open" if asking.refusal and asking.form.get("of") == "delete" else ""
    summary = word("删除账户…", "Delete the account …")
    return f'<details{opened}><summary>{summary}</summary><div class="desk">{sent}</div></details>'


def _before(asking: Asking) -> int | None:
    number = number_in(asking.query.get("before", ""))
    return number if number > 0 else None


def _told(person: Person) -> dict[str, Any]:
    return {
        "id": person.id,
        "address": person.address,
        "name": person.name,
        "roles": sorted(person.roles),
        "verified": person.verified is not None,
        "closed": person.closed is not None,
        "second_factor": person.second_factor,
    }


def _roles(asking: Asking, person: Person) -> str:
    return asking.word("、", ", ").join(ROLES[role][asking.lang == "en"] for role in sorted(person.roles))


def _act(asking: Asking, act: str) -> str:
    if act in ACTS:
        return asking.word(ACTS[act].zh, ACTS[act].en)
    return asking.word(*OWN_ACTS[act]) if act in OWN_ACTS else escape(act)


def _why(asking: Asking) -> str:
    return f'<p class="refused" role="alert">{escape(asking.refusal)}</p>' if asking.refusal else ""
