"""A copy of all that is kept of one person, as a ZIP that opens anywhere. Hashes and secrets are left out."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from datetime import date
from typing import Any

from hall_app.house.people.records.person import Person

__all__ = ["own_copy"]

_ABOUT = """\
本压缩包包含本馆保存的关于您的全部资料（JSON，UTF-8）。密码与登录令牌只以散列值保存，未包含在内；验证器密钥亦未包含。
{zh}。

This archive holds all that the house keeps about you (JSON, UTF-8). Passwords and session tokens are kept as hashes
only and left out, and so is the secret of your authenticator. {en}.
"""
_TOLD = {  # file: zh, en
    "account": ("账户", "the account"),
    "sessions": ("登录会话", "where you are signed in"),
    "favourites": ("收藏", "favourites"),
    "visits": ("参观记录", "visits that you asked to keep"),
    "bookings": ("预约", "reservations"),
    "occasions": ("所预约的场次", "what they are for, and when"),
    "answers": ("答卷撤回码", "withdrawal codes of answers that you asked to keep"),
    "followups": ("您处理的意见", "suggestions that you followed up, as staff"),
    "revisions": ("您发布或撤销的改动", "changes that you published or took back, as staff"),
    "drafts": ("您最后改动的草稿", "drafts that you changed last, as staff"),
    "journal": ("操作记录", "what was done"),
}


def own_copy(person: Person, kept: Mapping[str, Sequence[Any]]) -> bytes:
    """The archive. kept: for each file of records, dataclasses or mappings whose fields are told as they are."""
    files: dict[str, Any] = {"account": asdict(person)}
    files |= {
        name: [dict(row) if isinstance(row, Mapping) else asdict(row) for row in rows]
        for name, rows in kept.items()
    }
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("README.txt", _about(files))
        for name, value in files.items():
            archive.writestr(f"{name}.json", json.dumps(value, ensure_ascii=False, indent=1, default=_plain))
    return packed.getvalue()


def _about(files: Mapping[str, object]) -> str:
    zh = "；".join(f"{name}.json {_TOLD[name][0]}" for name in files)
    en = "; ".join(f"{name}.json: {_TOLD[name][1]}" for name in files)
    return _ABOUT.format(zh=zh, en=en)


def _plain(value: object) -> object:
    """Times and sets as JSON has them. Raises TypeError for anything else: nothing slips in unread."""
    if isinstance(value, date):  # datetime is one
        return value.isoformat()
    if isinstance(value, frozenset):
        return sorted(value)
    raise TypeError(f"{value!r} has no place in a copy")
