"""Whether this machine has the font the hall's boards are set in; without it rooms are raised with blank boards."""

import pytest

from hall_app.room.surface import MissingFontError, font_file


def _found() -> bool:
    try:
        return all(font_file(bold) for bold in (True, False))
    except MissingFontError:
        return False


BLANK = not _found()
needs_font = pytest.mark.skipif(BLANK, reason="Noto Serif CJK is missing – apt-get install fonts-noto-cjk")
