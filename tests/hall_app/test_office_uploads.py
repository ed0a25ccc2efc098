"""Uploads that mean harm: none is served as a page, none crashes the hall, none leaves the exhibit's folder."""

from __future__ import annotations

import json

import pytest
from content_house import EXHIBIT, add_exhibit
from hostile_files import hostile_files
from office_clerk import clerk

from hall_app.house.people import Role

SHOWN = {"image/jpeg", "image/png", "image/webp", "video/mp4", "audio/mpeg", "audio/ogg", "model/gltf-binary"}
NAMES = [f"{number}-{use}" for number, (_, _, use) in enumerate(hostile_files())]


@pytest.fixture(scope="module")
def curator(counter):
    add_exhibit(counter.content, "hostile", EXHIBIT.replace("z = -1.0", "z = 4.0"))
    return clerk(counter, counter.people, Role.CURATOR)


def snapshot(folder) -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def test_there_are_forty():
    assert len(hostile_files()) >= 40


@pytest.mark.parametrize(("name", "data", "use"), hostile_files(), ids=NAMES)
def test_a_hostile_file_harms_nobody(counter, curator, name, data, use):
    before = snapshot(counter.content)
    answer = curator.bring("hostile", [(name, data)], use=use)
    assert answer.status in (200, 400, 413), answer.text
    if answer.status != 200:
        assert json.loads(answer.body)["text"], "every refusal says why"
    for kept in json.loads(answer.body).get("files", ()):
        assert kept.startswith(("media/", "scan/"))
        assert set(kept) <= set("abcdefghijklmnopqrstuvwxyz0123456789-./")
        assert ".." not in kept
        shown = curator.ask("GET", f"/office/collection/hostile/file?name={kept}")
        kind = shown.headers["Content-Type"].partition(";")[0]
        assert kind in SHOWN | {"application/octet-stream"}
        assert shown.headers["X-Content-Type-Options"] == "nosniff"
        assert "sandbox" in shown.headers["Content-Security-Policy"]
        assert not kind.startswith("image/") or b"<script" not in shown.body
        assert shown.body[12:16] != b"JSON" or b"<script" not in shown.body
    assert snapshot(counter.content) == before, "nothing is in the hall before it is published"
    assert curator.api("collection/hostile").status == 200
    if curator.told("collection/hostile")["draft"]:
        curator.told("collection/hostile/drop", {})


def test_a_form_that_is_none_is_refused(curator):
    told = {"Origin": curator.url, "X-Seal": curator.seal}
    for kind, body in (
        ("multipart/form-data", b""),
        ("multipart/form-data; boundary=x", b""),
        ("multipart/form-data; boundary=x", b"--x\r\nContent-Disposition: form-data; name=file"),
        (
            "multipart/form-data; boundary=x",
            b"--x\r\nContent-Disposition: form-data; name=a\r\n\r\nb\r\n" * 300 + b"--x--",
        ),
        ("multipart/form-data; boundary=" + "x" * 300, b"--x"),
        (
            "multipart/form-data; boundary=x",
            b"--x\r\nContent-Disposition: form-data; name=a\r\n\r\nb\r\n" * 300 + b"--x--",
        ),
        ("application/json", b"{}"),
    ):
        answer = curator.ask(
            "POST", "/api/office/collection/hostile/upload", body, told | {"Content-Type": kind}
        )
        assert answer.status in (400, 413), (kind, answer.text)
