"""The text of an SVG file as a tree: decoded as it says, its entities bounded, without what only paints."""

import codecs
import re
from pathlib import Path
from xml.etree import ElementTree

from sim_core.errors import FileProblem
from sim_core.validation.files import read_bytes

__all__ = ["WHAT", "svg_root"]

WHAT = "a pattern drawn as SVG"
DECLARED = re.compile(rb"^\s*<\?xml[^>]*?encoding\s*=\s*[\"']([A-Za-z0-9._-]{1,40})[\"'][^>]*\?>")
PAINTING = {"mask", "pattern", "marker", "filter", "linearGradient", "radialGradient", "clipPath"}
MOST_GROWN = 1_000_000  # characters that entities stand for


def svg_root(path: Path) -> ElementTree.Element:
    """The root of an SVG file; raises FileProblem."""
    text = _decoded(path, read_bytes(path, WHAT))
    _check_entities(path, text)
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise FileProblem(f"{path}: not valid SVG ({error}) – give {WHAT}") from error
    if (tag := str(root.tag).rsplit("}", 1)[-1]) != "svg":
        raise FileProblem(f"{path}: its root is <{tag[:40]}> – give {WHAT}")
    for parent in list(root.iter()):
        for child in [c for c in parent if str(c.tag).rsplit("}", 1)[-1] in PAINTING]:
            parent.remove(child)
    return root


def _decoded(path: Path, given: bytes) -> str:
    """The text, by its byte order mark or its XML declaration, which is taken out; UTF-8 where it says nothing."""
    if given.startswith(b"\x1f\x8b"):
        raise FileProblem(f"{path}: compressed (SVGZ) – unpack it, or save it as plain SVG")
    if given.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        name, body = "utf-16", given
    else:
        found = DECLARED.match(given.removeprefix(codecs.BOM_UTF8))
        name = found[1].decode() if found else "utf-8"
        name, body = ("gb18030" if name.lower().startswith("gb") else name), given
    try:
        text = body.decode("utf-8-sig" if name.lower() in ("utf-8", "utf8") else name)
    except LookupError as error:
        raise FileProblem(f"{path}: encoding {name!r} is not known – save it as UTF-8") from error
    except (UnicodeError, ValueError) as error:
        said = "UTF-8" if name.lower() in ("utf-8", "utf8") else name
        raise FileProblem(
            f"{path}: not {said} text, as it should be – save it as plain SVG in UTF-8"
        ) from error
    if not isinstance(text, str):
        raise FileProblem(f"{path}: encoding {name!r} is none of text – save it as UTF-8")
    return re.sub(r"^\s*<\?xml.*?\?>", "", text.lstrip("\ufeff"), count=1, flags=re.DOTALL)


def _check_entities(path: Path, text: str) -> None:
    """Entities may be no more than names of short texts, as Illustrator writes its name spaces."""
    declared = dict(re.findall(r"<!ENTITY\s+([\w.-]+)\s+[\"']([^\"']*)[\"']\s*>", text))
    grown = sum(len(value) * text.count(f"&{name};") for name, value in declared.items())
    others = text.count("<!ENTITY") - len(declared)
    if others or grown > MOST_GROWN or any("&" in value or "%" in value for value in declared.values()):
        raise FileProblem(f"{path}: declares entities within entities – save it as plain SVG without them")
