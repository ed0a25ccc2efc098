"""The page: viser's own client with our style and script in its head."""

import html
import json
from collections.abc import Mapping
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path

__all__ = ["PAGE_FOLDER", "VISER_VERSION", "hall_page", "content_security_policy"]

PAGE_FOLDER = Path(__file__).parent.parent / "page"

# The page reads viser's internals (window.__viserMutable and friends), which are no public API.
VISER_VERSION = "1.1.1"

_HEAD = """
<link rel="stylesheet" href="/static/hall.css?v={stamp}">
<script>window.HALL={settings};</script>
<script>{first}</script>
<script type="module" src="/static/hall.js?v={stamp}"></script>
<noscript><p><a href="/catalogue">{noscript}</a></p></noscript>
"""


# Before viser's script, so that a frame's first callback runs ours ahead of its renderer: what the page sets is
# drawn in the same frame and not in the next one, which costs a software renderer a tenth of a second.
_FIRST = r"""
{
  const request = window.requestAnimationFrame.bind(window);
  let latest = -1;
  window.requestAnimationFrame = (callback) => request((now) => {
    if (now !== latest) { latest = now; window.HALL.beforeFrame?.(now); }
    callback(now);
  });
  // viser draws a picture every second whether or not something moved; the page says when that may be left out.
  const repeat = window.setInterval.bind(window);
  const heartbeat = (act, every) => every === 1000 && /^\(\)=>\w+\(\)$/.test(String(act).replace(/\s/g, ""));
  window.setInterval = (act, every, ...rest) =>
    repeat(heartbeat(act, every) ? () => { if (!window.HALL.mayRest?.()) act(); } : act, every, ...rest);
  // viser makes a sorter for Gaussian splats at once. It wants eval, which our policy forbids; the hall has no splats.
  const ask = window.fetch.bind(window);
  window.fetch = (what, ...rest) =>
    String(what).startsWith("data:application/wasm") ? new Promise(() => {}) : ask(what, ...rest);
}
"""


@lru_cache(maxsize=1)
def _client() -> tuple[str, str]:
    """viser's page, cut before the end of its outer head; the rest is a packed loader.

    Raises RuntimeError when another version of viser is installed.
    """
    import viser

    installed = version("viser")
    if installed != VISER_VERSION:
        raise RuntimeError(f"viser {installed} is installed, the page is made for viser=={VISER_VERSION}")
    page = Path(viser.__file__).parent / "client" / "build" / "index.html"
    head, tail = page.read_text("utf-8").split("</head>", 1)
    return head, tail


def hall_page(title: str, stamp: str, *, language: str, settings: Mapping[str, object]) -> str:
    """The page's HTML; `title` is escaped, `settings` reaches the script as `window.HALL`."""
    head, tail = _client()
    head = head.replace("<title>Viser</title>", f"<title>{html.escape(title)}</title>")
    head = head.replace('<html lang="en">', f'<html lang="{html.escape(language)}">')
    # "<" would end the script element from inside a string.
    literal = json.dumps(settings, ensure_ascii=True).replace("<", "\\u003c")
    noscript = "展品目录 · Catalogue of the exhibits"
    return (
        head + _HEAD.format(stamp=stamp, settings=literal, first=_FIRST, noscript=noscript) + "</head>" + tail
    )


def content_security_policy() -> str:
    """Nothing from elsewhere; viser needs its inline loader, its worker and WebAssembly."""
    return "; ".join(
        (
            "default-src 'self'",
            "script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval' blob: data:",
            "worker-src 'self' blob: data:",
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
