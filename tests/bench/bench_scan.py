"""Scans as exhibits: time, memory and measured deviation of their bakes; prints a table, writes JSON.

    python tests/bench/bench_scan.py [--triangles 1e5 1e6 5e6] [--form ply] [--pixels 4096]
        [--kept FOLDER] [--json FILE]

The scan is a garment of ours as a scanner leaves it (tests/scan_like.py): in millimetres, z up, .2 mm of noise, twelve
holes of 20 mm, thirty loose flakes, painted. Each size goes through the real door in a process of its own: a content
folder, `hall build --exhibit`. Of it: wall and processor seconds, greatest memory, seconds of each stage, and of both
models triangles, bytes, two-sided deviation (mean, p99, max) and whether that is within a pixel at the nearest view.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

sys.path[:0] = [str(Path(__file__).parents[1]), str(Path(__file__).parents[1] / "hall_app")]

from bench.signature import signed  # noqa: E402
from content_house import add_exhibit, edit, make_house  # noqa: E402
from scan_like import scan_of, with_flakes, with_holes, write_glb, write_obj, write_ply  # noqa: E402

FORMS = {"ply": write_ply, "glb": write_glb, "obj": write_obj}
SCANNED = '\n[scanned]\nunits = "mm"\nup = "z"\nkeep = "largest"\n'


def exhibit_of(folder: Path, triangles: int, form: str, pixels: int) -> Path:
    """A content folder whose exhibit "robe" is a scan of so many triangles."""
    house = make_house(folder)
    home = add_exhibit(house, "robe")
    edit(home / "exhibit.toml", '[models]\nhall = "media/chest.glb"\n', "")
    edit(home / "exhibit.toml", "behaviours", f'scan = "scan/robe.{form}"\nbehaviours')
    edit(home / "exhibit.toml", "x = 0.0\nz = -1.0", "x = 2.5\nz = 2.5")
    (home / "exhibit.toml").write_text((home / "exhibit.toml").read_text("utf-8") + SCANNED, "utf-8")
    (home / "scan").mkdir()
    made = with_flakes(with_holes(scan_of(triangles, pixels=pixels), 12, 0.02), 30, 0.004).turned()
    FORMS[form](made, home / f"scan/robe.{form}")
    return house


class Greatest(threading.Thread):
    """Asks the system for the greatest memory that a process has had, until it ends; `ru_maxrss` would tell that of the
    process that began it, where this is larger."""

    def __init__(self, process: int) -> None:
        super().__init__()
        self.status, self.kilobytes = Path(f"/proc/{process}/status"), 0

    def run(self) -> None:
        with suppress(OSError):
            while line := [
                line for line in self.status.read_text().splitlines() if line.startswith("VmHWM:")
            ]:
                self.kilobytes = int(line[0].split()[1])
                time.sleep(0.1)


def baked(house: Path) -> dict[str, Any]:
    """The record of a bake in a process of its own, with what that took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begin = time.perf_counter()
    command = [
        sys.executable,
        "-m",
        "hall_app",
        "build",
        "--content",
        str(house),
        "--exhibit",
        "robe",
        "--json",
    ]
    place = house.parent / "data"
    with subprocess.Popen(
        [*command, "--data", str(place)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as build:
        memory = Greatest(build.pid)
        memory.start()
        said, complaint = build.communicate()
        memory.join()
    if build.returncode:
        raise SystemExit(complaint)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    record = json.loads(said.strip().splitlines()[-1])
    scan = house / "exhibits/robe/scan"
    return {
        "triangles": record["errors"]["scan_triangles"],
        "file_mb": sum(path.stat().st_size for path in scan.iterdir()) / 1e6,
        "wall_s": round(time.perf_counter() - begin, 1),
        "cpu_s": round(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, 1),
        "memory_gb": round(memory.kilobytes / 1e6, 2),
        "seconds": record["seconds"],
        "hall": record["scan"]["hall"],
        "close": record["scan"]["close"],
    }


def rows(one: dict[str, Any]) -> str:
    """Two lines of the table."""
    lines = []
    for name in ("close", "hall"):
        told = one[name]
        apart = "".join(f"{1000 * told['deviation'][key]:8.2f}" for key in ("mean_m", "p99_m", "max_m"))
        begin = f"{one['triangles']:9d} {one['file_mb']:7.1f} {one['wall_s']:7.1f} {one['cpu_s']:7.1f}"
        begin += f" {one['memory_gb']:6.2f}"
        begin = begin if name == "close" else " " * len(begin)
        within = "yes" if told["within_budget"] else "no"
        lines.append(
            f"{begin} {name:<6}{told['triangles']:8d} {told['bytes'] / 1e6:6.2f}{apart}"
            f"{1000 * told['budget_m']:8.2f} {within:>6}"
        )
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--triangles", nargs="+", type=float, default=[1e5, 1e6, 5e6])
    parser.add_argument("--form", choices=FORMS, default="ply")
    parser.add_argument("--pixels", type=int, default=4096, help="a side of the scan's picture")
    parser.add_argument("--kept", type=Path, help="folder to leave the content folders in")
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    print(
        f"{'triangles':>9} {'MB':>7} {'wall s':>7} {'cpu s':>7} {'GB':>6} {'model':<6}{'tri.':>8} {'MB':>6}"
        f"{'mean mm':>8}{'p99':>8}{'max':>8}{'pixel':>8} within"
    )
    found = []
    with tempfile.TemporaryDirectory() as place:
        for triangles in sorted(arguments.triangles):
            folder = (arguments.kept or Path(place)) / f"{int(triangles)}" / "content"
            found.append(baked(exhibit_of(folder, int(triangles), arguments.form, arguments.pixels)))
            print(rows(found[-1]), flush=True)
            if arguments.json:  # after every size: the last takes long
                told = {"form": arguments.form, "scans": found}
                arguments.json.write_text(json.dumps(signed(told), indent=1), "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
