"""The certifier: what passes through without it does not with it; zones; what it says where it cannot."""

import importlib.util
import json
import sys
from pathlib import Path

import numpy as np
import pytest

from sim_core import cli, metrics
from sim_core.cloth import Contact, HalfSpace, Holds, Live, Phase, Sheet, drape
from sim_core.cloth.run import moved_together, zones_of
from sim_core.cloth.scenes import GF_CM, equilateral_sheet
from sim_core.errors import SimCoreError

needs_ipctk = pytest.mark.skipif(
    importlib.util.find_spec("ipctk") is None, reason="ipctk is not installed (extra 'certify')"
)


def thrown(speed: float) -> tuple[Sheet, np.ndarray, np.ndarray, list[int], int]:
    """A sheet held at two sides, and one 6 cm above that is thrown at it: sheet, x, v, pins, vertices of one."""
    rest, faces = equilateral_sheet(0.2, 0.2, 0.02)
    count = len(rest)
    both = Sheet.of(np.concatenate([rest, rest + [0.5, 0]]), np.concatenate([faces, faces + count]), GF_CM)
    low = np.column_stack([rest[:, 0], np.zeros(count), rest[:, 1]])
    x = np.concatenate([low, low + [0.007, 0.06, 0.011]])
    v = np.zeros_like(x)
    v[count:, 1] = -speed
    pins = np.flatnonzero((rest[:, 0] < 1e-9) | (rest[:, 0] > 0.2 - 1e-9)).tolist()
    return both, x, v, pins, count


def test_a_shell_alone_stops_a_sheet_thrown_at_20_m_s() -> None:
    """Steps become so short that it meets the shell of 3 mm: 64 crossings where they did not."""
    sheet, x, v, pins, count = thrown(20.0)
    crossed: list[int] = []
    done = drape(
        sheet,
        x,
        [Phase(0.08, damping=1.0)],
        velocities=v,
        pins=pins,
        contact=Contact(thickness=0.003),
        on_frame=lambda _, now: crossed.append(metrics.intersections(now.astype(float), sheet.faces)),
    )
    assert max(crossed) == 0
    assert done.positions[count:, 1].mean() > done.positions[:count, 1].mean()


@needs_ipctk
def test_a_sheet_thrown_at_another_goes_through_only_without_the_certifier() -> None:
    sheet, x, v, pins, count = thrown(5.0)

    def ends(certify: bool) -> tuple[int, np.ndarray]:
        crossed: list[int] = []

        def heard(_: int, now: np.ndarray) -> None:
            crossed.append(metrics.intersections(now.astype(float), sheet.faces))

        done = drape(
            sheet,
            x,
            [Phase(0.08, damping=1.0)],
            velocities=v,
            pins=pins,
            contact=Contact(),
            certify=certify,
            on_frame=heard,
        )
        if certify:
            found = done.certificate
            assert found is not None
            assert (found.frames, found.uncertified, found.intersections) == (done.frames, 0, 0)
            assert found.redone > 0
        else:
            assert done.certificate is None
        return max(crossed), done.positions

    crossed, through = ends(False)
    assert crossed > 0 or through[count:, 1].max() < through[:count, 1].min()
    crossed, kept = ends(True)
    assert crossed == 0
    assert kept[count:, 1].mean() > kept[:count, 1].mean()


@needs_ipctk
def test_a_solid_whose_mesh_is_given_is_not_entered_and_the_same_input_gives_the_same_bits() -> None:
    """A tetrahedron's tip under a falling sheet, and no collider but the certifier."""
    rest, faces = equilateral_sheet(0.2, 0.2, 0.04)
    sheet = Sheet.of(rest, faces, GF_CM)
    start = np.column_stack([rest[:, 0] - 0.1, np.full(len(rest), 0.101), rest[:, 1] - 0.1])
    tip = np.array([[0, 0.1, 0.003], [0.05, 0, 0.05], [-0.06, 0, 0.04], [0.001, 0, -0.05]])
    solid = (tip, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))

    def end() -> np.ndarray:
        done = drape(sheet, start, [Phase(0.12)], certify=solid)
        assert done.certificate is not None
        assert done.certificate.uncertified == done.certificate.intersections == 0
        assert done.certificate.zones > 0
        return done.positions

    kept = end()
    assert kept.tobytes() == end().tobytes()
    assert kept[:, 1].max() > 0.09  # what lies on the tip has not fallen
    assert drape(sheet, start, [Phase(0.12)]).positions[:, 1].max() < 0.06


@needs_ipctk
def test_a_resumed_run_is_certified_to_the_same_bits(tmp_path: Path) -> None:
    sheet, x, v, pins, _ = thrown(5.0)
    kinds = {"velocities": v, "pins": pins, "contact": Contact(thickness=0.002), "certify": True}
    whole = drape(sheet, x, [Phase(0.2)], **kinds)

    def stop(index: int, _: np.ndarray) -> None:
        if index == 2:
            raise KeyboardInterrupt

    kept = tmp_path / "state"
    with pytest.raises(KeyboardInterrupt):
        drape(sheet, x, [Phase(0.2)], **kinds, checkpoint=kept, on_frame=stop)
    assert kept.exists()
    again = drape(sheet, x, [Phase(0.2)], **kinds, checkpoint=kept, on_frame=lambda *_: None)
    assert again.positions.tobytes() == whole.positions.tobytes()
    assert again.certificate is not None
    assert whole.certificate is not None
    assert (again.certificate.redone, again.certificate.zones) == (
        whole.certificate.redone,
        whole.certificate.zones,
    )


@needs_ipctk
def test_led_vertices_that_must_cross_are_told() -> None:
    """Two sheets whose edges are led through each other: no way is free, and the certificate says so."""
    rest, faces = equilateral_sheet(0.1, 0.1, 0.05)
    count = len(rest)
    sheet = Sheet.of(np.concatenate([rest, rest + [0.5, 0]]), np.concatenate([faces, faces + count]), GF_CM)
    low = np.column_stack([rest[:, 0], np.zeros(count), rest[:, 1]])
    x = np.concatenate([low, low + [0.011, 0.02, 0.007]])
    live = Live(sheet, x, pins=range(2 * count), certify=True)
    goal = x.copy()
    goal[count:, 1] -= 0.03
    live.step(targets=goal)
    assert live.certificate is not None
    assert live.certificate.uncertified == 1


@needs_ipctk
def test_what_cannot_be_certified_is_said_before_anything_runs() -> None:
    sheet, x, _, _, count = thrown(0.0)
    entangled = x.copy()
    entangled[count:, 1] -= 0.06 - 0.002 * np.sin(60 * entangled[count:, 0])
    with pytest.raises(SimCoreError, match="certify: the start has"):
        drape(sheet, entangled, [Phase(0.04)], certify=True)
    with pytest.raises(SimCoreError, match="integrator auto"):
        drape(sheet, x, [Phase(0.04)], certify=True, integrator="implicit")
    holds = Holds.of(2 * count, pairs=np.array([[0, count]]), positions=x)
    with pytest.raises(SimCoreError, match="sewing pairs"):
        drape(sheet, x, [Phase(0.04)], certify=True, holds=holds)
    open_end = (np.zeros((3, 3)), np.array([[0, 1, 3]]))
    with pytest.raises(SimCoreError, match="certify: the solid's faces: index 3"):
        drape(sheet, x, [Phase(0.04)], certify=open_end, collider=HalfSpace())


def test_without_the_library_the_remedy_is_named(monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    monkeypatch.setitem(sys.modules, "ipctk", None)
    assert cli.main(["cloth", "hanging", "--vertices", "60", "--frames", "1", "--certify"]) == 1
    said = capsys.readouterr()
    assert said.out == ""
    assert "handress-hall[certify]" in said.err
    assert len(said.err.splitlines()) == 1


def test_intersections_are_counted_without_the_library(capsys) -> None:
    assert cli.main(["cloth", "hanging", "--vertices", "60", "--frames", "1", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["intersections"] == 0


@needs_ipctk
def test_the_command_certifies(capsys) -> None:
    words = ["cloth", "drape", "--vertices", "100", "--frames", "2", "--certify", "--json"]
    assert cli.main(words) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["certified"]["frames"] == 2
    assert told["certified"]["uncertified"] == told["intersections"] == 0


def test_zones_move_as_one_and_keep_momentum() -> None:
    rng = np.random.default_rng(3)
    way, v, mass = rng.normal(size=(9, 3)), rng.normal(size=(9, 3)), rng.uniform(1, 2, 9)
    zone = zones_of(np.array([[0, 1, 2, 3], [3, 4, 5, 0], [6, 7, 6, 7]]), 9)
    assert zone.tolist() == [0, 0, 0, 0, 0, 0, 1, 1, -1]
    moved, speed, stuck = moved_together(zone, way, v, 1 / mass)
    assert stuck == 0
    for number in (0, 1):
        assert np.ptp(moved[zone == number], axis=0).max() == 0.0
        assert np.ptp(speed[zone == number], axis=0).max() == 0.0
    assert np.array_equal(moved[8], way[8])
    assert mass @ speed == pytest.approx(mass @ v)
    assert mass @ moved == pytest.approx(mass @ way)
    held = 1 / mass
    held[7] = 0.0
    moved, speed, stuck = moved_together(zone, way, v, held)
    assert np.array_equal(moved[6], way[7])
    assert stuck == 0
    held[6] = 0.0
    assert moved_together(zone, way, v, held)[2] == 1
