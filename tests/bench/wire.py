"""A wire on 127.0.0.1 that counts what it carries, can hold every byte for a while and can be narrow, both ways."""

import asyncio
import contextlib
import mmap
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

CHUNK = 4 << 10  # [bytes] connections take turns on a narrow wire by so much …
AHEAD = 4  # … and each may have so many chunks wait, so that a busy machine does not leave the wire empty


class _Way:
    """One direction of the wire, shared by all connections: so many bits a second, 0 for no limit."""

    def __init__(self, bits: float) -> None:
        self.bits, self._free = bits, 0.0

    def through(self, size: int) -> float:
        """When `size` bytes that come now have gone in; who comes first goes first."""
        now = asyncio.get_running_loop().time()
        if not self.bits:
            return now
        self._free = max(now, self._free) + 8 * size / self.bits
        return self._free


async def _hold(
    reader: asyncio.StreamReader, writer: asyncio.StreamWriter, seconds: float, way: _Way, counter: mmap.mmap
) -> None:
    """Copy what is read after `seconds`, in order; several chunks may be under way."""
    loop = asyncio.get_running_loop()
    waiting: asyncio.Queue[tuple[float, bytes]] = asyncio.Queue()

    async def take() -> None:
        while data := await reader.read(CHUNK if way.bits else 1 << 16):
            through = way.through(len(data))
            waiting.put_nowait((through + seconds, data))
            if way.bits:
                await asyncio.sleep(through - loop.time() - 8 * AHEAD * CHUNK / way.bits)
        waiting.put_nowait((loop.time() + seconds, b""))

    async def give() -> None:
        while True:
            due, data = await waiting.get()
            await asyncio.sleep(max(0.0, due - loop.time()))
            if not data:
                break
            counter[:8] = (int.from_bytes(counter[:8], "little") + len(data)).to_bytes(8, "little")
            writer.write(data)
            await writer.drain()
        writer.close()

    with contextlib.suppress(ConnectionError):
        await asyncio.gather(take(), give())


async def _serve(port: int, round_trip: float, bits: float, tally: Path) -> None:
    with tally.open("r+b") as file:
        counter = mmap.mmap(file.fileno(), 8)

    writers: set[asyncio.StreamWriter] = set()
    up, down = _Way(bits), _Way(bits)

    async def connect(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await asyncio.sleep(round_trip)  # what TCP takes before the first byte may go
        far_reader, far_writer = await asyncio.open_connection("127.0.0.1", port)
        writers.update((writer, far_writer))
        ways = ((reader, far_writer, up), (far_reader, writer, down))
        await asyncio.gather(
            *(_hold(source, sink, round_trip / 2, way, counter) for source, sink, way in ways)
        )
        writers.difference_update((writer, far_writer))

    def cut() -> None:
        for writer in tuple(writers):
            writer.transport.abort()

    asyncio.get_running_loop().add_signal_handler(signal.SIGUSR1, cut)
    server = await asyncio.start_server(connect, "127.0.0.1", 0)
    sys.stdout.write(f"{server.sockets[0].getsockname()[1]}\n")
    sys.stdout.flush()
    await server.serve_forever()


@dataclass(frozen=True)
class Wire:
    """Where it begins, where it keeps count, the process that holds it."""

    port: int
    tally: Path
    process: subprocess.Popen

    def cut(self) -> None:
        """Break every connection; new ones may come."""
        self.process.send_signal(signal.SIGUSR1)

    def carried(self) -> int:
        """Bytes so far, both directions."""
        return int.from_bytes(self.tally.read_bytes(), "little")


@contextlib.contextmanager
def wire(port: int, round_trip: float = 0.0, bits: float = 0.0) -> Iterator[Wire]:
    """A port that leads to 127.0.0.1:`port`, in a process of its own.

    round_trip: latency added [s]; bits: what each direction carries a second, all connections together, 0: no limit.
    """
    with tempfile.TemporaryDirectory() as folder:
        tally = Path(folder) / "tally"
        tally.write_bytes(bytes(8))
        command = [sys.executable, __file__, str(port), str(round_trip), str(bits), str(tally)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            try:
                yield Wire(int(process.stdout.readline()), tally, process)
            finally:
                process.kill()


if __name__ == "__main__":
    asyncio.run(_serve(int(sys.argv[1]), float(sys.argv[2]), float(sys.argv[3]), Path(sys.argv[4])))
