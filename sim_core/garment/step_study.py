"""How far a drape depends on its mesh: an outfit dressed at several mesh steps, each compared with the next finer."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from sim_core import metrics
from sim_core.cloth import Checkpoint
from sim_core.errors import FileProblem
from sim_core.garment.dressing import dress, forget
from sim_core.garment.garment import Garment
from sim_core.garment.outfit import Outfit

__all__ = ["forget_study", "step_study", "study_inputs"]

BESIDE = 1.02  # times the coarsest step: another mesh of the same step, for what a drape scatters by
SPACING = 0.006  # [m] of the samples that measure the distance of two drapes


def study_inputs(outfit: Outfit) -> str:
    """A hash of all that decides the drapes but their mesh steps."""
    told = outfit.to_dict()
    for layer in told["layers"]:
        del layer["edge"]
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()[:16]


def step_study(
    outfit: Outfit,
    kept: Path,
    steps: Sequence[float],
    progress: Callable[[float, str], None] | None = None,
) -> dict[str, Any]:
    """The outfit dressed at mesh steps [m], the coarsest first, and once beside it; plain values for JSON.

    Of each layer: edges [m], triangles and processor seconds; distance of the drapes of successive steps, two-sided
    between surfaces, mean and p99 [m]; the same of the coarsest and one on a mesh 2 % coarser, which is what the drape
    scatters by. kept: garments are kept beside it, `NAME.26.0mm.robe.npz`, so that an interrupted study goes on; remove
    them by `forget_study` once the result is written.
    """
    ordered = sorted(map(float, steps), reverse=True)
    tried = [ordered[0] * BESIDE, *ordered]
    whole = sum(edge**-3 for edge in tried)
    dressed: list[tuple[Garment, ...]] = []
    for number, edge in enumerate(tried):
        before = sum(e**-3 for e in tried[:number]) / whole

        def told(share: float, label: str, edge: float = edge, before: float = before) -> None:
            assert progress is not None
            progress(before + share * edge**-3 / whole, f"{1000 * edge:.1f} mm: {label}")

        dressed.append(_dressed(outfit.coarser(edge), _beside(kept, edge), told if progress else None))
    other, *rest = dressed
    layers = []
    for number, layer in enumerate(outfit.layers):
        own = [garments[number] for garments in rest]
        layers.append(
            {
                "name": layer.name,
                "whole": bool(own[0].provenance["whole"]),
                "edges": ordered,
                "triangles": [len(garment.faces) for garment in own],
                "cpu_seconds": [garment.provenance["seconds"]["drape_cpu"] for garment in own],
                "apart": [_apart(a, b) for a, b in zip(own, own[1:], strict=False)],
                "scatter": _apart(other[number], own[0]),
            }
        )
    return {
        "outfit": outfit.name,
        "inputs": study_inputs(outfit),
        "layers": layers,
    }


def forget_study(kept: Path, steps: Sequence[float]) -> None:
    """Removes the garments a study kept to go on from."""
    for edge in (max(steps) * BESIDE, *steps):
        beside = _beside(kept, float(edge))
        forget(beside)
        for file in beside.parent.iterdir():
            if file.name.startswith(f"{beside.name}."):
                file.unlink()


def _beside(kept: Path, edge: float) -> Path:
    return kept.with_name(f"{kept.name}.{1000 * edge:.1f}mm")


def _dressed(outfit: Outfit, place: Path, progress: Any) -> tuple[Garment, ...]:
    """The outfit's garments, of an earlier study of the same inputs where they are all there."""
    files = [place.with_name(f"{place.name}.{layer.name}.npz") for layer in outfit.layers]
    wanted = study_inputs(outfit)
    try:
        found = tuple(Garment.load(file) for file in files)
        if all(garment.provenance.get("study") == wanted for garment in found):
            return found
    except FileProblem:
        pass
    garments = dress(outfit, progress=progress, checkpoint=Checkpoint(place, keep=True))
    garments = tuple(garment.noted(study=wanted) for garment in garments)
    for garment, file in zip(garments, files, strict=True):
        garment.save(file)
    forget(place)
    return garments


def _apart(a: Garment, b: Garment) -> dict[str, float]:
    """Two-sided distance of two drapes [m]."""
    found = metrics.hausdorff(a.positions, a.faces, b.positions, b.faces, spacing=SPACING)
    return {"mean_m": round(found.mean, 6), "p99_m": round(found.p99, 6)}
