"""The door: what comes before the first paint, what comes after it by address, packed once and kept by browsers."""

import base64
import gzip
import hashlib
import json
import re
import struct
import urllib.error
import urllib.request

import msgspec
import pytest
import zstandard
from plain_hall import write_plain_hall
from running_hall import running_hall
from websockets.sync.client import connect

from hall_app.show import LEAN, PICTURE, Pieces, split
from hall_app.web.answers import accepted
from hall_app.web.pages import PAGE_FOLDER, PageFiles, one_module, page_files, viser_client
from hall_app.web.pages import client as unpacking

FIRST_FLIGHT = 14_600  # [bytes] ten packets: what a server may send before the first acknowledgement


def ask(url: str, method: str = "GET", **headers: str):
    """(status, headers, body as it came)."""
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    try:
        with urllib.request.urlopen(
            urllib.request.Request(url, method=method, headers=named), timeout=20
        ) as answer:
            return answer.status, answer.headers, answer.read()
    except urllib.error.HTTPError as error:
        with error:
            return error.code, error.headers, error.read()


def page_of(hall) -> str:
    return ask(hall.url)[2].decode()


def settings_of(page: str) -> dict:
    [text] = re.findall(r'<script type="application/json" id="hall-settings">(.*?)</script>', page, re.DOTALL)
    return json.loads(text)


def files_of(hall) -> list[str]:
    files = settings_of(page_of(hall))["files"]
    viewer = files["viewer"]
    return [
        viewer["script"],
        viewer["style"],
        viewer["decoder"],
        files["ahead"],
        files["page"],
        files["rest"],
    ]


# The document.


def test_the_door_fits_one_flight_and_holds_both_languages(shipped_hall):
    _, headers, packed = ask(shipped_hall.url, Accept_Encoding="gzip")
    assert headers["Content-Encoding"] == "gzip"
    assert len(packed) + len(str(headers)) <= FIRST_FLIGHT
    page = gzip.decompress(packed).decode()
    for words in (
        "锦绣华裳",
        "Silk and Cloud",
        "一座中堂",
        "A nave and four rooms",
        "进入展厅",
        "Enter the hall",
    ):
        assert words in page
    assert 'href="/catalogue"' in page
    assert 'src="' not in page.split("<body>")[1].split("<script>")[0]


def test_nothing_keeps_the_first_paint_waiting(plain_hall):
    page = page_of(plain_hall)
    assert "<script src" not in page
    assert 'rel="stylesheet"' not in page.split("<script>")[0]
    assert "@import" not in page


def test_curators_words_are_escaped(tmp_path):
    content = write_plain_hall(tmp_path / "content")
    toml = (content / "hall.toml").read_text("utf-8")
    evil = "</script><img src=x onerror=alert(1)>'\\\""
    (content / "hall.toml").write_text(toml.replace('"Plain hall"', json.dumps(evil)), "utf-8")
    with running_hall(content, tmp_path / "work") as hall:
        page = page_of(hall)
        settings = settings_of(page)
    assert "<img src=x" not in page
    assert settings["title"]["en"] == evil


def test_only_our_own_scripts_may_run(plain_hall):
    _, headers, body = ask(plain_hall.url)
    [scripts] = re.findall(r"script-src ([^;]*)", headers["Content-Security-Policy"])
    assert "unsafe-inline" not in scripts
    assert "unsafe-eval'" not in scripts.replace("'wasm-unsafe-eval'", "")
    assert "http" not in scripts
    inline = re.findall(r"<script>(.*?)</script>", body.decode(), re.DOTALL)
    digests = [base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in inline]
    assert len(inline) == 1
    assert re.findall(r"'sha256-([^']*)'", scripts) == digests


def test_without_hooks_reaches_the_page(plain_hall):
    assert settings_of(page_of(plain_hall))["withoutHooks"] is False
    assert settings_of(ask(f"{plain_hall.url}/?withoutHooks=1")[2].decode())["withoutHooks"] is True


# Files: packed once, kept.


@pytest.mark.parametrize("coding", ["gzip", "zstd"])
def test_files_are_packed_as_the_browser_understands(plain_hall, coding):
    for path in ("/", "/api/scene", "/api/texts", "/grid.bin", "/static/hall.css", *files_of(plain_hall)):
        plain = ask(plain_hall.url + path)
        packed = ask(plain_hall.url + path, Accept_Encoding=f"br;q=1, {coding}")
        assert "Content-Encoding" not in plain[1], path
        assert packed[1]["Vary"] == "Accept-Encoding"
        body = packed[2]
        if packed[1]["Content-Encoding"]:
            assert packed[1]["Content-Encoding"] == coding
            unpack = gzip.decompress if coding == "gzip" else zstandard.ZstdDecompressor().decompress
            body = unpack(body)
            assert len(packed[2]) < len(plain[2])
        else:
            assert len(plain[2]) < 512, path
        assert body == plain[2], path


@pytest.mark.parametrize("coding", ["gzip", "zstd", "identity"])
def test_what_a_browser_has_is_not_sent_again(plain_hall, coding):
    for path in ("/", "/api/scene", "/api/texts", "/grid.bin", "/static/hall.css", *files_of(plain_hall)):
        tag = ask(plain_hall.url + path, Accept_Encoding=coding)[1]["ETag"]
        again = ask(plain_hall.url + path, Accept_Encoding=coding, If_None_Match=f'"other", W/{tag}')
        assert (again[0], again[2]) == (304, b""), path
        assert again[1]["ETag"] == tag
        assert ask(plain_hall.url + path, Accept_Encoding=coding, If_None_Match='"other"')[0] == 200


def test_versioned_addresses_keep_and_others_are_asked_again(plain_hall):
    for path in files_of(plain_hall):
        assert "immutable" in ask(plain_hall.url + path)[1]["Cache-Control"]
        old = re.sub(r"/[0-9a-f]{10,}/", "/0123456789/", path)
        status, headers, _ = ask(plain_hall.url + old)
        assert (status, headers["Cache-Control"]) == (200, "no-cache"), old
    told = {"/": "private, no-cache", "/static/hall.js": "no-cache", "/api/scene": "no-cache"}
    for path, cache in told.items():
        assert ask(plain_hall.url + path)[1]["Cache-Control"] == cache


def test_head_and_ranges_behave(plain_hall):
    for path in (*files_of(plain_hall), settings_of(page_of(plain_hall))["files"]["models"]["pack"]):
        status, headers, body = ask(plain_hall.url + path, "HEAD")
        assert (status, body) == (200, b"")
        whole = ask(plain_hall.url + path)[2]
        assert int(headers["Content-Length"]) == len(whole)
        status, _, part = ask(plain_hall.url + path, Range="bytes=0-9")
        assert (status, len(part)) in ((200, len(whole)), (206, 10))


@pytest.mark.parametrize(
    "path",
    [
        "/static/texts.toml",
        "/static/door.html",
        "/static/../cli.py",
        "/static/%2e%2e/cli.py",
        "/static/",
        "/viser/x/index.html",
        "/scene/pieces/0",
        "/scene/packs/0",
        "/scene/other/0",
    ],
)
def test_nothing_else_is_served(plain_hall, path):
    assert ask(plain_hall.url + path)[0] == 404


@pytest.mark.parametrize(
    ("header", "best"),
    [
        ("gzip, deflate, br, zstd", "zstd"),
        ("gzip, deflate", "gzip"),
        ("GZIP;q=0.5", "gzip"),
        ("zstd;q=0, gzip", "gzip"),
        ("gzip;q=0", "identity"),
        ("gzip;q=nonsense", "identity"),
        ("x-gzip, gzipped", "identity"),
        ("", "identity"),
    ],
)
def test_codings_are_those_asked_for(header, best):
    assert accepted(header)[0] == best


def test_a_changed_file_has_another_address():
    sources = page_files().sources
    changed = PageFiles(sources | {"picture/judge.js": sources["picture/judge.js"] + "\n// changed\n"})
    assert changed.stamp != page_files().stamp


# viser's client.


def test_visers_client_has_the_shape_the_page_relies_on():
    client = viser_client()
    script, style = client.script.body.decode(), client.style.body.decode()
    for mark in (
        "__viserMutable",
        "__viserSceneTree",
        "__viserTestpoints",
        "__viserZstdWasm",
        "new WebSocket(e,[o])",
    ):
        assert mark in script
    # line.js knows the worker by its parts: what stands ahead of it, and its source in one string.
    assert script.count("WebSocket worker: got") == 1
    assert script.count("new WebSocket(") == 1
    assert len(re.findall(r"new Blob\(\[`URL\.revokeObjectURL\(import\.meta\.url\);`,\w+\]", script)) >= 1
    assert ".mantine" in style or "mantine" in style
    assert client.decoder.body[:4] == b"\0asm"


def test_another_viser_is_refused_by_name(monkeypatch):
    monkeypatch.setattr(unpacking, "version", lambda name: "1.2.0")
    with pytest.raises(
        RuntimeError, match=r"viser 1\.2\.0 is installed, the page is made for viser==1\.1\.1"
    ):
        viser_client.__wrapped__()


def test_a_page_built_in_another_way_is_refused(monkeypatch):
    monkeypatch.setattr(unpacking, "_PAYLOAD", re.compile("nowhere to be found()()()"))
    with pytest.raises(RuntimeError, match=r"not the one of 1\.1\.1: its packed script .* missing"):
        viser_client.__wrapped__()


def test_a_client_without_what_is_counted_on_is_refused(monkeypatch):
    monkeypatch.setattr(unpacking, "_COUNTED_ON", (b"a hook that went away",))
    with pytest.raises(RuntimeError, match="lacks 'a hook that went away'"):
        viser_client.__wrapped__()


# The page's modules as one.


def test_all_modules_of_the_page_are_in_it():
    def read(name: str) -> str:
        return (PAGE_FOLDER / name).read_text("utf-8")

    script = one_module(read, "hall.js")
    told = re.findall(r"^// (\S+\.js)$", script, re.MULTILINE)
    inline = {"viser/first.js", "viser/line.js", "door.js"}
    inline |= {"book/words.js", "book/plan.js", "book/turn.js"}  # of pages to read and of the office
    assert (
        set(told) == {path.relative_to(PAGE_FOLDER).as_posix() for path in PAGE_FOLDER.rglob("*.js")} - inline
    )
    assert len(told) == len(set(told))
    assert told[-1] == "hall.js"


def test_modules_run_in_the_order_of_a_browser():
    sources = {
        "a.js": 'import { b as other, c } from "./ui/b.js";\nimport * as d from "./d.js";\nother(c, d.e);\n',
        "ui/b.js": 'import "../d.js";\nexport function b() {}\nexport const c = 1;\n',
        "d.js": "export class e {}\n",
    }
    script = one_module(sources.__getitem__, "a.js")
    assert (
        script.index('modules["d.js"] =')
        < script.index('modules["ui/b.js"] =')
        < script.index('modules["a.js"] =')
    )
    assert 'const { b: other, c } = modules["ui/b.js"];' in script
    assert "return { b, c };" in script


@pytest.mark.parametrize(
    ("sources", "told"),
    [
        ({"a.js": 'import { b } from "./b.js";'}, r"a\.js: imports b\.js, which does not exist"),
        (
            {"a.js": 'import "./b.js";', "b.js": 'import "./a.js";'},
            r"a\.js: imports itself by way of a\.js → b\.js",
        ),
        ({"a.js": "export default 1;"}, r"a\.js: 'export default 1;'"),
        ({"a.js": "export let a = 1;"}, r"a\.js: 'export let a = 1;'"),
        ({"a.js": 'import x from "./b.js";'}, r"a\.js: 'import x from"),
    ],
)
def test_another_way_of_writing_modules_is_named(sources, told):
    with pytest.raises(ValueError, match=told):
        one_module(sources.__getitem__, "a.js")


# Pieces.


def glb(picture: bytes, rest: bytes) -> bytes:
    """A GLB of one picture and some geometry."""
    document = {
        "bufferViews": [{"byteLength": len(rest)}, {"byteOffset": len(rest), "byteLength": len(picture)}],
        "images": [{"bufferView": 1, "mimeType": "image/png"}],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary = rest + picture
    total = 12 + 8 + len(text) + 8 + len(binary)
    head = struct.pack("<4sII", b"glTF", 2, total) + struct.pack("<I4s", len(text), b"JSON") + text
    return head + struct.pack("<I4s", len(binary), b"BIN\0") + binary


def message_of(body: dict) -> bytes:
    """As viser sends it."""
    inner = msgspec.msgpack.encode(body)
    packed = zstandard.ZstdCompressor(level=1).compress(inner)
    return struct.pack("<QQ", len(inner), len(packed)) + packed


def whole(lean: bytes, pieces: Pieces) -> bytes:
    """What line.js makes of a lean message, decoded as viser's worker does: frames one after the other."""
    assert lean.startswith(LEAN)
    (length,) = struct.unpack_from("<I", lean, 8)
    header = json.loads(lean[12 : 12 + length])
    at, frames = 12 + length, []
    for part in header["parts"]:
        frames.append(pieces.frame(part) if isinstance(part, str) else lean[at : at + part])
        at += 0 if isinstance(part, str) else part
    assert at == len(lean)
    body = b"".join(zstandard.ZstdDecompressor().decompress(frame) for frame in frames)
    assert len(body) == header["size"]
    return body


def noise(seed: int, size: int) -> bytes:
    return b"".join(hashlib.sha256(struct.pack("<II", seed, n)).digest() for n in range(size // 32))


PICTURE_BYTES = noise(1, PICTURE + 4096)


def scene_body(models: list[bytes]) -> dict:
    messages = [
        {"type": "GlbMessage", "props": {"glb_data": model}, "n": n} for n, model in enumerate(models)
    ]
    return {"messages": messages, "timestampSec": 1.5, "binaryBufferLengths": []}


MODELS = [
    glb(PICTURE_BYTES, noise(2, 40_000)),
    glb(PICTURE_BYTES, noise(3, 40_000)),
    noise(4, 50_000),  # msgpack begins it with two bytes of length
    noise(5, 900),  # for itself
]


@pytest.mark.parametrize("order", [(0,), (2,), (3, 0), (0, 1, 2, 3), (2, 2, 3, 0)])
def test_a_lean_message_becomes_the_one_with_the_models(order):
    pieces, models = Pieces(), [MODELS[n] for n in order]
    lean = pieces.lean(message_of(scene_body([pieces.stand_in(model) for model in models])))
    assert len(lean) < 2000 + 900
    assert whole(lean, pieces) == msgspec.msgpack.encode(scene_body(models))


def test_garments_of_one_cloth_share_its_picture():
    pieces = Pieces()
    for n, model in enumerate(MODELS):
        pieces.show(str(n), model)
    name, _ = pieces.plan_pack()
    packed = pieces.pack(name)
    (length,) = struct.unpack_from("<I", packed)
    index = json.loads(packed[4 : 4 + length])
    assert len(packed) < sum(map(len, MODELS)) - len(PICTURE_BYTES) + 2000
    assert sum(size for _, size in index) + 4 + length == len(packed)
    assert pieces.plan_pack() == (name, len(packed))
    assert all(b"".join(split(model)) == model for model in MODELS)
    pieces.hide("0")
    assert pieces.plan_pack()[0] != name


@pytest.mark.parametrize("odd", [b"glTF" + bytes(60_000), b"glTF\2\0\0\0" + b"\xff" * 60_000, b"", b"glTF"])
def test_odd_models_travel_whole(odd):
    assert b"".join(split(odd)) == odd


def test_messages_without_a_model_stay_as_they_are():
    pieces = Pieces()
    for body in (
        {"messages": [{"a": 1}], "timestampSec": 0, "binaryBufferLengths": []},
        {"messages": [{"a": noise(5, 50_000)}], "timestampSec": 0, "binaryBufferLengths": []},
        {"messages": [{"a": "hall model " + 20 * "0"}], "timestampSec": 0, "binaryBufferLengths": []},
    ):
        message = message_of(body)
        assert pieces.lean(message) is message
    arrays = message_of({**scene_body([b"small"]), "binaryBufferLengths": [8]}) + bytes(8)
    assert pieces.lean(arrays) is arrays


def test_arrays_beside_a_model_are_refused():
    """Where they begin depends on the length of what lies before."""
    pieces = Pieces()
    arrays = message_of({**scene_body([pieces.stand_in(MODELS[2])]), "binaryBufferLengths": [8]}) + bytes(8)
    with pytest.raises(ValueError, match="arrays follow"):
        pieces.lean(arrays)


def scene_of(hall) -> bytes:
    """The messages viser's socket brings, until the box is among them."""
    address = f"ws://127.0.0.1:{hall.port}/"
    with connect(address, subprotocols=["viser-v1.1.1"], max_size=None) as socket:  # type: ignore[list-item]
        came = b""
        while b"LEAN" not in came and len(came) < 100_000:
            came += socket.recv(timeout=20)  # type: ignore[operator]
    return came


def test_the_first_views_pieces_are_all_in_the_pack(shipped_hall):
    models = settings_of(page_of(shipped_hall))["files"]["models"]
    _, headers, packed = ask(shipped_hall.url + models["pack"])
    assert "immutable" in headers["Cache-Control"]
    (length,) = struct.unpack_from("<I", packed)
    inside = {name for name, _ in json.loads(packed[4 : 4 + length])}
    came = scene_of(shipped_hall)
    at = came.index(LEAN)
    (length,) = struct.unpack_from("<I", came, at + 8)
    parts = json.loads(came[at + 12 : at + 12 + length])["parts"]
    asked = {part for part in parts if isinstance(part, str)}
    assert asked
    assert asked <= inside
    name = next(iter(asked))
    assert ask(shipped_hall.url + models["piece"] + name)[0] == 200
