"""The collection as IIIF, LIDO, Dublin Core, schema.org and GLB: read by others' readers, and as their texts ask."""

from __future__ import annotations

import importlib
import io
import json
import os
import re
import warnings
from dataclasses import replace
from pathlib import Path

import pytest
from collection_grammars import LIDO, XML, lido_faults
from content_house import EXHIBIT, edit, make_house
from hypothesis import given, settings
from lxml import etree
from museum import ADDRESS, HOSTILE, both, collection, museum, read

from hall_app.content.schema import Bilingual, Record
from hall_app.web import collection as formats
from hall_app.web.collection import Collection, Item, document, licence_address, node

ASSETS = Path(__file__).parents[2] / "assets"
DC = "{http://purl.org/dc/elements/1.1/}"
ELEMENTS = set(
    "title creator subject description publisher contributor date type format identifier source language relation"
    " coverage rights".split()
)


@pytest.fixture(scope="module")
def shipped() -> Collection:
    return collection(read(ASSETS))


def hostile(shipped: Collection, zh: str, en: str) -> tuple[Collection, Item]:
    """An exhibit whose every text is one of these."""
    pair = Bilingual(zh=zh, en=en)
    record = Record.model_validate(
        {name: both(zh, en) for name in Record.model_fields if name != "line"}
        | {"line": [{"label": both(zh, en), "value": both(zh, en)}]}
    )
    media = tuple(replace(medium, alt=pair, caption=pair) for medium in shipped.items[0].media)
    item = replace(
        shipped.items[0], title=pair, caption=pair, text=pair, record=record, media=media, licence=zh
    )
    return replace(shipped, title=pair, about=pair, items=(item,)), item


# IIIF


def test_manifests_of_version_3_are_read_by_another_reader(shipped):
    reason = "not installed: it pins Pillow to 12.0, so install it alone (pip install --no-deps iiif-prezi3)"
    if os.environ.get("HALL_IIIF") == "required":
        prezi = importlib.import_module("iiif_prezi3")
    else:
        prezi = pytest.importorskip("iiif_prezi3", reason=reason)
    assert len(prezi.Collection.model_validate(formats.collection_document(shipped)).items) == len(
        shipped.items
    )
    for item in shipped.items:
        found = prezi.Manifest.model_validate(formats.manifest(shipped, item))
        assert len(found.items) == len(list(item.pictures))


def test_a_manifest_holds_the_pictures_as_large_as_they_are_and_the_model(shipped):
    for item in shipped.items:
        manifest = formats.manifest(shipped, item)
        assert manifest["@context"] == "http://iiif.io/api/presentation/3/context.json"
        assert manifest["label"] == {"zh": [item.title.zh], "en": [item.title.en]}
        assert manifest["rights"] == "http://creativecommons.org/publicdomain/zero/1.0/"
        assert manifest["requiredStatement"]["value"]["en"] == [item.record.rights.en]
        assert manifest["rendering"][0]["type"] == "Model"
        assert manifest["rendering"][0]["id"] == f"{ADDRESS}/collection/{item.id}/model.glb"
        assert [line["value"]["zh"] for line in manifest["metadata"]] == [[b.zh] for _, b in item.lines()]
        pictures = list(item.pictures)
        assert len(manifest["items"]) == len(pictures)
        for canvas, (medium, source) in zip(manifest["items"], pictures, strict=True):
            painting = canvas["items"][0]["items"][0]
            assert painting["motivation"] == "painting"
            assert painting["target"] == canvas["id"]
            assert (canvas["width"], canvas["height"]) == (source.width, source.height)
            assert painting["body"]["id"] == source.url
            assert canvas["summary"]["en"] == [medium.alt.en]


def test_every_part_has_an_address_of_its_own(shipped):
    for item in shipped.items:
        for found in (formats.manifest(shipped, item), formats.scene_manifest(shipped, item)):
            own = [thing["id"] for thing in parts(found) if thing.get("type") in OWN]
            assert len(own) == len(set(own))
            assert all(identity.startswith(ADDRESS + "/iiif/") for identity in own)


OWN = ("Manifest", "Canvas", "Scene", "AnnotationPage", "Annotation")


def parts(value, key: str = ""):
    """Every thing of a IIIF document but references to others."""
    if isinstance(value, dict):
        if key not in ("target", "partOf"):
            yield value
        for name, inside in value.items():
            if name not in ("target", "partOf"):
                yield from parts(inside, name)
    elif isinstance(value, list):
        for inside in value:
            yield from parts(inside, key)


def test_version_4_is_a_scene_with_the_model_and_says_that_it_is_a_draft(shipped):
    """After the text and the JSON schemas of the draft: motivation is a list, target a thing with its type."""
    for item in shipped.items:
        found = formats.scene_manifest(shipped, item)
        assert found["@context"] == "http://iiif.io/api/presentation/4/context.json"
        (scene,) = found["items"]
        (page,) = scene["items"]
        (painting,) = page["items"]
        assert scene["type"] == "Scene"
        assert painting["motivation"] == ["painting"]
        assert painting["target"] == {"id": scene["id"], "type": "Scene"}
        assert painting["body"]["type"] == "Model"
        assert painting["body"]["format"] == "model/gltf-binary"
        assert painting["body"]["id"] == item.model.url
        assert any("draft" in line["value"]["en"][0] for line in found["metadata"])
    whole = formats.scene_collection(shipped)
    assert [entry["id"] for entry in whole["items"]] == [
        f"{ADDRESS}/iiif/4/{item.id}/manifest" for item in shipped.items
    ]


def test_an_exhibit_without_pictures_has_a_canvas_all_the_same(tmp_path):
    bare = re.sub(r"\[\[media\]\].*", "", EXHIBIT, flags=re.DOTALL)
    content = museum(tmp_path, bare)
    found = collection(content)
    (canvas,) = formats.manifest(found, found.items[0])["items"]
    assert canvas["width"] > 0
    assert canvas["items"] == []
    assert "thumbnail" not in formats.manifest(found, found.items[0])


# LIDO


def test_lido_is_built_as_its_schema_says(shipped):
    whole = etree.fromstring(formats.lido_wrap(shipped))
    assert lido_faults(whole) == []
    assert len(whole) == len(shipped.items)
    for item in shipped.items:
        root = etree.fromstring(formats.lido_document(shipped, item))
        assert root.tag == f"{LIDO}lido"
        assert lido_faults(root) == []
        told = {d.get(f"{XML}lang"): d for d in root.iter(f"{LIDO}descriptiveMetadata")}
        assert set(told) == {"zh", "en"}
        for language, described in told.items():
            assert described.findtext(f".//{LIDO}titleSet/{LIDO}appellationValue") == getattr(
                item.title, language
            )
            tagged = [e.get(f"{XML}lang") for e in described.iter() if e.tag in NOTES]
            assert set(tagged) == {language}
        rights = root.findall(f".//{LIDO}rightsType/{LIDO}conceptID")
        assert {found.text for found in rights} == {"http://creativecommons.org/publicdomain/zero/1.0/"}
        links = {found.text for found in root.iter(f"{LIDO}linkResource")}
        assert item.model.url in links
        assert {source.url for medium in item.media for source in medium.sources} <= links


NOTES = (f"{LIDO}descriptiveNoteValue", f"{LIDO}displayMaterialsTech", f"{LIDO}displayDate")


def test_a_wrong_order_of_lido_is_found(shipped):
    root = etree.fromstring(formats.lido_document(shipped, shipped.items[0]))
    root.append(root[0])
    assert lido_faults(root)
    assert lido_faults(etree.fromstring(f'<lido xmlns="{LIDO[1:-1]}"><strange/></lido>'))


# Dublin Core


def test_dublin_core_has_the_fifteen_elements_alone(shipped):
    for item in shipped.items:
        root = etree.fromstring(formats.dublin_core_document(shipped, item))
        assert root.tag == "{http://www.openarchives.org/OAI/2.0/oai_dc/}dc"
        assert {child.tag.removeprefix(DC) for child in root} <= ELEMENTS
        assert all(child.text and not len(child) for child in root)
        titles = {child.get(f"{XML}lang"): child.text for child in root.findall(f"{DC}title")}
        assert titles == {"zh": item.title.zh, "en": item.title.en}
        assert "http://creativecommons.org/publicdomain/zero/1.0/" in [
            c.text for c in root.findall(f"{DC}rights")
        ]
        assert item.record.rights.zh in [c.text for c in root.findall(f"{DC}rights")]


# schema.org


def triples(thing: dict):
    """The graph another reader of JSON-LD makes of it, offline: schema.org's context is a vocabulary and types."""
    from rdflib import Graph

    assert thing["@context"] == "https://schema.org"
    # rdflib's own reader of JSON-LD still makes the graph that rdflib calls deprecated.
    warnings.filterwarnings("ignore", "ConjunctiveGraph is deprecated", DeprecationWarning)
    return Graph().parse(
        data=json.dumps({**thing, "@context": {"@vocab": "https://schema.org/"}}), format="json-ld"
    )


def test_schema_org_uses_words_that_are_there(shipped):
    from rdflib import RDF
    from rdflib.namespace import SDO

    graph = triples(formats.whole_graph(shipped))
    types = {str(kind).removeprefix("https://schema.org/") for kind in graph.objects(None, RDF.type)}
    assert {"VisualArtwork", "3DModel", "ExhibitionEvent", "Museum"} <= types
    # rdflib's list of schema.org is made of Python names, so the one that begins with a digit is not in it.
    assert [kind for kind in types - {"3DModel"} if kind not in SDO] == []
    assert [str(used) for used in set(graph.predicates()) if used != RDF.type and used not in SDO] == []


def test_schema_org_says_both_languages_and_the_licence(shipped):
    from rdflib import Literal, URIRef
    from rdflib.namespace import SDO

    for item in shipped.items:
        graph = triples(formats.artwork(shipped, item))
        work = URIRef(shipped.page(item))
        assert set(graph.objects(work, SDO.name)) == {
            Literal(item.title.zh, lang="zh"),
            Literal(item.title.en, lang="en"),
        }
        assert set(graph.objects(work, SDO.license)) == {Literal(item.rights)}
        models = [m for m in graph.objects(work, SDO.associatedMedia)]
        assert Literal(item.model.url) in [graph.value(m, SDO.contentUrl) for m in models]


# GLB


def test_a_model_carries_its_licence_and_is_the_same_model(shipped):
    import trimesh

    from sim_core.gltf import glb_parts

    for item in shipped.items:
        data = item.model.path.read_bytes()
        licensed = formats.licensed_glb(data, shipped, item)
        before, after = glb_parts(data), glb_parts(licensed)
        asset = after.document["asset"]
        assert asset["copyright"].startswith("CC0-1.0")
        assert asset["extras"]["title"] == {"zh": item.title.zh, "en": item.title.en}
        assert asset["extras"]["licence_address"] == item.rights
        (packet,) = after.document["extensions"]["KHR_xmp_json_ld"]["packets"]
        assert packet["dc:title"]["rdf:_2"] == {"@language": "zh", "@value": item.title.zh}
        assert packet["xmpRights:WebStatement"] == item.rights
        assert "KHR_xmp_json_ld" in after.document["extensionsUsed"]
        assert "KHR_xmp_json_ld" not in after.document.get("extensionsRequired", [])
        kept = set(before.document) - {"asset", "extensions", "extensionsUsed"}
        assert {key: before.document[key] for key in kept} == {key: after.document[key] for key in kept}
        assert licensed[after.begin :] == data[before.begin :]
        assert int.from_bytes(licensed[8:12], "little") == len(licensed)
        assert len(licensed) % 4 == 0
    first = shipped.items[0].model.path.read_bytes()
    scenes = [trimesh.load(io.BytesIO(data), file_type="glb") for data in (first, licensed_of(shipped))]
    assert scenes[0].bounds.tolist() == scenes[1].bounds.tolist()


def licensed_of(shipped: Collection) -> bytes:
    return formats.licensed_glb(shipped.items[0].model.path.read_bytes(), shipped, shipped.items[0])


def test_what_a_model_says_of_its_copyright_stays(tmp_path):
    from content_house import rewritten

    from sim_core.gltf import glb_parts

    house = make_house(tmp_path)
    path = rewritten(house, lambda d: d["asset"].update(copyright="© a museum", extras={"number": 7}))
    found = collection(read(house))
    asset = glb_parts(formats.licensed_glb(path.read_bytes(), found, found.items[0])).document["asset"]
    assert asset["copyright"] == "© a museum"
    assert asset["extras"]["number"] == 7
    assert asset["extras"]["licence"] == "CC0-1.0"


# All of them


@settings(max_examples=60, deadline=None)
@given(zh=HOSTILE, en=HOSTILE)
def test_hostile_texts_break_no_document(shipped, zh: str, en: str):
    found, item = hostile(shipped, zh, en)
    for made in (formats.lido_document, formats.dublin_core_document):
        root = etree.fromstring(made(found, item))
        texts = {element.text for element in root.iter() if element.text and element.text.strip("\n ")}
        assert {clean(zh), clean(en)} <= texts
    assert lido_faults(etree.fromstring(formats.lido_wrap(found))) == []
    assert json.loads(json.dumps(formats.manifest(found, item)))["label"] == {"zh": [zh], "en": [en]}
    element = formats.in_page(formats.artwork(found, item))
    inside = element.removeprefix('<script type="application/ld+json">').removesuffix("</script>")
    assert not re.search("[<>&]", inside)
    assert json.loads(inside)["name"][0]["@value"] == zh


def clean(text: str) -> str:
    """What XML can hold of it."""
    kept = (sign in "\t\n\r" or "\x20" <= sign < "\ufffe" or sign > "\uffff" for sign in text)
    return "".join(sign if keep else "\ufffd" for sign, keep in zip(text, kept, strict=True))


@given(text=HOSTILE)
def test_attributes_come_back_as_texts_do(text: str):
    root = etree.fromstring(document(node("a", node("b", text), attributes={"c": text})))
    assert root.get("c") == clean(text)
    assert root[0].text == clean(text)


@pytest.mark.parametrize(
    ("written", "address"),
    [
        ("CC0-1.0", "http://creativecommons.org/publicdomain/zero/1.0/"),
        ("cc-by-sa-4.0", "http://creativecommons.org/licenses/by-sa/4.0/"),
        ("CC-BY-NC-ND-3.0", "http://creativecommons.org/licenses/by-nc-nd/3.0/"),
        ("https://rightsstatements.org/vocab/InC/1.0/", "http://rightsstatements.org/vocab/InC/1.0/"),
        ("Apache-2.0", None),
        ("all rights reserved", None),
        ("https://evil.example/creativecommons.org/licenses/by/4.0/", None),
        ("CC-BY", None),
    ],
)
def test_addresses_of_licences(written: str, address: str | None):
    assert licence_address(written) == address


def test_a_licence_without_an_address_is_told_in_words(tmp_path):
    content = museum(tmp_path, EXHIBIT.replace("CC0-1.0", "All rights reserved"))
    found = collection(content)
    item = found.items[0]
    manifest = formats.manifest(found, item)
    assert "rights" not in manifest
    assert manifest["requiredStatement"]["value"]["en"] == ["All rights reserved"]
    assert formats.artwork(found, item)["license"] == "All rights reserved"
    assert b"<dc:rights>All rights reserved</dc:rights>" in formats.dublin_core_document(found, item)
    assert b"<lido:term>All rights reserved</lido:term>" in formats.lido_document(found, item)


def test_the_address_that_the_hall_states_goes_before_the_one_asked(tmp_path):
    house = make_house(tmp_path)
    edit(
        house / "hall.toml",
        'licence = "CC0-1.0"',
        'licence = "CC0-1.0"\naddress = "https://museum.example/hall/"',
    )
    found = collection(read(house), "http://127.0.0.1:8000")
    assert found.at("/oai") == "https://museum.example/hall/oai"
    assert found.host == "museum.example"
    assert found.items[0].model.url.startswith("https://museum.example/hall/collection/")


@pytest.mark.parametrize(
    ("key", "value", "remedy"),
    [
        ("address", "hall.example.org", "https://hall.example.org"),
        ("address", "https://a.example/?x=1", "without ?"),
        ("contact", "nobody", "collection@example.org"),
    ],
)
def test_what_is_wrong_with_address_and_contact_is_said(tmp_path, key, value, remedy):
    from hall_app.content import ContentError, load

    house = make_house(tmp_path)
    edit(house / "hall.toml", 'licence = "CC0-1.0"', f'licence = "CC0-1.0"\n{key} = "{value}"')
    with pytest.raises(ContentError, match=f"hall.toml: {key}") as refused:
        load(house)
    assert remedy in str(refused.value)


def test_a_record_is_as_new_as_the_newest_file_it_is_made_of(tmp_path):
    import os

    house = make_house(tmp_path)
    for path in house.rglob("*"):
        os.utime(path, (1_700_000_000, 1_700_000_000))
    assert collection(read(house)).items[0].changed.timestamp() == 1_700_000_000
    os.utime(house / "exhibits/chest/text.en.md", (1_700_000_100.9, 1_700_000_100.9))
    assert collection(read(house)).items[0].changed.timestamp() == 1_700_000_100


def test_texts_are_told_without_marks(tmp_path):
    content = museum(tmp_path)
    (tmp_path / "exhibits/chest/text.en.md").write_text(
        "# One\n\n*two* `three`\nfour ![five](media/front.jpg)\n\n- six\n\n| a | b |\n|-|-|\n| c | d |\n",
        "utf-8",
    )
    item = collection(read(tmp_path)).items[0]
    assert item.text.en.splitlines() == ["One", "two three four", "six", "a · b", "c · d"]
    assert item.text.zh == "一只箱子。"
    assert content.exhibits[0].text_en
