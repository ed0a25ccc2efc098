"""A page in a running hall of plain boxes."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from bench.browser import enter
from plain_hall import write_plain_hall
from running_hall import running_hall

__all__ = ["plain_page"]


@contextmanager
def plain_page(chromium, work: Path, box: Callable[[Path], None] | None = None) -> Iterator[Any]:
    """A page of 480 x 320 in a plain hall, its folder the `content_folder`; box writes another exhibit."""
    content = write_plain_hall(work / "content")
    if box is not None:
        box(content / "exhibits/box/box.glb")
    with running_hall(content, work) as hall:
        page = chromium.new_page(viewport={"width": 480, "height": 320})
        page.content_folder = hall.content
        enter(page, f"{hall.url}/?lang=en")
        yield page
        page.close()
