"""Lines of a DXF drawing, read by ezdxf: text or binary, release 10 to 2018, blocks where they are inserted.

ezdxf mends what is broken and decodes by the drawing's own code page; what is left to do here is to add the subclass
marks that simple exporters leave out, to follow inserts with a bound on their number, to leave out what is hidden, and
to keep the layer and the block of every line.
"""

from __future__ import annotations

import logging
import re
import struct
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from sim_core.errors import FileProblem
from sim_core.mesh.outline.contours import LARGEST
from sim_core.mesh.sheets.strokes.stroke import MOST_VISITED, Drawn, Stroke, visited
from sim_core.mesh.sheets.strokes.words import furnishes, spoken
from sim_core.validation.files import read_bytes

__all__ = ["dxf_strokes"]

METRES = {0: 1e-3, 1: 0.0254, 2: 0.3048, 4: 1e-3, 5: 1e-2, 6: 1.0, 10: 0.9144, 14: 0.1}
DRAWN = ("LWPOLYLINE", "POLYLINE", "LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE")
BINARY = b"AutoCAD Binary DXF"
SAID = re.compile(r"\s*units?\s*[:=]\s*([a-z]+)\b", re.IGNORECASE)  # AAMA-292 and ASTM D6673 say it in a text
APPAREL = re.compile(r"\s*(piece|style|sample|pattern)\s*(name|size)\s*[:=：]", re.IGNORECASE)
NAMED = re.compile(r"\s*(?:piece\s*name|裁片名称?|部件名称?|衣片名称?)\s*[:=：]\s*(\S[^\n]*)", re.IGNORECASE)
SIZED = re.compile(r"\s*(?:size|尺码|号型)\s*[:=：]\s*(\S[^\n]*)", re.IGNORECASE)
SAYING = {
    "METRIC": 1e-3,
    "ENGLISH": 0.0254,
    "MM": 1e-3,
    "CM": 1e-2,
    "INCH": 0.0254,
    "INCHES": 0.0254,
    "IN": 0.0254,
}
SAG = 0.02  # [mm] most between a curve and its steps
MOST_POINTS = 5_000_000
WHAT = "a pattern drawn as DXF"
MARKS = {"LWPOLYLINE": "AcDbPolyline", "SPLINE": "AcDbSpline", "ELLIPSE": "AcDbEllipse"}
HANZI = re.compile(rb"[\xa1-\xa3\xb0-\xf7][\xa1-\xfe]")  # signs and Chinese characters of GB 2312
RARE = re.compile("[\u0180-\u036f]")  # letters that hardly any name of a piece has
COMMON = {"5", "6", "8", "48", "60", "62", "67", "330", "370", "420"}  # tags that every entity may have


def dxf_strokes(path: Path, metres: float | None = None) -> Drawn:
    """The lines of a DXF file [m], y down; raises FileProblem.

    metres: of a drawing unit; without it a text such as "UNITS: ENGLISH" counts, then $INSUNITS, and where both are
    silent a millimetre.
    """
    text = read_bytes(path, WHAT)
    if b"SECTION" not in text and not text.startswith(BINARY):
        raise FileProblem(f"{path}: not a DXF file (no section in it) – give {WHAT}")
    document, lost = _document(path, text)
    unit = document.header.get("$INSUNITS", 0)
    texts = {block.name: list(_texts(block)) for block in (document.modelspace(), *_pieces_of(document))}
    scale = metres or _said(texts) or METRES.get(unit)
    if scale is None:
        raise FileProblem(f"{path}: $INSUNITS {unit} – say the unit with --units, such as --units mm")
    walk = _Walk(document, scale, _titles(texts))
    walk.left_out["INSERT of no block"] += lost
    try:
        with np.errstate(all="ignore"):  # what leaves the range is told by whoever sorts the lines
            found = list(walk.strokes(document.modelspace(), ()))
            blocks = [] if found else _pieces_of(document)
            for block in blocks:
                found += walk.strokes(block, (block.name,))
    except (ValueError, TypeError, AttributeError, ArithmeticError) as error:
        reason = " ".join(str(error).split())[:120]
        told = reason if " – " in reason else f"an entity cannot be read ({reason}) – draw it as polylines"
        raise FileProblem(f"{path}: {told}") from error
    walk.left_out["in paper space"] += sum(
        len(layout) for layout in document.layouts if layout.name != "Model"
    )
    remarks = (
        ("nothing is inserted in its model space, its blocks are taken for the pieces",) if blocks else ()
    )
    with np.errstate(all="ignore"):
        turned = np.array([scale, -scale])
        strokes = [walk.named(Stroke(points * turned, closed, *rest)) for points, closed, *rest in found]
    apparel = any(APPAREL.match(text) for some in texts.values() for text in some)
    return Drawn(strokes, walk.left_out, remarks, apparel=apparel)


def _texts(block: Any) -> Iterator[str]:
    """What is written in a block."""
    for entity in block:
        kind = entity.dxftype()
        if kind in ("TEXT", "MTEXT", "ATTDEF"):
            text = entity.plain_text() if kind == "MTEXT" else str(entity.dxf.get("text", ""))
            yield text.encode("utf-8", "replace").decode()


def _said(texts: dict[str, list[str]]) -> float | None:
    """Metres of a drawing unit, from the text in which an AAMA or ASTM file says its units."""
    for text in (text for some in texts.values() for text in some):
        if (found := SAID.match(text)) is not None:
            return SAYING.get(found[1].upper())
    return None


def _titles(texts: dict[str, list[str]]) -> dict[str, str]:
    """Names of the blocks in which an AAMA or ASTM file says a piece's name; its size where several have that name."""
    said = {
        block: tuple(
            " ".join(next((m[1] for m in map(key.match, some) if m), "").split()) for key in (NAMED, SIZED)
        )
        for block, some in texts.items()
    }
    often = Counter(name for name, _ in said.values())
    return {
        block: f"{name}-{size}" if often[name] > 1 and size else name
        for block, (name, size) in said.items()
        if name
    }


def _pieces_of(document: Any) -> list[Any]:
    """The blocks that people made, not those of layouts and dimensions."""
    return [block for block in document.blocks if not block.name.startswith("*")]


def _document(path: Path, text: bytes) -> tuple[Any, int]:
    """The drawing, and how many inserts name no block; ezdxf tells damage by many kinds of exception."""
    from ezdxf import recover
    from ezdxf.audit import AuditError
    from ezdxf.filemanagement import readfile
    from ezdxf.lldxf.const import DXFError

    logging.getLogger("ezdxf").addHandler(
        logging.NullHandler()
    )  # what it mends is no news to whoever cuts cloth
    try:
        if text.startswith(BINARY):
            return readfile(path), 0
        if b"\n" not in text:
            text = text.replace(b"\r", b"\n")  # as old Macintoshes end lines
        document, audit = recover.read(BytesIO(mended(spelled_out(text))))
        return document, sum(fix.code == AuditError.UNDEFINED_BLOCK for fix in audit.fixes)
    except (
        DXFError,
        ValueError,
        KeyError,
        IndexError,
        AttributeError,
        TypeError,
        OSError,
        struct.error,
    ) as error:
        reason = " ".join(str(error).split())[:120] or type(error).__name__
        raise FileProblem(f"{path}: not a DXF file ({reason}) – give {WHAT}") from error
    except (RecursionError, OverflowError, MemoryError, ArithmeticError) as error:
        raise FileProblem(f"{path}: not a DXF file that can be read – give {WHAT}") from error


class _Walk:
    """A way through a drawing, inserts followed into their blocks."""

    def __init__(self, document: Any, scale: float, titles: dict[str, str]) -> None:
        """titles: of blocks whose texts name a piece."""
        self.titles = titles
        self.document, self.sag, self.far = document, SAG * 1e-3 / scale, LARGEST / scale
        self.visits = self.points = 0
        self.left_out: Counter[str] = Counter()
        self.dark = {layer.dxf.name for layer in document.layers if layer.is_off() or layer.is_frozen()}

    def strokes(self, entities, within: tuple[str, ...], layer: str = "0", placed=None) -> Iterator[tuple]:
        """(points, closed, layer, groups, words) of entities. within: blocks around.  layer: the insert's.

        placed: the matrix from the block to the drawing; ezdxf's own way through inserts within inserts loses the skew
        of a turned one in one of two scales.
        """
        for entity in entities:
            self.visits = visited(self.visits)
            kind, own = entity.dxftype(), str(entity.dxf.get("layer", "0"))
            own = layer if own == "0" else own  # what a block draws on layer 0 lies on its insert's
            own = own.encode("utf-8", "replace").decode()  # what ezdxf could not decode
            if entity.dxf.get("invisible", 0):
                self.left_out["invisible"] += 1
            elif own in self.dark:
                self.left_out[f"on layer {own}, off or frozen"] += 1
            elif kind == "INSERT":
                yield from self._inserted(entity, within, own, placed)
            elif kind == "POINT":
                place = placed.transform(entity.dxf.location) if placed else entity.dxf.location
                yield np.array([[place.x, place.y]]), False, own, within, spoken(own)
            elif kind in DRAWN:
                yield from self._drawn(entity, own, within, placed)
            elif kind != "ATTDEF" or not placed:
                self.left_out[kind] += 1

    def named(self, stroke: Stroke) -> Stroke:
        """A line with its blocks called as their texts say, and as a part of the sheet where a block is that."""
        blocks = [spoken(name) for name in stroke.groups]
        words = [word for said in blocks if furnishes(said) for word in said]
        told = tuple(self.titles[name] for name in stroke.groups if name in self.titles)
        groups = tuple(self.titles.get(name, name) for name in stroke.groups)
        return replace(stroke, groups=groups, told=told, words=(*stroke.words, *words))

    def _drawn(self, entity, layer: str, within: tuple[str, ...], placed) -> Iterator[tuple]:
        from ezdxf import path as curves

        if entity.dxftype() == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline):
            self.left_out["POLYLINE mesh"] += 1
            return
        curve = curves.make_path(entity)
        curve = curve.transform(placed) if placed else curve
        corners = [c for v in curve.control_vertices() for c in (v.x, v.y)]
        if not all(
            abs(c) <= self.far for c in corners
        ):  # before it is cut into steps without end; false for NaN too
            raise ValueError(
                f"a line leaves the range of {LARGEST:g} m – draw it nearer to the origin, or say --units"
            )
        points = np.array([(p.x, p.y) for p in curve.flattening(self.sag)]).reshape(-1, 2)
        self.points += len(points)
        if self.points > MOST_POINTS:
            raise ValueError(f"its curves need more than {MOST_POINTS} points – say the unit with --units")
        closed = len(points) > 3 and bool(getattr(entity, "is_closed", False) or curve.is_closed)
        if closed and np.allclose(points[0], points[-1], rtol=0, atol=1e-9 * (1 + np.abs(points).max())):
            points = points[:-1]
        if len(points) > 1:
            yield points, closed, layer, within, spoken(layer)

    def _inserted(self, insert, within: tuple[str, ...], layer: str, placed) -> Iterator[tuple]:
        name = str(insert.dxf.get("name", ""))
        block = self.document.blocks.get(name)
        if block is None:
            self.left_out[f"INSERT of {name or 'nothing'}"] += 1
            return
        if name in within:
            raise ValueError(f"block {name[:40]} within itself")
        rows, columns = (max(1, int(insert.dxf.get(key, 1))) for key in ("row_count", "column_count"))
        if rows * columns > MOST_VISITED:
            visited(MOST_VISITED)
        for one in [insert] if rows * columns == 1 else insert.multi_insert():
            own = one.matrix44()  # what is multiplied from the right is done after it
            yield from self.strokes(block, (*within, name), layer, own @ placed if placed else own)


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
