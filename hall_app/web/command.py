"""`hall serve`: open the hall, follow the curator's edits, bake what they ask for, leave nothing behind."""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import signal
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from pathlib import Path
from typing import TYPE_CHECKING

from hall_app.content.folder import Content
from hall_app.content.loading import load
from hall_app.content.lookup import content_folder, make_data_folder
from hall_app.content.problems import ContentError
from hall_app.house.baking.preparation import Preparation, forsake, wanted_bakes
from hall_app.house.baking.queue import BakingQueue
from hall_app.house.people.command import add_accounts, add_data
from hall_app.house.signals import at_once
from hall_app.visit.places import Places
from hall_app.web.limits.addresses import Addresses
from hall_app.web.limits.descriptors import connections, raise_limit, shortage
from hall_app.web.limits.threads import few_threads
from hall_app.web.memory import settle
from hall_app.web.port import add_limits, check_port, gigabytes, port, server
from hall_app.web.progress_line import ProgressLine

if TYPE_CHECKING:
    from fastapi import FastAPI

    from hall_app.house.house import House
    from survey import Clip

__all__ = ["OFFERS", "add_parser", "run"]

_POLL = 1.0  # [s] between two looks at the content folder, and at what is being baked
_TICK = 0.25  # [s] between two ticks of the hall's clock

OFFERS = frozenset(
    {"culture", "research", "activities", "visit", "user-centre", "office"}
)  # pages of the platform beside the hall: what needs another is not asked

_TOLD = ProgressLine()  # whatever this command says goes through it, so that no line runs into another

_EPILOG = """\
The hall needs no network, no database server and no torch. Answers, accounts of visitors and staff, and
caches go to --data.
A change in the content folder shows within two seconds; a faulty file keeps its last good version on show. What has
to be baked for it, a garment or the room's light, is baked beside, one after the other: the last model and the last
light stay on show until then, and an exhibit that was never baked appears when it is.
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
    parser.add_argument("--port", type=port, default=8000, help="port of the page (default 8000)")
    parser.add_argument(
        "--host", default="127.0.0.1", help="address to listen on (default 127.0.0.1: this machine alone)"
    )
    parser.add_argument("--content", type=Path, metavar="FOLDER", help="content folder (default ./assets)")
    add_data(parser, "answers and caches")
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
    parser.add_argument(
        "--quota",
        type=gigabytes,
        default=2.0,
        metavar="GB",
        help="what drafts and the history of the office may take up in --data (default 2); backups, restored houses "
        "and bakes are not counted",
    )
    add_accounts(parser)
    add_limits(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Serve until interrupted."""
    with at_once():
        content = _prepared(arguments)
        if content is None:
            return 1
    for sign in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(sign, _end)  # a closed terminal or a service manager ends a bake as Ctrl-C does
    with contextlib.suppress(KeyboardInterrupt):  # Ctrl-C ends the hall at any time, and is no failure
        with at_once():
            addresses = Addresses()
            limit = raise_limit()
            if short := shortage(limit, arguments.visitors):
                _say(short)
            app = _open(content, arguments, addresses)
            listening = server(app, arguments, addresses, connections(limit, arguments.visitors))
        listening.run()
    return 0


def _prepared(arguments: argparse.Namespace) -> Content | None:
    """The content, told of; None, told why, where there is no hall."""
    try:
        content = load(content_folder(arguments.content))
    except ContentError as error:
        for problem in error.problems:
            print(f"hall serve: {problem}", file=sys.stderr)
        return None
    check_port(arguments.host, arguments.port)
    make_data_folder(arguments.data)
    _say(f"Content  {content.folder}")
    for problem in content.problems:
        _say(f"  left out: {problem}")
    return content


def _end(number: int, frame: object) -> None:
    raise KeyboardInterrupt


def _back_to(language: str, exhibit: str | None) -> str:
    """Where the thanks of a questionnaire lead: into the hall, to the exhibit it was asked at."""
    return f"/?lang={language}" + (f"&exhibit={exhibit}" if exhibit else "")


def _open(content: Content, arguments: argparse.Namespace, addresses: Addresses) -> FastAPI:
    from hall_app.house import end_all
    from hall_app.house.house import House
    from hall_app.house.people import People
    from hall_app.house.safekeeping import Holdings
    from hall_app.web.app import create_app
    from hall_app.web.platform import KEEP_CODE, follow_withdrawals
    from survey import Ways, mount
    from survey.web import Running

    people = People(arguments.accounts or arguments.data)
    _say("Opening the hall …")

    def show(fraction: float, label: str) -> None:
        _TOLD.tell(f"Preparing {label} {fraction:4.0%}", done=fraction >= 1)

    places = Places(arguments.visitors)
    house = House(content, arguments.data, walk_mode=arguments.walk, progress=show, places=places)
    house.expect(wanted_bakes(content, arguments.data, light=arguments.light))

    def close() -> None:
        end_all()
        survey.close()
        people.close()

    app = create_app(
        house, people=people, addresses=addresses, lifespan=lambda _: _living(house, arguments, close)
    )
    survey = mount(
        app,
        content=content.folder,
        data=arguments.data,
        problems=[],
        clip_of=lambda key: _film(house, key),
        offers=OFFERS,
        ways=Ways(home=_back_to, keep=KEEP_CODE),
        running=Running(proxies=tuple(arguments.proxy)),
    )
    house.survey_problems, house.survey_asks = lambda: survey.problems, survey.asks
    house.survey_results = survey.results
    house.survey_suggestions, house.survey_tokens = survey.suggestions, lambda: survey.store.tokens
    house.survey_standing, house.survey_made = survey.standing, survey.made
    house.survey_answers = survey
    follow_withdrawals(survey, people)
    house.holdings = Holdings(
        content.folder, arguments.data, arguments.accounts or arguments.data, arguments.data
    )
    house.quota = int(arguments.quota * 1e9)
    for problem in survey.problems:
        _say(f"  left out: {problem}")
    for hint in survey.hints:
        _say(f"  hint: {hint}")
    return app


@contextlib.asynccontextmanager
async def _living(
    house: House, arguments: argparse.Namespace, close: Callable[[], None]
) -> AsyncIterator[None]:
    """The hall while it is open: it follows the content and bakes. close: what else ends with it."""
    from hall_app.house.edits import Following

    loop = asyncio.get_running_loop()
    # The server knows two signals; the third, of a closed terminal, ends it in the same way.
    loop.add_signal_handler(signal.SIGHUP, signal.raise_signal, signal.SIGTERM)
    house.attach(loop)
    settle()
    few_threads()
    queue = BakingQueue(
        lambda bake: Preparation(house.content.folder, house.data, bake),
        lambda bake: forsake(bake, house.data),
        lambda name, line, last: _TOLD.tell(f"Preparing {name}: {line}", done=last),
    )
    house.queue = queue
    _greet(house, arguments)
    look = Following(house, queue, light=arguments.light, say=_say).look

    async def tick() -> None:
        house.stage.tick(loop.time())

    tasks = [
        asyncio.create_task(_for_ever(_POLL, look, "following edits")),
        asyncio.create_task(_for_ever(_TICK, tick, "moving exhibits")),
    ]
    try:
        yield
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        queue.close()
        close()
        house.close()
        _TOLD.end()


def _film(house: House, key: str) -> Clip | None:
    """The exhibit's film, for the questionnaire's items on motion; None where it has none (yet)."""
    from hall_app.content.views.scene import exhibit_json
    from survey import Clip

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
    for name in house.preparing:
        _say(f"  to come: {name}, when its garment is baked")
    if house.room.former or not house.room.baked:
        how = "with that of an earlier state" if house.room.former else "evenly lit"
        later = "" if arguments.light and house.room_unlit() else " (hall build --room computes it)"
        _say(f"The room's light is not computed for this plan: it is shown {how}{later}")
    _say(f"Open     http://{shown}:{arguments.port}   (Ctrl-C ends)")


async def _for_ever(period: float, act: Callable[[], Awaitable[None]], what: str) -> None:
    """Act every `period` seconds; an error is told once and does not end it."""
    told = ""
    while True:
        try:
            await act()
        except Exception as error:
            if str(error) != told:
                told = str(error)
                _say(f"Problem while {what}: {' '.join(told.split())} – the hall goes on as it was")
        await asyncio.sleep(period)


def _say(text: str) -> None:
    _TOLD.end()
    print(text, flush=True)
