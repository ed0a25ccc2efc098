"""The suite as other processors run it, and beside other load: which test depends on the machine?

    python tests/machines.py                                    all of it, on every machine
    python tests/machines.py --times 3 --beside                 three times in a row, beside a process that spins
    python tests/machines.py --only zen oldest -- tests/survey -m "not browser"

A machine is a set of environment variables: OpenBLAS takes another processor's kernels, numba compiles for another,
NumPy and the C library leave their vector loops out. So one x86-64 machine shows most of what another one would. What
stands after -- goes to pytest. Ends with status 1 if any test failed; each run's output is kept in --logs.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parents[1]
# Two processes, a file's tests on one of them, as .ci/run has it.
USUAL = ("-q", "-n", "2", "--dist", "loadfile", "--no-loadscope-reorder")


def numpy_loops() -> str:
    """NumPy's own loops for the vector units of this processor, as NPY_DISABLE_CPU_FEATURES takes them."""
    from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

    return " ".join(name for name in __cpu_dispatch__ if __cpu_features__.get(name))


def machines() -> dict[str, dict[str, str]]:
    """Name -> environment of every machine that this processor can stand for."""
    generic = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}
    found = {
        "haswell": {"OPENBLAS_CORETYPE": "Haswell"},
        "zen": {"OPENBLAS_CORETYPE": "Zen"},
        "skylakex": {"OPENBLAS_CORETYPE": "SkylakeX"},
        "generic": generic,
        # No vector unit beyond SSE, no fused multiplication: the least that is called x86-64 with NumPy.
        "oldest": {
            **generic,
            "OPENBLAS_CORETYPE": "Prescott",
            "NPY_DISABLE_CPU_FEATURES": numpy_loops(),
            "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F,-AVX2,-AVX,-FMA,-FMA4",
        },
    }
    needs = {"skylakex": "avx512f", "haswell": "avx2", "zen": "avx2"}
    there = processor_flags()
    return {name: env for name, env in found.items() if name not in needs or needs[name] in there}


def processor_flags() -> set[str]:
    """What /proc/cpuinfo says the processor has."""
    with contextlib.suppress(OSError):
        for line in Path("/proc/cpuinfo").read_text("utf-8", "replace").splitlines():
            if line.startswith("flags"):
                return set(line.partition(":")[2].split())
    return set()


@dataclass(frozen=True)
class Run:
    """One pass of the suite: machine, round, seconds, how many tests came to what, the names of the failed."""

    machine: str
    round: int
    seconds: float
    passed: int
    skipped: int
    failed: tuple[str, ...]
    status: int

    @property
    def good(self) -> bool:
        return self.status == 0


@contextlib.contextmanager
def spinning() -> Iterator[None]:
    """A process that keeps the first of the processors busy."""
    core = min(os.sched_getaffinity(0))
    spin = f"import os\nos.sched_setaffinity(0, {{{core}}})\nwhile True: pass"
    with subprocess.Popen([sys.executable, "-c", spin]) as process:
        try:
            yield
        finally:
            process.kill()


def surroundings(env: Mapping[str, str]) -> dict[str, str]:
    """This process's environment as that machine: what it does not set is this processor's own."""
    chosen = {key for other in machines().values() for key in other}
    return {key: value for key, value in os.environ.items() if key not in chosen} | dict(env)


def run(machine: str, env: Mapping[str, str], number: int, arguments: Sequence[str], logs: Path) -> Run:
    """The suite once, its output to `logs`."""
    name = f"{machine}-{number}"
    report, begin = logs / f"{name}.xml", time.monotonic()
    report.unlink(missing_ok=True)
    command = [sys.executable, "-m", "pytest", *USUAL, f"--junitxml={report}", *arguments]
    with (logs / f"{name}.log").open("wb") as sink:
        status = subprocess.run(
            command, cwd=ROOT, env=surroundings(env), stdout=sink, stderr=subprocess.STDOUT, check=False
        ).returncode
    passed, skipped, failed = counted(report)
    return Run(machine, number, time.monotonic() - begin, passed, skipped, failed, status)


def counted(report: Path) -> tuple[int, int, tuple[str, ...]]:
    """Passed, skipped and the names of the failed, of pytest's JUnit file; none of it where the run broke off."""
    if not report.is_file():
        return 0, 0, ()
    cases = ElementTree.parse(report).getroot().findall(".//testcase")
    failed = [case for case in cases if case.find("failure") is not None or case.find("error") is not None]
    skipped = [case for case in cases if case.find("skipped") is not None]
    names = [f"{case.get('classname', '').replace('.', '/')}.py::{case.get('name')}" for case in failed]
    return len(cases) - len(failed) - len(skipped), len(skipped), tuple(names)


def table(runs: Sequence[Run]) -> str:
    """The runs as lines, and under them where each failed test failed."""
    rows = [f"{'machine':<10} {'round':>5} {'passed':>7} {'skipped':>8} {'failed':>7} {'seconds':>8}"]
    for run in runs:
        broken = "" if run.good or run.failed else f"   pytest ended with {run.status}"
        rows.append(
            f"{run.machine:<10} {run.round:>5} {run.passed:>7} {run.skipped:>8} {len(run.failed):>7}"
            f" {run.seconds:>8.0f}{broken}"
        )
    for test in dict.fromkeys(test for run in runs for test in run.failed):
        where = ", ".join(f"{run.machine} {run.round}" for run in runs if test in run.failed)
        rows.append(f"FAILED {test} ({where})")
    return "\n".join(rows)


def main() -> int:
    able = machines()
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", nargs="+", choices=list(able), default=list(able), metavar="MACHINE")
    parser.add_argument("--times", type=int, default=1, help="rounds of each machine")
    parser.add_argument("--beside", action="store_true", help="beside a process that spins on one processor")
    parser.add_argument("--logs", type=Path, help="folder for pytest's output; default: a temporary one")
    parser.add_argument("pytest", nargs="*", help="what pytest is given, after --")
    args = parser.parse_args()
    logs = (args.logs or Path(tempfile.mkdtemp(prefix="machines-"))).resolve()
    logs.mkdir(parents=True, exist_ok=True)
    runs = []
    # numba keeps machine code by the processor it is for: one cache serves all machines, rounds and later runs.
    with spinning() if args.beside else contextlib.nullcontext():
        for number in range(1, args.times + 1):
            for name in args.only:
                print(f"{name}, round {number} of {args.times} …", file=sys.stderr, flush=True)
                runs.append(run(name, able[name], number, args.pytest, logs))
    print(table(runs))
    print(f"output: {logs}")
    return 0 if all(run.good for run in runs) else 1


if __name__ == "__main__":
    sys.exit(main())
