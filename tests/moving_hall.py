"""The hall of plain boxes, whose box moves by a clip, and what might have been tracked of it; one whose box somebody
wears; one whose box is compared with two others."""

from pathlib import Path

import numpy as np
from plain_hall import write_plain_hall

from hall_app.content.models import TrackedMotion
from sim_core.body import Mannequin, Pose
from sim_core.garment.clip import Clip, Drawn, Moved, drawn_in, model_clip
from sim_core.gltf import glb_parts

FRAMES, RATE = 50, 25.0
WOMAN = Path(__file__).parent.parent / "assets" / "mannequins" / "woman.npz"


def box_clip(model: bytes, *, drawn: tuple[Drawn, ...] | None = None) -> Clip:
    """The box, swaying once in two seconds."""
    parts = glb_parts(model)
    primitive = parts.document["meshes"][0]["primitives"][0]
    rest = parts.numbers(primitive["attributes"]["POSITION"])
    faces = parts.numbers(primitive["indices"]).reshape(-1, 3).astype(np.int32)
    found = drawn_in(model, {"box": rest})["box"] if drawn is None else drawn
    positions = np.repeat(rest[None], FRAMES, axis=0)
    positions[:, :, 0] += 0.2 * np.sin(2 * np.pi * np.arange(FRAMES) / FRAMES)[:, None] * rest[:, 1]
    return Clip.of([Moved("box", positions, faces, found)], rate=RATE, loop=True)


def box_points() -> TrackedMotion:
    """Its corners as joints, with points between them, as it stands and then sways; the upper ones are the trunk's, and
    cloth hangs over four."""
    corner = np.array([[x, y, z] for y in (0.0, 1.2) for x in (-0.25, 0.25) for z in (-0.25, 0.25)])
    bones = np.array([(a, b) for a in range(8) for b in range(a) if (corner[a] != corner[b]).sum() == 1])
    rest = np.concatenate([corner, corner[bones].mean(1)])
    frames = np.r_[0, np.arange(FRAMES)]
    points = np.repeat(rest[None], len(frames), axis=0)
    points[:, :, 0] += 0.2 * np.sin(2 * np.pi * frames / FRAMES)[:, None] * rest[:, 1]
    worn = np.arange(4, 8)
    delta = 0.01 + 0.005 * np.sin(2 * np.pi * (frames[:, None] + np.arange(3)) / FRAMES)
    return TrackedMotion(
        points=points,
        torso=rest[:, 1] > 1.0,
        bones=bones,
        worn=worn,
        cloth=points[:, worn] + [0.0, 0.1, 0.0],
        limbs=np.arange(3),
        m=delta / 0.02,
        delta=delta,
        lost=np.zeros(points.shape[:2], bool),
        noise=0.01,
        m0=0.1,
        rounds=5,
        rate=RATE,
        loop=True,
        begin=1,
    )


def write_moving_hall(folder: Path, *, points: bool = False) -> Path:
    """Write the folder and return it; points: with what was tracked."""
    write_plain_hall(folder)
    home = folder / "exhibits" / "box"
    toml = (home / "exhibit.toml").read_text("utf-8")
    toml = toml.replace("models = {", 'motion = "sway.clip"\nmodels = {').replace(', "turn_slowly"', "")
    (home / "exhibit.toml").write_text(toml, "utf-8")
    box_clip((home / "box.glb").read_bytes()).save(home / "sway.clip")
    if points:
        box_points().save(home / "sway.points")
    return folder


def write_worn_hall(folder: Path) -> tuple[Path, Clip]:
    """Write the folder, whose box sways round upon a figure that swings an arm; it, and the clip.

    No two of the clip's frames have a vertex of the box's lid, or of the arm, in one place.
    """
    import trimesh

    write_moving_hall(folder)
    home, woman = folder / "exhibits" / "box", Mannequin.load(WOMAN)
    angle = 2 * np.pi * np.arange(FRAMES) / FRAMES
    round_ = np.stack([np.sin(angle), 0 * angle, 1 - np.cos(angle)], axis=1)
    poses = [Pose.from_rotvecs({"shoulder_l": (0.0, 25.0 * x, -60.0 + 25.0 * z)}) for x, _, z in round_]
    box = trimesh.creation.box((0.5, 1.0, 0.5))
    box.apply_translation((0, 0.5, 0))
    upper = woman.faces[(woman.vertices[woman.faces, 1] > 1.1).all(1)]
    worn = trimesh.Trimesh(woman.posed(poses[0]), upper, process=False)
    worn.remove_unreferenced_vertices()
    scene = trimesh.Scene()
    for name, mesh, colour in (("garment", box, [160, 60, 50, 255]), ("figure", worn, [200, 190, 180, 255])):
        mesh.visual.vertex_colors = colour
        scene.add_geometry(mesh, node_name=name, geom_name=name)
    model = scene.export(file_type="glb")
    (home / "box.glb").write_bytes(model)
    moved = box.vertices + 0.2 * round_[:, None] * box.vertices[:, 1, None]
    clip = model_clip(model, {"box": moved}, figure=(woman, poses), rate=RATE, loop=True)
    assert clip.figure is not None
    clip.save(home / "sway.clip")
    return folder, clip


COMPARISON = """
[comparison]
model = "three.glb"
clip = "three.clip"
text = { zh = "三个网格", en = "Three <b>boxes</b>" }

[[comparison.side]]
name = { zh = "粗", en = "Coarse" }
colour = "#b07030"
vertices = 8
hausdorff_mm = 12.345
milliseconds = 3

[[comparison.side]]
name = { zh = "学", en = "Learned" }
colour = "#30a060"
vertices = 16
hausdorff_mm = 4
milliseconds = 8.5

[[comparison.side]]
name = { zh = "细", en = "Fine" }
colour = "#3060b0"
vertices = 16
milliseconds = 1104.6
"""


def write_comparing_hall(folder: Path) -> Path:
    """Write the folder, whose still box compares three others beside each other, which sway; return it."""
    import trimesh

    write_moving_hall(folder)
    home = folder / "exhibits" / "box"
    scene, moved = trimesh.Scene(), {}
    angle = 2 * np.pi * np.arange(FRAMES) / FRAMES
    for number, colour in enumerate(([176, 112, 48, 255], [48, 160, 96, 255], [48, 96, 176, 255])):
        box = trimesh.creation.box((0.5, 1.0, 0.5))
        box.apply_translation((0.7 * (number - 1), 0.5, 0))
        box.visual.vertex_colors = colour
        scene.add_geometry(box, node_name=f"side {number}", geom_name=f"side {number}")
        sway = np.zeros((FRAMES, len(box.vertices), 3))
        sway[:, :, 0] = 0.2 * np.sin(angle)[:, None] * box.vertices[:, 1]
        moved[f"side {number}"] = box.vertices + sway
    model = scene.export(file_type="glb")
    (home / "three.glb").write_bytes(model)
    model_clip(model, moved, rate=RATE, loop=True).save(home / "three.clip")
    toml = (home / "exhibit.toml").read_text("utf-8").replace('motion = "sway.clip"\n', "")
    (home / "exhibit.toml").write_text(toml + COMPARISON, "utf-8")
    (home / "sway.clip").unlink()
    return folder
