"""The weights that are shipped: small, free, and nearer than what they mend, on a sequence that nobody learned from."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from sim_core.learn.data import Take, film, recipes, split
from sim_core.learn.inference import read_weights
from sim_core.learn.rows import Biharmonic, Ours, measured

FOLDER = Path(__file__).parents[2] / "assets/learn"
FILES = sorted(FOLDER.glob("*.safetensors"))
FRAMES = 10


def test_weights_are_shipped_and_small() -> None:
    assert FILES
    assert sum(path.stat().st_size for path in FILES) < 5_000_000


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_shipped_weights_say_what_they_are(path: Path) -> None:
    told = read_weights(path).told
    assert told["scene"] == path.stem
    assert told["licence"] == "CC0-1.0"
    assert len(str(told["data_sha256"])) == 64
    held_back = {recipe.name for recipe in split(recipes(path.stem)).test}
    assert told["learned_from"]
    assert not held_back & set(told["learned_from"])


@pytest.mark.slow
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_shipped_weights_mend_a_sequence_that_was_held_back(path: Path) -> None:
    recipe = replace(split(recipes(path.stem)).test[0], frames=FRAMES)
    take = Take.of(recipe, film(recipe))
    ours, base = (measured(row, [take]) for row in (Ours(read_weights(path)), Biharmonic()))
    assert ours.errors.mean.vertex < 0.9 * base.errors.mean.vertex
