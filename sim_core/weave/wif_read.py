"""Tolerant WIF 1.0/1.1: what programs write, not only what the specification says.

Known traps, each of them with a file in the tests: absent colour lines mean the default colour; palettes of 0-999; any
Date; blanks round "="; yes/true/on/1; keys and sections in any case; CR, LF and CRLF; comments; thread numbers beyond
what was announced; sinking sheds; several shafts an end and several treadles a pick; lift plan beside treadling; no
[CONTENTS]; treadles that nothing is tied to; decimal commas and exponents; lengths a thread in the units of their side;
notes that go on without a number; warps of thousands of ends; colours that are 0 or not in the table.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np

from sim_core.errors import FileProblem, WeaveError
from sim_core.reading import shown
from sim_core.weave.algebra import Harness, lift_plan
from sim_core.weave.draft import MOST
from sim_core.weave.wif import PRIVATE, Wif, centimetres, tidy
from sim_core.weave.wif_sections import KNOWN, Section, decoded, sections_of, whole
from sim_core.weave.wif_threads import MOST_COLOURS, MOST_THREADS, Lists, Shed, cut_to_repeat, thread_colours

__all__ = ["parse_wif", "read_wif"]

LARGEST = 8_000_000  # bytes
TRUE, FALSE = {"true", "yes", "on", "1", "t", "y"}, {"false", "no", "off", "0", "f", "n"}
LONGEST = 1e5  # of a length, in the file's unit
PER_THREAD = {f"{side} {what}" for side in ("WARP", "WEFT") for what in ("SPACING", "THICKNESS")}
METRES = {"decipoints": 0.0254 / 720, "inches": 0.0254, "centimeters": 0.01}


def read_wif(path: str | Path) -> Wif:
    """Read a WIF file; raises FileProblem or WeaveError: file: [SECTION] key: what – remedy."""
    path = Path(path)
    try:
        with path.open("rb") as stream:
            data = stream.read(LARGEST + 1)
    except (OSError, ValueError) as error:
        raise FileProblem(
            f"{path}: {getattr(error, 'strerror', None) or error} – give the path of a WIF file"
        ) from error
    if len(data) > LARGEST:
        raise FileProblem(f"{path}: larger than {LARGEST // 1_000_000} MB – give a WIF file")
    try:
        return parse_wif(decoded(data))
    except WeaveError as error:
        raise WeaveError(f"{path}: {error}") from error


def parse_wif(text: str) -> Wif:
    """The value of a WIF text; raises WeaveError that begins with section and key."""
    sections = sections_of(text)
    if "WIF" not in sections:
        raise WeaveError("[WIF]: missing – every WIF file begins with it")
    version = sections["WIF"].get("version", ("", "1.1"))[1]
    if not re.fullmatch(r"1(\.\d+)?", version.strip()):
        raise WeaveError(f"[WIF] Version: {shown(version)} – 1.0 and 1.1 can be read")
    remarks: list[str] = []
    given, top = _palette(sections)
    threading, shed = _threading_and_shed(sections)
    palette, colours = thread_colours(
        sections, given, _count(sections, "WARP", threading), _picks(sections, shed)
    )
    threading, shed, colours = cut_to_repeat(threading, shed, colours, remarks)
    harness, plan = _harness(sections, threading, shed, (len(colours[0]), len(colours[1])), remarks)
    text_lines = [(key, value) for key, value in sections.get("TEXT", {}).values()]
    wif = Wif(
        title=next((value for key, value in text_lines if key.lower() == "title"), ""),
        harness=harness,
        plan=plan,
        palette=palette,
        top=top,
        warp_colours=colours[0],
        weft_colours=colours[1],
        spacing=(_length(sections, "WARP", "Spacing"), _length(sections, "WEFT", "Spacing")),
        thickness=(_length(sections, "WARP", "Thickness"), _length(sections, "WEFT", "Thickness")),
        text=tuple((key, value) for key, value in text_lines if key.lower() != "title"),
        notes=tuple(value for _, value in sections.get("NOTES", {}).values()),
        other=tuple((name, _kept(sections, name)) for name in sections if name not in KNOWN),
        private=_private(sections),
        remarks=tuple(remarks),
    )
    try:
        wif.draft  # noqa: B018 - what the private section says is judged now
    except WeaveError as error:
        raise WeaveError(f"[{PRIVATE}] 1: {error}") from error
    return wif


def _threading_and_shed(sections: dict[str, Section]) -> tuple[Lists, Shed]:
    """Threading, and tie-up, treadling and lift plan as far as they are there; the plan only where it is used."""
    threading = _lists(sections, "THREADING", "shaft")
    tied, treadled, planned = (
        _lists(sections, name, what) if name in sections else None
        for name, what in (("TIEUP", "shaft"), ("TREADLING", "treadle"), ("LIFTPLAN", "shaft"))
    )
    use_plan = planned is not None and any(planned.values())
    if not use_plan and not (tied and treadled):
        raise WeaveError(
            "[LIFTPLAN]: missing, and so are [TIEUP] and [TREADLING] together – add one or the other"
        )
    return threading, (tied, treadled, planned if use_plan else None)


def _picks(sections: dict[str, Section], shed: Shed) -> int:
    _, treadled, planned = shed
    return _count(sections, "WEFT", (planned if planned is not None else treadled) or {})


def _harness(
    sections: dict[str, Section], threading: Lists, shed: Shed, size: tuple[int, int], remarks: list[str]
) -> tuple[Harness, bool]:
    tied, treadled, planned = shed
    use_plan, (ends, picks) = planned is not None, size
    lists = [threading, planned or {}] + ([tied] if tied else [])
    shafts = max(
        _weaving(sections, "Shafts"),
        *(max((max(v, default=0) for v in d.values()), default=0) for d in lists),
    )
    if shafts < 1:
        raise WeaveError("[THREADING]: no end is on a shaft – number shafts from 1")
    threaded = _matrix(threading, ends, shafts)
    by_treadle = None
    if tied and treadled:
        most = max(max(v, default=0) for v in treadled.values())
        treadles = max(_weaving(sections, "Treadles"), max(tied), most, 1)
        by_treadle = _matrix(tied, treadles, shafts).T, _matrix(treadled, picks, treadles)
    if use_plan:
        plan = _matrix(planned or {}, picks, shafts)
        if by_treadle is not None and np.array_equal(lift_plan(*by_treadle), plan):
            use_plan = False  # both say the same; tie-up and treadling say more
        else:
            if by_treadle is not None:
                remarks.append("[LIFTPLAN] differs from [TIEUP] x [TREADLING]: the lift plan was taken")
            by_treadle = np.eye(shafts, dtype=bool), plan
    assert by_treadle is not None
    tieup, treadling = by_treadle
    if not _truth(sections, "WEAVING", "Rising Shed", True):
        # A sinking shed: what is tied goes down, so all other shafts stay up. Told as a lift plan, which is exact.
        tieup, treadling, use_plan = np.eye(shafts, dtype=bool), ~lift_plan(tieup, treadling), True
    return Harness(threaded, tieup, treadling), use_plan


def _lists(sections: dict[str, Section], name: str, what: str) -> dict[int, list[int]]:
    """Number -> numbers of a data section; 0 and nothing mean none."""
    if name not in sections:
        raise WeaveError(f"[{name}]: missing – add it")
    made = {}
    for lower, (key, value) in sections[name].items():
        number = whole(lower, name, key, "number the lines from 1")
        if not 1 <= number <= MOST_THREADS:
            raise WeaveError(f"[{name}] {key}: line number – give 1 to {MOST_THREADS}")
        parts = [part for part in re.split(r"[,\s]+", value) if part]
        numbers = [whole(part, name, key, f"give {what} numbers, such as 1,3") for part in parts]
        if any(not 0 <= n <= MOST for n in numbers):
            raise WeaveError(f"[{name}] {key}: {shown(value, 30)} – {what} numbers lie between 0 and {MOST}")
        made[number] = [n for n in numbers if n]
    return made


def _matrix(lists: dict[int, list[int]], rows: int, columns: int) -> np.ndarray:
    matrix = np.zeros((rows, columns), bool)
    for number, ones in lists.items():
        if number <= rows:
            matrix[number - 1, np.array(ones, int) - 1] = True
    return matrix


def _count(sections: dict[str, Section], side: str, lists: dict[int, list[int]]) -> int:
    """Threads announced, or as many as there are lines; lines beyond the announced number count too."""
    found = max(lists, default=0)
    if "threads" in sections.get(side, {}):
        key, value = sections[side]["threads"]
        found = max(found, whole(value, side, key, "give the number of threads"))
    if not 1 <= found <= MOST_THREADS:
        raise WeaveError(f"[{side}] Threads: {found} – 1 to {MOST_THREADS} threads can be read")
    return found


def _weaving(sections: dict[str, Section], key: str) -> int:
    written, value = sections.get("WEAVING", {}).get(key.lower(), (key, "0"))
    number = whole(value, "WEAVING", written, "give a number")
    if number > MOST:
        raise WeaveError(f"[WEAVING] {written}: {number} – at most {MOST}")
    return number


def _truth(sections: dict[str, Section], section: str, key: str, default: bool) -> bool:
    written, value = sections.get(section, {}).get(key.lower(), (key, ""))
    word = value.lower()
    if word and word not in TRUE | FALSE:
        raise WeaveError(f"[{section}] {written}: {shown(value, 30)} – give true or false")
    return default if not word else word in TRUE


def _palette(sections: dict[str, Section]) -> tuple[np.ndarray, int]:
    head, table = sections.get("COLOR PALETTE", {}), sections.get("COLOR TABLE", {})
    key, value = head.get("range", ("Range", "0,255"))
    bounds = [whole(part, "COLOR PALETTE", key, "give 0,255 or 0,999") for part in value.split(",")]
    if len(bounds) != 2 or not 0 <= bounds[0] < bounds[1] <= 65535:
        raise WeaveError(f"[COLOR PALETTE] {key}: {shown(value, 30)} – give 0,255 or 0,999")
    colours: dict[int, list[int]] = {}
    for lower, (key, value) in table.items():
        number = whole(lower, "COLOR TABLE", key, "number the colours from 1")
        parts = [whole(part, "COLOR TABLE", key, "give red,green,blue") for part in value.split(",")]
        if len(parts) != 3 or not 1 <= number <= MOST_COLOURS:
            raise WeaveError(
                f"[COLOR TABLE] {key}: {shown(value, 30)} – give red,green,blue, colours 1 to {MOST_COLOURS}"
            )
        colours[number] = [min(max(part, bounds[0]), bounds[1]) - bounds[0] for part in parts]
    top = bounds[1] - bounds[0]
    palette = np.full((max(colours, default=2), 3), top)
    for number, colour in colours.items():
        palette[number - 1] = colour
    if not colours:
        palette[1] = 0
    return palette, top


def _length(sections: dict[str, Section], side: str, key: str) -> float | None:
    written, value = sections.get(side, {}).get(key.lower(), (key, ""))
    return tidy(_metres(sections, side, side, written, value)) if value else None


def _kept(sections: dict[str, Section], name: str) -> tuple[tuple[str, str], ...]:
    """Lines of a section that is kept; lengths a thread in centimetres, as the writer announces them."""
    lines = tuple(sections[name].values())
    if name not in PER_THREAD:
        return lines
    side = name.split()[0]
    return tuple(
        (key, centimetres(_metres(sections, side, name, key, value)) if value else "") for key, value in lines
    )


def _metres(sections: dict[str, Section], side: str, section: str, key: str, value: str) -> float:
    unit = sections.get(side, {}).get("units", ("Units", "centimeters"))[1].lower() or "centimeters"
    if unit not in METRES:
        raise WeaveError(f"[{side}] Units: {shown(unit, 30)} – Decipoints, Inches or Centimeters")
    if not re.fullmatch(r"\+?(\d{1,9}([.,]\d{0,20})?|[.,]\d{1,20})(e[+-]?\d{1,2})?", value, re.ASCII | re.I):
        raise WeaveError(f"[{section}] {key}: {shown(value, 30)} is not a length – give a number")
    number = float(value.replace(",", "."))  # some programs write the comma of their country
    if number > LONGEST:
        raise WeaveError(f"[{section}] {key}: {shown(value, 30)} – give at most {LONGEST:g} {unit}")
    return number / 100 if unit == "centimeters" else number * METRES[unit]


def _private(sections: dict[str, Section]) -> dict | None:
    if PRIVATE not in sections:
        return None
    lines = sections[PRIVATE]
    values = (lines[str(k)][1] if str(k) in lines else "" for k in range(1, len(lines) + 1))
    text = "".join(value.removeprefix('"').removesuffix('"') for value in values)
    try:
        value = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise WeaveError(
            f"[{PRIVATE}] 1: damaged ({type(error).__name__}) – remove the section or copy it again"
        ) from error
    if not isinstance(value, dict):
        raise WeaveError(f"[{PRIVATE}] 1: not an object – remove the section or copy it again")
    return value
