"""A content folder of plain boxes: quick to draw, with the obstacles that walking is measured against."""

from pathlib import Path

HALL = """
title = { zh = "素厅", en = "Plain hall" }
subtitle = { zh = "测试用", en = "for tests" }
language = "en"
licence = "CC0-1.0"
questionnaire = "garment"
start = { x = 0.0, z = 4.0, facing = 180.0 }
"""

# A flat wall across z = 0, a corner of a block to the right, a round stand to the left.
PLAN = """
outline = [[-8.0, -6.0], [8.0, -6.0], [8.0, 6.0], [-8.0, 6.0]]
height = 3.0

[[wall]]
from = [-2.0, 0.0]
to = [2.0, 0.0]
thickness = 0.05

[[solid]]
id = "block"
kind = "stand"
height = 1.0
size = [2.0, 2.0]
at = [5.0, 0.0]

[[solid]]
id = "drum"
kind = "stand"
height = 1.0
round = { x = -5.0, z = 0.0, radius = 0.5 }

[[bay]]
id = "all"
name = { zh = "大厅", en = "Hall" }
polygon = [[-8.0, -6.0], [8.0, -6.0], [8.0, 6.0], [-8.0, 6.0]]
"""

EXHIBIT = """
title = { zh = "方匣", en = "Plain box" }
caption = { zh = "一只方匣", en = "a box" }
place = { x = 2.5, z = 3.0, facing = 0.0 }
models = { hall = "box.glb" }
body = { shape = "round", radius = 0.4, height = 1.2 }
behaviours = ["open_on_click", "glow_when_near", "turn_slowly"]
licence = "CC0-1.0"
questionnaire = "garment"
record = { material = { zh = "木", en = "wood" } }

[[media]]
kind = "picture"
file = "box.png"
alt = { zh = "一只方匣", en = "a box" }
"""


def write_plain_hall(folder: Path) -> Path:
    """Write the folder and return it."""
    import trimesh
    from PIL import Image

    home = folder / "exhibits" / "box"
    home.mkdir(parents=True)
    (folder / "hall.toml").write_text(HALL, "utf-8")
    (folder / "plan.toml").write_text(PLAN, "utf-8")
    (home / "exhibit.toml").write_text(EXHIBIT, "utf-8")
    (home / "text.zh.md").write_text("一只方匣，用来测试。", "utf-8")
    (home / "text.en.md").write_text("A box, made for *tests*.", "utf-8")
    box = trimesh.creation.box((0.5, 1.2, 0.5))
    box.apply_translation((0, 0.6, 0))
    box.visual.face_colors = [160, 60, 50, 255]
    (home / "box.glb").write_bytes(box.export(file_type="glb"))
    Image.new("RGB", (64, 64), (160, 60, 50)).save(home / "box.png")
    (folder / "questionnaires").mkdir()
    shipped = Path(__file__).parent.parent / "assets" / "questionnaires" / "garment.toml"
    (folder / "questionnaires" / "garment.toml").write_bytes(shipped.read_bytes())
    return folder
