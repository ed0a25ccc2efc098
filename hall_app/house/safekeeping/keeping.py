"""What a house holds, put into one file and taken out of it again."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from hall_app.house.people import People, existing_people
from hall_app.house.safekeeping.archive import (
    ANSWERS,
    CONTENT,
    DESK,
    PART,
    PEOPLE,
    ArchiveError,
    Manifest,
    extract,
    write_archive,
)
from hall_app.house.safekeeping.work import at_work, is_left_over
from survey import Store
from survey.store import existing_store

__all__ = ["Holdings", "back_up", "restore", "tidy"]

_WORK = ".backup-"


@dataclass(frozen=True)
class Holdings:
    """content, data: folders; accounts, answers: the data folder, or the URL of a database."""

    content: Path
    data: Path
    accounts: Path | str
    answers: Path | str


def back_up(file: Path, house: Holdings) -> Manifest:
    """Write all into `file`, which must not exist, while the hall is open or not. Each database is one moment's.

    Raises ArchiveError, SurveyError.
    """
    _see_that_it_is_new(file)
    with (
        tempfile.TemporaryDirectory(dir=file.parent, prefix=_WORK) as work,
        at_work(Path(work)),
    ):  # its owner's alone
        people_copy, answers_copy = Path(work) / PEOPLE, Path(work) / ANSWERS
        with closing(existing_people(house.accounts)) as people:
            accounts = people.copy_to(people_copy)
        with closing(existing_store(house.answers)) as store:
            answers = store.copy_to(answers_copy)
        # Drafts before what they need, which stays on the shelf as long as they do.
        members = [
            (PEOPLE, people_copy),
            (ANSWERS, answers_copy),
            *_desk(house.data),
            *_content(house.content),
        ]
        return write_archive(file, members, people=accounts, answers=answers)


def tidy(folder: Path) -> None:
    """Remove what backups left in that folder that were killed: copies of the databases, files begun. None at work."""
    for path in (*folder.glob(f"{_WORK}*"), *folder.glob(f"*.zip{PART}")):
        if is_left_over(path):
            shutil.rmtree(path) if path.is_dir() else path.unlink(missing_ok=True)


def restore(file: Path, house: Holdings) -> Manifest:
    """Make a house of the file. Nothing is overwritten: the content folder is absent or empty, the databases empty, and
    the data folder without drafts and history.

    The file is checked and unpacked, and all these places are, before anything is put anywhere.
    Raises ArchiveError, StoreError.
    """
    if house.content.exists() and (not house.content.is_dir() or any(house.content.iterdir())):
        raise ArchiveError(
            f"{house.content}: is there already – give --content a folder that is new or empty"
        )
    for part in DESK:
        if (house.data / part).is_dir() and any((house.data / part).iterdir()):
            raise ArchiveError(
                f"{house.data / part}: an office has worked there already – give --data another folder"
            )
    house.content.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=house.content.parent, prefix=".restore-") as work:
        folder = Path(work)
        manifest = extract(file, folder)
        with closing(People(house.accounts)) as people, closing(Store(house.answers)) as store:
            people.see_that_it_takes(folder / PEOPLE)
            store.see_that_it_takes(folder / ANSWERS)
            people.take_copy(folder / PEOPLE)
            store.take_copy(folder / ANSWERS)
        for part in DESK:
            if (folder / part).is_dir():
                shutil.copytree(folder / part, house.data / part, dirs_exist_ok=True)
        if house.content.exists():
            house.content.rmdir()
        os.replace(folder / CONTENT, house.content)
    return manifest


def _see_that_it_is_new(file: Path) -> None:
    if file.exists():
        raise ArchiveError(f"{file}: exists already – give another name, a backup never overwrites one")
    if not file.parent.is_dir():
        raise ArchiveError(f"{file}: no folder {file.parent} – make it, or give another place")


def _desk(data: Path) -> Iterator[tuple[str, Path]]:
    """Name and file of the office's drafts, and of what they and the history need."""
    for part in DESK:
        if (data / part).is_dir():
            for path in sorted((data / part).iterdir()):
                if path.is_file() and not path.name.startswith("."):
                    yield f"{part}/{path.name}", path


def _content(folder: Path) -> Iterator[tuple[str, Path]]:
    """Name and file of all that lies in the content folder. Raises ArchiveError for a link to a folder, never left out
    in silence; a link to a file counts as the file."""
    for where, folders, files in os.walk(folder):
        here = Path(where)
        folders.sort()
        for name in folders:
            if (here / name).is_symlink():
                raise ArchiveError(f"{here / name}: a link to a folder – put the folder itself in its place")
        for name in sorted(files):
            if not (here / name).is_file():
                raise ArchiveError(
                    f"{here / name}: no plain file, or a link to none – take it out of the content"
                )
            yield f"{CONTENT}/{(here / name).relative_to(folder).as_posix()}", here / name
