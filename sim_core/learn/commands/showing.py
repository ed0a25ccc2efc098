"""`simcore learn show`: coarse, learned and fine side by side for the close-up of an exhibit – model, clip, table."""

from __future__ import annotations

import argparse
import json
import sys
from typing import TYPE_CHECKING, Any

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.learn.commands.parts import films_of, never_seen, progress, weights_of
from sim_core.validation.files import check_target, written_whole

if TYPE_CHECKING:
    from sim_core.learn.data import Film, Recipe
    from sim_core.learn.rows import Row

__all__ = ["show"]

FILES = ("comparison.glb", "comparison.clip", "comparison.toml")
TIMED = 20  # frames that are simulated anew to tell what one costs
RATE = 25.0  # frames a second, as data have them
LARGEST = 2_000_000  # [bytes] of a clip that the hall takes
# Of each side: its node in the model, name in Chinese and English, colour.
COARSE = ("coarse", "粗网格模拟", "Coarse simulation", "#b0793c")
LEARNED = ("learned", "粗网格模拟＋学习", "Coarse + learned", "#2f9a6a")
FINE = ("fine", "细网格模拟", "Fine simulation", "#3a66b0")


def show(args: argparse.Namespace) -> int:
    """Writes comparison.glb, comparison.clip and comparison.toml."""
    from sim_core.learn.data import split
    from sim_core.learn.rows import row_of

    trained = weights_of(args.weights, args.scene)
    try:
        args.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise SimCoreError(f"--out: {args.out} – {error.strerror or error}: name a folder") from None
    for name in FILES:
        check_target(args.out / name)
    films = films_of(args)
    recipe = split([one for one, _ in films.values()]).test[0]
    never_seen(args.weights, trained, [recipe])
    film = films[recipe.name][1]
    last = args.begin - 1 + args.frames
    if last > len(film.fine):
        raise SimCoreError(
            f"--begin {args.begin} --frames {args.frames}: {recipe.name} has {len(film.fine)} frames"
        )
    facts = _written(args, row_of(trained), recipe, film)
    sys.stdout.write(json.dumps(facts, indent=2) + "\n" if args.json else _words(facts))
    return 0


def _written(args: argparse.Namespace, row: Row, recipe: Recipe, film: Film) -> dict[str, Any]:
    from sim_core.learn.data import Pair, floor
    from sim_core.learn.evaluation import Side, side_by_side_clip
    from sim_core.learn.rows import followed

    told, pair = progress(), Pair.of(recipe)
    first, last = args.begin - 1, args.begin - 1 + args.frames
    made, spent = [], []
    for number, (fine, seconds) in enumerate(followed(row, pair, film.coarse[:last])):
        spent.append(seconds)
        if number >= first:
            made.append(fine.astype(np.float32))
        if number % 25 == 0:
            told(0.5 * number / last, row.name)
    shown = {"coarse": film.coarse[first:last], "learned": np.stack(made), "fine": film.fine[first:last]}
    faces = {"coarse": pair.coarse.faces, "learned": pair.fine.faces, "fine": pair.fine.faces}
    errors = {}
    for number, name in enumerate(("coarse", "learned")):
        told(0.5 + 0.15 * number, name)
        errors[name] = _distance((shown[name], faces[name]), (shown["fine"], faces["fine"]))
    told(0.8, "times")
    now, net = floor(recipe, TIMED), 1000.0 * float(np.median(spent))
    times = {"coarse": now.coarse_ms, "learned": now.coarse_ms + net, "fine": now.fine_ms}
    sides = [Side(name, colour, shown[name], faces[name]) for name, _, _, colour in (COARSE, LEARNED, FINE)]
    model, clip = side_by_side_clip(sides, RATE, solid=recipe.on(recipe.coarse).solid)
    told(1.0, "")
    with written_whole(args.out / "comparison.glb") as stream:
        stream.write(model)
    size = clip.save(args.out / "comparison.clip")
    rows = [
        {
            "name": {"zh": zh, "en": en},
            "colour": colour,
            "vertices": shown[name].shape[1],
            **({"hausdorff_mm": round(errors[name], 2)} if name in errors else {}),
            "milliseconds": round(times[name], 2),
        }
        for name, zh, en, colour in (COARSE, LEARNED, FINE)
    ]
    with written_whole(args.out / "comparison.toml") as stream:
        stream.write(_table(recipe, args, rows).encode())
    return {
        "folder": str(args.out),
        "sequence": recipe.name,
        "begin": args.begin,
        "frames": args.frames,
        "sides": rows,
        "model_bytes": len(model),
        "clip_bytes": size,
        "clip_error_mm": round(1000.0 * clip.error, 4),
    }


def _distance(one: tuple[np.ndarray, np.ndarray], other: tuple[np.ndarray, np.ndarray]) -> float:
    """The mean over frames of the two-sided Hausdorff distance [mm] of two films (T, V, 3), each with its faces."""
    from sim_core.learn.evaluation import two_sided

    both = zip(one[0].astype(float), other[0].astype(float), strict=True)
    return 1000.0 * float(np.mean([two_sided(a, one[1], b, other[1]).max() for a, b in both]))


def _table(recipe: Recipe, args: argparse.Namespace, rows: list[dict[str, Any]]) -> str:
    """The tables of exhibit.toml."""
    frames = f"{args.begin}–{args.begin + args.frames - 1}"
    zh = (
        f"场景 {recipe.scene} 的序列 {recipe.name}（未用于学习），第 {frames} 帧。豪斯多夫距离为这些帧的平均值；"
        "毫秒数为单个处理器核心所需，含全部步骤。"
    )
    en = (
        f"Sequence {recipe.name} of the scene {recipe.scene}, not learned from, frames {frames}. Hausdorff distances "
        "are means over these frames; milliseconds are of one processor core, all steps included."
    )
    lines = [
        "[comparison]",
        'model = "comparison.glb"',
        'clip = "comparison.clip"',
        f'text = {{ zh = "{zh}", en = "{en}" }}',
    ]
    for row in rows:
        lines += [
            "",
            "[[comparison.side]]",
            f'name = {{ zh = "{row["name"]["zh"]}", en = "{row["name"]["en"]}" }}',
            f'colour = "{row["colour"]}"',
            *(f"{key} = {row[key]}" for key in ("vertices", "hausdorff_mm", "milliseconds") if key in row),
        ]
    return "\n".join(lines) + "\n"


def _words(facts: dict[str, Any]) -> str:
    lines = [f"{facts['folder']}: {facts['sequence']}, {facts['frames']} frames\n"]
    for side in facts["sides"]:
        away = f"Hausdorff {side['hausdorff_mm']:.2f} mm" if "hausdorff_mm" in side else "reference"
        lines.append(
            f"  {side['name']['en']:20}{side['vertices']:>8,} vertices  {side['milliseconds']:>8.2f} ms  {away}\n"
        )
    lines.append("copy comparison.glb and .clip beside exhibit.toml, and comparison.toml to its end\n")
    if facts["clip_bytes"] > LARGEST:
        lines.append(
            f"the clip has {facts['clip_bytes'] / 1e6:.2f} MB, the hall takes 2: give fewer --frames\n"
        )
    return "".join(lines)
