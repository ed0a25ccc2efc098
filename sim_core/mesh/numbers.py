"""Lists of numbers from JSON files: a text such as "1" or a true is no coordinate, though arrays would take both."""

from pathlib import Path

from sim_core.errors import FileProblem
from sim_core.validation.files import shown

__all__ = ["check_numbers"]


def check_numbers(path: Path, name: str, rows: object, shape: str) -> None:
    """Raise FileProblem naming the first row of a list that holds something else than numbers.

    rows: what the file holds under `name`; other faults of shape are left to whoever makes an array of it.
    shape: such as "[x, y] in metres".
    """
    if not isinstance(rows, list):
        return
    for k, row in enumerate(rows):
        for value in row if isinstance(row, list) else [row]:
            if isinstance(value, bool | str) or value is None:
                raise FileProblem(f"{path}: {name}: point {k} is {shown(row)} – give numbers, {shape}")
