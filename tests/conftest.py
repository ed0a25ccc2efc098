"""Fixtures of every room: running halls, a browser where there is one."""

import os
from pathlib import Path

import pytest
from plain_hall import write_plain_hall
from running_hall import running_hall
from scanned_hall import bake_small, write_scanned_hall

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="session")
def plain_hall(tmp_path_factory):
    """A running hall of plain boxes."""
    work = tmp_path_factory.mktemp("plain")
    with running_hall(write_plain_hall(work / "content"), work) as hall:
        yield hall


@pytest.fixture(scope="session")
def scanned_hall(tmp_path_factory):
    """A running hall that shows a scan, baked with small pictures."""
    work = tmp_path_factory.mktemp("scanned")
    content = write_scanned_hall(work / "content")
    bake_small(content, work / "data")
    with running_hall(content, work) as hall:
        yield hall


@pytest.fixture(scope="session")
def shipped_hall(tmp_path_factory):
    """The hall as it ships, running."""
    with running_hall(ROOT / "assets", tmp_path_factory.mktemp("shipped")) as hall:
        yield hall


@pytest.fixture(scope="session")
def chromium():
    """Headless Chromium with software WebGL; skipped with the reason where there is none."""
    from bench.browser import NoBrowserError, open_browser

    try:
        with open_browser() as browser:
            yield browser
    except NoBrowserError as error:
        if os.environ.get("HALL_BROWSER") == "required":
            pytest.fail(f"browser tests are required: {error}")
        pytest.skip(str(error))
