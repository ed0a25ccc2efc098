"""Clips: what comes back is what was given within the error told, each frame by itself; damage is refused."""

import json
import resource
import struct
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
from bench.clip_cases import striding, waving
from plain_garments import plain_maps

from sim_core.body import Mannequin
from sim_core.cloth import Capsule, Contact
from sim_core.cloth.contact import solid_mesh
from sim_core.cloth.scenes import equilateral_sheet
from sim_core.errors import FileProblem, SimCoreError
from sim_core.garment import Clothed, Garment, follow, load_outfit, write_glb
from sim_core.garment.clip import STEP, Clip, Drawn, Moved, Skinned, drawn_in, model_clip
from sim_core.gltf import glb_parts

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def woman() -> Mannequin:
    return Mannequin.load(ROOT / "assets" / "mannequins" / "woman.npz")


def apart(clip: Clip, name: str, positions: np.ndarray) -> float:
    """The farthest that a vertex lies from where it was [m]."""
    return max(
        float(np.linalg.norm(clip.positions(k, name) - x, axis=1).max()) for k, x in enumerate(positions)
    )


@pytest.mark.parametrize("size", [1e-4, 0.01, 1.0, 15.0])
def test_comes_back_within_the_error_that_is_told(tmp_path: Path, size: float):
    sheet = waving(size)
    clip = Clip.of([sheet], rate=12.5, loop=True)
    clip.save(tmp_path / "a.clip")
    back = Clip.load(tmp_path / "a.clip")
    assert (back.rate, back.loop, back.frames, back.seconds) == (12.5, True, 12, pytest.approx(0.96))
    assert np.array_equal(back.steps, clip.steps)
    assert np.array_equal(back.faces("sheet"), sheet.faces)
    found = apart(back, "sheet", sheet.positions)
    assert found == pytest.approx(clip.error, abs=1e-12)
    assert back.error == clip.error
    assert clip.error <= np.sqrt(3) / 2 * min(STEP, 1.001 * size / 4096)
    assert back.to_bytes() == clip.to_bytes()


def test_far_from_the_origin_and_finer_when_asked():
    sheet = waving()
    far = Moved("sheet", sheet.positions + [4e4, -3.0, 1e4], sheet.faces)
    assert Clip.of([far]).error <= STEP
    assert Clip.of([sheet], step=5e-5).error <= np.sqrt(3) / 2 * 5e-5 * 1.001


def test_too_large_a_box_is_refused():
    with pytest.raises(SimCoreError, match=r"span 17 m.*hold the wearer's root"):
        Clip.of([waving(17.0)])


def test_each_frame_is_read_by_itself():
    clip = Clip.of([waving()])
    for frame in (7, 0, 11):
        steps, beside = clip.code.unpacked([clip.frame_bytes(frame)])
        assert np.array_equal(steps[0], clip.steps[frame])
        assert beside == [b""]


def test_one_frame_and_many_meshes():
    one = waving(frames=1)
    assert Clip.of([one]).seconds == 0.0
    meshes = [
        Moved(f"part {k}", waving(edge=0.1 + 0.02 * k).positions + 0.3 * k, waving(edge=0.1 + 0.02 * k).faces)
        for k in range(5)
    ]
    clip = Clip.from_bytes(Clip.of(meshes).to_bytes())
    assert clip.names == tuple(mesh.name for mesh in meshes)
    for mesh in meshes:
        assert apart(clip, mesh.name, mesh.positions) <= clip.error + 1e-12
        assert np.array_equal(clip.faces(mesh.name), mesh.faces)


def test_vertices_in_any_order_and_without_faces_come_back():
    rng, sheet = np.random.default_rng(2), waving()
    count = sheet.positions.shape[1]
    order = rng.permutation(count + 3)
    loose = np.concatenate([sheet.positions, rng.uniform(0, 1, (12, 3, 3))], axis=1)
    shuffled = Moved("sheet", loose[:, np.argsort(order)], order[sheet.faces])
    clip = Clip.from_bytes(Clip.of([shuffled]).to_bytes())
    assert apart(clip, "sheet", shuffled.positions) <= clip.error + 1e-12
    grown = len(clip.frame_bytes(5)) / len(Clip.of([sheet]).frame_bytes(5))
    assert grown < 1.25  # what follows what is the mesh's order, not the file's


def test_a_hundred_frames_of_five_thousand_vertices_and_a_figure_stay_under_two_megabytes(woman):
    """Noise of 0.2 mm, as nothing in a real cloth is: a real one packs smaller."""
    sheet = waving(edge=0.0152, frames=100, noise=2e-4)
    assert sheet.positions.shape[1] >= 5000
    clip = Clip.of([sheet], figure=Skinned.of(woman, striding(100)), loop=True)
    assert clip.figure is not None
    assert clip.seconds == 4.0
    assert len(clip.to_bytes()) <= 2_000_000


def test_the_figure_goes_by_its_bones_as_it_was_posed(woman):
    poses = striding(30)
    clip = Clip.from_bytes(Clip.of([waving(frames=30)], figure=Skinned.of(woman, poses)).to_bytes())
    away = apart(clip, "figure", np.stack([woman.posed(pose) for pose in poses]))
    assert 0.0 < away <= 5e-5
    assert np.array_equal(clip.faces("figure"), woman.faces)


def test_a_figure_of_few_frames_goes_by_its_vertices(woman):
    poses = striding(2)
    few = Clip.of([waving(frames=2)], figure=Skinned.of(woman, poses))
    assert few.figure is None
    assert few.names == ("sheet", "figure")
    assert apart(few, "figure", np.stack([woman.posed(pose) for pose in poses])) <= few.error + 2e-5
    many = Clip.of([waving(frames=60)], figure=Skinned.of(woman, striding(60)))
    assert many.figure is not None


def test_part_of_a_figure(woman):
    kept = np.flatnonzero(woman.vertices[:, 1] > 1.2)
    number = np.full(len(woman.vertices), -1)
    number[kept] = np.arange(len(kept))
    faces = number[woman.faces]
    part = Skinned.of(woman, striding(3), part=(kept, faces[(faces >= 0).all(1)]))
    assert np.abs(part.posed(1) - woman.posed(striding(3)[1])[kept]).max() < 5e-5


@pytest.mark.parametrize(
    ("meshes", "figure", "words"),
    [
        ([], None, "give one or more"),
        ([waving(), waving()], None, "one name"),
        ([waving(), Moved("other", waving(frames=3).positions, waving().faces)], None, "sheet 12, other 3"),
        ([Moved("a", waving().positions[0], waving().faces)], None, "shape"),
        ([Moved("a", waving().positions * np.nan, waving().faces)], None, "frame 0 holds"),
        ([Moved("a", waving().positions[:, :9], waving().faces)], None, "index"),
        ([Moved("a", waving().positions, waving().faces, (Drawn("n", np.array([99999])),))], None, "beyond"),
        ([waving()], 3, "sheet 12, figure 3"),
    ],
)
def test_what_does_not_agree_is_refused(meshes, figure, words, woman):
    with pytest.raises(SimCoreError, match=words):
        Clip.of(meshes, figure=figure and Skinned.of(woman, striding(figure)))


@pytest.mark.parametrize("rate", [0.0, -5.0, np.nan, 1e9, "25"])
def test_odd_rates_are_refused(rate):
    with pytest.raises(SimCoreError, match="rate"):
        Clip.of([waving(frames=2)], rate=rate)


def test_damaged_files_are_refused_with_one_line(tmp_path: Path, woman):
    data = Clip.of([waving(edge=0.1)], figure=Skinned.of(woman, striding(12))).to_bytes()
    rng, path = np.random.default_rng(3), tmp_path / "bad.clip"
    broken = [b"", b"HALLCLIP", data[:5], data[:40], data[:-1], data + b"x", b"PK" + data[2:]]
    broken.append(data[:8] + struct.pack("<I", 2**31) + data[12:])
    head = 16 + struct.unpack_from("<I", data, 8)[0]
    for at in [*rng.integers(head, len(data), 60), *rng.integers(8, head, 120)]:
        changed = bytearray(data)
        changed[at] ^= int(rng.integers(1, 256))
        broken.append(bytes(changed))
    for bad in broken:
        path.write_bytes(bad)
        with pytest.raises(FileProblem) as caught:
            Clip.load(path)
        assert str(caught.value).startswith(f"{path}: ")
        assert "\n" not in str(caught.value)
    with pytest.raises(FileProblem, match="No such file"):
        Clip.load(tmp_path / "none.clip")


def told_otherwise(data: bytes, change: Callable[[dict], None]) -> bytes:
    """A clip's bytes with another header, whose checksum is right."""
    length = struct.unpack_from("<I", data, 8)[0]
    header = json.loads(data[16 : 16 + length])
    change(header)
    text = json.dumps(header).encode()
    return data[:8] + struct.pack("<II", len(text), zlib.crc32(text)) + text + data[16 + length :]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            lambda told: told["meshes"][0].update(vertices=1_000_000),
            "1000000 vertices in 60 frames, 360 MB – at most",
        ),
        (lambda told: told["meshes"][0].update(faces=4_000_000, drawn=[]), "cut off or of another length"),
        (
            lambda told: told["meshes"][0].update(drawn=[{"node": "a", "vertices": 4_000_000}] * 50),
            "claims 80. MB beside its frames, at most 64",
        ),
        (lambda told: told["figure"].update(vertices=4_000_000), "claims 216 MB beside its frames"),
        (lambda told: told["figure"].update(name="sheet"), "its header is damaged .meshes."),
        (lambda told: told["figure"].update(linear=[1]), "in a way that is not known"),
        (lambda told: told.update(meshes=[]), "its header is damaged .meshes."),
        (lambda told: told.update(origin=[1e300, 0, 0]), "its header is damaged .origin, step."),
        (lambda told: told.update(sizes=[told["sizes"][0], *[10**12] * 60]), "its header is damaged .sizes."),
    ],
)
def test_headers_that_claim_too_much_are_refused_before_it_is_made(woman, change, words: str):
    data = Clip.of([waving(edge=0.2, frames=60)], figure=Skinned.of(woman, striding(60))).to_bytes()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(SimCoreError, match=words):
        Clip.from_bytes(told_otherwise(data, change))
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000  # [kB]


def test_what_could_not_be_read_again_is_not_written():
    with pytest.raises(SimCoreError, match=r"3 vertices in 100001 frames.*make several clips"):
        Clip.of([Moved("dot", np.zeros((100_001, 3, 3)), np.array([[0, 1, 2]]))])


def test_no_changed_byte_of_a_frame_changes_a_vertex():
    clip = Clip.of([waving(edge=0.1)])
    frame = clip.frame_bytes(3)
    for at in range(len(frame)):
        changed = bytearray(frame)
        changed[at] ^= 0x10
        try:
            steps, _ = clip.code.unpacked([bytes(changed)])
        except SimCoreError:
            continue
        assert np.array_equal(steps[0], clip.steps[3])  # bits that fill up the last byte mean nothing


def test_a_models_vertices_find_theirs(tmp_path: Path):
    """Split along a seam in the GLB: each twin finds the vertex it was welded from."""
    garment = Garment.load(ROOT / "assets" / "exhibits" / "beizi" / "baked" / "garment.npz")
    write_glb(tmp_path / "a.glb", [Clothed(garment, plain_maps())], precision="hall")
    model = (tmp_path / "a.glb").read_bytes()
    drawn = drawn_in(model, {"beizi": garment.positions})["beizi"]
    assert sum(len(one.index) for one in drawn) > len(garment.positions)
    parts = glb_parts(model)
    nodes = {node["name"]: node["mesh"] for node in parts.document["nodes"]}
    for one in drawn:
        mesh = parts.document["meshes"][nodes[one.node]]["primitives"][0]
        points = parts.numbers(mesh["attributes"]["POSITION"])
        assert np.abs(garment.positions[one.index] - points).max() < 1e-6
    moved = np.stack([garment.positions, garment.positions + 0.01])
    back = Clip.from_bytes(Clip.of([Moved("beizi", moved, garment.faces, drawn)]).to_bytes())
    for one, told in zip(back.meshes[0].drawn, drawn, strict=True):
        assert one.node == told.node
        assert np.array_equal(one.index, told.index)
    with pytest.raises(SimCoreError, match="no node of the model lies on mesh 'beizi'"):
        drawn_in(model, {"beizi": garment.positions + 0.01})
    with pytest.raises(SimCoreError, match="not a GLB"):
        drawn_in(b"no", {"beizi": garment.positions})


def test_glb_with_morph_targets_for_others(tmp_path: Path):
    sheet = waving(edge=0.2, frames=4)
    clip = Clip.of([sheet], loop=True)
    size = clip.write_glb(tmp_path / "a.glb")
    data = (tmp_path / "a.glb").read_bytes()
    assert size == len(data)
    parts = glb_parts(data)
    primitive = parts.document["meshes"][0]["primitives"][0]
    first = parts.numbers(primitive["attributes"]["POSITION"])
    for k, target in enumerate(primitive["targets"], 1):
        placed = first + parts.numbers(target["POSITION"])
        assert np.abs(placed - clip.positions(k, "sheet")).max() < 1e-6
    sampler = parts.document["animations"][0]["samplers"][0]
    times = parts.numbers(sampler["input"]).ravel()
    weights = parts.numbers(sampler["output"]).reshape(len(times), -1)
    assert times.tolist() == pytest.approx([0.0, 0.04, 0.08, 0.12, 0.16])
    assert weights.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]]
    assert trimesh.load(tmp_path / "a.glb").geometry["sheet"].faces.shape == sheet.faces.shape


def test_a_garment_that_followed_its_wearer():
    """A veil on a ball that rises and turns: within the error told, and as small as a page needs."""
    ball, faces = solid_mesh(Capsule((0.0, 0.0, 0.0), (0.0, 0.02, 0.0), 0.1), 24)
    rest, own = equilateral_sheet(0.3, 0.3, 0.02)
    start = np.column_stack([rest[:, 0] - 0.15, np.full(len(rest), 0.13), rest[:, 1] - 0.15])
    material = {"density": 0.05, "stretch": 50.0, "bend": 2e-5, "friction": 0.5, "choices": {}}
    veil = Garment(
        name="veil",
        pattern=rest,
        pattern_faces=own.astype(np.int32),
        weld=np.arange(len(rest), dtype=np.int32),
        panel=np.zeros(len(own), np.int32),
        positions=start,
        cut={"panels": [{"name": "cloth"}]},
        material={"kinds": {"thin": material}, "panels": {"cloth": "thin"}},
    )
    body = ball[None] + np.linspace(0, 0.06, 11)[:, None, None] * np.array([0.0, 1.0, 0.0])
    frames = [veil.positions]
    contact = Contact(0.004, 0.001, speed_limit=4.0)
    follow(veil, body, faces, contact=contact, on_frame=lambda _, x: frames.append(x.astype(float)))
    clip = Clip.of([Moved("veil", np.stack(frames), veil.faces)])
    back = Clip.from_bytes(clip.to_bytes())
    assert back.frames == 11
    assert apart(back, "veil", np.stack(frames)) == pytest.approx(clip.error, abs=1e-12)
    assert clip.error <= np.sqrt(3) / 2 * STEP
    a_vertex = len(clip.frame_bytes(10)) / len(veil.positions)
    assert a_vertex * 5000 * 100 <= 1_900_000


@pytest.mark.parametrize(
    ("exhibit", "worn", "precision"),
    [("gown", "han-gown", "close"), ("walking", "walking", "hall"), ("walking", "walking", "close")],
)
def test_the_clip_of_a_baked_model(exhibit: str, worn: str, precision: str):
    """Of the fine garments and the whole figure only what the model shows, and it begins as the model stands."""
    baked = ROOT / "assets" / "exhibits" / exhibit / "baked"
    garments = [Garment.load(path) for path in (*sorted(baked.glob("beneath-*.npz")), baked / "garment.npz")]
    model = (baked / f"{precision}.glb").read_bytes()
    outfit = load_outfit(ROOT / "assets" / "outfits" / f"{worn}.toml")
    moved = {}
    for garment in garments:
        moved[garment.name] = np.repeat(garment.positions[None], 60, axis=0)
        moved[garment.name][:, :, 0] += np.linspace(0, 0.1, 60)[:, None] * (1.5 - garment.positions[:, 1])
    poses = [outfit.pose.facing(k) for k in range(60)]
    clip = model_clip(model, moved, figure=(outfit.wearer, poses), lift=0.025, loop=True)
    assert clip.figure is not None
    parts = glb_parts(model)
    nodes = {node["name"]: node["mesh"] for node in parts.document["nodes"]}
    drawn = {d.node: (mesh.name, d.index) for mesh in clip.meshes for d in mesh.drawn} | {
        d.node: ("figure", d.index) for d in clip.figure.drawn
    }
    assert set(nodes) - set(drawn) <= {"base"}
    for node, (mesh, index) in drawn.items():
        primitive = parts.document["meshes"][nodes[node]]["primitives"][0]
        points = parts.numbers(primitive["attributes"]["POSITION"])
        assert np.abs(clip.positions(0, mesh)[index] - points).max() < 3e-4
    triangles = sum(len(mesh.faces) for mesh in (*clip.meshes, clip.figure))
    assert triangles == sum(
        parts.document["accessors"][mesh["primitives"][0]["indices"]]["count"] // 3
        for mesh in (parts.document["meshes"][number] for node, number in nodes.items() if node in drawn)
    )
    if precision == "hall":
        assert len(clip.to_bytes()) / 60 * 100 <= 2_000_000
    with pytest.raises(SimCoreError, match="no node of the model lies on mesh"):
        model_clip(model, moved, lift=0.05)
