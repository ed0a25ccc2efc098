from __future__ import annotations

from types import SimpleNamespace

import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient
from survey_samples import ASSETS

import survey


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
