"""One place, or a server that is away: whoever waits long for the hall gets its picture too, and is told the truth."""

import pytest
from bench.browser import PATIENCE, enter, pose, soon
from plain_hall import write_plain_hall
from running_hall import free_port, running_hall

pytestmark = [pytest.mark.nightly, pytest.mark.browser, pytest.mark.slow]

VIEW = {"width": 480, "height": 270}
LONG = 42_000  # [ms] enough refusals in that time and Chromium opens no more sockets in time
LABEL = "[data-testid=progress-label]"
DRAWN = """() => {
  let meshes = 0;
  window.__viserMutable?.nodeRefFromName?.["/exhibits/box"]?.traverse((child) => { meshes += child.isMesh ? 1 : 0; });
  return meshes > 0;
}"""

# viser has told this page which of its clients it is.
KNOWN = """() => Boolean(document.querySelector("[data-hall-client]")?.dataset.hallClient)
  || Object.keys(window.__viserSceneTree?.getState() ?? {}).some((name) => name.startsWith("/_visitor/"))"""

# Whether viser's picture was there each time that "Connected again" was said.
TOLD = """() => {
  window.__said = [];
  new MutationObserver((changes) => {
    for (const { addedNodes } of changes)
      for (const node of addedNodes)
        if (node.textContent === "Connected again") window.__said.push(window.HALL.view.here);
  }).observe(document.querySelector(".toasts"), { childList: true });
}"""


@pytest.fixture(scope="module")
def hall_for_one(tmp_path_factory):
    work = tmp_path_factory.mktemp("one")
    with running_hall(write_plain_hall(work / "content"), work, "--visitors", "1") as hall:
        yield hall


@pytest.mark.parametrize("options", ["", "&withoutHooks=1"], ids=["page", "withoutHooks"])
def test_who_waited_long_gets_the_picture_and_walks(hall_for_one, chromium, options):
    first = chromium.new_context(viewport=VIEW)
    enter(first.new_page(), f"{hall_for_one.url}/?lang=en")
    context = chromium.new_context(viewport=VIEW)
    second = context.new_page()
    second.add_init_script("localStorage['hall.quality'] ??= 'low'")
    second.goto(f"{hall_for_one.url}/?lang=en{options}", wait_until="commit")
    label = second.locator(LABEL)
    soon(second, lambda: "You are number 1 in the queue" in label.inner_text(), 60)
    second.wait_for_timeout(LONG)
    assert second.locator("[data-testid=enter]").is_disabled()
    assert "You are number 1 in the queue" in label.inner_text()
    assert not second.locator(".enter-percent").is_visible()
    assert not second.locator("[data-testid=connection]").is_visible()
    assert not second.locator("[data-testid=enter-failure]").is_visible()
    assert (
        second.get_attribute("[data-testid=catalogue]", "target") == "_blank"
    )  # reading there keeps the place
    second.click("[data-testid=lang-zh]")
    assert "您排在第 1 位" in label.inner_text()
    first.close()
    second.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=PATIENCE)
    assert "展厅已就绪" in label.inner_text()
    if not options:
        assert second.evaluate(DRAWN)
    second.click("[data-testid=enter]")
    second.locator("[data-testid=enter-screen]").wait_for(state="detached", timeout=PATIENCE)
    before = pose(second)
    second.keyboard.down("w")
    soon(second, lambda: abs(pose(second)["z"] - before["z"]) > 0.3)
    second.keyboard.up("w")
    soon(second, lambda: second.evaluate(KNOWN))
    context.close()


def test_the_picture_comes_back_with_the_walk(chromium, tmp_path):
    """The server is away for long, and comes back: with it the walk, the picture, and then the word that it has."""
    content, port = write_plain_hall(tmp_path / "content"), free_port()
    page = chromium.new_page(viewport=VIEW)
    with running_hall(content, tmp_path / "work", port=port) as hall:
        enter(page, f"{hall.url}/?lang=en")
        page.evaluate(TOLD)
    page.wait_for_timeout(LONG)
    reload = page.locator("[data-testid=connection] button")
    assert reload.is_visible()
    exhibit = content / "exhibits" / "box" / "exhibit.toml"
    exhibit.write_text(exhibit.read_text("utf-8").replace("Plain box", "Painted box"), "utf-8")
    with running_hall(content, tmp_path / "work", port=port):
        soon(page, lambda: not page.locator("[data-testid=connection]").is_visible(), 60)
        soon(page, lambda: page.evaluate(KNOWN))
        # "Connected again", once, and the picture was there.
        assert page.evaluate("() => window.__said") == [True]
        page.evaluate("() => document.querySelector('[data-testid=stage]').focus()")
        page.evaluate("() => hall.goTo(2.5, 4.2, 0)")
        soon(page, lambda: page.locator("[data-testid=caption]").is_visible())
        page.locator("[data-testid=caption]", has_text="Painted box").wait_for(timeout=PATIENCE)
        page.keyboard.press("Enter")
        page.wait_for_function("() => hall.opened() === 'box' && hall.closeupAt() !== null", timeout=PATIENCE)
        page.close()
