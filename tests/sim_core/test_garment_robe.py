"""The robe recipe on coarse meshes and the shipped figure: outside the body, sewn, alike on both sides, resumable."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from sim_core import metrics
from sim_core.body import Figure, Mannequin, Pose
from sim_core.cloth.step import schedule
from sim_core.errors import SimCoreError
from sim_core.garment import Garment, Pattern, detail, follow, robe_on_figure, write_glb
from sim_core.garment.levels import shown_figure
from sim_core.garment.placement import Laying, laid
from sim_core.garment.recipes import Schedule
from sim_core.metrics import winding
from sim_core.weave import Weave, solve, surface_maps

ASSETS = Path(__file__).parents[2] / "assets"
SHORT = Schedule(
    Pose(10.0, 2.0), sew=0.4, hold=0.08, hang=0.12, lower=0.2, settle=0.08, release=0.08, rest=0.08
)


@pytest.fixture(scope="module")
def ling() -> Weave:
    return Weave.load(ASSETS / "weaves/ling.toml")


@pytest.fixture(scope="module")
def figure() -> Figure:
    return Figure(Mannequin.load(ASSETS / "mannequins/woman.npz"), cell=0.012)


def pattern(name: str = "beizi") -> Pattern:
    return Pattern.load(ASSETS / f"patterns/{name}.toml")


def test_laid_panels_are_unstretched_and_clear_of_the_figure(figure: Figure) -> None:
    vertices, faces = figure.mesh(Pose())
    top = float(vertices[np.abs(vertices[:, 0]) > 0.1, 1].max()) + 0.012
    cut = pattern()
    cloth = cut.cloth(0.03)
    x = laid(cut, cloth, Laying(top))
    flat = np.array([panel.along is None for panel in cut.panels])[cloth.panel]
    strain = np.abs(metrics.area_strain(cloth.vertices, x, cloth.faces))
    assert strain[flat].max() < 0.06  # where the bends are rounded
    assert np.percentile(strain, 95) < 0.03
    for seam in cut.seams:
        if seam.kind == "joined" and seam.b is not None:
            a, b = (cloth.along(p, cut.panel(p.panel)) for p in (seam.a, seam.b))
            assert x[a] == pytest.approx(x[b], abs=1e-9)
    # Exactly: the next node of a coarse field lies up to a cell away from the cloth at the neck.
    assert winding(x, vertices, faces).max() < 0.5


@pytest.fixture(scope="module")
def coat(ling: Weave, figure: Figure) -> Garment:
    return robe_on_figure(pattern(), ling, figure, edge=0.035)


@pytest.mark.slow
def test_a_coarse_coat_keeps_the_limits(coat: Garment) -> None:
    facts = coat.provenance["errors"]
    assert facts["inside_vertices"] == facts["inside_midpoints"] == facts["inside_centroids"] == 0
    assert facts["seam_gap_m"] == 0.0
    assert facts["seam_gap_sewn_m"] < 1e-3
    assert facts["area_strain_p95"] <= 0.03
    assert facts["self_intersections"] <= 25
    assert facts["asymmetry_m"] == 0.0
    assert facts["rest_p99_m"] < 1e-4
    x, left = coat.worn(), np.array([name.endswith("left") for name in coat.panels])
    own = np.unique(coat.pattern_faces[left[coat.panel]])
    front = own[coat.pattern[own, 1] > 0.3]
    assert x[front, 0].min() > 0.0  # no front passes the middle
    assert 0.1 < x[:, 1].min() < 0.45
    assert 1.30 < x[:, 1].max() < 1.50


@pytest.mark.slow
def test_a_coat_at_rest_stays_at_rest_with_nothing_but_itself_given(coat: Garment, tmp_path: Path) -> None:
    """Contact, friction, holds and figure come along with it, also through a file, to the same bits."""
    frames = [coat.positions]
    end = follow(coat, seconds=1.0, on_frame=lambda index, x: frames.append(x))
    ways = [np.linalg.norm(after - before, axis=1) for before, after in pairwise(frames)]
    assert max(np.percentile(way, 99) for way in ways) <= 5e-5
    assert np.linalg.norm(end.positions - coat.positions, axis=1).max() <= 1e-3
    coat.save(tmp_path / "coat.npz")
    again = follow(Garment.load(tmp_path / "coat.npz"), seconds=1.0)
    assert again.positions.tobytes() == end.positions.tobytes()


def test_it_settles_on_the_figure_as_the_arms_came_down() -> None:
    timing = Schedule()
    down, still = timing.dressing((1, 2)), timing.settling((1, 2))
    last = schedule(down)[-1].body[1]
    assert timing.pose_of(last) == timing.pose
    assert {moment.body for moment in schedule(still)} == {(last, last)}
    assert still[0].pins == (1, 2)
    assert not still[-1].pins
    assert still[-1].rest == timing.at_rest


@pytest.mark.nightly
@pytest.mark.slow
def test_coat_survives_file_detail_and_model(
    coat: Garment, ling: Weave, figure: Figure, tmp_path: Path
) -> None:
    coat.save(tmp_path / "coat.npz")
    back = Garment.load(tmp_path / "coat.npz")
    assert back.digest() == coat.digest()
    assert (back.panels, back.dyes, back.cut) == (coat.panels, coat.dyes, coat.cut)
    coarse = detail(back, 0.06)
    assert len(coarse.faces) < 0.5 * len(coat.faces)
    edges = np.sort(coarse.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert np.unique(edges, axis=0, return_counts=True)[1].max() == 2
    assert coarse.provenance["detail"]["hausdorff"]["max_m"] < 0.06
    shown = shown_figure(*figure.mesh(Pose(45.0, 12.0)), coat.positions, coat.faces, triangles=900)
    everything = shown_figure(*figure.mesh(Pose(45.0, 12.0)), np.zeros((3, 3)), np.array([[0, 1, 2]]))
    assert 0 < len(shown.faces) < 0.5 * len(everything.faces)
    maps = surface_maps(ling, solve(ling), pixels=64)
    size = write_glb(tmp_path / "coat.glb", coarse, maps, precision="hall", figure=shown)
    assert size < 1_500_000


@pytest.mark.nightly
@pytest.mark.slow
def test_same_bits_also_after_an_interrupt(ling: Weave, figure: Figure, tmp_path: Path, monkeypatch) -> None:
    from sim_core.cloth.run import drape_run as draping

    heard: list[int] = []
    whole = robe_on_figure(
        pattern("robe"), ling, figure, edge=0.06, schedule=SHORT, on_frame=lambda i, x, pose: heard.append(i)
    )
    monkeypatch.setattr(draping, "CHECKPOINT_SECONDS", 0.0)
    file = tmp_path / "robe.npz"
    for stop in (4, 15, 21):  # while it is sewn, while the arms come down, and while it settles

        def halt(index: int, x: np.ndarray, pose: Pose, stop: int = stop) -> None:
            if index == stop:
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            robe_on_figure(
                pattern("robe"), ling, figure, edge=0.06, schedule=SHORT, on_frame=halt, checkpoint=file
            )
    again: list[int] = []
    resumed = robe_on_figure(
        pattern("robe"),
        ling,
        figure,
        edge=0.06,
        schedule=SHORT,
        on_frame=lambda i, x, pose: again.append(i),
        checkpoint=file,
    )
    assert resumed.digest() == whole.digest()
    assert again == heard == list(range(len(heard)))
    assert not file.exists()


def test_what_is_no_half_is_refused(ling: Weave, figure: Figure) -> None:
    with pytest.raises(SimCoreError, match="mirror = true"):
        robe_on_figure(pattern("pibo"), ling, figure)
