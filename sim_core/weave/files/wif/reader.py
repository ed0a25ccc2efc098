"""Tolerant WIF 1.0/1.1: what programs write, not only what the specification says.

Known traps, each of them with a file in the tests: absent colour lines mean the default colour; palettes of 0-999; any
Date; blanks round "="; yes/true/on/1; keys and sections in any case; CR, LF and CRLF; comments; thread numbers beyond
what was announced; sinking sheds; several shafts an end and several treadles a pick; lift plan beside treadling; no
[CONTENTS]; treadles that nothing is tied to; decimal commas and exponents; lengths a thread in the units of their side;
notes that go on without a number; warps of thousands of ends; colours that are 0 or not in the table; lines that are
no lines; text before the first section; tables of colours from 0 or with a range of their own.

Only what tells the lift can make a file unreadable. Colours, sizes and texts that make no sense are replaced or left
out, and each replacement is a remark.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

from sim_core.errors import FileProblem, WeaveError
from sim_core.validation.files import shown
from sim_core.weave.draft.algebra import Harness
from sim_core.weave.files.wif.colours import palette_of, thread_colours
from sim_core.weave.files.wif.model import PRIVATE, Wif, centimetres, tidy
from sim_core.weave.files.wif.sections import KNOWN, Section, decoded, sections_of, unfit_sections
from sim_core.weave.files.wif.threads import count_of, harness_of, shed_of

__all__ = ["parse_wif", "read_bytes", "read_wif", "wif_of_sections"]

LARGEST = 64_000_000  # bytes; the lift plan of a jacquard of 4,000 x 4,000 has about 40 MB
LONGEST = 1e5  # of a length, in the file's unit
PER_THREAD = {f"{side} {what}" for side in ("WARP", "WEFT") for what in ("SPACING", "THICKNESS")}
METRES = {"decipoints": 0.0254 / 720, "inches": 0.0254, "centimeters": 0.01}


def read_wif(path: str | Path) -> Wif:
    """Read a WIF file; raises FileProblem or WeaveError: file: [SECTION] key: what – remedy."""
    path = Path(path)
    try:
        return parse_wif(decoded(read_bytes(path, "a WIF file")))
    except WeaveError as error:
        raise WeaveError(f"{path}: {error}") from error


def read_bytes(path: Path, what: str) -> bytes:
    """The bytes of a draft's file; raises FileProblem where it cannot be read or is larger than 64 MB."""
    try:
        with path.open("rb") as stream:
            data = stream.read(LARGEST + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise FileProblem(f"{path}: {reason} – give the path of {what}") from error
    if len(data) > LARGEST:
        raise FileProblem(f"{path}: larger than {LARGEST // 1_000_000} MB – give {what}")
    return data


def parse_wif(text: str) -> Wif:
    """The value of a WIF text; raises WeaveError that begins with section and key.

    What had to be replaced or passed over so that the draft could be read is told in `remarks`.
    """
    sections, remarks = sections_of(text)
    if "WIF" not in sections:
        # some programs leave it out; what begins with another section is another kind of file
        if next(iter(sections), "") not in KNOWN or "THREADING" not in sections:
            raise WeaveError("[WIF]: missing – every WIF file begins with it")
        remarks.append("[WIF]: missing – read as version 1.1")
    version = sections.get("WIF", {}).get("version", ("", "1.1"))[1]
    if not re.fullmatch(r"(1(\.\d+)?)?", version.strip()):
        raise WeaveError(f"[WIF] Version: {shown(version)} – 1.0 and 1.1 can be read")
    if not version:
        remarks.append("[WIF] Version: empty – read as version 1.1")
    return wif_of_sections(sections, remarks + unfit_sections(sections))


def wif_of_sections(sections: dict[str, Section], remarks: list[str], first_colour: int | None = None) -> Wif:
    """The value of the sections of a WIF file, or of a file that says the same in another form.

    first_colour: the number that such a form gives to its first colour; WIF's tables tell theirs.
    """
    threading, shed = shed_of(sections, remarks)
    _, treadled, planned = shed
    counts = (
        count_of(sections, "WARP", threading, remarks),
        count_of(sections, "WEFT", (planned if planned is not None else treadled) or {}, remarks),
    )
    table = palette_of(sections, remarks, first_colour)
    palette, colours = thread_colours(sections, table, counts, remarks)
    harness, plan = harness_of(sections, threading, shed, counts, remarks)
    text_lines = [(key, value) for key, value in sections.get("TEXT", {}).values()]
    return Wif(
        title=next((value for key, value in text_lines if key.lower() == "title"), ""),
        harness=harness,
        plan=plan,
        palette=palette,
        top=table[1],
        warp_colours=colours[0],
        weft_colours=colours[1],
        spacing=_lengths(sections, "Spacing", remarks),
        thickness=_lengths(sections, "Thickness", remarks),
        text=tuple((key, value) for key, value in text_lines if key.lower() != "title"),
        notes=tuple(value for _, value in sections.get("NOTES", {}).values()),
        other=tuple((name, _kept(sections, name, remarks)) for name in sections if name not in KNOWN),
        private=_private(sections, harness, remarks),
        remarks=tuple(remarks),
    )


def _lengths(sections: dict[str, Section], key: str, remarks: list[str]) -> tuple[float | None, float | None]:
    return _length(sections, "WARP", key, remarks), _length(sections, "WEFT", key, remarks)


def _length(sections: dict[str, Section], side: str, key: str, remarks: list[str]) -> float | None:
    """Spacing or thickness of a side [m]; None with a remark where it is no length, since no draft needs it."""
    written, value = sections.get(side, {}).get(key.lower(), (key, ""))
    try:
        length = tidy(_metres(sections, side, side, written, value)) if value else None
    except WeaveError as error:
        remarks.append(f"{error} (left out)")
        return None
    if length == 0:
        remarks.append(f"[{side}] {written}: {shown(value, 30)} is no length – give more (left out)")
    return length or None


def _kept(sections: dict[str, Section], name: str, remarks: list[str]) -> tuple[tuple[str, str], ...]:
    """Lines of a section that is kept; lengths a thread in centimetres, as the writer announces them."""
    lines = tuple(sections[name].values())
    if name not in PER_THREAD:
        return lines
    side = name.split()[0]
    try:
        return tuple(
            (key, centimetres(_metres(sections, side, name, key, value)) if value else "")
            for key, value in lines
        )
    except WeaveError as error:
        remarks.append(f"{error} (the section was left out)")
        return ()


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


def _private(sections: dict[str, Section], harness: Harness, remarks: list[str]) -> dict | None:
    """The JSON of our own section; None with a remark where it is damaged, for the draft is told beside it."""
    if PRIVATE not in sections:
        return None
    lines = sections[PRIVATE]
    values = (lines[str(k)][1] if str(k) in lines else "" for k in range(1, len(lines) + 1))
    text = "".join(value.removeprefix('"').removesuffix('"') for value in values)
    try:
        value = json.loads(text)
        if not isinstance(value, dict):
            raise WeaveError("not an object")
        Wif("", harness, private=value).draft  # noqa: B018 - judged now, not when it is woven
    except (ValueError, RecursionError) as error:  # WeaveError among them
        reason = f"{error}" if isinstance(error, WeaveError) else f"damaged ({type(error).__name__})"
        remarks.append(f"[{PRIVATE}]: {reason} – left out; copy the section again")
        return None
    return value
