"""What the store writes is for its owner alone: files 0600, a folder of its own 0700, whatever the umask says."""

from __future__ import annotations

import logging
import os
import stat
from pathlib import Path

__all__ = ["make_file", "make_folder", "make_private", "take_rights", "tighten"]

FILE, FOLDER = 0o600, 0o700
BESIDE = ("", "-wal", "-shm")  # SQLite makes the last two with the rights of the first

_LOG = logging.getLogger(__name__)


def make_private(folder: Path) -> bool:
    """Make a folder for its owner alone; False where it was there, and keeps its rights. Raises OSError."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    try:
        folder.mkdir(mode=FOLDER)
    except FileExistsError:
        if not folder.is_dir():
            raise
        return False
    folder.chmod(FOLDER)  # a umask may have taken rights of ours as well
    return True


def make_folder(folder: Path, store: str) -> None:
    """Make the folder of a store where it is absent. Raises OSError.

    One that was there keeps its rights, for others may keep things in it, unless it holds nothing but the files of
    `store`: such a one was made by us.
    """
    if not make_private(folder) and _is_of_the_store_alone(folder, store):
        _close_to_others(folder, FOLDER)


def make_file(file: Path) -> None:
    """Make an empty file where there is none. Raises OSError."""
    os.close(os.open(file, os.O_RDWR | os.O_CREAT, FILE))
    file.chmod(FILE)


def take_rights(file: Path, like: Path) -> None:
    """Give a file that takes the place of another the other's owner and rights; without another it is its owner's
    alone. Raises OSError."""
    if not like.exists():
        file.chmod(FILE)
        return
    found = like.stat()
    mode = stat.S_IMODE(found.st_mode)
    if hasattr(os, "chown"):
        try:
            os.chown(file, found.st_uid, found.st_gid)
        except PermissionError:
            mode &= FOLDER  # what was for another group is not for ours
    file.chmod(mode)


def tighten(file: Path) -> None:
    """Take from others what an earlier release let them read: a database and what SQLite keeps beside it."""
    for rest in BESIDE:
        _close_to_others(file.with_name(file.name + rest), FILE)


def _is_of_the_store_alone(folder: Path, store: str) -> bool:
    try:
        names = set(os.listdir(folder))
    except OSError:
        return False  # whoever may not even look into it did not make it
    return store in names and names <= {store + rest for rest in BESIDE}


def _close_to_others(path: Path, mode: int) -> None:
    """Nothing happens to what is absent or another's."""
    if not hasattr(os, "geteuid"):
        return  # no such rights on this system
    try:
        found = path.stat()
        before = stat.S_IMODE(found.st_mode)
        if found.st_uid == os.geteuid() and before & 0o077:
            path.chmod(mode)
            _LOG.warning("%s: was open to others (%04o), now to its owner alone (%04o)", path, before, mode)
    except FileNotFoundError:
        pass
    except OSError as error:
        _LOG.warning("%s: is open to others (%s) – chmod %o it", path, error.strerror, mode)
