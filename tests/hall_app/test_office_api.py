"""The APIs of the office and of the open hall keep to their own descriptions."""

from __future__ import annotations

import pytest
from office_conformity import PHASES, conform, conform_open
from plain_hall import write_plain_hall
from running_hall import running_hall


def holds(work, examples: int, phases: str) -> None:
    """Every operation is reached: each was done at least once, and whatever else was asked is answered as described."""
    pytest.importorskip("schemathesis", reason="not installed (extra 'test')", exc_type=ImportError)
    status, said, answered = conform(work, examples, phases)
    assert status == 0, said[-6000:]
    assert " generated" in said
    never = {name: dict(tally) for name, tally in answered.items() if not tally[200]}
    assert not never, "operations that were never done"
    broken = {name: dict(tally) for name, tally in answered.items() if max(tally) >= 500}
    assert not broken


def test_the_office_s_api_keeps_to_its_description(quick_hashes, tmp_path):
    holds(tmp_path, 1, "examples,fuzzing")


@pytest.mark.nightly
@pytest.mark.slow
def test_the_office_s_api_keeps_to_its_description_at_length(quick_hashes, tmp_path):
    holds(tmp_path, 60, PHASES)


def open_holds(work, examples: int) -> None:
    """Of what anyone may ask, the survey's answers included; a hall of its own, since answers are stored."""
    pytest.importorskip("schemathesis", reason="not installed (extra 'test')", exc_type=ImportError)
    with running_hall(write_plain_hall(work / "content"), work / "run") as hall:
        status, said = conform_open(hall.url, work / "asked", examples)
        assert "Traceback" not in hall.said()
    assert status == 0, said[-6000:]
    assert " generated" in said


def test_the_open_hall_s_api_keeps_to_its_description(tmp_path):
    open_holds(tmp_path, 2)


@pytest.mark.nightly
@pytest.mark.slow
def test_the_open_hall_s_api_keeps_to_its_description_at_length(tmp_path):
    open_holds(tmp_path, 60)
