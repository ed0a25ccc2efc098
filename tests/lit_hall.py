"""`hall` with the room of lit_room.py in place of the plan's: for tests of the page alone.

The file named by HALL_TEST_ROOM says what is shown, and is followed while the hall runs: "light", "flat".
"""

import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parent.parent))

from lit_room import environment, lit_room  # noqa: E402

from hall_app.show import HallScene  # noqa: E402


def _show_room(self, *args, **kwargs) -> None:
    light = Path(os.environ["HALL_TEST_ROOM"]).read_text("utf-8").strip() == "light"
    self.server.scene.add_glb("/room", lit_room(light=light), cast_shadow=False, receive_shadow=False)


def _show_environment(self, jpeg: bytes | None, *, show=HallScene.show_environment) -> None:
    show(self, environment())


if __name__ == "__main__":
    from hall_app.cli import main

    HallScene.show_room = _show_room
    HallScene.show_environment = _show_environment
    sys.exit(main())
