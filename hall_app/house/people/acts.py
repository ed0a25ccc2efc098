"""Who may do what: one table. A route names its act and is open to the roles beside it, to nobody else."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum

__all__ = ["ACTS", "OWN_ACTS", "ROLES", "Act", "Role", "may"]


class Role(StrEnum):
    """What somebody is to the house. A person may have several; a visitor has none."""

    EDITOR = "editor"
    CURATOR = "curator"
    RESEARCHER = "researcher"
    ADMINISTRATOR = "administrator"


@dataclass(frozen=True)
class Act:
    """roles: who may; zh, en: what it is called."""

    roles: frozenset[Role]
    zh: str
    en: str


ROLES: Mapping[Role, tuple[str, str]] = {  # zh, en
    Role.EDITOR: ("编辑", "Editor"),
    Role.CURATOR: ("策展人", "Curator"),
    Role.RESEARCHER: ("研究者", "Researcher"),
    Role.ADMINISTRATOR: ("管理员", "Administrator"),
}

_ALL_BUT_RESEARCH = frozenset({Role.EDITOR, Role.CURATOR, Role.ADMINISTRATOR})
_COLLECTION = frozenset({Role.CURATOR, Role.ADMINISTRATOR})
_RESEARCH = frozenset({Role.RESEARCHER, Role.ADMINISTRATOR})
_HOUSE = frozenset({Role.ADMINISTRATOR})

ACTS: Mapping[str, Act] = {
    "draft": Act(_ALL_BUT_RESEARCH, "起草内容", "Draft content"),
    "preview": Act(_ALL_BUT_RESEARCH, "预览内容", "Preview content"),
    "publish": Act(_COLLECTION, "发布", "Publish"),
    "place": Act(_COLLECTION, "布置展位", "Place exhibits"),
    "bake": Act(_COLLECTION, "烘焙模型", "Bake models"),
    "undo": Act(_COLLECTION, "撤销", "Undo"),
    "events": Act(_COLLECTION, "活动", "Events"),
    "reservations": Act(_COLLECTION, "预约", "Reservations"),
    "check-in": Act(_COLLECTION, "签到", "Check-in"),
    "questionnaires": Act(_RESEARCH, "问卷", "Questionnaires"),
    "answers": Act(_RESEARCH, "答卷", "Answers"),
    "analysis": Act(_RESEARCH, "分析", "Analysis"),
    "export": Act(_RESEARCH, "导出", "Export"),
    "people": Act(_HOUSE, "人员", "People"),
    "roles": Act(_HOUSE, "角色", "Roles"),
    "tokens": Act(_HOUSE, "令牌", "Tokens"),
    "audit": Act(_HOUSE, "审计记录", "Audit"),
    "backup": Act(_HOUSE, "备份", "Backup"),
}

# What everybody does with an account of his own, and the journal tells as well.
OWN_ACTS: Mapping[str, tuple[str, str]] = {  # zh, en
    "sign up": ("注册", "Sign up"),
    "sign in": ("登录", "Sign in"),
    "sign out": ("退出", "Sign out"),
    "profile": ("更改资料", "Change the profile"),
    "password": ("更改密码", "Change the password"),
    "second factor": ("两步验证", "Second factor"),
    "use code": ("使用一次性代码", "Use a one-time code"),
    "favourites": ("收藏", "Favourites"),
    "visits": ("参观记录", "Visits"),
    "answer codes": ("答卷撤回码", "Withdrawal codes of answers"),
    "book": ("预约", "Book"),
    "cancel booking": ("取消预约", "Cancel a booking"),
    "take copy": ("导出本人资料", "Take a copy of one's data"),
    "delete account": ("删除账户", "Delete the account"),
}


def may(roles: Iterable[Role], act: str) -> bool:
    """Whether somebody of these roles may do that. Raises KeyError for an act that is not in the table."""
    return not ACTS[act].roles.isdisjoint(roles)
