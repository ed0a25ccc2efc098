"""What the files hold: words, media, models and their weight, bakes, mannequins, and what nobody names."""

from hall_app.check.files.media import AUDIO, VIDEO

__all__ = ["AUDIO", "VIDEO"]
