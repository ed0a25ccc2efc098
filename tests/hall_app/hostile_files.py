"""Fifty uploads that mean harm, or are broken: name, content, use."""

from __future__ import annotations

import gzip
import io
import json
import struct
import tarfile
import zipfile
import zlib

import trimesh
from content_house import png_of
from PIL import Image
from svg_drawings import doubled, drawing

__all__ = ["hostile_files"]

HTML = b"<!doctype html><html><body><script>alert(1)</script></body></html>"
SVG = b'<svg xmlns="http://www.w3.org/2000/svg" onload="alert(1)"><script>alert(2)</script></svg>'


def picture(kind: str, size: tuple[int, int] = (8, 8), **more: object) -> bytes:
    data = io.BytesIO()
    Image.new("RGB", size, "#7a4b2e").save(data, kind, **more)
    return data.getvalue()


def zipped(inside: bytes) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("../../hall.toml", inside)
    return data.getvalue()


def tarred() -> bytes:
    data = io.BytesIO()
    with tarfile.open(fileobj=data, mode="w:gz") as archive:
        told = tarfile.TarInfo("/etc/evil")
        archive.addfile(told)
    return data.getvalue()


def glb(document: object, rest: bytes = b"", *, length: int | None = None) -> bytes:
    text = document if isinstance(document, bytes) else json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<II", len(text), 0x4E4F534A) + text + rest
    return struct.pack("<III", 0x46546C67, 2, 12 + len(body) if length is None else length) + body


def box() -> bytes:
    data = trimesh.Scene(trimesh.creation.box((0.5, 0.5, 0.5))).export(file_type="glb")
    assert isinstance(data, bytes)
    return data


def claiming(**accessor: object) -> bytes:
    """A GLB of a few hundred bytes, a triangle by what it says, whose one accessor tells of itself what is given."""
    told = {"componentType": 5126, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1], **accessor}
    document = {
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [told],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36}],
    }
    return glb(document, struct.pack("<II", 36, 0x004E4942) + bytes(36))


def text_bomb() -> bytes:
    """A PNG whose text unpacks to 60 MB."""
    body = b"zTXt" + b"Comment\0\0" + zlib.compress(bytes(60_000_000))
    chunk = struct.pack(">I", len(body) - 4) + body + struct.pack(">I", zlib.crc32(body))
    whole = png_of(8, 8, 8)
    return whole[:33] + chunk + whole[33:]


def hostile_files() -> list[tuple[str, bytes, str]]:
    """(name, content, use); what of them is taken in at all is harmless by then."""
    jpeg, png, model = picture("JPEG"), picture("PNG"), box()
    asset = {"asset": {"version": "2.0"}}
    return [
        ("page.jpg", HTML, "picture"),
        ("page.html", HTML, "picture"),
        ("page.mp4", HTML, "film"),
        ("page.glb", HTML, "hall"),
        ("page.obj", HTML, "scan"),
        ("drawing.svg", SVG, "picture"),
        ("drawing.png", SVG, "picture"),
        ("drawing.jpg", b"<?xml version='1.0'?>" + SVG, "picture"),
        ("entity.svg", b'<!DOCTYPE x [<!ENTITY a "aaaa">]>' + SVG, "picture"),
        ("address.svg", drawing(b'<image href="http://x/y.png"/><use href="https://x/#y"/>'), "picture"),
        (
            "frame.svg",
            drawing(b"<foreignObject><iframe xmlns='http://www.w3.org/1999/xhtml'/></foreignObject>"),
            "picture",
        ),
        ("sheet.svg", drawing(b"<style>@import 'http://x';*{fill:u\\72l(http://x)}</style>"), "picture"),
        ("uses.svg", drawing(doubled(40)), "picture"),
        ("circle.svg", drawing(b'<g id="a"><use href="#a"/></g>'), "picture"),
        ("deep.svg", drawing(b"<g>" * 100_000 + b"</g>" * 100_000), "picture"),
        ("page.svg", drawing(b"", root=b"html"), "picture"),
        ("model.svg", drawing(b"<path d='M0 0'/>"), "hall"),
        ("tail.jpg", jpeg + HTML, "picture"),
        ("comment.jpg", picture("JPEG", comment=HTML), "picture"),
        ("tail.png", png + HTML, "picture"),
        ("zip-tail.png", png + zipped(b"x"), "picture"),
        ("gifar.gif", b"GIF89a" + HTML, "picture"),
        ("head.webp", b"RIFF\x10\0\0\0WEBP" + HTML, "picture"),
        ("cut.jpg", jpeg[: len(jpeg) // 2], "picture"),
        ("cut.png", png[:40], "picture"),
        ("wide.png", png_of(100_000, 100_000), "picture"),
        ("long.png", png_of(8, 400_000_000), "picture"),
        ("bomb.png", png_of(20_000, 20_000, 20_000), "picture"),
        ("text.png", text_bomb(), "picture"),
        ("tiff.tif", b"II*\0" + bytes(8), "picture"),
        ("loop.tif", b"II*\0\x08\0\0\0\x01\0" + b"\xff" * 12 + b"\x08\0\0\0", "picture"),
        ("bomb.zip", zipped(bytes(50_000_000)), "picture"),
        ("bomb.gz", gzip.compress(bytes(50_000_000)), "hall"),
        ("slip.tar.gz", tarred(), "scan"),
        ("zip.glb", zipped(b"glTF"), "hall"),
        ("cut.glb", model[: len(model) // 2], "hall"),
        ("short.glb", model[:11], "hall"),
        ("tail.glb", model + HTML, "hall"),
        ("endless.glb", glb(asset, length=0xFFFFFFFF), "hall"),
        ("deep.glb", glb(b"[" * 90_000), "hall"),
        ("outside.glb", glb(asset | {"buffers": [{"byteLength": 4, "uri": "file:///etc/passwd"}]}), "hall"),
        (
            "huge.glb",
            glb(asset | {"accessors": [{"count": 2**60, "componentType": 5126, "type": "VEC3"}]}),
            "hall",
        ),
        ("claims-nothing-held.glb", claiming(count=30_000_000), "hall"),
        ("claims-a-view.glb", claiming(count=30_000_000, bufferView=0), "hall"),
        (
            "claims-sparse.glb",
            claiming(
                count=30_000_000,
                sparse={
                    "count": 1,
                    "indices": {"bufferView": 0, "componentType": 5125},
                    "values": {"bufferView": 0},
                },
            ),
            "hall",
        ),
        ("loop.glb", glb(asset | {"scenes": [{"nodes": [0]}], "nodes": [{"children": [0]}]}), "hall"),
        ("../../../../hall.toml", png, "picture"),
        ("..\\..\\plan.toml\0.png", png, "picture"),
        ("exhibit.toml", b"title = 1", "picture"),
        ("\u202egpj.exe" + "a" * 300 + ".jpg", jpeg, "picture"),
        ("", b"", "picture"),
        ("nul\0.mp3", b"ID3" + HTML, "sound"),
        ("con.ogg", b"OggS" + HTML, "sound"),
        ("ftyp.mp4", b"\0\0\0\x18ftypisom" + HTML, "film"),
        ("head.ply", b"ply\n" + HTML, "scan"),
    ]
