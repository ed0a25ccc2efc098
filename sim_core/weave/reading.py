"""Weave files: TOML in, `Weave` out, every mistake named by file, key, value and remedy."""

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sim_core.errors import SimCoreError, WeaveError
from sim_core.reading import read_toml, shown
from sim_core.weave.draft import MOST, Draft, plain, satin, twill
from sim_core.weave.model import Weave
from sim_core.weave.yarn import SILK_DENSITY, SILK_FILAMENT, SILK_MODULUS, Yarn

__all__ = ["read_weave"]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, strict=True)


class _Plain(_Part):
    kind: Literal["plain"]

    def draft(self) -> Draft:
        return plain()


class _Twill(_Part):
    kind: Literal["twill"]
    up: int = Field(ge=1, le=MOST)
    down: int = Field(ge=1, le=MOST)
    step: int = Field(1, ge=-MOST, le=MOST)

    def draft(self) -> Draft:
        return twill(self.up, self.down, self.step)


class _Satin(_Part):
    kind: Literal["satin"]
    ends: int = Field(ge=1, le=MOST)
    step: int = Field(ge=-MOST, le=MOST)
    face: Literal["warp", "weft"] = "warp"

    def draft(self) -> Draft:
        made = satin(self.ends, self.step)
        return made if self.face == "warp" else Draft(f"{made.name} (weft face)", ~made.lift.T)


class _Lift(_Part):
    """A draft written out: one string of 0 and 1 a pick, 1 = warp on top."""

    kind: Literal["lift"]
    lift: list[Annotated[str, Field(pattern="^[01]+$", max_length=MOST)]] = Field(
        min_length=1, max_length=MOST
    )

    def draft(self) -> Draft:
        if len({len(row) for row in self.lift}) != 1:
            raise WeaveError("draft.lift: rows differ in length – give every pick the same number of ends")
        return Draft("lift", np.array([[c == "1" for c in row] for row in self.lift]))


class _Yarn(_Part):
    tex: float
    diameter: float
    flattening: float = 1.0
    stiffness: float = 0.0
    colour: Annotated[str, Field(pattern="^#[0-9a-fA-F]{6}$")] = "#ede5d1"
    modulus: float = SILK_MODULUS
    density: float = SILK_DENSITY
    filament: float = SILK_FILAMENT
    tension: float = 0.0
    unevenness: float = 0.0

    def yarn(self) -> Yarn:
        values = self.model_dump()
        red, green, blue = (int(self.colour[k : k + 2], 16) / 255 for k in (1, 3, 5))
        return Yarn(**{**values, "colour": (red, green, blue)})


class _Title(_Part):
    zh: str
    en: str


class _WeaveFile(_Part):
    name: str
    title: _Title | None = None
    ends_per_m: float
    picks_per_m: float
    friction: float = 0.3
    draft: Annotated[_Plain | _Twill | _Satin | _Lift, Field(discriminator="kind")]
    warp: _Yarn
    weft: _Yarn


def read_weave(path: Path) -> Weave:
    """Read a weave file; raises FileProblem (cannot be read) or WeaveError (file: key: what – remedy)."""
    values = read_toml(path, "a weave file (TOML), such as those in assets/weaves")
    try:
        return _weave(_WeaveFile.model_validate(values))
    except ValidationError as error:
        raise WeaveError(f"{path}: {_first(error)}") from error
    except SimCoreError as error:
        raise WeaveError(f"{path}: {error}") from error


def _weave(file: _WeaveFile) -> Weave:
    yarns = {}
    for side in ("warp", "weft"):
        try:
            yarns[side] = getattr(file, side).yarn()
        except WeaveError as error:
            raise WeaveError(f"{side}: {error}") from error
    return Weave(
        name=file.name,
        draft=file.draft.draft(),
        ends_per_m=file.ends_per_m,
        picks_per_m=file.picks_per_m,
        friction=file.friction,
        **yarns,
    )


def _first(error: ValidationError) -> str:
    """One line for the first mistake pydantic found, and how many more there are."""
    found = error.errors(include_url=False, include_context=False)
    first = found[0]
    key = ".".join(str(part) for part in first["loc"]) or "file"
    if first["type"] == "missing":
        text = f"{key}: missing – add it"
    elif first["type"] == "extra_forbidden":
        text = f"{key}: unknown key – check the spelling or remove it"
    else:
        text = f"{key}: {shown(first['input'])}: {first['msg']}"
    return text if len(found) == 1 else f"{text} (and {len(found) - 1} more)"
