"""What was done, said once on the page that follows."""

from __future__ import annotations

from html import escape

from hall_app.web.platform.counter import Asking

__all__ = ["notice"]

_DONE = {  # key: zh, en
    "registered": ("账户已建好，您已登录。", "The account is made, and you are signed in."),
    "opened": ("新密码已生效。", "The new password holds."),
    "profile": ("资料已保存。", "The profile is saved."),
    "password": (
        "密码已更改，其他设备上的登录已结束。",
        "The password is changed; you are signed out everywhere else.",
    ),
    "factor-off": ("两步验证已关闭。", "The second factor is off."),
    "session": ("该登录已结束。", "That session is ended."),
    "sessions": ("其他设备上的登录都已结束。", "You are signed out everywhere else."),
    "kept": ("已加入收藏。", "It is among your favourites."),
    "dropped": ("已从收藏中移除。", "It is no favourite any more."),
    "visits-on": ("从现在起保存参观记录。", "From now on your visits are kept."),
    "visits-off": (
        "参观记录已全部删除，今后不再保存。",
        "All kept visits are deleted, and no more will be kept.",
    ),
    "code-kept": (
        "账户已保管这个撤回码，从此与那份回答相连。",
        "The account keeps the code, and leads to these answers from now on.",
    ),
    "code-forgotten": (
        "账户已忘记这个撤回码；回答仍在，不再与账户相连。",
        "The account has forgotten the code; the answers stay, and nothing leads to them from here.",
    ),
    "withdrawn": ("已撤回，评分与建议已删除。", "Withdrawn. The ratings and suggestions are deleted."),
    "withdrawn-soon": (
        "已撤回，评分与建议已删除；数据库文件中的残留数据将很快清除。",
        "Withdrawn. The ratings and suggestions are deleted; their last traces in the database's files will be gone "
        "shortly.",
    ),
    "deleted": (
        "账户与全部资料已删除。",
        "The account is deleted, with all that was kept of you.",
    ),
    "signed-out": ("您已退出。", "You are signed out."),
}


def notice(asking: Asking) -> str:
    """For a page that was led to by what was done; nothing for any other."""
    said = _DONE.get(asking.query.get("done", ""))
    return f'<p class="done" role="status">{escape(asking.word(*said))}</p>' if said else ""
