"""Bytes of a WIF file to sections of keys and values, and letters beyond ASCII to references and back."""

from __future__ import annotations

import re
from collections.abc import Iterable

from sim_core.errors import WeaveError
from sim_core.reading import shown
from sim_core.weave.wif import PRIVATE

__all__ = ["KNOWN", "Section", "decoded", "escaped", "listed", "sections_of", "unescaped", "whole"]

KNOWN = {
    "WIF", "CONTENTS", "COLOR PALETTE", "TEXT", "WEAVING", "WARP", "WEFT", "NOTES", "COLOR TABLE", "THREADING", "TIEUP",
    "TREADLING", "LIFTPLAN", "WARP COLORS", "WEFT COLORS", PRIVATE,
}  # fmt: skip
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
    stray: dict[str, list[tuple[int, str]]] = {}
    twice: dict[str, list[str]] = {}
    for number, raw in enumerate(re.split(r"\r\n|\r|\n", text), 1):
        line = raw.strip().strip("\x00\x1a")
        if not line or line[0] in ";#":
            continue
        if line[0] == "[":
            name, bracket, _ = line[1:].partition("]")
            if not bracket:
                raise WeaveError(f"line {number}: {shown(line, 30)} – close the section with ]")
            name = " ".join(name.split()).upper()
            current = sections.setdefault(name, {})
            continue
        key, equals, value = line.partition("=")
        if current is None:
            stray.setdefault("", []).append((number, line))
            continue
        if not equals and not (name in NEEDED and line.isascii() and line.isdigit()):
            if _is_lost(current, name, number, line):
                stray.setdefault(name, []).append((number, line))
            continue
        if name not in VERBATIM and not name.startswith("PRIVATE"):
            value = value.partition(";")[0]
        key, value = key.strip(), value.strip()
        if name != PRIVATE:
            key, value = unescaped(key), unescaped(value)
        if name in KNOWN and current.get(key.lower(), ("", value))[1] != value:
            twice.setdefault(name, []).append(key)
        current[key.lower()] = (key, value)
    if not sections and stray:
        number, line = stray[""][0]
        raise WeaveError(f"line {number}: {shown(line, 30)} – a WIF file begins with [WIF]")
    return sections, _told(stray, twice)


def _is_lost(current: Section, name: str, number: int, line: str) -> bool:
    """Whether a line without "=" is passed over; it is a note, or nothing to us in another program's section."""
    if name in NEEDED:
        raise WeaveError(f"[{name}] line {number}: {shown(line, 30)} – write key=value")
    if name == "NOTES":
        current[f"line {number}"] = ("", unescaped(line))
    return name in KNOWN and name != "NOTES"


def _told(stray: dict[str, list[tuple[int, str]]], twice: dict[str, list[str]]) -> list[str]:
    remarks = []
    for name, lines in stray.items():
        number, line = lines[0]
        more = f", and {len(lines) - 1} more such lines" if len(lines) > 1 else ""
        where = f"[{name}] line" if name else "line"
        remarks.append(f"{where} {number}: {shown(line, 30)} says nothing here – passed over{more}")
    for name, keys in twice.items():
        remarks.append(f"[{name}] {listed(keys)}: said twice – the last word counts")
    return remarks


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
