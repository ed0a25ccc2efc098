"""Threads of a WIF file: threading, tie-up, treadling and lift plan as lists of numbers, and the harness they make."""

from __future__ import annotations

import re

import numpy as np

from sim_core.errors import WeaveError
from sim_core.validation.files import shown
from sim_core.weave.draft.algebra import Harness, lift_plan
from sim_core.weave.files.wif.sections import FALSE, TRUE, Section, from_one, listed, whole

__all__ = ["Shed", "announced", "count_of", "harness_of", "shed_of", "truth"]

MOST_THREADS = 65_536  # of a file
MOST_SHAFTS = 4096  # shafts or treadles; a jacquard has a hook an end
MOST_CELLS = 400_000_000  # of threading or treadling
NUMBER = re.compile(r"\d{1,9}", re.ASCII)
NUMBERS = re.compile(r"[\d,\s]*", re.ASCII)
Lists = dict[int, list[int]]  # number of a thread or treadle -> shafts or treadles
Shed = tuple[Lists | None, Lists | None, Lists | None]  # tie-up, treadling, lift plan
Sections = dict[str, Section]


def shed_of(sections: Sections, remarks: list[str]) -> tuple[Lists, Shed]:
    """Threading, and tie-up, treadling and lift plan as far as they are there; the plan only where it is used.

    Raises WeaveError where the threading is missing, or lift plan and treadling or tie-up both are.
    """
    counted = sections | {
        name: from_one(name, sections[name], _threads(sections, side, name), remarks)
        for name, side in (("THREADING", "WARP"), ("TREADLING", "WEFT"), ("LIFTPLAN", "WEFT"))
        if name in sections
    }
    threading = _lists(counted, "THREADING", "shaft")
    tied, treadled, planned = (
        _lists(counted, name, what) if name in sections else None
        for name, what in (("TIEUP", "shaft"), ("TREADLING", "treadle"), ("LIFTPLAN", "shaft"))
    )
    use_plan = planned is not None and any(planned.values())
    if use_plan and tied and treadled and (lacking := _lacking(tied, treadled, planned or {})):
        remarks.append(
            f"[LIFTPLAN] {listed(lacking)}: no line, though trodden – [TIEUP] and [TREADLING] were taken"
        )
        use_plan = False
    if not use_plan and not (tied and treadled):
        raise WeaveError(
            "[LIFTPLAN]: missing, and so are [TIEUP] and [TREADLING] together – add one or the other"
        )
    return threading, (tied, treadled, planned if use_plan else None)


def _lacking(tied: Lists, treadled: Lists, planned: Lists) -> list[int]:
    """Picks that lift shafts by treadles and have no line in the lift plan, if the treadling has all that it has."""
    if any(shafts and not treadled.get(pick) for pick, shafts in planned.items()):
        return []
    lifting = (pick for pick, treadles in treadled.items() if any(tied.get(t) for t in treadles))
    return sorted(pick for pick in lifting if pick not in planned)


def _threads(sections: Sections, side: str, name: str) -> int:
    """The threads that a side announces, else as many as a table has lines."""
    told = sections.get(side, {}).get("threads", ("", ""))[1]
    return int(told) if told.isascii() and told.isdigit() and len(told) < 10 else len(sections[name])


def count_of(sections: Sections, side: str, lists: Lists, remarks: list[str]) -> int:
    """Threads announced, or as many as there are lines; lines beyond the announced number count too."""
    lines = max(lists, default=0)
    found = lines
    key, value = sections.get(side, {}).get("threads", ("Threads", ""))
    if value and not NUMBER.fullmatch(value.strip()):
        remarks.append(
            f"[{side}] {key}: {shown(value, 30)} is no number of threads – there are lines for {lines}"
        )
    elif value:
        told = int(value)
        found = max(lines, told)
        if lines > told:
            remarks.append(f"[{side}] {key}: {told}, but there are lines for {lines} – {lines} were taken")
    else:
        what = "empty" if "threads" in sections.get(side, {}) else "missing"
        remarks.append(f"[{side}] {key}: {what} – there are lines for {lines}")
    if not 1 <= found <= MOST_THREADS:
        raise WeaveError(f"[{side}] {key}: {found} – 1 to {MOST_THREADS} threads can be read")
    return found


def harness_of(
    sections: Sections, threading: Lists, shed: Shed, size: tuple[int, int], remarks: list[str]
) -> tuple[Harness, bool]:
    """The harness, and whether it is told as a lift plan."""
    tied, treadled, planned = shed
    use_plan, (ends, picks) = planned is not None, size
    _remark_bare("THREADING", threading, ends, "on no shaft", remarks)
    shafts = _most(
        sections, "Shafts", [("THREADING", threading), ("LIFTPLAN", planned), ("TIEUP", tied)], remarks
    )
    if shafts < 1:
        raise WeaveError("[THREADING]: no end is on a shaft – number shafts from 1")
    threaded = _matrix("THREADING", threading, ends, shafts)
    by_treadle = None
    if tied and treadled:
        keys: Lists = {1: list(tied)}
        treadles = max(_most(sections, "Treadles", [("TREADLING", treadled), ("TIEUP", keys)], remarks), 1)
        by_treadle = (
            _matrix("TIEUP", tied, treadles, shafts).T,
            _matrix("TREADLING", treadled, picks, treadles),
        )
    if use_plan:
        plan = _matrix("LIFTPLAN", planned or {}, picks, shafts)
        if by_treadle is not None and np.array_equal(lift_plan(*by_treadle), plan):
            use_plan = False  # both say the same; tie-up and treadling say more
        else:
            if by_treadle is not None:
                remarks.append("[LIFTPLAN] differs from [TIEUP] x [TREADLING]: the lift plan was taken")
            by_treadle = np.eye(shafts, dtype=bool), plan
    assert by_treadle is not None
    tieup, treadling = by_treadle
    if use_plan:
        _remark_bare("LIFTPLAN", planned or {}, picks, "lifts no shaft", remarks)
    else:
        _remark_treadles(treadled or {}, tieup, treadling, remarks)
    if sections.get("WEAVING", {}).get("rising shed", ("", "yes"))[1] == "":
        remarks.append("[WEAVING] Rising Shed: empty – taken for a rising shed")
    if not truth(sections, "WEAVING", "Rising Shed", True):
        # A sinking shed: what is tied goes down, so all other shafts stay up. Told as a lift plan, which is exact.
        tieup, treadling, use_plan = np.eye(shafts, dtype=bool), ~lift_plan(tieup, treadling), True
        remarks.append("[WEAVING] Rising Shed: false – told as the lift plan of a rising shed")
    return Harness(threaded, tieup, treadling), use_plan


def _remark_treadles(treadled: Lists, tieup: np.ndarray, treadling: np.ndarray, remarks: list[str]) -> None:
    _remark_bare("TREADLING", treadled, len(treadling), "on no treadle", remarks)
    idle = np.flatnonzero(treadling.any(axis=0) & ~tieup.any(axis=0))
    if idle.size:
        remarks.append(f"[TIEUP] {listed(idle + 1)}: trodden, but tied to no shaft – lifts nothing")


def truth(sections: Sections, section: str, key: str, default: bool) -> bool:
    """Yes or no; raises WeaveError for another word."""
    written, value = sections.get(section, {}).get(key.lower(), (key, ""))
    word = value.lower()
    if word and word not in TRUE | FALSE:
        raise WeaveError(f"[{section}] {written}: {shown(value, 30)} – give true or false")
    return default if not word else word in TRUE


def announced(sections: Sections, key: str, remarks: list[str]) -> int:
    """The number of shafts or treadles that [WEAVING] announces, 0 where it does not; no lift hangs on it."""
    written, value = sections.get("WEAVING", {}).get(key.lower(), (key, "0"))
    if value.isascii() and value.isdigit() and len(value) < 10 and int(value) <= MOST_SHAFTS:
        return int(value)
    remarks.append(
        f"[WEAVING] {written}: {shown(value, 30)} – not a number up to {MOST_SHAFTS}, counted from the lines"
    )
    return 0


def _most(sections: Sections, key: str, tables: list[tuple[str, Lists | None]], remarks: list[str]) -> int:
    """Shafts or treadles: as many as announced, or as are used."""
    told = announced(sections, key, remarks)
    used = [
        (max((max(v, default=0) for v in (table or {}).values()), default=0), name) for name, table in tables
    ]
    found, name = max(used)
    if told and found > told:
        remarks.append(f"[WEAVING] {key}: {told}, but [{name}] uses {found} – {found} were taken")
    return max(told, found)


def _remark_bare(name: str, lists: Lists, count: int, what: str, remarks: list[str]) -> None:
    bare = [number for number in range(1, count + 1) if not lists.get(number)]
    if bare:
        remarks.append(f"[{name}] {listed(bare)}: {what}")


def _lists(sections: Sections, name: str, what: str) -> Lists:
    """Number -> numbers of a data section; 0 and nothing mean none."""
    if name not in sections:
        raise WeaveError(f"[{name}]: missing – add it")
    made = {}
    for lower, (key, value) in sections[name].items():
        number = whole(lower, name, key, "number the lines from 1")
        if not 1 <= number <= MOST_THREADS:
            raise WeaveError(f"[{name}] {key}: line number – give 1 to {MOST_THREADS}")
        if NUMBERS.fullmatch(value):
            numbers = [int(part[:10]) for part in value.replace(",", " ").split()]
        else:
            parts = [part for part in re.split(r"[,\s]+", value) if part]
            numbers = [whole(part, name, key, f"give {what} numbers, such as 1,3") for part in parts]
        if numbers and max(numbers) > MOST_SHAFTS:
            raise WeaveError(
                f"[{name}] {key}: {shown(value, 30)} – {what} numbers lie between 0 and {MOST_SHAFTS}"
            )
        made[number] = [n for n in numbers if n]
    return made


def _matrix(name: str, lists: Lists, rows: int, columns: int) -> np.ndarray:
    if rows * columns > MOST_CELLS:
        raise WeaveError(
            f"[{name}]: {rows:,} lines of {columns:,} – at most {MOST_CELLS:,} places can be read"
        )
    matrix = np.zeros((rows, columns), bool)
    for number, ones in lists.items():
        if number <= rows:
            matrix[number - 1, np.array(ones, int) - 1] = True
    return matrix
