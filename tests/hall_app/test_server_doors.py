"""The served hall through its doors: page, API, media, sockets, survey."""

import dataclasses
import gzip
import json
import os
import re
import shutil
import signal
import stat
import subprocess
import sys
import time
import urllib.error
import urllib.request

import pytest
from plain_hall import write_plain_hall
from running_hall import free_port, running_hall
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

PATIENCE = 60.0  # [s] of a machine that has much else to do


def get(url: str, **headers: str):
    return urllib.request.urlopen(urllib.request.Request(url, headers=headers), timeout=PATIENCE)


def status(url: str, data: bytes | None = None, **headers: str) -> int:
    try:
        with urllib.request.urlopen(
            urllib.request.Request(url, data=data, headers=headers), timeout=PATIENCE
        ) as answer:
            return answer.status
    except urllib.error.HTTPError as error:
        with error:
            return error.code


def until(test, patience: float = PATIENCE):
    end = time.monotonic() + patience
    while time.monotonic() < end:
        if value := test():
            return value
        time.sleep(0.2)
    raise AssertionError("did not happen in time")


def scene(hall) -> dict:
    with get(f"{hall.url}/api/scene") as answer:
        return json.load(answer)


@pytest.fixture
def own_hall(tmp_path):
    """A plain hall of the test's own, free to be edited."""
    with running_hall(write_plain_hall(tmp_path / "content"), tmp_path / "work") as hall:
        yield hall


def visitor(hall):
    """A walking visitor without a picture."""
    socket = connect(f"ws://127.0.0.1:{hall.port}/walk")
    socket.send(json.dumps({"t": "hello", "client": None, "display": "page", "able": "predict"}))
    hello = json.loads(socket.recv(timeout=PATIENCE))
    assert hello["t"] == "hi"
    return socket, hello


def pose_after(socket, seq: int) -> dict:
    """The server's word on input `seq`; other news is passed over."""
    while True:
        message = json.loads(socket.recv(timeout=PATIENCE))
        if message["t"] == "pose" and message["seq"] >= seq:
            return message


def test_start_says_what_and_where(plain_hall):
    said = plain_hall.said()
    assert str(plain_hall.content) in said
    assert "1 exhibit, 0 problems" in said
    assert plain_hall.url in said


def test_the_data_folder_that_the_hall_makes_is_its_owner_s_alone(plain_hall):
    assert stat.S_IMODE(plain_hall.data.stat().st_mode) == 0o700
    assert len(list(plain_hall.data.iterdir())) > 1  # so that nobody but the hall itself can have closed it


def test_the_hall_says_who_answers_for_it_as_far_as_that_is_stated(plain_hall):
    assert "hint: controller.toml: missing" in plain_hall.said()
    with get(f"{plain_hall.url}/privacy?lang=en") as answer:
        page = answer.read().decode()
    assert "This record is not complete" in page
    assert "No proxy is believed on where visitors come from" in page
    assert "not known to this page" not in page


def test_page_names_what_it_consists_of(plain_hall):
    with get(plain_hall.url) as answer:
        page = answer.read().decode()
        policy = answer.headers["Content-Security-Policy"]
    for name in ("hall.packed.js", "hall.rest.css", "viser.js", "viser.css"):
        [address] = re.findall(rf'"(/(?:static|viser)/[0-9a-f]+/{re.escape(name)})"', page)
        assert status(plain_hall.url + address) == 200
    assert "<title>Plain hall</title>" in page
    assert "'unsafe-eval'" not in policy
    assert "http:" not in policy


@pytest.mark.parametrize("path", ["/", "/catalogue", "/api/scene", "/grid.bin", "/static/hall.js"])
def test_head_is_answered_like_get(plain_hall, path):
    request = urllib.request.Request(plain_hall.url + path, method="HEAD")
    with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
        assert answer.status == 200
        assert answer.read() == b""


def test_grid_is_packed_where_that_is_understood(plain_hall):
    with get(f"{plain_hall.url}/grid.bin") as answer:
        plain = answer.read()
    with get(f"{plain_hall.url}/grid.bin", **{"Accept-Encoding": "gzip"}) as answer:
        assert answer.headers["Content-Encoding"] == "gzip"
        assert gzip.decompress(answer.read()) == plain


def test_nothing_is_fetched_from_elsewhere(plain_hall):
    with get(plain_hall.url) as answer:
        page = answer.read().decode()
    for mark in ('src="http', 'href="http', "//cdn", "googleapis"):
        assert mark not in page


def test_media_answers_ranges(plain_hall):
    url = plain_hall.url + scene(plain_hall)["exhibits"][0]["thumbnail"]
    with get(url) as answer:
        whole = answer.read()
        assert answer.headers["Content-Type"] == "image/png"
    with get(url, Range="bytes=10-19") as answer:
        assert answer.status == 206
        assert answer.read() == whole[10:20]


@pytest.mark.parametrize(
    "path",
    [
        "box/../../hall.toml",
        "box/%2e%2e/%2e%2e/hall.toml",
        "hall/hall.toml",
        "box/exhibit.toml",
        "nobody/x.png",
        "box/%00",
        "hall/exhibits/box/box.png",
    ],
)
def test_media_keeps_to_what_is_shown(plain_hall, path):
    assert status(f"{plain_hall.url}/media/{path}") == 404


def test_grid_fits_its_description(plain_hall):
    grid = scene(plain_hall)["walk"]["grid"]
    with get(plain_hall.url + grid["url"]) as answer:
        assert len(answer.read()) == 2 * grid["nx"] * grid["nz"]


def test_catalogue_tells_everything_without_script(plain_hall):
    for lang, words in (("en", "A box, made for <em>tests</em>"), ("zh", "一只方匣，用来测试")):
        with get(f"{plain_hall.url}/catalogue?lang={lang}") as answer:
            page = answer.read().decode()
        assert words in page
        scripts = re.findall(r"<script[^>]*>", page)
        assert set(scripts) == {'<script type="application/ld+json">'}  # data for programs, nothing that runs


def test_walking_is_simulated_again(plain_hall):
    socket, hello = visitor(plain_hall)
    with socket:
        at = hello["z"]
        for number in range(1, 31):
            socket.send(json.dumps({"t": "in", "in": [[number, 1 / 30, 1, 0, 0.0, 1.6]]}))
            time.sleep(1 / 30)
        answer = pose_after(socket, 30)
        assert at - answer["z"] == pytest.approx(1.6, rel=0.02)


def test_speed_hacks_do_not_pay(plain_hall):
    socket, hello = visitor(plain_hall)
    with socket:
        socket.send(json.dumps({"t": "in", "in": [[n, 0.25, -1, 0, 0.0, 1.6] for n in range(1, 60)]}))
        answer = pose_after(socket, 1)
        assert abs(answer["z"] - hello["z"]) < 1.6 * 1.5


NONSENSE = [
    "",
    "null",
    "[]",
    '{"t":[]}',
    '{"t":"in","in":"x"}',
    '{"t":"in","in":[[1,"a",0,0,0,0]]}',
    '{"t":"in","in":[[1e999]]}',
    '{"t":"keys"}',
    '{"t":"goto","x":null,"z":"NaN"}',
    '{"t":"open","id":7}',
    '{"t":"open","id":"../x"}',
    "{" * 5000,
    "[" * 30000,
]


@pytest.mark.parametrize("nonsense", NONSENSE)
def test_nonsense_leaves_the_visitor_walking(plain_hall, nonsense):
    socket, _ = visitor(plain_hall)
    with socket:
        socket.send(nonsense)
        socket.send(json.dumps({"t": "in", "in": [[5, 0.1, 1, 0, 0.0, 1.6]]}))
        assert pose_after(socket, 5)["seq"] == 5


def test_a_message_that_is_too_long_ends_the_visit_alone(plain_hall):
    socket, _ = visitor(plain_hall)
    with socket:
        socket.send("x" * (65 << 10))
        with pytest.raises(ConnectionClosed):
            pose_after(socket, 1)
    assert scene(plain_hall)["exhibits"]


@pytest.mark.parametrize("path", ["/walk", "/"])
def test_strangers_pages_get_no_socket(plain_hall, path):
    protocols = ["viser-v1.1.1"] if path == "/" else None
    with (
        pytest.raises(InvalidStatus),
        connect(
            f"ws://127.0.0.1:{plain_hall.port}{path}", origin="http://evil.example", subprotocols=protocols
        ),
    ):
        pass  # pragma: no cover


@pytest.mark.parametrize("origin", ["http://[::1", "null", "http://127.0.0.1.evil.example"])
def test_odd_origins_are_refused(plain_hall, origin):
    address = f"ws://127.0.0.1:{plain_hall.port}/walk"
    with pytest.raises(InvalidStatus) as refusal, connect(address, origin=origin):
        pass  # pragma: no cover
    assert refusal.value.response.status_code == 403


def test_only_a_visitors_messages_reach_viser():
    """viser would open a public tunnel, take uploads and change panels for anybody."""
    import msgspec
    from viser import _messages

    from hall_app.web.sockets import message_kind, relay

    def wanted(kind: object, **fields: object) -> bool:
        return message_kind(msgspec.msgpack.encode({"type": kind, **fields})) is not None

    point, wxyz = [0, 0.5, 1], [1, 0, 0, 0]
    lens = {"fov": 1.0, "near": 0.01, "far": 1000, "image_height": 360, "image_width": 640}
    camera = {"wxyz": wxyz, "position": point, "look_at": point, "up_direction": point, **lens}
    ray = {"ray_origin": point, "ray_direction": point, "screen_pos": [0.5, 0.5]}
    click = {"name": "/exhibits/box", "instance_index": None, "modifier": None, "owner": "", **ray}
    for kind, fields in (("ViewerCameraMessage", camera), ("SceneNodeClickMessage", click)):
        assert {field.name for field in dataclasses.fields(getattr(_messages, kind))} == set(fields)
        assert set(getattr(relay, kind).__struct_fields__) == set(fields)
        assert wanted(kind, **fields)
        assert not wanted(kind, **fields, another=1)
        for name in fields.keys() - {"owner"}:
            assert not wanted(kind, **{key: value for key, value in fields.items() if key != name})
            assert not wanted(kind, **fields | {name: [None]})
    for kind in (
        "ShareUrlRequest",
        "ShareUrlDisconnect",
        "FileTransferStartUpload",
        "GuiUpdateMessage",
        None,
        7,
    ):
        assert not wanted(kind)
    assert message_kind(b"") is None
    assert message_kind(b"\xc1 no msgpack") is None


@pytest.mark.nightly
def test_an_unreadable_model_keeps_the_last_good_one(own_hall):
    model = own_hall.content / "exhibits" / "box" / "box.glb"
    good = model.read_bytes()
    model.write_bytes(b"")

    def problems():
        with get(f"{own_hall.url}/api/problems") as answer:
            return json.load(answer)

    assert any("box.glb" in json.dumps(problem) for problem in until(problems))
    assert [e["id"] for e in scene(own_hall)["exhibits"]] == ["box"]
    model.unlink()
    until(lambda: any("missing" in json.dumps(problem) for problem in problems()))
    assert [e["id"] for e in scene(own_hall)["exhibits"]] == ["box"]
    model.write_bytes(good)
    until(lambda: not problems())


@pytest.mark.nightly
def test_an_odd_file_keeps_no_other_edit_from_showing(own_hall):
    """A second exhibit is spoiled in every way; the first one's edits go on, and the fault is named."""
    home = own_hall.content / "exhibits"
    shutil.copytree(home / "box", home / "odd")
    toml = (home / "odd/exhibit.toml").read_text("utf-8").replace("x = 2.5", "x = -2.5")
    (home / "odd/exhibit.toml").write_text(toml, "utf-8")
    until(lambda: len(scene(own_hall)["exhibits"]) == 2)

    def problems() -> list[dict]:
        with get(f"{own_hall.url}/api/problems") as answer:
            return json.load(answer)

    faults = {
        "digits": "digits = " + "9" * 5000,
        "deep": "deep = " + "[" * 5000,
        "name": toml.replace("box.png", "x" * 300 + ".png"),
        "place": toml.replace("x = -2.5", "x = 1e300"),
    }
    for word, text in faults.items():
        (home / "odd/exhibit.toml").write_text(text, "utf-8")
        (home / "box/text.en.md").write_text(f"Told of {word}.", "utf-8")

        def shown(word: str = word) -> bool:
            with get(f"{own_hall.url}/api/exhibits/box") as answer:
                return word in json.load(answer)["text"]["en"]

        until(shown)
        assert {problem["file"] for problem in problems()} == {"exhibits/odd/exhibit.toml"}
    (home / "odd/text.en.md").write_text(f"![words](media/{'x' * 300}.png)", "utf-8")
    (home / "odd/exhibit.toml").write_text(toml, "utf-8")
    until(lambda: not problems())
    assert status(f"{own_hall.url}/api/exhibits/odd") == 200
    assert status(f"{own_hall.url}/catalogue") == 200


def test_only_this_machine_is_served(plain_hall):
    with open(f"/proc/{plain_hall.process.pid}/net/tcp", encoding="ascii") as table:
        rows = [line.split() for line in table.readlines()[1:]]
    listening = {row[1] for row in rows if row[3] == "0A"}
    ours = [address for address in listening if int(address.split(":")[1], 16) == plain_hall.port]
    assert ours
    assert all(address.startswith("0100007F") for address in ours)


def test_edits_show_without_restart_and_bad_ones_do_not(own_hall):
    text = own_hall.content / "exhibits" / "box" / "text.en.md"
    text.write_text("Quite another text with <script>alert(1)</script>.", "utf-8")

    def shown():
        with get(f"{own_hall.url}/api/exhibits/box") as answer:
            return json.load(answer)["text"]["en"]

    changed = until(lambda: shown() if "another" in shown() else None)
    assert "<script" not in changed
    toml = own_hall.content / "exhibits" / "box" / "exhibit.toml"
    good = toml.read_text("utf-8")
    toml.write_text(good.replace("caption", "capton"), "utf-8")

    def problems():
        with get(f"{own_hall.url}/api/problems") as answer:
            return json.load(answer)

    [problem] = until(problems)
    assert problem["file"] == "exhibits/box/exhibit.toml"
    assert problem["key"] == "capton"
    assert [e["id"] for e in scene(own_hall)["exhibits"]] == ["box"]
    toml.write_text(good.replace("x = 2.5", "x = -2.5"), "utf-8")
    until(lambda: scene(own_hall)["exhibits"][0]["x"] == -2.5)
    assert problems() == []


@pytest.mark.nightly
def test_a_moved_exhibit_stands_in_the_way_at_once(own_hall):
    socket, _ = visitor(own_hall)
    with socket:
        toml = own_hall.content / "exhibits" / "box" / "exhibit.toml"
        toml.write_text(toml.read_text("utf-8").replace("x = 2.5, z = 3.0", "x = 0.0, z = 2.5"), "utf-8")
        before = scene(own_hall)["revision"]
        until(lambda: scene(own_hall)["revision"] != before)
        for number in range(1, 60):
            socket.send(json.dumps({"t": "in", "in": [[number, 1 / 30, 1, 0, 0.0, 1.6]]}))
            time.sleep(1 / 30)
        assert pose_after(socket, 59)["z"] >= 2.5 + 0.4 + 0.3 - 1e-6


def test_survey_is_there(plain_hall):
    assert status(f"{plain_hall.url}/api/v1/healthz") == 200
    assert status(f"{plain_hall.url}/questionnaires/garment?lang=en") == 200
    url = f"{plain_hall.url}/api/v1/questionnaires/garment/submissions"
    assert status(url, b"x" * (1 << 20 | 1), **{"Content-Type": "application/json"}) == 413
    assert status(f"{plain_hall.url}/api/scene") == 200


@pytest.mark.parametrize("missing", ["hall.toml", "plan.toml"])
def test_no_hall_or_no_plan_is_said_by_name(tmp_path, missing):
    content = write_plain_hall(tmp_path / "content")
    (content / missing).unlink()
    done = serve_once(content, tmp_path)
    assert done.returncode == 1
    assert missing in done.stderr
    assert "Traceback" not in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1


@pytest.mark.nightly
def test_a_faulty_exhibit_is_left_out_and_named(tmp_path):
    content = write_plain_hall(tmp_path / "content")
    (content / "exhibits" / "box" / "box.png").unlink()
    with running_hall(content, tmp_path / "work") as hall:
        assert "0 exhibits, 1 problem" in hall.said()
        assert "exhibits/box/exhibit.toml" in hall.said()
        assert "box.png" in hall.said()
        assert scene(hall)["exhibits"] == []


def test_a_port_in_use_is_one_clear_line(plain_hall, tmp_path):
    done = serve_once(plain_hall.content, tmp_path, port=plain_hall.port)
    assert done.returncode == 1
    assert f"{plain_hall.port}" in done.stderr
    assert "--port" in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1


def test_wrong_arguments_are_status_two(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "hall_app", "serve", "--walk", "fly"], capture_output=True, text=True
    )
    assert done.returncode == 2


def test_interrupt_leaves_nothing_running(tmp_path):
    with running_hall(write_plain_hall(tmp_path / "content"), tmp_path / "work") as hall:
        pid = hall.process.pid
        hall.process.send_signal(signal.SIGINT)
        assert hall.process.wait(PATIENCE) == 0
        assert "Traceback" not in hall.said()
        left = [
            entry
            for entry in os.listdir("/proc")
            if entry.isdigit() and f" {pid} " in _stat(entry).split(")")[-1][:20]
        ]
        assert left == []


def _stat(entry: str) -> str:
    try:
        with open(f"/proc/{entry}/stat", encoding="ascii", errors="replace") as file:
            return file.read()
    except OSError:
        return ""


def serve_once(content, tmp_path, port: int | None = None) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "hall_app", "serve", "--content", content, "--data", tmp_path / "data"]
    return subprocess.run(
        [*command, "--port", str(port or free_port())],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
