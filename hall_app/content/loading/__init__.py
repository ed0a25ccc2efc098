"""From a content folder to `Content`, and again after an edit.

tables: one file; exhibits, writing: a folder of them each; hall: all of it; reload: an edit noticed.
"""

from hall_app.content.loading.exhibits import RESERVED, load_exhibit_problems
from hall_app.content.loading.hall import load
from hall_app.content.loading.reload import Watcher
from hall_app.content.loading.tables import read_table

__all__ = ["RESERVED", "Watcher", "load", "load_exhibit_problems", "read_table"]
