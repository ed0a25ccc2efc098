"""Erased is erased.

`removal` deletes the rows, the `eraser` takes their last bytes out of the files, where it searches for `leftovers`.
"""

from survey.store.erasure.eraser import Eraser, add_trace, clear_traces, rewrite_tables, traces
from survey.store.erasure.leftovers import BLOCK, Erased, erased_answer, everything, left_over
from survey.store.erasure.removal import Overdue, erase, overdue, withdraw

__all__ = [
    "BLOCK",
    "Erased",
    "Eraser",
    "Overdue",
    "add_trace",
    "clear_traces",
    "erase",
    "erased_answer",
    "everything",
    "left_over",
    "overdue",
    "rewrite_tables",
    "traces",
    "withdraw",
]
