"""An SVG file as a tree that svgelements can be trusted with.

The text is decoded as it says and its entities bounded; what only paints is left out; depth, and how often `<use>` may
draw, are bounded; and nested viewports (`<svg>` within `<svg>`, `<use>` of a `<symbol>`: SVG 2, chapter 8) become
groups, since svgelements 1.9.6 moves a nested `<svg>` twice and draws a `<symbol>` where it is declared.
"""

import codecs
import re
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from copy import deepcopy
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from sim_core.errors import FileProblem
from sim_core.validation.files import read_bytes

__all__ = [
    "LENGTHS",
    "MOST_VISITED",
    "NUMBER",
    "check_bounds",
    "flatten_viewports",
    "left_out_of",
    "svg_root",
]

WHAT = "a pattern drawn as SVG"
DECLARED = re.compile(rb"^\s*<\?xml[^>]*?encoding\s*=\s*[\"']([A-Za-z0-9._-]{1,40})[\"'][^>]*\?>")
BARE = re.compile(r"&(?!#?\w+;)")  # FreeSewing writes what a text says as it is, "&" too
PAINTING = {"mask", "pattern", "marker", "filter", "linearGradient", "radialGradient", "clipPath"}
MOST_GROWN = 1_000_000  # characters that entities stand for
MOST_VISITED = 200_000  # elements, those of blocks and uses each time they are drawn
MOST_DEEP = 200
UNREAD = ("text", "image", "foreignObject")
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
LENGTHS = {
    "": 1,
    "px": 1,
    "mm": 96 / 25.4,
    "cm": 960 / 25.4,
    "m": 96000 / 25.4,
    "in": 96,
    "pt": 4 / 3,
    "pc": 16,
    "q": 24 / 25.4,
}
ALIGNED = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}
PLACED = ("x", "y", "width", "height", "viewBox", "preserveAspectRatio", "transform")
# What reading a damaged drawing may end in.
BROKEN = (ValueError, IndexError, KeyError, TypeError, AttributeError, ArithmeticError)
Size = tuple[float, float]


def svg_root(path: Path, what: str = WHAT) -> ElementTree.Element:
    """The root of an SVG file, of which one wants `what`; raises FileProblem."""
    text = _decoded(path, read_bytes(path, what))
    _check_entities(path, text)
    try:
        root = ElementTree.fromstring(BARE.sub("&amp;", text))
    except (ElementTree.ParseError, ValueError) as error:
        raise FileProblem(f"{path}: not valid SVG ({error}) – give {what}") from error
    if (tag := str(root.tag).rsplit("}", 1)[-1]) != "svg":
        raise FileProblem(f"{path}: its root is <{tag[:40]}> – give {what}")
    for parent in list(root.iter()):
        for child in [c for c in parent if str(c.tag).rsplit("}", 1)[-1] in PAINTING]:
            parent.remove(child)
    return root


@contextmanager
def told(path: Path, remedy: str, *further: type[Exception], longest: int = 120) -> Iterator[None]:
    """What goes wrong in the block with a drawing is a FileProblem: one line of `longest` characters, and the remedy
    where it names none. further: what else may be raised."""
    try:
        yield
    except RecursionError as error:
        raise FileProblem(f"{path}: groups nested too deep – take shapes out of their groups") from error
    except (*BROKEN, *further) as error:
        reason = " ".join(str(error).split())[:longest] or type(error).__name__
        raise FileProblem(f"{path}: {reason}{'' if '–' in reason else f' – {remedy}'}") from error


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


def _tag(element: ElementTree.Element) -> str:
    return element.tag.rsplit("}", 1)[-1] if isinstance(element.tag, str) else ""


def check_bounds(root: ElementTree.Element) -> None:
    """Raise ValueError where `<use>` draws itself, or everything together draws too many elements or too deep."""
    named = {name: element for element in root.iter() if (name := element.get("id"))}
    counts: dict[int, int] = {}
    doing: set[int] = set()

    def drawn(element: ElementTree.Element, deep: int) -> int:
        key = id(element)
        if deep > MOST_DEEP:
            raise ValueError("groups nested too deep")
        if key in doing:
            raise ValueError(f"<use> of #{element.get('id', '')[:40]} within itself")
        if key not in counts:
            doing.add(key)
            counts[key] = 1 + sum(drawn(child, deep + 1) for child in element)
            if _tag(element) == "use" and (used := named.get(_used(element))) is not None:
                counts[key] += drawn(used, deep + 1)
            doing.discard(key)
            if counts[key] > MOST_VISITED:
                raise ValueError(f"it draws more than {MOST_VISITED} elements")
        return counts[key]

    drawn(root, 0)


def _href(element: ElementTree.Element) -> str:
    return next((text for key, text in element.items() if key.rsplit("}", 1)[-1] == "href"), "")


def _used(element: ElementTree.Element) -> str:
    name = _href(element)
    return name.removeprefix("#") if name.startswith("#") else ""


def left_out_of(root: ElementTree.Element) -> Counter[str]:
    """How many elements draw nothing that a panel has: texts, pictures, hidden and clipped things."""
    found: Counter[str] = Counter()
    named = {name for element in root.iter() if (name := element.get("id"))}
    hidden = set()
    for element in root.iter():
        tag = _tag(element)
        style = re.sub(r"\s", "", element.get("style", ""))
        if tag in UNREAD:
            found[f"<{tag}>"] += 1
        elif element.get("display") == "none" or "display:none" in style:
            found["hidden (display: none)"] += 1
            hidden |= set(element.iter())
        elif element.get("clip-path"):
            found["clip-path"] += 1
        elif tag == "use" and _used(element) not in named:
            found[f"<use> of {_href(element) or 'nothing'}"] += 1
    return found


def flatten_viewports(root: ElementTree.Element, size: Size) -> None:
    """Turn nested viewports into groups, in place. size: of the outermost one, in user units. Raises ValueError."""
    space = root.tag[: root.tag.rfind("}") + 1]
    named = {name: element for element in root.iter() if (name := element.get("id"))}
    _flatten(root, size, space, named)
    for parent in list(root.iter()):
        for child in [child for child in parent if child.tag == f"{space}symbol"]:
            parent.remove(child)


def _flatten(
    element: ElementTree.Element, size: Size, space: str, named: dict[str, ElementTree.Element]
) -> None:
    for k, child in enumerate(list(element)):
        inner = size
        if child.tag == f"{space}symbol":
            continue
        if child.tag == f"{space}svg":
            child, inner = _group(child, child, size, space)
            element[k] = child
        elif child.tag == f"{space}use":
            name = next((text for key, text in child.items() if key.rsplit("}", 1)[-1] == "href"), "")
            symbol = named.get(name.removeprefix("#"))
            if symbol is not None and symbol.tag == f"{space}symbol":
                child, inner = _group(child, deepcopy(symbol), size, space)
                element[k] = child
        _flatten(child, inner, space, named)


def _group(placed: ElementTree.Element, held: ElementTree.Element, size: Size, space: str):
    """A group with the children of `held`, standing where `placed` puts its viewport; and the size in it."""
    x, y = _pair(placed, ("x", "y"), size, (0.0, 0.0))
    width = _pair(placed, ("width", "height"), size, size)
    scale, shift, inner = _viewport(held.get("viewBox", ""), held.get("preserveAspectRatio", ""), width)
    frame = f"matrix({scale[0]!r} 0 0 {scale[1]!r} {x + shift[0]!r} {y + shift[1]!r})"
    before = [placed.get("transform", ""), frame, held.get("transform", "") if held is not placed else ""]
    kept = {key: value for key, value in placed.items() if key not in PLACED and not key.endswith("href")}
    if held is not placed and "id" in held.keys():  # noqa: SIM118 - an element, no mapping
        kept["data-symbol"] = held.get("id", "")  # tells letters that a printer drew from pieces
    group = ElementTree.Element(f"{space}g", {**kept, "transform": " ".join(filter(None, before))})
    group.extend(list(held))
    return group, inner


def _viewport(view_box: str, aspect: str, size: Size) -> tuple[list[float], list[float], Size]:
    """Scale and shift from a viewBox to a viewport of `size`, and the size in its units."""
    box = [float(v) for v in NUMBER.findall(view_box)]
    if len(box) != 4:
        return [1.0, 1.0], [0.0, 0.0], size
    if not (box[2] > 0 and box[3] > 0 and np.isfinite(size).all()):
        raise ValueError(f"viewBox {view_box[:40]!r} of a nested drawing without a size")
    scale = np.array(size) / box[2:]
    words = (aspect.split() or ["xMidYMid"])[:2]
    found = re.fullmatch(r"x(Min|Mid|Max)Y(Min|Mid|Max)", words[0])
    if words[0] != "none":
        scale[:] = scale.max() if words[1:] == ["slice"] else scale.min()
    align = np.array([ALIGNED[k] for k in found.groups()]) if found else np.zeros(2)
    shift = align * (size - scale * box[2:]) - scale * box[:2]
    return scale.tolist(), shift.tolist(), (box[2], box[3])


def _pair(element: ElementTree.Element, names: tuple[str, str], size: Size, missing: Size) -> Size:
    """Two lengths in user units; a percentage is of the viewport's size."""
    found = []
    for name, whole, default in zip(names, size, missing, strict=True):
        text = element.get(name, "").strip()
        number = re.fullmatch(rf"({NUMBER.pattern})\s*([a-z%]*)", text.lower())
        if not text or text == "auto":
            found.append(default)
        elif number is None or number[2] not in (*LENGTHS, "%"):
            raise ValueError(f"length {text[:30]!r} is not a number with a unit such as mm")
        else:
            found.append(float(number[1]) * (whole / 100 if number[2] == "%" else LENGTHS[number[2]]))
    return found[0], found[1]
