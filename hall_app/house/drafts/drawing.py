"""A drawing that is brought as SVG, written anew: of its elements and attributes those that draw, and nothing else.

Programs, animations, links, filters, addresses beyond the file, embedded documents, comments and what editors note of
themselves are left out; embedded pictures are drawn anew. How much it draws is bounded, `<use>` in `<use>` included.
"""

from __future__ import annotations

import base64
import binascii
import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from xml.etree import ElementTree
from xml.parsers.expat import ExpatError, ParserCreate

from hall_app.content.models import PictureError, picture_size
from hall_app.house.people import PeopleError

__all__ = ["redrawn"]

_SVG, _XLINK = "http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"
_SHAPES = "path rect circle ellipse line polyline polygon text image use"
_DRAWN = frozenset(
    f"svg g defs symbol switch title desc {_SHAPES} tspan textPath linearGradient radialGradient stop pattern "
    "clipPath mask marker style".split()
)
_TEXTS = frozenset(("text", "tspan", "textPath"))
_GRADIENTS = frozenset(("linearGradient", "radialGradient"))
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9-]*")
_UNUSED = ("on", "filter", "begin", "end", "dur", "values")  # how names begin that draw nothing here
_REFERENCE = re.compile(r"""url\(\s*(['"]?)#([^'"()\s;{}%]+)\1\s*\)""", re.IGNORECASE)
_ASKING = re.compile(r"(?:url|src|image|image-set|cross-fade|element|expression)\s*\(", re.IGNORECASE)
_COMMENT = re.compile(r"/\*.*?(?:\*/|\Z)", re.DOTALL)
# What is never closed goes to the end, and nothing is looked at twice: else few bytes take minutes.
_AT_RULE = re.compile(
    r"""@[\w-]++(?:"[^"\n]*+"|'[^'\n]*+'|[^;{}@"'])*+(?:;|\{(?:[^{}]++|\{[^{}]*+\})*+\}|\Z)"""
)
_FILTER = re.compile(r"(?<![\w.#-])(?:-webkit-|backdrop-)?filter\s*:[^;{}]*", re.IGNORECASE)
_PICTURE = re.compile(r"data:image/(?:png|jpe?g|webp)\s*;\s*base64\s*,", re.IGNORECASE)
_TYPES = {".png": "png", ".jpg": "jpeg", ".webp": "webp"}

_XML_SPACE = "{http://www.w3.org/XML/1998/namespace}space"
_SCREENS = ("", "all", "screen")
# Attributes whose targets are drawn for each element within.
_PAINTING = re.compile(r"fill|stroke|marker.*|style")
_MARKERS = re.compile(r"marker(?:-mid)?\b")
_STROKE = 64  # characters of a path that count as one more element

_MOST_DEEP = 120
_LONGEST_SPACE = 200  # characters of a namespace's name, which every name of the tree repeats
_MOST_WRITTEN = 60_000  # elements of the file
_MOST_DRAWN = 300_000  # elements, each as often as it is drawn
_MOST_PIXELS = 20_000_000  # of all pictures within
_MOST_TOLD = 8


def redrawn(
    name: str, data: bytes, picture: Callable[[str, bytes], tuple[bytes, str, str]]
) -> tuple[bytes, str]:
    """(SVG, what is known of it). name: for messages; picture: draws an embedded picture anew, as (bytes, ending, …).

    Raises PeopleError.
    """
    cleaning = _Cleaning(name, picture)
    root = cleaning.kept(_tree(name, data), "svg")
    if taken := _without_rules_that_draw(root):
        cleaning.left["url"] += taken
    _check_drawn(name, root)
    root.set("xmlns", _SVG)
    told = " × ".join(_measures(root))
    if cleaning.left:
        most = sorted(cleaning.left.most_common(_MOST_TOLD))
        told += " · − " + ", ".join(f"{key} {count}" for key, count in most)
    return ElementTree.tostring(root, "utf-8", xml_declaration=True), told.removeprefix(" · ")


def _tree(name: str, data: bytes) -> ElementTree.Element:
    """Looked through before it is read: what is declared, an entity or an attribute, may be small as a file alone."""
    if b"\0" in data:  # sixteen bits a character; no program writes drawings so
        raise PeopleError("file-broken", name=name, why="it is no UTF-8")
    try:
        _look_through(name, data)
        root = ElementTree.fromstring(data)
    except PeopleError:
        raise
    except (ExpatError, ElementTree.ParseError, ValueError, LookupError) as error:
        raise PeopleError("file-broken", name=name, why=str(error)[:120]) from None
    if _local(root.tag) != "svg":
        raise PeopleError("file-kind", name=name)
    return root


def _look_through(name: str, data: bytes) -> None:
    """Raises PeopleError for declarations, and for what is too deep or too long; ExpatError for what is no XML."""
    depth = count = 0

    def declared(*_: object) -> None:
        raise PeopleError("file-svg", name=name)

    def begin(_: str, attributes: dict[str, str]) -> None:
        nonlocal depth, count
        depth, count = depth + 1, count + 1
        spaces = (len(value) for key, value in attributes.items() if key.startswith("xmlns"))
        if depth > _MOST_DEEP or count > _MOST_WRITTEN or max(spaces, default=0) > _LONGEST_SPACE:
            raise PeopleError("file-svg-drawn", name=name)

    def end(_: str) -> None:
        nonlocal depth
        depth -= 1

    parser = ParserCreate()
    parser.EntityDeclHandler = parser.AttlistDeclHandler = declared
    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.Parse(data, True)


@dataclass
class _Cleaning:
    name: str
    picture: Callable[[str, bytes], tuple[bytes, str, str]]
    left: Counter[str] = field(default_factory=Counter)  # what was left out -> how often
    pixels: int = 0

    def kept(self, source: ElementTree.Element, tag: str) -> ElementTree.Element:
        """The element with what draws of it under that name, its names without a namespace."""
        made = ElementTree.Element(tag)
        for name, value in source.attrib.items():
            self._attribute(made, name, value)
        if tag == "style":
            made.attrib = {}
            shown = source.get("media", "").strip().lower() in _SCREENS
            made.text = self._rules("".join(source.itertext())) if shown else ""
            return made
        made.text = source.text
        for child in source:
            local = _local(child.tag)
            if local == "a":  # a link leads nowhere from a picture; what it holds is drawn
                local = "tspan" if tag in _TEXTS else "g"
            if local in _DRAWN and (local != "image" or self._embedded(child)):
                made.append(self.kept(child, local))
                made[-1].tail = child.tail
                continue
            if local not in ("", "metadata"):  # what an editor notes for itself is no loss
                self.left[local[:20]] += 1
            if child.tail and len(made):
                made[-1].tail = (made[-1].tail or "") + child.tail
            elif child.tail:
                made.text = (made.text or "") + child.tail
        return made

    def _attribute(self, made: ElementTree.Element, name: str, value: str) -> None:
        space, _, local = name.rpartition("}")
        if name == _XML_SPACE:
            made.set(name, value)
        elif local == "href" and space in ("", "{" + _XLINK):
            if (value.strip().startswith("#") and "%" not in value) or made.tag == "image":
                made.set("href", made.get("href", value.strip()) if space else value.strip())
            else:
                self.left["href"] += 1
        elif space or not _NAME.fullmatch(local) or local.startswith("data-"):
            return
        elif local.lower().startswith(_UNUSED):
            self.left[local[:20]] += 1
        elif local in ("id", "class"):
            made.set(local, value)
        elif (clean := self._value(value)) is None:
            self.left[local[:20]] += 1
        else:
            made.set(local, clean)

    def _value(self, value: str) -> str | None:
        """An attribute that may hold CSS; None: it asks for something beyond the file, or hides what it asks for."""
        value = _FILTER.sub("", _COMMENT.sub(" ", value))
        hidden = "\\" in value or "/*" in value
        return None if hidden or _ASKING.search(_REFERENCE.sub(" ", value)) else value

    def _rules(self, sheet: str) -> str:
        sheet, at_rules = _AT_RULE.subn("", _COMMENT.sub(" ", sheet))
        if at_rules:
            self.left["@"] += at_rules
        clean = self._value(sheet)
        if clean is None or set("@<") & set(clean):
            self.left["style"] += 1
            return ""
        return clean

    def _embedded(self, element: ElementTree.Element) -> bool:
        """Whether the picture lies in the file; it is drawn anew then."""
        key = next((name for name in element.attrib if name.rpartition("}")[2] == "href"), "")
        head = _PICTURE.match(element.get(key, "").strip())
        if head is None:
            return False
        try:
            data = base64.b64decode(element.get(key, "").strip()[head.end() :])
            width, height = picture_size(data)
            self.pixels += width * height
            if self.pixels > _MOST_PIXELS:
                raise PeopleError("file-svg-drawn", name=self.name)
            data, ending, _ = self.picture(self.name, data)
        except (binascii.Error, PictureError):
            return False
        for name in [name for name in element.attrib if name.rpartition("}")[2] == "href"]:
            del element.attrib[name]
        element.set("href", f"data:image/{_TYPES[ending]};base64,{base64.b64encode(data).decode()}")
        return True


def _local(tag: object) -> str:
    """The name of an SVG element, empty for one of another namespace, a comment or an instruction."""
    space, _, local = str(tag).rpartition("}")
    return local if isinstance(tag, str) and space in ("", "{" + _SVG) else ""


def _measures(root: ElementTree.Element) -> Iterator[str]:
    """Its width and height as it says them, else those of its frame."""
    frame = (root.get("viewBox") or "").replace(",", " ").split()
    sides = [root.get("width") or "", root.get("height") or ""]
    for side, other in zip(sides, frame[2:4] if len(frame) == 4 else ("", ""), strict=True):
        if side or other:
            yield (side or other)[:20]


def _without_rules_that_draw(root: ElementTree.Element) -> int:
    """Takes from style sheets what their rules refer to but for gradients; how often. A rule serves any number of
    elements: nobody can tell how much that draws."""
    free = {one.get("id", "") for one in root.iter() if one.tag in _GRADIENTS}
    free -= {one.get("id", "") for one in root.iter() if one.tag not in _GRADIENTS}
    taken = 0
    for sheet in root.iter("style"):
        parts = _REFERENCE.finditer(sheet.text or "")
        taken += sum(match[2] not in free for match in parts)
        sheet.text = _REFERENCE.sub(lambda match: match[0] if match[2] in free else "none", sheet.text or "")
    return taken


def _check_drawn(name: str, root: ElementTree.Element) -> None:
    """Raises PeopleError where little text draws without end: uses, patterns, masks, clips and markers that nest."""
    by_id: dict[str, ElementTree.Element] = {}
    for one in root.iter():
        by_id.setdefault(one.get("id", ""), one)  # of two of one name browsers take the first
    known: dict[ElementTree.Element, int] = {}
    within: set[ElementTree.Element] = set()

    def drawn(element: ElementTree.Element, depth: int) -> int:
        if element in known:
            return known[element]
        if element in within or depth > 2 * _MOST_DEEP:
            raise PeopleError("file-svg-drawn", name=name)
        within.add(element)
        line = len(element.get("d", "")) + len(element.get("points", ""))
        count = (
            1
            + (line + len(element.text or "")) // _STROKE
            + sum(drawn(child, depth + 1) for child in element)
        )
        times = 1
        for key, target in targets(element):
            cost = drawn(target, depth + 1)
            if _PAINTING.fullmatch(key):  # handed down to all that is within
                corners = line // 2 if _MARKERS.search(key + element.get("style", "")) else 0
                times += cost * max(1, corners)
            else:
                count += cost
        within.discard(element)
        known[element] = count = min(count * times, _MOST_DRAWN + 1)
        return count

    def targets(element: ElementTree.Element) -> Iterator[tuple[str, ElementTree.Element]]:
        for key, value in element.attrib.items():
            names = [match[2] for match in _REFERENCE.finditer(value)]
            if key == "href" and value.startswith("#"):
                names.append(value[1:])
            for one in names:
                target = by_id.get(one)
                if target is not None and target.tag not in _GRADIENTS and element.tag not in _GRADIENTS:
                    yield key, target

    if drawn(root, 0) > _MOST_DRAWN:
        raise PeopleError("file-svg-drawn", name=name)
