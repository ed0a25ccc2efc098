"""XML as values: a node has a name, attributes and children, and is written with every sign where it is allowed.

Names carry their prefix as they are written ("dc:title"), and each document declares its own namespaces at its root, as
OAI-PMH asks of the metadata it wraps.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from xml.sax.saxutils import escape, quoteattr

__all__ = ["Node", "document", "node"]

# All that XML 1.0 has no way to write, not even as a reference.
_UNWRITABLE = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'
_KEPT = {"\r": "&#13;"}  # a reader would make it a line feed
_KEPT_INSIDE = {"\r": "&#13;", "\n": "&#10;", "\t": "&#9;"}  # and these spaces, in an attribute


@dataclass(frozen=True)
class Node:
    """An element: either children or text."""

    name: str
    attributes: Mapping[str, str]
    children: tuple[Node, ...] = ()
    text: str = ""


def node(
    name: str,
    *inside: Node | str | None,
    lang: str | None = None,
    attributes: Mapping[str, str] | None = None,
) -> Node:
    """An element; what is None inside is left out. lang: its xml:lang."""
    told = {**(attributes or {}), **({"xml:lang": lang} if lang else {})}
    text = "".join(part for part in inside if isinstance(part, str))
    return Node(name, told, tuple(part for part in inside if isinstance(part, Node)), text)


def document(root: Node) -> bytes:
    """The whole document, UTF-8, indented where there is no text."""
    return (_HEAD + _written(root, "") + "\n").encode()


def _written(node: Node, margin: str) -> str:
    told = "".join(f" {name}={_quoted(value)}" for name, value in node.attributes.items())
    if node.text:
        return f"{margin}<{node.name}{told}>{escape(_clean(node.text), _KEPT)}</{node.name}>"
    if not node.children:
        return f"{margin}<{node.name}{told}/>"
    inside = "\n".join(_written(child, margin + "  ") for child in node.children)
    return f"{margin}<{node.name}{told}>\n{inside}\n{margin}</{node.name}>"


def _quoted(value: str) -> str:
    return quoteattr(_clean(value), _KEPT_INSIDE)


def _clean(text: str) -> str:
    """The text with U+FFFD for what XML cannot hold (control characters, halves of a pair)."""
    return _UNWRITABLE.sub("\ufffd", text)
