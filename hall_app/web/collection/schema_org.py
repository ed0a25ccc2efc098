"""schema.org as JSON-LD, which search engines read: works with their models, the hall as a museum, what it shows.

https://schema.org/VisualArtwork, /3DModel, /ExhibitionEvent, /Museum
"""

from __future__ import annotations

import json
from typing import Any

from hall_app.content.schema.values import Bilingual
from hall_app.web.collection.record import GLB, LANGUAGES, Collection, Item, Medium

__all__ = ["MEDIA_TYPE", "artwork", "hall_graph", "in_page", "whole_graph"]

MEDIA_TYPE = "application/ld+json"
_CONTEXT = "https://schema.org"
_MEDIA = {"video": "VideoObject", "audio": "AudioObject"}

Thing = dict[str, Any]


def whole_graph(collection: Collection) -> Thing:
    """The hall, its exhibition and every exhibit."""
    works = [_artwork(collection, item) for item in collection.items]
    return {"@context": _CONTEXT, "@graph": [_museum(collection), _exhibition(collection), *works]}


def hall_graph(collection: Collection) -> Thing:
    """The hall and its exhibition alone."""
    return {"@context": _CONTEXT, "@graph": [_museum(collection), _exhibition(collection)]}


def artwork(collection: Collection, item: Item) -> Thing:
    """One exhibit."""
    return {"@context": _CONTEXT, **_artwork(collection, item)}


def in_page(thing: Thing) -> str:
    """A script element of a page. No sign of the texts can end it, or begin anything else."""
    text = json.dumps(thing, ensure_ascii=False, separators=(",", ":"))
    for sign in "<>&\u2028\u2029":
        text = text.replace(sign, f"\\u{ord(sign):04x}")
    return f'<script type="{MEDIA_TYPE}">{text}</script>'


def _both(text: Bilingual | None) -> list[dict[str, str]] | None:
    """A text of both languages as JSON-LD writes it."""
    if text is None:
        return None
    return [{"@language": language, "@value": getattr(text, language)} for language in LANGUAGES]


def _told(**properties: Any) -> Thing:
    """A thing of what is known of it."""
    return {name: value for name, value in properties.items() if value not in (None, [], "")}


def _museum_name(collection: Collection) -> str:
    return collection.at("/#museum")


def _museum(collection: Collection) -> Thing:
    about = _told(
        name=_both(collection.title),
        alternateName=_both(collection.subtitle),
        description=_both(collection.about),
        url=collection.at("/"),
        email=collection.contact,
        isAccessibleForFree=True,
    )
    return {"@type": "Museum", "@id": _museum_name(collection), **about}


def _exhibition(collection: Collection) -> Thing:
    about = _told(
        name=_both(collection.title),
        description=_both(collection.about or collection.subtitle),
        url=collection.at("/"),
        location={"@type": "VirtualLocation", "url": collection.at("/")},
        eventAttendanceMode="https://schema.org/OnlineEventAttendanceMode",
        organizer={"@id": _museum_name(collection)},
        isAccessibleForFree=True,
        inLanguage=list(LANGUAGES),
        workFeatured=[{"@id": collection.page(item)} for item in collection.items],
    )
    return {"@type": "ExhibitionEvent", "@id": collection.at("/#exhibition"), **about}


def _artwork(collection: Collection, item: Item) -> Thing:
    record = item.record
    keywords = [words for text in (record.culture, record.colour) for words in _both(text) or ()]
    about = _told(
        name=_both(item.title),
        description=_both(item.caption or item.text),
        abstract=_both(item.text) if item.caption else None,
        url=collection.page(item),
        artform=_both(record.object),
        artMedium=[*(_both(record.material) or ()), *(_both(record.technique) or ())],
        size=_both(record.measurements),
        temporalCoverage=_both(record.date),
        keywords=keywords,
        creator=_told(**{"@type": "Organization", "name": _both(record.maker)}) if record.maker else None,
        isBasedOn={"@type": "CreativeWork", "description": _both(record.source)} if record.source else None,
        license=item.rights or item.licence,
        copyrightNotice=_both(record.rights),
        dateModified=item.changed.strftime("%Y-%m-%dT%H:%M:%SZ"),
        inLanguage=list(LANGUAGES),
        isAccessibleForFree=True,
        publisher={"@id": _museum_name(collection)},
        thumbnailUrl=item.thumbnail.url if item.thumbnail else None,
        image=[_image(item, medium) for medium in item.media if medium.kind == "picture"],
        associatedMedia=[_model(item), *(_played(item, m) for m in item.media if m.kind != "picture")],
    )
    return {"@type": "VisualArtwork", "@id": collection.page(item), **about}


def _model(item: Item) -> Thing:
    about = _told(
        name=_both(item.title),
        contentUrl=item.model.url,
        encodingFormat=GLB,
        contentSize=f"{item.model.size} B",
        license=item.rights or item.licence,
    )
    return {"@type": "3DModel", **about}


def _image(item: Item, medium: Medium) -> Thing:
    source = medium.sources[0]
    about = _told(
        contentUrl=source.url,
        encodingFormat=source.type,
        width=source.width or None,
        height=source.height or None,
        caption=_both(medium.caption),
        description=_both(medium.alt),
        license=item.rights or item.licence,
    )
    return {"@type": "ImageObject", **about}


def _played(item: Item, medium: Medium) -> Thing:
    """A film or a sound, in its first format."""
    source = medium.sources[0]
    about = _told(
        name=_both(medium.label or item.title),
        description=_both(medium.alt or medium.label or item.title),
        contentUrl=source.url,
        encodingFormat=source.type,
        thumbnailUrl=medium.poster,
        uploadDate=item.changed.strftime("%Y-%m-%dT%H:%M:%SZ"),
        license=item.rights or item.licence,
    )
    return {"@type": _MEDIA[medium.kind], **about}
