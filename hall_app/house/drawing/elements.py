"""What is kept of a drawing's tree: elements and attributes that draw, and what is said of them in styles.

Programs, animations, links, filters, addresses beyond the file, embedded documents, comments and what editors note of
themselves are left out; embedded pictures are drawn anew.
"""

from __future__ import annotations

import base64
import codecs
import re
from collections import Counter
from collections.abc import Callable, Iterator, Set
from dataclasses import dataclass, field
from typing import NoReturn
from urllib.parse import unquote
from xml.etree import ElementTree
from xml.parsers.expat import ExpatError, ParserCreate

import tinycss2

from hall_app.content.models import PictureError, picture_size
from hall_app.house.drawing.cost import MOST_DEEP, draws_too_much
from hall_app.house.drawing.dashes import Told, dashed
from hall_app.house.drawing.sheets import TooMuch, told_by_sheets
from hall_app.house.drawing.styles import (
    LONGEST_VALUE,
    PROPERTIES,
    clean,
    declared,
    note,
    plain,
    target,
    weighty,
    written,
)
from hall_app.house.people import PeopleError

__all__ = ["redrawn"]

_SVG, _XLINK = "http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"
_SHAPES = "path rect circle ellipse line polyline polygon text image use"
_DRAWN = frozenset(
    f"svg g a defs symbol switch title desc {_SHAPES} tspan textPath linearGradient radialGradient stop pattern "
    "clipPath mask marker".split()
)
_TEXTS = frozenset(("text", "tspan", "textPath"))
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9-]*")
# How names begin that draw nothing here.
_UNUSED = ("on", "filter", "begin", "end", "dur", "values", "pathlength")
_PICTURE = re.compile(r"data:image/(?:png|jpe?g|webp)\s*(?:;[\w=-]+\s*)*;\s*base64\s*,", re.IGNORECASE)
_TYPES = {".png": "png", ".jpg": "jpeg", ".webp": "webp"}
_XML = "{http://www.w3.org/XML/1998/namespace}"
_LANGUAGE = re.compile(r"[A-Za-z0-9-]{0,35}")  # by which a browser chooses how Han characters are written

_DECLARED = re.compile(rb"^\s*<\?xml[^>]*?encoding\s*=\s*[\"']([\w-]+)[\"'][^>]*\?>")
_DECLARATION = re.compile(r"^\s*<\?xml[^>]*\?>")
_HEAD = 200  # bytes in which the encoding is declared
# What expat does not read by itself, and what it is read as.
_ENCODINGS = {
    "gb2312": "gb18030",
    "gbk": "gb18030",
    "gb18030": "gb18030",
    "big5": "big5hkscs",
    "shift_jis": "cp932",
}

_DASHES = "stroke-dasharray"
_READ = frozenset(("clip-path", "mask", _DASHES))  # as a style says them, whatever they look like
_LONGEST_SPACE = 200  # characters of a namespace's name, which every name of the tree repeats
_MOST_WRITTEN = 60_000  # elements of the file
_MOST_ATTRIBUTES = 300_000
_MOST_ENTITIES, _LONGEST_ENTITY, _MOST_UNFOLDED = 20, 200, 100_000
_MOST_PICTURES, _MOST_PIXELS = 200, 20_000_000  # pictures within, and pixels of all of them
_MOST_STYLED = 1_000_000  # characters of style attributes that differ
_MOST_TOLD = 8


def redrawn(
    name: str, data: bytes, picture: Callable[[str, bytes], tuple[bytes, str, str]], most: int
) -> tuple[bytes, str]:
    """(SVG, what is known of it). name: for messages; picture: draws an embedded picture anew, as (bytes, ending, …);
    most: bytes it may have once pictures are drawn anew.

    Without dashes where they would be too many, or nobody can tell. Raises PeopleError.
    """
    tree = _tree(name, data)
    cleaning = _Cleaning(name, picture, most)
    try:
        root, sheet, said = cleaning.cleaned(tree)
        if draws_too_much(root, said, dashes=False):
            raise TooMuch
        if dashed(said) and draws_too_much(root, said, dashes=True):
            cleaning = cleaning.without(_DASHES)
            root, sheet, _ = cleaning.cleaned(tree)
    except PeopleError:
        raise
    except (TooMuch, RecursionError):  # what nests in styles is followed as it nests
        raise PeopleError("file-svg-drawn", name=name) from None
    except ValueError as error:  # numbers of thousands of figures, which tinycss2 cannot read
        raise PeopleError("file-broken", name=name, why=str(error)[:120]) from None
    if sheet:
        root.insert(0, ElementTree.Element("style"))
        root[0].text = sheet
    root.set("xmlns", _SVG)
    known = " × ".join(_measures(root))
    if cleaning.left:
        often = sorted(cleaning.left.most_common(_MOST_TOLD))
        known += " · − " + ", ".join(f"{key} {count}" for key, count in often)
    data = ElementTree.tostring(root, "utf-8", xml_declaration=True)
    if len(data) > most:
        cleaning.too_large()
    return data, known.removeprefix(" · ")


def _tree(name: str, data: bytes) -> ElementTree.Element:
    """Looked through before it is read: what is declared, an entity or an attribute, may be small as a file alone."""
    try:
        data = _as_utf8(name, data)
        _look_through(name, data)
        root = ElementTree.fromstring(data)
    except PeopleError:
        raise
    except (ExpatError, ElementTree.ParseError, ValueError, LookupError) as error:
        raise PeopleError("file-broken", name=name, why=str(error)[:120]) from None
    if _local(root.tag) != "svg":
        raise PeopleError("file-kind", name=name)
    return root


def _as_utf8(name: str, data: bytes) -> bytes:
    """As it is where expat reads it. Raises PeopleError, or ValueError of the decoder."""
    told = _DECLARED.match(data[:_HEAD])
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        text = data.decode("utf-16")
    elif told is not None and (known := _ENCODINGS.get(told[1].decode().lower())):
        text = data.decode(known)
    elif b"\0" in data:
        raise PeopleError("file-broken", name=name, why="it is no UTF-8")
    else:
        return data
    return _DECLARATION.sub("", text).encode()


def _look_through(name: str, data: bytes) -> None:
    """Raises PeopleError for declarations but the short names some programs give to addresses, and for what is too deep
    or too long; ExpatError for what is no XML."""
    depth = count = given = 0
    entities: list[str] = []

    def refuse(*_: object) -> NoReturn:
        raise PeopleError("file-svg", name=name)

    def attribute(_: str, key: str, *__: object) -> None:
        if not key.startswith("xmlns"):  # old programs declare so what their names begin with
            refuse()

    def entity(called: str, parameter: bool, value: str | None, *_: object) -> None:
        entities.append(called)
        unfolded = data.count(f"&{called};".encode()) * len(value or "")
        if (
            parameter
            or not called.isascii()
            or value is None
            or set("&<%") & set(value)
            or len(value) > _LONGEST_ENTITY
            or len(entities) > _MOST_ENTITIES
            or unfolded > _MOST_UNFOLDED
        ):
            refuse()

    def begin(_: str, attributes: dict[str, str]) -> None:
        nonlocal depth, count, given
        depth, count, given = depth + 1, count + 1, given + len(attributes)
        spaces = (len(value) for key, value in attributes.items() if key.startswith("xmlns"))
        much = count > _MOST_WRITTEN or given > _MOST_ATTRIBUTES
        if depth > MOST_DEEP or much or max(spaces, default=0) > _LONGEST_SPACE:
            raise PeopleError("file-svg-drawn", name=name)

    def end(_: str) -> None:
        nonlocal depth
        depth -= 1

    parser = ParserCreate()
    parser.EntityDeclHandler, parser.AttlistDeclHandler = entity, attribute
    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.Parse(data, True)


@dataclass
class _Cleaning:
    """left: what was left out, and how often; sheets: (media, text) of style sheets; said: by style attributes."""

    name: str
    picture: Callable[[str, bytes], tuple[bytes, str, str]]
    most: int
    left: Counter[str] = field(default_factory=Counter)
    sheets: list[tuple[str, str]] = field(default_factory=list)
    said: dict[ElementTree.Element, list[tuple[str, str]]] = field(default_factory=dict)
    values: dict[tuple[str, str], str | None] = field(default_factory=dict)
    styles: dict[str, tuple[str, list[tuple[str, str]], Counter[str]]] = field(default_factory=dict)
    styled: int = 0
    pictures: dict[str, str | None] = field(default_factory=dict)
    pixels: int = 0
    drawn: int = 0  # pictures
    embedded: int = 0  # characters of pictures, each as often as it is written
    properties: Set[str] = PROPERTIES  # that are kept

    def without(self, key: str) -> _Cleaning:
        """Begun anew, for a file whose pictures are drawn already."""
        fewer = _Cleaning(self.name, self.picture, self.most, properties=self.properties - {key})
        fewer.pictures, fewer.pixels, fewer.drawn = self.pictures, self.pixels, self.drawn
        return fewer

    def cleaned(self, tree: ElementTree.Element) -> tuple[ElementTree.Element, str, Told]:
        """(what is kept of it, its style sheet, what is said of each element that decides how much is drawn).

        Raises TooMuch, PeopleError, RecursionError, and ValueError of tinycss2.
        """
        root = self.kept(tree, "svg")
        told, sheet = told_by_sheets(self.sheets, root, self.left, self.properties)
        _without_links(root)
        said = {
            one: [*weighty(one.attrib.items()), *told.get(one, ()), *self.said.get(one, ())]
            for one in root.iter()
        }
        return root, sheet, said

    def kept(self, source: ElementTree.Element, tag: str) -> ElementTree.Element:
        """The element with what draws of it under that name, its names without a namespace."""
        made = ElementTree.Element(tag)
        for name, value in source.attrib.items():
            self._attribute(made, name, value)
        words = [source.text or ""]  # since the last child that was kept
        for child in source:
            local = _local(child.tag)
            if local in _DRAWN and (local != "image" or self._embedded(child)):
                _speak(made, words)
                made.append(self.kept(child, local))
                words = []
            elif local == "style" and child.get("type", "").strip().lower() in ("", "text/css"):
                self.sheets.append((child.get("media", ""), "".join(child.itertext())))
            elif local not in ("", "metadata"):  # what an editor notes for itself is no loss
                note(self.left, local)
            words.append(child.tail or "")
        _speak(made, words)
        return made

    def _attribute(self, made: ElementTree.Element, name: str, value: str) -> None:
        space, _, local = name.rpartition("}")
        if name == _XML + "space" or (name == _XML + "lang" and _LANGUAGE.fullmatch(value)):
            made.set(name, value)
        elif local == "href" and space in ("", "{" + _XLINK):
            picture = made.tag == "image"
            named = None if picture else target(value, linked=True)
            kept = self._anew(value) if picture else named and f"#{named}"
            if kept is None:
                note(self.left, "href")
            elif not space or "href" not in made.attrib:
                made.set("href", kept)
                self.embedded += len(kept) if picture else 0
                if self.embedded > self.most:
                    self.too_large()
        elif space or not _NAME.fullmatch(local) or local.startswith("data-"):
            return
        elif local.lower().startswith(_UNUSED):
            note(self.left, local)
        elif local in ("id", "class"):
            made.set(local, value)
        elif local == "style":
            self._style(made, value)
        elif (kept := self._value(local, value)) is None:
            note(self.left, local)
        else:
            made.set(local, kept)

    def _value(self, name: str, value: str) -> str | None:
        """What an attribute may say; None: it asks for something beyond the file, or hides what it asks for."""
        read = name in PROPERTIES and (name in _READ or not plain(value))
        if not read:
            return value if plain(value) else None
        if len(value) > LONGEST_VALUE or name not in self.properties:
            return None
        if (name, value) not in self.values:
            tokens = tinycss2.parse_component_value_list(value, skip_comments=True)
            self.values[name, value] = clean(name, tokens)
        return self.values[name, value]

    def _style(self, made: ElementTree.Element, value: str) -> None:
        """Programs say the same of many elements; it is read once."""
        if value not in self.styles:
            self.styled += len(value)
            if self.styled > _MOST_STYLED:
                raise PeopleError("file-svg-drawn", name=self.name)
            left = Counter[str]()
            said, stressed = declared(value, left, self.properties)
            self.styles[value] = (
                written(said, stressed),
                weighty([*said.items(), *stressed.items()]),
                left,
            )
        style, said, left = self.styles[value]
        self.left.update(left)
        if style:
            made.set("style", style)
            self.said[made] = said

    def too_large(self) -> NoReturn:
        raise PeopleError("file-size", name=self.name, kind="drawing", most=self.most // 1_000_000)

    def _embedded(self, element: ElementTree.Element) -> bool:
        """Whether the picture lies in the file, and can be drawn."""
        keys = (name for name in element.attrib if name.rpartition("}")[2] == "href")
        return any(self._anew(element.get(name, "")) for name in keys)

    def _anew(self, given: str) -> str | None:
        given = given.strip()
        if given not in self.pictures:
            self.pictures[given] = self._drawn_anew(given)
        return self.pictures[given]

    def _drawn_anew(self, given: str) -> str | None:
        head = _PICTURE.match(given)
        if head is None:
            return None
        try:
            data = base64.b64decode(unquote(given[head.end() :]))
            width, height = picture_size(data)
            self.pixels += width * height
            self.drawn += 1
            if self.pixels > _MOST_PIXELS or self.drawn > _MOST_PICTURES:
                raise PeopleError("file-svg-drawn", name=self.name)
            data, ending, _ = self.picture(self.name, data)
        except PeopleError as error:
            if error.key != "file-broken":
                raise
            return None
        except (ValueError, PictureError):  # no base64, no picture
            return None
        return f"data:image/{_TYPES[ending]};base64,{base64.b64encode(data).decode()}"


def _speak(made: ElementTree.Element, words: list[str]) -> None:
    """What is said after the last of its children, or before there is any."""
    said = "".join(words).replace("\r", "\n") or None  # as it is read again
    if len(made):
        made[-1].tail = said
    else:
        made.text = said


def _without_links(root: ElementTree.Element) -> None:
    """A link leads nowhere from a picture; what it holds is drawn."""
    for one in root.iter():
        for child in one:
            if child.tag == "a":
                child.tag = "tspan" if one.tag in _TEXTS else "g"
                for name in ("target", "download", "type", "href"):
                    child.attrib.pop(name, None)


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
