"""What a sensor streams: one row a joint and frame, `time, joint, x, y, z, state`, as CSV or as JSON."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sim_core.errors import FileProblem, SimCoreError
from sim_core.track.recording import Recording
from sim_core.track.skeletons import KINECT
from sim_core.validation.files import read_json, read_text, shown

__all__ = ["STATES", "read_csv_stream", "read_json_stream"]

COLUMNS = ("time", "joint", "x", "y", "z", "state")
STATES = {"nottracked": 0, "inferred": 1, "tracked": 2, "lost": 0, "0": 0, "1": 1, "2": 2, "": 2}
"""What a sensor says of a joint: a Kinect's words and numbers; one that is not tracked was not seen."""
WHAT = "a stream (time, joint, x, y, z, state)"
_JOINTS = {name.lower(): number for number, name in enumerate(KINECT.joints)}
_JOINTS |= {str(number): number for number in range(len(KINECT.joints))}


@dataclass(frozen=True)
class _Row:
    """One row, and how an error in one of its columns is told."""

    cells: dict[str, Any]
    problem: Callable[[str, str], FileProblem]

    def number(self, column: str) -> float:
        value = self.cells[column]
        try:
            real = float(value) if not isinstance(value, bool) else np.nan
        except (TypeError, ValueError, OverflowError):
            raise self.problem(column, f"{shown(value)} is no number") from None
        return real

    def joint(self) -> int:
        value = self.cells["joint"]
        found = _JOINTS.get(str(value).strip().lower())
        if found is None:
            raise self.problem(
                "joint", f"{shown(value)} – a Kinect's joint is meant, such as SpineBase or 0 to 24"
            )
        return found

    def seen(self) -> bool:
        value = self.cells.get("state", "")
        found = STATES.get(str(value).strip().lower().replace(" ", "").replace("_", ""))
        if found is None:
            raise self.problem(
                "state", f"{shown(value)} – tracked, inferred or nottracked (2, 1, 0) is meant"
            )
        return found > 0


def read_csv_stream(path: Path, unit: float = 1.0) -> Recording:
    """The frames of a CSV stream; raises FileProblem naming line and column of what is wrong.

    Any order of the columns, which the first line names; `state` may be missing. Rows of one time are one frame, in
    whatever order they come, unless a joint comes again. unit [m]: of its lengths.
    """
    return _recording(path, _csv_rows(path, read_text(path, WHAT)), unit)


def read_json_stream(path: Path, unit: float = 1.0) -> Recording:
    """The frames of a JSON stream: an array of {"time", "joint", "x", "y", "z", "state"}."""
    value = read_json(path, WHAT)
    if not isinstance(value, list):
        raise FileProblem(
            f"{path}: {shown(value)} – an array of rows is meant, {{time, joint, x, y, z, state}}"
        )
    return _recording(path, _json_rows(path, value), unit)


def _csv_rows(path: Path, text: str) -> Iterator[_Row]:
    lines = text.splitlines()
    first = next((number for number, line in enumerate(lines) if line.strip()), None)
    if first is None:
        raise FileProblem(f"{path}: the file is empty – give {WHAT}")
    names = [name.strip().strip('"').lower() for name in lines[first].split(",")]
    for number, name in enumerate(names):
        if name not in COLUMNS or name in names[:number]:
            place = _column(lines[first], number)
            told = f"{shown(name)} – the first line names {', '.join(COLUMNS)}, each once"
            raise FileProblem(f"{path}: line {first + 1}, column {place}: {told}")
    if missing := [name for name in COLUMNS[:-1] if name not in names]:
        raise FileProblem(f"{path}: line {first + 1}, column 1: no {missing[0]} among the columns")
    for number, line in enumerate(lines[first + 1 :], first + 2):
        if not line.strip():
            continue
        cells = [cell.strip().strip('"') for cell in line.split(",")]
        if len(cells) != len(names):
            place = _column(line, min(len(cells), len(names)) - 1)
            told = f"{len(cells)} cells – the first line names {len(names)}"
            raise FileProblem(f"{path}: line {number}, column {place}: {told}")

        def problem(column: str, what: str, line: str = line, number: int = number) -> FileProblem:
            place = _column(line, names.index(column))
            return FileProblem(f"{path}: line {number}, column {place}: {column}: {what}")

        yield _Row(dict(zip(names, cells, strict=True)), problem)


def _column(line: str, cell: int) -> int:
    """Where the cell of that number begins, counted from 1."""
    before = ",".join(line.split(",")[:cell])
    start = len(before) + bool(cell)
    return start + len(line[start:]) - len(line[start:].lstrip()) + 1


def _json_rows(path: Path, rows: list[Any]) -> Iterator[_Row]:
    for number, row in enumerate(rows):
        if not isinstance(row, dict) or not set(COLUMNS[:-1]) <= set(row) <= set(COLUMNS):
            raise FileProblem(f"{path}: row {number}: {shown(row)} – {{{', '.join(COLUMNS)}}} is meant")

        def problem(column: str, what: str, number: int = number) -> FileProblem:
            return FileProblem(f"{path}: row {number}, {column}: {what}")

        yield _Row(row, problem)


def _recording(path: Path, rows: Iterator[_Row], unit: float) -> Recording:
    times: list[float] = []
    frames: list[np.ndarray] = []
    there: list[set[int]] = []
    latest: dict[float, int] = {}  # the last frame of each time: rows come late, or joint by joint
    ever = np.zeros(len(KINECT.joints), bool)
    for row in rows:
        time, joint = row.number("time"), row.joint()
        if not math.isfinite(time):
            raise row.problem("time", f"{time} – seconds are meant; leave the row out")
        frame = latest.get(time)
        if frame is None or joint in there[frame]:
            frame = latest[time] = len(times)
            times.append(time)
            frames.append(np.full((len(KINECT.joints), 3), np.nan))
            there.append(set())
        there[frame].add(joint)
        if row.seen():
            frames[frame][joint] = [row.number(axis) for axis in "xyz"]
            ever[joint] = True
    if not frames:
        raise FileProblem(f"{path}: no row of a joint – give {WHAT}")
    told = [name for name, once in zip(KINECT.joints, ever, strict=True) if not once]
    words = (f"never seen: {', '.join(told)}",) if told else ()
    try:
        return Recording(KINECT, np.array(times), np.array(frames) * unit, None, (), words)
    except SimCoreError as error:
        raise FileProblem(f"{path}: {error}") from error
