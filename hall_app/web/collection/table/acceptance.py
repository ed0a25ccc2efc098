"""A table taken into the content folder: all of it or, where anything is wrong, nothing.

Every file is rewritten beside, checked as `hall check` does in a likeness of the folder, and only then put in place,
one atomic step each. Whoever looks at the folder meanwhile, a running hall too, sees whole files.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from hall_app.check import QUICK, new_problems
from hall_app.content.files import replace_file
from hall_app.content.loading import load
from hall_app.web.collection.table.difference import Change, changes
from hall_app.web.collection.table.sheet import read_sheet
from hall_app.web.collection.table.toml_text import EditError, edited

__all__ = ["Acceptance", "accept"]

_MARK = b"\xef\xbb\xbf"  # Notepad's, which stays where it is


@dataclass(frozen=True)
class Acceptance:
    """What came of it.

    changes: exhibit -> its changes; faults: what kept all of them out; written: whether they are in.
    """

    changes: Mapping[str, tuple[Change, ...]]
    faults: tuple[str, ...]
    written: bool


def accept(folder: Path, data: bytes, *, dry_run: bool = False) -> Acceptance:
    """Take the table `data` into the content folder; dry_run: only say what would change.

    Raises ContentError where there is no hall, OSError where a file cannot be read or written.
    """
    folder = folder.resolve()
    wanted, faults = changes(read_sheet(data), load(folder).exhibits)
    if faults:
        return Acceptance(wanted, tuple(str(fault) for fault in faults), False)
    before = {name: _file(folder, name).read_bytes() for name in wanted}
    after: dict[str, bytes] = {}
    wrong: list[str] = []
    for name, changed in wanted.items():
        try:
            after[name] = _rewritten(before[name], changed)
        except EditError as error:
            keys = "; ".join(str(change) for change in changed)
            wrong.append(f"exhibits/{name}/exhibit.toml: {error} – make these changes there by hand: {keys}")
    if not wrong and wanted:
        found = new_problems(
            folder, {f"exhibits/{name}/exhibit.toml": data for name, data in after.items()}, QUICK
        )
        wrong = [str(problem) for problem in found]
    if wrong or dry_run or not wanted:
        return Acceptance(wanted, tuple(wrong), False)
    for name, old in before.items():
        if _file(folder, name).read_bytes() != old:
            what = f"exhibits/{name}/exhibit.toml: it was changed meanwhile – look at it, and import the table again"
            return Acceptance(wanted, (what,), False)
    for name, new in after.items():
        replace_file(_file(folder, name), new)
    return Acceptance(wanted, (), True)


def _file(folder: Path, name: str) -> Path:
    return folder / "exhibits" / name / "exhibit.toml"


def _rewritten(data: bytes, changed: tuple[Change, ...]) -> bytes:
    mark = _MARK if data.startswith(_MARK) else b""
    return mark + edited(data.decode("utf-8-sig"), changed).encode()
