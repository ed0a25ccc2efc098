"""axe itself: it sees what is wrong, also in a frame, or a clean report means nothing."""

import pytest
from bench.axe import violations

pytestmark = [pytest.mark.browser, pytest.mark.slow]

GOOD = '<html lang="en"><title>t</title><main><h1>A hall</h1><p>of dress</p></main></html>'
BAD = '<html><title>t</title><main><h1>A hall</h1><h3>of dress</h3><img src="data:,"></main></html>'


def test_faults_are_found_and_named(chromium):
    page = chromium.new_page()
    page.set_content(GOOD)
    assert violations(page) == []
    page.set_content(BAD)
    rules = {line.partition(" ")[0] for line in violations(page)}
    assert {"html-has-lang", "heading-order", "image-alt"} <= rules
    assert violations(page, within="h1") == []
    page.close()


def test_faults_in_a_frame_are_found(chromium):
    page = chromium.new_page()
    inside = "<html lang=en><title>f</title><h1>In it</h1><img src=data:,></html>"
    page.set_content(GOOD.replace("</main>", f'<iframe title="f" srcdoc="{inside}"></iframe></main>'))
    page.frame_locator("iframe").locator("h1").wait_for()
    assert [line.partition(" ")[0] for line in violations(page)] == ["image-alt"]
    page.close()
