"""What of a drawing was not read, told in one line."""

import warnings
from collections import Counter
from pathlib import Path

from sim_core.errors import OutlineWarning

__all__ = ["MOST_VISITED", "visited", "warn_left_out"]

MOST_VISITED = 200_000  # elements, those of blocks and uses each time they are drawn
MOST_NAMED = 8


def visited(before: int) -> int:
    """One element more; raises ValueError where a drawing multiplies itself beyond bearing."""
    if before >= MOST_VISITED:
        raise ValueError(f"it draws more than {MOST_VISITED} elements")
    return before + 1


def warn_left_out(path: Path, found: Counter[str]) -> None:
    """Warn of what was left out (name: how often), the most frequent first, if there is anything."""
    if not found:
        return
    named = [f"{count} {what[:40]}" for what, count in found.most_common(MOST_NAMED)]
    more = ["more"] if len(found) > MOST_NAMED else []
    warnings.warn(f"left out of {path.name}: {', '.join(named + more)}", OutlineWarning, stacklevel=2)
