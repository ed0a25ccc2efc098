"""A house kept safe: everything in one file that is checked, and a house made of such a file again.

archive: the file, its contents and their digests; keeping: what is put into it and taken out, whole or not at all,
and what killed backups left, removed; work: which of that somebody is still at work on;
command: `hall backup` and `hall restore`.
"""

from hall_app.house.safekeeping.archive import ArchiveError, Manifest, check_archive
from hall_app.house.safekeeping.keeping import Holdings, back_up, restore, tidy

__all__ = ["ArchiveError", "Holdings", "Manifest", "back_up", "check_archive", "restore", "tidy"]
