"""What an SVG file may ask of a reader: depth, and how often `<use>` may draw; and what a pattern has no use for."""

import re
from collections import Counter
from xml.etree import ElementTree

from sim_core.mesh.sheets.strokes.left_out import MOST_VISITED

__all__ = ["check_bounds", "left_out_of"]

MOST_DEEP = 200
UNREAD = ("text", "image", "foreignObject")


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
