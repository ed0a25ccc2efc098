"""Sequences made by whatever executes work, each written as it is done; what is there already is not made again."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor, Future, as_completed
from pathlib import Path
from typing import Any

from sim_core.errors import SimCoreError
from sim_core.learn.data.film import film
from sim_core.learn.data.lead import MADE_BY
from sim_core.learn.data.recipe import Recipe
from sim_core.learn.data.store import Manifest, packed

__all__ = ["generate"]

Told = Callable[[float, str], None]


def generate(
    folder: Path,
    recipes: Sequence[Recipe],
    *,
    executor: Executor | None = None,
    progress: Told | None = None,
) -> Manifest:
    """Makes the sequences of a folder that are not there yet, and returns what it holds then.

    executor: any of `concurrent.futures` (processes on this machine; a Dask cluster's
    `distributed.Client.get_executor()`): work goes out as recipes and comes back as files' bytes, so workers need no
    disk in common. None: one after the other, here. progress(share, words): of all sequences. Interrupted or killed,
    the same call goes on with what is missing.
    Raises SimCoreError where the folder holds other data, or a worker failed.
    """
    folder.mkdir(parents=True, exist_ok=True)
    manifest = Manifest.of(folder, recipes)
    manifest.save(folder)
    told = progress or (lambda share, words: None)
    if executor is None:
        for recipe in manifest.left:
            ready = len(manifest.done)

            def share(part: float, name: str = recipe.name, ready: int = ready) -> None:
                told((ready + part) / len(recipes), name)

            manifest = manifest.adding(folder, recipe, *made(recipe, share))
        return manifest
    waiting: dict[Future[tuple[bytes, dict[str, Any]]], Recipe] = {
        executor.submit(made, recipe): recipe for recipe in manifest.left
    }
    try:
        for done in as_completed(waiting):
            manifest = manifest.adding(folder, waiting[done], *_result(waiting[done], done))
            told(len(manifest.done) / len(recipes), waiting[done].name)
    finally:
        for future in waiting:
            future.cancel()
    return manifest


def _result(recipe: Recipe, done: Future[tuple[bytes, dict[str, Any]]]) -> tuple[bytes, dict[str, Any]]:
    """What a worker made. Raises SimCoreError, its own or one that tells how the worker ended."""
    try:
        return done.result()
    except SimCoreError:
        raise
    except Exception as error:
        words = (str(error).splitlines() or ["no words"])[0][:120]
        raise SimCoreError(
            f"{recipe.name}: its worker failed ({type(error).__name__}: {words}) – the same command goes on"
        ) from error


def made(recipe: Recipe, told: Callable[[float], None] | None = None) -> tuple[bytes, dict[str, Any]]:
    """A sequence as its file's bytes, and what the manifest says of it."""
    both = film(recipe, told)
    facts = {
        "frames": len(both.fine),
        "coarse_vertices": both.coarse.shape[1],
        "fine_vertices": both.fine.shape[1],
        "coarse_ms": round(both.coarse_ms, 3),
        "fine_ms": round(both.fine_ms, 3),
        "made": MADE_BY,
    }
    return packed(recipe, both), facts
