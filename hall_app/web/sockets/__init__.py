"""Two sockets a visitor.

origin: who may open one; tasks: what a connection does at once; relay: viser's; walk: ours.
"""

from hall_app.web.sockets.relay import Turns, Views, add_relay, message_kind
from hall_app.web.sockets.tasks import until_first
from hall_app.web.sockets.walk import add_walk_socket

__all__ = ["Turns", "Views", "add_relay", "add_walk_socket", "message_kind", "until_first"]
