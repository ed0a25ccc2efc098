"""Tables of scores, wherever they come from.

`csv_table` reads them from a file, with `columns` choosing which columns of a foreign one are items; `sources` takes
them from the store or a synthetic sample, and says which of their items to drop, turn or group.
"""

from survey.scores.columns import Choice, no_items
from survey.scores.csv_table import SECONDS, ScoreTable, read_column, read_scores
from survey.scores.sources import (
    context_of,
    dropped,
    listed,
    load_scores,
    open_stored,
    other_roles,
    other_versions,
    reverse_keyed,
    sample_scores,
    stated_groups,
    stored_scores,
)

__all__ = [
    "SECONDS",
    "Choice",
    "ScoreTable",
    "context_of",
    "dropped",
    "listed",
    "load_scores",
    "no_items",
    "open_stored",
    "other_roles",
    "other_versions",
    "read_column",
    "read_scores",
    "reverse_keyed",
    "sample_scores",
    "stated_groups",
    "stored_scores",
]
