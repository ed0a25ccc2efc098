"""Tests of learned cloth where torch is installed: in an environment of its own that has the extra `learn`.

python tests/with_learn.py                   every test of sim_core.learn, those of the night with them
python tests/with_learn.py -k commands_lead  what follows goes to pytest
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TESTS = sorted(str(path.relative_to(ROOT)) for path in (ROOT / "tests" / "sim_core").glob("test_learn_*.py"))


def main(*more: str) -> int:
    """The status of pytest, or of pip where it fails."""
    with tempfile.TemporaryDirectory() as folder:
        venv.create(folder, with_pip=True)
        python = str(Path(folder) / "bin" / "python")
        installed = subprocess.run(
            (python, "-m", "pip", "install", "-q", "--no-compile", f"{ROOT}[learn,test]"), check=False
        )
        if installed.returncode:
            return installed.returncode
        if subprocess.run((python, "-c", "import torch"), check=False).returncode:
            return 1  # else all would be skipped, and pass
        suite = (
            python,
            "-m",
            "pytest",
            "-q",
            "-n",
            "2",
            "--dist",
            "loadfile",
            "-m",
            "nightly or not nightly",
        )
        environment = os.environ | {"OMP_NUM_THREADS": "1", "PYTHONSAFEPATH": "1"}
        return subprocess.run((*suite, *TESTS, *more), cwd=ROOT, env=environment, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
