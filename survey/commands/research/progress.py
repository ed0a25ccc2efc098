"""What a command shows on a terminal while it works; elsewhere nothing."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic

__all__ = ["counted", "described"]

PATIENCE = 2.0  # seconds of work that need no word


@contextmanager
def counted(what: str, total: int) -> Iterator[Callable[[int], object]]:
    """A bar; what it gives is called with how many were just done."""
    if not sys.stderr.isatty():
        yield lambda done: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=total)
        yield lambda done: bar.advance(task, done)


@contextmanager
def described() -> Iterator[Callable[[str], object]]:
    """A line for work of unknown length, once it has taken a while; what it gives is called with what is done next."""
    if not sys.stderr.isatty():
        yield lambda text: None
        return
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    begun = monotonic()
    with Progress(*columns, console=Console(stderr=True), transient=True) as line:
        task = line.add_task("", visible=False)
        yield lambda text: line.update(task, description=text, visible=monotonic() - begun > PATIENCE)
