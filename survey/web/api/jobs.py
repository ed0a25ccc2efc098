"""Work that would hold visitors up, in a process of its own: started, waited for, ended; what it made is handed out."""

from __future__ import annotations

import asyncio
import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import weakref
from collections.abc import AsyncIterator, Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, BinaryIO

from fastapi import Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import StreamingResponse

from survey.errors import AnswerError, StoreError, room_in

__all__ = ["JOBS_AT_WORK", "JOBS_OPEN", "Jobs", "Run"]

JOBS_AT_WORK = 2  # processes at a time
JOBS_OPEN = (
    8  # files that somebody is still fetching, or that are being made: each takes its size on the disk
)
RETRY_SECONDS = 5
_PART = 1 << 16  # bytes handed to the network at a time
_COMMAND = (sys.executable, "-P", "-m", "survey.job")
_ROOT = str(Path(__file__).resolve().parents[3])  # where the process finds what it is to import


class Jobs:
    """Exports and analyses of one store. where: the data folder or the database's URL.

    A process makes its file, which has no name and is nobody else's, at full speed; whoever fetches it slowly holds
    neither a process nor the database. It ends with whoever hangs up, with close(), and with this process.
    """

    def __init__(self, where: Path | str, *, most: int = JOBS_AT_WORK) -> None:
        self._where = where
        self._running: set[Run] = set()
        self._open: weakref.WeakSet[BinaryIO] = weakref.WeakSet()
        self._threads = ThreadPoolExecutor(most, "survey-job")

    async def response(
        self,
        request: Request,
        job: Mapping[str, Any],
        media_type: str,
        headers: Mapping[str, str],
        noted: Callable[[], None] = lambda: None,
    ) -> StreamingResponse:
        """What the job makes. job: as survey.job reads it, without where the store is.

        noted: called once it is made; where that raises, nothing is handed out. Raises AnswerError: 503 where too many
        are at work, else what the job refuses; StoreError.
        """
        if sum(not body.closed for body in self._open) >= JOBS_OPEN:
            problem = f"{JOBS_OPEN} exports and analyses are under way"
            remedy = f"send the same again in {RETRY_SECONDS} s"
            raise AnswerError("", problem, remedy, status=503, wait=RETRY_SECONDS)
        with room_in(tempfile.gettempdir()):
            run = Run(_store(self._where) | dict(job))
        self._running.add(run)
        self._open.add(run.body)
        try:
            told = await self._finished(request, run)
            await run_in_threadpool(noted)
        except BaseException:
            run.body.close()
            raise
        finally:
            run.end()
            self._running.discard(run)
        size = run.body.seek(0, os.SEEK_END)
        run.body.seek(0)
        sizes = {"Content-Length": str(size)}  # by which whoever is cut off notices
        return StreamingResponse(
            _parts(run.body), media_type=media_type, headers={**headers, **told, **sizes}
        )

    def made(self, job: Mapping[str, Any]) -> bytes:
        """The same for a caller who waits, in a thread of his own. Raises AnswerError, StoreError."""
        with room_in(tempfile.gettempdir()):
            run = Run(_store(self._where) | dict(job))
        self._running.add(run)
        try:
            self._threads.submit(run.through).result()
            run.body.seek(0)
            return run.body.read()
        finally:
            run.end()
            run.body.close()
            self._running.discard(run)

    async def _finished(self, request: Request, run: Run) -> dict[str, str]:
        """What the run says at its end; where the client hangs up before, the run is over."""
        done = asyncio.get_running_loop().run_in_executor(self._threads, run.through)
        # Where the request itself was ended nobody is left to hear what became of it.
        done.add_done_callback(lambda found: found.cancelled() or found.exception())
        gone = asyncio.ensure_future(_hang_up(request))
        try:
            await asyncio.wait({done, gone}, return_when=asyncio.FIRST_COMPLETED)
            if not done.done():
                run.end()
            return await done
        except asyncio.CancelledError:
            # The service ends and waits no longer: whoever asked hears that, and its log no traceback.
            raise _broken_off() from None
        finally:
            gone.cancel()

    def close(self) -> None:
        """End what is under way."""
        for run in list(self._running):
            run.end()


class Run:
    """One process. body: what it makes, a file without a name, readable by nobody else."""

    def __init__(self, job: dict[str, Any]) -> None:
        self.body: BinaryIO = tempfile.TemporaryFile()  # noqa: SIM115  (closed with its last reader)
        self._job, self._ended = job, False
        self._process: subprocess.Popen[bytes] | None = None
        self._changing = threading.Lock()

    def through(self) -> dict[str, str]:
        """Start it and wait for its end; the headers that it gives. Raises AnswerError, StoreError."""
        with room_in(tempfile.gettempdir()):
            folder = tempfile.mkdtemp(prefix="survey-")  # for it alone (0700)
        try:
            with self._changing:
                if self._ended:
                    raise _broken_off()
                self._process = process = subprocess.Popen(
                    _COMMAND,
                    stdin=subprocess.PIPE,
                    stdout=self.body,
                    stderr=subprocess.PIPE,
                    env=os.environ | {"PYTHONPATH": _found(os.environ.get("PYTHONPATH"))},
                )
            return self._heard(process, folder)
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def _heard(self, process: subprocess.Popen[bytes], folder: str) -> dict[str, str]:
        assert process.stdin is not None
        assert process.stderr is not None
        with process.stderr, process.stdin:
            try:
                # Where the store is may hold a password: it is written here and stands on no command line.
                process.stdin.write(json.dumps(self._job | {"folder": folder}).encode() + b"\n")
                process.stdin.flush()
                said = process.stderr.read()
            except BrokenPipeError:
                said = process.stderr.read()
            code = process.wait()
        return _told(code, said.decode(errors="replace"))

    def end(self) -> None:
        """End the process where it still runs; none is started any more."""
        with self._changing:
            self._ended = True
            if self._process is not None:
                self._process.kill()


def _told(code: int, said: str) -> dict[str, str]:
    if code < 0:
        raise _broken_off()
    if code:
        raise RuntimeError(f"an export or analysis failed:\n{said}")
    told = json.loads(said.splitlines()[-1])
    if "refusal" in told:
        field, problem, remedy, status = told["refusal"]
        raise AnswerError(field, problem, remedy, status=status)
    if "store" in told:
        raise StoreError(*told["store"])
    return told["headers"]


def _broken_off() -> StoreError:
    return StoreError("the export or analysis was broken off – ask again")


def _store(where: Path | str) -> dict[str, str]:
    return {"data": str(where.absolute())} if isinstance(where, Path) else {"db": where}


def _found(given: str | None) -> str:
    return os.pathsep.join(filter(None, (_ROOT, given)))


async def _hang_up(request: Request) -> None:
    """Returns when nobody listens any more."""
    while (await request.receive())["type"] != "http.disconnect":
        pass


async def _parts(body: BinaryIO) -> AsyncIterator[bytes]:
    with body:
        while part := await run_in_threadpool(body.read, _PART):
            yield part
