"""A clip in the page: it reads what Python wrote, writes whole frames, and asks for nothing where nobody sees it."""

from pathlib import Path

import numpy as np
import pytest
from bench.clip_cases import striding, waving
from bench.clip_page import ClipPage

from sim_core.body import Mannequin
from sim_core.garment.clip import Clip, Drawn, Moved, Skinned
from sim_core.picture import normals

pytestmark = pytest.mark.browser

FRAMES = 20
ASSETS = Path(__file__).parents[2] / "assets"


def figure_of(name: str) -> Skinned:
    """The upper half of a figure, small enough to be handed over as text."""
    figure = Mannequin.load(ASSETS / "mannequins" / f"{name}.npz")
    kept = np.flatnonzero(figure.vertices[:, 1] > 0.9)
    number = np.full(len(figure.vertices), -1)
    number[kept] = np.arange(len(kept))
    faces = number[figure.faces]
    faces = faces[(faces >= 0).all(1)]
    drawn = (Drawn("figure", np.arange(len(kept), dtype=np.int32)),)
    return Skinned.of(figure, striding(FRAMES), part=(kept, faces), drawn=drawn)


@pytest.fixture(scope="module")
def clip() -> Clip:
    """A sheet that is drawn as two meshes, with twins; and half a figure."""
    sheet = waving(edge=0.05, frames=FRAMES)
    count = sheet.positions.shape[1]
    twins = np.r_[np.arange(count), np.arange(0, count, 3)].astype(np.int32)
    drawn = (Drawn("sheet 1", twins), Drawn("sheet.2", np.arange(5, dtype=np.int32)))
    other = Moved("other", waving(edge=0.2, frames=FRAMES).positions + 0.5, waving(edge=0.2).faces)
    moved = Moved("sheet", sheet.positions, sheet.faces, drawn)
    return Clip.of([other, moved], figure=figure_of("woman"), loop=True)


@pytest.fixture(scope="module")
def page(chromium, clip):
    tab = chromium.new_page()
    figure = clip.figure
    assert figure is not None
    models = [("sheet_1", len(clip.meshes[1].drawn[0].index)), ("sheet2", 5), ("figure", len(figure.rest))]
    yield ClipPage(tab, clip.to_bytes(), [*models, ("base", 9)])
    tab.close()


def test_reads_what_python_wrote(page, clip):
    assert page.told == {"frames": FRAMES, "period": pytest.approx(0.8), "names": ["other", "sheet"]}
    told = np.array(page.tab.evaluate("() => Array.from(clip.steps)")).reshape(FRAMES, -1, 3)
    assert np.array_equal(told, clip.steps)
    for number, mesh in enumerate(clip.meshes):
        faces = page.tab.evaluate("(k) => Array.from(clip.meshes[k].faces)", number)
        assert np.array_equal(np.array(faces).reshape(-1, 3), mesh.faces)


@pytest.mark.parametrize("frame", [0, 7, FRAMES - 1])
def test_writes_garment_and_figure_of_one_frame(page, clip, frame):
    assert page.play(3 * 0.8 + (frame + 0.5) / 25)
    sheet, index = clip.positions(frame, "sheet"), clip.meshes[1].drawn[0].index
    found, lit = page.arrays(0)
    assert np.abs(found - sheet[index]).max() < 1e-6
    assert np.abs(lit - normals(sheet, clip.faces("sheet"))[index]).max() < 1e-4
    assert np.abs(page.arrays(1)[0] - sheet[:5]).max() < 1e-6
    figure, shaded = page.arrays(2)
    assert np.abs(figure - clip.positions(frame, "figure")).max() < 1e-6  # 0.5 mm are asked for
    true = normals(clip.positions(frame, "figure"), clip.faces("figure"))
    assert np.quantile(np.abs(shaded - true).max(1), 0.99) < 1e-3
    assert not page.arrays(3)[0].any()  # the base stands still


def test_a_figure_whose_joints_are_all_screws(chromium):
    """One of another skin: the same blending in the page as where it was simulated."""
    skinned = figure_of("woman")
    dual = Skinned(**{**skinned.__dict__, "skin": "dual"})
    small = Clip.of([waving(edge=0.2, frames=FRAMES)], figure=dual)
    tab = chromium.new_page()
    page = ClipPage(tab, small.to_bytes(), [("figure", len(dual.rest))])
    page.play(5.5 / 25)
    away = np.abs(page.arrays(0)[0] - small.positions(5, "figure")).max()
    linear = np.abs(skinned.posed(5) - dual.posed(5)).max()
    tab.close()
    assert linear > 1e-3
    assert away < 1e-6


def test_a_picture_is_asked_for_once_a_frame(page):
    page.play(0.02)
    before = page.asked()
    assert not page.play(0.021)
    assert not page.play(0.039)
    assert page.asked() == before
    assert page.play(0.041)
    assert page.asked() == before + 1


def test_what_nobody_sees_costs_nothing(page):
    page.play(0.0)
    before, (kept, _) = page.asked(), page.arrays(0)
    for k in range(1, 20):
        assert not page.play(0.04 * k + 0.02, seen=False)
    page.tab.evaluate("() => Object.defineProperty(document, 'hidden', {value: true, configurable: true})")
    assert not page.play(0.5)
    page.tab.evaluate("() => { delete document.hidden; }")
    assert page.asked() == before
    assert np.array_equal(page.arrays(0)[0], kept)


def test_new_meshes_are_found_and_bounded(page, clip):
    """As after viser's socket connected again: the same frame, on the new ones."""
    page.play(0.1)
    page.tab.evaluate("() => make()")
    assert page.play(0.1)
    assert np.abs(page.arrays(1)[0] - clip.positions(2, "sheet")[:5]).max() < 1e-6
    told = page.tab.evaluate(
        """() => __meshes.slice(0, 3).map(({geometry: {boundingSphere, boundingBox}}) =>
        [boundingSphere.center.at, boundingSphere.radius, boundingBox])"""
    )
    for number, name in ((0, "sheet"), (2, "figure")):
        centre, radius, box = told[number]
        assert box is None
        for frame in range(FRAMES):
            assert np.linalg.norm(clip.positions(frame, name) - centre, axis=1).max() <= radius


def test_no_mesh_or_another_model_is_left_alone(page):
    page.tab.evaluate("() => { window.__kept = __meshes; window.__meshes = [__meshes[3]]; }")
    before = page.asked()
    assert not page.play(0.3)
    page.tab.evaluate("() => { window.__meshes = __kept; }")
    assert page.asked() == before
    assert page.play(0.3)


CLOCK = """
() => {
  let now = 5000;
  const clock = createClock(() => now), seen = [], heard = [];
  clock.watch((stopped) => heard.push(stopped));
  const look = (passed) => { now += passed; seen.push(clock.seconds()); };
  look(0); look(1000);
  clock.toggle(); look(3000); look(1);
  clock.toggle(); look(0); look(500); look(3600e3);
  return {seen, heard, stopped: clock.stopped};
}
"""


def test_the_clock_stops_and_goes_on_where_it_stopped(page):
    told = page.tab.evaluate(CLOCK)
    assert told["seen"] == pytest.approx([5.0, 6.0, 6.0, 6.0, 6.0, 6.5, 3606.5])
    assert told["heard"] == [False, True, False]
    assert not told["stopped"]


def test_the_clock_stands_for_who_asks_for_less_motion(page):
    page.tab.emulate_media(reduced_motion="reduce")
    told = page.tab.evaluate(CLOCK)
    page.tab.emulate_media(reduced_motion="no-preference")
    assert told["heard"] == [True, False, True]
    assert told["seen"][0] == told["seen"][1] == 0.0


@pytest.mark.parametrize(
    "change", ["bytes[0] = 1", "bytes = bytes.slice(0, -3)", "bytes[bytes.length - 9] ^= 255"]
)
def test_damaged_clips_are_refused(page, clip, change):
    told = page.tab.evaluate(
        f"""async (given) => {{
        let bytes = Uint8Array.from(given);
        {change};
        return readClip(bytes.buffer).then(() => null, (error) => String(error));
    }}""",
        list(Clip.of([waving(edge=0.2, frames=3)]).to_bytes()),
    )
    assert told


CREASE = """
([index, normal]) => {
  const {geometry} = __meshes[0];
  geometry.index = {array: Uint32Array.from(index)};
  geometry.attributes.normal.array.set(normal);
  window.playback = replay();
}
"""


@pytest.mark.parametrize("sharp", [True, False])
def test_both_sides_of_a_crease_keep_their_own_light(chromium, sharp: bool) -> None:
    flat = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1], [2, 0, 0], [2, 0, 1]], float)
    fold, faces = flat.copy(), np.array([[0, 2, 1], [0, 3, 2], [1, 5, 4], [1, 2, 5]], np.int32)
    fold[4:, :2] = [[1.2, 0.9]]
    index = np.array([0, 1, 2, 3, 1, 2, 4, 5], np.int32)  # the edge is there twice
    drawn_faces = np.array([0, 2, 1, 0, 3, 2, 4, 7, 6, 4, 5, 7])
    sides = np.array([[0, 1, 0]] * 4 + [[-0.9, 0.4, 0] if sharp else [0, 1, 0]] * 4, float)
    clip = Clip.of([Moved("fold", np.stack([flat, fold]), faces, (Drawn("fold", index),))])
    tab = chromium.new_page()
    page = ClipPage(tab, clip.to_bytes(), [("fold", len(index))])
    tab.evaluate(CREASE, [drawn_faces.tolist(), sides.ravel().tolist()])
    page.play(1.5 / 25)
    lit = page.arrays(0)[1]
    tab.close()
    own = normals(fold[index], drawn_faces.reshape(-1, 3))
    shared = normals(fold, faces)[index]
    assert np.abs(own - shared).max() > 0.3
    assert np.abs(lit - (own if sharp else shared)).max() < 1e-3
