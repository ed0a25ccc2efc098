"""Curators' Markdown to HTML: no raw HTML, links only to the web or inside, pictures only of the exhibit."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from html import escape
from typing import Any
from urllib.parse import unquote

from markdown_it import MarkdownIt
from markdown_it.renderer import RendererHTML
from markdown_it.token import Token

SCHEME = re.compile(r"^[a-z][a-z0-9+.-]*:", re.IGNORECASE)
Address = Callable[[str], str | None]


def link_allowed(url: str) -> bool:
    """http(s) addresses and relative ones; not `//host`, `javascript:`, `data:`, `file:` and the like."""
    plain = "".join(character for character in url if character > " ").replace("\\", "/")
    if plain.startswith("//"):
        return False
    return plain.lower().startswith(("http://", "https://")) or not SCHEME.match(plain)


@lru_cache(maxsize=1)
def _parser() -> MarkdownIt:
    parser = MarkdownIt("commonmark", {"html": False, "typographer": False}).enable("table")
    parser.validateLink = link_allowed
    parser.add_render_rule("image", _image)
    parser.add_render_rule("link_open", _link_open)
    return parser


def _image(_self: RendererHTML, tokens: Sequence[Token], index: int, _options: Any, env: Any) -> str:
    token = tokens[index]
    words = escape("".join(child.content for child in token.children or ()))
    address = env["picture"](_path_of(token))
    if address is None:
        return words  # only the exhibit's own pictures are shown: the hall asks no other server
    return f'<img src="{escape(address)}" alt="{words}" loading="lazy">'


def _link_open(self: RendererHTML, tokens: Sequence[Token], index: int, options: Any, env: Any) -> str:
    if str(tokens[index].attrGet("href") or "").lower().startswith("http"):
        tokens[index].attrSet("target", "_blank")
        tokens[index].attrSet("rel", "noopener noreferrer")
    return self.renderToken(tokens, index, options, env)


def _path_of(token: Token) -> str:
    """The picture's path as the curator wrote it: the parser escapes spaces and Chinese letters with %."""
    return unquote(str(token.attrGet("src") or "").partition("?")[0])


def html_of(markdown: str, picture: Address) -> str:
    """HTML of a curator's text. `picture(path)` gives a picture's address, or None to show its words only."""
    return _parser().render(markdown, {"picture": picture})


def pictures_in(markdown: str) -> Iterator[str]:
    """The path of every picture in the text, as written there."""
    for block in _parser().parse(markdown):
        for token in block.children or ():
            if token.type == "image":
                yield _path_of(token)


def raw_html_in(markdown: str) -> str | None:
    """The first thing that looks like an HTML tag outside code; the hall shows it as plain letters."""
    for block in _parser().parse(markdown):
        for token in block.children or ():
            if token.type == "text" and (
                found := re.search(r"</?[a-z][^>\n]*>", token.content, re.IGNORECASE)
            ):
                return found.group()
    return None
