"""The door on a slow line: when it is painted, when the hall stands behind it, what it cost, how progress went."""

import time

from .wire import Wire

BITS, ROUND_TRIP = 1.6e6, 0.3  # [bit/s], [s] a poor mobile line
SIZE = {"width": 480, "height": 270}

# When the title can be read, and every value the progress bar has shown: [ms since navigation, per cent, label].
WATCH = """
(() => {
  const seen = window.doorSeen = { title: null, progress: [] };
  const look = () => {
    const title = document.querySelector("#hall-ui .enter-title");
    if (seen.title === null && title?.innerText.trim() && title.getBoundingClientRect().width)
      seen.title = performance.now();
    const bar = document.querySelector("#hall-ui .enter-bar");
    const now = Number(bar?.getAttribute("aria-valuenow") ?? NaN);
    if (!Number.isNaN(now) && now !== seen.progress.at(-1)?.[1])
      seen.progress.push([performance.now(), now, document.querySelector("[data-testid=progress-label]")?.innerText]);
    requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
})();
"""
PAINTED = "() => performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? null"
ENTRY = """() => {
  const { transferSize, responseEnd, requestStart, redirectCount } = performance.getEntriesByType("navigation")[0];
  const blocking = performance.getEntriesByType("resource").filter((r) => r.renderBlockingStatus === "blocking");
  return { bytes: transferSize, redirects: redirectCount, ended: responseEnd, asked: requestStart,
           blocking: blocking.map((r) => r.name) };
}"""


def slow_visit(browser, line: Wire, query: str = "lang=en", size: dict | None = None) -> dict:
    """One cold visit over `line`, until the hall may be entered.

    Returns painted_s, title_s, ready_s since navigation, bytes of the whole first view, `door`: the document's own
    bytes and what blocked the first paint, `progress`: list of (s, per cent, label).
    """
    carried = line.carried()
    context = browser.new_context(viewport=size or SIZE)
    page = context.new_page()
    page.add_init_script(WATCH)
    began = time.perf_counter()
    page.goto(f"http://127.0.0.1:{line.port}/?{query}", wait_until="commit")
    page.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=180_000)
    ready = time.perf_counter() - began
    page.wait_for_timeout(500)
    seen, painted, door = page.evaluate("() => doorSeen"), page.evaluate(PAINTED), page.evaluate(ENTRY)
    context.close()
    return {
        "painted_s": painted / 1000,
        "title_s": seen["title"] / 1000,
        "ready_s": ready,
        "bytes": line.carried() - carried,
        "door": door,
        "progress": [(at / 1000, value, label) for at, value, label in seen["progress"]],
    }


def longest_stand(visit: dict) -> float:
    """The longest time [s] for which progress showed the same value while bytes flowed: up to 85 per cent."""
    times = [at for at, value, _ in visit["progress"] if value < 85]
    return max((b - a for a, b in zip(times, times[1:], strict=False)), default=visit["ready_s"])
