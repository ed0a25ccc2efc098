"""A hall of plain boxes and one scan: a garment of ours as a scanner leaves it, an OBJ with what lies beside it."""

from pathlib import Path

import pytest
from plain_hall import write_plain_hall
from scan_like import Made, scan_of, with_flakes, with_holes, write_obj

from hall_app.cli import main

PIXELS = {"close": 512, "hall": 256}  # sides of the pictures of a small bake
ROBE = """
title = { zh = "扫描件", en = "Scanned robe" }
scan = "scan/robe.obj"
scanned = { units = "mm", up = "z", keep = "largest" }
place = { x = -2.5, z = 3.0 }
body = { shape = "round", radius = 0.4 }
licence = "CC0-1.0"
record = { material = { zh = "绢", en = "silk" } }
"""


def scanned_coat(triangles: int = 20_000, *, pixels: int = 1024) -> Made:
    """The coat in millimetres, z up, with noise, three holes and five loose flakes around it."""
    return with_flakes(with_holes(scan_of(triangles, pixels=pixels), 3, 0.05), 5, 0.004, 1.0).turned()


def write_scanned_hall(folder: Path) -> Path:
    """Write the folder, whose scan has not been baked, and return it."""
    write_plain_hall(folder)
    home = folder / "exhibits/robe"
    (home / "scan").mkdir(parents=True)
    (home / "exhibit.toml").write_text(ROBE, "utf-8")
    for name in ("text.zh.md", "text.en.md"):
        (home / name).write_text("A robe.", "utf-8")
    write_obj(scanned_coat(), home / "scan/robe.obj")
    return folder


def bake_small(content: Path, data: Path) -> None:
    """Bake its scan, with smaller pictures than a hall's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("hall_app.build.scan.PIXELS", PIXELS)
        assert (
            main(["build", "--content", str(content), "--data", str(data), "--exhibit", "robe", "--json"])
            == 0
        )
