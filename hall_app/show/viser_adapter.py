"""All that the hall knows of viser's inside: no public API, pinned to one version and asserted in the tests.

What the page knows of it stands in page/viser/, what is known of its client's files in web/pages/client.py.
"""

from __future__ import annotations

import logging
import socket
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import viser

__all__ = ["open_viser", "queue_environment"]

_NODES_A_MESSAGE = 8  # the page draws the first while it fetches and reads the others


def open_viser() -> viser.ViserServer:
    """viser's server on a free port of 127.0.0.1, without its announcements."""
    import rich
    import viser

    # viser announces its beginning and, from a thread of its own, its end, whatever `verbose` says.
    # Nobody else in a serving process prints through rich's own console.
    rich.get_console().quiet = True
    # Only the relay comes to this port: whoever leaves while it is let in would be told with a traceback.
    logging.getLogger("websockets.server").setLevel(logging.CRITICAL)
    server = viser.ViserServer("127.0.0.1", _free_port(), verbose=False)
    server._websock_server.get_message_buffer().max_window_size = _NODES_A_MESSAGE
    return server


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def queue_environment(server: viser.ViserServer, picture: bytes | None, strength: float) -> None:
    """What every visitor's exhibits reflect: an equirectangular picture, None: nothing.

    viser's own call takes its presets only, so its message is queued directly.
    """
    from viser import _messages

    upright = (1.0, 0.0, 0.0, 0.0)
    server.scene._websock_interface.queue_message(
        _messages.EnvironmentMapMessage(
            hdri_data=picture,
            background=False,
            background_blurriness=0.0,
            background_intensity=1.0,
            background_wxyz=upright,
            environment_intensity=strength,
            environment_wxyz=upright,
        )
    )
