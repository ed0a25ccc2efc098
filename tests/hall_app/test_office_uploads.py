"""Uploads that mean harm: none is served as a page, none crashes the hall, none leaves the exhibit's folder."""

from __future__ import annotations

import io
import json
import random
import time
from concurrent.futures import ThreadPoolExecutor

import av
import pytest
from brought_films import MADE_BY, encodes, held, recording, turned_by_hand
from content_house import EXHIBIT, add_exhibit
from fastapi import FastAPI
from fastapi.testclient import TestClient
from hostile_files import HTML, hostile_files
from office_clerk import clerk

from hall_app.content import load
from hall_app.house import House, end_all
from hall_app.house.drafts import beside
from hall_app.house.people import Role
from hall_app.web import create_app

SHOWN = {
    "image/jpeg",
    "image/png",
    "image/webp",
    "image/svg+xml",
    "video/mp4",
    "audio/mpeg",
    "audio/ogg",
    "model/gltf-binary",
}
NAMES = [f"{number}-{use}" for number, (_, _, use) in enumerate(hostile_files())]


@pytest.fixture(scope="module")
def curator(counter):
    add_exhibit(counter.content, "hostile", EXHIBIT.replace("z = -1.0", "z = 4.0"))
    return clerk(counter, counter.people, Role.CURATOR)


# What is brought: container, encoders of pictures and sound, for what; and what is kept: ending, codecs.
FILMS = {
    "what browsers play": (("mp4", "libx264", "aac"), "film", ".mp4", ("h264", "aac")),
    "VP9": (("webm", "libvpx-vp9", "libopus"), "film", ".webm", ("vp9", "opus")),
    "a container that they do not": (("matroska", "libx264", "aac"), "film", ".mp4", ("h264", "aac")),
    "QuickTime with plain samples": (("mov", "libx264", "pcm_s16le"), "film", ".mp4", ("h264", "aac")),
    "MPEG-4 part 2": (("mp4", "mpeg4", "aac"), "film", ".mp4", ("h264", "aac")),
    "HEVC": (("mp4", "libx265", "aac"), "film", ".mp4", ("h264", "aac")),
    "a film without sound": (("mp4", "libx264", None), "film", ".mp4", ("h264", None)),
    "a film's sound alone": (("mp4", "libx264", "aac"), "sound", ".m4a", (None, "aac")),
    "MP3": (("mp3", None, "libmp3lame"), "sound", ".mp3", (None, "mp3")),
    "Opus": (("ogg", None, "libopus"), "sound", ".ogg", (None, "opus")),
    "a wave": (("wav", None, "pcm_s16le"), "sound", ".wav", (None, "pcm_s16le")),
    "a studio's wave": (("wav", None, "pcm_s32le"), "sound", ".mp3", (None, "mp3")),
}


@pytest.fixture
def bring(counter, curator):
    """What becomes of a file: (ending, content) of what is kept, or (None, why not)."""

    def act(data: bytes, use: str) -> tuple[str | None, bytes]:
        answer = curator.bring("hostile", [("brought.bin", data)], use=use)
        if answer.status != 200:
            assert answer.status == 400
            return None, json.loads(answer.body)["text"].encode()
        (name,) = json.loads(answer.body)["files"]
        kept = curator.ask("GET", f"/office/collection/hostile/file?name={name}")
        assert kept.status == 200
        curator.drop("hostile")
        return name[name.rindex(".") :], kept.body

    return act


@pytest.mark.parametrize("case", FILMS)
def test_a_recording_is_kept_as_browsers_play_it_and_tells_nothing(bring, case):
    (form, pictures, sound), use, ending, codecs = FILMS[case]
    if not all(encodes(one) for one in (pictures, sound) if one):
        pytest.skip("this build of PyAV does not write it")
    data = recording(form, pictures, sound)
    assert any(told.encode() in data for told in MADE_BY.values()), "it says where it was made"
    kept, body = bring(data, use)
    assert kept == ending
    found = held(body)
    assert (found.get("video"), found.get("audio")) == codecs
    assert found.get("red", "left") == "left"
    for told in MADE_BY.values():
        assert told.encode() not in body


@pytest.mark.parametrize("pictures", ["libx264", "mpeg4"])
def test_a_film_stays_upright(bring, pictures):
    ending, body = bring(turned_by_hand(recording("mp4", pictures, None)), "film")
    assert (ending, held(body)["red"]) == (".mp4", "above")


def test_ten_bits_are_made_eight(bring):
    _, body = bring(recording("mp4", "libx264", None, colours="yuv422p10le"), "film")
    with av.open(io.BytesIO(body)) as film:
        assert film.streams.video[0].pix_fmt == "yuv420p"


NO_RECORDINGS = {
    "cut off": lambda: recording("mp4", "libx264", "aac")[:-9_000],
    "its second half missing": lambda: halved(recording("webm", "libvpx-vp9", "libopus")),
    "half a wave": lambda: halved(recording("wav", None, "pcm_s16le")),
    "a head and a page": lambda: b"\0\0\0\x18ftypisom" + HTML * 40,
    "a head and a playlist": lambda: b"\0\0\0\x18ftypisom\n#EXTM3U\n#EXTINF:1,\nfile:///etc/passwd\n",
    "a mark and a page": lambda: b"ID3" + HTML * 40,
    "noise within a true head": lambda: noisy(recording("mp4", "libx264", None)),
}


def halved(data: bytes) -> bytes:
    return data[: len(data) // 2]


def noisy(film: bytes) -> bytes:
    begin, end = film.index(b"mdat") + 4, film.index(b"moov") - 4
    return film[:begin] + random.Random(1).randbytes(end - begin) + film[end:]


@pytest.mark.parametrize("case", NO_RECORDINGS)
@pytest.mark.parametrize("use", ["film", "sound"])
def test_what_cannot_be_played_is_refused_with_a_reason(bring, case, use):
    kept, why = bring(NO_RECORDINGS[case](), use)
    assert kept is None
    assert b"brought.bin" in why


def test_each_is_brought_for_what_it_is(bring):
    for data, use, word in (
        (recording("mp4", None, "aac"), "film", b"holds a sound"),
        (recording("mp4", "libx264", None), "sound", b"holds no sound"),
        (recording("mp4", "mpeg4", None, seconds=660, rate=1), "film", b"too long: a film lasts 10 minutes"),
    ):
        kept, why = bring(data, use)
        assert kept is None
        assert word in why


def test_what_does_not_come_to_an_end_is_ended():
    begin = time.monotonic()
    assert beside(time.sleep, 600, within=0.2) is None
    with ThreadPoolExecutor(1) as one:  # as a request waits while the server ends
        waiting = one.submit(beside, time.sleep, 600)
        while not waiting.done():
            end_all()
            time.sleep(0.05)
    assert waiting.result() is None
    assert time.monotonic() - begin < 300


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
        curator.drop("hostile")


def test_what_was_taken_in_and_published_is_served_to_everybody_as_what_it_is(counter, curator):
    kept = []
    for name, data, use in hostile_files():
        if use == "scan":
            continue  # what is no scan within is refused when it is to be published, by reading all of it
        answer = curator.bring("hostile", [(name, data)], use=use, **{"alt.zh": "图", "alt.en": "A picture"})
        kept += json.loads(answer.body).get("files", ()) if answer.status == 200 else ()
    assert kept, "some of them are harmless once they are made anew"
    curator.told("collection/hostile/publish", {})
    house = House(load(counter.content), counter.data)
    try:
        served = [answered_by(create_app(house), f"/media/hostile/{name}") for name in kept]
    finally:
        house.close()
    assert 200 in {status for status, _, _ in served}
    for status, headers, body in served:
        assert status in (200, 404), "what no page shows is nobody's to fetch"
        if status == 200:
            assert headers["content-type"].partition(";")[0] in SHOWN
            assert headers["x-content-type-options"] == "nosniff"
            assert b"<script" not in body


def answered_by(app: FastAPI, path: str) -> tuple[int, dict[str, str], bytes]:
    """What a stranger gets there."""
    answer = TestClient(app).get(path)
    return answer.status_code, dict(answer.headers), answer.content


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
