"""`survey export`: answers in a file or on standard output."""

from __future__ import annotations

import argparse
import errno
import os
import shutil
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from survey.commands.options import add_content, add_store, declare, positive, where
from survey.errors import SurveyError

if TYPE_CHECKING:
    from survey.questionnaire import Questionnaire
    from survey.store import Store

__all__ = ["add"]

_MORE = """\
csv       UTF-8 with a byte order mark: one row per answer, one column per item and per module's suggestions.
          "Not seen" is an empty cell. Text that a spreadsheet would run as a formula gets an apostrophe in front.
xlsx      the same as a workbook, with the codebook on a second sheet
sav       SPSS, with labels in both languages; "not seen" is the user-missing value 9
json      the questionnaire as it was asked, and every answer
codebook  what each column means, as a CSV table
r         a script that repeats the analysis in R from the CSV

The column `submission` is a pseudonym made from the withdrawal code, which itself never leaves the store.

--k N makes the file k-anonymous: times become hours, days, weeks or months or are left out, and exhibit and language
are left out, until every combination is shared by N answers; pseudonyms and suggestions are left out, the rows
shuffled. What was done stands on standard error, in the file and in its codebook (--format codebook --k N). Scores
are kept as they are: who knows what somebody answered finds the row. Give out one such file of the same answers,
because what two of them tell together is not k-anonymous."""

FORMATS = ("csv", "xlsx", "sav", "json", "codebook", "r")


def add(commands) -> argparse.ArgumentParser:
    """Declare the command."""
    command = declare(commands, "export", _run, "export all answers to one questionnaire", _MORE)
    add = command.add_argument
    add("--questionnaire", required=True, metavar="ID", help="which one, such as garment")
    add("--version", type=positive, metavar="N", help="an earlier version (default: the file's)")
    text = f"{', '.join(FORMATS)} (default: by the ending of --out, else csv)"
    add("--format", choices=FORMATS, metavar="FORMAT", help=text)
    text = "make the file k-anonymous: at least N answers share all that is told beside the scores"
    add("--k", type=_k, metavar="N", help=text)
    add("--out", type=Path, metavar="FILE", help="where to (default: standard output)")
    add_content(command)
    add_store(command)
    return command


def _k(text: str) -> int:
    if not (text.isascii() and text.isdecimal()) or not 2 <= int(text[:5]) <= 1000:
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is no number from 2 to 1000")
    return int(text)


def _run(args: argparse.Namespace) -> int:
    from survey.errors import room_in
    from survey.scores import open_stored

    ending = "" if args.out is None else args.out.suffix.lower().lstrip(".")
    kind = args.format or (ending if ending in FORMATS else "csv")
    with room_in(tempfile.gettempdir()), tempfile.TemporaryFile() as made:
        # The database is let go before anybody reads the file, however slowly.
        with open_stored(where(args), args.content, args.questionnaire, args.version) as (asked, store):
            count, notes = _make(args, kind, asked, store, made)
            part = _beside(made, args.out)
            hidden = "" if args.k is None else f" k={args.k}"
            try:
                store.audit.note("export", f"{asked.id} version {asked.version} {kind}{hidden}, command line")
            except BaseException:
                if part is not None:
                    part.unlink(missing_ok=True)
                raise
        for note in filter(None, notes):
            print(f"survey: {args.questionnaire}: {note}", file=sys.stderr)
        _hand_out(made, part, args.out)
    if args.out is not None:
        print(f"{args.out}: {count} answers")
    return 0


def _make(
    args: argparse.Namespace, kind: str, asked: Questionnaire, store: Store, made: BinaryIO
) -> tuple[int, tuple[str, str]]:
    """Write the file; how many answers are in it, and what to say of it."""
    from survey.export import put, stored_sheet
    from survey.scores import other_versions
    from survey.store.answers import Archive

    with Archive(where(args)).snapshot() as connection, tempfile.TemporaryDirectory() as folder:
        sheet = stored_sheet(connection, asked, args.k, kind)
        put(kind, sheet, made, Path(folder))
    made.flush()
    if sheet.anonymity is None:
        return store.count(asked.id, asked.version), (other_versions(store, asked), "")
    done = sheet.anonymity
    return done.answers - done.suppressed, (other_versions(store, asked), done.told())


def _beside(made: BinaryIO, out: Path | None) -> Path | None:
    """The finished file beside where it is to be: a full disk leaves there what was there. None: no such place."""
    if out is None or _is_no_file(out):
        return None
    from survey.store.database import take_rights

    part = None
    try:
        if out.is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        place = out.resolve()  # not the link to it is replaced
        handle, name = tempfile.mkstemp(prefix=".survey-", dir=place.parent)
        part = Path(name)
        with open(handle, "wb") as file:
            made.seek(0)
            shutil.copyfileobj(made, file)
        take_rights(part, place)
        return part
    except OSError as error:
        if part is not None:
            part.unlink(missing_ok=True)
        raise _unwritten(str(out), error) from None


def _hand_out(made: BinaryIO, part: Path | None, out: Path | None) -> None:
    """Put the finished file where it was asked for."""
    try:
        if part is not None and out is not None:
            os.replace(part, out.resolve())
            return
        made.seek(0)
        if out is not None:
            with out.open("wb") as file:
                shutil.copyfileobj(made, file)
            return
        shutil.copyfileobj(made, sys.stdout.buffer)
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        if part is not None:
            part.unlink(missing_ok=True)
        if out is None:
            # Python would try to write the rest once more while it ends.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise _unwritten("standard output" if out is None else str(out), error) from None


def _is_no_file(out: Path) -> bool:
    """Whether there is something that is written to and never replaced, such as /dev/stdout or a pipe."""
    return out.exists() and not (out.is_file() or out.is_dir())


def _unwritten(place: str, error: OSError) -> SurveyError:
    return SurveyError(f"{place}: cannot be written ({error.strerror}) – make room or give another --out")
