"""The collection's addresses on a running hall: types, heads, both ways of OAI-PMH, the catalogue's own data."""

from __future__ import annotations

import json
import re
import urllib.error
import urllib.parse
import urllib.request

import pytest
from collection_grammars import lido_faults, oai_faults
from lxml import etree

from sim_core.gltf import glb_parts

IIIF = 'application/ld+json;profile="http://iiif.io/api/presentation/{}/context.json"'
ADDRESSES = {
    "/iiif/3/collection": IIIF.format(3),
    "/iiif/3/box/manifest": IIIF.format(3),
    "/iiif/4/collection": IIIF.format(4),
    "/iiif/4/box/manifest": IIIF.format(4),
    "/collection/lido.xml": "application/xml; charset=utf-8",
    "/collection/box/lido.xml": "application/xml; charset=utf-8",
    "/collection/box/dc.xml": "application/xml; charset=utf-8",
    "/collection/schema.jsonld": "application/ld+json",
    "/collection/box/schema.jsonld": "application/ld+json",
    "/collection/table.csv": "text/csv; charset=utf-8",
    "/collection/box/model.glb": "model/gltf-binary",
    "/oai?verb=Identify": "text/xml; charset=utf-8",
}


def answer(url: str, data: bytes | None = None, **heads: str):
    """(heads, body)."""
    asked = urllib.request.Request(
        url, data, {name.replace("_", "-"): value for name, value in heads.items()}
    )
    with urllib.request.urlopen(asked, timeout=30) as got:
        return got.headers, got.read()


@pytest.mark.parametrize("path", ADDRESSES)
def test_every_address_answers_others_pages_too(plain_hall, path):
    heads, body = answer(plain_hall.url + path)
    assert heads["Content-Type"] == ADDRESSES[path]
    assert heads["Access-Control-Allow-Origin"] == "*"
    assert heads["X-Content-Type-Options"] == "nosniff"
    assert body
    if "json" in heads["Content-Type"]:
        assert plain_hall.url.encode() in body, "addresses are whole"
        json.loads(body)
    if "xml" in heads["Content-Type"]:
        etree.fromstring(body)


@pytest.mark.parametrize("path", [path for path in ADDRESSES if "box" in path])
def test_nobody_is_not_found(plain_hall, path):
    with pytest.raises(urllib.error.HTTPError) as refused:
        answer(plain_hall.url + path.replace("box", "nobody"))
    with refused.value as got:
        assert got.code == 404


def test_every_address_that_a_manifest_names_is_there(plain_hall):
    for version in (3, 4):
        _, body = answer(f"{plain_hall.url}/iiif/{version}/box/manifest")
        named = set(
            re.findall(rf'"id": "({plain_hall.url}/(?:media|collection|catalogue)[^"]*)"', body.decode())
        )
        assert len(named) >= 5
        for url in named:
            heads, _ = answer(url)
            assert "catalogue" in url or heads["Access-Control-Allow-Origin"] == "*", url


def test_documents_are_asked_again_by_their_mark(plain_hall):
    heads, _ = answer(f"{plain_hall.url}/iiif/3/box/manifest")
    with pytest.raises(urllib.error.HTTPError) as same:
        answer(f"{plain_hall.url}/iiif/3/box/manifest", If_None_Match=heads["ETag"])
    with same.value as got:
        assert got.code == 304


def test_the_model_is_downloaded_with_its_licence(plain_hall):
    heads, body = answer(f"{plain_hall.url}/collection/box/model.glb")
    assert heads["Content-Disposition"] == 'attachment; filename="box.glb"'
    assert glb_parts(body).document["asset"]["copyright"].startswith("CC0-1.0")


def test_harvesting_by_get_and_by_post(plain_hall):
    asked = urllib.parse.urlencode({"verb": "ListRecords", "metadataPrefix": "lido"})
    roots = [
        etree.fromstring(answer(f"{plain_hall.url}/oai?{asked}")[1]),
        etree.fromstring(answer(f"{plain_hall.url}/oai", asked.encode())[1]),
    ]
    for root in roots:
        assert oai_faults(root) == []
        (inside,) = root.find(".//{*}metadata")
        assert lido_faults(inside) == []
        assert root.findtext(".//{*}header/{*}identifier") == "oai:127.0.0.1:box"


@pytest.mark.parametrize(
    "query", ["", "verb=", "&".join(f"a{n}=1" for n in range(50)), "verb=%ff%00%3c", "verb"]
)
def test_odd_requests_are_errors_of_the_protocol(plain_hall, query):
    root = etree.fromstring(answer(f"{plain_hall.url}/oai?{query}")[1])
    assert oai_faults(root) == []
    assert root.find("{*}error").get("code") == "badVerb"


def test_a_form_without_end_is_refused(plain_hall):
    with pytest.raises(urllib.error.HTTPError) as refused:
        answer(f"{plain_hall.url}/oai", b"verb=" + b"x" * 100_000)
    with refused.value as got:
        assert got.code == 413


def test_whoever_asks_by_another_name_gets_addresses_of_that_name(plain_hall):
    _, body = answer(f"{plain_hall.url}/iiif/3/box/manifest", Host="hall.example.org")
    assert json.loads(body)["id"] == "http://hall.example.org/iiif/3/box/manifest"
    _, body = answer(f"{plain_hall.url}/iiif/3/box/manifest")
    assert json.loads(body)["id"] == f"{plain_hall.url}/iiif/3/box/manifest"


@pytest.mark.parametrize("lang", ["zh", "en"])
def test_the_catalogue_tells_programs_what_it_tells_readers(shipped_hall, lang):
    _, body = answer(f"{shipped_hall.url}/catalogue?lang={lang}")
    page = body.decode()
    told = [
        json.loads(text) for text in re.findall(r'<script type="application/ld\+json">(.*?)</script>', page)
    ]
    works = [one for one in told if one.get("@type") == "VisualArtwork"]
    assert [one["@id"] for one in works] == [
        f"/catalogue#{name}" for name in re.findall(r'<article id="([^"]+)"', page)
    ]
    kinds = {one["@type"] for thing in told for one in thing.get("@graph", ())}
    assert kinds == {"Museum", "ExhibitionEvent"}
    for work in works:
        models = [medium for medium in work["associatedMedia"] if medium["@type"] == "3DModel"]
        (model,) = models
        assert f'href="{model["contentUrl"]}"' in page
        answer(shipped_hall.url + model["contentUrl"])
