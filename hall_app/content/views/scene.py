"""What the page asks for, as plain dictionaries: GET /api/scene and GET /api/exhibits/{id}."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from hall_app.content.behaviours import kind_of
from hall_app.content.files import BAKED, CLOSE_MOTION, MOTION, digest, is_there, tracked_beside
from hall_app.content.floor.footprints import plan_footprints
from hall_app.content.floor.opaque import opaque_walls
from hall_app.content.folder import Content, Exhibit
from hall_app.content.models.glb import GlbError, read_glb
from hall_app.content.schema.exhibit import Media, Record
from hall_app.content.views.markdown import html_of
from hall_app.content.views.measurements import measured_lines

# Named here and not asked of the system: what `mimetypes` knows differs from machine to machine.
TYPES = {
    ".jpg": "image/jpeg",
    ".jpeg": "image/jpeg",
    ".png": "image/png",
    ".webp": "image/webp",
    ".svg": "image/svg+xml",
    ".webm": "video/webm",
    ".mp4": "video/mp4",
    ".ogg": "audio/ogg",
    ".opus": "audio/ogg",
    ".m4a": "audio/mp4",
    ".mp3": "audio/mpeg",
    ".wav": "audio/wav",
    ".glb": "model/gltf-binary",
    ".clip": "application/vnd.handress.clip",
    ".points": "application/vnd.handress.points",
}

# Names of the catalogue record's lines, Chinese and English.
RECORD_LABELS: dict[str, tuple[str, str]] = {
    "object": ("名称", "Object"),
    "date": ("年代", "Date"),
    "culture": ("文化", "Culture"),
    "material": ("材质", "Material"),
    "technique": ("工艺", "Technique"),
    "colour": ("颜色", "Colour"),
    "measurements": ("尺寸", "Measurements"),
    "wear": ("穿用", "How it is worn"),
    "maker": ("制作", "Maker"),
    "source": ("依据", "Basis"),
    "rights": ("权利", "Rights"),
}


def media_type(path: str, kind: str = "") -> str:
    """MIME type by the file's ending; a .webm or .mp4 of kind "audio" is sound."""
    known = TYPES.get(Path(path).suffix.lower(), "application/octet-stream")
    return known.replace("video/", "audio/") if kind == "audio" else known


def media_file(exhibit: Exhibit, path: str, baked: Path | None = None) -> Path:
    """Where the exhibit's file `path` lies; `baked`: the folder of its bake, if not its own one."""
    if baked is not None and path.startswith(BAKED):
        return baked / path.removeprefix(BAKED)
    return exhibit.folder / path


def media_url(owner: str, path: str, file: Path) -> str | None:
    """Address of `path` of exhibit `owner` (or "hall"), None while there is no such file."""
    if not is_there(file):
        return None
    return f"/media/{quote(owner)}/{quote(path)}?v={digest(file)}"


def yaw_of(facing: float) -> float:
    """Page yaw [rad], 0 = -z, of a plan's facing [degrees], 0 = +z; in (-pi, pi]."""
    yaw = math.radians(facing) - math.pi
    return math.atan2(math.sin(yaw), math.cos(yaw))


def scene_json(
    content: Content, *, nodes: Sequence[str] | None = None, baked: Mapping[str, Path] | None = None
) -> dict[str, Any]:
    """GET /api/scene without its `walk`.

    nodes: names of the drawn things, default one per exhibit; baked: exhibit id -> folder of its bake where
    that is not exhibits/<id>/baked. `music` is the first file's address, `music_sources` all formats.
    """
    hall, plan = content.hall, content.plan
    music = _sources([(path, media_url("hall", path, content.folder / path)) for path in hall.music], "audio")
    if nodes is None:
        nodes = [f"/exhibits/{exhibit.id}" for exhibit in content.exhibits]
    return {
        "revision": content.revision,
        "title": hall.title.as_json(),
        "subtitle": hall.subtitle.as_json(),
        "about": hall.about.as_json() if hall.about else None,
        "language": hall.language,
        "music": music[0]["url"] if music else None,
        "music_sources": music,
        "start": {"x": hall.start.x, "z": hall.start.z, "yaw": yaw_of(hall.start.facing)},
        "eye": hall.eye.model_dump(),
        "outline": [list(point) for point in plan.outline],
        "solids": [footprint.as_json() for footprint in plan_footprints(plan)],
        "opaque": [list(wall) for wall in opaque_walls(plan)],
        "bays": [
            {"id": bay.id, "name": bay.name.as_json(), "polygon": [list(point) for point in bay.polygon]}
            for bay in plan.bay
        ],
        "exhibits": [_entry(exhibit, (baked or {}).get(exhibit.id)) for exhibit in content.exhibits],
        "nodes": list(nodes),
        "questionnaire": hall.questionnaire,
        "licence": hall.licence,
    }


def _sources(addresses: Sequence[tuple[str, str | None]], kind: str) -> list[dict[str, str]]:
    return [{"url": url, "type": media_type(path, kind)} for path, url in addresses if url]


def _entry(exhibit: Exhibit, baked: Path | None) -> dict[str, Any]:
    file = exhibit.file
    return {
        "id": exhibit.id,
        "title": file.title.as_json(),
        "x": file.place.x,
        "z": file.place.z,
        "facing": file.place.facing,
        "lamp": file.place.lamp,
        "thumbnail": thumbnail(exhibit, baked),
        "motion": _motion(exhibit, baked),
        "close_motion": _url(exhibit, CLOSE_MOTION, baked) if file.outfit is not None else None,
        "moves": bool(_motion(exhibit, baked)) or bool(file.comparison and file.comparison.clip),
        "kind": kind_of(file.behaviours),
        "caption": file.caption.as_json() if file.caption else None,
    }


def _motion(exhibit: Exhibit, baked: Path | None) -> str | None:
    """Address of the clip its model moves by: the one its file names, else the one that was baked with it."""
    path = _clip(exhibit)
    return _url(exhibit, path, baked) if path else None


def _clip(exhibit: Exhibit) -> str | None:
    return exhibit.file.motion or (MOTION if exhibit.file.outfit is not None else None)


def _points(exhibit: Exhibit, baked: Path | None) -> str | None:
    """Address of what was tracked of the wearer in its clip, None where it has none or nobody was tracked."""
    path = _clip(exhibit)
    if path is None or _url(exhibit, path, baked) is None:
        return None
    return _url(exhibit, tracked_beside(path), baked)


def thumbnail(exhibit: Exhibit, baked: Path | None) -> str | None:
    """Address of the picture that stands for the exhibit in lists."""
    pictures = [path for medium in exhibit.file.media if medium.kind == "picture" for path in medium.sources]
    for path in [exhibit.file.thumbnail, *pictures]:
        if path and (address := _url(exhibit, path, baked)):
            return address
    return None


def _url(exhibit: Exhibit, path: str, baked: Path | None) -> str | None:
    return media_url(exhibit.id, path, media_file(exhibit, path, baked))


def exhibit_json(content: Content, identity: str, *, baked: Path | None = None) -> dict[str, Any] | None:
    """GET /api/exhibits/{id}, None where there is no such exhibit. `baked`: as for one in scene_json."""
    exhibit = content.exhibit(identity)
    if exhibit is None:
        return None
    file = exhibit.file
    return {
        "id": exhibit.id,
        "title": file.title.as_json(),
        "caption": file.caption.as_json() if file.caption else None,
        "text": {
            "zh": html_of(exhibit.text_zh, lambda path: own_picture(exhibit, path)),
            "en": html_of(exhibit.text_en, lambda path: own_picture(exhibit, path)),
        },
        "media": [shown for medium in file.media if (shown := _medium(exhibit, medium, baked))],
        "record": _record(file.record),
        "measured": measured_lines(_bake(media_file(exhibit, BAKED + "bake.json", baked))),
        "licence": file.licence,
        "questionnaire": file.questionnaire,
        "has_close": _has_close(exhibit, baked),
        "scanned": file.scan is not None,
        "points": _points(exhibit, baked),
        "comparison": _comparison(exhibit),
    }


def _comparison(exhibit: Exhibit) -> dict[str, Any] | None:
    """What the page tells of meshes side by side; None where it compares nothing, or nothing that can be drawn."""
    told, path = exhibit.file.comparison, exhibit.compared_path()
    if told is None or path is None:
        return None
    try:
        read_glb(path)
    except (GlbError, OSError):
        return None
    return {
        "clip": _url(exhibit, told.clip, None) if told.clip else None,
        "text": told.text.as_json() if told.text else None,
        "sides": [side.model_dump() for side in told.side],
    }


def _has_close(exhibit: Exhibit, baked: Path | None) -> bool:
    if exhibit.file.baked_key is not None:
        return media_file(exhibit, BAKED + "close.glb", baked).is_file()
    return exhibit.model_path("close") is not None


def own_picture(exhibit: Exhibit, path: str) -> str | None:
    """Address of a picture in a text: only one of the exhibit's own folder, else None."""
    full = own_file(exhibit, path)
    if full is None or not media_type(path).startswith("image/"):
        return None
    return media_url(exhibit.id, full.relative_to(exhibit.folder.resolve()).as_posix(), full)


def own_file(exhibit: Exhibit, path: str) -> Path | None:
    """Where `path` of a text lies, None outside the exhibit's folder and for a name no file system takes."""
    own = exhibit.folder.resolve()
    try:
        full = (own / path).resolve()
    except (OSError, ValueError):
        return None
    return full if full.is_relative_to(own) else None


def _medium(exhibit: Exhibit, medium: Media, baked: Path | None) -> dict[str, Any] | None:
    """A picture, video or sound; None while none of its files is there (not baked yet)."""
    sources = _sources([(path, _url(exhibit, path, baked)) for path in medium.sources], medium.kind)
    if not sources:
        return None
    return {
        "kind": medium.kind,
        "sources": sources,
        "poster": _url(exhibit, medium.poster, baked) if medium.poster else None,
        "alt": medium.alt.as_json() if medium.alt else None,
        "caption": medium.caption.as_json() if medium.caption else None,
        "transcript": medium.transcript.as_json() if medium.transcript else None,
    }


def _record(record: Record) -> list[dict[str, Any]]:
    lines = []
    for name, (zh, en) in RECORD_LABELS.items():
        value = getattr(record, name)
        if value is not None:
            lines.append({"label": {"zh": zh, "en": en}, "value": value.as_json()})
    lines += [{"label": line.label.as_json(), "value": line.value.as_json()} for line in record.line]
    return lines


def _bake(file: Path) -> dict[str, Any]:
    """What the last bake noted about itself, {} before the first."""
    try:
        noted = json.loads(file.read_text("utf-8"))
    except (OSError, ValueError):
        return {}
    return noted if isinstance(noted, dict) else {}
