"""Crowds and attackers at the hall's doors: floods end, a class gets in, the queue moves on."""

import asyncio
import contextlib
import json
import random
import re
import socket as sockets
import sys
import time
import urllib.request
from pathlib import Path

import event_loop
import msgspec
import pytest
from full_matrix import by_day
from plain_hall import write_plain_hall
from running_hall import running_hall
from starlette.websockets import WebSocketDisconnect
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed, InvalidStatus

sys.path.insert(0, str(Path(__file__).parents[1] / "bench"))
from crowd_attack import CLICK, WALK, frame  # noqa: E402
from crowd_load import VISER, camera  # noqa: E402

from hall_app.visit import Places
from hall_app.web.limits import RATES
from hall_app.web.sockets import Turns, Views, until_first

HELLO = json.dumps({"t": "hello", "client": None, "display": "page", "able": "predict"})
PATIENCE = 60.0  # [s]; these tests ask what happens, not how fast


@pytest.fixture(scope="module")
def small_hall(tmp_path_factory):
    """A hall for three, behind a proxy at 127.0.0.9."""
    work = tmp_path_factory.mktemp("small")
    options = ("--visitors", "3", "--proxy", "127.0.0.9")
    with running_hall(write_plain_hall(work / "content"), work, *options) as hall:
        yield hall


@pytest.fixture
def full_hall(tmp_path):
    """A hall for three of its own: nobody else's place in the queue is kept in it."""
    with running_hall(write_plain_hall(tmp_path / "content"), tmp_path / "work", "--visitors", "3") as hall:
        yield hall


@pytest.fixture
def own_hall(tmp_path):
    """A hall that has seen nobody misbehave yet."""
    with running_hall(write_plain_hall(tmp_path / "content"), tmp_path / "work") as hall:
        yield hall


def altered(*lines: str) -> tuple[str, ...]:
    """A program that is `hall` after these lines of Python."""
    begin = "import runpy, resource, sys; sys.argv[0] = 'hall'"
    return (
        sys.executable,
        "-c",
        "\n".join([begin, *lines, "runpy.run_module('hall_app', run_name='__main__')"]),
    )


@pytest.fixture
def tight_hall(tmp_path):
    """A hall for three that may open few files."""
    few = altered("resource.setrlimit(resource.RLIMIT_NOFILE, (300, 300))")
    work, content = tmp_path / "work", write_plain_hall(tmp_path / "content")
    with running_hall(content, work, "--visitors", "3", program=few) as hall:
        yield hall


def door(hall, address: str = "127.0.0.1", path: str = "/walk", **options):
    """A socket from an address of this machine, as a browser would open it: it reads all there is."""
    usual = {
        "local_addr": (address, 0),
        "proxy": None,
        "max_queue": None,
        "max_size": None,
        "close_timeout": 2,
    }
    return connect(f"ws://127.0.0.1:{hall.port}{path}", open_timeout=PATIENCE, **usual, **options)


async def hear(socket, kind: str) -> dict:
    """The next message of that kind."""
    async with asyncio.timeout(PATIENCE):
        while (message := json.loads(await socket.recv()))["t"] != kind:
            pass
    return message


async def enter(socket) -> dict:
    await socket.send(HELLO)
    return await hear(socket, "hi")


async def walks(socket, number: int = 1) -> None:
    """This visitor is answered."""
    await socket.send(json.dumps({"t": "in", "in": [[number, 1 / 60, 1, 0, 0.0, 1.6]]}))
    while (await hear(socket, "pose"))["seq"] != number:
        pass


FLOODS = {kind: [json.dumps(message) for message in messages] for kind, messages in WALK.items()}
FLOODS["in"] = [json.dumps({"t": "in", "in": [[k, 0.001, 1, 0, 0.1, 1.6] for k in range(1, 600)]})]
FLOODS["unreadable"] = ["{" * 100]
FLOODS["large"] = ["[" + "1," * 15_000 + "1]"]
FLOODS["no kind"] = ["{}"]


async def flooded(socket, messages: list) -> ConnectionClosed:
    """Send on end, reading all the while, until thrown out."""

    async def send() -> None:
        for n in range(30_000):
            await socket.send(messages[n % len(messages)])
            if n % 20 == 0:
                await asyncio.sleep(0)  # time to read why it is over

    async def read() -> None:
        while True:
            await socket.recv()

    async with asyncio.timeout(PATIENCE):
        with pytest.raises(ConnectionClosed) as ended:
            await asyncio.gather(send(), read())
    return ended.value


@pytest.mark.parametrize("kind", by_day(["in", "unreadable"], FLOODS))
def test_a_flood_of_any_kind_is_shown_out_with_a_reason(plain_hall, kind):
    async def run() -> None:
        async with door(plain_hall) as other:
            await enter(other)
            async with door(plain_hall, "127.0.0.2") as attacker:
                await enter(attacker)
                ended = await flooded(attacker, FLOODS[kind])
            assert ended.rcvd is not None
            assert ended.rcvd.code == 1008
            assert "too much" in ended.rcvd.reason
            await walks(other)

    event_loop.run(run())


async def ask(hall, address: str) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    return await asyncio.open_connection("127.0.0.1", hall.port, local_addr=(address, 0))


async def answered(reader: asyncio.StreamReader) -> bytes:
    """The whole answer of a connection that ends with it."""
    async with asyncio.timeout(PATIENCE):
        return await reader.read(-1)


def test_one_address_asking_on_hundreds_of_lines_does_not_make_another_wait_for_all(own_hall):
    """Counted, not timed: how many of the others' answers come before the one to whoever asked last."""
    get = f"GET /catalogue HTTP/1.1\r\nHost: 127.0.0.1:{own_hall.port}\r\nConnection: close\r\n\r\n".encode()

    async def place() -> int:
        many = [await ask(own_hall, "127.0.0.2") for _ in range(200)]
        reader, writer = await ask(own_hall, "127.0.0.3")
        order: list[str] = []

        async def told(name: str, reader: asyncio.StreamReader) -> None:
            assert b" 200 " in (await answered(reader))[:20]
            order.append(name)

        for _, line in many:
            line.write(get)
        writer.write(get)
        await asyncio.gather(*(told("many", line) for line, _ in many), told("one", reader))
        for _, line in [*many, (reader, writer)]:
            line.close()
        return order.index("one")

    async def run() -> None:
        assert sorted([await place() for _ in range(5)])[2] < 100

    event_loop.run(run())


def test_visitors_of_one_address_within_their_budgets_leave_another_his_turn(own_hall):
    """Counted: how many of their messages are answered between his and its answer."""
    batches = [
        json.dumps({"t": "in", "in": [[64 * n + k, 0.002, 1, 1, 0.1, 1.6] for k in range(1, 65)]})
        for n in range(30)
    ]

    async def run() -> None:
        async with contextlib.AsyncExitStack() as stack:
            other = await stack.enter_async_context(door(own_hall, "127.0.0.3"))
            many = [await stack.enter_async_context(door(own_hall, "127.0.0.2")) for _ in range(40)]
            await asyncio.gather(*map(enter, [other, *many]))
            served = dict.fromkeys(range(len(many)), 0)

            async def follow(n: int, socket) -> None:
                while served[n] < 64 * len(batches):
                    served[n] = (await hear(socket, "pose"))["seq"]

            following = [asyncio.ensure_future(follow(n, socket)) for n, socket in enumerate(many)]
            for batch in batches:
                for socket in many:
                    await socket.send(batch)
            passed = []
            for number in range(1, 6):
                before = sum(served.values())
                await walks(other, number)
                passed.append((sum(served.values()) - before) / 64)
            assert sorted(passed)[2] < 40, passed  # less than a message of each
            await asyncio.gather(*following)  # and none of theirs is lost

    event_loop.run(run())


def test_a_line_that_asks_ahead_without_end_is_cut(own_hall):
    get = f"GET /api/texts HTTP/1.1\r\nHost: 127.0.0.1:{own_hall.port}\r\n\r\n".encode()

    async def run() -> None:
        reader, writer = await ask(own_hall, "127.0.0.2")
        writer.write(get * 2000)
        said = b""
        with contextlib.suppress(ConnectionError):
            said = await answered(reader)
        assert said.count(b"HTTP/1.1 200") < 50
        writer.close()
        reader, writer = await ask(own_hall, "127.0.0.2")
        writer.write(get * 7 + get.replace(b"\r\n\r\n", b"\r\nConnection: close\r\n\r\n"))
        assert (await answered(reader)).count(b"HTTP/1.1 200") == 8  # a few are no offence
        writer.close()

    event_loop.run(run())


@pytest.mark.nightly
@pytest.mark.parametrize("opcode", [9, 10, 0])  # pings, pongs, a message in endless pieces
def test_floods_below_the_messages_are_cut(plain_hall, opcode):
    async def run() -> None:
        async with door(plain_hall, "127.0.0.3") as attacker:
            await enter(attacker)
            if opcode == 0:
                attacker.transport.write(bytes([0x01, 0x80, 0, 0, 0, 0]))
            async with asyncio.timeout(PATIENCE):
                while not attacker.transport.is_closing():
                    attacker.transport.write(
                        bytes([opcode, 0x80, 0, 0, 0, 0]) if not opcode else frame(b"", opcode)
                    )
                    await asyncio.sleep(0)
        async with door(plain_hall) as other:
            await enter(other)

    event_loop.run(run())


@pytest.mark.nightly
@pytest.mark.parametrize("message", [camera.__call__, None])
def test_floods_on_visers_socket_are_shown_out(plain_hall, message):
    import random

    data = message(random.Random(1)) if message else msgspec.msgpack.encode(CLICK)

    async def run() -> None:
        async with door(plain_hall, "127.0.0.4", "/", subprotocols=[VISER]) as attacker:
            ended = await flooded(attacker, [data])
        assert ended.rcvd is not None
        assert ended.rcvd.code == 1008

    event_loop.run(run())


@pytest.mark.nightly
def test_a_lively_visitor_is_never_touched(plain_hall):
    """240 inputs a second, the map, close-ups, a camera that never rests."""
    import random

    async def run() -> None:
        rng = random.Random(1)
        view = door(plain_hall, "127.0.0.5", "/", subprotocols=[VISER])
        async with door(plain_hall, "127.0.0.5") as socket, view as looking:
            await enter(socket)
            for batch in range(150):
                inputs = [[8 * batch + k, 1 / 240, 1, 0, 0.001 * batch, 1.6] for k in range(1, 9)]
                await socket.send(json.dumps({"t": "in", "in": inputs}))
                await looking.send(camera(rng))
                await looking.send(camera(rng))
                if batch % 15 == 0:
                    await socket.send(json.dumps({"t": "goto", "x": rng.random(), "z": 4.0}))
                if batch % 40 == 0:
                    await socket.send(json.dumps({"t": "open", "id": "box"}))
                    await hear(socket, "open")
                    await socket.send(json.dumps({"t": "close"}))
                await asyncio.sleep(1 / 30)
            while (await hear(socket, "pose"))["seq"] != 8 * 150:
                pass

    event_loop.run(run())


def test_what_is_open_is_not_sent_again(plain_hall):
    async def run() -> None:
        async with door(plain_hall, "127.0.0.5") as socket:
            await enter(socket)
            for _ in range(3):
                await socket.send(json.dumps({"t": "open", "id": "box"}))
            await socket.send(json.dumps({"t": "close"}))
            said = []
            while not said or said[-1] != "closed":
                said.append(json.loads(await asyncio.wait_for(socket.recv(), PATIENCE))["t"])
            assert said.count("open") == 1

    event_loop.run(run())


@pytest.mark.nightly
def test_silent_sockets_are_few_and_a_class_gets_in_beside_them(own_hall):
    """400 that never say hello from one address; 100 visitors from another come in, and from the same one later."""

    async def run() -> None:
        async with contextlib.AsyncExitStack() as stack:
            opened = 0
            for _ in range(400):
                with contextlib.suppress(InvalidStatus):
                    await stack.enter_async_context(door(own_hall, "127.0.0.2"))
                    opened += 1
            assert 100 <= opened <= 200
            inside = [await stack.enter_async_context(door(own_hall, "127.0.0.3")) for _ in range(100)]
            await asyncio.gather(*(enter(socket) for socket in inside))
            await asyncio.gather(*(walks(socket) for socket in inside))

    event_loop.run(run())


@pytest.mark.nightly
def test_a_class_of_a_hundred_comes_in_at_once(own_hall):
    """Both sockets of each, all at the same moment, from one address."""

    async def visitor(stack: contextlib.AsyncExitStack) -> None:
        view = door(own_hall, path="/", subprotocols=[VISER])
        await stack.enter_async_context(view)
        socket = await stack.enter_async_context(door(own_hall))
        await enter(socket)
        await walks(socket)

    async def run() -> None:
        async with contextlib.AsyncExitStack() as stack:
            await asyncio.gather(*(visitor(stack) for _ in range(100)))

    event_loop.run(run())


@pytest.mark.nightly
def test_the_thrown_out_find_the_door_shut(own_hall):
    """Back at full speed after each kick: soon no socket is opened from there; others are let in."""

    async def run() -> None:
        kicked = 0

        async def again_and_again() -> None:
            nonlocal kicked
            for _ in range(60):
                async with door(own_hall, "127.0.0.2") as attacker:
                    await enter(attacker)
                    await flooded(attacker, FLOODS["goto"])
                    kicked += 1

        with pytest.raises(InvalidStatus) as refusal:
            await again_and_again()
        assert refusal.value.response.status_code == 403
        assert 1 <= kicked < 40
        async with door(own_hall, "127.0.0.3") as other:
            await enter(other)
            await walks(other)

    event_loop.run(run())


async def opened(hall, address: str, forwarded: str) -> int:
    """How many sockets that claim to come from `forwarded` open before one is refused; 500 at most.

    Many at a time: one after another a busy machine opens no more than come back meanwhile."""

    async def opens() -> bool:
        try:
            async with door(hall, address, additional_headers={"X-Forwarded-For": forwarded}):
                return True
        except InvalidStatus:
            return False

    number = 0
    while number < 500:
        came = await asyncio.gather(*(opens() for _ in range(20)))
        number += sum(came)
        if not all(came):
            break
    return number


async def goes_on(hall, address: str, forwarded: str) -> bool:
    """Whether an address whose budget is exhausted gets more under that name than comes back meanwhile."""
    begin = time.monotonic()
    got = await opened(hall, address, forwarded)
    return got > 2 + RATES["socket"].per_second * (time.monotonic() - begin)


@pytest.mark.nightly
def test_forwarded_addresses_count_from_the_named_proxy_alone(small_hall):
    """Whoever exhausts his own budget cannot go on under another name; behind the proxy names are believed."""

    async def run() -> None:
        assert await opened(small_hall, "127.0.0.6", "203.0.113.1") < 500
        assert not await goes_on(small_hall, "127.0.0.6", "203.0.113.2")
        assert await opened(small_hall, "127.0.0.9", "203.0.113.3") < 500
        async with door(
            small_hall, "127.0.0.9", additional_headers={"X-Forwarded-For": "203.0.113.4"}
        ) as socket:
            await socket.send(HELLO)
            await socket.recv()

    event_loop.run(run())


@pytest.mark.nightly
def test_this_machine_is_no_proxy_unless_named(own_hall):
    async def run() -> None:
        assert await opened(own_hall, "127.0.0.1", "203.0.113.1") < 500
        assert not await goes_on(own_hall, "127.0.0.1", "203.0.113.2")

    event_loop.run(run())


def test_who_finds_it_full_sees_his_place_and_comes_in_in_order(small_hall):
    async def run() -> None:
        async with contextlib.AsyncExitStack() as stack:

            async def come():
                socket = await stack.enter_async_context(door(small_hall))
                await socket.send(HELLO)
                return socket

            inside = [await come() for _ in range(3)]
            for socket in inside:
                await hear(socket, "hi")
            waiting = []
            for place in (1, 2, 3):
                waiting.append(await come())
                assert (await hear(waiting[-1], "queue"))["place"] == place
            await waiting[0].send(json.dumps({"t": "goto", "x": 0, "z": 0}))  # waits all the same
            await waiting[1].close()  # gives up
            assert (await hear(waiting[2], "queue"))["place"] == 2
            await inside[0].close()
            await hear(waiting[0], "hi")
            assert (await hear(waiting[2], "queue"))["place"] == 1
            await walks(waiting[0])
            await inside[1].close()
            await hear(waiting[2], "hi")

    event_loop.run(run())


def key_set(socket) -> str:
    found = re.match(r"hall-place=[0-9a-f]{32}", socket.response.headers["Set-Cookie"])
    assert found
    return found.group()


def view(hall, key: str | None = None):
    headers = {"Cookie": key} if key else {}
    return door(hall, path="/", subprotocols=[VISER], additional_headers=headers)


async def shows(socket) -> None:
    """viser's scene comes: this view has begun."""
    async with asyncio.timeout(PATIENCE):
        await socket.recv()


async def shows_nothing(socket) -> None:
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(1):
            await socket.recv()


@pytest.mark.nightly
def test_views_are_for_those_inside(small_hall):
    """Who waits sees nothing, on a socket that is open; who is let in looks at once, though others would take it."""

    async def run() -> None:
        async with contextlib.AsyncExitStack() as stack:
            come, keys = stack.enter_async_context, []
            walkers, views = [], []
            for _ in range(3):
                views.append(await come(view(small_hall)))
                await shows(views[-1])
                keys.append(key_set(views[-1]))
                walkers.append(await come(door(small_hall, additional_headers={"Cookie": keys[-1]})))
                await enter(walkers[-1])
            early = await come(view(small_hall))  # a stranger, and no room
            await shows_nothing(early)
            await views[0].close()
            await shows(early)  # a page that has not said hello yet
            late = await come(door(small_hall, additional_headers={"Cookie": key_set(early)}))
            await late.send(HELLO)
            await hear(late, "queue")
            await asyncio.wait_for(early.wait_closed(), PATIENCE)  # its view is for somebody inside
            assert early.close_code == 1013
            waiting = await come(view(small_hall, key_set(early)))
            await shows_nothing(waiting)
            await waiting.send(
                camera(random.Random(0))
            )  # dropped but for the last, by which viser will know it
            await shows(await come(view(small_hall, keys[0])))  # inside: comes back
            await walkers[1].close()
            await hear(late, "hi")
            await shows(waiting)

    event_loop.run(run())


@pytest.fixture
def hasty_hall(tmp_path):
    """A hall for three that keeps nothing long for those who are not there."""
    hasty = altered(
        "from hall_app.web.sockets import relay, walk",
        "from hall_app.visit import places",
        "walk.KEPT = places.KEPT = 1.0",
        "relay._STRANGERS = 15.0",
    )
    work, content = tmp_path / "work", write_plain_hall(tmp_path / "content")
    with running_hall(content, work, "--visitors", "3", program=hasty) as hall:
        yield hall


async def dismissed(look) -> None:
    await asyncio.wait_for(look.wait_closed(), PATIENCE)
    assert look.close_code == 1013


@pytest.mark.nightly
def test_a_view_ends_with_its_visit(hasty_hall):
    """Whoever comes, looks and leaves again and again leaves no views behind."""

    async def run() -> None:
        for _ in range(4):
            async with view(hasty_hall) as look:
                async with door(hasty_hall, additional_headers={"Cookie": key_set(look)}) as walker:
                    await enter(walker)
                    await shows(look)
                await dismissed(look)  # when its place is not kept any longer

    event_loop.run(run())


@pytest.mark.nightly
def test_a_view_without_a_visit_ends(hasty_hall):
    async def run() -> None:
        async with view(hasty_hall) as look:
            await shows(look)
            await dismissed(look)

    event_loop.run(run())


@pytest.mark.nightly
def test_a_socket_that_is_closed_is_told_why(tmp_path):
    impatient = altered("from hall_app.web.sockets import walk", "walk._HELLO_WITHIN = 5.0")

    async def told(hall, *said: bytes) -> tuple[int, str]:
        async with door(hall) as walker:
            for message in said:
                await walker.send(message)
            with pytest.raises(ConnectionClosed) as ended:
                await hear(walker, "none")
        assert ended.value.rcvd is not None
        return ended.value.rcvd.code, ended.value.rcvd.reason

    async def run(hall) -> None:
        assert await told(hall) == (1008, "no hello")
        assert await told(hall, b"bytes") == (1003, "text only")

    content = write_plain_hall(tmp_path / "content")
    with running_hall(content, tmp_path / "work", program=impatient) as hall:
        event_loop.run(run(hall))


@pytest.mark.nightly
def test_who_waits_and_loads_the_page_again_keeps_his_place(full_hall):
    key = asked(full_hall, "/")[1]["Set-Cookie"].partition(";")[0]

    async def run() -> None:
        async with contextlib.AsyncExitStack() as stack:
            come = stack.enter_async_context
            for _ in range(3):
                await enter(await come(door(full_hall)))
            async with door(full_hall, additional_headers={"Cookie": key}) as mine:
                await mine.send(HELLO)
                assert (await hear(mine, "queue"))["place"] == 1
                other = await come(door(full_hall))
                await other.send(HELLO)
                assert (await hear(other, "queue"))["place"] == 2
            again = await come(door(full_hall, additional_headers={"Cookie": key}))
            await again.send(HELLO)
            assert (await hear(again, "queue"))["place"] == 1

    event_loop.run(run())


@pytest.mark.nightly
def test_a_page_on_another_line_has_its_place_though_the_first_has_not_ended(full_hall):
    key = asked(full_hall, "/")[1]["Set-Cookie"].partition(";")[0]
    hello = json.dumps(json.loads(HELLO) | {"page": "one page"})

    async def run() -> None:
        async with contextlib.AsyncExitStack() as stack:
            come = stack.enter_async_context
            for _ in range(2):
                await enter(await come(door(full_hall)))
            died = await come(door(full_hall, additional_headers={"Cookie": key}))
            await died.send(hello)
            await hear(died, "hi")
            waiting = await come(door(full_hall))
            await waiting.send(HELLO)
            await hear(waiting, "queue")
            again = await come(door(full_hall, additional_headers={"Cookie": key}))
            await again.send(hello)
            assert json.loads(await again.recv())["t"] == "hi"
            await asyncio.wait_for(died.wait_closed(), PATIENCE)
            await walks(again)

    event_loop.run(run())


def test_waiting_views_are_as_many_as_may_wait():
    """Three look, twelve wait, the next is refused; when one goes, the first who waited begins."""

    async def run() -> None:
        views = Views(Places(3))
        looks = [views.ask(f"browser {n}", f"192.0.2.{n}") for n in range(15)]
        assert [look is not None and look.begins.is_set() for look in looks] == [True] * 3 + [False] * 12
        assert views.ask("one more", "192.0.2.99") is None
        assert looks[0] is not None
        views.leave(looks[0])
        assert [look is not None and look.begins.is_set() for look in looks] == [True] * 4 + [False] * 11
        assert views.ask("one more", "192.0.2.99") is not None

    event_loop.run(run())


def test_no_address_takes_all_the_waiting_of_views():
    async def run() -> None:
        views = Views(Places(100))
        looks = [views.ask(f"browser {n}", "192.0.2.1") for n in range(500)]
        assert sum(look is not None for look in looks) < 100 + 4 * 100
        assert views.ask("another", "192.0.2.2") is not None

    event_loop.run(run())


def test_views_of_one_address_begin_in_turn_and_others_do_not_wait():
    async def run() -> None:
        turns, order = Turns(), []

        async def begin(name: str, address: str) -> None:
            await turns.take(address)
            order.append(name)

        one_address = [asyncio.create_task(begin(f"class {n}", "192.0.2.1")) for n in range(6)]
        await asyncio.sleep(0)
        other = asyncio.create_task(begin("other", "192.0.2.2"))
        one_address[1].cancel()  # hangs up: nobody waits for it
        await asyncio.gather(other, *one_address, return_exceptions=True)
        assert order == ["class 0", "other", "class 2", "class 3", "class 4", "class 5"]

    event_loop.run(run())


def line(hall, address: str) -> sockets.socket:
    """A plain connection that says nothing yet, and takes little at a time."""
    made = sockets.socket()
    made.setsockopt(sockets.SOL_SOCKET, sockets.SO_RCVBUF, 4096)
    made.bind((address, 0))
    made.settimeout(PATIENCE)
    made.connect(("127.0.0.1", hall.port))
    return made


def asked(hall, path: str = "/api/scene", **headers: str):
    """(status, headers, bytes) of a plain request."""
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    request = urllib.request.Request(hall.url + path, headers=named)
    with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
        return answer.status, answer.headers, answer.read()


@pytest.mark.nightly
def test_connections_that_say_nothing_leave_room_for_others(tight_hall):
    """More than there are descriptors, from one address; others are answered while they stand."""
    with contextlib.ExitStack() as stack:
        for _ in range(500):
            stack.enter_context(line(tight_hall, "127.0.0.2"))
        for _ in range(5):
            assert asked(tight_hall)[0] == 200

        async def run() -> None:
            async with door(tight_hall, path="/", subprotocols=[VISER]), door(tight_hall) as socket:
                await enter(socket)
                await walks(socket)

        event_loop.run(run())
    assert "Traceback" not in tight_hall.said(), tight_hall.said()


@pytest.mark.nightly
def test_connections_that_neither_ask_nor_read_are_cut(tight_hall):
    largest = max(re.findall(r"/viser/[0-9a-f]+/viser.js", asked(tight_hall, "/")[2].decode()))
    whole = len(asked(tight_hall, largest)[2])
    with contextlib.ExitStack() as stack:
        silent, half, unread = (stack.enter_context(line(tight_hall, "127.0.0.2")) for _ in range(3))
        half.send(b"GET / HTTP/1.1\r\nHost: 127")
        unread.send(f"GET {largest} HTTP/1.1\r\nHost: hall\r\n\r\n".encode() * 20)
        for late in (silent, half):
            assert late.recv(1) == b""  # within PATIENCE, or it raises
        time.sleep(45.0)
        got = 0
        with contextlib.suppress(ConnectionError):
            while data := unread.recv(1 << 20):
                got += len(data)
        assert 0 < got < 20 * whole
    assert "Traceback" not in tight_hall.said(), tight_hall.said()


def test_the_page_brings_the_key_of_both_sockets(plain_hall):
    """A fresh browser opens both at the same moment: they must not be given a key each."""
    _, first, body = asked(plain_hall, "/", Accept_Encoding="gzip")
    assert re.search(r"hall-place=[0-9a-f]{32}; Path=/; HttpOnly; SameSite=Strict$", first["Set-Cookie"])
    assert "private" in first["Cache-Control"]
    key = first["Set-Cookie"].partition(";")[0]
    _, again, same = asked(plain_hall, "/", Accept_Encoding="gzip", Cookie=key)
    assert again["Set-Cookie"] is None
    assert (again["ETag"], same) == (first["ETag"], body)
    _, other, _ = asked(plain_hall, "/", Cookie="hall-place=made-up")
    assert other["Set-Cookie"].partition(";")[0] not in (key, "hall-place=made-up")

    async def run() -> None:
        headers = {"Cookie": key}
        view = door(plain_hall, path="/", subprotocols=[VISER], additional_headers=headers)
        async with view as looking, door(plain_hall, additional_headers=headers) as walking:
            for socket in (looking, walking):
                assert "Set-Cookie" not in socket.response.headers

    event_loop.run(run())


@pytest.mark.nightly
def test_who_loads_the_page_again_in_a_full_hall_keeps_his_place(small_hall):
    key = asked(small_hall, "/")[1]["Set-Cookie"].partition(";")[0]

    def own():
        return door(small_hall, additional_headers={"Cookie": key})

    async def run() -> None:
        async with contextlib.AsyncExitStack() as stack:
            for _ in range(2):
                await enter(await stack.enter_async_context(door(small_hall)))
            async with own() as mine:
                await enter(mine)
                waiting = await stack.enter_async_context(door(small_hall))
                await waiting.send(HELLO)
                assert (await hear(waiting, "queue"))["place"] == 1
            async with own() as again:
                await again.send(HELLO)
                assert json.loads(await again.recv())["t"] == "hi"
            await hear(waiting, "hi")  # does not come back: a moment later

    event_loop.run(run())


@pytest.mark.nightly
def test_who_was_away_for_long_makes_room_and_may_come_back(tmp_path):
    soon_away = altered(
        "from hall_app.visit import places",
        "from hall_app.web.sockets import walk",
        "places.AWAY, walk._LOOK = 3.0, 0.5",
    )
    content = write_plain_hall(tmp_path / "content")

    async def run(hall) -> None:
        async with door(hall) as away, door(hall) as waiting:
            await enter(away)
            await asyncio.sleep(3.5)
            await walks(away)  # nobody waits
            await waiting.send(HELLO)
            await hear(waiting, "hi")
            with pytest.raises(ConnectionClosed) as ended:
                await hear(away, "none")
            assert (ended.value.rcvd.code, ended.value.rcvd.reason) == (1013, "away")
            async with door(hall) as back:
                await back.send(HELLO)
                assert (await hear(back, "queue"))["place"] == 1

    with running_hall(content, tmp_path / "work", "--visitors", "1", program=soon_away) as hall:
        event_loop.run(run(hall))


@pytest.mark.parametrize("option", [["--visitors", "0"], ["--visitors", "many"], ["--proxy", "everybody"]])
def test_odd_limits_are_refused_in_one_line(option, capsys):
    from hall_app.cli import main

    with pytest.raises(SystemExit) as ended:
        main(["serve", *option])
    assert ended.value.code == 2
    assert "give" in capsys.readouterr().err


def test_a_fault_within_a_line_is_told_once_and_a_line_that_ended_never(caplog):
    async def fails() -> None:
        raise KeyError("a model that is not kept")

    async def ends() -> None:
        raise WebSocketDisconnect(1006)

    async def run() -> None:
        for act in (fails, ends, fails):
            await asyncio.wait_for(until_first(act(), asyncio.sleep(PATIENCE)), 5)

    event_loop.run(run())
    assert [record.exc_info[0] for record in caplog.records if record.exc_info] == [KeyError]
