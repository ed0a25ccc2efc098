"""LIDO 1.1, in which museums hand records on: a description for each language, rights, record and resources.

http://lido-schema.org/schema/v1.1/lido-v1.1.html; the order of elements is the schema's.
"""

from __future__ import annotations

from collections.abc import Iterator

from hall_app.content.schema.values import Bilingual
from hall_app.web.collection.markup import Node, document, node
from hall_app.web.collection.record import GLB, LANGUAGES, Collection, Item

__all__ = ["NAMESPACE", "SCHEMA", "lido", "lido_document", "lido_wrap"]

NAMESPACE = "http://www.lido-schema.org"
SCHEMA = "http://www.lido-schema.org/schema/v1.1/lido-v1.1.xsd"

_ROOT = {
    "xmlns:lido": NAMESPACE,
    "xmlns:xsi": "http://www.w3.org/2001/XMLSchema-instance",
    "xsi:schemaLocation": f"{NAMESPACE} {SCHEMA}",
}
# Of the LIDO terminology: what kind of identifier, category, event and record it is.
_TERMS = "http://terminology.lido-schema.org/"
_URI, _LOCAL = _TERMS + "lido00099", _TERMS + "lido00100"
_MADE_BY_HUMANS = (_TERMS + "lido00096", Bilingual(zh="人造物", en="Human-made object"))
_PRODUCTION = (_TERMS + "lido00007", Bilingual(zh="制作", en="Production"))
_ITEM_RECORD = (_TERMS + "lido00141", Bilingual(zh="单件著录", en="Item-level record"))

_KINDS = {
    "picture": Bilingual(zh="图像", en="Digital image"),
    "video": Bilingual(zh="影片", en="Video recording"),
    "audio": Bilingual(zh="声音", en="Sound recording"),
    "model": Bilingual(zh="三维模型", en="3-D model"),
}


def lido_document(collection: Collection, item: Item) -> bytes:
    """One exhibit's record as a document of its own, element lido:lido."""
    return document(lido(collection, item))


def lido_wrap(collection: Collection) -> bytes:
    """The records of all exhibits, element lido:lidoWrap."""
    return document(
        node("lido:lidoWrap", *(_record(collection, item) for item in collection.items), attributes=_ROOT)
    )


def lido(collection: Collection, item: Item) -> Node:
    """One exhibit's record, with the namespaces it needs."""
    record = _record(collection, item)
    return Node(record.name, _ROOT, record.children)


def _record(collection: Collection, item: Item) -> Node:
    return node(
        "lido:lido",
        _identifier("lido:lidoRecID", f"{collection.host}:{item.id}", _LOCAL),
        _identifier("lido:objectPublishedID", collection.page(item), _URI),
        _concept("lido:category", *_MADE_BY_HUMANS),
        *(_description(collection, item, language) for language in LANGUAGES),
        *(_administration(collection, item, language) for language in LANGUAGES),
    )


def _identifier(name: str, text: str, kind: str) -> Node:
    return node(name, text, attributes={"lido:type": kind})


def _concept(name: str, identity: str, term: Bilingual) -> Node:
    return node(name, _identifier("lido:conceptID", identity, _URI), *_terms(term))


def _terms(term: Bilingual) -> Iterator[Node]:
    for language in LANGUAGES:
        yield node("lido:term", getattr(term, language), lang=language)


def _description(collection: Collection, item: Item, lang: str) -> Node:
    kind = item.record.object or item.title
    work_type = node("lido:objectWorkType", node("lido:term", getattr(kind, lang), lang=lang))
    return node(
        "lido:descriptiveMetadata",
        node("lido:objectClassificationWrap", node("lido:objectWorkTypeWrap", work_type)),
        _identification(collection, item, lang),
        node("lido:eventWrap", node("lido:eventSet", _production(item, lang))),
        lang=lang,
    )


def _identification(collection: Collection, item: Item, lang: str) -> Node:
    record = item.record
    repository = node(
        "lido:repositorySet",
        _legal_body("lido:repositoryName", collection, lang),
        node("lido:workID", item.id),
    )
    notes = [item.caption, item.text, record.colour, record.wear, record.source, *_further(item)]
    measures = node(
        "lido:objectMeasurementsSet", _text("lido:displayObjectMeasurements", record.measurements, lang)
    )
    made_of = [_text("lido:displayMaterialsTech", text, lang) for text in (record.material, record.technique)]
    made_of = [node("lido:objectMaterialsTechSet", text) for text in made_of if text is not None]
    return node(
        "lido:objectIdentificationWrap",
        node("lido:titleWrap", node("lido:titleSet", _text("lido:appellationValue", item.title, lang))),
        node("lido:repositoryWrap", repository),
        node("lido:objectDescriptionWrap", *(_note(note, lang) for note in notes if note is not None)),
        node("lido:objectMeasurementsWrap", measures) if record.measurements else None,
        node("lido:objectMaterialsTechWrap", *made_of) if made_of else None,
    )


def _further(item: Item) -> Iterator[Bilingual]:
    """Lines of the record that have no element of their own, with their names."""
    for line in item.record.line:
        yield Bilingual(
            zh=f"{line.label.zh}：{line.value.zh}",
            en=f"{line.label.en}: {line.value.en}",
        )


def _text(name: str, text: Bilingual | None, lang: str) -> Node | None:
    return node(name, getattr(text, lang), lang=lang) if text is not None else None


def _note(text: Bilingual, lang: str) -> Node:
    return node("lido:objectDescriptionSet", _text("lido:descriptiveNoteValue", text, lang))


def _legal_body(name: str, collection: Collection, lang: str) -> Node:
    appellation = _text("lido:appellationValue", collection.title, lang)
    return node(
        name,
        node("lido:legalBodyName", appellation),
        node("lido:legalBodyWeblink", collection.at("/")),
    )


def _production(item: Item, lang: str) -> Node:
    record = item.record
    actor = _text("lido:displayActorInRole", record.maker, lang)
    culture = _text("lido:term", record.culture, lang)
    date = _text("lido:displayDate", record.date, lang)
    return node(
        "lido:event",
        _concept("lido:eventType", *_PRODUCTION),
        node("lido:eventActor", actor) if actor else None,
        node("lido:culture", culture) if culture else None,
        node("lido:eventDate", date) if date else None,
    )


def _administration(collection: Collection, item: Item, lang: str) -> Node:
    info = node(
        "lido:recordInfoSet",
        node("lido:recordInfoLink", collection.at(f"/collection/{item.id}/lido.xml")),
        node("lido:recordMetadataDate", item.changed.strftime("%Y-%m-%dT%H:%M:%SZ")),
    )
    return node(
        "lido:administrativeMetadata",
        node("lido:rightsWorkWrap", _rights("lido:rightsWorkSet", item, lang)),
        node(
            "lido:recordWrap",
            _identifier("lido:recordID", item.id, _LOCAL),
            _concept("lido:recordType", *_ITEM_RECORD),
            _legal_body("lido:recordSource", collection, lang),
            _rights("lido:recordRights", item, lang),
            info,
        ),
        node("lido:resourceWrap", *_resources(item, lang)),
        lang=lang,
    )


def _rights(name: str, item: Item, lang: str) -> Node:
    """The licence, and what the record says of it in words."""
    identity = _identifier("lido:conceptID", item.rights, _URI) if item.rights else None
    return node(
        name,
        node("lido:rightsType", identity, node("lido:term", item.licence)),
        _text("lido:creditLine", item.record.rights, lang),
    )


def _resources(item: Item, lang: str) -> Iterator[Node]:
    yield _resource(item, lang, "model", ((item.model.url, GLB),), item.title)
    for medium in item.media:
        links = tuple((source.url, source.type) for source in medium.sources)
        yield _resource(item, lang, medium.kind, links, medium.alt or medium.caption)


def _resource(
    item: Item, lang: str, kind: str, links: tuple[tuple[str, str], ...], words: Bilingual | None
) -> Node:
    """A resource in one or several formats. words: what it shows."""
    shown = [node("lido:linkResource", url, attributes={"lido:formatResource": told}) for url, told in links]
    return node(
        "lido:resourceSet",
        *(node("lido:resourceRepresentation", link) for link in shown),
        node("lido:resourceType", node("lido:term", getattr(_KINDS[kind], lang), lang=lang)),
        _text("lido:resourceDescription", words, lang),
        _rights("lido:rightsResource", item, lang),
    )
