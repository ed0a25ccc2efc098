"""Curators' Markdown to HTML: no raw HTML, links only to the web or inside, pictures only of the exhibit.

References are links by name: [罗](word:luo), [the gown](exhibit:gown), [luo](weave:luo), [pleats](article:pleats).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache
from html import escape
from typing import Any
from urllib.parse import unquote

from markdown_it import MarkdownIt
from markdown_it.renderer import RendererHTML
from markdown_it.token import Token

SCHEME = re.compile(r"^[a-z][a-z0-9+.-]*:", re.IGNORECASE)
REFERENCE = re.compile(r"^(word|exhibit|weave|article):([a-z0-9-]+)$")
Address = Callable[[str], str | None]
Draw = Callable[[str, str], str]
Refer = Callable[
    [str, str], Mapping[str, str] | None
]  # (kind, name) -> the link's attributes, None: words alone


def link_allowed(url: str) -> bool:
    """http(s) addresses and relative ones; not `//host`, `javascript:`, `data:`, `file:` and the like."""
    plain = "".join(character for character in url if character > " ").replace("\\", "/")
    if plain.startswith("//"):
        return False
    known = plain.lower().startswith(("http://", "https://")) or REFERENCE.match(plain)
    return bool(known) or not SCHEME.match(plain)


@lru_cache(maxsize=1)
def _parser() -> MarkdownIt:
    parser = MarkdownIt("commonmark", {"html": False, "typographer": False}).enable("table")
    parser.validateLink = link_allowed
    parser.add_render_rule("image", _image)
    parser.add_render_rule("link_open", _link_open)
    parser.add_render_rule("th_open", _head_open)
    return parser


def _image(_self: RendererHTML, tokens: Sequence[Token], index: int, _options: Any, env: Any) -> str:
    token = tokens[index]
    words = escape("".join(child.content for child in token.children or ()))
    address = env["picture"](_path_of(token))
    if address is None:
        return words  # only the exhibit's own pictures are shown: the hall asks no other server
    below = token.attrGet("title") if env["figures"] else None
    caption = f"<figcaption>{escape(str(below))}</figcaption>" if below else ""
    return env["draw"](address, words) + caption


def _plainly(address: str, words: str) -> str:
    return f'<img src="{escape(address)}" alt="{words}" loading="lazy">'


def _link_open(self: RendererHTML, tokens: Sequence[Token], index: int, options: Any, env: Any) -> str:
    if str(tokens[index].attrGet("href") or "").lower().startswith("http"):
        tokens[index].attrSet("target", "_blank")
        tokens[index].attrSet("rel", "noopener noreferrer")
    return self.renderToken(tokens, index, options, env)


def _head_open(self: RendererHTML, tokens: Sequence[Token], index: int, options: Any, env: Any) -> str:
    """The corner of a table that nothing is written in heads nothing: who hears the page is told of no such head."""
    if not tokens[index + 1].content.strip():
        tokens[index].tag = tokens[index + 2].tag = "td"
    return self.renderToken(tokens, index, options, env)


def _path_of(token: Token) -> str:
    """The picture's path as the curator wrote it: the parser escapes spaces and Chinese letters with %."""
    return unquote(str(token.attrGet("src") or "").partition("?")[0])


def html_of(
    markdown: str,
    picture: Address,
    *,
    draw: Draw = _plainly,
    top: int | None = None,
    refer: Refer | None = None,
    figures: bool = False,
) -> str:
    """HTML of a curator's text. `picture(path)` gives a picture's address, or None to show its words only.

    draw(address, words): the HTML of a picture, its words escaped already. top: level of the text's own first
    headings, for a page in which it stands beneath others; None leaves levels as they were written. refer: where
    references lead; without it they are words. figures: a picture alone in its paragraph is a figure, its title
    the caption.
    """
    env = {"picture": picture, "draw": draw, "figures": figures}
    tokens = _parser().parse(markdown, env)
    for token in tokens:
        if token.children:
            token.children = list(_referred(token.children, refer))
    if top is not None:
        _set_beneath(tokens, top)
    if figures:
        _set_apart(tokens)
    return _parser().renderer.render(tokens, _parser().options, env)


def _referred(tokens: Sequence[Token], refer: Refer | None) -> Iterator[Token]:
    """The tokens of a line, references with the attributes of their links; what leads nowhere loses its link."""
    dropped = False  # links never stand in one another
    for token in tokens:
        found = REFERENCE.match(str(token.attrGet("href") or "")) if token.type == "link_open" else None
        if found is not None:
            attributes = refer(found[1], found[2]) if refer is not None else None
            dropped = attributes is None
            token.attrs = dict(attributes or {})
        if dropped and token.type in ("link_open", "link_close"):
            dropped = token.type == "link_open"
            continue
        yield token


def _set_apart(tokens: Sequence[Token]) -> None:
    """Make figures of the paragraphs that hold a picture and nothing else."""
    for before, line, after in zip(tokens, tokens[1:], tokens[2:], strict=False):
        if before.type == "paragraph_open" and [one.type for one in line.children or ()] == ["image"]:
            before.tag = after.tag = "figure"


def references_in(markdown: str) -> Iterator[tuple[str, str]]:
    """(kind, name) of every reference in the text, in its order."""
    for block in _parser().parse(markdown):
        for token in block.children or ():
            found = REFERENCE.match(str(token.attrGet("href") or "")) if token.type == "link_open" else None
            if found is not None:
                yield found[1], found[2]


def words_in(markdown: str) -> str:
    """The words of a text alone, a space between its blocks; captions and alternative texts among them."""
    return " ".join(
        "".join(_plain_words(token) for token in block.children or ())
        for block in _parser().parse(markdown)
        if block.type == "inline"
    )


def _plain_words(token: Token) -> str:
    if token.type == "image":
        return f"{token.content} {token.attrGet('title') or ''}"
    return " " if token.type in ("softbreak", "hardbreak") else token.content


def _set_beneath(tokens: Sequence[Token], top: int) -> None:
    """Number the headings from `top` on without a gap, whatever levels the curator chose."""
    above: list[int] = []
    for token in tokens:
        if token.type == "heading_open":
            written = int(token.tag[1:])
            while above and above[-1] >= written:
                above.pop()
            above.append(written)
        if token.type in ("heading_open", "heading_close"):
            token.tag = f"h{min(top + len(above) - 1, 6)}"


def pictures_in(markdown: str) -> Iterator[str]:
    """The path of every picture in the text, as written there."""
    for block in _parser().parse(markdown):
        for token in block.children or ():
            if token.type == "image":
                yield _path_of(token)


def undescribed_in(markdown: str) -> Iterator[str]:
    """The path of every picture in the text that has no words for who cannot see it."""
    for block in _parser().parse(markdown):
        for token in block.children or ():
            if token.type == "image" and not token.content.strip():
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


def plain_text(markdown: str) -> str:
    """The text without its marks: a line for each paragraph, heading, list entry and table row; pictures left out."""
    lines: list[str] = []
    cells: list[str] | None = None  # of the table row that is being read
    for token in _parser().parse(markdown):
        if token.type == "tr_open":
            cells = []
        elif token.type == "tr_close" and cells is not None:
            lines, cells = [*lines, " · ".join(cells)], None
        elif token.type == "inline":
            words = "".join(_words(child) for child in token.children or ()).strip()
            (lines if cells is None else cells).append(words)
        elif token.type in ("fence", "code_block"):
            lines.append(token.content.rstrip())
    return "\n".join(line for line in lines if line)


def _words(token: Token) -> str:
    """What is read of an inline part."""
    if token.type in ("softbreak", "hardbreak"):
        return " "
    return "" if token.type == "image" else token.content
