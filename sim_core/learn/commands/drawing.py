"""`simcore learn draw`: coarse, made fine and fine side by side, on sequences that are held back."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.learn.commands.parts import never_seen, progress, usual, weights_of
from sim_core.validation.files import check_target

if TYPE_CHECKING:
    from sim_core.learn.data import Film, Recipe
    from sim_core.learn.evaluation import Shown
    from sim_core.learn.rows import Row

__all__ = ["draw"]


def draw(args: argparse.Namespace) -> int:
    """Draws a scene a row, each of the first sequence held back."""
    from sim_core.learn.data import read_films, split
    from sim_core.learn.evaluation import draw_side_by_side
    from sim_core.learn.rows import Biharmonic, row_of

    check_target(args.out)
    given = {}
    for path in args.weights:
        trained = weights_of(path)
        given.setdefault(trained.told.get("scene"), []).append((path, trained))
    told, rows, facts = progress(), [], []
    for number, folder in enumerate(args.data):
        films = read_films(folder)
        recipe = split([one for one, _ in films.values()]).test[0]
        learned = given.get(recipe.scene, ())
        for path, trained in learned:
            never_seen(path, trained, [recipe])
        follows = [Biharmonic(), *(row_of(trained) for _, trained in learned)]

        def share(part: float, words: str, number: int = number) -> None:
            told((number + part) / len(args.data), words)

        shown, fact = _scene(*films[recipe.name], follows, args.frame, share)
        rows.append(shown)
        facts.append(fact)
    draw_side_by_side(args.out, rows)
    told(1.0, "")
    summary = {"file": str(args.out), "rows": facts}
    words = "".join(f"{fact['sequence']}, frame {fact['frame']}\n" for fact in facts)
    sys.stdout.write(json.dumps(summary, indent=2) + "\n" if args.json else f"{args.out}: {words}")
    return 0


def _scene(
    recipe: Recipe, film: Film, rows: list[Row], frame: int | None, told: Callable[[float, str], None]
) -> tuple[list[Shown], dict[str, Any]]:
    """The meshes of a row: the coarse one, one for each way from it to the fine one, and the fine one."""
    from sim_core.learn.data import Pair
    from sim_core.learn.evaluation import Shown, frame_errors
    from sim_core.learn.rows import followed

    if frame is not None and frame > len(film.fine):
        raise SimCoreError(f"--frame: {frame} – {recipe.name} has {len(film.fine)}")
    pair, made, solid = Pair.of(recipe), [], recipe.on(recipe.coarse).solid
    for number, row in enumerate(rows):
        frames = []
        for k, (fine, _) in enumerate(followed(row, pair, film.coarse[:frame])):
            frames.append(fine.astype(np.float32))
            if k % 50 == 0:
                told((number + k / len(film.coarse)) / len(rows), row.name)
        made.append(np.stack(frames))
    which = usual(made[-1], film.fine) if frame is None else frame - 1
    fine = np.asarray(film.fine[which], float)
    shown = [
        Shown(
            f"{recipe.scene}: coarse, {len(pair.coarse.rest):,} vertices",
            film.coarse[which],
            pair.coarse.faces,
            solid=solid,
        )
    ]
    errors = {}
    for row, frames in zip(rows, made, strict=True):
        place = np.asarray(frames[which], float)
        found = frame_errors(place, fine, pair.fine.faces, pair.fine.rest)
        errors[row.name] = {
            "mean_mm": round(1e3 * found.vertex, 3),
            "hausdorff_mm": round(1e3 * found.hausdorff, 3),
        }
        words = f"{row.name}, {len(fine):,}: mean {1e3 * found.vertex:.2g}, Hausdorff {1e3 * found.hausdorff:.2g} mm"
        shown.append(Shown(words, place, pair.fine.faces, np.linalg.norm(place - fine, axis=1), solid))
    shown.append(Shown(f"fine, {len(fine):,} vertices", fine, pair.fine.faces, solid=solid))
    return shown, {"sequence": recipe.name, "frame": which + 1, "errors": errors}
