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
_REFERENCE = re.compile(r"""url\(\s*(['"]?)#([^'")\s]+)\1\s*\)""", re.IGNORECASE)
_ASKING = re.compile(r"(?:url|src|image|image-set|cross-fade|element|expression)\s*\(", re.IGNORECASE)
_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
_AT_RULE = re.compile(r"@[\w-]+[^;{}]*(?:;|\{(?:[^{}]|\{[^{}]*\})*\})")
_FILTER = re.compile(r"(?:backdrop-)?filter\s*:[^;}]*", re.IGNORECASE)
_PICTURE = re.compile(r"data:image/(?:png|jpe?g|webp)\s*;\s*base64\s*,", re.IGNORECASE)
_TYPES = {".png": "png", ".jpg": "jpeg", ".webp": "webp"}

_MOST_DEEP = 120
_MOST_WRITTEN = 60_000  # elements of the file
_MOST_DRAWN = 300_000  # elements, each as often as it is drawn
_MOST_PICTURES = 8


def redrawn(
    name: str, data: bytes, picture: Callable[[str, bytes], tuple[bytes, str, str]]
) -> tuple[bytes, str]:
    """(SVG, what is known of it). name: for messages; picture: draws an embedded picture anew, as (bytes, ending, …).

    Raises PeopleError.
    """
    cleaning = _Cleaning(name, picture)
    root = cleaning.kept(_tree(name, data), "svg")
    _check_drawn(name, root)
    root.set("xmlns", _SVG)
    told = " × ".join(_measures(root))
    if cleaning.left:
        told += " · − " + ", ".join(f"{key} {count}" for key, count in sorted(cleaning.left.items()))
    return ElementTree.tostring(root, "utf-8", xml_declaration=True), told.removeprefix(" · ")


def _tree(name: str, data: bytes) -> ElementTree.Element:
    """Read while its depth and length are counted: an entity or a nest of groups is small as a file."""
    if b"<!ENTITY" in data:
        raise PeopleError("file-svg", name=name)
    parser = ElementTree.XMLPullParser(("start", "end"))
    depth = count = 0
    root: ElementTree.Element | None = None
    try:
        for at in range(0, len(data), 65_536):
            parser.feed(data[at : at + 65_536])
            for event, element in parser.read_events():
                root = element if root is None else root
                depth += 1 if event == "start" else -1
                count += event == "start"
                if depth > _MOST_DEEP or count > _MOST_WRITTEN:
                    raise PeopleError("file-svg-drawn", name=name)
        parser.close()
    except PeopleError:
        raise
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise PeopleError("file-broken", name=name, why=str(error)[:120]) from None
    if root is None or _local(root.tag) != "svg":
        raise PeopleError("file-kind", name=name)
    return root


@dataclass
class _Cleaning:
    name: str
    picture: Callable[[str, bytes], tuple[bytes, str, str]]
    left: Counter[str] = field(default_factory=Counter)  # what was left out -> how often
    pictures: int = 0

    def kept(self, source: ElementTree.Element, tag: str) -> ElementTree.Element:
        """The element with what draws of it under that name, its names without a namespace."""
        made = ElementTree.Element(tag)
        for name, value in source.attrib.items():
            self._attribute(made, name, value)
        if tag == "style":
            made.attrib = {}
            made.text = self._rules("".join(source.itertext()))
            return made
        made.text = source.text
        for child in source:
            local = _local(child.tag)
            if local == "a":  # a link leads nowhere from a picture; what it holds is drawn
                local = "tspan" if tag in _TEXTS else "g"
            if local in _DRAWN and (local != "image" or self._embedded(child)):
                made.append(self.kept(child, local))
                made[-1].tail = child.tail
            elif local not in ("", "metadata"):  # what an editor notes for itself is no loss
                self.left[local] += 1
        return made

    def _attribute(self, made: ElementTree.Element, name: str, value: str) -> None:
        space, _, local = name.rpartition("}")
        if local == "href" and space in ("", "{" + _XLINK):
            if value.strip().startswith("#") or made.tag == "image":
                made.set("href", value.strip())
            else:
                self.left["href"] += 1
        elif space or not _NAME.fullmatch(local) or local.startswith("data-"):
            return
        elif local.lower().startswith(_UNUSED):
            self.left[local[:20]] += 1
        elif (clean := self._value(value)) is None:
            self.left[local] += 1
        else:
            made.set(local, clean)

    def _value(self, value: str) -> str | None:
        """An attribute that may hold CSS; None: it asks for something beyond the file, or hides what it asks for."""
        value = _FILTER.sub("", _COMMENT.sub("", value))
        return None if "\\" in value or _ASKING.search(_REFERENCE.sub("", value)) else value

    def _rules(self, sheet: str) -> str:
        sheet, at_rules = _AT_RULE.subn("", _COMMENT.sub("", sheet))
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
        self.pictures += 1
        if self.pictures > _MOST_PICTURES:
            raise PeopleError("file-svg-drawn", name=self.name)
        try:
            data = base64.b64decode(element.get(key, "").strip()[head.end() :])
        except (binascii.Error, ValueError):
            return False
        data, ending, _ = self.picture(self.name, data)
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


def _check_drawn(name: str, root: ElementTree.Element) -> None:
    """Raises PeopleError where little text draws without end: uses, patterns, masks, clips and markers that nest."""
    by_id = {one.get("id"): one for one in root.iter() if one.get("id")}
    known: dict[ElementTree.Element, int] = {}
    within: set[ElementTree.Element] = set()

    def drawn(element: ElementTree.Element, depth: int) -> int:
        if element in known:
            return known[element]
        if element in within or depth > 2 * _MOST_DEEP:
            raise PeopleError("file-svg-drawn", name=name)
        within.add(element)
        count = 1 + sum(drawn(child, depth + 1) for child in element)
        for key in references(element):
            if (target := by_id.get(key)) is not None:
                count += drawn(target, depth + 1)
        within.discard(element)
        known[element] = count = min(count, _MOST_DRAWN + 1)
        return count

    def references(element: ElementTree.Element) -> Iterator[str]:
        for key, value in element.attrib.items():
            if key == "href" and value.startswith("#"):
                yield value[1:]
            yield from (match[2] for match in _REFERENCE.finditer(value))

    # A rule of a style sheet serves any number of elements: it may name what costs nothing, and clips of one shape.
    for sheet in root.iter("style"):
        for match in _REFERENCE.finditer(sheet.text or ""):
            target = by_id.get(match[2])
            plain = target is None or target.tag in _GRADIENTS
            if not (plain or (len(list(target.iter())) <= 2 and target.find("use") is None)):
                raise PeopleError("file-svg-drawn", name=name)
    if drawn(root, 0) > _MOST_DRAWN:
        raise PeopleError("file-svg-drawn", name=name)
