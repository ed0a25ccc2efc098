"""How the hall listens: its words on the command line, and the server behind its port."""

from __future__ import annotations

import argparse
import socket
from typing import TYPE_CHECKING

from hall_app.visit.places import MOST_VISITORS
from hall_app.web.limits.addresses import Addresses
from survey.commands import add_proxy

if TYPE_CHECKING:
    import uvicorn
    from fastapi import FastAPI

__all__ = ["add_limits", "check_port", "gigabytes", "port", "server"]


def add_limits(parser: argparse.ArgumentParser) -> None:
    """Declare how many come in, and whose word is believed on where they come from."""
    parser.add_argument(
        "--visitors",
        type=_count,
        default=MOST_VISITORS,
        metavar="N",
        help=f"visitors at a time, the others see their place in the queue (default {MOST_VISITORS})",
    )
    add_proxy(parser, "a proxy in front of the hall")


def server(
    app: FastAPI, arguments: argparse.Namespace, addresses: Addresses, connections: int
) -> uvicorn.Server:
    """uvicorn behind the hall's door, its limits narrowed; connections: how many at a time."""
    import uvicorn

    from hall_app.web.limits.lines import AT_A_TIME, LONGEST, Listener, Socket, line_class
    from hall_app.web.limits.open_lines import OpenLines

    lines = OpenLines(connections)
    mapped = [
        f"::ffff:{proxy}" for proxy in arguments.proxy if ":" not in proxy
    ]  # as an IPv6 socket tells it
    config = uvicorn.Config(
        app,
        host=arguments.host,
        port=arguments.port,
        log_level="warning",
        access_log=False,
        loop="asyncio",  # uvloop is faster, but reads one socket's flood for a second before it turns to the others
        http=line_class(addresses, lines, arguments.proxy),
        ws=Socket,
        ws_max_size=LONGEST,
        ws_per_message_deflate=False,  # 0.4 ms a message; what is large is packed before it is sent
        proxy_headers=bool(arguments.proxy),  # uvicorn would believe anybody on this machine
        forwarded_allow_ips=[*arguments.proxy, *mapped],
        backlog=AT_A_TIME,
        timeout_graceful_shutdown=2,
    )
    return Listener(config, lines)


def port(text: str) -> int:
    number = int(text)
    if not 1 <= number <= 65535:
        raise argparse.ArgumentTypeError(f"{number} is no port – give 1 to 65535")
    return number


def _count(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text[:6]) <= 10_000 or len(text) > 6:
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is no number of visitors – give 1 to 10000")
    return int(text)


def check_port(host: str, port: int) -> None:
    """Say at once that the port is taken, before anything is prepared."""
    with socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            raise OSError(
                f"cannot listen on {host}:{port} ({error.strerror}) – choose another with --port"
            ) from error


def gigabytes(text: str) -> float:
    """A size for argparse [GB]."""
    try:
        size = float(text)
    except ValueError:
        size = 0.0
    if not 0 < size <= 10_000:
        raise argparse.ArgumentTypeError(f"{text!r} is no size in GB: give one above 0, such as 2")
    return size
