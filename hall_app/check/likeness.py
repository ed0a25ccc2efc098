"""A likeness of the content folder with some files changed: what is to be put in place is looked at there first."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from hall_app.check.folder import check
from hall_app.content.files import remove_file, replace_file
from hall_app.content.folder import Content
from hall_app.content.problems import Problem

__all__ = ["Changed", "likeness_of", "new_problems"]

# Name in the content folder -> its new bytes, a file that holds them, or None where it goes.
Changed = Mapping[str, bytes | Path | None]


@contextmanager
def likeness_of(folder: Path, files: Changed) -> Iterator[Path]:
    """The folder as it would be, of hard links, for as long as the block runs. Raises OSError."""
    with tempfile.TemporaryDirectory(prefix="hall-likeness-") as place:
        whole = Path(place) / "content"
        shutil.copytree(folder, whole, symlinks=True, copy_function=_linked)
        for name, data in files.items():
            path = whole / name
            if data is None:
                remove_file(path, whole)
            elif isinstance(data, Path):
                path.parent.mkdir(parents=True, exist_ok=True)
                path.unlink(missing_ok=True)
                _linked(str(data), str(path))
            else:
                replace_file(path, data)
        yield whole


def new_problems(
    folder: Path, files: Changed, looks: Iterable[Callable[[Content], list[Problem]]] | None = None
) -> list[Problem]:
    """What `hall check` would say with these files that it does not say without them. looks: as `check` takes it."""
    looks = None if looks is None else tuple(looks)
    known = set(check(folder, looks))
    with likeness_of(folder, files) as whole:
        found = check(whole, looks)
    return [problem for problem in found if problem not in known]


def _linked(source: str, target: str) -> str:
    """A second name for the file, or a copy where the two places are on different disks."""
    try:
        os.link(source, target, follow_symlinks=False)
    except OSError:
        shutil.copy2(source, target, follow_symlinks=False)
    return target
