"""A wire on 127.0.0.1 that counts what it carries and can hold every byte for a while, in both directions."""

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


async def _hold(
    reader: asyncio.StreamReader, writer: asyncio.StreamWriter, seconds: float, counter: mmap.mmap
) -> None:
    """Copy what is read after `seconds`, in order; several chunks may be under way."""
    loop = asyncio.get_running_loop()
    waiting: asyncio.Queue[tuple[float, bytes]] = asyncio.Queue()

    async def take() -> None:
        while data := await reader.read(1 << 16):
            waiting.put_nowait((loop.time() + seconds, data))
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


async def _serve(port: int, round_trip: float, tally: Path) -> None:
    with tally.open("r+b") as file:
        counter = mmap.mmap(file.fileno(), 8)

    writers: set[asyncio.StreamWriter] = set()

    async def connect(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        far_reader, far_writer = await asyncio.open_connection("127.0.0.1", port)
        writers.update((writer, far_writer))
        ways = ((reader, far_writer), (far_reader, writer))
        await asyncio.gather(*(_hold(source, sink, round_trip / 2, counter) for source, sink in ways))
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
def wire(port: int, round_trip: float = 0.0) -> Iterator[Wire]:
    """A port that leads to 127.0.0.1:`port` with `round_trip` [s] of added latency, in a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        tally = Path(folder) / "tally"
        tally.write_bytes(bytes(8))
        command = [sys.executable, __file__, str(port), str(round_trip), str(tally)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            try:
                yield Wire(int(process.stdout.readline()), tally, process)
            finally:
                process.kill()


if __name__ == "__main__":
    asyncio.run(_serve(int(sys.argv[1]), float(sys.argv[2]), Path(sys.argv[3])))
