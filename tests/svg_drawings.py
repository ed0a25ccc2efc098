"""Drawings in SVG to clean: one around given elements, and few bytes that draw without end."""

__all__ = ["doubled", "drawing"]


def drawing(inside: bytes, root: bytes = b"svg") -> bytes:
    told = b' xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9">'
    return b"<" + root + told + inside + b"<!-- <svg --></" + root + b">"


def doubled(times: int) -> bytes:
    """Few bytes that draw one path 2^times times."""
    levels = [b'<path id="u0" d="M0 0h9"/>']
    for n in range(1, times + 1):
        levels.append(b'<g id="u%d"><use href="#u%d"/><use href="#u%d"/></g>' % (n, n - 1, n - 1))
    return b"".join(levels)
