"""An exhibit that moves where the line breaks, and where the tab sleeps; what it costs the line while it plays."""

import signal
import time
from contextlib import contextmanager

import numpy as np
import pytest
from bench.browser import PATIENCE, enter, soon, stand_before
from bench.wire import wire
from moving_hall import FRAMES, RATE, write_worn_hall
from running_hall import running_hall

pytestmark = [pytest.mark.browser, pytest.mark.nightly]

VIEW = {"width": 480, "height": 270}
NODE = "/exhibits/box"

# Of every picture: when it was begun and when it was written, and one vertex of each mesh; null where there is no such
# mesh. What is shown is the clock's frame of some moment between the two: a busy machine may take long from one to the
# other.
WATCH = """
([node, picks]) => {
  window.__seen = [];
  const vertex = (name, at) => {
    let found = null;
    window.__viserMutable.nodeRefFromName[node]?.traverse((one) => {
      if (one.isMesh && one.name === name) found = one.geometry.attributes.position.array;
    });
    return found && Array.from(found.subarray(3 * at, 3 * at + 3));
  };
  const clock = () => performance.now() / 1000;
  window.__look = (begun) => [begun, clock(), ...picks.map(([name, at]) => vertex(name, at))];
  const write = HALL.beforeFrame;
  HALL.beforeFrame = (now) => {
    const begun = clock();
    write(now);
    window.__seen.push(window.__look(begun));
  };
}
"""
# A tab behind another one: no picture comes, and its clock goes on. Headless Chromium takes every tab for the front
# one, and lets none be frozen.
SLEEP = """
(() => {
  const frame = requestAnimationFrame.bind(window), clock = performance.now.bind(performance);
  let held = null, later = 0;
  performance.now = () => clock() + later;
  window.requestAnimationFrame = (act) => {
    if (held) return held.push(act);
    return frame((now) => (held ? held.push(act) : act(now + later)));
  };
  const turn = (hidden) => {
    Object.defineProperty(document, "hidden", { value: hidden, configurable: true });
    document.dispatchEvent(new Event("visibilitychange", { bubbles: true }));
  };
  window.__sleep = () => { held = []; turn(true); };
  window.__wake = (seconds) => {
    const due = held;
    later += 1000 * seconds;
    held = null;
    turn(false);
    due.forEach((act) => requestAnimationFrame(act));
  };
})();
"""
MARK = "(node) => { __viserMutable.nodeRefFromName[node].traverse((one) => { one.__old = true; }); }"
NEW = """
(node) => {
  let meshes = 0, old = false;
  window.__viserMutable.nodeRefFromName[node]?.traverse((one) => { meshes += one.isMesh ? 1 : 0; old ||= one.__old; });
  return meshes > 1 && !old;
}
"""


@pytest.fixture(scope="module")
def hall(tmp_path_factory):
    """The running hall, the line to it, and the clip."""
    work = tmp_path_factory.mktemp("worn")
    content, clip = write_worn_hall(work / "content")
    with running_hall(content, work) as hall, wire(hall.port) as line:
        yield hall, line, clip


class Watched:
    """A tab before the exhibit; which frame each of its meshes shows."""

    def __init__(self, page, clip) -> None:
        self.page = page
        drawn = [clip.meshes[0].drawn[0], clip.figure.drawn[0]]
        moved = [
            np.stack([clip.positions(k, name)[one.index] for k in range(FRAMES)])
            for name, one in zip(("box", "figure"), drawn, strict=True)
        ]
        picked = [int(np.ptp(x, axis=0).sum(1).argmax()) for x in moved]
        self.places = [x[:, k] for x, k in zip(moved, picked, strict=True)]
        page.evaluate(WATCH, [NODE, [[one.node, at] for one, at in zip(drawn, picked, strict=True)]])

    def frames(self, told: list) -> np.ndarray:
        """Times (N, 2) [s] and the frames that both meshes showed (N, 2), -1 where one was not there."""
        shown = [[*row[:2], *map(self._frame, self.places, row[2:])] for row in told]
        return np.array(shown).reshape(-1, 4)

    @staticmethod
    def _frame(places: np.ndarray, vertex: list | None) -> int:
        if vertex is None:
            return -1
        away = np.linalg.norm(places - vertex, axis=1)
        return int(away.argmin()) if away.min() < 1e-5 else -2

    def seen(self) -> np.ndarray:
        return self.frames(self.page.evaluate("() => window.__seen.splice(0)"))

    def follow(self, changes: int = 6, patience: float = 30.0) -> np.ndarray:
        """What is seen from now on, until the frame has changed so often: a busy machine draws few pictures."""
        self.seen()
        told = np.zeros((0, 4))

        def enough() -> bool:
            nonlocal told
            told = np.concatenate([told, self.seen()])
            return np.count_nonzero(np.diff(told[:, 2])) >= changes

        soon(self.page, enough, patience)
        return told

    def now(self) -> np.ndarray:
        """The frames that both meshes show (2,)."""
        return self.frames([self.page.evaluate("() => window.__look(0)")])[0, 2:]


@pytest.fixture(scope="module")
def tab(chromium, hall):
    _, line, clip = hall
    page = chromium.new_page(viewport=VIEW)
    page.add_init_script(SLEEP)
    enter(page, f"http://127.0.0.1:{line.port}/?lang=en")
    stand_before(page, "box")
    page.mouse.move(200, 100)
    soon(page, lambda: page.evaluate("() => hall.playing()") == [NODE])
    yield Watched(page, clip)
    page.close()


@contextmanager
def broken(line):
    """Every connection breaks, and none comes about meanwhile."""
    line.cut()
    time.sleep(0.3)  # until it is cut; a tab tries again after a second
    line.process.send_signal(signal.SIGSTOP)
    try:
        yield
    finally:
        line.process.send_signal(signal.SIGCONT)


def together(told: np.ndarray) -> None:
    """Both meshes showed one frame, and it was the clock's, which nobody stopped, while the picture was written."""
    shown = told[:, 2]
    assert (told[:, 2:] >= 0).all()
    assert np.array_equal(shown, told[:, 3])
    first, last = np.floor(told[:, :2].T * RATE + [[-1e-6], [1e-6]])
    assert ((shown - first) % FRAMES <= last - first).all()


def test_while_it_plays_not_a_byte_goes_over_the_line(hall, tab):
    _, line, _ = hall
    tab.page.wait_for_timeout(1500)  # the walk's last word on where the visitor stands
    before = line.carried()
    together(tab.follow(50))  # two seconds, or more
    assert line.carried() == before


def test_it_goes_on_while_the_line_is_broken_and_after(hall, tab):
    _, line, _ = hall
    notice = tab.page.locator("[data-testid=connection]")
    tab.page.evaluate(MARK, NODE)
    with broken(line):
        notice.wait_for(timeout=PATIENCE)
        together(tab.follow())
        assert notice.is_visible()
    notice.wait_for(state="hidden", timeout=PATIENCE)
    soon(tab.page, lambda: tab.page.evaluate(NEW, NODE))
    together(tab.follow())


@pytest.mark.parametrize("minutes", [0.0, 90.0])
def test_a_tab_that_slept_shows_the_clocks_frame_at_once(tab, minutes):
    page = tab.page
    page.evaluate("() => __sleep()")
    page.wait_for_timeout(200)
    before, drawn = tab.now(), page.evaluate("() => hall.framesDrawn()")
    page.evaluate("() => HALL.beforeFrame(performance.now())")  # a picture that was under way
    page.wait_for_timeout(500)
    assert np.array_equal(tab.now(), before)  # nothing was done meanwhile
    assert page.evaluate("() => hall.framesDrawn()") == drawn
    tab.seen()
    page.evaluate("(seconds) => __wake(seconds)", 60.0 * minutes + 0.35)
    page.wait_for_function("() => __seen.length > 0", timeout=PATIENCE)
    together(tab.seen())  # from the first picture on
    together(tab.follow())


@pytest.mark.nightly
def test_a_clip_that_did_not_come_is_asked_for_again(chromium, hall):
    _, line, clip = hall
    page = chromium.new_page(viewport=VIEW)
    asked = []
    page.route(
        "**/sway.clip*", lambda route: route.continue_() if asked else (asked.append(1), route.abort())
    )
    enter(page, f"http://127.0.0.1:{line.port}/?lang=en")
    stand_before(page, "box")
    page.mouse.move(200, 100)
    soon(page, lambda: page.evaluate("() => hall.playing()") == [NODE])
    page.close()
