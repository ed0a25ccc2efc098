"""`simcore learn train`: weights of a scene's network, from the sequences that are not held back."""

# pyright: reportMissingImports=false
# (torch is an extra)

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from sim_core.learn.commands.parts import progress, takes_of

if TYPE_CHECKING:
    import numpy as np

    from sim_core.learn.data import Take
    from sim_core.learn.pooling import Pooled

__all__ = ["train"]

LICENCE = "CC0-1.0"  # of weights, as of all that is made here


def train(args: argparse.Namespace) -> int:
    """Trains on the sequences that are not held back, and writes the weights."""
    from importlib.util import find_spec

    from sim_core.cloth.run import ENGINE_VERSION
    from sim_core.errors import SimCoreError
    from sim_core.learn.data import POOLINGS, Manifest, pooled_by_kind, pooled_takes
    from sim_core.learn.inference import RivalTrained, Settings, Trained, write_weights

    if args.out.suffix != ".safetensors":
        raise SimCoreError(f"--out: {args.out} – name a file that ends in .safetensors")
    if find_spec("torch") is None:
        raise SimCoreError("torch is not installed – pip install '.[learn]'; to use weights it is not needed")
    if args.share and args.row != "ours":
        raise SimCoreError(f"--share: {args.row} does not reconstruct – only ours does")
    takes = takes_of(args).train
    began, told = time.monotonic(), progress()
    device, words = _device(args.device)
    if not args.json:
        sys.stdout.write(f"trains {args.row} on {words}\n")
        sys.stdout.flush()
    facts = {
        "scene": args.scene,
        "row": args.row,
        **({"share": args.share} if args.share else {}),
        "learned_from": [take.name for take in takes],
        "data_sha256": Manifest.load(args.data).digest,
        "engine": ENGINE_VERSION,
        "updates": args.updates,
        "seed": args.seed,
        "device": words,
        "licence": LICENCE,
    }
    pooled: dict[str, Pooled] = {}
    if args.share:
        told(0.0, "pools")
        pooled = pooled_by_kind(takes, POOLINGS[1], args.share)
        takes = pooled_takes(takes, pooled)
    weights, more = _trained(args, takes, device, told)
    trained = (
        Trained(Settings(), weights, facts, pooled)
        if more is None
        else RivalTrained(args.row, weights, more, facts)
    )
    told(1.0, "")
    write_weights(args.out, trained)
    size = sum(value.size for value in trained.weights.values())
    facts |= {
        "file": str(args.out),
        "parameters": size,
        "seconds": round(time.monotonic() - began, 1),
    }
    line = f"{args.out}: {size:,} numbers, {args.updates:,} updates in {facts['seconds']:.0f} s\n"
    sys.stdout.write(json.dumps(facts, indent=2) + "\n" if args.json else line)
    return 0


def _device(wanted: str) -> tuple[str, str]:
    """As torch names it, and in words. Raises SimCoreError for a GPU that is not there."""
    import torch

    from sim_core.errors import SimCoreError

    there = torch.cuda.is_available()
    if wanted == "cuda" and not there:
        raise SimCoreError("--device cuda: there is no GPU that torch can use – leave it out, or say cpu")
    if there and wanted != "cpu":
        return "cuda", torch.cuda.get_device_name(0)
    return "cpu", "cpu"


def _trained(
    args: argparse.Namespace, takes: list[Take], device: str, told: Callable[[float, str], None]
) -> tuple[dict[str, np.ndarray], dict[str, Pooled] | None]:
    """Weights, and of a rival what its own pooling keeps."""
    from sim_core.learn.inference import RIVALS, Settings

    record = args.out.with_suffix(".record")

    def heard(share: float, words: str) -> None:
        told(share, words if words[:1].isalpha() else f"loss {words}")

    if args.row in RIVALS:
        from sim_core.learn.networks.rivals import RivalSchedule, train_rival

        rival, plan = RIVALS[args.row], RivalSchedule(updates=args.updates, seed=args.seed)
        return train_rival(takes, rival, plan, device=device, record=record, told=heard)
    from sim_core.learn.networks import Schedule
    from sim_core.learn.networks import train as trained

    schedule = Schedule(updates=args.updates, lanes=4 if device == "cpu" else 16, seed=args.seed)
    return trained(takes, Settings(), schedule, device=device, record=record, told=heard), None
