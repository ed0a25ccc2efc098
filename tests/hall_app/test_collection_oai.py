"""OAI-PMH 2.0: each verb, each error, lists in parts; harvested by a client of others."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import parse_qsl, urlsplit

import pytest
from collection_grammars import LIDO, OAI, lido_faults, oai_faults
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree
from museum import ADDRESS, collection, read

from hall_app.web.collection import Collection, harvested

ASSETS = Path(__file__).parents[2] / "assets"
NOW = datetime(2026, 11, 30, 12, tzinfo=UTC)
FIRST = datetime(2026, 1, 1, tzinfo=UTC)
HOST = "hall.example.org"


@pytest.fixture(scope="module")
def many() -> Collection:
    """23 records, a day apart, every third one a ready-made model."""
    one = collection(read(ASSETS)).items[0]
    items = tuple(
        replace(
            one, id=f"e{n:02}", changed=FIRST + timedelta(days=n), kind="model" if n % 3 == 0 else "simulated"
        )
        for n in range(23)
    )
    return replace(collection(read(ASSETS)), items=items[::-1])


def asked(collection: Collection, *arguments: tuple[str, str], page: int = 5, **more: str):
    """The answer's root, its form tested."""
    given = [*arguments, *((name.rstrip("_"), value) for name, value in more.items())]
    root = etree.fromstring(harvested(collection, given, NOW, page=page))
    assert oai_faults(root) == []
    assert root.findtext(f"{OAI}responseDate") == "2026-11-30T12:00:00Z"
    return root


def error(root) -> str | None:
    found = root.find(f"{OAI}error")
    return None if found is None else found.get("code")


def identifiers(root) -> list[str]:
    return [found.text for found in root.iter(f"{OAI}identifier")]


def whole_list(collection: Collection, **arguments: str) -> list[list[str]]:
    """The identifiers of each part of a list."""
    parts, root = [], asked(collection, verb="ListIdentifiers", **arguments)
    while True:
        assert error(root) is None
        parts.append(identifiers(root))
        token = root.find(f".//{OAI}resumptionToken")
        if token is None:
            return parts
        assert int(token.get("completeListSize")) >= sum(map(len, parts))
        assert int(token.get("cursor")) == sum(map(len, parts[:-1]))
        if not token.text:
            return parts
        root = asked(collection, verb="ListIdentifiers", resumptionToken=token.text)


def test_identify(many):
    root = asked(many, verb="Identify")
    told = root.find(f"{OAI}Identify")
    assert told.findtext(f"{OAI}baseURL") == f"{ADDRESS}/oai"
    assert told.findtext(f"{OAI}protocolVersion") == "2.0"
    assert told.findtext(f"{OAI}earliestDatestamp") == "2026-01-01T00:00:00Z"
    assert told.findtext(f"{OAI}granularity") == "YYYY-MM-DDThh:mm:ssZ"
    assert told.findtext(f"{OAI}adminEmail").endswith(".invalid"), "nobody's address is made up"
    assert dict(root.find(f"{OAI}request").attrib) == {"verb": "Identify"}
    stated = asked(replace(many, contact="a@museum.example"), verb="Identify")
    assert stated.findtext(f".//{OAI}adminEmail") == "a@museum.example"


def test_formats_and_sets(many):
    prefixes = [e.text for e in asked(many, verb="ListMetadataFormats").iter(f"{OAI}metadataPrefix")]
    assert prefixes == ["oai_dc", "lido"]
    one = asked(many, verb="ListMetadataFormats", identifier=f"oai:{HOST}:e03")
    assert [e.text for e in one.iter(f"{OAI}metadataPrefix")] == prefixes
    assert [e.text for e in asked(many, verb="ListSets").iter(f"{OAI}setSpec")] == [
        "simulated",
        "scanned",
        "model",
    ]


@pytest.mark.parametrize("prefix", ["oai_dc", "lido"])
def test_a_record(many, prefix):
    root = asked(many, verb="GetRecord", identifier=f"oai:{HOST}:e03", metadataPrefix=prefix)
    header = root.find(f".//{OAI}header")
    assert header.findtext(f"{OAI}datestamp") == "2026-01-04T00:00:00Z"
    assert header.findtext(f"{OAI}setSpec") == "model"
    (inside,) = root.find(f".//{OAI}metadata")
    raw = harvested(
        many, [("verb", "GetRecord"), ("identifier", f"oai:{HOST}:e03"), ("metadataPrefix", prefix)], NOW
    )
    begin = raw.index(b"<metadata>")
    assert b"schemaLocation=" in raw[begin:], "the metadata declares its own schema"
    assert b"xmlns:" in raw[begin:]
    if prefix == "lido":
        assert inside.tag == f"{LIDO}lido"
        assert lido_faults(inside) == []


def test_a_list_comes_in_parts_whole_and_once(many):
    parts = whole_list(many, metadataPrefix="lido")
    assert [len(part) for part in parts] == [5, 5, 5, 5, 3]
    assert sum(parts, []) == [f"oai:{HOST}:e{n:02}" for n in range(23)]
    short = asked(many, verb="ListIdentifiers", metadataPrefix="lido", page=50)
    assert short.find(f".//{OAI}resumptionToken") is None


@pytest.mark.parametrize(
    ("arguments", "count"),
    [
        ({"from_": "2026-01-11"}, 13),
        ({"until": "2026-01-11"}, 11),
        ({"from_": "2026-01-03", "until": "2026-01-03"}, 1),
        ({"from_": "2026-01-03T00:00:00Z", "until": "2026-01-03T00:00:00Z"}, 1),
        ({"from_": "2026-01-03T00:00:01Z", "until": "2026-01-04T23:59:59Z"}, 1),
        ({"set": "model"}, 8),
        ({"set": "model", "from_": "2026-01-02"}, 7),
        ({"until": "9999-12-31"}, 23),
    ],
)
def test_a_list_of_a_time_and_a_set(many, arguments, count):
    assert len(sum(whole_list(many, metadataPrefix="oai_dc", **arguments), [])) == count


def test_a_list_goes_on_while_exhibits_come_and_go(many):
    first = asked(many, verb="ListIdentifiers", metadataPrefix="oai_dc")
    token = first.findtext(f".//{OAI}resumptionToken")
    less = replace(many, items=tuple(item for item in many.items if item.id not in ("e02", "e05")))
    went_on = asked(less, verb="ListIdentifiers", resumptionToken=token)
    assert identifiers(went_on)[0] == f"oai:{HOST}:e06"
    gone = replace(many, items=tuple(item for item in many.items if item.id < "e03"))
    assert error(asked(gone, verb="ListIdentifiers", resumptionToken=token)) == "badResumptionToken"


RECORDS = ("verb", "ListRecords")
DUBLIN = ("metadataPrefix", "oai_dc")
REFUSED = {
    "no verb": ("badVerb", []),
    "another verb": ("badVerb", [("verb", "Delete")]),
    "a verb in small letters": ("badVerb", [("verb", "identify")]),
    "two verbs": ("badVerb", [("verb", "Identify"), ("verb", "Identify")]),
    "an argument that Identify does not take": ("badArgument", [("verb", "Identify"), DUBLIN]),
    "an unknown argument": ("badArgument", [RECORDS, DUBLIN, ("x", "y")]),
    "no format": ("badArgument", [RECORDS]),
    "an argument twice": ("badArgument", [RECORDS, DUBLIN, DUBLIN]),
    "no identifier": ("badArgument", [("verb", "GetRecord"), DUBLIN]),
    "a date that is none": ("badArgument", [RECORDS, DUBLIN, ("from", "2026-02-30")]),
    "a date in words": ("badArgument", [RECORDS, DUBLIN, ("until", "today")]),
    "a year of five digits": ("badArgument", [RECORDS, DUBLIN, ("until", "12026-01-01")]),
    "an empty date": ("badArgument", [RECORDS, DUBLIN, ("from", "")]),
    "Arabic digits": ("badArgument", [RECORDS, DUBLIN, ("from", "٢٠٢٦-٠١-٠١")]),
    "two granularities": (
        "badArgument",
        [RECORDS, DUBLIN, ("from", "2026-01-01"), ("until", "2026-01-02T00:00:00Z")],
    ),
    "from after until": ("badArgument", [RECORDS, DUBLIN, ("from", "2026-02-01"), ("until", "2026-01-01")]),
    "a token with something beside": ("badArgument", [RECORDS, DUBLIN, ("resumptionToken", "x")]),
    "another format": ("cannotDisseminateFormat", [RECORDS, ("metadataPrefix", "marc21")]),
    "another format of one": (
        "cannotDisseminateFormat",
        [("verb", "GetRecord"), ("identifier", f"oai:{HOST}:e03"), ("metadataPrefix", "x")],
    ),
    "nobody": ("idDoesNotExist", [("verb", "GetRecord"), DUBLIN, ("identifier", f"oai:{HOST}:nobody")]),
    "formats of nobody": ("idDoesNotExist", [("verb", "ListMetadataFormats"), ("identifier", "x")]),
    "another set": ("noRecordsMatch", [RECORDS, DUBLIN, ("set", "paintings")]),
    "before all": ("noRecordsMatch", [RECORDS, DUBLIN, ("until", "2025-12-31")]),
    "after all": ("noRecordsMatch", [RECORDS, DUBLIN, ("from", "2027-01-01")]),
    "a token that is none": ("badResumptionToken", [RECORDS, ("resumptionToken", "nothing")]),
    "an empty token": ("badResumptionToken", [RECORDS, ("resumptionToken", "")]),
    "a token of sets": ("badResumptionToken", [("verb", "ListSets"), ("resumptionToken", "x")]),
}


@pytest.mark.parametrize("case", REFUSED)
def test_errors(many, case):
    code, arguments = REFUSED[case]
    root = asked(many, *arguments)
    assert error(root) == code
    assert root.find(f"{OAI}error").text
    attributes = dict(root.find(f"{OAI}request").attrib)
    assert attributes == ({} if code in ("badVerb", "badArgument") else dict(arguments))


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_no_argument_breaks_an_answer(many, data):
    names = st.sampled_from(
        ["verb", "metadataPrefix", "from", "until", "set", "identifier", "resumptionToken"]
    )
    values = st.one_of(
        st.text(max_size=20),
        st.sampled_from(["ListRecords", "GetRecord", "lido", "2026-01-01", "IiI", "AAAA"]),
    )
    arguments = data.draw(st.lists(st.tuples(st.one_of(names, st.text(max_size=8)), values), max_size=4))
    asked(many, *arguments)


@settings(max_examples=80, deadline=None)
@given(
    told=st.recursive(
        st.none() | st.integers() | st.text(max_size=5),
        lambda inner: st.lists(inner, max_size=7),
        max_leaves=9,
    )
)
def test_a_forged_token_is_refused(many, told):
    """Even one with the right sum: what it says is checked as any argument."""
    import base64
    import hashlib
    import json

    text = json.dumps(told).encode()
    token = base64.urlsafe_b64encode(hashlib.sha256(text).digest()[:4] + text).decode().rstrip("=")
    assert error(asked(many, verb="ListRecords", resumptionToken=token)) == "badResumptionToken"


@pytest.fixture(scope="module")
def harbour(many) -> Iterator[str]:
    """The function behind a port of its own, five records an answer."""

    class Answering(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            arguments = parse_qsl(urlsplit(self.path).query, keep_blank_values=True)
            body = harvested(many, arguments, NOW, page=5)
            self.send_response(200)
            self.send_header("Content-Type", "text/xml; charset=utf-8")
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *told) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Answering)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield f"http://127.0.0.1:{server.server_address[1]}/oai"
    server.shutdown()
    server.server_close()
    thread.join()


def test_a_harvester_takes_all_of_it(harbour):
    from oaipmh_scythe import Scythe

    with Scythe(harbour) as scythe:
        assert [told.metadataPrefix for told in scythe.list_metadata_formats()] == ["oai_dc", "lido"]
        for prefix in ("oai_dc", "lido"):
            taken = list(scythe.list_records(metadata_prefix=prefix))
            assert [record.header.identifier for record in taken] == [
                f"oai:{HOST}:e{n:02}" for n in range(23)
            ]
        titles = next(iter(scythe.list_records(metadata_prefix="oai_dc"))).metadata["title"]
        assert titles == ["秋香缠枝花绫褙子", "Autumn-gold beizi in flowered silk"]
        models = list(scythe.list_identifiers(metadata_prefix="oai_dc", set_="model"))
        assert len(models) == 8
