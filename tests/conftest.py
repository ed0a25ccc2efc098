"""Fixtures of every room: running halls, a browser where there is one."""

import contextlib
import itertools
import os
import subprocess
import warnings
from collections import Counter
from pathlib import Path

import pytest
from durations import is_of_the_night
from plain_hall import write_plain_hall
from running_hall import running_hall
from scanned_hall import bake_small, write_scanned_hall

ROOT = Path(__file__).parent.parent
_NUMBERS = itertools.count()


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


def started(pgserver, folder: Path):
    """pgserver waits ten seconds for its server and no longer; asked again it takes the one that starts meanwhile."""
    for _ in range(30):
        with contextlib.suppress(subprocess.TimeoutExpired):
            return pgserver.get_server(folder, cleanup_mode="delete")
    raise AssertionError("PostgreSQL did not start in five minutes")


def pytest_terminal_summary(terminalreporter):
    """Beside the slowest tests the slowest files: what tests share, they wait for together, and on one core."""
    if not terminalreporter.config.option.durations:
        return
    seconds = Counter()
    for reports in terminalreporter.stats.values():
        for report in reports:
            if hasattr(report, "duration"):
                seconds[report.nodeid.partition("::")[0]] += report.duration
    terminalreporter.section(f"slowest files of {seconds.total():.0f} s")
    for name, spent in seconds.most_common(60):
        terminalreporter.write_line(f"{spent:8.1f}s {name}")


# Elsewhere PostgreSQL is of the night.
POSTGRES_BY_DAY = {
    "test_survey_store.py",
    "test_survey_privacy.py",
    "test_people.py",
    "test_bookings.py",
    "test_safekeeping.py",
}


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Before `-m` chooses."""
    for item in items:
        asked, name = getattr(item, "callspec", None), item.nodeid.partition("[")[0]
        if (
            asked and asked.params.get("database") == "postgresql" and item.path.name not in POSTGRES_BY_DAY
        ) or (not item.get_closest_marker("door") and is_of_the_night(name, item.fixturenames)):
            item.add_marker(pytest.mark.nightly)


@pytest.fixture(scope="session")
def postgres(tmp_path_factory):
    """A PostgreSQL server of our own; a function that makes an empty database and returns its URL."""
    pytest.importorskip("psycopg", reason="PostgreSQL's driver is not installed (extra 'test')")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # platformdirs remarks on XDG_RUNTIME_DIR while it is imported
        pgserver = pytest.importorskip("pgserver", reason="no PostgreSQL server for this platform")
    from sqlalchemy import create_engine, make_url, text

    server = started(pgserver, tmp_path_factory.mktemp("postgres"))
    url = make_url(server.get_uri()).set(drivername="postgresql+psycopg")
    engine = create_engine(url, isolation_level="AUTOCOMMIT")

    def fresh() -> str:
        name = f"store_{next(_NUMBERS)}"
        with engine.connect() as connection:
            connection.execute(text(f"CREATE DATABASE {name}"))
        return url.set(database=name).render_as_string(hide_password=False)

    yield fresh
    engine.dispose()
    server.cleanup()


@pytest.fixture(params=["sqlite", pytest.param("postgresql", marks=pytest.mark.slow)])
def database(request, tmp_path):
    """Where a store keeps its answers: a data folder, or the URL of an empty PostgreSQL database."""
    return tmp_path / "data" if request.param == "sqlite" else request.getfixturevalue("postgres")()
