"""Bytes of a WIF file to sections of keys and values, and letters beyond ASCII to references and back."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from difflib import get_close_matches

from sim_core.errors import WeaveError
from sim_core.validation.files import shown
from sim_core.weave.files.wif.model import PRIVATE

__all__ = [
    "FALSE", "KNOWN", "TRUE", "Section", "decoded", "escaped", "from_one", "listed", "sections_of", "unescaped",
    "unfit_sections", "whole",
]  # fmt: skip

KNOWN = {
    "WIF", "CONTENTS", "COLOR PALETTE", "TEXT", "WEAVING", "WARP", "WEFT", "NOTES", "COLOR TABLE", "THREADING", "TIEUP",
    "TREADLING", "LIFTPLAN", "WARP COLORS", "WEFT COLORS", PRIVATE,
}  # fmt: skip
SECTIONS = KNOWN | {
    f"{side} {what}" for side in ("WARP", "WEFT")
    for what in ("SPACING", "SPACING ZOOM", "THICKNESS", "THICKNESS ZOOM", "SYMBOLS", "SYMBOL TABLE", "SYMBOL PALETTE")
}  # fmt: skip
TRUE, FALSE = {"true", "yes", "on", "1", "t", "y"}, {"false", "no", "off", "0", "f", "n"}
VERBATIM = {"TEXT", "NOTES"}  # sections in which ";" is no comment
# In these a line without "=" may be a thread or a treadle that was meant; elsewhere nothing is lost with it.
NEEDED = {"THREADING", "TIEUP", "TREADLING", "LIFTPLAN"}
Section = dict[str, tuple[str, str]]  # lower-case key -> key as written, value


def escaped(text: str) -> str:
    """One line of ASCII: other letters as &#number;, so that `unescaped` gives them back."""
    line = re.sub(r"[\r\n]+", " ", text).replace("&#", "&#38;#")
    return line.encode("ascii", "xmlcharrefreplace").decode("ascii")


def unescaped(text: str) -> str:
    """Letters for their &#number;; numbers of plain ASCII other than & and of no letter stay as they are."""

    def letter(found: re.Match) -> str:
        number = int(found[1])
        good = number == 38 or 127 < number < 0xD800 or 0xDFFF < number < 0x110000
        return chr(number) if good else found[0]

    return re.sub(r"&#([0-9]{1,7});", letter, text)


def decoded(data: bytes) -> str:
    """The text of a file's bytes: UTF-8, UTF-16 with its mark, else what Windows programs of 1997 wrote."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data.decode("utf-16", errors="replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", errors="replace")


def sections_of(text: str) -> tuple[dict[str, Section], list[str]]:
    """Sections by upper-case name, and remarks on lines that were passed over; raises WeaveError that names the line.

    A line without "=" is a further line of the [NOTES], passed over with a remark where it may have been meant, and
    nothing in sections of other programs. In tables of numbers, "3" without "=" is a thread of which nothing is said.
    """
    sections: dict[str, Section] = {}
    current: Section | None = None
    name = ""
    odd = _Odd()
    for number, raw in enumerate(re.split(r"\r\n|\r|\n", text), 1):
        line = raw.strip().strip("\x00\x1a")
        if not line or line[0] in ";#":
            continue
        if line[0] == "[" and _is_header(line, name, number, odd):
            name = " ".join(line[1:].partition("]")[0].split()).upper()
            current = sections.setdefault(name, {})
            continue
        key, equals, value = line.partition("=")
        if current is None:
            odd.stray.setdefault("", []).append((number, line))
            continue
        if not equals and not (name in NEEDED and line.isascii() and line.isdigit()):
            if _is_lost(current, name, number, line):
                odd.stray.setdefault(name, []).append((number, line))
            continue
        if name not in VERBATIM and not name.startswith("PRIVATE"):
            value, _, comment = value.partition(";")
            if name in NEEDED and re.fullmatch(r"[\s\d,;]*\d[\s\d,;]*", comment, re.ASCII):
                odd.commented.setdefault(name, []).append(key.strip())
        key, value = key.strip(), value.strip()
        if name != PRIVATE:
            key, value = unescaped(key), unescaped(value)
        if name in KNOWN and current.get(key.lower(), ("", value))[1] != value:
            odd.twice.setdefault(name, []).append(key)
        current[key.lower()] = (key, value)
    if not sections and odd.stray:
        number, line = odd.stray[""][0]
        raise WeaveError(f"line {number}: {shown(line, 30)} – a WIF file begins with [WIF]")
    return sections, odd.told()


@dataclass
class _Odd:
    """What was passed over or settled line by line: by section, numbers and texts of lines, or keys."""

    stray: dict[str, list[tuple[int, str]]] = field(default_factory=dict)
    twice: dict[str, list[str]] = field(default_factory=dict)
    commented: dict[str, list[str]] = field(default_factory=dict)
    unclosed: list[str] = field(default_factory=list)

    def told(self) -> list[str]:
        remarks = list(self.unclosed)
        for name, lines in self.stray.items():
            number, line = lines[0]
            more = f", and {len(lines) - 1} more such lines" if len(lines) > 1 else ""
            where = f"[{name}] line" if name else "line"
            remarks.append(f"{where} {number}: {shown(line, 30)} says nothing here – passed over{more}")
        for name, keys in self.twice.items():
            remarks.append(f"[{name}] {listed(keys)}: said twice – the last word counts")
        for name, keys in self.commented.items():
            remarks.append(f"[{name}] {listed(keys)}: what follows ; is a comment – commas part numbers")
        return remarks


def _is_header(line: str, name: str, number: int, odd: _Odd) -> bool:
    """Whether a line that begins with [ is the head of a section; raises WeaveError where a lift may hang on it."""
    if "]" in line:
        return True
    if name in VERBATIM and " ".join(line[1:].split()).upper() not in KNOWN:
        return False
    if " ".join(line[1:].split()).upper() not in KNOWN - NEEDED:
        raise WeaveError(f"line {number}: {shown(line, 30)} – close the section with ]")
    odd.unclosed.append(f"line {number}: {shown(line, 30)} has no ] – taken for the head of that section")
    return True


def _is_lost(current: Section, name: str, number: int, line: str) -> bool:
    """Whether a line without "=" is passed over; it is a note, or nothing to us in another program's section."""
    if name in NEEDED:
        raise WeaveError(f"[{name}] line {number}: {shown(line, 30)} – write key=value")
    if name == "NOTES":
        current[f"line {number}"] = ("", unescaped(line))
    return name in KNOWN and name != "NOTES"


def unfit_sections(sections: dict[str, Section]) -> list[str]:
    """Remarks on sections that [CONTENTS] announces and the file does not have, and on names that look misspelt."""
    lacking = [
        key
        for lower, (key, value) in sections.get("CONTENTS", {}).items()
        if value.lower() in TRUE and lower.upper() in SECTIONS and lower.upper() not in sections
    ]
    remarks = [f"[CONTENTS] {listed(lacking)}: announced, but not in the file"] if lacking else []
    for name in sections:
        near = [] if name in SECTIONS else get_close_matches(name, SECTIONS - sections.keys(), 1, 0.84)
        if near:
            remarks.append(f"[{name}]: no section of WIF, and left out – is [{near[0]}] meant?")
    return remarks


def from_one(name: str, lines: Section, count: int, remarks: list[str]) -> Section:
    """The lines of a table of so many threads, numbered from 1, with a remark where the file numbers them from 0."""
    if "0" not in lines or str(count) in lines:
        return lines
    remarks.append(f"[{name}]: its threads are numbered from 0 – counted from 1")
    return {
        str(int(k) + 1) if k.isascii() and k.isdigit() and len(k) < 10 else k: line
        for k, line in lines.items()
    }


def listed(numbers: Iterable[object], most: int = 4) -> str:
    """The first few of many, and how many more there are: "4, 5, 6, 9 and 12 more"."""
    texts = [str(number)[:20] for number in numbers]
    more = len(texts) - most
    return ", ".join(texts[:most]) + (f" and {more} more" if more > 0 else "")


def whole(text: str, section: str, key: str, remedy: str) -> int:
    """The whole number of at most nine digits that a text is; raises WeaveError that names section and key."""
    if not re.fullmatch(r"\s*\d{1,9}\s*", text, re.ASCII):
        raise WeaveError(f"[{section}] {key}: {shown(text, 30)} is not a whole number – {remedy}")
    return int(text)
