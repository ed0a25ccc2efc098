"""What models are made of and no visitor is handed: scans, and the files beside them that belong to them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from hall_app.content.bakes.inputs import scan_files
from hall_app.content.files import exhibit_files
from hall_app.content.folder import Content, Exhibit
from hall_app.content.views.markdown import pictures_in

__all__ = ["is_source"]


def is_source(content: Content, full: Path) -> bool:
    """Whether a resolved path is a scan's and is shown by no table and no text: such files are large, and whoever owns
    them may not want them taken."""
    return any(full == path.resolve() for path in _scans(content)) and not any(
        full == path.resolve() for exhibit in content.exhibits for path in _shown(exhibit)
    )


def _scans(content: Content) -> Iterator[Path]:
    for exhibit in content.exhibits:
        if exhibit.file.scan is not None:
            with suppress(OSError):
                yield from scan_files(content.folder, exhibit.folder, exhibit.file.scan)


def _shown(exhibit: Exhibit) -> Iterator[Path]:
    for key, path in exhibit_files(exhibit.file):
        if key != "scan":
            yield exhibit.folder / path
    for text in (exhibit.text_zh, exhibit.text_en):
        yield from (exhibit.folder / path for path in pictures_in(text))
