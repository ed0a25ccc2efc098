"""Who opens a socket: only pages that this server itself has handed out; the browser's key ties its two sockets.

The key is a random word that lives as long as the browser's session. It comes with the page, before either socket: two
that open at the same moment would bring two. It is kept in memory while the sockets are open, written down nowhere,
and says nothing but that viser's socket belongs to a page that was let in.
"""

import re
import secrets
from urllib.parse import urlsplit

from starlette.requests import HTTPConnection
from starlette.websockets import WebSocket

__all__ = ["key_of", "known_key", "same_origin", "with_key"]

_COOKIE = "hall-place"


def same_origin(socket: WebSocket) -> bool:
    """True when the page that opens the socket came from the host it connects to.

    A missing Origin header is no browser (a test, a script on this machine) and is let in.
    """
    origin = socket.headers.get("origin")
    if origin is None:
        return True
    try:
        return urlsplit(origin).netloc.lower() == socket.headers.get("host", "").lower()
    except ValueError:
        return False


def known_key(asking: HTTPConnection) -> str | None:
    """The key the browser has, None where it has none that we could have made."""
    key = asking.cookies.get(_COOKIE, "")
    return key if re.fullmatch(r"[0-9a-f]{32}", key) else None


def key_of(asking: HTTPConnection) -> str:
    """The browser's key, a new one where it has none."""
    return known_key(asking) or secrets.token_hex(16)


def with_key(asking: HTTPConnection, key: str) -> list[tuple[bytes, bytes]]:
    """The headers that tell the browser its key, none where it knows."""
    if asking.cookies.get(_COOKIE) == key:
        return []
    secure = "; Secure" if asking.url.scheme in ("wss", "https") else ""
    return [(b"set-cookie", f"{_COOKIE}={key}; Path=/; HttpOnly; SameSite=Strict{secure}".encode())]
