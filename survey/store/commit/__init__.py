"""Writing answers: what a `batch` of them becomes in one transaction, and the `writer` that commits what waits."""

from survey.store.commit.batch import Entry, Receipt, commit_batch, freeze_version, insert_new
from survey.store.commit.writer import BATCH_SIZE, Writer

__all__ = [
    "BATCH_SIZE",
    "Entry",
    "Receipt",
    "Writer",
    "commit_batch",
    "freeze_version",
    "insert_new",
]
