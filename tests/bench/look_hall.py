"""`hall` whose room is lit another way: the same content, for comparison by bench_look.py.

HALL_LOOK says how: "shipped" (unlit, baked light), "ambient" (lit materials, one ambient light), "default" (lit
materials, viser's default environment map; its default lamps, which cost more still, are left out), "beside" (both).
"""

import json
import os
import struct
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

from hall_app.show import HallScene  # noqa: E402


def for_lights(glb: bytes) -> bytes:
    """The same GLB with materials that real lights shine on."""
    length = struct.unpack_from("<I", glb, 12)[0]
    document = json.loads(glb[20 : 20 + length])
    for material in document.get("materials", ()):
        material.get("extensions", {}).pop("KHR_materials_unlit", None)
        material.setdefault("pbrMetallicRoughness", {}).update(metallicFactor=0.0, roughnessFactor=0.9)
    used = set(document.get("extensionsUsed", ())) - {"KHR_materials_unlit"}
    document["extensionsUsed"] = sorted(used)
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    rest = glb[20 + length :]
    head = struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest))
    return head + struct.pack("<I4s", len(text), b"JSON") + text + rest


def look_otherwise(how: str) -> None:
    """Make every HallScene of this process light its room in the given way."""
    configure, show_environment = HallScene._configure, HallScene.show_environment

    def configured(self) -> None:
        configure(self)
        scene = self.server.scene
        show = self.pieces.show

        def lit(node: str, model: bytes, **kwargs):
            return show(node, for_lights(model) if node in ("/room", "/studio") else model, **kwargs)

        self.pieces.show = lit  # pyright: ignore[reportAttributeAccessIssue]
        for light in ("/light/sky", "/light/key"):
            scene.remove_by_name(light)
        if how in ("ambient", "beside"):
            scene.add_light_ambient("/light/all", intensity=3.0)
        if how in ("beside", "default"):
            scene.configure_environment_map()

    def another_environment(self, jpeg: bytes | None) -> None:
        # viser's client begins with an environment of its own: "ambient" takes it off as the hall does.
        if how == "ambient":
            show_environment(self, None)

    HallScene._configure = configured
    HallScene.show_environment = another_environment


if __name__ == "__main__":
    from hall_app.cli import main

    if os.environ["HALL_LOOK"] != "shipped":
        look_otherwise(os.environ["HALL_LOOK"])
    sys.exit(main())
