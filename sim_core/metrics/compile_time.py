"""How long machine code takes to be made, or fetched from its cache, while something else is timed."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import get_ident
from time import perf_counter

from numba.core.event import Event, Listener, install_listener

__all__ = ["CompileClock", "compile_clock"]

LONG = 10.0  # [s] of compiling after which it is told


class CompileClock(Listener):
    """Counts the seconds [s] that this thread spends on compiling; `tell` is called once when they pass ten."""

    def __init__(self, tell: Callable[[], None] | None = None) -> None:
        self.seconds = 0.0
        self._tell = tell
        self._thread, self._depth, self._begin = get_ident(), 0, 0.0

    def on_start(self, event: Event) -> None:
        """The compiler is entered (again, from within, for what a kernel calls)."""
        if get_ident() != self._thread:
            return
        if self._depth == 0:
            self._begin = perf_counter()
        self._depth += 1

    def on_end(self, event: Event) -> None:
        """The compiler is left."""
        if get_ident() != self._thread or self._depth == 0:
            return
        self._depth -= 1
        if self._tell and self.seconds + perf_counter() - self._begin > LONG:
            self._tell()
            self._tell = None
        if self._depth == 0:
            self.seconds += perf_counter() - self._begin


@contextmanager
def compile_clock(tell: Callable[[], None] | None = None) -> Iterator[CompileClock]:
    """A `CompileClock` that runs within the context; contexts may lie in each other."""
    with install_listener("numba:compiler_lock", CompileClock(tell)) as clock:
        yield clock
