from __future__ import annotations

import contextlib
import itertools
import subprocess
import warnings
from pathlib import Path
from types import SimpleNamespace

import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient
from survey_samples import ASSETS

import survey

_NUMBERS = itertools.count()


def started(pgserver, folder: Path):
    """pgserver waits ten seconds for its server and no longer; asked again it takes the one that starts meanwhile."""
    for _ in range(30):
        with contextlib.suppress(subprocess.TimeoutExpired):
            return pgserver.get_server(folder, cleanup_mode="delete")
    raise AssertionError("PostgreSQL did not start in five minutes")


POSTGRES_BY_DAY = {"test_survey_store.py", "test_survey_privacy.py"}  # elsewhere PostgreSQL is of the night


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    for item in items:
        asked = getattr(item, "callspec", None)
        if asked and asked.params.get("database") == "postgresql" and item.path.name not in POSTGRES_BY_DAY:
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
        name = f"survey_{next(_NUMBERS)}"
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


@pytest.fixture
def hall(database):
    """A web application with the survey mounted under a prefix-free path, and what one needs to talk to it."""
    app = FastAPI()
    mounted = survey.mount(app, content=ASSETS, data=database)
    with TestClient(app, raise_server_exceptions=False) as client:
        yield SimpleNamespace(
            client=client,
            app=app,
            mounted=mounted,
            store=mounted.store,
            garment=mounted.questionnaires["garment"],
            url="/api/v1/questionnaires/garment/submissions",
            data=database,
        )
    mounted.close()
