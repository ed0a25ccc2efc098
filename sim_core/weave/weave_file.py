"""Weave files: TOML in, what makes a `Weave` out, every mistake named by file, key, value and remedy."""

from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sim_core.errors import SimCoreError, WeaveError
from sim_core.validation.files import read_toml, shown
from sim_core.weave.draft.draft import MOST_MOTIF as MOST
from sim_core.weave.draft.draft import Draft, plain, satin, twill
from sim_core.weave.draft.figured import Figure, FigureKind
from sim_core.weave.draft.generators import striped
from sim_core.weave.draft.motifs import recipe_of
from sim_core.weave.yarn import SILK_DENSITY, SILK_FILAMENT, SILK_MODULUS, Yarn

__all__ = ["Published", "read_published", "read_weave_file"]


Colour = Annotated[str, Field(pattern="^#[0-9a-fA-F]{6}$")]
# A motif written out: one string a row, the top row of the picture first; "." is 0, digits are themselves.
Rows = Annotated[
    list[Annotated[str, Field(pattern=r"^[.0-9]+$", max_length=MOST)]], Field(min_length=1, max_length=MOST)
]
MotifFile = Annotated[
    str, Field(pattern=r"\.toml$", max_length=200)
]  # its path, from the weave file's folder
Parameters = dict[str, Annotated[float, Field(gt=0)]]  # of the motif's program, other than its file has them


def _motif(rows: list[str]) -> np.ndarray:
    """(picks, ends) int, the lowest row first, as cloth grows upwards."""
    if len({len(row) for row in rows}) != 1:
        raise WeaveError("draft.motif: rows differ in length – give every row the same number of places")
    return np.array([[0 if c == "." else int(c) for c in row] for row in reversed(rows)])


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, strict=True)


class _Motif(_Part):
    """A weave that a motif chooses in: rows written out, or a motif file and what is changed in it."""

    motif: Rows | MotifFile
    parameters: Parameters = {}

    def figure(self, folder: Path, kind: FigureKind, **rest: Any) -> Figure | None:
        """The figure of a motif file; None where rows are written out."""
        if isinstance(self.motif, str):
            return Figure.of(kind, recipe_of(folder / self.motif, self.parameters), **rest)
        if self.parameters:
            raise WeaveError("draft.parameters: of a motif file – the rows of draft.motif have none")
        return None

    def rows(self) -> np.ndarray:
        """The rows written out, (picks, ends) int."""
        assert not isinstance(self.motif, str)
        return _motif(self.motif)


# How many ends or picks, and their colour: a place in warp_colours or weft_colours.
Stripe = Annotated[list[Annotated[int, Field(ge=0, le=MOST)]], Field(min_length=2, max_length=2)]
Stripes = Annotated[list[Stripe], Field(max_length=256)]


class _Striped(_Part):
    """A weave whose ends and picks may change their colour."""

    warp_stripes: Stripes = []
    weft_stripes: Stripes = []

    def striped(self, draft: Draft) -> Draft:
        """The draft with its yarns in their colours."""
        return striped(draft, self.warp_stripes, self.weft_stripes)


class _Plain(_Striped):
    kind: Literal["plain"]

    def draft(self, folder: Path) -> Draft | Figure:
        return self.striped(plain())


class _Twill(_Striped):
    kind: Literal["twill"]
    up: int = Field(ge=1, le=MOST)
    down: int = Field(ge=1, le=MOST)
    step: int = Field(1, ge=-MOST, le=MOST)

    def draft(self, folder: Path) -> Draft | Figure:
        return self.striped(twill(self.up, self.down, self.step))


class _Satin(_Striped):
    kind: Literal["satin"]
    ends: int = Field(ge=1, le=MOST)
    step: int = Field(ge=-MOST, le=MOST)
    face: Literal["warp", "weft"] = "warp"

    def draft(self, folder: Path) -> Draft | Figure:
        made = satin(self.ends, self.step)
        return self.striped(made if self.face == "warp" else Draft(f"{made.name} (weft face)", ~made.lift.T))


class _Damask(_Motif):
    """Figure on a ground by a motif; ground and figure as on the command line, such as "satin:8/3"."""

    kind: Literal["damask"]
    ground: str = "satin:5/2"
    figured: str | list[str] | None = Field(None, alias="figure")
    longest: int = Field(0, ge=0, le=MOST)

    def draft(self, folder: Path) -> Draft | Figure:
        from sim_core.weave.draft.generators import check_limit, damask
        from sim_core.weave.draft.notation import draft_of_words

        named = [self.figured] if isinstance(self.figured, str) else self.figured or []
        if isinstance(self.motif, str) and not named:
            raise WeaveError('draft.figure: missing – name the weave of the figure, such as "satin:5/2:weft"')
        check_limit("draft.longest", self.longest, [draft_of_words(words) for words in (self.ground, *named)])
        made = self.figure(folder, "damask", words=(self.ground, *named), longest=self.longest)
        if made:
            return made
        if len(named) > 1:
            raise WeaveError("draft.figure: several weaves – rows written out have one; take a motif file")
        figure = draft_of_words(named[0]) if named else None
        return damask(self.rows() > 0, draft_of_words(self.ground), figure, longest=self.longest)


class _Leno(_Part):
    kind: Literal["leno"]
    form: Literal["pair", "four-end", "figured"] = "pair"
    motif: MotifFile | None = None
    parameters: Parameters = {}

    def draft(self, folder: Path) -> Draft | Figure:
        if (self.form == "figured") != (self.motif is not None):
            raise WeaveError('draft.form: "figured" has a motif, and no other form – give both, or none')
        if self.motif:
            return Figure.of("leno", recipe_of(folder / self.motif, self.parameters))
        from sim_core.weave.draft.structures import four_end_gauze, gauze

        return gauze() if self.form == "pair" else four_end_gauze()


class _Compound(_Motif):
    kind: Literal["compound"]
    series: int = Field(ge=2, le=8)
    face: Literal["warp", "weft"] = "warp"

    def draft(self, folder: Path) -> Draft | Figure:
        from sim_core.weave.draft.structures import warp_compound, weft_compound

        kind: FigureKind = "warp-compound" if self.face == "warp" else "weft-compound"
        figure = self.figure(folder, kind, series=self.series)
        if figure:
            return figure
        made = warp_compound if self.face == "warp" else weft_compound
        return made(self.rows(), self.series)


class _Tapestry(_Motif):
    kind: Literal["tapestry"]

    def draft(self, folder: Path) -> Draft | Figure:
        from sim_core.weave.draft.structures import tapestry

        return self.figure(folder, "tapestry") or tapestry(self.rows())


class _Brocade(_Motif):
    kind: Literal["brocade"]
    ground: str = "plain"
    every: int = Field(4, ge=2, le=32)

    def draft(self, folder: Path) -> Draft | Figure:
        from sim_core.weave.draft.notation import draft_of_words
        from sim_core.weave.draft.structures import brocade

        figure = self.figure(folder, "brocade", words=(self.ground,), every=self.every)
        if figure:
            return figure
        return brocade(self.rows() - 1, ground=draft_of_words(self.ground), every=self.every)


class _Lift(_Striped):
    """A draft written out: one string of 0 and 1 a pick, 1 = warp on top."""

    kind: Literal["lift"]
    lift: list[Annotated[str, Field(pattern="^[01]+$", max_length=MOST)]] = Field(
        min_length=1, max_length=MOST
    )

    def draft(self, folder: Path) -> Draft | Figure:
        if len({len(row) for row in self.lift}) != 1:
            raise WeaveError("draft.lift: rows differ in length – give every pick the same number of ends")
        return self.striped(Draft("lift", np.array([[c == "1" for c in row] for row in self.lift])))


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
    twist: float = 0.0

    def yarn(self) -> Yarn:
        values = self.model_dump()
        return Yarn(**{**values, "colour": _rgb(self.colour)})


def _rgb(text: str) -> tuple[float, float, float]:
    red, green, blue = (int(text[k : k + 2], 16) / 255 for k in (1, 3, 5))
    return red, green, blue


class _Title(_Part):
    zh: str
    en: str


_Above0 = Annotated[float, Field(gt=0)]
_Told = _Above0 | Annotated[list[_Above0], Field(min_length=2, max_length=2)] | None


class Published(_Part):
    """What a source tells of a cloth of this kind: a number or the least and the most; None: nothing.

    areal_density [kg/m2], openness, thickness [m], bending: B [N m], shear: G [N/m per rad], tensile: EMT.
    """

    source: str
    areal_density: _Told = None
    openness: _Told = None
    thickness: _Told = None
    bending: _Told = None
    shear: _Told = None
    tensile: _Told = None

    def values(self) -> dict[str, float | list[float] | None]:
        """All but the source."""
        return self.model_dump(exclude={"source"})


class _WeaveFile(_Part):
    name: str
    title: _Title | None = None
    ends_per_m: float
    picks_per_m: float
    friction: float = 0.3
    source: str | None = None
    published: Published | None = None
    sheer: bool | None = None  # False: an opaque cloth, whose yarns have to touch
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
    file = _checked(path)
    try:
        return _values(file, path.parent)
    except SimCoreError as error:
        raise WeaveError(f"{path}: {error}") from error


def read_published(path: Path) -> Published | None:
    """What a weave file says that others measured on such a cloth; None where it says nothing.

    Raises as `read_weave_file` does.
    """
    return _checked(path).published


def _checked(path: Path) -> _WeaveFile:
    values = read_toml(path, "a weave file (TOML), such as those in assets/weaves")
    try:
        return _WeaveFile.model_validate(values)
    except ValidationError as error:
        raise WeaveError(f"{path}: {_first(error)}") from error


def _values(file: _WeaveFile, folder: Path) -> dict[str, Any]:
    _check_stripes(file)
    yarns, made = {}, file.draft.draft(folder)
    figure, draft = (made, None) if isinstance(made, Figure) else (None, made)
    if figure is not None:
        draft = figure.draft(figure.numbers(file.ends_per_m, file.picks_per_m), file.name)
    for side in ("warp", "weft", "extra"):
        try:
            if getattr(file, side):
                yarns[side] = getattr(file, side).yarn()
        except WeaveError as error:
            raise WeaveError(f"{side}: {error}") from error
    return dict(
        name=file.name,
        draft=draft,
        figure=figure,
        sheer=file.sheer,
        ends_per_m=file.ends_per_m,
        picks_per_m=file.picks_per_m,
        friction=file.friction,
        warp_colours=tuple(_rgb(c) for c in file.warp_colours),
        weft_colours=tuple(_rgb(c) for c in file.weft_colours),
        **yarns,
    )


def _check_stripes(file: _WeaveFile) -> None:
    for side in ("warp", "weft"):
        stripes, colours = getattr(file.draft, f"{side}_stripes", []), getattr(file, f"{side}_colours")
        if any(count < 1 for count, _ in stripes):
            raise WeaveError(
                f"draft.{side}_stripes: a stripe of no yarns – give [how many, colour], at least one"
            )
        if any(colour >= len(colours) for _, colour in stripes):
            raise WeaveError(
                f"draft.{side}_stripes: a colour that is not there – {side}_colours has {len(colours)}, counted from 0"
            )


REMEDIES = {
    "finite_number": "write an ordinary number, neither nan nor inf",
    "float_type": "write a number, without quotation marks",
    "greater_than": "write a number above 0",
}


def _first(error: ValidationError) -> str:
    """One line for the first mistake pydantic found; a key that may be several things is told as one mistake."""
    first = error.errors(include_url=False, include_context=False)[0]
    parts = [str(part) for part in first["loc"]]
    key = (
        ".".join(part for part in parts if "[" not in part and part not in ("float", "constrained-float"))
        or "file"
    )
    given = shown(first["input"])
    if first["type"] == "missing":
        return f"{key}: missing – add it"
    if first["type"] == "extra_forbidden":
        return f"{key}: unknown key – check the spelling or remove it"
    if "colour" in parts[-1] or "_colours" in key:
        return f'{key}: {given} is no colour – write six hexadecimal digits, such as "#e6d3b3"'
    if parts[0] == "draft" and "motif" in parts:
        return f'{key}: {given} is no motif – name a file that ends in .toml, or write rows of "." and digits'
    if parts[0] == "published" and first["type"] != "finite_number":
        return f"{key}: {given} is no value of a source – write a number above 0, or [least, most]"
    return f"{key}: {given}: {first['msg']} – {REMEDIES.get(first['type'], 'correct the value (see assets/weaves)')}"
