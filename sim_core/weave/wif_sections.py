"""Bytes of a WIF file to sections of keys and values, and letters beyond ASCII to references and back."""

from __future__ import annotations

import re

from sim_core.errors import WeaveError
from sim_core.reading import shown
from sim_core.weave.wif import PRIVATE

__all__ = ["KNOWN", "Section", "decoded", "escaped", "sections_of", "unescaped", "whole"]

KNOWN = {
    "WIF", "CONTENTS", "COLOR PALETTE", "TEXT", "WEAVING", "WARP", "WEFT", "NOTES", "COLOR TABLE", "THREADING", "TIEUP",
    "TREADLING", "LIFTPLAN", "WARP COLORS", "WEFT COLORS", PRIVATE,
}  # fmt: skip
VERBATIM = {"TEXT", "NOTES"}  # sections in which ";" is no comment
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


def sections_of(text: str) -> dict[str, Section]:
    """Sections by upper-case name; raises WeaveError that names the line.

    Lines without "=" are a further line of the [NOTES], and nothing in sections of other programs.
    """
    sections: dict[str, Section] = {}
    current: Section | None = None
    name = ""
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
        if not equals:
            if current is None:
                raise WeaveError(f"line {number}: {shown(line, 30)} – a WIF file begins with [WIF]")
            if name == "NOTES":
                current[f"line {number}"] = ("", unescaped(line))
            elif name in KNOWN:
                raise WeaveError(f"[{name}] line {number}: {shown(line, 30)} – write key=value")
            continue
        if current is None:
            raise WeaveError(f"line {number}: {shown(line, 30)} – a WIF file begins with [WIF]")
        if name not in VERBATIM and not name.startswith("PRIVATE"):
            value = value.partition(";")[0]
        key, value = key.strip(), value.strip()
        if name != PRIVATE:
            key, value = unescaped(key), unescaped(value)
        current[key.lower()] = (key, value)
    return sections


def whole(text: str, section: str, key: str, remedy: str) -> int:
    """The whole number of at most nine digits that a text is; raises WeaveError that names section and key."""
    if not re.fullmatch(r"\s*\d{1,9}\s*", text, re.ASCII):
        raise WeaveError(f"[{section}] {key}: {shown(text, 30)} is not a whole number – {remedy}")
    return int(text)
