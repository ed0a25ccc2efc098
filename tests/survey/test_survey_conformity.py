"""The API against its own description, by schemathesis; the full number of examples runs in `survey bench`."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import pytest

EXAMPLES = 40


@pytest.mark.nightly
@pytest.mark.slow
def test_the_api_keeps_to_its_description(tmp_path, monkeypatch):
    pytest.importorskip("schemathesis", reason="not installed (extra 'test')", exc_type=ImportError)
    monkeypatch.syspath_prepend(str(Path(__file__).parents[1] / "bench"))
    conform = importlib.import_module("survey_conformity").conform

    found = conform(tmp_path, EXAMPLES)
    assert found["failures"] == 0
    assert found["cases"] > 10 * EXAMPLES
    assert found["answers_stored"] > 0
    sys.modules.pop("survey_conformity")
