"""Chromium for tests and benches: Debian's, or Playwright's own."""

import contextlib
import shutil
import time
from collections.abc import Callable, Iterator

FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
PATIENCE = 120_000  # [ms]


class NoBrowserError(RuntimeError):
    """There is no Chromium on this machine."""


@contextlib.contextmanager
def open_browser() -> Iterator:
    """Playwright's browser object. Raises NoBrowserError, saying what to install."""
    try:
        from playwright.sync_api import Error, sync_playwright
    except ImportError as error:
        raise NoBrowserError("playwright is missing – pip install '.[test]'") from error
    path = next((found for name in ("chromium", "chromium-browser") if (found := shutil.which(name))), None)
    with sync_playwright() as playwright:
        try:
            browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        except Error as error:
            raise NoBrowserError(
                f"no Chromium – apt-get install chromium ({error.message.splitlines()[0]})"
            ) from error
        try:
            yield browser
        finally:
            browser.close()


CHOOSE = "(level) => { localStorage['hall.quality'] ??= level; }"


def enter(page, url: str, *, quality: str | None = "low") -> None:
    """Open the hall at `url`, go in and wait for what is not in its first view, unless an exhibit opens at once, for
    which that waits; `quality` of the picture if none is chosen yet, None leaves it to the page."""
    if quality is not None:
        page.add_init_script(f"({CHOOSE})({quality!r})")
    page.goto(url)
    page.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=PATIENCE)
    page.click("[data-testid=enter]")
    page.locator("[data-testid=enter-screen]").wait_for(state="detached", timeout=PATIENCE)
    # An earlier hall, for comparing, has all in its first view; where the server walks nothing is known of viser.
    whole = "() => hall.display() !== 'page' || (hall.whole?.() ?? true) || hall.opened() !== null"
    page.wait_for_function(whole, timeout=PATIENCE)


def pose(page) -> dict:
    """The visitor's pose as the page has it: x, z, eye [m], yaw, pitch [rad]."""
    return page.evaluate("() => hall.pose()")


def stand_before(page, exhibit: str) -> None:
    """Walk to where the map's list would lead: in front of the exhibit of that id."""
    page.evaluate(
        """async (id) => {
        const {standBefore} = await import("/static/ui/map/geometry.js");
        const scene = await (await fetch("/api/scene")).json();
        const {x, z, yaw} = standBefore(scene.exhibits.find((exhibit) => exhibit.id === id), scene);
        hall.goTo(x, z, yaw);
    }""",
        exhibit,
    )


def open_exhibit(page, exhibit: str) -> None:
    """Its close-up, by the list, once it is drawn."""
    page.click("[data-testid=list]")
    page.click(f"[data-testid=list-item-{exhibit}]")
    page.locator("html[data-closeup=drawn]").wait_for(state="attached", timeout=PATIENCE)


def displayed(page) -> list[float]:
    """Where the picture is really seen from [m]."""
    return page.evaluate("() => hall.displayed()")


# Waits until twelve frames in a row have not changed what TELLS, and hands that back; an error where it goes on
# changing, or where no frame comes: a promise that nothing keeps would be waited for for ever.
AT_REST = """
async (patience) => {
  const tell = () => JSON.stringify(TELLS);
  const frames = (n) => new Promise((done) => {
    const next = () => (n-- ? requestAnimationFrame(next) : done());
    next();
  });
  let before = null, over = false;
  const rest = async () => {
    while (!over) {
      await frames(12);
      if (before === tell()) return JSON.parse(before);
      before = tell();
    }
  };
  const late = new Promise((_, fail) => setTimeout(() => {
    over = true;
    fail(new Error(`not at rest after ${patience} ms: ${before}, now ${tell()}`));
  }, patience));
  return Promise.race([rest(), late]);
}
"""


def at_rest(page) -> list[float]:
    """Where the picture is seen from [m] once its camera has come to rest, however long a frame takes."""
    page.wait_for_timeout(300)  # it sets out
    return rested(page, "hall.displayed()")


def rested(page, tells: str):
    """What a JavaScript expression tells once frames no longer change it."""
    return page.evaluate(AT_REST.replace("TELLS", tells), PATIENCE)


def soon(page, holds: Callable[[], object], patience: float = 30.0) -> None:
    """Wait until `holds()` is true: what a page does late, on a machine that has much else to do, it still does."""
    end = time.monotonic() + patience
    while not holds():
        assert time.monotonic() < end, f"not within {patience:.0f} s"
        page.wait_for_timeout(50)


def alive(page, holds: Callable[[], object], patience: float = 30.0) -> None:
    """Wait until `holds()` is true, with a visitor who moves now and then."""
    seen = iter(range(10_000))
    soon(page, lambda: page.mouse.move(100 + next(seen) % 50, 300) or holds(), patience)


def back_in_the_hall(page) -> None:
    """Wait until the picture is seen from the hall again, not from the studio."""
    soon(page, lambda: displayed(page)[0] < 400, PATIENCE / 1000)


# Nothing fades or slides any more; what turns for ever does not count.
STILL = """
() => document.getAnimations().every(
    (a) => a.playState !== "running" || a.effect.getComputedTiming().endTime === Infinity)
"""


def settled(page) -> None:
    """Wait until what a click, a key or a resize began has come to its end."""
    page.wait_for_timeout(450)
    page.wait_for_function(STILL, timeout=PATIENCE)
