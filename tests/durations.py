"""What the tests cost, and which of the suite are for that reason of the night.

    pytest -m '' -n 2 --dist loadfile --durations=0 --durations-min=1 | tee LOG
    python tests/durations.py LOG …         takes down what their functions took, all cases of one together

A function that took longer than the day has for one (`DAY`) is marked `nightly` as it is collected, so that the suite
stays as short as it was made: who writes a slow test need not know. A door of the house is walked by day all the same
(`door`), and so is what nobody has timed yet.
"""

from __future__ import annotations

import json
import re
import sys
from collections import Counter
from collections.abc import Iterable, Mapping
from functools import lru_cache
from pathlib import Path

__all__ = ["DAY", "DEAR", "is_of_the_night"]

FILE = Path(__file__).with_suffix(".json")
ROOT = FILE.parents[1]
DAY = 4.0  # [s]
KEPT = 1.0  # [s] from which on a function is taken down
# Fixtures that take half a minute by themselves: whatever asks for one waits for it, however little it does then.
DEAR = frozenset({"coat", "skirt", "walked", "scanned_hall", "coarse_scarf", "coarse_layers"})
_LINE = re.compile(r"\s*([\d.]+)s call\s+(tests/\S+?\.py::\w+)")


def is_of_the_night(name: str, fixtures: Iterable[str]) -> bool:
    """name: of the function, with its file below the repository, as pytest names it without its case."""
    return _costs().get(name, 0.0) > DAY or not DEAR.isdisjoint(fixtures)


def read(lines: Iterable[str]) -> dict[str, float]:
    """Function -> seconds of all its cases, from what pytest prints with --durations."""
    found: Counter[str] = Counter()
    for line in lines:
        if match := _LINE.match(line):
            found[match[2]] += float(match[1])
    return dict(found)


def there(name: str) -> bool:
    """Whether the function is still in its file."""
    file, _, function = name.partition("::")
    path = ROOT / file
    return path.is_file() and f"def {function}(" in path.read_text("utf-8")


@lru_cache(maxsize=1)
def _costs() -> Mapping[str, float]:
    return json.loads(FILE.read_text("utf-8")) if FILE.is_file() else {}


def main(logs: list[str]) -> int:
    if not logs:
        print(__doc__)
        return 2
    found = dict(_costs())
    for log in logs:
        found |= read(Path(log).read_text("utf-8", "replace").splitlines())
    kept = {name: round(cost, 1) for name, cost in sorted(found.items()) if cost >= KEPT and there(name)}
    FILE.write_text(json.dumps(kept, indent=0) + "\n", "utf-8")
    longer = [cost for cost in kept.values() if cost > DAY]
    print(
        f"{FILE.name}: {len(kept)} functions, {len(longer)} of them longer than {DAY} s ({sum(longer):.0f} s)"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
