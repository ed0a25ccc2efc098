"""A hall that does not answer for a while: what a visitor who walks sees of it."""

import os
import signal

import numpy as np
import pytest
from bench.browser import PATIENCE, displayed, enter
from bench.track import RECORD, place, watch
from bench.wire import wire
from corridor_hall import write_corridor_hall
from running_hall import running_hall

from hall_app.walk import ARREARS

pytestmark = [pytest.mark.nightly, pytest.mark.browser, pytest.mark.slow]

VIEW = {"width": 480, "height": 270}
SPEED = 1.6  # [m/s]
JUMP = 0.05  # [m]
BUNCH = 0.2  # [s] of the server's words that may come at once
NOTICE = "[data-testid=connection]"
WALKED = "([[x, , z], way]) => { const at = hall.pose(); return Math.hypot(at.x - x, at.z - z) >= way; }"

# Every change of the notice: when, and which state it shows.
NOTICES = """
() => {
  const notice = document.querySelector("[data-testid=connection]");
  window.__notices = [];
  const look = () => {
    const state = notice.hidden ? "open" : notice.dataset.state;
    if (window.__notices.at(-1)?.[1] !== state) window.__notices.push([performance.now() / 1000, state]);
  };
  new MutationObserver(look).observe(notice, { attributes: true });
}
"""

# The longest time from an input to its answer [ms].
SLOWEST = """
() => {
  const Real = window.WebSocket, left = new Map();
  window.__slowest = 0;
  window.WebSocket = class extends Real {
    constructor(...args) {
      super(...args);
      if (!String(args[0]).includes("/walk")) return;
      this.addEventListener("message", ({ data }) => {
        if (typeof data !== "string") return;
        const { t, seq } = JSON.parse(data), at = t === "pose" && left.get(seq);
        if (at) window.__slowest = Math.max(window.__slowest, performance.now() - at);
      });
    }
    send(text) {
      super.send(text);
      const message = typeof text === "string" ? JSON.parse(text) : {};
      if (message.t === "in") left.set(message.in.at(-1)[0], performance.now());
    }
  };
}
"""


@pytest.fixture(scope="module", params=["predict", "server"])
def corridor(request, chromium, tmp_path_factory):
    """A page in a hall of its own, which may be stopped; the page and the hall's process."""
    work = tmp_path_factory.mktemp("corridor")
    with running_hall(write_corridor_hall(work / "content"), work, "--walk", request.param) as hall:
        page = chromium.new_page(viewport=VIEW)
        watch(page)
        enter(page, f"{hall.url}/?lang=en")
        assert page.evaluate("() => hall.mode()") == request.param
        page.wait_for_timeout(2000)
        page.evaluate(NOTICES)
        yield page, hall.process
        page.close()


def seen(page) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of what RECORD saw: (N,) [s] times of frames, (N,) [m] way made along the corridor as displayed, and as walked.

    A busy machine draws fewer pictures than it has frames, so the display may lag the walk; it must not go back.
    """
    track = np.array(page.evaluate("() => { window.__recording = false; return window.__track; }"))
    return track[:, 0] / 1000, track[0, 3] - track[:, 3], track[0, 5] - track[:, 5]


def thrown_back(way: np.ndarray) -> float:
    """Farthest behind the place that had been reached [m]."""
    return float((np.maximum.accumulate(way) - way).max())


@pytest.mark.parametrize("stall", [1.5, 2.5, 4.0, 5.0])
def test_the_view_neither_goes_back_nor_leaps(corridor, stall):
    page, process = corridor
    place(page, 0.0, 22.0, 0.0)
    page.evaluate("() => { window.__notices.length = 0; }")
    page.evaluate(RECORD)
    page.keyboard.down("KeyW")
    page.wait_for_timeout(1500)
    os.kill(process.pid, signal.SIGSTOP)
    stopped = page.evaluate("() => performance.now() / 1000")
    try:
        page.wait_for_timeout(1000 * stall)
    finally:
        resumed = page.evaluate("() => performance.now() / 1000")
        os.kill(process.pid, signal.SIGCONT)
    page.wait_for_timeout(2500)
    page.keyboard.up("KeyW")
    times, way, walked = seen(page)
    assert thrown_back(way) <= JUMP
    assert thrown_back(walked) <= JUMP
    # Where the server walks, the display is its words as they come, and a busy machine hands on several at once.
    made_up = SPEED * (ARREARS + BUNCH) if page.evaluate("() => hall.mode()") == "server" else 0.0
    assert (np.diff(walked) - SPEED * np.diff(times)).max() <= JUMP + made_up
    during = walked[(times > stopped) & (times < resumed)]
    assert np.ptp(during) <= SPEED * 1.0
    assert walked[-1] - during[-1] >= 1.0  # and walks on
    notices = page.evaluate("() => window.__notices")
    begun = [at for at, state in notices if state == "waiting" and stopped + 0.4 < at < resumed + 0.5]
    assert len(begun) == 1  # says so, once
    assert page.locator(NOTICE).is_hidden()


def test_what_it_says_is_in_the_visitors_language(corridor):
    page, process = corridor
    place(page, 0.0, 22.0, 0.0)
    page.keyboard.down("KeyW")
    page.wait_for_timeout(500)
    os.kill(process.pid, signal.SIGSTOP)
    try:
        page.locator(NOTICE).wait_for(state="visible", timeout=10_000)
        assert "waiting for the hall" in page.locator(NOTICE).inner_text().lower()
    finally:
        os.kill(process.pid, signal.SIGCONT)
    page.locator(NOTICE).wait_for(state="hidden", timeout=10_000)
    page.keyboard.up("KeyW")
    assert page.locator("[data-testid=toast]").count() == 0  # nothing was lost, so nothing is restored


def test_a_page_that_stood_still_itself_goes_on_from_there(corridor):
    """The page's own thread is busy for three seconds: no leap, no throw-back, no word about the hall."""
    page, _ = corridor
    place(page, 0.0, 22.0, 0.0)
    page.evaluate("() => { window.__notices.length = 0; }")
    page.evaluate(RECORD)
    page.keyboard.down("KeyW")
    page.wait_for_timeout(1000)
    page.evaluate("() => { const end = performance.now() + 3000; while (performance.now() < end); }")
    page.wait_for_timeout(1500)
    page.keyboard.up("KeyW")
    times, way, walked = seen(page)
    assert max(thrown_back(way), thrown_back(walked)) <= JUMP
    busy = int(np.argmax(np.diff(times)))
    assert (
        walked[busy + 1] - walked[busy] <= 0.5 * SPEED
    )  # a slow frame's way at most, not that of three seconds
    assert walked[-1] >= 2.0
    woken = times[busy + 1]
    assert [at for at, state in page.evaluate("() => window.__notices") if abs(at - woken) < 0.3] == []


def test_a_cut_line_comes_back_to_where_one_stands(corridor, chromium):
    """Keys stay down while every connection is broken and made again."""
    page, _ = corridor
    port = int(page.url.split(":")[2].split("/")[0])
    with wire(port, 0.08) as line:
        far = chromium.new_page(viewport=VIEW)
        watch(far)
        enter(far, f"http://127.0.0.1:{line.port}/?lang=en")
        far.wait_for_timeout(1000)
        start = displayed(far)
        far.evaluate(RECORD)
        far.keyboard.down("KeyW")
        far.wait_for_timeout(1000)
        line.cut()
        far.wait_for_timeout(5000)
        far.wait_for_function(WALKED, arg=[start, 2.6], timeout=PATIENCE)
        far.keyboard.up("KeyW")
        far.wait_for_timeout(1000)
        _, way, walked = seen(far)
        apart = far.evaluate(
            "() => { const [x, , z] = hall.displayed(), at = hall.pose(); return Math.hypot(x - at.x, z - at.z); }"
        )
        far.close()
    assert thrown_back(walked) <= JUMP
    assert walked[-1] >= 2.5
    assert apart <= 0.01  # viser began anew; the picture is the visitor's again


@pytest.mark.parametrize("round_trip", [0.3, 0.6])
def test_ordinary_latency_walks_at_full_speed_in_silence(corridor, chromium, round_trip):
    page, _ = corridor
    if page.evaluate("() => hall.mode()") == "server":
        pytest.skip("where the server walks, its answer is the walk")
    port = int(page.url.split(":")[2].split("/")[0])
    with wire(port, round_trip) as line:
        far = chromium.new_page(viewport=VIEW)
        far.add_init_script(f"({SLOWEST})()")
        enter(far, f"http://127.0.0.1:{line.port}/?lang=en")
        far.wait_for_timeout(2000)
        far.evaluate(NOTICES)
        far.evaluate(RECORD)
        far.keyboard.down("KeyW")
        far.wait_for_timeout(4000)
        times, _, walked = seen(far)
        far.keyboard.up("KeyW")
        slowest = far.evaluate("() => window.__slowest / 1000")
        notices = far.evaluate("() => window.__notices")
        far.close()
    assert slowest >= round_trip
    if slowest < 0.9:  # a machine so busy that answers take longer has to stand
        begin = int(np.argmax(walked > 0.01))
        assert (walked[-1] - walked[begin]) / (times[-1] - times[begin]) >= 0.95 * SPEED
        assert notices == []
    assert thrown_back(walked) <= JUMP
