"""`simcore learn data`: a scene's sequences simulated, and what they are worth."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from statistics import median
from threading import Thread
from typing import TYPE_CHECKING, Any

from sim_core.errors import SimCoreError
from sim_core.learn.commands.parts import progress

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from sim_core.learn.data import Floor, Manifest, Recipe

__all__ = ["data"]

PATIENCE = 10.0  # [s] for a cluster's scheduler to answer, and for a worker to be there


def data(args: argparse.Namespace) -> int:
    """Makes the data and tells what they are worth."""
    from sim_core.learn.data import Manifest, floor, generate, recipes

    wanted = recipes(args.scene, sequences=args.sequences, frames=args.frames, seed=args.seed)
    args.out.mkdir(parents=True, exist_ok=True)
    Manifest.matching(args.out, wanted)  # what cannot go on is refused before anything runs
    with _executor(args) as executor:
        worth = floor(wanted[0], args.floor) if args.floor else None
        if worth is not None and not args.json:
            sys.stdout.write(_floor_words(wanted[0], worth))
            sys.stdout.flush()
        manifest = generate(args.out, wanted, executor=executor, progress=progress())
    facts = _facts(args.out, manifest) | ({"floor": _floor_facts(worth)} if worth else {})
    sys.stdout.write(json.dumps(facts, indent=2) + "\n" if args.json else _words(facts))
    return 0


def _executor(args: argparse.Namespace) -> AbstractContextManager[Executor | None]:
    """Who makes sequences: a cluster, processes of this machine, or nobody but this one."""
    if args.cluster is not None:
        return _cluster(args.cluster)
    if args.workers > 1:
        from concurrent.futures import ProcessPoolExecutor
        from multiprocessing import get_context

        return ProcessPoolExecutor(args.workers, mp_context=get_context("spawn"))
    return nullcontext()


@contextmanager
def _cluster(address: str) -> Iterator[Executor]:
    """The workers of a Dask cluster. Raises SimCoreError where Dask is not installed, or nobody is there to work."""
    try:
        from distributed import Client
    except ImportError:
        raise SimCoreError("--cluster: Dask is not installed – pip install '.[cluster]'") from None
    found: list[Client | BaseException] = []

    def connect() -> None:
        try:
            found.append(Client(address, timeout=PATIENCE))
        except BaseException as error:
            found.append(error)

    # Whoever accepts a connection and says nothing is waited for without an end, whatever the client's own limit is.
    thread = Thread(target=connect, daemon=True)
    thread.start()
    thread.join(2 * PATIENCE)
    client = found[0] if found else TimeoutError(f"no answer within {2 * PATIENCE:g} s")
    if isinstance(client, BaseException):
        why = (str(client).splitlines() or [type(client).__name__])[0][:120]
        raise SimCoreError(
            f"--cluster {address}: no scheduler answers ({why}) – run `dask scheduler` there, or correct the address"
        )
    with client:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError:
            raise SimCoreError(
                f"--cluster {address}: the scheduler has no workers – run `dask worker {address}` where they are"
            ) from None
        yield client.get_executor()


def _facts(folder: Path, manifest: Manifest) -> dict[str, Any]:
    kept = list(manifest.done.values())
    return {
        "folder": str(folder),
        "scene": manifest.recipes[0].scene,
        "sequences": len(kept),
        "frames": sum(one["frames"] for one in kept),
        "coarse_vertices": [one["coarse_vertices"] for one in kept],
        "fine_vertices": [one["fine_vertices"] for one in kept],
        "coarse_ms": round(median([one["coarse_ms"] for one in kept]), 3),
        "fine_ms": round(median([one["fine_ms"] for one in kept]), 3),
        "bytes": sum((folder / one["file"]).stat().st_size for one in kept),
    }


def _floor_facts(worth: Floor) -> dict[str, Any]:
    halved, flat = worth.halved, worth.linear
    return {
        "frames": halved.frames,
        "hausdorff_mm": round(1000 * halved.mean.hausdorff, 4),
        "hausdorff_p95_mm": round(1000 * halved.p95.hausdorff, 4),
        "mean_mm": round(1000 * halved.mean.vertex, 4),
        "normal_deg": round(halved.mean.normal, 4),
        "linear_hausdorff_mm": round(1000 * flat.mean.hausdorff, 4),
        "linear_mean_mm": round(1000 * flat.mean.vertex, 4),
        "slack_mm": round(1000 * worth.slack, 4),
        "fine_ms": round(worth.fine_ms, 2),
        "halved_ms": round(worth.halved_ms, 2),
    }


def _floor_words(recipe: Recipe, worth: Floor) -> str:
    told = _floor_facts(worth)
    return (
        f"floor, {recipe.name}, {told['frames']} frames looked at: half the step moves the fine sheet by "
        f"{told['mean_mm']:.3g} mm (mean), {told['hausdorff_mm']:.3g} mm (Hausdorff; p95 "
        f"{told['hausdorff_p95_mm']:.3g})\n"
        f"  the coarse surface is {told['linear_mean_mm']:.3g} mm from it (mean), {told['linear_hausdorff_mm']:.3g} mm "
        f"(Hausdorff); the led means are {told['slack_mm']:.2g} mm off\n"
    )


def _words(facts: dict[str, Any]) -> str:
    return (
        f"{facts['folder']}: {facts['sequences']} sequences, {facts['frames']} frames of {facts['scene']}, "
        f"{facts['bytes'] / 1e6:.1f} MB; a frame takes {facts['coarse_ms']:.2f} ms coarse, {facts['fine_ms']:.1f} ms "
        "fine and led\n"
    )
