"""Models and scans in the office: drawn, sent to be turned, their limits told."""

from __future__ import annotations

import io
import json
import shutil
import struct
import uuid
from typing import Any

import numpy as np
import pytest
import trimesh
from content_house import EXHIBIT, add_exhibit
from office_clerk import Clerk, clerk
from PIL import Image

from hall_app.house.drafts import LARGEST, MOST_TURNED
from hall_app.house.people import Role


@pytest.fixture
def curator(counter) -> Clerk:
    return clerk(counter, counter.people, Role.CURATOR)


@pytest.fixture
def chest(counter):
    """An exhibit of its own that goes afterwards; its folder."""
    key = f"c{uuid.uuid4().hex[:10]}"
    home = add_exhibit(counter.content, key, EXHIBIT)
    yield home
    shutil.rmtree(home, ignore_errors=True)


def told_shape(data: bytes) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, int]:
    """Positions, normals, colours and triangles of what the office sends to be turned, and triangles of the file."""
    name, corners, triangles, of = struct.unpack("<4sIII", data[:16])
    assert name == b"HDSH"
    assert len(data) == 16 + corners * 20 + triangles * 12
    positions = np.frombuffer(data, "<f4", corners * 3, 16).reshape(-1, 3)
    normals = np.frombuffer(data, "i1", corners * 4, 16 + corners * 12).reshape(-1, 4)[:, :3]
    colours = np.frombuffer(data, "u1", corners * 4, 16 + corners * 16).reshape(-1, 4)[:, :3]
    return positions, normals, colours, np.frombuffer(data, "<u4", -1, 16 + corners * 20).reshape(-1, 3), of


def ball(subdivisions: int, ending: str) -> bytes:
    """A ball of radius 0.5 m, red above and blue below."""
    mesh: Any = trimesh.creation.icosphere(subdivisions=subdivisions, radius=0.5)
    above = mesh.vertices[:, 1] > 0
    mesh.visual.vertex_colors = np.where(above[:, None], [200, 30, 30, 255], [30, 30, 200, 255]).astype(
        np.uint8
    )
    data = mesh.export(file_type=ending)
    return data if isinstance(data, bytes) else data.encode()


def test_a_model_goes_with_what_takes_its_place(counter, curator, chest):
    """Else the check would refuse the draft: nothing may lie there unused."""
    key, box = chest.name, (chest / "media/chest.glb").read_bytes()
    (chest / "exhibit.toml").write_text(EXHIBIT.replace("z = -1.0", "z = 2.0"), "utf-8")
    steps = (
        ("hall", "new.glb", box, "media/new.glb", ["media/chest.glb"]),
        ("close", "close.glb", box, "media/close.glb", []),
        ("scan", "ball.ply", ball(2, "ply"), "scan/ball.ply", ["media/new.glb", "media/close.glb"]),
        ("hall", "chest.glb", box, "media/chest.glb", ["scan/ball.ply"]),
    )
    for use, name, data, brought, gone in steps:
        answer = curator.bring(key, [(name, data)], use=use)
        assert list(json.loads(answer.body)["files"]) == [brought]
        files = curator.told(f"collection/{key}")["files"]
        assert brought in files
        assert not set(gone) & set(files)
        if use != "scan":  # which is baked first
            assert curator.api(f"collection/{key}/publish", {}).status == 200
    assert sorted(one.name for one in (chest / "media").iterdir()) == ["chest.glb", "front.jpg"]


def test_a_model_that_something_else_names_stays(counter, curator, chest):
    key, box = chest.name, (chest / "media/chest.glb").read_bytes()
    hall = 'hall = "media/chest.glb"'
    (chest / "exhibit.toml").write_text(EXHIBIT.replace(hall, f'{hall}\nclose = "media/chest.glb"'), "utf-8")
    assert curator.bring(key, [("new.glb", box)], use="hall").status == 200
    assert "media/chest.glb" in curator.told(f"collection/{key}")["files"]
    assert curator.bring(key, [("near.glb", box)], use="close").status == 200
    assert "media/chest.glb" not in curator.told(f"collection/{key}")["files"]
    curator.drop(key)
    (chest / "text.en.md").write_text("The [model](media/chest.glb) itself.", "utf-8")
    assert curator.bring(key, [("new.glb", box)], use="hall").status == 200
    assert "media/chest.glb" in curator.told(f"collection/{key}")["files"]


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["glb", "ply", "obj"])
def test_a_scan_is_drawn_and_turned_for_who_brought_it(counter, curator, chest, ending):
    data = (b"mtllib beside.mtl\n" if ending == "obj" else b"") + ball(4, ending)
    brought = curator.bring(chest.name, [(f"ball.{ending}", data)], use="scan")
    assert brought.status == 200, brought.text
    name = f"scan/ball.{ending}"
    page = curator.get(f"/office/collection/{chest.name}?lang=en").text
    for way in ("picture", "shape"):
        assert f"/office/collection/{chest.name}/{way}?lang=en&amp;name=scan%2Fball.{ending}" in page
    assert '<script src="/static/book/turn.js"' in page
    sent = curator.get(f"/office/collection/{chest.name}/shape?name={name}")
    assert sent.headers["Content-Type"] == "application/octet-stream"
    assert "sandbox" in sent.headers["Content-Security-Policy"]
    positions, normals, colours, faces, of = told_shape(sent.body)
    assert of == len(faces) == 5120, "as many as there are: nothing was to be made fewer"
    assert faces.max() < len(positions)
    assert np.linalg.norm(positions, axis=1) == pytest.approx(0.5, abs=1e-3)
    assert (normals / 127 * positions).sum(axis=1) == pytest.approx(0.5, abs=0.02), "all look outwards"
    if ending != "obj":  # whose colours lie in the file that is not there
        # A GLB's numbers are linear light, whatever the program that wrote them took them for.
        strong, weak = (229, 96) if ending == "glb" else (200, 30)
        above, below = positions[:, 1] > 0.05, positions[:, 1] < -0.05
        assert colours[above].mean(axis=0) == pytest.approx([strong, weak, weak], abs=3)
        assert colours[below].mean(axis=0) == pytest.approx([weak, weak, strong], abs=3)
    drawn = curator.get(f"/office/collection/{chest.name}/picture?name={name}")
    assert drawn.headers["Content-Type"] == "image/jpeg"
    middle = np.asarray(Image.open(io.BytesIO(drawn.body)).convert("L").crop((200, 250, 280, 350)))
    assert middle.max() > middle.min()
    facts = curator.told(f"collection/{chest.name}/shape?name={name}")
    assert facts["size"] == len(data)


@pytest.mark.slow
def test_a_dense_scan_is_turned_with_few_triangles(curator, chest):
    curator.bring(chest.name, [("dense.ply", ball(7, "ply"))], use="scan")
    sent = curator.get(f"/office/collection/{chest.name}/shape?name=scan/dense.ply").body
    positions, _, _, faces, of = told_shape(sent)
    assert of == 327_680
    assert MOST_TURNED / 3 < len(faces) <= MOST_TURNED
    assert np.linalg.norm(positions, axis=1) == pytest.approx(0.5, abs=0.005)
    a, b, c = (positions[faces[:, k]].astype(float) for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    assert area == pytest.approx(np.pi, rel=0.03), "closed, and once"


@pytest.mark.slow
def test_what_cannot_be_drawn_is_said(curator, chest):
    assert curator.bring(chest.name, [("cut.ply", ball(2, "ply")[:600])], use="scan").status == 200
    for way in ("picture", "shape"):
        told = curator.ask("GET", f"/office/collection/{chest.name}/{way}?name=scan/cut.ply")
        assert told.status in (400, 404), way
        assert curator.ask("GET", f"/office/collection/{chest.name}/{way}?name=media/none.glb").status == 404


@pytest.mark.parametrize("lang", ["zh", "en"])
def test_limits_are_told_where_files_are_brought(curator, chest, lang):
    page = curator.get(f"/office/collection/{chest.name}?lang={lang}").text
    for kind, size in LARGEST.items():
        assert f"{size // 1_000_000} MB" in page, kind
    assert f"exhibits/{chest.name}/scan/" in page, "how a larger one comes in"
