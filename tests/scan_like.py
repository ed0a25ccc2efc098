"""Scans as a scanner leaves them, made of our garments: dense, noisy, painted, with holes and flakes, in mm, z up."""

from __future__ import annotations

import io
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sim_core.gltf import GlbFile, glb_parts
from sim_core.mesh.scan import laid_out

ASSETS = Path(__file__).parents[1] / "assets"
NOISE = 0.2e-3  # [m]


@dataclass(frozen=True)
class Made:
    """A scan: vertices (V, 3), faces (F, 3), uv (V, 2; v downwards) in picture (H, W, 3) uint8."""

    vertices: np.ndarray
    faces: np.ndarray
    uv: np.ndarray
    picture: np.ndarray

    def turned(self, scale: float = 1000.0) -> Made:
        """In millimetres, z up, as many scanners write it."""
        x, y, z = self.vertices.T
        return replace(self, vertices=scale * np.stack([x, -z, y], axis=1))


def garment_mesh(exhibit: str = "walking") -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cloth of a baked close-up: vertices (V, 3) [m], faces (F, 3), pattern (V, 2) [mm]."""
    parts = glb_parts((ASSETS / f"exhibits/{exhibit}/baked/close.glb").read_bytes())
    document, at = parts.document, 0
    vertices, faces, pattern = [], [], []
    for node in document["nodes"]:
        primitive = document["meshes"][node["mesh"]]["primitives"][0]
        if "TEXCOORD_0" not in primitive["attributes"]:
            continue  # the figure
        points = parts.numbers(primitive["attributes"]["POSITION"])
        vertices.append(points)
        pattern.append(parts.numbers(primitive["attributes"]["TEXCOORD_0"]))
        faces.append(parts.numbers(primitive["indices"]).reshape(-1, 3).astype(np.int64) + at)
        at += len(points)
    return np.concatenate(vertices), np.concatenate(faces), np.concatenate(pattern)


def _cloth_paint(mm: np.ndarray) -> np.ndarray:
    """(N, 3) uint8 at pattern places (N, 2) [mm]: lozenges, a band, a fleck here and there."""
    x, y = mm[:, 0], mm[:, 1]
    lozenge = np.abs((x / 60 + y / 80) % 1 - 0.5) + np.abs((x / 60 - y / 80) % 1 - 0.5)
    figure, line = lozenge < 0.32, np.abs(lozenge - 0.5) < 0.035
    colour = np.tile([146.0, 60.0, 48.0], (len(mm), 1))
    colour[figure] = [205, 164, 84]
    colour[line] = [236, 222, 188]
    colour[np.abs(y % 400 - 30) < 9] = [44, 66, 92]
    colour *= (0.94 + 0.06 * np.sin(2 * np.pi * x / 3.0) * np.sin(2 * np.pi * y / 3.0))[:, None]
    return np.clip(colour, 0, 255).astype(np.uint8)


def scan_of(
    triangles: int, *, exhibit: str = "walking", pixels: int = 2048, noise: float = NOISE, seed: int = 1
) -> Made:
    """The garment as about so many triangles, each vertex off by `noise` [m], its cloth painted in an atlas."""
    vertices, faces, pattern = garment_mesh(exhibit)
    first, weld = np.unique(np.round(vertices, 6), axis=0, return_inverse=True)
    whole = weld.reshape(-1)[faces]
    sound = (whole[:, 0] != whole[:, 1]) & (whole[:, 1] != whole[:, 2]) & (whole[:, 2] != whole[:, 0])
    faces, whole = faces[sound], whole[sound]
    layout = laid_out(first, whole, pixels)
    picture = np.full((pixels, pixels, 3), 0, np.uint8)
    y, x = np.nonzero(layout.owner >= 0)
    face = layout.owner[y, x]
    a, b, c = (layout.place[face, k] for k in range(3))
    spot = np.stack([x, y], axis=1) + 0.5

    def across(one: np.ndarray, other: np.ndarray) -> np.ndarray:
        return one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]

    area = across(b - a, c - a)
    s, t = across(spot - a, c - a) / area, across(b - a, spot - a) / area
    weights = np.stack([1 - s - t, s, t], axis=1)
    picture[y, x] = _cloth_paint(np.einsum("nk,nkc->nc", weights, pattern[faces[face]]))
    return _finer(first, whole, layout.place / pixels, triangles, noise, seed, picture)


def _finer(
    vertices: np.ndarray,
    faces: np.ndarray,
    uv: np.ndarray,
    triangles: int,
    noise: float,
    seed: int,
    picture: np.ndarray,
) -> Made:
    """Every face cut into n x n; vertices of shared edges are one place, with one noise."""
    n = max(1, round((triangles / len(faces)) ** 0.5))
    i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    inside = i + j <= n
    weight = np.stack([n - i[inside] - j[inside], i[inside], j[inside]], axis=1) / n
    number = np.full((n + 1, n + 1), -1)
    number[inside] = np.arange(inside.sum())
    small = [
        corner
        for p in range(n)
        for q in range(n - p)
        for corner in (
            [(number[p, q], number[p + 1, q], number[p, q + 1])]
            + ([(number[p + 1, q], number[p + 1, q + 1], number[p, q + 1])] if p + q < n - 1 else [])
        )
    ]
    own = np.array(small)
    points = np.einsum("kc,fcd->fkd", weight, vertices[faces]).reshape(-1, 3)
    places = np.einsum("kc,fcd->fkd", weight, uv).reshape(-1, 2)
    fine = (own[None] + len(weight) * np.arange(len(faces))[:, None, None]).reshape(-1, 3)
    key = np.round(points * 1e7).astype(np.int64)
    order = np.lexsort(key.T)
    new = np.r_[True, (key[order][1:] != key[order][:-1]).any(1)]
    weld = np.zeros(len(points), np.int64)
    weld[order] = np.cumsum(new) - 1
    rng = np.random.default_rng(seed)
    shift = rng.normal(scale=noise, size=(int(new.sum()), 3))
    return Made(points[order[new]][weld] + shift[weld], fine.astype(np.int32), places, picture)


def with_holes(scan: Made, count: int, width: float, seed: int = 2) -> Made:
    """With round holes of that width [units] torn into it."""
    rng = np.random.default_rng(seed)
    middle = scan.vertices[scan.faces].mean(1)
    keep = np.ones(len(middle), bool)
    for centre in middle[rng.choice(len(middle), count, replace=False)]:
        keep &= ((middle - centre) ** 2).sum(1) > (width / 2) ** 2
    return replace(scan, faces=scan.faces[keep])


def with_flakes(scan: Made, count: int, size: float, away: float = 0.0, seed: int = 3) -> Made:
    """With loose triangles of that size [units] beside it, `away` further off."""
    rng = np.random.default_rng(seed)
    low, high = scan.vertices.min(0), scan.vertices.max(0)
    centre = rng.uniform(low - away, high + away, (count, 1, 3))
    corners = centre + size * rng.normal(size=(count, 3, 3))
    more = np.arange(3 * count, dtype=np.int32).reshape(-1, 3) + len(scan.vertices)
    return replace(
        scan,
        vertices=np.concatenate([scan.vertices, corners.reshape(-1, 3)]),
        faces=np.concatenate([scan.faces, more]),
        uv=np.concatenate([scan.uv, np.full((3 * count, 2), 0.5)]),
    )


def jpeg(picture: np.ndarray) -> bytes:
    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(picture).save(stream, "JPEG", quality=95, subsampling=0)
    return stream.getvalue()


def write_glb(scan: Made, path: Path) -> Path:
    """As a scanner's GLB: one mesh, its picture embedded."""
    glb = GlbFile()
    look = {"baseColorTexture": glb.picture(jpeg(scan.picture), "image/jpeg"), "metallicFactor": 0.0}
    material = glb.material({"pbrMetallicRoughness": look})
    glb.mesh("scan", scan.vertices, scan.faces, material, uv=scan.uv, shading=False)
    path.write_bytes(glb.bytes("scan", []))
    return path


def write_ply(scan: Made, path: Path, *, text: bool = False, painted: bool = True) -> Path:
    """With vertex colours (painted), or with texture coordinates and a picture beside it."""
    kinds = [(axis, "<f4") for axis in "xyz"]
    kinds += [(c, "u1") for c in ("red", "green", "blue")] if painted else [("s", "<f4"), ("t", "<f4")]
    vertex = np.zeros(len(scan.vertices), kinds)
    for k, axis in enumerate("xyz"):
        vertex[axis] = scan.vertices[:, k]
    if painted:
        high, wide = scan.picture.shape[:2]
        x, y = (np.clip((scan.uv * [wide, high]).astype(int), 0, [wide - 1, high - 1])).T
        for k, name in enumerate(("red", "green", "blue")):
            vertex[name] = scan.picture[y, x, k]
    else:
        vertex["s"], vertex["t"] = scan.uv[:, 0], 1 - scan.uv[:, 1]
        (path.parent / f"{path.stem}.jpg").write_bytes(jpeg(scan.picture))
    face = np.zeros(len(scan.faces), [("n", "u1"), ("v", "<i4", (3,))])
    face["n"], face["v"] = 3, scan.faces
    names = {"<f4": "float", "u1": "uchar"}
    form = "ascii" if text else "binary_little_endian"
    lines = ["ply", f"format {form} 1.0", *([] if painted else [f"comment TextureFile {path.stem}.jpg"])]
    lines += [f"element vertex {len(vertex)}", *(f"property {names[kind]} {name}" for name, kind in kinds)]
    lines += [f"element face {len(face)}", "property list uchar int vertex_indices", "end_header"]
    head = ("\n".join(lines) + "\n").encode()
    if text:
        rows = [" ".join(map(str, row)) for row in vertex.tolist()]
        rows += [f"3 {a} {b} {c}" for a, b, c in scan.faces.tolist()]
        path.write_bytes(head + ("\n".join(rows) + "\n").encode())
    else:
        path.write_bytes(head + vertex.tobytes() + face.tobytes())
    return path


def write_obj(scan: Made, path: Path) -> Path:
    """With its material file and its picture beside it."""
    stem = path.stem
    lines = [f"mtllib {stem}.mtl", *(f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in scan.vertices.tolist())]
    lines += [f"vt {u:.6f} {1 - v:.6f}" for u, v in scan.uv.tolist()]
    lines += ["usemtl cloth", *(f"f {a}/{a} {b}/{b} {c}/{c}" for a, b, c in (scan.faces + 1).tolist())]
    path.write_text("\n".join(lines) + "\n", "utf-8")
    (path.parent / f"{stem}.mtl").write_text(f"newmtl cloth\nKd 1 1 1\nmap_Kd {stem}.jpg\n", "utf-8")
    (path.parent / f"{stem}.jpg").write_bytes(jpeg(scan.picture))
    return path
