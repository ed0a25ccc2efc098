"""Networks that ours is compared with: what they are given, how they are pooled, and the commands that train them."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from sim_core.cli import main
from sim_core.errors import SimCoreError
from sim_core.learn.data import Recipe, Take, film, generate
from sim_core.learn.inference import RIVALS, Ground, RivalTrained, read_weights, write_weights
from sim_core.learn.pooling import Pooled
from sim_core.learn.rows import RivalRow


def small(case: int) -> Recipe:
    return Recipe("hanging", case, 7, 8, 0, coarse=90, fine=340)


@cache
def hanging(case: int) -> Take:
    return Take.of(small(case), film(small(case)))


def test_weights_keep_what_was_pooled_and_what_was_changed_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "paper.safetensors"
    pooled = Pooled(np.array([0, 2, 5]), np.array([[0, 1, 2]], np.int32), 0.5)
    weights = {"out.weight": np.arange(6, dtype=np.float32).reshape(3, 2)}
    write_weights(path, RivalTrained("paper", weights, {"hanging-01": pooled}, {"scene": "hanging"}))
    found = read_weights(path)
    assert isinstance(found, RivalTrained)
    assert (found.row, found.told, list(found.weights)) == ("paper", {"scene": "hanging"}, ["out.weight"])
    assert np.array_equal(found.weights["out.weight"], weights["out.weight"])
    assert np.array_equal(found.pooled["hanging-01"].kept, pooled.kept)
    assert np.array_equal(found.pooled["hanging-01"].faces, pooled.faces)
    assert found.pooled["hanging-01"].share == 0.5
    whole = bytearray(path.read_bytes())
    whole[-3] ^= 1
    path.write_bytes(whole)
    with pytest.raises(SimCoreError, match="changed since"):
        read_weights(path)
    write_weights(path, RivalTrained("another", weights, {}, {}))
    with pytest.raises(SimCoreError, match="another"):
        read_weights(path)


def test_features_turn_along_with_the_sheet_but_for_where_down_is() -> None:
    torch = pytest.importorskip("torch")
    from scipy.spatial.transform import Rotation

    from sim_core.learn.networks.rivals import RivalSheet

    made = hanging(1).film
    ground = Ground.of(hanging(1).pair)
    sheet = RivalSheet(ground, torch.device("cpu"))
    base = np.stack([ground.pair.base @ made.coarse[k].astype(float) for k in (7, 6, 5)])
    about = Rotation.from_rotvec([0.0, 0.7, 0.0])  # about what hangs: down stays
    turned = np.stack([about.apply(one) + [2.0, 1.0, -1.0] for one in base])
    one, other = (sheet.frames(torch.from_numpy(x.astype(np.float32))[None]) for x in (base, turned))
    assert float((one.features - other.features).abs().max()) < 1e-3
    flat = np.column_stack([ground.pair.fine.rest, np.zeros(len(ground.pair.fine.rest))])
    still = sheet.frames(torch.from_numpy(np.stack([flat] * 3).astype(np.float32))[None])
    assert still.turn[0].numpy() == pytest.approx(np.broadcast_to(np.eye(3), (len(flat), 3, 3)), abs=1e-5)
    assert float(still.features[:, :, 3:9].abs().max()) == 0.0


@pytest.mark.parametrize("name", list(RIVALS))
def test_a_rival_learns_what_it_is_shown(name: str) -> None:
    torch = pytest.importorskip("torch")
    from sim_core.learn.networks.rivals import RivalSchedule, train_rival

    torch.set_num_threads(1)
    schedule = RivalSchedule(updates=200 if name == "paper" else 300, batch=4)
    weights, pooled = train_rival([hanging(1)], RIVALS[name], schedule)
    assert (not pooled) == (name == "mfsr")
    for one in pooled.values():
        assert one.share < RIVALS[name].share
    pair, made = hanging(1).pair, hanging(1).film
    follow = RivalRow(RivalTrained(name, weights, pooled, {})).follow(pair)
    off = [[], []]
    for coarse, fine in zip(made.coarse.astype(float), made.fine, strict=True):
        for kind, place in enumerate((follow(coarse), pair.base @ coarse)):
            off[kind].append(np.linalg.norm(place - fine, axis=1).mean())
    assert np.mean(off[0]) < 0.9 * np.mean(off[1])
    if pooled:
        with pytest.raises(SimCoreError, match="no sheet of this kind"):
            RivalRow(RivalTrained(name, weights, pooled, {})).follow(hanging(13).pair)


def test_the_commands_train_rivals_and_set_them_beside_the_base(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("torch")
    generate(tmp_path / "data", [small(case) for case in (1, 3)])
    place, out = ["hanging", "--data", str(tmp_path / "data")], tmp_path / "mesh.safetensors"
    words = [
        "learn",
        "train",
        *place,
        "--row",
        "mesh_conv",
        "--device",
        "cpu",
        "--updates",
        "10",
        "--out",
        str(out),
    ]
    assert main([*words, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["row"], told["device"], told["learned_from"]) == ("mesh_conv", "cpu", ["hanging-01"])
    assert main([*words, "--json"]) == 0  # goes on with its record, which is at its end
    again = read_weights(out)
    capsys.readouterr()
    assert (
        main(["learn", "evaluate", *place, "--rows", "biharmonic,mesh_conv", "--weights", str(out), "--json"])
        == 0
    )
    rows = json.loads(capsys.readouterr().out)["rows"]
    assert rows["mesh_conv"]["mean_mm"] == pytest.approx(rows["biharmonic"]["mean_mm"], rel=0.5)
    assert isinstance(again, RivalTrained)
    assert main(["learn", "evaluate", *place, "--rows", "paper", "--weights", str(out)]) == 1
    assert "--rows paper" in capsys.readouterr().err
