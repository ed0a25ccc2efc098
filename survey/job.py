"""What runs in a process of its own, so that visitors need not wait for it: an export or an analysis of the store.

`python -m survey.job`: reads one line of JSON from its input, writes the file to its output, and at its end one line
of JSON to its errors: {"headers": …}, {"refusal": …} or {"store": …}. Its input stays open; when that ends, so does
the process, whatever it is at: whoever started it is gone.
"""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

# All that costs time to import is imported where it is needed, after the process has made way for others.
if TYPE_CHECKING:
    from survey.export import Sheet
    from survey.questionnaire import Language, Questionnaire
    from survey.store.answers import Archive

__all__ = ["HEADER", "NICE", "main"]

HEADER = "Survey-Anonymity"  # says of a k-anonymous file what was made coarse
NICE = 10  # how far behind the service it stands for the processor


def main() -> int:
    """Do the one job. Exit status 0, also where the job is refused."""
    if hasattr(os, "nice"):
        with contextlib.suppress(OSError):
            os.nice(NICE)
    job = json.loads(sys.stdin.buffer.readline())
    folder = Path(job["folder"])
    threading.Thread(target=_end_with_input, args=(folder,), daemon=True).start()
    from survey.errors import AnswerError, StoreError, room_in

    told: dict[str, Any]
    try:
        # A buffer of its own: what sys.stdout could not write it would try once more at the end, and fail there.
        with room_in(folder.parent), open(sys.stdout.fileno(), "wb", closefd=False) as out:
            told = {"headers": _done(job, out, folder)}
    except AnswerError as error:
        told = {"refusal": [error.field, error.problem, error.remedy, error.status]}
    except StoreError as error:
        told = {"store": [error.problem, error.place]}
    sys.stderr.write(json.dumps(told) + "\n")
    return 0


def _end_with_input(folder: Path) -> None:
    # Not through sys.stdin, whose lock the interpreter wants at its end.
    while os.read(0, 1024):
        pass
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(1)


def _done(job: dict[str, Any], out: BinaryIO, folder: Path) -> dict[str, str]:
    """Write what is asked for; what its response's header says of it. Raises AnswerError, StoreError."""
    from survey.questionnaire import Questionnaire
    from survey.store.answers import Archive

    archive = Archive(Path(job["data"]) if "data" in job else job["db"])
    asked, task = Questionnaire.model_validate(job["questionnaire"]), job["task"]
    if task == "analysis":
        found = _analysed(asked, archive, job["settings"], job.get("language"))
        out.write(json.dumps(found, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode())
        return {}
    from survey.errors import AnswerError
    from survey.export import TooFew, stored_sheet

    try:
        with archive.snapshot() as connection:
            sheet = stored_sheet(connection, asked, job.get("k"), task)
            _put(task, sheet, out, folder)
    except TooFew as error:
        problem, _, remedy = str(error).partition(" – ")
        raise AnswerError("k", problem, remedy) from None
    return {} if sheet.anonymity is None else {HEADER: sheet.anonymity.told()}


def _put(task: str, sheet: Sheet, out: BinaryIO, folder: Path) -> None:
    from survey.export import put, put_rows, put_suggestions

    if task in ("rows", "suggestions"):
        (put_rows if task == "rows" else put_suggestions)(sheet, out)
    else:
        put(task, sheet, out, folder)


def _analysed(
    whole: Questionnaire, archive: Archive, wanted: dict[str, Any], language: Language | None
) -> dict[str, Any]:
    """language: in which its warnings are told as well, under "remarks"; None: in none."""
    from survey.analysis import AnalysisError, analyse
    from survey.analysis.procedure import Settings, summary
    from survey.errors import AnswerError
    from survey.scores import context_of, dropped, reverse_keyed, stored_scores

    table = stored_scores(whole, archive, texts=False)
    factors = wanted["factors"]
    settings = Settings(
        drop=dropped(wanted["drop"], whole),
        factors=int(factors) if factors.isdecimal() else factors,
        rotation=wanted["rotation"],
        missing=wanted["missing"],
        method=wanted["correlation"],
        bootstrap=wanted["bootstrap"],
        seed=wanted["seed"],
        reverse=reverse_keyed(wanted["reverse"], table),
    )
    try:
        found = analyse(table.scores, table.items, settings=settings, context=context_of(table, whole.points))
    except AnalysisError as error:
        problem, _, remedy = str(error).partition(" – ")
        raise AnswerError(error.code, problem, remedy or "see survey/README.md") from None
    if language is None:
        return summary(found)
    from survey.report import Words

    say = Words(language, whole, found.turned.items)
    return summary(found) | {"remarks": [say.remark(note) for note in found.notes]}


if __name__ == "__main__":
    sys.exit(main())
