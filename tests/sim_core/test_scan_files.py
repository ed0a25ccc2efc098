"""Scans as files: what each form holds comes back, and what is wrong with one is one sentence with its remedy."""

from __future__ import annotations

import json
import struct
import zlib
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
import scan_like

from sim_core.mesh.scan import Scan, ScanError, read_scan, scan_companions

PACKED = Path(__file__).parent / "scans"


@pytest.fixture(scope="module")
def made() -> scan_like.Made:
    """Two walls of a few hundred triangles, painted."""
    u, v = np.meshgrid(np.linspace(0, 1, 12), np.linspace(0, 1, 12), indexing="ij")
    i = np.arange(144).reshape(12, 12)
    a, b, c, d = (x.ravel() for x in (i[:-1, :-1], i[1:, :-1], i[1:, 1:], i[:-1, 1:]))
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32)
    vertices = np.stack([u.ravel(), v.ravel(), 0.1 * np.sin(6 * u.ravel())], axis=1)
    picture = np.zeros((64, 64, 3), np.uint8)
    picture[:, :32], picture[:, 32:] = (200, 40, 30), (30, 60, 200)
    picture[:8] = (20, 220, 40)
    return scan_like.Made(vertices, faces, np.stack([u.ravel(), v.ravel()], axis=1), picture)


def mean_colours(scan: Scan) -> np.ndarray:
    """(F, 3) sRGB at the middle of each face."""
    from sim_core.mesh.scan import Colours
    from sim_core.metrics import Surface

    thirds = np.full((len(scan.faces), 3), 1 / 3)
    return Colours(scan, Surface(scan.vertices, scan.faces)).at(np.arange(len(scan.faces)), thirds)


def write(made: scan_like.Made, form: str, folder: Path) -> Path:
    if form == "glb":
        return scan_like.write_glb(made, folder / "s.glb")
    if form == "obj":
        return scan_like.write_obj(made, folder / "s.obj")
    return scan_like.write_ply(made, folder / "s.ply", text="text" in form, painted="painted" in form)


@pytest.mark.parametrize("form", ["glb", "obj", "ply", "ply painted", "ply text", "ply text painted"])
def test_every_form_gives_back_shape_and_colours(made, tmp_path, form):
    path = write(made, form, tmp_path)
    scan = read_scan(path, tmp_path)
    corners = scan.vertices[scan.faces]
    assert np.abs(corners - made.vertices[made.faces]).max() < 1e-6
    middle = made.uv[made.faces].mean(1)
    away = (np.abs(middle[:, 0] - 0.5) > 0.1) & (middle[:, 1] > 0.25)
    wanted = np.where(middle[:, [0]] < 0.5, [[200, 40, 30]], [[30, 60, 200]])
    assert np.abs(mean_colours(scan) - wanted)[away].max() < 12  # JPEG's
    top = middle[:, 1] < 0.08  # v is downwards: the picture's first rows
    assert np.abs(mean_colours(scan)[top] - [20, 220, 40]).max() < 90
    assert (mean_colours(scan)[top][:, 1] > 120).all()


def test_what_lies_beside_is_found(made, tmp_path):
    obj, ply = (
        scan_like.write_obj(made, tmp_path / "a.obj"),
        scan_like.write_ply(made, tmp_path / "b.ply", painted=False),
    )
    assert [path.name for path in scan_companions(obj, tmp_path)] == ["a.mtl", "a.jpg"]
    assert [path.name for path in scan_companions(ply, tmp_path)] == ["b.jpg"]
    assert scan_companions(scan_like.write_glb(made, tmp_path / "c.glb"), tmp_path) == ()
    (tmp_path / "a.jpg").unlink()
    assert [path.name for path in scan_companions(obj, tmp_path)] == ["a.mtl"]
    (tmp_path / "a.jpg").write_bytes(b"there again")
    assert [path.name for path in scan_companions(obj, tmp_path)] == ["a.mtl", "a.jpg"]


def refused(path: Path, root: Path) -> ScanError:
    with pytest.raises(ScanError) as caught:
        read_scan(path, root)
    assert caught.value.what
    assert caught.value.fix
    assert "\n" not in str(caught.value)
    return caught.value


@pytest.mark.parametrize("form", ["glb", "obj", "ply", "ply painted", "ply text"])
@pytest.mark.parametrize("share", [0.0, 0.02, 0.4, 0.97])
def test_a_file_that_is_cut_off_is_refused(made, tmp_path, form, share):
    path = write(made, form, tmp_path)
    data = path.read_bytes()
    path.write_bytes(data[: int(share * len(data))])
    refused(path, tmp_path)


@pytest.mark.parametrize("form", ["obj", "ply"])
def test_a_missing_picture_is_named(made, tmp_path, form):
    path = write(made, form, tmp_path)
    (tmp_path / "s.jpg").unlink()
    error = refused(path, tmp_path)
    assert "'s.jpg'" in error.what
    assert path.name in error.fix


def test_a_missing_material_file_is_named(made, tmp_path):
    path = write(made, "obj", tmp_path)
    (tmp_path / "s.mtl").unlink()
    assert "'s.mtl'" in refused(path, tmp_path).what


def test_a_name_in_other_capitals_is_told(made, tmp_path):
    """On a curator's own system both names are one file."""
    path = write(made, "obj", tmp_path)
    (tmp_path / "s.jpg").rename(tmp_path / "S.JPG")
    assert refused(path, tmp_path).fix == "rename S.JPG to s.jpg"


@pytest.mark.parametrize(
    "look", ["newmtl cloth\n\tmap_Kd\ts.jpg\n", "newmtl\tcloth\r\nmap_Kd -s 1 1 1 s.jpg\r\n"]
)
def test_a_material_file_may_be_written_with_tabs_and_options(made, tmp_path, look):
    path = write(made, "obj", tmp_path)
    (tmp_path / "s.mtl").write_text(look, "utf-8")
    assert [picture.shape for picture in read_scan(path, tmp_path).pictures] == [(64, 64, 3)]


def test_a_picture_beyond_the_limit_is_told_by_its_size(made, tmp_path):
    """Also where Pillow would have refused it unsaid."""
    path = write(made, "obj", tmp_path)
    (tmp_path / "s.jpg").write_bytes(png_head(20_000, 20_000))
    assert "20000 x 20000 pixels, at most 16384" in refused(path, tmp_path).what


def test_a_picture_of_more_pixels_than_can_be_used_is_scaled_down(made, tmp_path, monkeypatch):
    path = write(made, "obj", tmp_path)
    whole = mean_colours(read_scan(path, tmp_path))
    monkeypatch.setattr("sim_core.mesh.scan.files.pictures.ALL", 1024)
    scan = read_scan(path, tmp_path)
    assert [picture.shape for picture in scan.pictures] == [(32, 32, 3)]
    middle = made.uv[made.faces].mean(1)
    away = (np.abs(middle[:, 0] - 0.5) > 0.1) & (middle[:, 1] > 0.25)
    assert np.abs(mean_colours(scan) - whole)[away].max() < 12


def png_head(wide: int, high: int) -> bytes:
    """A PNG of that size whose pixels are not there."""

    def chunk(name: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))

    head = struct.pack(">IIBBBBB", wide, high, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", b"") + chunk(b"IEND", b"")


@pytest.mark.parametrize(
    "name", ["../../secret.jpg", "/etc/hostname", "C:\\secret.jpg", "https://example.org/a.jpg"]
)
@pytest.mark.parametrize("form", ["obj", "ply"])
def test_nothing_outside_the_content_folder_is_opened(made, tmp_path, form, name):
    home = tmp_path / "content" / "scan"
    home.mkdir(parents=True)
    (tmp_path / "secret.jpg").write_bytes(scan_like.jpeg(made.picture))
    path = write(made, form, home)
    named = home / "s.mtl" if form == "obj" else path
    named.write_bytes(named.read_bytes().replace(b"s.jpg", name.encode(), 1))
    assert "outside the content folder" in refused(path, home.parent).what


def test_a_link_out_of_the_folder_is_not_followed(made, tmp_path):
    home = tmp_path / "content"
    home.mkdir()
    path = write(made, "obj", home)
    (home / "s.jpg").rename(tmp_path / "away.jpg")
    (home / "s.jpg").symlink_to(tmp_path / "away.jpg")
    assert "outside the content folder" in refused(path, home).what


def rewritten(path: Path, change) -> Path:
    data = path.read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + size])
    change(document)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(data) - 20 - size, len(text), 0x4E4F534A)
    path.write_bytes(head + text + data[20 + size :])
    return path


@pytest.mark.parametrize(
    ("extension", "remedy"),
    [
        ("KHR_draco_mesh_compression", "Compression off"),
        ("EXT_meshopt_compression", "gltfpack"),
        ("KHR_meshopt_compression", "gltfpack"),
        ("KHR_texture_basisu", "PNG or JPEG"),
    ],
)
def test_compressed_glb_says_how_to_unpack(made, tmp_path, extension, remedy):
    path = rewritten(write(made, "glb", tmp_path), lambda d: d.update(extensionsUsed=[extension]))
    error = refused(path, tmp_path)
    assert extension in error.what
    assert remedy in error.fix


@pytest.mark.parametrize(
    ("name", "remedy"), [("draco", "Compression off"), ("meshopt", "gltfpack -noq -i scan.glb -o plain.glb")]
)
def test_what_other_programs_packed_is_refused_with_the_remedy(name, remedy):
    assert remedy in refused(PACKED / f"{name}.glb", PACKED).fix


@pytest.mark.parametrize("name", ["quantised", "unpacked"])
def test_what_is_quantised_or_was_unpacked_by_the_remedy_is_read(made, name):
    scan = read_scan(PACKED / f"{name}.glb", PACKED)
    middle = np.sort(scan.vertices[scan.faces].mean(1), axis=0)
    assert np.abs(middle - np.sort(made.vertices[made.faces].mean(1), axis=0)).max() < 1e-3
    mean, left = mean_colours(scan), scan.vertices[scan.faces].mean(1)[:, 0] < 0.45
    assert (mean[left][:, 0] > 150).all()
    assert (mean[left][:, 2] < 90).all()


def test_a_glb_that_asks_for_another_file_is_refused(made, tmp_path):
    path = rewritten(write(made, "glb", tmp_path), lambda d: d["images"][0].update(uri="cloth.jpg"))
    assert "'cloth.jpg'" in refused(path, tmp_path).what


@pytest.mark.parametrize("stride", [0, 2, -12])
def test_rows_that_overlap_are_refused(made, tmp_path, stride):
    """A few bytes would be as many corners as a number can say."""

    def crowd(document: dict) -> None:
        corners = document["accessors"][document["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
        document["bufferViews"][corners["bufferView"]]["byteStride"] = stride

    assert "overlap" in refused(rewritten(write(made, "glb", tmp_path), crowd), tmp_path).what


def test_nodes_turn_and_mirror(made, tmp_path):
    path = rewritten(
        write(made, "glb", tmp_path), lambda d: d["nodes"][0].update(scale=[-2, 2, 2], translation=[1, 0, 0])
    )
    scan = read_scan(path, tmp_path)
    corners = scan.vertices[scan.faces]
    assert np.abs(corners[:, ::-1] - (made.vertices[made.faces] * [-2, 2, 2] + [1, 0, 0])).max() < 1e-5


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("f 1 2 9\n", "line 4"),
        ("f 1 2 x\n", "line 4"),
        ("f 1 2 3\nf 1 2\n", "line 5"),
        ("v 1 2\nf 1 2 3\n", "line 4"),
        ("", "no triangles"),
    ],
)
def test_a_damaged_obj_names_the_line(tmp_path, text, told):
    path = tmp_path / "s.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + text)
    error = refused(path, tmp_path)
    assert told in str(error)


def test_an_obj_of_polygons_and_numbers_of_every_kind(tmp_path):
    path = tmp_path / "s.obj"
    path.write_text("# a scan\r\nv 0 0 0\r\nv 1e0 0 0\r\nv +1 1.0 -0\r\nv 0 10E-1 0\r\nf -4//1 2 3/ 4\r\n")
    scan = read_scan(path, tmp_path)
    assert scan.faces.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert scan.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    assert not scan.coloured


def test_what_has_other_faces_than_triangles_is_to_be_triangulated(made, tmp_path):
    path = tmp_path / "s.ply"
    head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    head += "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    path.write_text(head + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n")
    assert "triangulate" in refused(path, tmp_path).fix


def test_too_many_triangles_are_refused_by_the_header(made, tmp_path):
    path = write(made, "ply painted", tmp_path)
    data = path.read_bytes()
    path.write_bytes(data.replace(b"element face 242", b"element face 5000001"))
    assert "at most 5000000" in refused(path, tmp_path).what


def test_an_unknown_ending_is_refused(tmp_path):
    path = tmp_path / "robe.stl"
    path.write_bytes(b"solid robe")
    assert ".glb, .ply, .obj" in refused(path, tmp_path).fix


def test_arbitrary_bytes_never_fail_in_another_way(made, tmp_path):
    """A hundred damaged files of each form: each is read, or refused in one line."""
    rng = np.random.default_rng(5)
    for form in ("glb", "obj", "ply"):
        path = write(made, form, tmp_path)
        data = path.read_bytes()
        for _ in range(60):
            spoilt = bytearray(data)
            for at in rng.integers(0, min(len(data), 2000), 4):
                spoilt[at] = rng.integers(0, 256)
            path.write_bytes(bytes(spoilt))
            with suppress(ScanError):  # any other error fails
                read_scan(path, tmp_path)
