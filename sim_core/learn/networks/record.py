"""A record of training, from which it goes on where it was broken off."""

# pyright: reportMissingImports=false
# (torch is an extra)

from __future__ import annotations

import os
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch

from sim_core.errors import SimCoreError

__all__ = ["Record"]

BETWEEN = 60.0  # [s] between two writes


class Record:
    """One file; same: settings, schedule and films, of which another training is refused."""

    def __init__(self, path: Path, same: Mapping[str, Any]) -> None:
        self.path, self.same, self._written = path, dict(same), time.monotonic()

    def write(
        self,
        update: int,
        parts: Mapping[str, Any],
        rng: np.random.Generator,
        more: Any = None,
        *,
        now: bool = False,
    ) -> None:
        """Every minute, or now: so many updates, the state of parts, of the generator, and whatever else there is."""
        if not now and time.monotonic() - self._written < BETWEEN:
            return
        value = {
            "same": self.same,
            "update": update,
            "parts": {name: part.state_dict() for name, part in parts.items()},
            "rng": rng.bit_generator.state,
            "torch": torch.get_rng_state(),
            "more": more,
        }
        beside = self.path.with_name(f".{self.path.name}.part")
        torch.save(value, beside)
        os.replace(beside, self.path)
        self._written = time.monotonic()

    def read(
        self, parts: Mapping[str, Any], rng: np.random.Generator, device: torch.device
    ) -> tuple[int, Any]:
        """The update to go on with and whatever else was written; 0 and None where there is no file.

        Parts and generator are put where they were. Raises SimCoreError for the record of another training, and a
        damaged one.
        """
        if not self.path.is_file():
            return 0, None
        try:
            value = torch.load(self.path, weights_only=False, map_location=device)
            if value["same"] != self.same:
                raise SimCoreError(
                    f"{self.path}: was begun with other settings or data – give another file, or delete it"
                )
            for name, part in parts.items():
                part.load_state_dict(value["parts"][name])
            rng.bit_generator.state = value["rng"]
            torch.set_rng_state(value["torch"].cpu())
            return int(value["update"]), value["more"]
        except SimCoreError:
            raise
        except Exception as error:
            raise SimCoreError(f"{self.path}: damaged ({error}) – delete it and train again") from None
