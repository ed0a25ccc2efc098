"""Weights as files: safetensors, whose header says what they are of, and a hash that they were not changed since."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.learn.inference.settings import Settings

__all__ = ["Trained", "read_weights", "write_weights"]

FORMAT = "1"


@dataclass(frozen=True)
class Trained:
    """weights: float32 by the names of `Settings.shapes`; told: scene, sequences learned from, engine and updates."""

    settings: Settings
    weights: Mapping[str, np.ndarray]
    told: Mapping[str, Any]


def write_weights(path: Path, trained: Trained) -> None:
    """Writes a .safetensors file, whole or not at all."""
    from safetensors.numpy import save

    weights = {name: np.ascontiguousarray(value, np.float32) for name, value in trained.weights.items()}
    head = {
        "format": FORMAT,
        "settings": json.dumps(asdict(trained.settings)),
        "told": json.dumps(dict(trained.told)),
        "sha256": _digest(weights),
    }
    beside = path.with_name(f".{path.name}.part")
    beside.write_bytes(save(weights, metadata=head))
    beside.replace(path)


def read_weights(path: Path) -> Trained:
    """Reads one; raises SimCoreError for a file that is none, is cut short, was changed, or does not fit itself."""
    from safetensors import SafetensorError, safe_open

    try:
        with safe_open(path, framework="numpy") as file:
            head = file.metadata() or {}
            weights = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 – no mapping
        if head.get("format") != FORMAT:
            raise SimCoreError(
                f"{path}: format {head.get('format')} – this version reads {FORMAT}: train again"
            )
        settings = Settings(**json.loads(head["settings"]))
        told = dict(json.loads(head["told"]))
    except (OSError, SafetensorError, ValueError, KeyError, TypeError) as error:
        raise SimCoreError(f"{path}: not weights, or damaged ({error}) – fetch or train them again") from None
    if _digest(weights) != head.get("sha256"):
        raise SimCoreError(f"{path}: changed since it was written – fetch or train the weights again")
    shapes = {name: value.shape for name, value in weights.items()}
    if shapes != dict(settings.shapes()) or any(not np.isfinite(value).all() for value in weights.values()):
        raise SimCoreError(
            f"{path}: arrays that do not fit its own settings – fetch or train the weights again"
        )
    return Trained(settings, weights, told)


def _digest(weights: Mapping[str, np.ndarray]) -> str:
    digest = hashlib.sha256()
    for name in sorted(weights):
        digest.update(f"{name} {weights[name].shape} {weights[name].dtype}\n".encode())
        digest.update(weights[name].tobytes())
    return digest.hexdigest()
