"""Types of command-line arguments: what is out of range is refused before any work begins, with exit status 2."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

__all__ = ["ending", "number", "whole"]

Kind = TypeVar("Kind", int, float)


def number(least: float, most: float, unit: str = "") -> Callable[[str], float]:
    """A finite number from `least` to `most`; unit: such as " m", for the message."""

    def read(text: str) -> float:
        value = _read(float, text, "a number")
        if not (math.isfinite(value) and least <= value <= most):
            raise argparse.ArgumentTypeError(f"{text} – give {least:g} to {most:g}{unit}")
        return value

    return read


def whole(least: int, most: int) -> Callable[[str], int]:
    """A whole number from `least` to `most`."""

    def read(text: str) -> int:
        value = _read(int, text, "a whole number")
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(f"{text[:40]} – give {least} to {most}")
        return value

    return read


def ending(*endings: str) -> Callable[[str], Path]:
    """A path whose name ends as one of `endings`, such as ".png"."""

    def read(text: str) -> Path:
        path = Path(text)
        if path.suffix.lower() not in endings:
            raise argparse.ArgumentTypeError(f"{text!r} – end the name with {' or '.join(endings)}")
        return path

    return read


def _read(kind: type[Kind], text: str, what: str) -> Kind:
    try:
        return kind(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is not {what}") from error
