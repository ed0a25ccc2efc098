"""The hall's own music, drawings and the ready-made mirror: made by programs, so that nobody's rights are touched."""

from hall_app.media.make import make_media

__all__ = ["make_media"]
