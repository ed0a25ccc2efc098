"""Weights as files: safetensors, whose header says what they are of, and a hash that they were not changed since."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.learn.inference.settings import RIVALS, Settings
from sim_core.learn.pooling import Pooled

__all__ = ["RivalTrained", "Trained", "read_weights", "write_weights"]

FORMAT = "1"
OURS = "ours"


@dataclass(frozen=True)
class Trained:
    """weights: float32 by the names of `Settings.shapes`; told: scene, sequences learned from, engine and updates;
    pooled: where it reconstructs, what stays of each kind of sheet, by `Pair.kind`."""

    settings: Settings
    weights: Mapping[str, np.ndarray]
    told: Mapping[str, Any]
    pooled: Mapping[str, Pooled] = field(default_factory=dict)
    row: str = OURS


@dataclass(frozen=True)
class RivalTrained:
    """row: of RIVALS; weights: float32 by torch's names; pooled: what stays of each kind of sheet, by
    `Pair.kind`; told: as of `Trained`."""

    row: str
    weights: Mapping[str, np.ndarray]
    pooled: Mapping[str, Pooled]
    told: Mapping[str, Any]


def write_weights(path: Path, trained: Trained | RivalTrained) -> None:
    """Writes a .safetensors file, whole or not at all."""
    from safetensors.numpy import save

    arrays: dict[str, np.ndarray] = {
        name: np.ascontiguousarray(value, np.float32) for name, value in trained.weights.items()
    }
    head = {"format": FORMAT, "row": trained.row, "told": json.dumps(dict(trained.told))}
    if isinstance(trained, Trained):
        head["settings"] = json.dumps(asdict(trained.settings))
    for name, pooled in trained.pooled.items():
        arrays[f"{name}/kept"] = np.ascontiguousarray(pooled.kept, np.int32)
        arrays[f"{name}/faces"] = np.ascontiguousarray(pooled.faces, np.int32)
    head["shares"] = json.dumps({name: pooled.share for name, pooled in trained.pooled.items()})
    beside = path.with_name(f".{path.name}.part")
    beside.write_bytes(save(arrays, metadata=head | {"sha256": _digest(arrays)}))
    beside.replace(path)


def read_weights(path: Path) -> Trained | RivalTrained:
    """Reads one; raises SimCoreError for a file that is none, is cut short, was changed, or does not fit itself."""
    from safetensors import SafetensorError, safe_open

    try:
        with safe_open(path, framework="numpy") as file:
            head = file.metadata() or {}
            arrays = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 – no mapping
        if head.get("format") != FORMAT:
            raise SimCoreError(
                f"{path}: format {head.get('format')} – this version reads {FORMAT}: train again"
            )
        if _digest(arrays) != head.get("sha256"):
            raise SimCoreError(f"{path}: changed since it was written – fetch or train the weights again")
        row, told = head.get("row", OURS), dict(json.loads(head["told"]))
        if any(not np.isfinite(value).all() for value in arrays.values()):
            raise ValueError("numbers that are not finite")
        pooled = _pooled(arrays, json.loads(head.get("shares", "{}")))
        weights = {name: value for name, value in arrays.items() if value.dtype == np.float32}
        if row == OURS:
            return _ours(weights, Settings(**json.loads(head["settings"])), told, pooled)
        if row not in RIVALS:
            raise ValueError(f"row {row!r}")
        return RivalTrained(row, weights, pooled, told)
    except (OSError, SafetensorError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise SimCoreError(f"{path}: not weights, or damaged ({error}) – fetch or train them again") from None


def _ours(
    weights: Mapping[str, np.ndarray],
    settings: Settings,
    told: Mapping[str, Any],
    pooled: Mapping[str, Pooled],
) -> Trained:
    if {name: value.shape for name, value in weights.items()} != dict(settings.shapes()):
        raise ValueError("arrays that do not fit its own settings")
    return Trained(settings, weights, told, pooled)


def _pooled(arrays: Mapping[str, np.ndarray], shares: Mapping[str, float]) -> dict[str, Pooled]:
    return {
        name: Pooled(arrays[f"{name}/kept"].astype(np.int64), arrays[f"{name}/faces"], float(share))
        for name, share in shares.items()
    }


def _digest(arrays: Mapping[str, np.ndarray]) -> str:
    digest = hashlib.sha256()
    for name in sorted(arrays):
        digest.update(f"{name} {arrays[name].shape} {arrays[name].dtype}\n".encode())
        digest.update(arrays[name].tobytes())
    return digest.hexdigest()
