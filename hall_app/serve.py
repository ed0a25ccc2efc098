"""`hall serve`: prepare what is missing, open the hall, follow the curator's edits, leave nothing behind."""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import signal
import socket
import sys
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .beside import beside
from .content.loading import Content, Exhibit, load
from .content.lookup import content_folder
from .content.problems import ContentError
from .ending import at_once
from .preparing import Preparation, stale_garments
from .progress_line import ProgressLine

if TYPE_CHECKING:
    import uvicorn
    from fastapi import FastAPI

    from survey import Clip

    from .house import House

__all__ = ["add_parser", "run"]

_POLL = 1.0  # [s] between two looks at the content folder

_EPILOG = """\
The hall needs no network, no database server and no torch. Answers, accounts of baking and caches go to --data.
A change in the content folder shows on reloading the page; a faulty file keeps its last good version on show.
Ctrl-C ends everything. Exit status: 0 ended by the user, 1 no hall (the message names the file), 2 wrong arguments."""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare `hall serve`."""
    parser = subparsers.add_parser(
        "serve",
        help="open the hall in the browser",
        description="Open the hall at http://HOST:PORT until Ctrl-C.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--port", type=_port, default=8000, help="port of the page (default 8000)")
    parser.add_argument(
        "--host", default="127.0.0.1", help="address to listen on (default 127.0.0.1: this machine alone)"
    )
    parser.add_argument("--content", type=Path, metavar="FOLDER", help="content folder (default ./assets)")
    parser.add_argument(
        "--data",
        type=Path,
        default=Path("hall-data"),
        metavar="FOLDER",
        help="answers and caches (default ./hall-data)",
    )
    parser.add_argument(
        "--walk",
        choices=("predict", "server"),
        default="predict",
        help="predict: the page walks at once, the server has the last word (default); server: the server walks",
    )
    parser.add_argument(
        "--no-light",
        dest="light",
        action="store_false",
        help="where the room's light has not been computed for this plan, leave it even",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Serve until interrupted."""
    with at_once():
        content = _prepared(arguments)
        if content is None:
            return 1
        stale = stale_garments(content, arguments.data)
    for sign in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(sign, _end)  # a closed terminal or a service manager ends a bake as Ctrl-C does
    with contextlib.suppress(KeyboardInterrupt):  # Ctrl-C ends the hall at any time, and is no failure
        _bake_missing(content, arguments.data, stale)
        with at_once():
            server = _server(_open(content, arguments), arguments)
        server.run()
    return 0


def _prepared(arguments: argparse.Namespace) -> Content | None:
    """The content, told of; None, told why, where there is no hall."""
    try:
        content = load(content_folder(arguments.content))
    except ContentError as error:
        for problem in error.problems:
            print(f"hall serve: {problem}", file=sys.stderr)
        return None
    _check_port(arguments.host, arguments.port)
    try:
        arguments.data.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OSError(
            f"--data {arguments.data}: {error.strerror} – choose a folder that can be written"
        ) from error
    _say(f"Content  {content.folder}")
    for problem in content.problems:
        _say(f"  left out: {problem}")
    return content


def _server(app: FastAPI, arguments: argparse.Namespace) -> uvicorn.Server:
    import uvicorn

    config = uvicorn.Config(
        app,
        host=arguments.host,
        port=arguments.port,
        log_level="warning",
        access_log=False,
        loop="asyncio",  # the loop viser runs on as well
        ws="websockets-sansio",
        ws_max_size=1 << 26,
        timeout_graceful_shutdown=2,
    )
    return uvicorn.Server(config)


def _end(number: int, frame: object) -> None:
    raise KeyboardInterrupt


def _port(text: str) -> int:
    number = int(text)
    if not 1 <= number <= 65535:
        raise argparse.ArgumentTypeError(f"{number} is no port – give 1 to 65535")
    return number


def _check_port(host: str, port: int) -> None:
    """Say at once that the port is taken, before anything is prepared."""
    with socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            raise OSError(
                f"cannot listen on {host}:{port} ({error.strerror}) – choose another with --port"
            ) from error


def _open(content: Content, arguments: argparse.Namespace) -> FastAPI:
    from survey import mount

    from .house import House
    from .server.app import create_app

    _say("Opening the hall …")
    progress = ProgressLine()

    def show(fraction: float, label: str) -> None:
        progress.tell(f"Preparing {label} {fraction:4.0%}", done=fraction >= 1)

    house = House(content, arguments.data, walk_mode=arguments.walk, progress=show)

    @contextlib.asynccontextmanager
    async def living(app: FastAPI) -> AsyncIterator[None]:
        house.attach(asyncio.get_running_loop())
        following = asyncio.create_task(_follow_edits(house, arguments.light))
        _greet(house, arguments)
        try:
            yield
        finally:
            following.cancel()
            await asyncio.gather(following, return_exceptions=True)
            survey.close()
            house.close()

    app = create_app(house, lifespan=living)
    survey = mount(
        app, content=content.folder, data=arguments.data, problems=[], clip_of=lambda key: _film(house, key)
    )
    house.survey_problems = lambda: survey.problems
    for problem in survey.problems:
        _say(f"  left out: {problem}")
    return app


def _film(house: House, key: str) -> Clip | None:
    """The exhibit's film, for the questionnaire's items on motion; None where it has none (yet)."""
    from survey import Clip

    from .content.views import exhibit_json

    models = house.models(key)
    shown = exhibit_json(house.content, key, baked=models.baked if models else None) or {"media": ()}
    for medium in shown["media"]:
        if medium["kind"] == "video":
            sources = tuple((source["url"], source["type"]) for source in medium["sources"])
            return Clip(sources, medium["alt"] or {}, medium["poster"])
    return None


def _greet(house: House, arguments: argparse.Namespace) -> None:
    count, wrong = len(house.shown()), len(house.problems)
    exhibits = f"{count} exhibit{'' if count == 1 else 's'}"
    for problem in (*house.unbaked, *house.room_problems):
        _say(f"  left out: {problem}")
    shown = f"[{arguments.host}]" if ":" in arguments.host else arguments.host
    _say(f"{exhibits}, {wrong} problem{'' if wrong == 1 else 's'}")
    if not house.room.baked:
        later = "" if arguments.light and house.room_unlit() else " (hall build --room computes it)"
        _say(f"The room's light is not computed for this plan: it is shown evenly lit{later}")
    _say(f"Open     http://{shown}:{arguments.port}   (Ctrl-C ends)")


def _bake_missing(content: Content, data: Path, stale: Sequence[Exhibit]) -> None:
    """Bake garments that have no bake yet, in a process of their own, before the doors open."""
    progress = ProgressLine()
    for exhibit in stale:
        try:
            with Preparation(content.folder, data, "--exhibit", exhibit.id) as preparation:
                while preparation.poll() is None:
                    progress.tell(f"Preparing {exhibit.id}: {preparation.line()}")
                    time.sleep(0.3)
            progress.tell(f"Preparing {exhibit.id}: {preparation.outcome()}", done=True)
        finally:
            progress.end()


async def _follow_edits(house: House, light: bool) -> None:
    """Show edits within a second or two; bake changed garments and the room beside the serving process."""
    from .content.reload import Watcher

    watcher = Watcher(house.content.folder, house.content)

    async def look() -> None:
        content = await beside(watcher.poll)
        if content is not None:
            before = set(house.problems)
            await house.replace(content)
            for problem in house.problems:
                if problem not in before:
                    _say(f"Problem: {problem}")
        for exhibit in stale_garments(house.content, house.data):
            if not house.given_up(exhibit):
                await _bake_beside(house, exhibit)
        if light and house.room_unlit():
            await _light_beside(house)

    await _for_ever(_POLL, look, "following edits")


async def _for_ever(period: float, act: Callable[[], Awaitable[None]], what: str) -> None:
    """Act every `period` seconds; an error is told once and does not end it."""
    told = ""
    while True:
        await asyncio.sleep(period)
        try:
            await act()
        except Exception as error:
            if str(error) != told:
                told = str(error)
                _say(f"Problem while {what}: {' '.join(told.split())} – the hall goes on as it was")


async def _bake_beside(house: House, exhibit: Exhibit) -> None:
    house.baked(exhibit, await _built(house, exhibit.id, "--exhibit", exhibit.id))
    await house.replace(house.content)


async def _light_beside(house: House) -> None:
    """Compute the light of a room that was raised flat; it is shown as soon as it is there."""
    key = house.room.key
    house.room_baked(key, await _built(house, "the room's light", "--room"))
    await house.replace(house.content)


async def _built(house: House, name: str, *what: str) -> str | None:
    """Run one build in a process of its own; why it failed, or None."""
    with Preparation(house.content.folder, house.data, *what) as preparation:
        _say(f"Preparing {name} …")
        while preparation.poll() is None:
            await asyncio.sleep(0.5)
    outcome = preparation.outcome()
    _say(f"Preparing {name}: {outcome}")
    return None if preparation.returncode == 0 else outcome


def _say(text: str) -> None:
    print(text, flush=True)
