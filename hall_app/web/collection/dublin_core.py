"""Dublin Core, the fifteen elements, as OAI-PMH wraps them (oai_dc): every text in both languages."""

from __future__ import annotations

from collections.abc import Iterator

from hall_app.content.schema.values import Bilingual
from hall_app.web.collection.markup import Node, document, node
from hall_app.web.collection.record import GLB, LANGUAGES, Collection, Item

__all__ = ["NAMESPACE", "SCHEMA", "dublin_core", "dublin_core_document"]

NAMESPACE = "http://www.openarchives.org/OAI/2.0/oai_dc/"
SCHEMA = "http://www.openarchives.org/OAI/2.0/oai_dc.xsd"

_ROOT = {
    "xmlns:oai_dc": NAMESPACE,
    "xmlns:dc": "http://purl.org/dc/elements/1.1/",
    "xmlns:xsi": "http://www.w3.org/2001/XMLSchema-instance",
    "xsi:schemaLocation": f"{NAMESPACE} {SCHEMA}",
}


def dublin_core_document(collection: Collection, item: Item) -> bytes:
    """The exhibit's record as a document of its own."""
    return document(dublin_core(collection, item))


def dublin_core(collection: Collection, item: Item) -> Node:
    """The exhibit's record: element oai_dc:dc."""
    record = item.record
    texts = [
        ("title", item.title),
        ("creator", record.maker),
        ("subject", record.object),
        ("subject", record.culture),
        ("description", item.caption),
        ("description", item.text),
        ("publisher", collection.title),
        ("date", record.date),
        ("type", record.object),
        ("format", record.material),
        ("format", record.technique),
        ("format", record.measurements),
        ("source", record.source),
        ("coverage", record.culture),
        ("rights", record.rights),
    ]
    plain = [
        ("type", "InteractiveResource"),  # DCMI's own list of types knows no 3-D model
        ("format", GLB),
        ("identifier", collection.page(item)),
        ("identifier", collection.at(f"/iiif/3/{item.id}/manifest")),
        ("relation", item.model.url),
        *(("language", language) for language in LANGUAGES),
        ("rights", item.rights or item.licence),
    ]
    told = [element for name, text in texts for element in _both(name, text)]
    return node("oai_dc:dc", *told, *(node(f"dc:{name}", text) for name, text in plain), attributes=_ROOT)


def _both(name: str, text: Bilingual | None) -> Iterator[Node]:
    if text is not None:
        for language in LANGUAGES:
            yield node(f"dc:{name}", getattr(text, language), lang=language)
