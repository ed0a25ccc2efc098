"""Rows as HTML, and the head of every page of the office."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from hall_app.web.platform.counter import Asking, Page, Shown, button, clock_line

__all__ = ["office_page", "rows"]

# path, act of the table of roles that it takes, name in both languages
PARTS: tuple[tuple[str, str, str, str], ...] = (
    ("collection", "draft", "藏品", "Collection"),
    ("events", "events", "活动与参观", "Activities and visits"),
    ("questionnaires", "questionnaires", "问卷", "Questionnaires"),
    ("suggestions", "answers", "意见与建议", "Suggestions"),
    ("tokens", "tokens", "令牌", "Tokens"),
    ("people", "people", "人员与角色", "People and roles"),
    ("audit", "audit", "审计记录", "Audit"),
    ("backups", "backup", "备份", "Backup"),
)
_DONE = ("已保存。", "It is saved.")


def office_page(
    asking: Asking,
    title: str,
    inside: str,
    *,
    path: str,
    lead: str = "",
    query: dict[str, str] | None = None,
    script: str = "",
) -> Shown:
    """title: not escaped yet; inside: HTML; path: below /office, of the other language's page; script: of /static."""
    word = asking.word
    ways = [("", word("办公室", "Office"))]
    ways += [(f"/{part}", word(zh, en)) for part, act, zh, en in PARTS if asking.person.may(act)]
    here = f"/{path.partition('/')[0]}" if path else ""
    listed = "".join(
        f'<a href="{asking.address(f"/office{way}")}"{" aria-current=page" if way == here else ""}>{name}</a>'
        for way, name in ways
    )
    out = button(asking, "sign-out", "/office/sign-out", word("退出", "Sign out"), hidden={})
    told = f'<p class="done" role="status">{word(*_DONE)}</p>' if asking.query.get("done") else ""
    top = f'<p class="lead">{lead}</p>' if lead else ""
    clock = clock_line(top + inside, asking.lang)
    main = f"""<header class="who"><div><h1>{escape(title)}</h1>{top}</div>{out}</header>
<nav class="rooms" aria-label="{word("办公室", "Office")}">{listed}</nav>{told}{clock}{inside}"""
    return Shown(Page(title, main, "", query or {}, script), path=f"/office{'/' if path else ''}{path}")


def rows(caption: str, heads: Iterable[str], lines: Iterable[Iterable[str]]) -> str:
    """A table; cells are HTML, the first of a line names it. caption: for who hears the page.

    It is no landmark: the sheet of a day holds several, which may be called alike.
    """
    head = "".join(f'<th scope="col">{name}</th>' for name in heads)
    body = "".join(
        "<tr>"
        + "".join(
            f'<th scope="row">{cell}</th>' if at == 0 else f"<td>{cell}</td>" for at, cell in enumerate(line)
        )
        + "</tr>"
        for line in lines
    )
    return f"""<div class="wide" tabindex="0" role="group" aria-label="{escape(caption)}"><table class="numbers">
<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"""
