"""A content folder with room to walk straight on for many seconds."""

from pathlib import Path

from plain_hall import write_plain_hall

PLAN = """
outline = [[-4.0, -24.0], [4.0, -24.0], [4.0, 24.0], [-4.0, 24.0]]
height = 3.0

[[bay]]
id = "all"
name = { zh = "长廊", en = "Corridor" }
polygon = [[-4.0, -24.0], [4.0, -24.0], [4.0, 24.0], [-4.0, 24.0]]
"""


def write_corridor_hall(folder: Path) -> Path:
    """The plain hall without its obstacles, 48 m long; visitors start at its end and look along it."""
    write_plain_hall(folder)
    (folder / "plan.toml").write_text(PLAN, "utf-8")
    hall = folder / "hall.toml"
    hall.write_text(hall.read_text("utf-8").replace("z = 4.0", "z = 22.0"), "utf-8")
    return folder
