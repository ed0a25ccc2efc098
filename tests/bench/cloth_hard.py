"""The hard cases: what breaks other engines, each with what it must keep, and the table of the outcome.

    python tests/bench/cloth_hard.py [--only WORDS] [--readme]

Every case ends finite, keeps its longest edge within 10 % of an analytic value or of the same with a quarter of the
step, has 0 samples deeper than a tenth of the clearance in a collider at any frame, and gets no energy back without
work (at most 1 % of what it has lost). `unique`: the equilibrium is one, and every vertex regains it within 1 mm;
`calm`: kinetic energy goes to zero and self-intersections do not grow from when nothing does work any more.
`order`: 150 stacks each, drawn by chance, fall on a floor, and no layer crosses another or changes places in silence.
Nothing is put to sleep. --readme writes the table into the room's README.
"""

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

from cloth_course import Outcome
from cloth_hard_hung import HUNG
from cloth_hard_met import MET
from cloth_hard_same import SAME
from cloth_hard_stacks import STACKS

README = Path(__file__).parents[2] / "sim_core" / "cloth" / "README.md"
BEGIN, END = "<!-- hard cases -->", "<!-- end of hard cases -->"

CASES: dict[str, Callable[[], Outcome]] = {**HUNG, **MET, **SAME, **STACKS}


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", default="", help="cases whose name holds this")
    parser.add_argument("--readme", action="store_true", help="write their rows into the room's README")
    args = parser.parse_args()
    rows, kept = {}, True
    for name, case in CASES.items():
        if args.only in name:
            begin = time.perf_counter()
            found = case()
            kept &= found.kept
            mark = "yes" if found.kept else "**no**"
            rows[name] = f"| {name} | {mark} | {found.rule} | {found.figures} | {found.fallbacks} |"
            print(rows[name], f" {time.perf_counter() - begin:.1f} s", flush=True)
            if args.readme:
                _written(rows)
    return 0 if kept else 1


def _written(rows: dict[str, str]) -> None:
    """The table of the README with these rows new and all others of a case as they were."""
    text = README.read_text("utf-8")
    head, rest = text.split(BEGIN)
    old, tail = rest.split(END)
    known = {line.split("|")[1].strip(): line for line in old.splitlines() if line.startswith("|")}
    lines = ["| case | kept | rule | figures | implicit frames |", "|-|-|-|-|-|"]
    lines += [(known | rows)[name] for name in CASES if name in known | rows]
    README.write_text(head + BEGIN + "\n" + "\n".join(lines) + "\n" + END + tail, "utf-8")


if __name__ == "__main__":
    sys.exit(main())
