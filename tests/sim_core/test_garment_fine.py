"""Sewn and posed on a coarse mesh, brought to rest on a fine one: no crossings, welds hold, resumable, and as near to
what is dressed on the fine mesh alone as two such drapes are to each other."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim_core import metrics
from sim_core.garment import Frame, Garment, Layer, Outfit, dress, load_outfit
from sim_core.garment.outfit import Step
from sim_core.garment.pattern import Pattern, Transfer

ASSETS = Path(__file__).parents[2] / "assets"
FINE, COARSE = 0.04, 0.08
STEPS = (
    Step("sew", 0.48, (0.0, 1.5), 6.0, 0.0),
    Step("weld"),
    Step("settle", 0.4, (2.0, 9.81), 3.0, 0.15),
    Step("settle", 0.2, damping=5.0, friction=0.45),
    Step("rest", 1.2, damping=10.0, friction=0.45, still=2e-4),
)


def robe(edge: float, coarse: float | None = None) -> Outfit:
    """The robe sewn on outstretched arms and left there."""
    outfit = load_outfit(ASSETS / "outfits/robe.toml")
    (layer,) = outfit.layers
    program = replace(layer.program, steps=STEPS)
    assert program.start is not None
    layer = replace(layer, edge=edge, program=program, coarse=coarse)
    return replace(outfit, layers=(layer,), pose=program.start)


def distance(a: Garment, b: Garment) -> float:
    """Mean, two-sided [m]."""
    return metrics.hausdorff(a.positions, a.faces, b.positions, b.faces, spacing=0.02).mean


def welded(layer: Layer, positions: np.ndarray) -> np.ndarray:
    """Means (V, 3) of twins at positions (P, 3)."""
    closed = layer.cloth.closed
    return np.stack([np.bincount(closed, x) for x in positions.T], axis=1) / np.bincount(closed)[:, None]


@pytest.fixture(scope="module")
def heard() -> list[Frame]:
    return []


@pytest.fixture(scope="module")
def carried(heard: list[Frame]) -> Garment:
    (garment,) = dress(robe(FINE, COARSE), on_frame=heard.append)
    return garment


@pytest.mark.parametrize("name", ["beizi", "robe", "gown"])
def test_a_flat_cloth_stays_flat(name: str) -> None:
    """What is linear in the pattern is given on exactly, beyond curved edges, too."""
    pattern = Pattern.load(ASSETS / f"patterns/{name}.toml")
    coarse, fine = pattern.cloth(0.05), pattern.cloth(0.02)
    transfer = Transfer.between(coarse, fine)
    assert np.allclose(transfer.shares.sum(1), 1.0)
    assert transfer.shares.min() > -1.0
    assert np.percentile(transfer.shares.min(1), 5) > -0.1
    turn = np.array([[0.6, 0.8, 0.1], [-0.8, 0.6, 0.3]])
    assert np.allclose(transfer.of(coarse.vertices @ turn), fine.vertices @ turn, atol=1e-12)
    half = transfer.of((coarse.vertices @ turn).astype(np.float32))
    assert half.dtype == np.float32
    assert (coarse.panel_of[transfer.corners] == fine.panel_of[:, None]).all()


def test_only_fine_cloth_is_begun_on_a_coarser_mesh() -> None:
    (layer,) = robe(0.013).layers
    assert layer.first is layer
    assert replace(layer, edge=0.006).first.edge == 0.015
    assert replace(layer, edge=0.006, coarse=0.006).first.edge == 0.006
    assert replace(layer, coarse=0.03).first.edge == 0.03
    assert replace(layer, coarse=0.01).first.edge == 0.013


def test_no_crossing_is_made_by_the_change_of_mesh(carried: Garment, heard: list[Frame]) -> None:
    """The frames of the coarse mesh are told on the fine one, and the last of them is where that begins."""
    (layer,) = robe(FINE, COARSE).layers
    assert carried.provenance["coarse"]["edge"] == COARSE
    assert all(len(frame.positions) == len(carried.pattern) for frame in heard)
    begin = round(25 * carried.provenance["coarse"]["simulated"])
    assert 30 < begin < len(heard) - 10
    x, after = (welded(layer, heard[k].positions) for k in (begin - 1, begin))
    assert metrics.intersections(x, carried.faces) == 0
    assert np.linalg.norm(after - x, axis=1).max() < 0.04  # no leap: 1 m/s
    facts = carried.provenance["errors"]
    assert facts["self_intersections"] == facts["inside_vertices"] == facts["layer_order"] == 0
    assert facts["seam_gap_m"] == 0.0


def test_seams_keep_their_lengths(carried: Garment) -> None:
    (layer,) = robe(FINE, COARSE).layers
    worn, cloth = carried.worn(), layer.cloth
    for seam in layer.pattern.seams:
        path = cloth.along(seam.a, layer.pattern.panel(seam.a.panel), " left")
        flat, draped = (
            float(np.linalg.norm(np.diff(points[path], axis=0), axis=1).sum())
            for points in (cloth.vertices, worn)
        )
        assert draped == pytest.approx(flat, rel=0.03)


class _Stopped(Exception):
    pass


def test_same_bits_after_interrupts(
    carried: Garment, heard: list[Frame], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Stopped on the coarse mesh, on the fine one as a half, and as a whole; frames are heard from the first."""
    from sim_core.cloth.run import drape_run as draping

    monkeypatch.setattr(draping, "CHECKPOINT_SECONDS", 0.0)
    for stop in (5, 30, len(heard) - 2):
        seen: list[Frame] = []

        def halt(frame: Frame, stop: int = stop, seen: list[Frame] = seen) -> None:
            seen.append(frame)
            if len(seen) == stop:
                raise _Stopped

        with pytest.raises(_Stopped):
            dress(robe(FINE, COARSE), on_frame=halt, checkpoint=tmp_path / "dressing")
    seen, shares = [], list[float]()
    (resumed,) = dress(
        robe(FINE, COARSE),
        on_frame=seen.append,
        checkpoint=tmp_path / "dressing",
        progress=lambda share, label: shares.append(share),
    )
    assert resumed.digest() == carried.digest()
    assert [frame.positions.tobytes() for frame in seen] == [frame.positions.tobytes() for frame in heard]
    assert shares == sorted(shares)
    assert not list(tmp_path.iterdir())


def test_it_comes_to_what_the_fine_mesh_alone_comes_to(carried: Garment) -> None:
    """Within two and a half times of what a drape scatters by when its mesh is a little coarser or finer."""
    (fine,), *others = (dress(robe(share * FINE)) for share in (1.0, 1.02, 0.96))
    assert "coarse" not in fine.provenance
    scatter = max(distance(other, fine) for (other,) in others)
    assert distance(carried, fine) < 2.5 * scatter < 0.02
    assert carried.provenance["errors"]["rest_p99_m"] <= 2e-4
    assert carried.provenance["errors"]["area_strain_p95"] < 0.02
