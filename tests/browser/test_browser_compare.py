"""What an exhibit compares, in a running hall: on request its meshes stand side by side in the close-up and move."""

import numpy as np
import pytest
from bench.axe import violations
from bench.browser import alive, enter
from bench.wire import wire
from moving_hall import write_comparing_hall
from running_hall import running_hall

pytestmark = [pytest.mark.browser, pytest.mark.nightly]

VIEW = {"width": 900, "height": 600}
NODES = "() => ['/closeup', '/comparison'].filter((name) => window.__viserMutable.nodeRefFromName[name])"
# The least and greatest x [m] of every mesh of the comparison as it stands in its own model.
REACH = """
() => {
  const found = {};
  window.__viserMutable.nodeRefFromName["/comparison"]?.traverse((mesh) => {
    if (!mesh.isMesh) return;
    const x = Array.from(mesh.geometry.attributes.position.array).filter((_, k) => k % 3 === 0);
    found[mesh.name] = [Math.min(...x), Math.max(...x)];
  });
  return found;
}
"""


@pytest.fixture(scope="module")
def hall(tmp_path_factory):
    work = tmp_path_factory.mktemp("compare")
    with running_hall(write_comparing_hall(work / "content"), work) as hall:
        yield hall


def look_closely(chromium, url, lang: str = "en", **options):
    page = chromium.new_page(**{"viewport": VIEW, **options})
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.asked = asked
    enter(page, f"{url}/?lang={lang}&exhibit=box")
    page.locator("html[data-closeup=drawn]").wait_for(state="attached", timeout=60_000)
    return page


@pytest.fixture(scope="module")
def page(chromium, hall):
    page = look_closely(chromium, hall.url)
    yield page
    page.close()


def compared(page) -> None:
    page.locator("[data-testid=tab-compare]").click()
    alive(page, lambda: page.evaluate(NODES) == ["/comparison"] and len(page.evaluate(REACH)) == 3)


def test_nothing_is_fetched_before_it_is_asked_for_and_then_all_move_by_one_clock(page):
    assert page.evaluate(NODES) == ["/closeup"]
    assert not any("three." in url for url in page.asked)
    compared(page)
    seen = []

    def swayed() -> bool:
        seen.append([high for _, high in sorted(page.evaluate(REACH).values())])
        return len(seen) > 12 and np.ptp(seen, axis=0).min() > 0.05

    alive(page, swayed)
    moved = np.array(seen) - seen[0]
    assert np.abs(moved - moved[:, :1]).max() < 1e-3  # the same sway in every picture
    assert sum("three.clip" in url for url in page.asked) == 1


def test_the_table_tells_vertices_distance_and_milliseconds_of_each(page):
    compared(page)
    rows = [
        row.inner_text().split("\t") for row in page.locator("[data-testid=compare-table] tbody tr").all()
    ]
    assert [[cell.strip() for cell in row] for row in rows] == [
        ["Coarse", "8", "12.3", "3.0"],
        ["Learned", "16", "4.0", "8.5"],
        ["Fine", "16", "reference", "1,104.6"],
    ]
    colours = "(all) => all.map((one) => getComputedStyle(one).backgroundColor)"
    marks = page.locator(".compare-mark").evaluate_all(colours)
    assert marks == ["rgb(176, 112, 48)", "rgb(48, 160, 96)", "rgb(48, 96, 176)"]
    assert "Three <b>boxes</b>" in page.locator("[data-testid=compare]").inner_text()
    page.keyboard.press("p")
    assert page.locator("[data-testid=compare-stopped]").is_visible()
    page.keyboard.press("p")
    assert violations(page) == []


def test_another_tab_brings_the_exhibit_back_and_leaving_takes_both_away(page):
    compared(page)
    page.locator("[data-testid=tab-intro]").click()
    alive(page, lambda: page.evaluate(NODES) == ["/closeup"])
    compared(page)
    page.keyboard.press("Escape")
    alive(page, lambda: page.evaluate(NODES) == [])
    assert page.evaluate("() => hall.compares()") is False
    page.evaluate("() => document.querySelector('[data-testid=list]').click()")
    page.locator("[data-testid=list-item-box]").click()
    alive(page, lambda: page.evaluate(NODES) == ["/closeup"])


def test_it_is_there_again_after_a_lost_line(chromium, hall):
    with wire(int(hall.url.rsplit(":", 1)[1])) as line:
        page = look_closely(chromium, f"http://127.0.0.1:{line.port}", lang="zh")
        compared(page)
        page.evaluate("() => { window.__viserMutable.nodeRefFromName['/comparison'].__old = true; }")
        line.cut()
        new = "() => window.__viserMutable.nodeRefFromName['/comparison']?.__old === undefined"
        alive(page, lambda: page.evaluate(NODES) == ["/comparison"] and page.evaluate(new), 90)
        assert page.evaluate("() => hall.compares()")
        assert "豪斯多夫" in page.locator("[data-testid=compare]").inner_text()
        page.close()


def test_for_who_wants_no_motion_they_stand_side_by_side(chromium, hall):
    page = look_closely(chromium, hall.url, reduced_motion="reduce")
    compared(page)
    first = page.evaluate(REACH)
    page.wait_for_timeout(400)
    assert page.evaluate(REACH) == first
    assert not any("three.clip" in url for url in page.asked)
    assert page.locator("[data-testid=compare-stopped]").is_visible()
    page.close()
