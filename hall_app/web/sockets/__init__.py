"""Two sockets a visitor.

origin: who may open one; tasks: what a connection does at once; relay: viser's; walk: ours.
"""

from hall_app.web.sockets.origin import key_of, known_key, same_origin, with_key
from hall_app.web.sockets.relay import Turns, Views, add_relay, message_kind
from hall_app.web.sockets.tasks import until_first
from hall_app.web.sockets.walk import add_walk_socket

__all__ = [
    "Turns",
    "Views",
    "add_relay",
    "add_walk_socket",
    "key_of",
    "known_key",
    "message_kind",
    "same_origin",
    "until_first",
    "with_key",
]
