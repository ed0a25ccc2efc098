"""What is slow by nature, in parts that resume: full matrices, sweeps and soaks, and the suite of other processors.

    python tests/nightly.py                  every part that has not passed on this commit
    python tests/nightly.py --list           the parts, and the commit each has passed on
    python tests/nightly.py browser survey   these parts, whether they have passed or not

A test is of the night where it is marked `nightly`; `pytest` leaves those out and `pytest -m nightly` runs them alone.
Other processors are those whose machine code is another: the kernels of OpenBLAS for AVX2 where this one has AVX-512,
those for AVX-512 where it has not and can, and the least that is called x86-64. Of the suite they run what reckons: a
server answers alike everywhere.
A part that passed is noted with its commit beside the repository's own records (`git rev-parse --git-path nightly`), so
that a night that was broken off goes on where it was. Ends with status 1 if a part failed.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from functools import lru_cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# Name by name: of a test that hangs the log has the begin.
SUITE = (sys.executable, "-m", "pytest", "-v", "-n", "2", "--dist", "loadfile", "--no-loadscope-reorder")
OTHER = (sys.executable, "tests/machines.py", "--only")
RECKONING = (
    "tests/sim_core",
    "tests/hall_app",
    "tests/survey",
    "-k",
    "sim_core or bake or light or analys or figure",
)
DAY = ("--", "-m", "not nightly and not browser", *RECKONING)
# Name -> command. Browsers draw alike on every processor, so those take part on this one only.
PARTS: dict[str, tuple[str, ...]] = {
    **{
        room: (*SUITE, "-m", "nightly", f"tests/{room}")
        for room in ("browser", "hall_app", "sim_core", "survey")
    },
    "learn": (sys.executable, "tests/with_learn.py"),
    **{machine: (*OTHER, machine, *DAY) for machine in ("haswell", "skylakex", "oldest")},
}


# Parts whose tests need most kernels: made once, on both cores, before workers meet them at the same time.
KERNELS = frozenset(("browser", "hall_app", "sim_core"))
ROOMS = (("cloth", "light"), ("mesh", "weave", "garment"))


def git(*words: str) -> str:
    return subprocess.run(
        ("git", *words), cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.strip()


def notes() -> Path:
    """The folder that holds one file a part that passed."""
    return ROOT / git("rev-parse", "--git-path", "nightly")


def note_of(part: str) -> dict[str, object]:
    """What the part passed on: its commit and seconds; empty where it never has."""
    try:
        return json.loads((notes() / f"{part}.json").read_text("utf-8"))
    except (OSError, ValueError):
        return {}


@lru_cache(maxsize=1)
def kernels() -> None:
    """What cannot be made is said here, and again by the first test that needs it."""
    making = [
        subprocess.Popen((sys.executable, "tests/compile_kernels.py", *rooms), cwd=ROOT) for rooms in ROOMS
    ]
    for one in making:
        one.wait()


def run(part: str, commit: str) -> bool:
    """Runs a part and notes that it passed; `commit` is empty where the tree differs from what is committed."""
    begin = time.monotonic()
    environment = os.environ | {"HALL_BROWSER": "required"}
    if part in KERNELS:
        kernels()
        # What is installed, and its kernels, in all processes that a test starts.
        environment["PYTHONSAFEPATH"] = "1"
    passed = subprocess.run(PARTS[part], cwd=ROOT, env=environment, check=False).returncode == 0
    seconds = time.monotonic() - begin
    if passed and commit:
        notes().mkdir(exist_ok=True)
        (notes() / f"{part}.json").write_text(
            json.dumps({"commit": commit, "seconds": round(seconds)}), "utf-8"
        )
    print(f"== {part}: {'passed' if passed else 'FAILED'} ({seconds:.0f} s)", flush=True)
    return passed


def able() -> list[str]:
    """The parts this machine can run and is not itself: not every processor can stand for every other."""
    sys.path.insert(0, str(ROOT / "tests"))  # PYTHONSAFEPATH leaves it out
    from machines import machines, processor_flags

    own = "skylakex" if "avx512f" in processor_flags() else "haswell"  # Zen's kernels are Haswell's
    others = machines().keys() - {own}
    return [part for part, command in PARTS.items() if command[:3] != OTHER or part in others]


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "part", nargs="*", help=f"of {', '.join(PARTS)}; default: all that have not passed yet"
    )
    parser.add_argument(
        "--list", action="store_true", help="say what passed on which commit, and run nothing"
    )
    args = parser.parse_args()
    parts = able()
    if strange := [part for part in args.part if part not in parts]:
        parser.error(
            f"{', '.join(strange)}: no part of this machine's night – choose from {', '.join(parts)}"
        )
    commit = "" if git("status", "--porcelain") else git("rev-parse", "HEAD")
    if args.list:
        for part in parts:
            note = note_of(part)
            print(f"{part:<10} {str(note.get('commit', 'never'))[:12]:<14} {note.get('seconds', '-'):>6} s")
        return 0
    todo = args.part or [part for part in parts if not commit or note_of(part).get("commit") != commit]
    if not commit:
        print("the tree differs from its commit: what passes now is not noted", file=sys.stderr)
    results = [run(part, commit) for part in todo]  # all of them: one failure does not hide another
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
