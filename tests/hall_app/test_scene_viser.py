"""What the scene uses of viser beyond its public API: an update that changes it fails here."""

import socket
from dataclasses import fields

from lit_room import environment

from hall_app.show import HallScene


def test_environment_message_is_as_pinned():
    from viser import _messages

    assert [field.name for field in fields(_messages.EnvironmentMapMessage)] == [
        "hdri_data",
        "background",
        "background_blurriness",
        "background_intensity",
        "background_wxyz",
        "environment_intensity",
        "environment_wxyz",
    ]


def test_environment_is_queued_for_every_visitor():
    from viser import _messages

    scene = HallScene()
    try:
        queued = []
        wire = scene.server.scene._websock_interface
        send = wire.queue_message
        wire.queue_message = lambda message: (queued.append(message), send(message))  # pyright: ignore
        scene.show_environment(environment())
        scene.show_environment(None)
    finally:
        scene.stop()
    first, second = queued
    assert isinstance(first, _messages.EnvironmentMapMessage)
    assert first.hdri_data == environment()
    assert not first.background
    assert second.hdri_data is None


def test_who_leaves_while_he_is_let_in_is_no_traceback(caplog):
    """The relay hangs up in the midst of viser's handshake where its visitor has gone."""
    scene = HallScene()
    try:
        for said in (b"", b"GET / HTTP/1.1\r\nHost: hall\r\n"):
            with socket.create_connection(("127.0.0.1", scene.port), timeout=10) as line:
                line.sendall(said)
                line.shutdown(socket.SHUT_WR)
                while line.recv(4096):  # until viser has dealt with it
                    pass
    finally:
        scene.stop()
    assert not [record for record in caplog.records if record.exc_info]
