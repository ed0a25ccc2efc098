"""A long list on pages of a length: which one is asked for, and the ways to those before and after it."""

from __future__ import annotations

from html import escape

from hall_app.web.platform.counter.asking import Asking

__all__ = ["leaf_asked", "leaf_ways"]


def leaf_asked(asking: Asking) -> int:
    """The page of a list, from 1; the first for none and for what is no number."""
    told = asking.query.get("page", "")
    return max(1, int(told)) if told.isascii() and told.isdigit() and len(told) < 7 else 1


def leaf_ways(asking: Asking, path: str, page: int, *, more: bool, **query: str) -> str:
    """Links to the pages before and after this one, "" where it is the only one. query: of the list's address."""
    ways = []
    if page > 1:
        before = asking.address(path, **query, page=str(page - 1) if page > 2 else "")
        ways.append(f'<a rel="prev" href="{escape(before)}">{asking.word("上一页", "The page before")}</a>')
    if more:
        after = asking.address(path, **query, page=str(page + 1))
        ways.append(f'<a rel="next" href="{escape(after)}">{asking.word("下一页", "The next page")}</a>')
    name = asking.word("各页", "Pages")
    return f'<nav class="doors" aria-label="{name}">{"".join(ways)}</nav>' if ways else ""
