"""IIIF Presentation 3.0: a manifest an exhibit, its pictures as canvases and its model to download, and a collection.

https://iiif.io/api/presentation/3.0/
"""

from __future__ import annotations

from typing import Any

from hall_app.content.schema.values import Bilingual
from hall_app.web.collection.record import GLB, LANGUAGES, Collection, Item, Medium, Source

__all__ = ["CONTEXT", "collection_document", "language_map", "manifest", "manifest_reference", "told"]

CONTEXT = "http://iiif.io/api/presentation/3/context.json"
MEDIA_TYPE = f'application/ld+json;profile="{CONTEXT}"'
EMPTY_CANVAS = 1000  # [pixels] a side, of an exhibit without pictures: a manifest holds one canvas at least

_TYPES = {"picture": "Image", "video": "Video", "audio": "Sound"}
_MODEL = Bilingual(zh="三维模型（GLB）", en="3-D model (GLB)")
_RIGHTS = Bilingual(zh="权利", en="Rights")
_PAGES = {"zh": "目录中的展品", "en": "The exhibit in the catalogue"}
_HALL = Bilingual(zh="进入展厅", en="Enter the hall")


def language_map(text: Bilingual) -> dict[str, list[str]]:
    """A text of both languages as IIIF writes it."""
    return {"zh": [text.zh], "en": [text.en]}


def collection_document(collection: Collection) -> dict[str, Any]:
    """The collection of all manifests."""
    identity = collection.at("/iiif/3/collection")
    return {
        "@context": CONTEXT,
        "id": identity,
        "type": "Collection",
        "label": language_map(collection.title),
        "summary": language_map(collection.about or collection.subtitle),
        "provider": _provider(collection),
        "homepage": [_link(collection.at("/"), "Text", "text/html", _HALL)],
        "items": [manifest_reference(collection, item, version=3) for item in collection.items],
    }


def manifest_reference(collection: Collection, item: Item, *, version: int) -> dict[str, Any]:
    """A manifest as a collection names it."""
    found = {
        "id": collection.at(f"/iiif/{version}/{item.id}/manifest"),
        "type": "Manifest",
        "label": language_map(item.title),
    }
    return found | _thumbnail(item)


def manifest(collection: Collection, item: Item) -> dict[str, Any]:
    """The exhibit's manifest."""
    identity = collection.at(f"/iiif/3/{item.id}/manifest")
    pictures = list(item.pictures)
    canvases = [_canvas(identity, number, *picture) for number, picture in enumerate(pictures, 1)]
    return {
        "@context": CONTEXT,
        "id": identity,
        "type": "Manifest",
        "label": language_map(item.title),
        **told(collection, item),
        "rendering": _renderings(item),
        "items": canvases or [_empty_canvas(identity, item)],
        "partOf": [{"id": collection.at("/iiif/3/collection"), "type": "Collection"}],
    }


def told(collection: Collection, item: Item) -> dict[str, Any]:
    """What a manifest of either version tells of the exhibit beside its label and its items."""
    rights = item.record.rights or Bilingual(zh=item.licence, en=item.licence)
    pages = [
        {
            "id": collection.at(f"/catalogue?lang={language}#exhibit-{item.id}"),
            "type": "Text",
            "label": {language: [_PAGES[language]]},
            "format": "text/html",
            "language": [language],
        }
        for language in LANGUAGES
    ]
    found: dict[str, Any] = {
        "summary": language_map(item.caption or item.text),
        "metadata": [{"label": language_map(a), "value": language_map(b)} for a, b in item.lines()],
        "requiredStatement": {"label": language_map(_RIGHTS), "value": language_map(rights)},
        "provider": _provider(collection),
        "homepage": pages,
        "seeAlso": _see_also(collection, item),
        **_thumbnail(item),
    }
    return {**found, "rights": item.rights} if item.rights else found


def _provider(collection: Collection) -> list[dict[str, Any]]:
    home = _link(collection.at("/"), "Text", "text/html", collection.title)
    about = {"id": collection.at("/"), "type": "Agent", "label": language_map(collection.title)}
    return [{**about, "homepage": [home]}]


def _link(address: str, kind: str, media_type: str, label: Bilingual) -> dict[str, Any]:
    return {"id": address, "type": kind, "format": media_type, "label": language_map(label)}


def _see_also(collection: Collection, item: Item) -> list[dict[str, Any]]:
    """The same exhibit in the other formats."""
    base = collection.at(f"/collection/{item.id}")
    return [
        {
            "id": f"{base}/lido.xml",
            "type": "Dataset",
            "label": {"none": ["LIDO 1.1"]},
            "format": "application/xml",
            "profile": "http://www.lido-schema.org",
        },
        {
            "id": f"{base}/dc.xml",
            "type": "Dataset",
            "label": {"none": ["Dublin Core"]},
            "format": "application/xml",
            "profile": "http://www.openarchives.org/OAI/2.0/oai_dc/",
        },
        {
            "id": f"{base}/schema.jsonld",
            "type": "Dataset",
            "label": {"none": ["schema.org"]},
            "format": "application/ld+json",
            "profile": "https://schema.org",
        },
    ]


def _thumbnail(item: Item) -> dict[str, Any]:
    if item.thumbnail is None:
        return {}
    return {"thumbnail": [{"id": item.thumbnail.url, "type": "Image", "format": item.thumbnail.type}]}


def _renderings(item: Item) -> list[dict[str, Any]]:
    """What is shown by another program, or downloaded: the model, films, sounds, drawings without pixels."""
    found = [_link(item.model.url, "Model", GLB, _MODEL)]
    for medium in item.media:
        whole = medium.kind != "picture" or not medium.sources[0].width
        for source in medium.sources if whole else ():
            label = medium.label or item.title
            found.append(_link(source.url, _TYPES[medium.kind], source.type, label))
    return found


def _canvas(manifest: str, number: int, medium: Medium, source: Source) -> dict[str, Any]:
    """A picture, as large as it is."""
    identity = f"{manifest}/canvas/{number}"
    size = {"width": source.width, "height": source.height}
    body = {"id": source.url, "type": "Image", "format": source.type, **size}
    painting = {
        "id": f"{identity}/painting",
        "type": "Annotation",
        "motivation": "painting",
        "body": body,
        "target": identity,
    }
    label = {"label": language_map(medium.label)} if medium.label else {"label": {"none": [str(number)]}}
    summary = {"summary": language_map(medium.alt)} if medium.alt else {}
    page = {"id": f"{identity}/page", "type": "AnnotationPage", "items": [painting]}
    return {"id": identity, "type": "Canvas", **label, **summary, **size, "items": [page]}


def _empty_canvas(manifest: str, item: Item) -> dict[str, Any]:
    size = {"width": EMPTY_CANVAS, "height": EMPTY_CANVAS}
    identity = f"{manifest}/canvas/1"
    return {"id": identity, "type": "Canvas", "label": language_map(item.title), **size, "items": []}
