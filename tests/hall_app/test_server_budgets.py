"""Budgets and places: values with a clock in the hand, no server."""

import asyncio
import random

import event_loop
import pytest

from hall_app.visit import AWAY, KEPT, Places
from hall_app.web.limits import (
    ASKS_WITHIN,
    MOST_OF_ONE_ADDRESS,
    MOST_SILENT,
    MOST_SILENT_IN_ALL,
    PORTION,
    RATES,
    RELAY,
    TAKES_WITHIN,
    WALK,
    Addresses,
    Allowance,
    Bucket,
    Doorkeeper,
    OpenLines,
    Portions,
    Rate,
    Shares,
    address_of,
    descriptors,
    name_of,
)


def test_a_bucket_holds_its_burst_and_fills_evenly():
    rate = Rate(burst=3, per_second=2)
    bucket = Bucket(3, 0.0).less(3)
    assert bucket.filled(rate, 0.5).left == 1
    assert bucket.filled(rate, 99.0).left == 3
    assert bucket.filled(rate, -5.0) == Bucket(0, 0.0)


def play(hertz: int, seconds: float, rng: random.Random, stalls: bool) -> set[str]:
    """Verdicts on a fast human: walks on end, clicks the map, opens and closes; a line that stands still at times."""
    allowance, said, waiting, until = Allowance(WALK, 0.0), set(), [], 0.0
    for batch in range(int(30 * seconds)):
        now = batch / 30
        waiting.append(("inputs", hertz / 30))
        if batch % 15 == 0:
            waiting.append(("goto", 1))  # twice a second
        if batch % 45 == 0:
            waiting += [("open", 1), ("close", 1)]
        if stalls and now > until + 4.0 and rng.random() < 0.005:
            until = now + 4.0
        if now < until:
            continue
        for kind, amount in waiting:
            said |= {allowance.take("messages", now), allowance.take("bytes", now, 70 * amount)}
            said.add(allowance.take(kind, now, amount))
        waiting.clear()
    return said


@pytest.mark.parametrize("hertz", [60, 240, 480])
@pytest.mark.parametrize("stalls", [False, True])
def test_honest_play_is_never_touched(hertz, stalls):
    assert play(hertz, 600, random.Random(hertz), stalls) == {"serve"}


def test_honest_keys_where_the_server_walks_are_never_touched():
    allowance = Allowance(WALK, 0.0)
    said = {allowance.take(kind, n / 30) for n in range(30 * 600) for kind in ("messages", "keys")}
    assert said == {"serve"}


def test_an_honest_view_is_never_touched():
    """viser's client tells its camera 50 times a second; a hurried visitor clicks three times a second."""
    allowance, said = Allowance(RELAY, 0.0), set()
    for n in range(50 * 600):
        now = n / 50
        said |= {allowance.take("messages", now), allowance.take("bytes", now, 300)}
        if n % 17 == 0:
            said.add(allowance.take("click", now))
    assert said == {"serve"}


@pytest.mark.parametrize("rates", [WALK, RELAY])
def test_whoever_goes_on_is_shown_out(rates):
    """Of each kind: the burst is served, some more is dropped, then it is enough; a pause mends nothing for a flood."""
    for kind, rate in rates.items():
        allowance, amount = Allowance(rates, 0.0), max(1.0, rate.burst / 1000)
        said = [allowance.take(kind, n / 8000, amount) for n in range(20_000)]
        first = said.index("leave")
        assert "drop" in said[:first]
        assert said[:first].count("serve") * amount <= rate.burst + rate.per_second * first / 8000 + amount


def test_dropped_now_and_then_is_forgiven():
    allowance = Allowance(WALK, 0.0)
    for n in range(100):
        said = {allowance.take("goto", n * 20.0) for _ in range(30)}
        assert said == {"serve", "drop"}


class Clock:
    now = 0.0

    def __call__(self) -> float:
        return self.now


def test_a_class_comes_in_at_once_and_a_flood_does_not():
    addresses = Addresses(Clock())
    for kind, each in {"line": 8, "request": 80, "attempt": 4, "socket": 2}.items():
        assert all(addresses.take(kind, "10.0.0.7") for _ in range(100 * each)), kind
        assert not all(addresses.take(kind, "10.0.0.7") for _ in range(int(RATES[kind].burst))), kind
    assert addresses.take("socket", "10.0.0.8")


def test_the_thrown_out_come_back_slowly():
    addresses = Addresses(clock := Clock())
    for _ in range(50):
        addresses.throw_out("10.0.0.7")
    assert not addresses.take("socket", "10.0.0.7")
    assert addresses.take("socket", "10.0.0.8")
    clock.now += 2 * RATES["socket"].burst / RATES["socket"].per_second
    assert addresses.take("socket", "10.0.0.7")  # and is forgiven in the end


def test_an_ipv6_customer_is_one_address():
    addresses = Addresses(Clock())
    served = [addresses.take("socket", f"2001:db8:0:1::{n:x}") for n in range(1000)]
    assert served.count(True) == RATES["socket"].burst
    assert addresses.take("socket", "2001:db8:0:2::1")
    assert addresses.take("socket", "fe80::1%eth0")
    assert addresses.take("socket", "no:address")


def test_many_addresses_cost_no_memory_without_end():
    addresses = Addresses(Clock())
    for n in range(20_000):
        addresses.take("socket", f"10.{n >> 16}.{n >> 8 & 255}.{n & 255}")
    assert len(addresses._buckets) <= 4096


def test_silent_sockets_are_counted_and_given_back_once():
    addresses = Addresses(Clock())
    open_now = [addresses.silent("10.0.0.7") for _ in range(MOST_SILENT)]
    assert all(open_now)
    assert addresses.silent("10.0.0.7") is None
    assert addresses.silent("10.0.0.8") is not None
    open_now[0].end()
    open_now[0].end()
    assert addresses.silent("10.0.0.7") is not None
    assert addresses.silent("10.0.0.7") is None


def test_places_are_given_in_the_order_of_coming():
    places = Places(2)
    tickets = [places.ask(f"k{n}", "here") for n in range(6)]
    assert [t.inside for t in tickets] == [True, True] + [False] * 4
    assert [t.place for t in tickets] == [0, 0, 1, 2, 3, 4]
    tickets[3].leave()  # gave up waiting
    assert [t.place for t in tickets] == [0, 0, 1, 2, 2, 3]
    tickets[0].leave()
    assert tickets[2].inside
    assert (tickets[4].place, tickets[5].place) == (1, 2)
    tickets[0].leave()  # a second time changes nothing
    assert len(places) == 2
    for ticket in tickets:
        ticket.leave()
    assert len(places) == 0
    assert not any(places.inside_with(f"k{n}") for n in range(6))


def test_the_queue_is_bounded_and_nobody_fills_it_alone():
    places = Places(100)
    tickets = [places.ask("k", f"10.0.0.{n}") for n in range(100)]
    alone = [places.ask("k", "10.0.1.1") for n in range(400)]
    assert alone.count(None) >= 200
    others = [places.ask("k", f"10.0.2.{n}") for n in range(400)]
    assert None not in others[:100]
    assert None in others
    assert all(tickets)


def test_a_key_waits_only_while_none_of_its_pages_is_inside():
    places = Places(1)
    first, second = places.ask("a", "here"), places.ask("b", "here")
    assert (places.inside_with("a"), places.waits("a"), places.waits("b")) == (1, False, True)
    first.leave()
    assert second.inside
    assert (places.inside_with("a"), places.inside_with("b"), places.waits("b")) == (0, 1, False)


def test_requests_beyond_an_addresss_budget_are_refused_and_no_others():
    async def app(scope, receive, send):
        await send({"type": "http.response.start", "status": 200, "headers": []})

    async def asked(keeper: Doorkeeper, address: str, kind: str) -> object:
        said = []

        async def send(message):
            said.append(message)

        await keeper({"type": kind, "client": (address, 1)}, None, send)
        return said[0].get("status", said[0]["type"])

    keeper = Doorkeeper(app, addresses := Addresses(Clock()))
    while addresses.take("request", "10.0.0.7") and addresses.take("attempt", "10.0.0.8"):
        pass
    while addresses.take("request", "10.0.0.7"):
        pass

    async def run() -> None:
        assert await asked(keeper, "10.0.0.7", "http") == 429
        assert await asked(keeper, "10.0.0.8", "websocket") == "websocket.close"
        assert await asked(keeper, "10.0.0.9", "http") == 200
        assert await asked(keeper, "10.0.0.9", "websocket") == 200

    event_loop.run(run())


def work(shares: Shares, clock: Clock, done: list[str], name: str, seconds: float):
    """A piece of work of an address that takes its time."""

    async def piece() -> None:
        await shares.turn(name)
        clock.now += seconds
        done.append(name)

    return piece()


def test_whoever_asks_for_little_waits_for_a_few_pieces_of_whoever_asks_for_much():
    async def run() -> None:
        shares, done = Shares(clock := Clock()), []
        flood = [asyncio.ensure_future(work(shares, clock, done, "much", 0.002)) for _ in range(300)]
        while len(done) < 20:
            await asyncio.sleep(0)
        before = len(done)
        await work(shares, clock, done, "little", 0.0002)
        assert len(done) - before <= 4
        await asyncio.gather(*flood)
        assert done.count("much") == 300

    event_loop.run(run())


def test_time_is_shared_and_not_pieces():
    async def run() -> None:
        shares, done = Shares(clock := Clock()), []
        pieces = [work(shares, clock, done, "slow", 0.004) for _ in range(100)]
        pieces += [work(shares, clock, done, "quick", 0.001) for _ in range(100)]
        await asyncio.gather(*pieces)
        last = max(n for n, name in enumerate(done) if name == "quick")
        assert done[:last].count("slow") <= 40  # a quarter as many, and where it begins

    event_loop.run(run())


def test_whoever_gives_up_waiting_holds_nobody_up():
    async def run() -> None:
        shares, done = Shares(clock := Clock()), []
        pieces = [asyncio.ensure_future(work(shares, clock, done, "here", 0.001)) for _ in range(10)]
        await asyncio.sleep(0)
        for piece in pieces[3:]:
            piece.cancel()
        await asyncio.gather(*pieces, return_exceptions=True)
        await work(shares, clock, done, "here", 0.001)
        assert 1 <= len(done) <= 4

    event_loop.run(run())


def test_penalties_outlive_any_number_of_other_addresses():
    addresses = Addresses(Clock())
    for _ in range(50):
        addresses.throw_out("2001:db8::1")
    while addresses.take("attempt", "2001:db8::1"):
        pass
    for n in range(20_000):
        addresses.take("socket", f"2001:db8:{n >> 16 & 65535:x}:{n & 65535 | 1:x}::1")
    assert not addresses.take("socket", "2001:db8::1")
    assert not addresses.take("attempt", "2001:db8::1")
    assert len(addresses._buckets) <= 4200


def test_where_all_places_for_the_silent_are_taken_whoever_has_most_loses_the_oldest():
    addresses, thrown_out = Addresses(Clock()), []
    for n in range(MOST_SILENT_IN_ALL):
        silent = addresses.silent(f"10.0.0.{n * 6 // MOST_SILENT_IN_ALL}")
        silent.throw_out = lambda n=n: thrown_out.append(n)
    others = [addresses.silent(f"10.0.1.{n}") for n in range(120)]
    assert None not in others
    assert len(thrown_out) == 120
    first = {n * 6 // MOST_SILENT_IN_ALL: n for n in reversed(range(MOST_SILENT_IN_ALL))}
    assert set(first.values()) <= set(
        thrown_out
    )  # every attacker lost his oldest, and none more than the others
    assert max(thrown_out) < MOST_SILENT_IN_ALL
    assert all(n - first[n * 6 // MOST_SILENT_IN_ALL] < 22 for n in thrown_out)


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("10.0.0.7", "10.0.0.7"),
        ("10.0.0.7:5123", "10.0.0.7"),
        ("::ffff:10.0.0.7", "10.0.0.7"),
        ("::ffff:a00:7", "10.0.0.7"),
        ("[::ffff:10.0.0.7]:443", "10.0.0.7"),
        ("2001:db8::7", "2001:db8::/64"),
        ("[2001:db8::7]", "2001:db8::/64"),
        ("[2001:db8::7]:443", "2001:db8::/64"),
        ("fe80::1%eth0", "fe80::/64"),
        ("2001:db8::/64", "2001:db8::/64"),
        ("no address", "no address"),
        ("", ""),
    ],
)
def test_an_address_has_one_name_however_it_is_written(written, name):
    assert name_of(written) == name
    assert address_of({"client": (written, 1)}) == name


class Wire:
    """A transport that remembers how it ended."""

    cut, unsent = False, 0

    def abort(self) -> None:
        self.cut = True

    def get_write_buffer_size(self) -> int:
        return self.unsent


def open_wires(lines: OpenLines, addresses: list[str], clock: Clock) -> list[tuple[Wire, object]]:
    opened = []
    for address in addresses:
        clock.now += 0.001
        opened.append((wire := Wire(), lines.come(wire, address)))
    return opened


def test_where_no_connection_is_left_whoever_has_most_loses_the_oldest_idle_one():
    lines = OpenLines(20, clock := Clock())
    other = open_wires(lines, ["10.0.0.8"] * 3, clock)
    attacker = open_wires(lines, ["10.0.0.7"] * 17, clock)
    attacker[0][1].asked()  # is being answered
    (wire, came), *_ = open_wires(lines, ["10.0.0.9"], clock)
    assert came is not None
    assert len(lines) == 20
    assert [wire.cut for wire, _ in attacker] == [False, True] + [False] * 15
    assert not any(wire.cut for wire, _ in other)
    for _, line in [*attacker, *other, (wire, came)]:
        line.asked()
    refused, nothing = open_wires(lines, ["10.0.0.9"], clock)[0]
    assert refused.cut  # nobody idles
    assert nothing is None
    other[0][1].end()
    other[0][1].end()
    assert len(lines) == 19
    assert open_wires(lines, ["10.0.0.9"], clock)[0][1] is not None


def test_one_address_has_its_share_of_the_connections_and_a_proxy_has_no_limit():
    lines = OpenLines(100_000, clock := Clock())
    wires = open_wires(lines, ["2001:db8::1", "2001:db8::2"] * MOST_OF_ONE_ADDRESS, clock)
    assert len(lines) == MOST_OF_ONE_ADDRESS
    assert [wire.cut for wire, _ in wires] == [True] * MOST_OF_ONE_ADDRESS + [False] * MOST_OF_ONE_ADDRESS
    assert all(lines.come(Wire(), "10.0.0.9", proxy=True) for _ in range(2 * MOST_OF_ONE_ADDRESS))


def test_connections_that_neither_ask_nor_take_are_cut():
    lines = OpenLines(100, clock := Clock())
    (silent, _), (slow, reading), (stuck, waiting), (socket, upgraded) = open_wires(
        lines, ["10.0.0.7"] * 4, clock
    )
    for line in (reading, waiting, upgraded):
        line.asked()
    reading.answered()  # said, and not yet taken
    slow.unsent = stuck.unsent = 100_000
    for _ in range(60):
        clock.now += 1.0
        slow.unsent -= 10
        lines.sweep()
        for wire, within in ((silent, ASKS_WITHIN), (stuck, TAKES_WITHIN)):
            assert not wire.cut or clock.now > within
            assert wire.cut or clock.now < within + 2
    assert not slow.cut
    assert not socket.cut
    slow.unsent = 0
    clock.now += ASKS_WITHIN - 1
    lines.sweep()
    assert not slow.cut
    clock.now += 2
    lines.sweep()
    assert slow.cut
    assert len(lines) == 1


def test_descriptors_are_for_connections_and_too_few_are_told():
    for limit, visitors in [(256, 3), (1024, 100), (65_536, 100), (65_536, 2000)]:
        most = descriptors.connections(limit, visitors)
        assert 16 <= most <= limit - 2 * visitors - 64
    assert descriptors.shortage(65_536, 100) is None
    assert "ulimit -n" in (descriptors.shortage(1024, 100) or "")
    assert descriptors.connections(65_536, 100) >= 100 * (2 + 6 + 4)


@pytest.mark.parametrize("size", [0, 10, PORTION, PORTION + 1, 5 * PORTION])
def test_large_answers_go_out_in_portions_and_whole(size):
    body, said = bytes(range(256)) * (size // 256) + b"x" * (size % 256), []

    async def app(scope, receive, send):
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": body})

    async def send(message):
        said.append(message)

    event_loop.run(Portions(app)({"type": "http"}, None, send))
    assert b"".join(message["body"] for message in said[1:]) == body
    assert max(len(message["body"]) for message in said[1:]) <= PORTION
    assert [message.get("more_body", False) for message in said[1:]] == [True] * (len(said) - 2) + [False]


def test_whoever_comes_back_in_a_moment_finds_his_place():
    places = Places(2, clock := Clock())
    first, second, waiting = places.ask("a", "here"), places.ask("b", "here"), places.ask("c", "here")
    first.step_out()
    assert not waiting.inside  # kept
    assert places.inside_with("a") == 1
    clock.now += KEPT - 1
    places.expire()
    again = places.ask("a", "here")
    assert again.inside
    assert len(places) == 2
    again.step_out()
    clock.now += KEPT
    places.expire()
    assert waiting.inside
    assert not places.ask("a", "here").inside  # too late
    second.leave()  # not kept
    assert len(places) == 2
    for n in range(5):
        clock.now += 2 * KEPT
        places.expire()
        assert len(places) == 2, n


def test_a_page_that_waits_takes_the_place_of_the_one_that_was_lost():
    """The line broke, and the page was back before the hall knew."""
    places = Places(1, Clock())
    lost, earlier, back = places.ask("a", "here"), places.ask("b", "here"), places.ask("a", "here")
    assert (earlier.place, back.place) == (1, 2)
    lost.step_out()
    assert back.inside
    assert (earlier.inside, earlier.place) == (False, 1)
    back.leave()
    assert earlier.inside
    waiting = places.ask("c", "here")
    waiting.step_out()  # its place is kept, and not given
    earlier.leave()
    assert len(places) == 0


def test_whoever_loads_the_page_again_in_the_queue_is_where_he_was():
    places = Places(1, clock := Clock())
    inside, first, second = (places.ask(key, "here") for key in "abc")
    first.step_out()
    clock.now += KEPT - 1
    assert second.place == 2
    again = places.ask("b", "there")
    assert (again.place, second.place) == (1, 2)
    again.step_out()
    inside.leave()
    assert second.inside  # whoever is there goes before whoever is not
    late = places.ask("b", "there")
    assert (late.inside, late.place) == (False, 1)
    late.step_out()
    clock.now += KEPT
    places.expire()
    assert places.ask("d", "here").place == 1
    assert not places.waits("b")


def test_a_page_whose_line_died_has_its_place_on_the_next_one():
    """No word came that the old line had ended (Wi-Fi): the hall would hold it for inside for most of a minute."""
    places = Places(1, Clock())
    died, waiting = places.ask("a", "here", "page 1"), places.ask("b", "here", "page 2")
    other_tab = places.ask("a", "here", "page 3")
    assert (other_tab.inside, other_tab.place) == (False, 2)
    somebody = places.ask("c", "here", "page 1")  # another browser, whatever it says of itself
    assert (somebody.inside, died.given_up.is_set()) == (False, False)
    again = places.ask("a", "elsewhere", "page 1")
    assert again.inside
    assert died.given_up.is_set()
    died.leave()  # noticed at last
    assert (len(places), places.inside_with("a"), waiting.place) == (1, 1, 1)
    waiting_again = places.ask("b", "here", "page 2")
    assert (waiting_again.place, other_tab.place) == (1, 2)
    waiting.step_out()
    again.leave()
    assert waiting_again.inside


def test_who_was_away_for_long_gives_his_place_to_who_waits():
    places = Places(4, clock := Clock())
    inside = [places.ask(key, address) for key, address in [("a", "x"), ("b", "y"), ("c", "y"), ("d", "z")]]
    clock.now += AWAY - 1
    inside[3].here()
    clock.now += 2
    places.give_away()
    assert not any(ticket.given_up.is_set() for ticket in inside)  # nobody waits
    waiting = places.ask("e", "w")
    for _ in range(3):  # one is asked for one who waits, of the address with most places
        places.give_away()
    assert [ticket.given_up.is_set() for ticket in inside] == [False, True, False, False]
    inside[1].leave()
    assert waiting.inside
    more = [places.ask(key, "w") for key in "fgh"]
    places.give_away()
    assert [ticket.given_up.is_set() for ticket in inside] == [True, True, True, False]
    assert not waiting.given_up.is_set()  # came in just now
    assert not any(ticket.given_up.is_set() for ticket in more)
