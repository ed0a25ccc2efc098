"""The page at `/`: the door, painted before anything else is fetched, and the names of all that follows."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable, Mapping
from functools import lru_cache
from hashlib import sha256
from html import escape
from string import Template
from typing import Any

from hall_app.content.schema.hall import HallFile
from hall_app.web.pages.client import viser_client
from hall_app.web.pages.static import AHEAD, REST, SCRIPT, PageFiles

__all__ = ["ICON", "content_security_policy", "door_page"]

# The hall's seal; without it a browser asks for /favicon.ico.
ICON = (
    "data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 32 32'%3E"
    "%3Crect width='32' height='32' rx='4' fill='%239e2b25'/%3E"
    "%3Cpath d='M5 5h22v22H5zM12 5v7H5M12 12h8M20 5v15h7M12 12v15M12 20h8' fill='none' stroke='%23f6f1e6'"
    " stroke-width='1.6'/%3E%3C/svg%3E"
)

LANGUAGES = {"zh": "zh-Hans", "en": "en"}


def door_page(
    files: PageFiles,
    hall: HallFile,
    *,
    exhibits: int,
    pack: tuple[str, int],
    still: bytes | None,
    without_hooks: bool = False,
) -> str:
    """The page's HTML. What curators wrote is escaped.

    exhibits: how many are shown; pack: name and bytes of the scene's pack (show/pieces.py), packed or, before it is,
    guessed; still: JPEG behind the words.
    """
    texts = files.texts
    both = _Both(texts)
    lead = both(lambda lang, t: " · ".join(filter(None, (_of(hall.subtitle, lang), _count(t, exhibits)))))
    about = both(lambda lang, t: _of(hall.about, lang) or t["enter"]["about"])
    settings = _settings(files, hall, texts, pack) | {"withoutHooks": without_hooks}
    own = hall.language
    return Template(files.sources["door.html"]).substitute(
        tag=LANGUAGES[own],
        icon=ICON,
        title=escape(_of(hall.title, own)),
        description=escape(_of(hall.about, own) or _of(hall.title, own)),
        style=files.first_style,
        still=_background(still) if still else "",
        titles=both(lambda lang, t: _of(hall.title, lang)),
        second=both(lambda lang, t: _of(hall.title, _other(lang)), words_of=_other),
        lead=lead,
        about=about,
        noscript=both(lambda lang, t: t["noscript"]["text"]),
        preparing=both(lambda lang, t: t["enter"]["preparing"]),
        failed=both(lambda lang, t: t["fail"]["title"]),
        retry=both(lambda lang, t: t["enter"]["retry"]),
        enter=both(lambda lang, t: t["enter"]["button"]),
        catalogue=both(lambda lang, t: t["enter"]["catalogue"]),
        music=both(lambda lang, t: t["enter"]["music"]),
        silent="" if hall.music else " hidden",
        progress=escape(texts[own]["enter"]["progress"]),
        language=escape(texts[own]["bar"]["language"]),
        settings=_literal(settings),
        door=files.sources["door.js"],
    )


def _background(jpeg: bytes) -> str:
    data = base64.b64encode(jpeg).decode()
    return f" style=\"background-image: url('data:image/jpeg;base64,{data}')\""


class _Both:
    """Text in both languages; style shows the one of the document (ui/enter/enter.css)."""

    def __init__(self, texts: Mapping[str, Any]) -> None:
        self.texts = texts

    def __call__(
        self, say: Callable[[str, Mapping[str, Any]], str], words_of: Callable[[str], str] = lambda lang: lang
    ) -> str:
        return "".join(
            f'<span data-in="{lang}" lang="{LANGUAGES[words_of(lang)]}">{escape(say(lang, self.texts[lang]))}</span>'
            for lang in LANGUAGES
        )


def _other(lang: str) -> str:
    return "en" if lang == "zh" else "zh"


def _of(text: Any, lang: str) -> str:
    return getattr(text, lang) if text else ""


def _count(texts: Mapping[str, Any], number: int) -> str:
    return texts["count"]["exhibit_one" if number == 1 else "exhibit_other"].replace("{n}", str(number))


def _settings(
    files: PageFiles, hall: HallFile, texts: Mapping[str, Any], pack: tuple[str, int]
) -> dict[str, Any]:
    """What page/door.js needs: addresses, and how many bytes each will be about, so that progress is true."""
    client = viser_client()
    name, weight = pack
    viser = f"/viser/{client.script.digest}"
    return {
        "language": hall.language,
        "title": {lang: _of(hall.title, lang) for lang in LANGUAGES},
        "texts": {
            lang: {
                "tag": tag,
                "language": texts[lang]["bar"]["language"],
                "progress": texts[lang]["enter"]["progress"],
                "loading": texts[lang]["progress"],
                "fail": texts[lang]["fail"],
            }
            for lang, tag in LANGUAGES.items()
        },
        "files": {
            "viewer": {
                "script": f"{viser}/viser.js",
                "style": f"{viser}/viser.css",
                "decoder": f"{viser}/zstd.wasm",
                "bytes": len(client.script.body),
                "weight": len(client.script.body) // 4,  # a script packs to a quarter
            },
            "models": {"pack": f"/scene/packs/{name}", "piece": "/scene/pieces/", "weight": weight},
            "ahead": f"/static/{files.stamp}/{AHEAD}",
            "page": f"/static/{files.stamp}/{SCRIPT}",
            "rest": f"/static/{files.stamp}/{REST}",
        },
    }


def _literal(value: object) -> str:
    """JSON for inside a script element: "<" would end it from inside a string."""
    return json.dumps(value, ensure_ascii=False, separators=(",", ":")).replace("<", "\\u003c")


@lru_cache(maxsize=2)
def _hash(script: str) -> str:
    return "'sha256-" + base64.b64encode(sha256(script.encode()).digest()).decode() + "'"


def content_security_policy(files: PageFiles) -> str:
    """Nothing from elsewhere, and of what stands in the page only the door's script.

    viser needs its workers, WebAssembly and styles of its own."""
    return "; ".join(
        (
            "default-src 'self'",
            f"script-src 'self' {_hash(files.sources['door.js'])} 'wasm-unsafe-eval'",
            "worker-src 'self' blob:",
            "style-src 'self' 'unsafe-inline'",
            "img-src 'self' blob: data:",
            "media-src 'self' blob:",
            "font-src 'self' data:",
            "connect-src 'self' ws: wss: blob: data:",
            "frame-src 'self'",
            "frame-ancestors 'self'",
            "object-src 'none'",
            "base-uri 'self'",
        )
    )
