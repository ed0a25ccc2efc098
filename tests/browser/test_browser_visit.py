"""A whole visit in a real browser: enter, walk, look closer, read, watch, listen, come back, answer."""

import csv
import io
import subprocess
import sys
import urllib.request

import pytest
from bench.browser import at_rest, back_in_the_hall, displayed, enter, pose, soon, stand_before
from bench.track import place, watch
from full_matrix import by_day

pytestmark = [pytest.mark.browser, pytest.mark.slow]

GARMENT = "pibo"
BEFORE_THE_DAIS = -4.3  # [m] z from which on a visitor who walks at it is stopped


@pytest.fixture(scope="module")
def page(shipped_hall, chromium):
    context = chromium.new_context(viewport={"width": 1280, "height": 720})
    page = context.new_page()
    watch(page)
    page.troubles = []
    page.on("pageerror", lambda error: page.troubles.append(str(error)))
    page.on("requestfailed", lambda request: page.troubles.append(f"{request.url}: {request.failure}"))
    enter(page, f"{shipped_hall.url}/?lang=en")
    yield page
    context.close()


def closed(page) -> None:
    if page.locator("[data-testid=panel]").is_visible():
        page.keyboard.press("Escape")
        page.locator("[data-testid=panel]").wait_for(state="hidden")
    back_in_the_hall(page)


def opened(page, exhibit: str = GARMENT) -> None:
    """From the exhibits' list into the close-up."""
    closed(page)
    page.click("[data-testid=list]")
    page.click(f"[data-testid=list-item-{exhibit}]")
    page.locator("[data-testid=panel]").wait_for()
    page.locator("html[data-closeup=drawn]").wait_for(state="attached", timeout=60_000)


def test_hooks_of_the_pinned_client(page):
    """The page reads viser's internals; an update that takes one away fails here."""
    found = page.evaluate("""() => ({
        mutable: ["camera", "cameraControl", "canvas", "scene", "nodePoseData", "requestRender", "nodeRefFromName"]
            .filter((name) => !window.__viserMutable?.[name]),
        tree: typeof window.__viserSceneTree?.getState,
        info: typeof window.__viserTestpoints?.rendererInfo?.render?.calls,
        tones: window.__viserMutable.scene.__r3f.root.getState().gl.toneMapping,
        frames: typeof window.__viserTestpoints?.rendererInfo?.render?.frame,
        settings: ["get", "set"].filter((name) => !window.__viserTestpoints?.devSettings?.[name]),
        fixed: "fixedDpr" in window.__viserTestpoints.devSettings.get(),
        pose: Object.keys(window.__viserMutable.nodePoseData["/exhibits/pibo"]).sort(),
        outline: (() => {
            let found = 0;
            window.__viserMutable.nodeRefFromName["/exhibits/pibo"].traverse((o) => {
                if (o.material?.uniforms?.thickness !== undefined && o.parent.isGroup) found += 1;
            });
            return found;
        })(),
        gestures: {...window.__viserMutable.cameraControl.mouseButtons},
    })""")
    assert found["mutable"] == []
    assert found["tree"] == "function"
    assert found["info"] == "number"
    assert found["tones"] == 0
    assert found["frames"] == "number"
    assert found["settings"] == []
    assert found["fixed"]
    assert found["pose"] == ["poseUpdateState", "position", "wxyz"]
    assert found["outline"] > 0
    assert {found["gestures"][name] for name in ("left", "middle", "right", "wheel")} == {0}


@pytest.mark.parametrize("width", by_day([480], [1280, 768, 480, 360]))
def test_visers_own_panel_is_out_of_sight(page, width):
    closed(page)
    page.set_viewport_size({"width": width, "height": 720})
    page.wait_for_timeout(600)
    seen = page.evaluate("""() => {
        const found = [];
        for (const fx of [0.1, 0.5, 0.9]) for (const fy of [0.2, 0.5, 0.75]) {
            const element = document.elementFromPoint(innerWidth * fx, innerHeight * fy);
            if (element && !element.closest("#hall-ui") && element.tagName !== "CANVAS")
                found.push(element.outerHTML.slice(0, 90));
        }
        const canvas = document.querySelector("canvas").getBoundingClientRect();
        return {found, canvas: [canvas.width, canvas.height], size: [innerWidth, innerHeight]};
    }""")
    page.set_viewport_size({"width": 1280, "height": 720})
    assert seen["found"] == []
    assert seen["canvas"] == seen["size"]


@pytest.mark.door
def test_walks_and_is_stopped(page):
    closed(page)
    place(page, 0.0, -2.0, 0.0)
    before = pose(page)
    page.keyboard.down("KeyW")
    page.wait_for_function("(z) => hall.pose().z < z - 1", arg=before["z"], timeout=60_000)
    # Of a machine that has much else to do a picture may stand for long, however far the way is still free.
    soon(page, lambda: at_rest(page)[2] < BEFORE_THE_DAIS, 90)
    still = at_rest(page)
    assert still[2] > -8  # the dais and the wall behind it
    page.keyboard.up("KeyW")
    assert at_rest(page) == pytest.approx(still, abs=1e-3)


def test_near_an_exhibit_its_caption_appears_and_enter_opens_it(page):
    closed(page)
    stand_before(page, GARMENT)
    page.locator("[data-testid=caption]", has_text="pibo").wait_for(timeout=60_000)
    page.keyboard.press("Enter")
    page.locator("[data-testid=panel]").wait_for(timeout=60_000)
    assert page.evaluate("() => hall.opened()") == GARMENT


LOOKED_AT = """
async ([ids, exhibits, pose, current]) => {
  const {lookedAt} = await import("/static/ui/map/geometry.js");
  return lookedAt(new Set(ids), exhibits, pose, current);
}
"""
AROUND = [{"id": "ahead", "x": 0, "z": -2}, {"id": "right", "x": 2, "z": 0}, {"id": "behind", "x": 0, "z": 1}]


@pytest.mark.parametrize(
    ("ids", "yaw", "current", "meant"),
    [
        (["ahead", "right", "behind"], 0.0, None, "ahead"),
        (["right", "behind"], 0.0, None, "right"),
        (["ahead", "right"], -1.5, None, "right"),
        (["ahead", "right"], -0.75, None, "ahead"),  # a little more nearly
        (["ahead", "right"], -0.75, "right", "right"),  # but not so clearly that the caption changes
        (["ahead", "behind"], 3.1 - 20 * 3.141592653589793, None, "behind"),  # after ten turns
        ([], 0.0, "ahead", None),
        (["gone"], 0.0, "gone", None),
    ],
)
def test_of_several_exhibits_the_one_ahead_is_meant(page, ids, yaw, current, meant):
    pose = {"x": 0.0, "z": 0.0, "yaw": yaw}
    assert page.evaluate(LOOKED_AT, [ids, AROUND, pose, current]) == meant


def test_between_two_exhibits_the_caption_names_the_one_that_is_looked_at(page):
    """Whichever noticed the visitor last: the robe on its bar stands beside the wrap robe, and comes as near."""
    closed(page)
    stand_before(page, "quju")
    page.locator("[data-testid=caption]", has_text="Curved wrap robe").wait_for(timeout=60_000)
    page.evaluate("() => hall.goTo(-8.3, 4.1, Math.PI / 2)")
    page.locator("[data-testid=caption]", has_text="Straight robe").wait_for(timeout=60_000)
    stand_before(page, "quju")
    page.locator("[data-testid=caption]", has_text="Curved wrap robe").wait_for(timeout=60_000)


# Where the face of an exhibit is drawn that is nearest to the eye, of those that nothing of the page covers [px].
NEAREST = """(id) => {
  const { camera, nodeRefFromName } = window.__viserMutable;
  const found = [];
  nodeRefFromName[`/exhibits/${id}`].traverse((mesh) => {
    const { index, attributes } = mesh.isMesh ? mesh.geometry : {};
    const corner = (at) => mesh.position.clone().fromBufferAttribute(attributes.position, index.getX(at));
    for (let at = 0; at < (index?.count ?? 0); at += 3) {
      const corners = [0, 1, 2].map((n) => corner(at + n));
      const centre = corners[0].add(corners[1]).add(corners[2]).divideScalar(3).applyMatrix4(mesh.matrixWorld);
      found.push([centre.distanceTo(camera.getWorldPosition(mesh.position.clone())), centre]);
    }
  });
  for (const [, centre] of found.sort((a, b) => a[0] - b[0])) {
    const seen = centre.project(camera), x = ((seen.x + 1) / 2) * innerWidth, y = ((1 - seen.y) / 2) * innerHeight;
    if (document.elementFromPoint(x, y)?.tagName === "CANVAS") return [x, y];
  }
  return null;
}"""


def test_click_on_the_exhibit_opens_it(page):
    closed(page)
    stand_before(page, GARMENT)
    seen: list[tuple[float, float] | None] = []  # None: out of sight

    def settled() -> bool:  # the view may be on its way back, in jerks
        page.wait_for_timeout(450)
        found = page.evaluate(NEAREST, GARMENT)
        seen.append(found and tuple(found))
        return len(seen) >= 4 and seen[-1] is not None and len(set(seen[-4:])) == 1

    soon(page, settled, 60)
    page.mouse.click(*seen[-1])
    page.locator("[data-testid=panel]").wait_for(timeout=60_000)
    assert page.evaluate("() => hall.opened()") == GARMENT


@pytest.mark.nightly
def test_the_fine_model_can_be_turned(page):
    opened(page)
    page.wait_for_timeout(300)
    before = displayed(page)
    page.mouse.move(400, 350)
    page.mouse.down()
    page.mouse.move(250, 350, steps=6)
    page.mouse.up()
    page.wait_for_timeout(600)
    soon(page, lambda: max(abs(a - b) for a, b in zip(before, displayed(page), strict=True)) > 0.2)
    turned = displayed(page)
    middle = [500, turned[1], 0]

    def away() -> float:
        return sum((a - b) ** 2 for a, b in zip(displayed(page), middle, strict=True))

    far = away()
    page.mouse.wheel(0, -400)
    soon(page, lambda: away() < far)


@pytest.mark.nightly
def test_cloth_is_shaded_towards_the_visitor(page):
    """Every fine mesh drawn from both sides has the shading that leaves no dots along folds, and it compiles."""
    opened(page)
    found = page.evaluate("""() => {
        const found = [], m = window.__viserMutable, {properties} = m.scene.__r3f.root.getState().gl;
        m.nodeRefFromName["/closeup"].traverse((o) => {
            if (o.isMesh && o.material.side === 2) {
                const program = properties.get(o.material).currentProgram;
                const source = program?.fragmentShader;
                found.push([o.material.userData.bySight === true, program?.diagnostics === undefined, Boolean(source)]);
            }
        });
        return found;
    }""")  # fmt: skip
    assert found
    assert all(all(mesh) for mesh in found)


@pytest.mark.nightly
def test_text_in_both_languages(page):
    opened(page)
    page.click("[data-testid=tab-intro]")
    text = page.locator("[data-testid=exhibit-text]")
    assert "light cloth" in text.inner_text()
    page.click("[data-testid=lang-zh]")
    assert "披帛" in text.inner_text()
    page.click("[data-testid=lang-en]")
    assert "light cloth" in text.inner_text()


@pytest.mark.nightly
def test_every_picture_shows_and_says_what_it_is(page):
    opened(page)
    page.click("[data-testid=tab-pictures]")
    pictures = page.locator("[data-testid=sheet-pictures] img")
    assert pictures.count() >= 2
    for index in range(pictures.count()):
        picture = pictures.nth(index)
        picture.scroll_into_view_if_needed()
        shown = "(image) => image.complete && image.naturalWidth > 100"
        soon(page, lambda picture=picture, shown=shown: picture.evaluate(shown))
        assert len(picture.get_attribute("alt")) > 10


@pytest.mark.door
@pytest.mark.parametrize(
    ("tab", "kind"), by_day([("film", "video")], [("film", "video"), ("sound", "audio")])
)
def test_media_play(page, tab, kind):
    opened(page)
    page.click(f"[data-testid=tab-{tab}]")
    medium = page.locator(f"[data-testid=sheet-{tab}] {kind}").first
    medium.evaluate("(medium) => { medium.muted = true; return medium.play(); }")
    soon(page, lambda: medium.evaluate("(m) => m.error !== null || m.currentTime > 0.3"))
    long, error = medium.evaluate("(m) => [m.duration, m.error && m.error.message]")
    assert error is None
    assert long > 3
    medium.evaluate("(medium) => { medium.currentTime = medium.duration * 0.8; }")  # needs Range requests
    soon(page, lambda: medium.evaluate("(m) => m.readyState >= 2 && m.currentTime") > long * 0.75)


@pytest.mark.nightly
def test_both_film_formats_are_whole(shipped_hall, page):
    opened(page)
    urls = page.evaluate("async () => (await (await fetch('/api/exhibits/pibo')).json()).media"
                         ".filter((m) => m.kind === 'video').flatMap((m) => m.sources.map((s) => s.url))")  # fmt: skip
    assert {url.split("?")[0].rsplit(".", 1)[-1] for url in urls} == {"webm", "mp4"}
    import av

    for url in urls:
        with urllib.request.urlopen(shipped_hall.url + url) as answer:
            data = io.BytesIO(answer.read())
        with av.open(data) as film:
            assert sum(1 for _ in film.decode(video=0)) > 50


@pytest.mark.nightly
def test_escape_leads_back_to_the_same_spot(page):
    closed(page)
    before = displayed(page)
    opened(page)
    soon(page, lambda: displayed(page)[0] > 400)
    closed(page)
    assert displayed(page) == pytest.approx(before, abs=1e-6)


@pytest.mark.nightly
def test_escape_leads_back_from_a_films_own_controls(page):
    """Chromium keeps keys that fall inside a film's controls from the page."""
    opened(page)
    page.click("[data-testid=tab-film]")
    # Its controls are those of a film that is known; until then there are fewer.
    page.wait_for_function("() => document.querySelector('[data-testid=sheet-film] video').readyState >= 1")
    page.focus("[data-testid=sheet-film] video")
    # To its last control: how many there are depends on the film's width and on what is known of it.
    for _ in range(20):
        page.keyboard.press("Tab")
        if page.evaluate("() => document.activeElement.tagName") != "VIDEO":
            break
    page.keyboard.press("Shift+Tab")
    assert page.evaluate("() => document.activeElement.tagName") == "VIDEO"
    page.keyboard.press("Escape")
    page.locator("[data-testid=panel]").wait_for(state="hidden")
    back_in_the_hall(page)


@pytest.mark.nightly
def test_escape_closes_a_window_over_the_close_up_first(page):
    opened(page)
    page.click("[data-testid=tab-pictures]")
    page.locator("[data-testid=sheet-pictures] .picture").first.click()
    page.locator("dialog[open]").wait_for()
    page.keyboard.press("Escape")
    page.locator("dialog[open]").wait_for(state="detached")
    assert page.locator("[data-testid=panel]").is_visible()
    page.keyboard.press("Escape")
    page.locator("[data-testid=panel]").wait_for(state="hidden")


@pytest.mark.door
def test_enter_opens_the_exhibit_one_has_walked_to(page):
    """A window gives the focus back to its button; walking gives it back to the hall."""
    closed(page)
    stand_before(page, GARMENT)
    page.focus("[data-testid=settings]")
    page.keyboard.press("Enter")
    page.locator("dialog[open]").wait_for()
    page.keyboard.press("Escape")
    page.locator("dialog[open]").wait_for(state="detached")
    assert page.evaluate("() => document.activeElement.dataset.testid") == "settings"
    page.keyboard.press("KeyW")
    page.locator("[data-testid=caption]", has_text="pibo").wait_for(timeout=60_000)
    page.keyboard.press("Enter")
    page.locator("[data-testid=panel]").wait_for(timeout=60_000)
    assert page.locator("dialog[open]").count() == 0
    assert page.evaluate("() => hall.opened()") == GARMENT


def test_typing_never_walks(page):
    closed(page)
    page.evaluate("""() => {
        const field = document.createElement("input");
        field.id = "probe";
        field.style.pointerEvents = "auto";
        document.querySelector("#hall-ui").append(field);
        field.focus();
    }""")
    before = at_rest(page)
    page.keyboard.type("wasd wasd")
    page.wait_for_timeout(300)
    assert page.evaluate("() => document.querySelector('#probe').value") == "wasd wasd"
    assert displayed(page) == before
    page.evaluate("() => document.querySelector('#probe').remove()")


def test_music_starts_with_entering_and_can_be_switched(page):
    closed(page)
    button = page.locator("[data-testid=music]")
    assert button.get_attribute("aria-pressed") == "true"
    button.click()
    assert button.get_attribute("aria-pressed") == "false"


@pytest.mark.door
def test_questionnaire_is_answered_and_exported(page, shipped_hall):
    opened(page)
    page.click("[data-testid=survey]")
    form = page.frame_locator("[data-testid=survey-frame]")
    form.locator("input[type=radio]").first.wait_for(timeout=60_000)
    for name in dict.fromkeys(
        form.locator("input[type=radio]").evaluate_all("(inputs) => inputs.map((input) => input.name)")
    ):
        form.locator(f"input[type=radio][name='{name}'][value='4']").check(force=True)
    form.locator("input[type=checkbox]").first.check(force=True)
    form.locator("#send").click()
    page.locator("[data-testid=survey]", has_text="Answered").wait_for(
        timeout=60_000
    )  # stays, unlike the toast
    command = [
        sys.executable,
        "-m",
        "survey.cli",
        "export",
        "--questionnaire",
        "garment",
        "--data",
        shipped_hall.data,
    ]
    done = subprocess.run(
        [*command, "--content", shipped_hall.content], capture_output=True, text=True, check=True
    )
    rows = list(csv.DictReader(io.StringIO(done.stdout.lstrip("\ufeff"))))
    assert len(rows) == 1
    assert "4" in rows[0].values()
    assert GARMENT in rows[0].values()


def test_no_trouble_on_the_way(page):
    # A browser that drops a medium it no longer needs reports the request as aborted.
    troubles = [t for t in page.troubles if "ERR_ABORTED" not in t]
    assert troubles == []
