"""tests/machines.py finds the test that depends on the machine, and says where it failed."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

MACHINES = Path(__file__).with_name("machines.py")

ODD = """
import os

def test_of_any_machine():
    assert 1 + 1 == 2

def test_of_one_machine():
    assert os.environ.get("NUMBA_CPU_NAME") != "generic" or "OPENBLAS_CORETYPE" in os.environ
"""


def told(*words: object) -> subprocess.CompletedProcess[str]:
    """What it says where the environment asks for a machine already, as a developer's may."""
    env = os.environ | {"OPENBLAS_CORETYPE": "Prescott"}
    command = [sys.executable, MACHINES, *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, check=False, env=env)


@pytest.mark.nightly
@pytest.mark.slow
def test_a_test_that_depends_on_the_machine_is_named_with_machine_and_round(tmp_path):
    (tmp_path / "test_odd.py").write_text(ODD)
    done = told(
        *("--only", "generic", "oldest", "--times", 2, "--beside", "--logs", tmp_path / "logs"),
        *("--", "-n", 0, "-p", "no:cacheprovider", "--rootdir", tmp_path, tmp_path / "test_odd.py"),
    )
    assert done.returncode == 1, done.stderr
    rows = [line.split() for line in done.stdout.splitlines()]
    assert [row[:5] for row in rows[1:5]] == [
        ["generic", "1", "1", "0", "1"],
        ["oldest", "1", "2", "0", "0"],
        ["generic", "2", "1", "0", "1"],
        ["oldest", "2", "2", "0", "0"],
    ]
    failed = [line for line in done.stdout.splitlines() if line.startswith("FAILED")]
    assert len(failed) == 1
    assert "::test_of_one_machine (generic 1, generic 2)" in failed[0]
    assert "assert" in (tmp_path / "logs" / "generic-1.log").read_text("utf-8")


@pytest.mark.nightly
def test_a_run_that_breaks_off_is_no_success(tmp_path):
    done = told("--only", "generic", "--logs", tmp_path, "--", "-n", 0, tmp_path / "nothing.py")
    assert done.returncode == 1
    assert "pytest ended with 4" in done.stdout
