"""Strict WIF 1.1: every section announced, no blanks round "=", the format's own date, CRLF line ends, ASCII only."""

import json
from pathlib import Path

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.files.wif.model import PRIVATE, Wif, centimetres
from sim_core.weave.files.wif.sections import escaped

__all__ = ["wif_text", "write_wif"]

HEAD = (
    ("Version", "1.1"),
    ("Date", "April 20, 1997"),  # of the format, not of the file
    ("Developers", "wif@mhsoft.com"),
    ("Source Program", "simcore weave"),
)
CHUNK = 200  # characters of JSON a line


def wif_text(wif: Wif) -> str:
    """The file as text."""
    sections = [("WIF", HEAD), *_body(wif)]
    contents = ("CONTENTS", tuple((name, "true") for name, _ in sections[1:]))
    parts = []
    for name, lines in [sections[0], contents, *sections[1:]]:
        parts += [f"[{name}]", *_lines(name, lines), ""]
    return "\r\n".join(parts)


def _lines(name: str, lines) -> list[str]:
    keep = str if name == PRIVATE else escaped
    return [f"{keep(key)}={keep(value)}" for key, value in lines]


def write_wif(wif: Wif, path: str | Path) -> None:
    """Write the file; raises OSError where that fails and WeaveError where the folder does not exist."""
    path = Path(path)
    if not path.parent.is_dir():
        raise WeaveError(f"{path}: no such folder – make {path.parent} first")
    path.write_bytes(wif_text(wif).encode("ascii"))


def _body(wif: Wif):
    harness = wif.harness
    yield "COLOR PALETTE", (("Entries", str(len(wif.palette))), ("Form", "RGB"), ("Range", f"0,{wif.top}"))
    title = (("Title", wif.title),) if wif.title else ()
    if title or wif.text:
        yield "TEXT", (*title, *wif.text)
    shafts, treadles = harness.tieup.shape
    treadles = 0 if wif.plan else treadles
    yield "WEAVING", (("Shafts", str(shafts)), ("Treadles", str(treadles)), ("Rising Shed", "true"))
    yield "WARP", _side(wif, 0, harness.threading.shape[0], wif.warp_colours)
    yield "WEFT", _side(wif, 1, harness.treadling.shape[0], wif.weft_colours)
    if wif.notes:
        yield "NOTES", tuple((str(k + 1), line) for k, line in enumerate(wif.notes))
    yield (
        "COLOR TABLE",
        tuple((str(k + 1), ",".join(str(v) for v in c)) for k, c in enumerate(wif.palette.tolist())),
    )
    yield "THREADING", _rows(harness.threading)
    if wif.plan:
        yield "LIFTPLAN", _rows(harness.treadling)
    else:
        yield "TIEUP", _rows(harness.tieup.T)
        yield "TREADLING", _rows(harness.treadling)
    for name, colours in (("WARP COLORS", wif.warp_colours), ("WEFT COLORS", wif.weft_colours)):
        default = int(np.bincount(colours).argmax())
        lines = tuple((str(k + 1), str(c)) for k, c in enumerate(colours.tolist()) if c != default)
        if lines:
            yield name, lines
    if wif.private is not None:
        text = json.dumps(wif.private, ensure_ascii=True, separators=(",", ":"))
        chunks = [text[k : k + CHUNK] for k in range(0, len(text), CHUNK)]
        yield PRIVATE, tuple((str(k + 1), f'"{chunk}"') for k, chunk in enumerate(chunks))
    yield from wif.other


def _side(wif: Wif, side: int, threads: int, colours: np.ndarray):
    lines = [
        ("Threads", str(threads)),
        ("Color", str(np.bincount(colours).argmax())),
        ("Units", "Centimeters"),
    ]
    for key, values in (("Spacing", wif.spacing), ("Thickness", wif.thickness)):
        value = values[side]
        if value is not None:
            lines.append((key, centimetres(value)))
    return tuple(lines)


def _rows(matrix: np.ndarray):
    """One line a row: the numbers of its ones, from 1; 0 where there is none."""
    return tuple(
        (str(k + 1), ",".join(str(n + 1) for n in np.flatnonzero(row)) or "0") for k, row in enumerate(matrix)
    )
