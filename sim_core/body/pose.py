"""How a figure holds its arms."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Pose"]


@dataclass(frozen=True)
class Pose:
    """Arms of a figure: degrees below horizontal, and elbows bent forward."""

    arm: float = 0.0
    elbow: float = 0.0
