"""Weave files: TOML in, what makes a `Weave` out, every mistake named by file, key, value and remedy."""

from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sim_core.errors import SimCoreError, WeaveError
from sim_core.validation.files import read_toml, shown
from sim_core.weave.draft.draft import MOST_MOTIF as MOST
from sim_core.weave.draft.draft import Draft, plain, satin, twill
from sim_core.weave.yarn import SILK_DENSITY, SILK_FILAMENT, SILK_MODULUS, Yarn

__all__ = ["read_weave_file"]


Colour = Annotated[str, Field(pattern="^#[0-9a-fA-F]{6}$")]
# A motif written out: one string a row, the top row of the picture first; "." is 0, digits are themselves.
Motif = Annotated[
    list[Annotated[str, Field(pattern=r"^[.0-9]+$", max_length=MOST)]], Field(min_length=1, max_length=MOST)
]


def _motif(rows: list[str]) -> np.ndarray:
    """(picks, ends) int, the lowest row first, as cloth grows upwards."""
    if len({len(row) for row in rows}) != 1:
        raise WeaveError("draft.motif: rows differ in length – give every row the same number of places")
    return np.array([[0 if c == "." else int(c) for c in row] for row in reversed(rows)])


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


class _Damask(_Part):
    """Figure on a ground by a motif; ground and figure as on the command line, such as "satin:8/3"."""

    kind: Literal["damask"]
    motif: Motif
    ground: str = "satin:5/2"
    figure: str | None = None
    longest: int = Field(0, ge=0, le=MOST)

    def draft(self) -> Draft:
        from sim_core.weave.draft.generators import damask
        from sim_core.weave.draft.notation import draft_of_words

        figure = draft_of_words(self.figure) if self.figure else None
        return damask(_motif(self.motif) > 0, draft_of_words(self.ground), figure, longest=self.longest)


class _Leno(_Part):
    kind: Literal["leno"]
    form: Literal["pair", "four-end"] = "pair"

    def draft(self) -> Draft:
        from sim_core.weave.draft.structures import four_end_gauze, gauze

        return gauze() if self.form == "pair" else four_end_gauze()


class _Compound(_Part):
    kind: Literal["compound"]
    motif: Motif
    series: int = Field(ge=2, le=8)
    face: Literal["warp", "weft"] = "warp"

    def draft(self) -> Draft:
        from sim_core.weave.draft.structures import warp_compound, weft_compound

        made = warp_compound if self.face == "warp" else weft_compound
        return made(_motif(self.motif), self.series)


class _Tapestry(_Part):
    kind: Literal["tapestry"]
    motif: Motif

    def draft(self) -> Draft:
        from sim_core.weave.draft.structures import tapestry

        return tapestry(_motif(self.motif))


class _Brocade(_Part):
    kind: Literal["brocade"]
    motif: Motif
    ground: str = "plain"
    every: int = Field(4, ge=2, le=32)

    def draft(self) -> Draft:
        from sim_core.weave.draft.notation import draft_of_words
        from sim_core.weave.draft.structures import brocade

        return brocade(_motif(self.motif) - 1, ground=draft_of_words(self.ground), every=self.every)


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
    colour: Colour = "#ede5d1"
    modulus: float = SILK_MODULUS
    density: float = SILK_DENSITY
    filament: float = SILK_FILAMENT
    tension: float = 0.0
    unevenness: float = 0.0

    def yarn(self) -> Yarn:
        values = self.model_dump()
        return Yarn(**{**values, "colour": _rgb(self.colour)})


def _rgb(text: str) -> tuple[float, float, float]:
    red, green, blue = (int(text[k : k + 2], 16) / 255 for k in (1, 3, 5))
    return red, green, blue


class _Title(_Part):
    zh: str
    en: str


class _WeaveFile(_Part):
    name: str
    title: _Title | None = None
    ends_per_m: float
    picks_per_m: float
    friction: float = 0.3
    source: str | None = None
    draft: Annotated[
        _Plain | _Twill | _Satin | _Damask | _Leno | _Compound | _Tapestry | _Brocade | _Lift,
        Field(discriminator="kind"),
    ]
    warp: _Yarn
    weft: _Yarn
    extra: _Yarn | None = None
    warp_colours: list[Colour] = Field(default=[], max_length=16)
    weft_colours: list[Colour] = Field(default=[], max_length=16)


def read_weave_file(path: Path) -> dict[str, Any]:
    """The keyword arguments of the `Weave` a file describes.

    Raises FileProblem (cannot be read) or WeaveError (file: key: what – remedy).
    """
    values = read_toml(path, "a weave file (TOML), such as those in assets/weaves")
    try:
        return _values(_WeaveFile.model_validate(values))
    except ValidationError as error:
        raise WeaveError(f"{path}: {_first(error)}") from error
    except SimCoreError as error:
        raise WeaveError(f"{path}: {error}") from error


def _values(file: _WeaveFile) -> dict[str, Any]:
    yarns = {}
    for side in ("warp", "weft", "extra"):
        try:
            if getattr(file, side):
                yarns[side] = getattr(file, side).yarn()
        except WeaveError as error:
            raise WeaveError(f"{side}: {error}") from error
    return dict(
        name=file.name,
        draft=file.draft.draft(),
        ends_per_m=file.ends_per_m,
        picks_per_m=file.picks_per_m,
        friction=file.friction,
        warp_colours=tuple(_rgb(c) for c in file.warp_colours),
        weft_colours=tuple(_rgb(c) for c in file.weft_colours),
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
