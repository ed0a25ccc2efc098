"""A copy of all that is kept of one person, as a ZIP that opens anywhere. Hashes and secrets are left out."""

from __future__ import annotations

import io
import json
import zipfile
from datetime import datetime
from typing import TYPE_CHECKING

from hall_app.house.people.records.journal import Entry
from hall_app.house.people.records.person import Person
from hall_app.house.people.records.sessions import Session

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["own_copy"]

_ABOUT = """\
本压缩包包含本馆保存的关于您的全部资料（JSON，UTF-8）。密码与登录令牌只以散列值保存，未包含在内。
account.json 账户；sessions.json 登录会话；journal.json 操作记录。

This archive holds all that the house keeps about you (JSON, UTF-8). Passwords and session tokens are kept as hashes
only and left out. account.json: the account; sessions.json: where you are signed in; journal.json: what was done.
"""


def own_copy(person: Person, sessions: Sequence[Session], entries: Sequence[Entry]) -> bytes:
    """The archive."""
    files = {
        "account.json": {
            "id": person.id,
            "address": person.address,
            "name": person.name,
            "language": person.language,
            "made": _time(person.made),
            "verified": _time(person.verified),
            "second_factor": person.second_factor,
            "roles": sorted(person.roles),
        },
        "sessions.json": [
            {"office": one.office, "made": _time(one.made), "expires": _time(one.expires)} for one in sessions
        ],
        "journal.json": [
            {
                "at": _time(one.at),
                "by": one.who,
                "act": one.act,
                "subject": one.subject,
                "refused": one.refused,
            }
            for one in entries
        ],
    }
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("README.txt", _ABOUT)
        for name, value in files.items():
            archive.writestr(name, json.dumps(value, ensure_ascii=False, indent=1))
    return packed.getvalue()


def _time(at: datetime | None) -> str | None:
    return None if at is None else at.isoformat()
