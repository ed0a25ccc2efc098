"""DXF as simple exporters write it, without the subclass marks that ezdxf asks of newer entities."""

import re

__all__ = ["mended", "spelled_out"]

MARKS = {"LWPOLYLINE": "AcDbPolyline", "SPLINE": "AcDbSpline", "ELLIPSE": "AcDbEllipse"}
HANZI = re.compile(rb"[\xa1-\xa3\xb0-\xf7][\xa1-\xfe]")  # signs and Chinese characters of GB 2312
RARE = re.compile("[\u0180-\u036f]")  # letters that hardly any name of a piece has
COMMON = {"5", "6", "8", "48", "60", "62", "67", "330", "370", "420"}  # tags that every entity may have


def spelled_out(text: bytes) -> bytes:
    """The same drawing, signs beyond ASCII as \\U+4E2D, where it names no code page and is UTF-8 or Chinese (GBK).

    Without a word ezdxf takes such a drawing for Western European, as AutoCAD did.
    """
    if text.isascii() or b"$DWGCODEPAGE" in text:
        return text
    chinese = HANZI.sub(b"", text).isascii()
    try:
        signs = text.decode("utf-8")
        chinese = (
            chinese and RARE.search(signs) is not None
        )  # two Chinese signs may be bytes of UTF-8 by accident
    except UnicodeDecodeError:
        if not chinese:
            return text
        signs = ""
    if chinese:
        signs = text.decode("gb18030", "replace")
    return b"".join(
        c.encode() if c.isascii() else b"".join(rb"\U+%04X" % unit for unit in _units(c)) for c in signs
    )


def _units(sign: str) -> list[int]:
    """A sign in UTF-16: one unit, or two where it lies beyond the first 65,536."""
    pair = sign.encode("utf-16-be", "surrogatepass")
    return [int.from_bytes(pair[k : k + 2], "big") for k in range(0, len(pair), 2)]


def mended(text: bytes) -> bytes:
    """The same drawing, with subclass marks where an LWPOLYLINE, a SPLINE or an ELLIPSE has none."""
    lines = re.split(rb"\r?\n", text)
    marks = {name.encode(): mark.encode() for name, mark in MARKS.items()}
    if not any(line.strip() in marks for line in lines):
        return text
    common = {code.encode() for code in COMMON}
    found: list[bytes] = []
    k = 0
    while k < len(lines) - 1:
        name = lines[k + 1].strip()
        if lines[k].strip() != b"0" or name not in marks:
            found += lines[k : k + 2]
            k += 2
            continue
        end = k + 2
        while end < len(lines) - 1 and lines[end].strip() != b"0":
            end += 2
        tags = [(lines[m], lines[m + 1]) for m in range(k + 2, end, 2)]
        if not any(code.strip() == b"100" for code, _ in tags):
            base = [tag for tag in tags if tag[0].strip() in common]
            own = [tag for tag in tags if tag[0].strip() not in common]
            tags = [(b"100", b"AcDbEntity"), *base, (b"100", marks[name]), *own]
        found += [lines[k], lines[k + 1], *(part for tag in tags for part in tag)]
        k = end
    return _newer(b"\n".join([*found, *lines[k:]]))


def _newer(text: bytes) -> bytes:
    """The drawing with the release that knows these entities in its header: in release 12 ezdxf skips their marks."""
    version = re.search(rb"\$ACADVER\s*\n\s*1\s*\n\s*(AC\d+)", text)
    if version is not None:
        old = version[1] < b"AC1015"
        return text[: version.start(1)] + b"AC1015" + text[version.end(1) :] if old else text
    told = b"9\n$ACADVER\n1\nAC1015\n"
    header = re.search(rb"(?m)^\s*2\s*\nHEADER\s*?\n", text)
    if header is not None:
        return text[: header.end()] + told + text[header.end() :]
    return b"0\nSECTION\n2\nHEADER\n" + told + b"0\nENDSEC\n" + text
