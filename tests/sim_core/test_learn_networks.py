"""What is trained is what is run: torch and the follower without it say the same, and who says nothing is the base."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from sim_core.cli import main
from sim_core.errors import SimCoreError
from sim_core.learn.data import (
    DESIGNS,
    POOLINGS,
    Design,
    Film,
    Pair,
    Recipe,
    Take,
    film,
    generate,
    pooled_by_kind,
    pooled_takes,
    read_films,
)
from sim_core.learn.inference import PATCH, Follower, Ground, Settings, Trained, read_weights, write_weights
from sim_core.learn.pooling import Pooled

SMALL = Settings(width=8, hidden=12, blocks=2, steps=2)


@cache
def hanging(case: int) -> tuple[Ground, Film]:
    recipe = Recipe("hanging", case, 7, 6, 0, coarse=90, fine=340)
    return Ground.of(Pair.of(recipe)), film(recipe)


@cache
def pooled(case: int) -> tuple[Ground, Film]:
    """The same, from less than half of the fine vertices."""
    whole = Take.of(Recipe("hanging", case, 7, 6, 0, coarse=90, fine=340), hanging(case)[1])
    (take,) = pooled_takes([whole], pooled_by_kind([whole], POOLINGS[1], 0.45))
    return Ground.of(take.pair), take.film


def drawn(seed: int, scale: float = 0.05) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    return {name: rng.normal(0, scale, shape).astype(np.float32) for name, shape in SMALL.shapes().items()}


@pytest.mark.parametrize("sheets", [hanging, pooled])
def test_a_network_that_says_nothing_is_the_base(sheets) -> None:
    ground, made = sheets(1)
    follow = Follower(ground, SMALL, drawn(0, 0.0))
    for coarse in made.coarse:
        assert np.array_equal(follow(coarse), ground.pair.base @ coarse.astype(float))


@pytest.mark.parametrize("sheets", [hanging, pooled])
def test_the_follower_goes_along_when_the_sheet_is_moved_and_turned(sheets) -> None:
    from scipy.spatial.transform import Rotation

    ground, made = sheets(1)
    whole = Rotation.from_rotvec([0.4, -2.0, 0.9])
    one, other = (Follower(ground, SMALL, drawn(1)) for _ in range(2))
    far = 0.0
    for coarse in made.coarse.astype(float):
        fine, turned = one(coarse), other(whole.apply(coarse) + [3.0, -1.0, 7.0])
        assert np.abs(whole.apply(fine) + [3.0, -1.0, 7.0] - turned).max() < 1e-7
        far = max(far, np.abs(fine - ground.pair.base @ coarse).max())
        if kept := list(ground.pair.kept):
            assert np.abs(fine[kept] - coarse).max() < 1e-9
    assert far > 1e-4


def test_another_sheet_other_weights_and_nan_are_refused() -> None:
    ground, made = hanging(1)
    follow = Follower(ground, SMALL, drawn(1))
    with pytest.raises(SimCoreError, match="coarse"):
        follow(made.coarse[0][:-1])
    with pytest.raises(SimCoreError, match="coarse"):
        follow(np.full_like(made.coarse[0], np.nan))
    weights = drawn(1)
    weights["steps.0.inner.bias"] = np.zeros(3, np.float32)
    with pytest.raises(SimCoreError, match=r"steps.0.inner.bias – \(8,\) is meant, \(3,\) found"):
        Follower(ground, SMALL, weights)
    with pytest.raises(SimCoreError, match="none found"):
        Follower(ground, SMALL, {})


def glued(grounds: list[Ground], *, gathered: bool = False):
    """The grounds as one sheet, and its sums as a GPU has them, or compiled."""
    torch = pytest.importorskip("torch")

    from sim_core.learn.networks import Gathered, Glued, Sheets

    sheets = [Sheets.of(ground, torch.device("cpu")) for ground in grounds]
    made = Glued(grounds, sheets)
    if gathered:
        made.at = Gathered(Sheets.glued(sheets))
    return made


@pytest.mark.parametrize("gathered", [False, True])
@pytest.mark.parametrize("sheets", [hanging, pooled])
def test_torch_says_the_same_on_several_sheets_glued_together(gathered: bool, sheets) -> None:
    torch = pytest.importorskip("torch")
    from sim_core.learn.networks import LearnedSteps, Moment

    network = LearnedSteps(SMALL)
    weights = drawn(2)
    assert {name: tuple(value.shape) for name, value in network.state_dict().items()} == dict(SMALL.shapes())
    network.load_state_dict({name: torch.from_numpy(value) for name, value in weights.items()})
    made = [sheets(1), sheets(13)]
    whole = glued([ground for ground, _ in made], gathered=gathered)
    followers = [Follower(ground, SMALL, weights) for ground, _ in made]
    now, was, turn = torch.zeros(int(whole.fine[-1]), 3), torch.zeros(int(whole.coarse[-1]), PATCH), None
    for k in range(6):
        moments = [Moment.of(ground, one.coarse, k) for ground, one in made]
        if gathered:
            moments = [Moment.stacked([moment], torch.device("cpu")).row(0) for moment in moments]
        moment = Moment.glued(moments)
        last = whole.at.carried(now, moment.turn if turn is None else turn, moment.turn)
        with torch.no_grad():
            now, was = network(whole, moment, last, was)
        turn = moment.turn
        for n, (ground, one) in enumerate(made):
            fine = followers[n](one.coarse[k])
            told = moments[n].base + ground.unit * now[whole.fine[n] : whole.fine[n + 1]]
            assert np.abs(fine - told.numpy()).max() < 1e-5 * ground.patches.length


def test_the_sums_of_a_gpu_have_the_gradients_of_the_compiled_ones() -> None:
    torch = pytest.importorskip("torch")
    from sim_core.learn.networks import LearnedSteps, Moment

    made = [hanging(1), hanging(13)]
    moment = Moment.glued([Moment.of(ground, one.coarse, 4) for ground, one in made])
    found = []
    for gathered in (False, True):
        network = LearnedSteps(SMALL)
        network.load_state_dict({name: torch.from_numpy(value) for name, value in drawn(2).items()})
        whole = glued([ground for ground, _ in made], gathered=gathered)
        last = torch.randn(int(whole.fine[-1]), 3, generator=torch.Generator().manual_seed(0))
        was = torch.randn(int(whole.coarse[-1]), PATCH, generator=torch.Generator().manual_seed(1))
        off, _ = network(whole, moment, whole.at.carried(last, moment.turn, moment.turn), was)
        (off.square().mean() + whole.at.edge_gap(off)).backward()
        found.append({name: value.grad for name, value in network.named_parameters()})
    for name, one in found[0].items():
        assert (one - found[1][name]).norm() < 1e-3 * one.norm() + 1e-7, name


def test_gradients_are_those_of_small_changes() -> None:
    torch = pytest.importorskip("torch")
    from sim_core.learn.networks import LearnedSteps, Moment

    torch.manual_seed(0)
    ground, made = hanging(1)
    network, whole = LearnedSteps(Settings(width=6, hidden=8, blocks=1, steps=1)), glued([ground])
    with torch.no_grad():
        for value in network.parameters():
            value.add_(0.1 * torch.randn_like(value))
    moment = Moment.of(ground, made.coarse, 4)
    last, was = torch.randn(int(whole.fine[-1]), 3), torch.randn(int(whole.coarse[-1]), PATCH)

    def loss():
        off, _ = network(whole, moment, last, was)
        return off.square().mean() + whole.at.edge_gap(off)

    loss().backward()
    for name, value in network.named_parameters():
        step = torch.randn_like(value)
        step *= 1e-2 / step.norm()
        with torch.no_grad():
            value.add_(step)
            there = float(loss())
            value.sub_(2 * step)
            back = float(loss())
            value.add_(step)
        assert there - back == pytest.approx(2 * float((value.grad * step).sum()), rel=0.05, abs=2e-5), name


def test_what_was_trained_is_nearer_and_a_broken_off_training_ends_in_the_same_weights(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("torch")
    from sim_core.learn.networks import Schedule, record, train

    monkeypatch.setattr(record, "BETWEEN", 0.0)
    recipe = Recipe("hanging", 1, 7, 6, 0, coarse=90, fine=340)
    ground, made = hanging(1)
    take = Take.of(recipe, made)
    schedule, file = Schedule(updates=400, lanes=2, rate=1e-2), tmp_path / "record.pt"
    weights = train([take], SMALL, schedule)

    def broken(share: float, words: str) -> None:
        if share > 0.4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train([take], SMALL, schedule, record=file, told=broken)
    again = train([take], SMALL, schedule, record=file)
    assert all(np.array_equal(again[name], weights[name]) for name in weights)
    follow, off = Follower(ground, SMALL, weights), [[], []]
    for coarse, fine in zip(made.coarse.astype(float), made.fine, strict=True):
        for kind, place in enumerate((follow(coarse), ground.pair.base @ coarse)):
            off[kind].append(np.linalg.norm(place - fine, axis=1).mean())
    assert np.mean(off[0]) < 0.6 * np.mean(off[1])
    with pytest.raises(SimCoreError, match="begun with other settings"):
        train([take], SMALL, Schedule(updates=121, lanes=2, rate=1e-2), record=file)
    file.write_bytes(b"half")
    with pytest.raises(SimCoreError, match="damaged .* delete it and train again"):
        train([take], SMALL, schedule, record=file)


def test_weights_are_kept_as_they_are_and_what_was_changed_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "ours.safetensors"
    write_weights(path, Trained(SMALL, drawn(5), {"scene": "hanging", "updates": 3}))
    found = read_weights(path)
    assert isinstance(found, Trained)
    assert found.settings == SMALL
    assert found.told == {"scene": "hanging", "updates": 3}
    assert all(np.array_equal(found.weights[name], value) for name, value in drawn(5).items())
    whole = bytearray(path.read_bytes())
    whole[-7] ^= 1
    for data, words in (
        (whole, "changed since"),
        (whole[:-40], "damaged"),
        (b"", "damaged"),
        (b"{}" * 9, "damaged"),
    ):
        path.write_bytes(data)
        with pytest.raises(SimCoreError, match=words):
            read_weights(path)
    with pytest.raises(SimCoreError, match="damaged"):
        read_weights(tmp_path / "none.safetensors")
    write_weights(path, Trained(Settings(), drawn(5), {}))
    with pytest.raises(SimCoreError, match="do not fit"):
        read_weights(path)
    stays = {"9-20-1.0": Pooled(np.array([0, 2, 5]), np.array([[0, 1, 2]], np.int32), 0.5)}
    write_weights(path, Trained(SMALL, drawn(5), {"share": 0.5}, stays))
    found = read_weights(path)
    assert np.array_equal(found.pooled["9-20-1.0"].kept, [0, 2, 5])
    assert set(found.weights) == set(drawn(5))


def test_the_commands_compare_what_was_trained(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    generate(tmp_path / "data", [Recipe("hanging", case, 7, 6, 0, coarse=90, fine=340) for case in (1, 3, 4)])
    place, out = ["hanging", "--data", str(tmp_path / "data")], tmp_path / "ours.safetensors"
    write_weights(out, Trained(SMALL, drawn(5, 0.01), {"scene": "hanging", "learned_from": ["hanging-01"]}))
    assert (
        main(["learn", "evaluate", *place, "--rows", "biharmonic,ours", "--weights", str(out), "--json"]) == 0
    )
    rows = json.loads(capsys.readouterr().out)["rows"]
    assert rows["ours"]["net_ms"] > rows["biharmonic"]["net_ms"]
    assert main(["learn", "evaluate", *place, "--rows", "ours"]) == 1
    assert "give its --weights" in capsys.readouterr().err
    for told, words in (
        ({"scene": "flag"}, "has learned flag"),
        ({"scene": "hanging", "share": 0.5}, "trained with --share 0.5"),
    ):
        write_weights(out, Trained(SMALL, drawn(5), told))
        assert main(["learn", "evaluate", *place, "--weights", str(out)]) == 1
        assert words in capsys.readouterr().err
    write_weights(out, Trained(SMALL, drawn(5), {"scene": "hanging", "learned_from": ["hanging-03"]}))
    assert main(["learn", "evaluate", *place, "--weights", str(out)]) == 1
    assert "learned from hanging-03, which would be tested on" in capsys.readouterr().err
    assert main(["learn", "train", *place, "--out", "ours.pt"]) == 1
    assert "ends in .safetensors" in capsys.readouterr().err


def test_the_command_trains(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("torch")
    generate(tmp_path, [Recipe("hanging", case, 7, 6, 0, coarse=90, fine=340) for case in (1, 3)])
    out = tmp_path / "ours.safetensors"
    words = [
        "learn",
        "train",
        "hanging",
        "--data",
        str(tmp_path),
        "--out",
        str(out),
        "--updates",
        "30",
        "--json",
    ]
    assert main(words) == 0
    assert json.loads(capsys.readouterr().out)["learned_from"] == ["hanging-01"]
    assert read_weights(out).told["updates"] == 30
    assert out.with_suffix(".record").is_file()


def test_the_command_makes_a_fine_film(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(DESIGNS, "teapot", Design(16, 400, 90, 340))
    weights, out = tmp_path / "ours.safetensors", tmp_path / "film.npz"
    write_weights(weights, Trained(SMALL, drawn(5, 0.01), {"scene": "teapot"}))
    words = ["learn", "infer", "teapot", "--weights", str(weights), "--out", str(out), "--json"]
    assert main([*words, "--frames", "3", "--case", "2"]) == 0
    facts = json.loads(capsys.readouterr().out)
    with np.load(out) as file:
        coarse, fine = file["coarse"], file["fine"]
        assert coarse.shape == (3, facts["coarse_vertices"], 3)
        assert fine.shape == (3, facts["fine_vertices"], 3)
        assert file["fine_faces"].max() == facts["fine_vertices"] - 1
    assert facts["total_ms"] == pytest.approx(facts["coarse_ms"] + facts["net_ms"], abs=2e-3)
    brought, again = tmp_path / "mine.npz", tmp_path / "again.npz"
    np.savez(brought, coarse=coarse)
    words[words.index(str(out))] = str(again)
    assert main([*words, "--case", "2", "--coarse", str(brought)]) == 0
    with np.load(again) as file:
        assert np.array_equal(file["fine"], fine)
    capsys.readouterr()
    coarse[1, 5] = np.nan
    for film_, told in (
        (coarse, "frame 2: coarse: vertex 5 is not finite"),
        (coarse[:, :-1], "frame 1: coarse"),
        (coarse[0], "(frames, vertices, 3) [m] is meant"),
    ):
        np.savez(brought, coarse=film_)
        assert main([*words, "--coarse", str(brought)]) == 1
        assert told in capsys.readouterr().err
    brought.write_bytes(b"none")
    for more, told in (
        (["--coarse", str(brought)], "not a coarse film"),
        (["--case", "17"], "there are 1 to 16"),
    ):
        assert main([*words, *more]) == 1
        assert told in capsys.readouterr().err
    words[2] = "flag"
    assert main(words) == 1
    assert "has learned teapot – give weights of flag" in capsys.readouterr().err


def test_the_command_draws_a_scene_a_row(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from PIL import Image

    generate(tmp_path / "data", [Recipe("hanging", case, 7, 6, 0, coarse=90, fine=340) for case in (1, 3)])
    weights, out = tmp_path / "ours.safetensors", tmp_path / "drawn.png"
    write_weights(weights, Trained(SMALL, drawn(5, 0.01), {"scene": "hanging"}))
    words = ["learn", "draw", "--data", str(tmp_path / "data"), "--out", str(out), "--json"]
    assert main([*words, "--weights", str(weights)]) == 0
    row = json.loads(capsys.readouterr().out)["rows"][0]
    assert row["sequence"] == "hanging-03"
    assert list(row["errors"]) == ["biharmonic", "ours"]
    assert 0 < row["errors"]["ours"]["mean_mm"] < row["errors"]["ours"]["hausdorff_mm"]
    with Image.open(out) as picture:
        assert picture.width > 3 * picture.height
        assert len(np.unique(np.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0)) > 200
    words[words.index(str(out))] = str(out.with_suffix(".jpg"))
    assert main(words) == 0
    with Image.open(out.with_suffix(".jpg")) as picture:
        assert picture.format == "JPEG"
    capsys.readouterr()
    assert main([*words, "--frame", "7"]) == 1
    assert "--frame: 7 – hanging-03 has 6" in capsys.readouterr().err
    write_weights(
        weights, Trained(SMALL, drawn(5, 0.01), {"scene": "hanging", "learned_from": ["hanging-03"]})
    )
    assert main([*words, "--weights", str(weights)]) == 1
    assert "learned from hanging-03, which would be tested on" in capsys.readouterr().err


def test_the_command_shows_three_meshes_for_an_exhibit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    import tomllib

    from sim_core.garment.clip import Clip
    from sim_core.gltf import glb_parts

    generate(tmp_path / "data", [Recipe("hanging", case, 7, 6, 0, coarse=90, fine=340) for case in (1, 3)])
    weights, out = tmp_path / "ours.safetensors", tmp_path / "out"
    told = {"scene": "hanging", "learned_from": ["hanging-01"]}
    write_weights(weights, Trained(SMALL, drawn(5, 0.01), told))
    words = ["learn", "show", "hanging", "--data", str(tmp_path / "data"), "--weights", str(weights)]
    assert main([*words, "--out", str(out), "--begin", "2", "--frames", "4", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    coarse, learned, fine = facts["sides"]
    assert 0 < learned["hausdorff_mm"]
    assert "hausdorff_mm" not in fine
    assert coarse["vertices"] < learned["vertices"] == fine["vertices"]
    assert coarse["milliseconds"] < learned["milliseconds"]
    clip, model = Clip.load(out / "comparison.clip"), glb_parts((out / "comparison.glb").read_bytes())
    assert (clip.frames, clip.rate, clip.names) == (4, 25.0, ("coarse", "learned", "fine"))
    film = read_films(tmp_path / "data")["hanging-03"][1]
    for name, frames in (("coarse", film.coarse), ("fine", film.fine)):
        places = np.stack([clip.positions(k, name) for k in range(4)])
        away = places - frames[1:5]
        assert np.abs(away - away[0, 0]).max() < 3e-4  # moved aside, and nothing else
        assert places[:, :, 1].min() > -3e-4
    right = [clip.positions(0, name)[:, 0] for name in clip.names]
    assert right[0].max() < right[1].min()
    assert right[1].max() < right[2].min()
    for mesh, name in zip(model.document["meshes"], clip.names, strict=True):
        places = model.numbers(mesh["primitives"][0]["attributes"]["POSITION"])
        assert min(np.abs(clip.positions(k, name) - places).max() for k in range(4)) < 3e-4  # a frame of them
    table = tomllib.loads((out / "comparison.toml").read_text("utf-8"))["comparison"]
    assert [side["name"]["zh"] for side in table["side"]][1:] == ["粗网格模拟＋学习", "细网格模拟"]
    assert table["side"][0]["hausdorff_mm"] == coarse["hausdorff_mm"]
    assert main([*words, "--out", str(out), "--frames", "7"]) == 1
    assert "hanging-03 has 6 frames" in capsys.readouterr().err
    words[2] = "flag"
    assert main([*words, "--out", str(out)]) == 1
    assert "has learned hanging – give weights of flag" in capsys.readouterr().err
