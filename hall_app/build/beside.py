"""Several exhibits baked beside each other, a process each: a dressing keeps one core busy, a machine has more."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import traceback
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

from hall_app.content.bakes.store import bake_folder, bake_work
from hall_app.content.folder import Content, Exhibit
from hall_app.content.loading import load
from hall_app.content.lookup import make_data_folder

__all__ = ["Job", "bake", "bake_beside", "cores"]

Progress = Callable[[float, str], None]
MOST = 4  # processes at once, each of which takes some 700 MB


@dataclass(frozen=True)
class Job:
    """One exhibit to bake. folder: the content's; data: where work under way is kept; seconds: what it took the last
    time, or may take; film: whether to film it; force: whether earlier garments must not serve again."""

    folder: Path
    exhibit: str
    key: str
    target: Path
    data: Path
    seconds: float
    film: bool = True
    force: bool = False


def cores() -> int:
    """How many exhibits are baked at once where nobody says."""
    held = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return min(held, MOST)


def bake(job: Job, content: Content, progress: Progress) -> dict[str, Any]:
    """Bakes an outfit or a scan in this process; its record. Raises what either raises."""
    exhibit = _wanted(content, job.exhibit)
    make_data_folder(job.data)
    work = bake_work(job.data, exhibit.id, job.key)
    if exhibit.file.scan is not None:
        from hall_app.build.scan import bake_scan

        return bake_scan(content, exhibit, key=job.key, target=job.target, work=work, progress=progress)
    from hall_app.build.outfit import bake_outfit

    former = None if job.force else bake_folder(content, exhibit, job.data)
    return bake_outfit(
        content,
        exhibit,
        key=job.key,
        target=job.target,
        work=work,
        progress=progress,
        film=job.film,
        former=former,
    )


def bake_beside(
    jobs: Sequence[Job], workers: int, heard: Callable[[str, float, str], None]
) -> Iterator[tuple[str, dict[str, Any] | str]]:
    """Each exhibit as soon as it is baked, with its record, or with one line that says why it could not be.

    The longest begin first. heard(exhibit, share, label): how far each is. Whoever stops listening ends all that are
    under way, which go on from there another time.
    """
    context = get_context("spawn")
    waiting = deque(sorted(jobs, key=lambda job: -job.seconds))
    running: dict[Connection, tuple[str, Any]] = {}
    try:
        while waiting or running:
            while waiting and len(running) < workers:
                job, (ours, theirs) = waiting.popleft(), context.Pipe(duplex=False)
                process = context.Process(target=_at_work, args=(job, theirs), name=job.exhibit)
                process.start()
                theirs.close()
                running[ours] = job.exhibit, process
            for ready in wait([*running]):
                assert isinstance(ready, Connection)
                exhibit, process = running[ready]
                try:
                    share, news = ready.recv()
                except EOFError:
                    process.join()
                    share, news = None, f"its process ended with status {process.exitcode} – build it again"
                if share is not None:
                    heard(exhibit, share, news)
                    continue
                del running[ready]
                ready.close()
                process.join()
                yield exhibit, news
    finally:
        for _, process in running.values():
            process.terminate()
        for _, process in running.values():
            process.join()


def _at_work(job: Job, told: Connection) -> None:
    """A process's work: tells (share, label) again and again, at the end (None, record or what went wrong)."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever started this one ends it
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # and the film's own processes with it
    with contextlib.suppress(BrokenPipeError), told:
        try:
            record = bake(job, load(job.folder), lambda share, label: told.send((share, label)))
        except BrokenPipeError:
            raise
        except Exception as error:
            line = " ".join(str(error).split())
            told.send((None, line or "".join(traceback.format_exception_only(error)).strip()))
        else:
            told.send((None, record))


def _wanted(content: Content, name: str) -> Exhibit:
    exhibit = content.exhibit(name)
    if exhibit is None:
        raise ValueError(f"no exhibit {name!r} in {content.folder}")
    return exhibit
