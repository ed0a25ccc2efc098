"""The office's API keeps to its own description."""

from __future__ import annotations

import pytest
from office_conformity import conform


def holds(counter, tmp_path, examples: int) -> None:
    pytest.importorskip("schemathesis", reason="not installed (extra 'test')", exc_type=ImportError)
    status, said = conform(counter, tmp_path, examples)
    assert status == 0, said[-6000:]
    assert " generated" in said


def test_the_office_s_api_keeps_to_its_description(counter, tmp_path):
    holds(counter, tmp_path, 2)


@pytest.mark.nightly
@pytest.mark.slow
def test_the_office_s_api_keeps_to_its_description_at_length(counter, tmp_path):
    holds(counter, tmp_path, 60)
