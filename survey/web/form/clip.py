"""The film that is shown beside items on motion, where the host has one of the exhibit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from html import escape

from survey.questionnaire import Language, Module

__all__ = ["MOTION", "Clip", "ClipOf", "clip_html"]

MOTION = "dynamic"  # tag of the items that can only be judged in motion


@dataclass(frozen=True)
class Clip:
    """A film. sources: (address, media type), preferred first; poster: address of a still; alt: what it shows."""

    sources: tuple[tuple[str, str], ...]
    alt: dict[Language, str]
    poster: str | None = None


ClipOf = Callable[[str], Clip | None]  # exhibit → its film


def clip_html(clip: Clip | None, module: Module, language: Language) -> str:
    """The film as the head of a module that asks about motion, else nothing. Muted: it may be watched among others."""
    if clip is None or not any(MOTION in item.tags for item in module.items):
        return ""
    sources = "".join(f'<source src="{escape(url)}" type="{escape(kind)}">' for url, kind in clip.sources)
    poster = f' poster="{escape(clip.poster)}"' if clip.poster else ""
    alt = escape(clip.alt.get(language, ""))
    return (
        f'<video class="clip" controls muted loop playsinline preload="metadata"{poster} aria-label="{alt}">'
        f"{sources}</video>"
    )
