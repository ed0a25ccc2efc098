"""Drafts by name: `plain`, `twill:2/1`, `satin:8/3`, with :S and :weft; by a picture of a motif."""

from __future__ import annotations

import re
from math import gcd
from pathlib import Path

import numpy as np

from sim_core.errors import FileProblem, WeaveError
from sim_core.weave.draft.draft import MOST_MOTIF, Draft, plain, satin, twill

__all__ = ["PICTURES", "draft_of_words", "motif_of", "satin_by_pick"]

WORDS = "plain, twill:2/1, satin:8/3 (suffixes :S, :weft), a .wif, .dtx, .json or .toml file, or a picture of a motif"
EXAMPLES = {"twill": "2/1", "satin": "8/3"}
PICTURES = {".png", ".jpg", ".jpeg", ".bmp", ".gif", ".webp"}


def draft_of_words(words: str) -> Draft:
    """A draft by name; `twill:2/1` is Z, `satin:8/3` has the one weft point of pick i on end 3 i mod 8."""
    name, *rest = words.strip().split(":")
    numbers = rest.pop(0) if name in ("twill", "satin") and rest else ""
    if name not in ("plain", "twill", "satin") or any(
        word not in ("S", "Z", "weft", "warp") for word in rest
    ):
        raise WeaveError(f"{words[:60]!r}: no such weave – give {WORDS}")
    if {"S", "Z"} <= set(rest) or {"warp", "weft"} <= set(rest):
        raise WeaveError(
            f"{words[:60]!r}: suffixes that contradict each other – give one of :S and :Z, of :weft and :warp"
        )
    if name == "plain":
        draft = plain()
    else:
        found = re.fullmatch(r"(\d{1,4})/(\d{1,4})", numbers, re.ASCII)
        if not found:
            what = "two whole numbers of 1 to 4 digits are meant" if numbers else "numbers are missing"
            raise WeaveError(f"{words[:60]!r}: {what} – give {name}:{EXAMPLES[name]}")
        first, second = int(found[1]), int(found[2])
        draft = twill(first, second) if name == "twill" else satin_by_pick(first, second)
    if "weft" in rest and draft.face != "warp":
        raise WeaveError(f"{words[:60]!r}: it is no warp-faced weave – leave :weft out")
    lift = ~draft.lift if "weft" in rest else draft.lift
    if "S" in rest:
        lift = np.roll(lift[:, ::-1], 1, axis=1)  # mirrored about end 0
    return Draft(words.strip(), lift)


def satin_by_pick(ends: int, step: int) -> Draft:
    """The warp-faced satin whose one weft point of pick i lies on end step x i mod ends."""
    if ends >= 5 and 1 < step < ends - 1 and gcd(ends, step) == 1:
        return satin(ends, pow(step, -1, ends)).renamed(f"satin {ends}/{step}")
    return satin(ends, step)  # says what is wrong


def _grey(picture) -> np.ndarray:
    """(rows, columns) brightness; what is transparent counts as white paper, 16 bits keep their range."""
    from PIL import Image

    if picture.mode.startswith(("I", "F")):
        return np.asarray(picture)
    if picture.mode in ("LA", "La", "PA", "RGBA", "RGBa") or "transparency" in picture.info:
        drawn = picture.convert("RGBA")
        picture = Image.alpha_composite(Image.new("RGBA", drawn.size, "white"), drawn)
    return np.asarray(picture.convert("L"))


def motif_of(path: Path) -> np.ndarray:
    """(picks, ends) bool, dark where the figure is; one pixel a crossing, the lowest row the first pick."""
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as picture:
            if max(picture.size) > MOST_MOTIF:
                raise WeaveError(
                    f"{path}: {picture.size[0]} x {picture.size[1]} pixels – a crossing a pixel, at most {MOST_MOTIF}"
                )
            grey = _grey(picture)
    except (OSError, UnidentifiedImageError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        if isinstance(error, WeaveError):
            raise
        reason = getattr(error, "strerror", None) or "not a picture"
        raise FileProblem(f"{path}: {reason} – give a picture of the motif, one pixel a crossing") from error
    dark = grey < (float(grey.min()) + float(grey.max()) + 1) / 2
    if dark.all() or not dark.any():
        raise WeaveError(f"{path}: one tone only – paint the figure dark on a light ground")
    return dark[::-1]
