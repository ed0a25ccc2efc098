"""A GLB with the licence and the name of what it shows written into it: whoever has the file alone knows both.

`asset.copyright` and `asset.extras` for whoever looks into the file, KHR_xmp_json_ld for programs.
https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Khronos/KHR_xmp_json_ld
"""

from __future__ import annotations

import json
import struct
from typing import Any

from hall_app.content.schema.values import Bilingual
from hall_app.web.collection.record import GLB, Collection, Item
from sim_core.gltf import HEADER, glb_parts

__all__ = ["licensed_glb"]

_XMP = "KHR_xmp_json_ld"
_CONTEXT = {
    "dc": "http://purl.org/dc/elements/1.1/",
    "rdf": "http://www.w3.org/1999/02/22-rdf-syntax-ns#",
    "xmpRights": "http://ns.adobe.com/xap/1.0/rights/",
}


def licensed_glb(data: bytes, collection: Collection, item: Item) -> bytes:
    """The GLB with the exhibit's licence; meshes and pictures are untouched, and what it says of its copyright stays.

    Raises GlbError (sim_core.gltf) where `data` is no GLB.
    """
    document = glb_parts(data).document
    old_size, length = struct.unpack_from("<I", data, 12)[0], struct.unpack_from("<I", data, 8)[0]
    text = json.dumps(_told(document, collection, item), ensure_ascii=False, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    rest = data[HEADER + old_size : length]
    head = struct.pack("<4sIIII", data[:4], 2, HEADER + len(text) + len(rest), len(text), 0x4E4F534A)
    return head + text + rest


def _told(document: dict[str, Any], collection: Collection, item: Item) -> dict[str, Any]:
    """The document with the licence in its `asset`, and as a packet of XMP unless it has packets of its own."""
    asset = dict(document.get("asset", {}))
    asset.setdefault(
        "copyright", f"{item.licence} · {item.title.zh} · {item.title.en} · {collection.title.en}"
    )
    extras = asset.get("extras")
    asset["extras"] = {**(extras if isinstance(extras, dict) else {}), **_extras(collection, item)}
    used, extensions = document.get("extensionsUsed", []), document.get("extensions", {})
    if _XMP in used:
        return {**document, "asset": asset}
    asset["extensions"] = {**asset.get("extensions", {}), _XMP: {"packet": 0}}
    return {
        **document,
        "asset": asset,
        "extensionsUsed": [*used, _XMP],
        "extensions": {**extensions, _XMP: {"packets": [_packet(collection, item)]}},
    }


def _extras(collection: Collection, item: Item) -> dict[str, Any]:
    return {
        "title": item.title.as_json(),
        "licence": item.licence,
        "licence_address": item.rights,
        "rights": item.record.rights.as_json() if item.record.rights else None,
        "source": collection.page(item),
    }


def _packet(collection: Collection, item: Item) -> dict[str, Any]:
    packet: dict[str, Any] = {
        "@context": _CONTEXT,
        "@id": "",
        "dc:title": _alternatives(item.title),
        "dc:format": GLB,
        "dc:identifier": collection.page(item),
        "dc:rights": _alternatives(item.record.rights or Bilingual(zh=item.licence, en=item.licence)),
        "xmpRights:UsageTerms": _alternatives(Bilingual(zh=item.licence, en=item.licence)),
    }
    return {**packet, "xmpRights:WebStatement": item.rights} if item.rights else packet


def _alternatives(text: Bilingual) -> dict[str, Any]:
    """A text in both languages as XMP writes it."""
    en, zh = ({"@language": name, "@value": getattr(text, name)} for name in ("en", "zh"))
    return {"@type": "rdf:Alt", "rdf:_1": en, "rdf:_2": zh}
