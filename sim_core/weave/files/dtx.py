"""Fiberworks' own .dtx drafts, read as the sections of a WIF file that says the same.

A section begins with @@ and a name; lines with %% say something about it. Threading, treadling, colours and spacings
are numbers with blanks between, several treadles of a pick with commas; tie-up and lift plan are rows of 0 and 1, the
tie-up with shaft 1 as its last row; colours are numbered from 0, and spacings count .053 cm.
"""

from __future__ import annotations

import re
from pathlib import Path

from sim_core.errors import WeaveError
from sim_core.validation.files import shown
from sim_core.weave.files.wif.model import Wif
from sim_core.weave.files.wif.reader import read_bytes, wif_of_sections
from sim_core.weave.files.wif.sections import Section, decoded, listed

__all__ = ["parse_dtx", "read_dtx"]

SPACE = 0.053  # cm of one step of spacing
USUAL = 4  # steps
Block = tuple[dict[str, str], list[str]]  # what the %% lines say, and the other lines


def read_dtx(path: str | Path) -> Wif:
    """Read a .dtx file; raises FileProblem or WeaveError: file: [SECTION] key: what – remedy."""
    path = Path(path)
    try:
        return parse_dtx(decoded(read_bytes(path, "a .dtx file")))
    except WeaveError as error:
        raise WeaveError(f"{path}: {error}") from error


def parse_dtx(text: str) -> Wif:
    """The value of a .dtx text; raises WeaveError that begins with the section, named as in WIF."""
    remarks: list[str] = []
    blocks = _blocks(text, remarks)
    sections: dict[str, Section] = {"THREADING": _numbered(_words(blocks, "threading"))}
    if "threading" not in blocks:
        raise WeaveError("@@Threading: missing – a .dtx file has it")
    info = blocks.get("info", ({}, []))[0]
    sections["WEAVING"] = _keyed(
        {
            "Shafts": info.get("shafts", "0"),
            "Treadles": info.get("treadles", "0"),
            "Rising Shed": "false" if _sinks(blocks) else "true",
        }
    )
    if "tieup" in blocks:
        sections["TIEUP"] = _tied(_rows(blocks, "tieup"))
    if "treadling" in blocks:
        sections["TREADLING"] = _numbered(_words(blocks, "treadling"))
    if "liftplan" in blocks:
        rows = _rows(blocks, "liftplan")
        sections["LIFTPLAN"] = _numbered([_ones(row) for row in rows])
    remarks += _lacking(blocks)
    table = blocks.get("color palet", blocks.get("color palette"))
    if table:
        sections["COLOR TABLE"] = _numbered(table[1], first=0)
    for side, told in (("WARP", "ends"), ("WEFT", "picks")):
        sections[side] = _side(told, info.get(told, ""))
        colours = _words(blocks, f"{side.lower()} colors")
        sections[f"{side} COLORS"] = _numbered(colours)
        announced = info.get(told, "")
        if colours and re.fullmatch(r"\d{1,9}", announced, re.ASCII) and len(colours) < int(announced):
            remarks.append(
                f"@@{side.title()} Colors: {len(colours)} of {info[told]} {told} – the others have the first"
            )
        # threads beyond the list have the first colour of it, as in the WIF that Fiberworks writes
        if f"{side.lower()} colors" in blocks:
            usual = colours[0] if colours else "0" if side == "WARP" else "1"
            sections[side]["color"] = ("Color", usual)
        steps = _words(blocks, f"{side.lower()} spacing")
        if steps:
            sections[f"{side} SPACING"] = _numbered([_centimetres(step) for step in steps])
    title = " ".join(blocks.get("description", ({}, []))[1])
    sections["TEXT"] = _keyed({"Title": title}) if title else {}
    sections["NOTES"] = _numbered(blocks.get("notes", ({}, []))[1])
    return wif_of_sections(sections, remarks, first_colour=0)


def _blocks(text: str, remarks: list[str]) -> dict[str, Block]:
    blocks: dict[str, Block] = {}
    current: Block | None = None
    for number, raw in enumerate(re.split(r"\r\n|\r|\n", text), 1):
        line = raw.strip().strip("\x00\x1a")
        if not line:
            continue
        if line.startswith("@@"):
            current = blocks.setdefault(" ".join(line[2:].lower().split()), ({}, []))
        elif current is None:
            remarks.append(f"line {number}: {shown(line, 30)} says nothing here – passed over")
        elif line.startswith("%%"):
            key, _, value = line.lstrip("%").strip().partition(" ")
            current[0][key.lower()] = value.strip()
        else:
            current[1].append(line)
    if "startdtx" not in blocks:
        raise WeaveError("@@StartDTX: missing – every .dtx file begins with it")
    return blocks


def _lacking(blocks: dict[str, Block]) -> list[str]:
    """Remarks on what a whole file has: its end, the sections that it announces, a row of the tie-up a shaft."""
    remarks = [] if "enddtx" in blocks else ["@@EndDTX: missing – the file seems to be cut off"]
    if "info" not in blocks:
        remarks.append("@@Info: missing – ends, picks, shafts and treadles were counted")
    names = {" ".join(line.lower().split()): line for line in blocks.get("contents", ({}, []))[1]}
    lacking = [line for name, line in names.items() if name.replace("palette", "palet") not in
               {block.replace("palette", "palet") for block in blocks} | {"enddtx"}]  # fmt: skip
    if lacking:
        remarks.append(f"@@Contents {listed(lacking)}: announced, but not in the file")
    shafts = [int(n) for n in re.findall(r"\b\d{1,6}\b", " ".join(_words(blocks, "threading")))]
    rows = len(blocks["tieup"][1]) if "tieup" in blocks else 0
    if rows and shafts and rows < max(shafts):
        remarks.append(
            f"@@Tieup: {rows} rows, but ends on shaft {max(shafts)} – the last row was taken for shaft 1"
        )
    return remarks


def _words(blocks: dict[str, Block], name: str) -> list[str]:
    """Entries with blanks between; blanks after a comma do not count."""
    return re.sub(r"\s*,\s*", ",", " ".join(blocks.get(name, ({}, []))[1])).split()


def _rows(blocks: dict[str, Block], name: str) -> list[str]:
    rows = [re.sub(r"[,\s]", "", line) for line in blocks[name][1]]
    for number, row in enumerate(rows, 1):
        if row.strip("01") or len(row) != len(rows[0]):
            raise WeaveError(
                f"[{name.upper()}] row {number}: {shown(row, 30)} – give {len(rows[0])} places of 0 and 1"
            )
    return rows


def _sinks(blocks: dict[str, Block]) -> bool:
    name = "tieup" if "tieup" in blocks else "liftplan"
    return "sinking" in blocks.get(name, ({}, []))[0]


def _tied(rows: list[str]) -> Section:
    """Treadle -> shafts; the last row is shaft 1."""
    columns = zip(*reversed(rows), strict=True)
    return _numbered([_ones("".join(column)) for column in columns])


def _ones(row: str) -> str:
    return ",".join(str(k + 1) for k, place in enumerate(row) if place == "1")


def _centimetres(steps: str) -> str:
    return f"{int(steps) * SPACE:.3f}" if re.fullmatch(r"\d{1,6}", steps, re.ASCII) else steps


def _side(told: str, threads: str) -> Section:
    values = _keyed({"Units": "centimeters", "Spacing": f"{USUAL * SPACE:.3f}"})
    return values | ({"threads": (f"%%{told}", threads)} if threads else {})


def _keyed(values: dict[str, str]) -> Section:
    return {key.lower(): (key, value) for key, value in values.items()}


def _numbered(values: list[str], first: int = 1) -> Section:
    return {str(k): (str(k), value) for k, value in enumerate(values, first)}
