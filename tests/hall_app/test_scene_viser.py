"""What the scene uses of viser beyond its public API: an update that changes it fails here."""

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
