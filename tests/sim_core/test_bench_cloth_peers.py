"""What the cloth bench does with peers, as far as it can be tested without them."""

import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

NAMES = (
    "cloth_against",
    "cloth_figures",
    "cloth_folded",
    "cloth_peer_tables",
    "cloth_plot",
    "cloth_sweeps",
    "mapping",
    "peers",
)
BENCH = Path(__file__).parents[1] / "bench"


@pytest.fixture
def bench(monkeypatch):
    """The modules of the bench, which import each other by their bare names."""
    for folder in (BENCH / "cloth_peers", BENCH):
        monkeypatch.syspath_prepend(str(folder))
    yield {name: import_module(name) for name in NAMES}
    for name in NAMES:
        sys.modules.pop(name, None)


def test_shell_has_both_the_stretch_and_the_bending(bench):
    young, thickness = bench["mapping"].shell(49.0, 0.3, 4.9e-5)
    assert young * thickness == pytest.approx(49.0)
    assert young * thickness**3 / (12 * (1 - 0.3**2)) == pytest.approx(4.9e-5)


def test_lame_numbers_give_the_stretch_and_poissons_ratio_back(bench):
    mu, lam = bench["mapping"].lame(49.0, 0.3)
    # plane stress: sigma_x = (2 mu + lam) e_x + lam e_y with sigma_y = 0
    across = -lam / (2 * mu + lam)
    assert -across == pytest.approx(0.3)
    assert (2 * mu + lam) + lam * across == pytest.approx(49.0)


@pytest.mark.nightly
def test_hinges_of_a_bent_strip_store_the_energy_of_a_plate(bench):
    from sim_core.cloth.scenes import GF_CM, hang_edge

    sheet = hang_edge(0.05).sheet
    rest, bend, kappa = sheet.rest, GF_CM.bend, 0.02
    quads = []
    for e, (a, b) in enumerate(sheet.edges):
        faces = np.flatnonzero((sheet.face_edges == e).any(1))
        if len(faces) == 2:
            quads.append([*(next(v for v in sheet.faces[f] if v not in (a, b)) for f in faces), a, b])
    quad = np.array(quads)
    length, area = bench["mapping"].hinges(rest, quad[:, :2], quad[:, 2:])
    height = 0.5 * kappa * rest[:, 0] ** 2
    place = np.column_stack([rest, height])

    def normals(point):
        a, b = place[quad[:, 2]], place[quad[:, 3]]
        n = np.cross(b - a, place[point] - a)
        return n / np.linalg.norm(n, axis=1)[:, None]

    cosine = -(normals(quad[:, 0]) * normals(quad[:, 1])).sum(1)
    angle = np.arccos(np.clip(cosine, -1, 1))
    stored = (0.5 * bend * length / area * length * angle**2).sum()
    # the rim of the sheet has hinges on one side only: it holds a little less than B kappa^2/2 on the whole area
    assert 0.93 < stored / (0.5 * bend * kappa**2) < 1.02


def test_blender_is_told_its_own_gravity_and_the_lattice_of_our_stretch(bench):
    from sim_core.cloth.scenes import hang_edge

    scene = hang_edge(0.05)
    mass = float(scene.sheet.mass.sum())
    told = bench["mapping"].blender_numbers(scene.sheet.rest, scene.sheet.faces, mass, 49.0, 0.0, 9.81)
    assert told["gravity"] * 1e-3 * 25**2 == pytest.approx(9.81)
    spring = told["tension"] / 0.05 * 25**2 * mass / len(scene.positions)
    assert 2 / np.sqrt(3) * spring == pytest.approx(
        49.0, rel=0.03
    )  # the mean edge is not 0.05 m to the last digit


def test_only_qualities_that_blender_keeps_are_swept(bench):
    steps = bench["mapping"].blender_steps
    assert steps(12) == 13
    sweeps = bench["cloth_sweeps"]
    for every in (sweeps.SWEEPS, sweeps.SILK_SWEEPS, sweeps.LAYER_SWEEPS):
        assert all(steps(s["substeps"]) == s["substeps"] for s in every["Blender"])


def test_every_peer_is_swept_over_four_settings_beside_its_limit(bench):
    for sweep in bench["cloth_sweeps"].SWEEPS.values():
        assert len(sweep) >= 5
        assert len({tuple(s.items()) for s in sweep}) == len(sweep)


def test_cheapest_is_the_fastest_near_its_limit_and_never_the_limit_itself(bench):
    def row(ms, error, is_limit=False):
        return {"cpu_ms": ms, "own": {"mean": error}, "is_limit": is_limit}

    rows = [row(1, 5.0), row(3, 1.9), row(2, 1.95), row(9, 0.0, True)]
    assert bench["cloth_figures"].cheapest(rows) is rows[2]
    assert bench["cloth_figures"].cheapest([rows[0], rows[3]]) is None


def test_a_run_that_is_not_finite_is_infinitely_far(bench):
    ends = np.zeros((4, 3)), np.full((4, 3), np.nan)
    assert bench["cloth_figures"].distance(*ends)["mean"] == np.inf


def test_of_films_the_worst_frame_counts_and_the_last_is_told(bench):
    still = np.zeros((3, 2, 3))
    moved = still + np.array([0.0, 3e-3, 1e-3])[:, None, None] * np.eye(3)[0]
    found = bench["cloth_figures"].distance(still, moved)
    assert found["mean"] == pytest.approx(3.0)
    assert found["end"] == pytest.approx(1.0)


def test_crossings_of_a_film_are_the_most_in_a_frame_and_those_in_the_last(bench):
    apart = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.2, 1], [0.3, 0.2, 1], [0.2, 0.3, 2]], float)
    through = apart - np.array([[0, 0, 0]] * 3 + [[0, 0, 1.5]] * 3)
    faces = np.array([[0, 1, 2], [3, 4, 5]])
    found = bench["cloth_figures"].crossed(np.stack([apart, through, apart]), faces)
    assert found["most"] == 2
    assert found["end"] == 0
    assert bench["cloth_figures"].crossed(apart, faces) is None


def test_the_folded_sheet_begins_unstrained_outside_the_bar_and_itself(bench):
    from sim_core.metrics import intersections

    scene = bench["cloth_folded"].folded()
    sheet, x = scene.sheet, scene.positions
    lengths = np.linalg.norm(x[sheet.edges[:, 0]] - x[sheet.edges[:, 1]], axis=1)
    rest = np.linalg.norm(sheet.rest[sheet.edges[:, 0]] - sheet.rest[sheet.edges[:, 1]], axis=1)
    assert lengths == pytest.approx(rest)
    assert scene.collider.distance(x).min() == pytest.approx(scene.contact.clearance)
    assert intersections(x, sheet.faces) == 0
    assert len(np.unique(sheet.rest[list(scene.pins), 1])) == 2


def test_only_what_has_layers_is_told_of_them(bench):
    sweeps = bench["cloth_sweeps"]
    told = sweeps.given(sweeps.compared("folded"))
    assert told["film"] == 1
    assert told["thickness"] == pytest.approx(2 * told["clearance"])
    assert "thickness" not in sweeps.given(sweeps.compared("hang_edge_silk"))


def test_a_limit_that_was_broken_off_leaves_the_finest_that_was_reached(bench):
    class Kept:
        sweeps = {"peer": ({"substeps": 1}, {"substeps": 2}, {"substeps": 3})}
        faces = np.array([[0, 1, 2]])

        def __init__(self, last):
            run = {"cpu_ms": [1.0], "ms": [1.0], "build_seconds": 0, "compile_seconds": 0, "version": "0"}
            self.turns = {"1": [run], "2": [run], **({"3": [{"error": last}]} if last else {})}

        def key(self, engine, setting):
            return str(setting["substeps"])

        def end(self, key):
            return np.full((3, 3), float(key))

    summed = bench["cloth_figures"].engine_summary
    assert "has not been run" in summed(Kept(""), "peer", None, "default")["error"]
    found = summed(Kept("TimeoutError: not reached in 2 s"), "peer", None, "default")
    assert found["limit"] == "2"
    assert found["refused"] == [{"setting": "3", "why": "TimeoutError: not reached in 2 s"}]


def test_tables_tell_who_is_ahead(bench):
    tables = bench["cloth_peer_tables"]
    assert tables.least([(3.0, "a"), (2.0, "b")]) == "2.0 (b)"
    assert tables.least([(3.0, "a"), (0.5, "b")]) == "b is 2.0 times as fast"


class Played:
    """Stands for the peers' process: a run ends `1/substeps` m from the sheet's start."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, int]] = []

    def run(self, engine, setting, **given):
        self.asked.append((engine, setting["substeps"]))
        if engine == "Blender":
            return {"error": "ModuleNotFoundError: No module named 'bpy'"}
        times = {"ms": [1.0] * 5, "cpu_ms": [float(setting["substeps"])] * 5}
        about = {"build_seconds": 0.0, "compile_seconds": 0.0, "version": "0"}
        return {**times, **about, "positions": given["positions"] + 1 / setting["substeps"] * np.eye(3)[0]}


@pytest.mark.nightly
@pytest.mark.slow
def test_turns_alternate_are_kept_and_a_missing_peer_is_named(bench, tmp_path, capsys):
    against, figures = bench["cloth_against"], bench["cloth_figures"]
    asked = bench["cloth_sweeps"].compared("hang_edge", 60)
    engines, inf = ["MuJoCo Euler", "MuJoCo discrete", "Blender"], float("inf")
    kept, first = against.Kept(tmp_path, asked), Played()
    assert against.run_turns(asked, engines, kept, 2, inf, first)
    assert [name for name, _ in first.asked[:3]] == engines
    assert (
        first.asked.count(("MuJoCo Euler", 256)) == 2
    )  # a setting has its rounds, a limit one, a failure none more
    assert first.asked.count(("MuJoCo Euler", 2048)) == 1
    assert sum(name == "Blender" for name, _ in first.asked) == len(bench["cloth_sweeps"].SWEEPS["Blender"])
    again, second = against.Kept(tmp_path, asked), Played()
    assert against.run_turns(asked, engines, again, 2, inf, second)
    assert second.asked == []
    runs = [against.ours(asked, n) for n in (32, 64)]
    own = {name: against.ours(asked, own=way) for name, way in asked.ours.items()}
    found = figures.summary(again, list(bench["cloth_sweeps"].SWEEPS), own, runs)
    mine = found["ours"]["cheapest_within_2mm"]
    assert mine["error"]["mean"] <= 2.0
    assert mine["cpu_ms"] == min(
        row["cpu_ms"] for row in found["ours"]["settings"] if row["error"]["mean"] <= 2.0
    )
    told = found["peers"]["MuJoCo Euler"]["rows"][0]
    turns = again.turns[again.key("MuJoCo Euler", told["setting"])]
    assert told["ratio_cheapest"] == pytest.approx(
        np.median([150 / np.median(turn["ours"][mine["name"]]) for turn in turns])
    )
    assert found["peers"]["MuJoCo discrete"]["floor"]["mean"] == pytest.approx(1e3 / 32 - 1e3 / 64)
    assert found["peers"]["MuJoCo discrete"]["cheapest_within_2mm"] is None
    assert "No module named 'bpy'" in found["peers"]["Blender"]["error"]
    assert "never within 2 mm; best 15.6" in capsys.readouterr().out
    del again.turns[again.key("MuJoCo discrete", bench["cloth_sweeps"].SWEEPS["MuJoCo discrete"][-1])]
    assert (
        "64, has not been run" in figures.engine_summary(again, "MuJoCo discrete", None, "default")["error"]
    )
    bench["cloth_plot"].plot({"hang_edge": found}, tmp_path / "plot.png")
    assert (tmp_path / "plot.png").stat().st_size > 5000


@pytest.mark.nightly
def test_settings_that_decide_are_the_cheapest_within_2_mm_and_those_beside_it(bench, tmp_path):
    against, sweeps = bench["cloth_against"], bench["cloth_sweeps"].SWEEPS
    asked = bench["cloth_sweeps"].compared("hang_edge", 60)
    kept, engine = against.Kept(tmp_path, asked), "MuJoCo Euler"
    for setting in sweeps[engine]:
        error = {"ms": [1.0], "cpu_ms": [float(setting["substeps"])], "build_seconds": 0.0, "version": "0"}
        end = asked.scene.positions + 0.001 * (setting["substeps"] < 208) * 3
        kept.add(kept.key(engine, setting), {**error, "compile_seconds": 0.0}, end)
    chosen = bench["cloth_figures"].deciding(kept, [engine])[engine]
    assert [s["substeps"] for s in chosen] == [208, 160, 256]
    peers = Played()
    assert against.run_turns(asked, [engine], kept, 2, float("inf"), peers, {engine: chosen})
    assert sorted(steps for _, steps in peers.asked) == [160, 160, 208, 208, 256, 256]


def test_no_run_is_begun_after_the_budget(bench, tmp_path):
    asked, peers = bench["cloth_sweeps"].compared("hang_edge", 60), Played()
    kept = bench["cloth_against"].Kept(tmp_path, asked)
    assert not bench["cloth_against"].run_turns(asked, ["MuJoCo Euler"], kept, 1, float("-inf"), peers)
    assert peers.asked == []


def test_sections_of_the_list_of_peers(bench):
    text = "# head\n# a: first\none==1\n\n# b: second\ntwo==2\nthree\n"
    assert bench["peers"].requirements(text, "b") == ["two==2", "three"]
    with pytest.raises(SystemExit, match="no section 'c'"):
        bench["peers"].requirements(text, "c")
    listed = bench["peers"].LIST.read_text("utf-8")
    assert any(line.startswith("bpy==") for line in bench["peers"].requirements(listed, "cloth"))
    assert any(line.startswith("gmsh==") for line in bench["peers"].requirements(listed, "mesh"))


def test_wind_presses_as_on_one_triangle(bench):
    x, v = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 5]]), np.zeros((4, 3))
    v[:3, 2] = 1.0
    force = bench["mapping"].pressed(x, v, np.array([[0, 1, 2]]), np.array([7.0, 0, 3]), 1.2)
    assert force[:3] == pytest.approx(np.tile([0, 0, 0.5 * 1.2 * 0.5 * 2**2 / 3], (3, 1)))
    assert not force[3].any()


def test_figures_are_json_also_where_a_run_exploded(bench):
    told = bench["cloth_against"].told_finite({"a": [1.0, float("inf")], "b": {"c": float("nan"), "d": "x"}})
    assert told == {"a": [1.0, None], "b": {"c": None, "d": "x"}}


def test_table_says_what_a_peer_cannot_and_what_explodes(bench, monkeypatch):
    table = import_module("cloth_peer_tables")
    monkeypatch.delitem(sys.modules, "cloth_peer_tables")
    row = {
        "cpu_ms": 50.0,
        "cpu_ms_quartiles": [49.0, 52.0],
        "ratio": 12.5,
        "ratio_cheapest": 40.5,
        "own": {"mean": None, "p99": None},
    }
    row["setting"] = {"substeps": 8}
    peer = {"limit": "64", "floor": {"mean": 0.4}, "limit_from_ours": {"mean": 0.5, "p99": 0.9}}
    lost = {"error": "ModuleNotFoundError: No module named 'bpy'"}
    assert "not compared: ModuleNotFoundError" in table.peer_line("Blender", lost)
    told = table.peer_line("MuJoCo", {**peer, "cheapest_within_2mm": None, "best": row})
    assert "8 (best; never within 2 mm)" in told
    assert "exploded" in told
    assert table.peer_line("MuJoCo", {**peer, "cheapest_within_2mm": row, "best": row}).endswith(
        "| 12.5 | 40.5 |"
    )


def test_scenes_of_an_earlier_run_stay_in_the_file(bench, tmp_path):
    added, path = bench["cloth_against"].added, tmp_path / "new" / "figures.json"
    added(path, {"flag": {"seconds": 0.2}})
    assert added(path, {"hanging": {"seconds": 0.4}}) == {
        "flag": {"seconds": 0.2},
        "hanging": {"seconds": 0.4},
    }
    assert added(path, {"flag": {"seconds": 0.3}})["flag"] == {"seconds": 0.3}
