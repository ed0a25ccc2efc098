"""Who may open a socket: only pages that this server itself has handed out."""

from urllib.parse import urlsplit

from starlette.websockets import WebSocket

__all__ = ["same_origin"]


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
