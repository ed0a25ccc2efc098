"""Backups from the office: made, listed, fetched, and a house made of one beside this one."""

from __future__ import annotations

import re
import shutil
import threading
from datetime import UTC, datetime
from html import escape
from pathlib import Path
from shlex import quote
from typing import Any

from hall_app.house.people import PeopleError
from hall_app.house.safekeeping import ArchiveError, Holdings, back_up, restore, tidy
from hall_app.web.platform.counter import Asking, Counter, Download, Field, Shown, button, form
from hall_app.web.platform.office.deeds import Deed, Reading
from hall_app.web.platform.office.table import office_page
from survey.errors import SurveyError

__all__ = ["backup_deeds", "backup_readings"]

_NAME = re.compile(r"hall-\d{8}-\d{6}(?:-\d+)?\.zip")
_HOUSE = re.compile(r"hall-\d{8}-\d{6}(?:-\d+){0,2}")
_ONE = "backups/{key}"


def backup_readings(counter: Counter) -> tuple[Reading, ...]:
    rooms = _Rooms(counter)
    return (
        Reading("backups", "backup", rooms.all, rooms.page),
        Reading(f"{_ONE}/file", "backup", rooms.facts, rooms.file),
        Reading("restored", "backup", rooms.houses, rooms.page),
    )


def backup_deeds(counter: Counter) -> tuple[Deed, ...]:
    rooms = _Rooms(counter)
    typed = {"name": "of the backup once more, to confirm"}
    house = {"name": "of the restored house once more, to confirm"}
    tidy(counter.house.data / "backups")
    return (
        Deed("backups", "backup", rooms.make, "backups", rooms.page),
        Deed(f"{_ONE}/remove", "backup", rooms.remove, "backups", rooms.page),
        Deed(
            f"{_ONE}/restore",
            "backup",
            rooms.restore,
            "backups",
            rooms.page,
            rooms.restored_page,
            fields=typed,
        ),
        Deed("restored/{key}/remove", "backup", rooms.remove_house, "backups", rooms.page, fields=house),
    )


_AT_WORK = threading.Lock()  # one backup or restoration at a time


class _Rooms:
    def __init__(self, counter: Counter) -> None:
        self._house, self._people = counter.house, counter.people

    @property
    def _folder(self) -> Path:
        return self._house.data / "backups"

    def all(self, asking: Asking) -> list[dict[str, Any]]:
        """The newest first."""
        if not self._folder.is_dir():
            return []
        found = sorted((p for p in self._folder.iterdir() if _NAME.fullmatch(p.name)), reverse=True)
        return [_told(path) for path in found]

    def houses(self, asking: Asking) -> list[dict[str, Any]]:
        """Whole houses that were made of backups, the newest first."""
        folder = self._house.data / "restored"
        if not folder.is_dir():
            return []
        return [{"name": path.name} for path in sorted(folder.iterdir(), reverse=True) if _is_house(path)]

    def remove_house(self, asking: Asking) -> dict[str, Any]:
        home = self._house.data / "restored" / asking.names["key"]
        if not _is_house(home):
            raise PeopleError("no-backup")
        if asking.form.get("name", "").strip() != home.name:
            raise PeopleError("remove-confirm")
        with _AT_WORK:
            try:
                shutil.rmtree(home)
            except OSError as error:
                raise PeopleError("backup-failed", why=error.strerror or str(error)) from None
            self._people.note(asking.person.id, "backup", f"remove restored {home.name}")
        return {"name": home.name}

    def facts(self, asking: Asking) -> dict[str, Any]:
        return _told(self._path(asking))

    def _path(self, asking: Asking) -> Path:
        name = asking.names["key"]
        path = self._folder / name
        if not _NAME.fullmatch(name) or not path.is_file():
            raise PeopleError("no-backup")
        return path

    def _holdings(self) -> Holdings:
        if self._house.holdings is None:
            raise PeopleError("backup-failed", why="hall serve did not say where the house's databases are")
        return self._house.holdings

    def make(self, asking: Asking) -> dict[str, Any]:
        holdings = self._holdings()
        with _AT_WORK:
            self._folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            tidy(self._folder)
            stem = f"hall-{datetime.now(UTC):%Y%m%d-%H%M%S}"
            name, number = f"{stem}.zip", 1
            while (self._folder / name).exists():
                number += 1
                name = f"{stem}-{number}.zip"
            try:
                made = back_up(self._folder / name, holdings)
            except (ArchiveError, SurveyError, OSError) as error:
                raise PeopleError("backup-failed", why=_plain(error, self._folder)) from None
            self._people.note(asking.person.id, "backup", f"make {name}")
        return _told(self._folder / name) | {"people": made.people, "answers": made.answers}

    def file(self, asking: Asking) -> Download:
        path = self._path(asking)
        self._people.note(asking.person.id, "backup", f"fetch {path.name}")
        return Download(path, path.name, "application/zip")

    def remove(self, asking: Asking) -> dict[str, Any]:
        path = self._path(asking)
        with self._people.noting(asking.person.id, "backup", f"remove {path.name}"):
            path.unlink(missing_ok=True)
        return {"name": path.name}

    def restore(self, asking: Asking) -> dict[str, Any]:
        """A whole house of the backup, beside this one: what is open here is never written over."""
        path = self._path(asking)
        if asking.form.get("name", "").strip() != path.name:
            raise PeopleError("restore-confirm")
        with _AT_WORK:
            home = self._house.data / "restored" / path.stem
            number = 1
            while home.exists():
                number += 1
                home = home.with_name(f"{path.stem}-{number}")
            home.mkdir(mode=0o700, parents=True)
            try:
                data = home / "data"
                made = restore(path, Holdings(home / "content", data, data, data))
            except (ArchiveError, SurveyError, OSError) as error:
                shutil.rmtree(home, ignore_errors=True)
                raise PeopleError("backup-failed", why=_plain(error, self._folder)) from None
            self._people.note(asking.person.id, "backup", f"restore {path.name}")
        return {
            "name": path.name,
            "content": str(home / "content"),
            "data": str(home / "data"),
            "people": made.people,
            "answers": made.answers,
        }

    def page(self, asking: Asking) -> Shown:
        word = asking.word
        title = word("备份", "Backup")
        told = word(
            "一个文件含展厅内容、草稿与历史、账户与答卷，逐部分校验。其中有邮箱与密码散列，请像数据文件夹一样保管。",
            "One checked file with content, drafts and history, accounts and answers. It holds addresses and "
            "hashes of passwords: keep it as you keep the data folder.",
        )
        refused = asking.form.get("of", "") if asking.refusal else ""
        why = (
            f'<p class="refused" role="alert">{escape(asking.refusal)}</p>'
            if refused in ("make", "remove")
            else ""
        )
        make = form(asking, "make", "/office/backups", (), word("现在备份", "Make a backup"))
        if refused == "make":
            why = ""
        lines = "".join(self._line(asking, number, one) for number, one in enumerate(self.all(asking)))
        none = f"<p>{word('还没有备份。', 'There is none yet.')}</p>"
        listed = f'<ul class="programme kept">{lines}</ul>' if lines else none
        inside = f"{why}{make}{listed}{self._restored(asking)}"
        return office_page(asking, title, inside, path="backups", lead=told)

    def _restored(self, asking: Asking) -> str:
        """Houses that were made of backups: each has a whole content folder, accounts and answers."""
        word, found = asking.word, self.houses(asking)
        if not found:
            return ""
        told = word(
            "各是一座完整的馆，含账户与答卷。确认没有以 hall serve 打开之后，可以删除。",
            "Each is a whole house with accounts and answers. Remove it once no hall serve has it open.",
        )
        lines = ""
        for number, one in enumerate(found):
            name = escape(one["name"])
            field = Field(
                "name",
                word("照抄名称以确认", "Type its name to confirm"),
                given={"autocomplete": "off", "spellcheck": "false", "maxlength": "60"},
            )
            key = f"remove-house-{number}"
            sent = form(
                asking,
                key,
                f"/office/restored/{name}/remove",
                (field,),
                word("删除", "Remove"),
                style="grave",
            )
            opened = " open" if asking.refusal and asking.form.get("of") == key else ""
            lines += f"""<li><h2><code>{name}</code></h2><details{opened}><summary>{word("删除…", "Remove …")}</summary>
<div class="desk">{sent}</div></details></li>"""
        title = word("恢复出的馆", "Restored houses")
        return f"""<h2 class="small">{title}</h2><p class="quiet">{told}</p><ul class="programme kept">{lines}</ul>"""

    def _line(self, asking: Asking, number: int, one: dict[str, Any]) -> str:
        word, name = asking.word, one["name"]
        at = f"/office/backups/{name}"
        field = Field(
            "name",
            word("照抄备份名称以确认", "Type the backup's name to confirm"),
            hint=word(
                "在旁边恢复成一座完整的馆，当前展厅不受影响。",
                "A whole house is made of it beside this one; the open hall stays as it is.",
            ),
            given={"autocomplete": "off", "spellcheck": "false", "maxlength": "60"},
        )
        again = form(asking, f"restore-{number}", f"{at}/restore", (field,), word("恢复", "Restore"))
        goes = button(asking, "remove", f"{at}/remove", word("删除", "Remove"), about=name, hidden={})
        fetch = f'<a class="way" href="{asking.address(f"{at}/file")}">{word("下载", "Download")}</a>'
        opened = " open" if asking.refusal and asking.form.get("of") == f"restore-{number}" else ""
        return f"""<li><h2><code>{escape(name)}</code></h2>
<p class="quiet">{one["size"] / 1e6:.1f} MB</p><div class="deeds">{fetch}{goes}</div>
<details{opened}><summary>{word("恢复…", "Restore …")}</summary><div class="desk">{again}</div></details></li>"""

    def restored_page(self, asking: Asking, came: dict[str, Any]) -> Shown:
        word = asking.word
        command = f"hall serve --content {quote(str(came['content']))} --data {quote(str(came['data']))}"
        told = word(
            f"已校验并恢复：{came['people']} 个账户，{came['answers']} 份答卷。停止当前展厅后，用此命令打开：",
            f"Checked and restored: {came['people']} accounts, {came['answers']} answers. End this hall; open it by:",
        )
        after = word(
            "恢复后无人登录，一次性代码与令牌失效；备份之后删除或撤回的内容会重新出现。",
            "Nobody is signed in there, one-time codes and tokens are void; what was deleted since is there again.",
        )
        back = f'<a href="{asking.address("/office/backups")}">{word("返回", "Back")}</a>'
        inside = f"""<p role="status">{told}</p><p><code>{escape(command)}</code></p><p class="quiet">{after}</p>
<p class="doors">{back}</p>"""
        return office_page(asking, word("已恢复", "Restored"), inside, path="backups")


def _is_house(path: Path) -> bool:
    return bool(_HOUSE.fullmatch(path.name)) and path.is_dir() and not path.is_symlink()


def _told(path: Path) -> dict[str, Any]:
    stat = path.stat()
    made = datetime.fromtimestamp(stat.st_mtime, UTC).isoformat(timespec="seconds")
    return {"name": path.name, "size": stat.st_size, "made": made}


def _plain(error: Exception, folder: Path) -> str:
    """Without the place of the folder, which is nobody's but the machine's."""
    return str(error).replace(f"{folder}/", "")
