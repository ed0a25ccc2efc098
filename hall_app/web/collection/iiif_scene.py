"""IIIF Presentation 4.0, a draft: the exhibit's model in a Scene. What the final text changes is changed here.

https://preview.iiif.io/api/prezi-4/presentation/4.0/; the manifests of version 3 are what viewers read today.
"""

from __future__ import annotations

from typing import Any

from hall_app.content.schema.values import Bilingual
from hall_app.web.collection.iiif import language_map, manifest_reference, told
from hall_app.web.collection.record import GLB, Collection, Item

__all__ = ["CONTEXT", "scene_collection", "scene_manifest"]

CONTEXT = "http://iiif.io/api/presentation/4/context.json"
MEDIA_TYPE = f'application/ld+json;profile="{CONTEXT}"'

_DRAFT = {
    "label": language_map(Bilingual(zh="格式", en="Format")),
    "value": language_map(
        Bilingual(
            zh="IIIF Presentation 4.0 草案，可能更改", en="IIIF Presentation 4.0, a draft that may change"
        )
    ),
}


def scene_collection(collection: Collection) -> dict[str, Any]:
    """The collection of all manifests of version 4."""
    return {
        "@context": CONTEXT,
        "id": collection.at("/iiif/4/collection"),
        "type": "Collection",
        "label": language_map(collection.title),
        "metadata": [_DRAFT],
        "items": [manifest_reference(collection, item, version=4) for item in collection.items],
    }


def scene_manifest(collection: Collection, item: Item) -> dict[str, Any]:
    """The exhibit as one Scene, its model at the origin: metres, y up, its foot at y = 0.

    Viewers add camera and light where a Scene has none.
    """
    identity = collection.at(f"/iiif/4/{item.id}/manifest")
    scene = f"{identity}/scene"
    painting = {
        "id": f"{scene}/painting",
        "type": "Annotation",
        "motivation": ["painting"],
        "body": {"id": item.model.url, "type": "Model", "format": GLB, "label": language_map(item.title)},
        "target": {"id": scene, "type": "Scene"},
    }
    page = {"id": f"{scene}/page", "type": "AnnotationPage", "items": [painting]}
    about = told(collection, item)
    return {
        "@context": CONTEXT,
        "id": identity,
        "type": "Manifest",
        "label": language_map(item.title),
        **about,
        "metadata": [*about["metadata"], _DRAFT],
        "items": [{"id": scene, "type": "Scene", "label": language_map(item.title), "items": [page]}],
        "partOf": [{"id": collection.at("/iiif/4/collection"), "type": "Collection"}],
    }
