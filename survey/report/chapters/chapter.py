"""A part of the report that some other analysis adds: what stands in it, whoever sets the page."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from survey.report.tables import Table
from survey.report.words import Words

__all__ = ["Chapter", "Drawing", "Further"]


@dataclass(frozen=True)
class Drawing:
    """key: name of the SVG file. svg: id prefix → the <svg>."""

    key: str
    caption: str
    svg: Callable[[str], str]


@dataclass(frozen=True)
class Chapter:
    """title: key of the heading's words. parts: paragraphs (text, not yet escaped), tables and drawings in order."""

    title: str
    parts: tuple[str | Table | Drawing, ...]


Further = Callable[[Words], Chapter]  # what is to be told, in one language
