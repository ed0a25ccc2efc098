"""A crowd in one hall: round trips, processor and memory of many visitors, and what one attacker costs them.

    python tests/bench/bench_crowd.py [--visitors 100] [--seconds 10] [--waves 4] [--attacks all]
        [--beside CHECKOUT] [--json FILE]

A real `hall serve` in one process; visitors and attacker are processes of their own on the other core. Round trips
are those of the walk socket (inputs → pose) and of plain requests. Waves: everybody joins, walks, leaves, and the
memory that is left is read. Attacks: 30 visitors, without and with one attacker at full speed, in turns.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parents[2]))
sys.path.insert(0, str(Path(__file__).parent))

from crowd_attack import KINDS  # noqa: E402
from running_hall import RunningHall, running_hall  # noqa: E402
from signature import signed  # noqa: E402

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
OTHERS = 30  # visitors beside an attacker
CORES = sorted(os.sched_getaffinity(0))


def elsewhere(command: Sequence[str], *, nice: int = 0) -> subprocess.Popen:
    """A process on the core the hall does not run on."""

    def settle() -> None:
        os.sched_setaffinity(0, {CORES[-1]})
        os.nice(nice)

    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, preexec_fn=settle)


def open_hall(checkout: Path, stack: contextlib.ExitStack, arguments: argparse.Namespace) -> Any:
    """`hall serve` of a checkout on the first core; one from before `--visitors` has its constant raised."""
    begin = f"import sys, runpy; sys.path.insert(0, {str(checkout)!r}); sys.argv[0] = 'hall'"
    options, most = arguments.options.split(), max(arguments.visitors, OTHERS + 10)
    if (checkout / "hall_app/server/relay.py").exists():  # the README's figures compare with such a one
        begin += f"; import hall_app.server.relay as r; r.MOST_VISITORS = {most}"
    else:
        options += ["--visitors", str(most)]
    begin += "; runpy.run_module('hall_app', run_name='__main__')"
    program = ("taskset", "-c", str(CORES[0]), sys.executable, "-c", begin)
    work = Path(stack.enter_context(tempfile.TemporaryDirectory()))
    paths = os.pathsep.join([str(checkout), *filter(None, [os.environ.get("PYTHONPATH")])])
    return running_hall(arguments.content, work, *options, program=program, env={"PYTHONPATH": paths})


def crowd(port: int, plan: dict[str, Any]) -> subprocess.Popen:
    return elsewhere([sys.executable, str(HERE / "crowd_load.py"), str(port), json.dumps(plan)])


class Meter:
    """Processor and memory of a process."""

    def __init__(self, pid: int) -> None:
        self.pid = pid

    def cpu(self) -> float:
        """Seconds so far, all threads."""
        fields = Path(f"/proc/{self.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def megabytes(self) -> float:
        rss = int(Path(f"/proc/{self.pid}/statm").read_text().split()[1])
        return rss * os.sysconf("SC_PAGE_SIZE") / 1e6


def measure_wave(hall: RunningHall, plan: dict[str, Any]) -> dict[str, Any]:
    """Everybody joins, walks and leaves; figures of the walking, memory before, at most and after."""
    meter = Meter(hall.process.pid)
    before, most = meter.megabytes(), 0.0
    process = crowd(hall.port, plan)
    assert process.stdout is not None
    process.stdout.readline()  # all inside
    began, cpu = time.perf_counter(), meter.cpu()
    while process.poll() is None:
        most = max(most, meter.megabytes())
        time.sleep(0.2)
        if time.perf_counter() - began < plan["seconds"]:
            share = (meter.cpu() - cpu) / (time.perf_counter() - began)
    found = json.loads(process.stdout.read())
    time.sleep(6.0)  # those who left are forgotten
    memory = {"before_mb": before, "most_mb": most, "after_mb": meter.megabytes()}
    return {**found, "cpu_share": share, **memory}


def measure_attack(hall: RunningHall, kind: str, seconds: float) -> dict[str, Any]:
    """30 visitors alone, then beside one attacker."""
    plan = {"visitors": OTHERS, "seconds": seconds, "gets": 10.0, "viser": False, "ramp": 0.5}
    rows = {}
    for name in ("without", "with"):
        process = crowd(hall.port, plan)
        assert process.stdout is not None
        process.stdout.readline()
        attacker = None
        if name == "with":
            command = [sys.executable, str(HERE / "crowd_attack.py"), str(hall.port), kind, str(seconds)]
            attacker = elsewhere(command, nice=5)
        rows[name] = json.loads(process.communicate()[0])
        if attacker is not None:
            rows["attacker"] = json.loads(attacker.communicate()[0] or "{}")
        time.sleep(0.5)
    return {
        "kind": kind,
        **{f"{what}_longer_ms": longer(rows, f"{what}_ms") for what in ("walk", "get")},
        **rows,
    }


def longer(rows: dict[str, Any], what: str) -> float | None:
    """How much later than alone, p95 [ms]; None where nothing came back at all."""
    alone, beside = (rows[name][what].get("p95") for name in ("without", "with"))
    return None if alone is None or beside is None else beside - alone


def print_wave(title: str, row: dict[str, Any]) -> None:
    joining, walk = (
        " ".join(f"{what} {row[name].get(what, -1):.1f}" for what in ("p50", "p95", "max"))
        for name in ("joining_walk_ms", "walk_ms")
    )
    memory = " → ".join(f"{row[what]:.0f}" for what in ("before_mb", "most_mb", "after_mb"))
    print(
        f"{title}: {row['inside']} inside, walk while they join {joining} ms, then {walk} ms, "
        f"{row['cpu_share']:.0%} of a core, memory {memory} MB, scene {row['scene_megabytes']:.3f} MB, "
        f"lost {row['lost']}",
        flush=True,
    )


def print_attack(title: str, row: dict[str, Any]) -> None:
    told = []
    for what in ("walk", "get"):
        alone, beside = (row[name][f"{what}_ms"] for name in ("without", "with"))
        told.append(f"{what} p95 {alone.get('p95', -1):7.1f} → {beside.get('p95', -1):8.1f}")
        told[-1] += f" (max {beside.get('max', -1):.0f})"
    print(f"{title} {'   '.join(told)}   {row.get('attacker')} lost {row['with']['lost']}", flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--visitors", type=int, default=100)
    parser.add_argument(
        "--seconds", type=float, default=10.0, help="measured per wave; half of it per attack"
    )
    parser.add_argument("--waves", type=int, default=4)
    parser.add_argument(
        "--attacks", default="all", help=f"kinds with commas, 'all' or 'none': {', '.join(KINDS)}"
    )
    parser.add_argument(
        "--beside", type=Path, metavar="CHECKOUT", help="measures the same of another checkout, in turns"
    )
    parser.add_argument("--content", type=Path, default=ROOT / "assets")
    parser.add_argument("--options", default="", help="more options for `hall serve`")
    parser.add_argument("--json", type=Path, metavar="FILE")
    arguments = parser.parse_args()
    kinds = {"all": KINDS, "none": ()}.get(arguments.attacks, tuple(arguments.attacks.split(",")))
    checkouts = {"here": ROOT} | ({"beside": arguments.beside.resolve()} if arguments.beside else {})
    rows: dict[str, Any] = {"cores": len(CORES), "visitors": arguments.visitors, "seconds": arguments.seconds}
    rows |= {name: {"waves": [], "attacks": []} for name in checkouts}
    with contextlib.ExitStack() as stack:
        halls = {
            name: stack.enter_context(open_hall(checkout, stack, arguments))
            for name, checkout in checkouts.items()
        }
        for number in range(1, arguments.waves + 1):
            for name, hall in halls.items():
                found = measure_wave(hall, {"visitors": arguments.visitors, "seconds": arguments.seconds})
                rows[name]["waves"].append(found)
                print_wave(f"{name:6} wave {number}", found)
        for kind in kinds:
            for name, hall in halls.items():
                found = measure_attack(hall, kind, arguments.seconds / 2)
                rows[name]["attacks"].append(found)
                print_attack(f"{name:6} {kind:11}", found)
    if arguments.json:
        arguments.json.write_text(json.dumps(signed(rows), indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
