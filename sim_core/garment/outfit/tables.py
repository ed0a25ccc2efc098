"""The tables of an outfit file and of the default programs, checked key by key."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StrictBool, field_validator

from sim_core.garment.outfit.steps import GRAVITY, Do
from sim_core.garment.pattern.tables import Dye, Measure, SpotTable

__all__ = ["LayerTable", "OutfitTable", "ProgramTable", "StandTable", "StepTable"]


STRICT = Field(strict=True)  # neither true nor "1"


def within(low: float, high: float, unit: str = "") -> AfterValidator:
    """Refuses a number beyond its bounds, saying them and their unit."""

    def check(value: float) -> float:
        if not low <= value <= high:  # what is not a number is not within either
            raise ValueError(f"give {low:.10g} to {high:.10g}{unit and f' {unit}'}")
        return value

    return AfterValidator(check)


Near = Annotated[float, STRICT, within(0.0, 0.1, "m")]
Width = Annotated[float, STRICT, within(0.01, 5.0, "m")]
Friction = Annotated[float, STRICT, within(0.0, 5.0)]
Share = Annotated[float, STRICT, within(0.0, 1.0)]
Offset = Annotated[float, STRICT, within(-2.0, 2.0, "m")]
Folds = Annotated[float, STRICT, within(0.5, 100.0, "folds")]
Acceleration = Annotated[float, STRICT, within(0.0, 50.0, "m/s2")]
Seconds = Annotated[float, STRICT, within(0.0, 600.0, "s")]
Damping = Annotated[float, STRICT, within(0.0, 10_000.0, "1/s")]
Speed = Annotated[float, STRICT, within(0.01, 100.0, "m/s")]
Still = Annotated[float, STRICT, within(1e-7, 0.1, "m a frame")]
Untangle = Annotated[int, STRICT, within(0, 1000)]
Sheet = Annotated[float, STRICT, within(0.1, 0.5, "m")]
Room = Annotated[float, STRICT, within(0.005, 0.3, "m")]
Distance = Annotated[float, STRICT, within(-5.0, 5.0, "m")]
Rise = Annotated[float, STRICT, within(-1.0, 1.0, "m")]
Angle = Annotated[float, STRICT, within(-360.0, 360.0, "degrees")]
Gap = Annotated[float, STRICT, within(0.002, 0.1, "m")]
Edge = Annotated[float, STRICT, within(0.002, 0.2, "m")]
Seed = Annotated[int, STRICT, within(0, 2**32 - 1)]
Every = Annotated[int, STRICT, within(1, 16)]
Bending = Annotated[float, STRICT, within(0.1, 20.0, "edges")]
Height = Annotated[float, STRICT, within(0.5, 3.0, "m")]
Span = Annotated[float, STRICT, within(0.2, 5.0, "m")]
Radius = Annotated[float, STRICT, within(0.005, 0.04, "m")]
Words = dict[Literal["zh", "en"], str]


class Table(BaseModel):
    model_config = ConfigDict(extra="forbid")


class TouchTable(Table):
    clearance: Near | None = Field(None, description="[m] vertices keep from what lies beneath")
    sample_clearance: Near | None = Field(None, description="[m] the same of midpoints")
    thickness: Near | None = Field(None, description="[m] layers keep from each other")
    self_friction: Friction | None = Field(None, description="of cloth on cloth")
    separation: Share | None = Field(None, description="share of parting speed near layers lose")
    partly: StrictBool | None = Field(None, description="whether tangles are shortened that do not come free")
    untangle: Untangle | None = Field(
        None, description="steps a frame in which tangles are taken apart; 0: left alone"
    )


PoseTable = str | dict[str, Any]


class StepTable(Table):
    do: Do = Field(description="sew, weld, pin, release, close, pose, settle or rest")
    seconds: Seconds = Field(0.0, description="how long")
    gravity: tuple[Acceleration, Acceleration] = Field(
        (GRAVITY, GRAVITY), description="[m/s2] at its begin and end"
    )
    damping: Damping | None = Field(None, description="of the cloth [1/s]; hanging cloth: 2 to 10")
    friction: Friction | None = Field(None, description="on what lies beneath; else the weave's")
    speed: Speed | None = Field(None, description="[m/s] that no vertex passes")
    still: Still | None = Field(None, description="[m] a frame (p99) at which a settle or rest ends early")
    at: list[Literal["nape", "top"] | SpotTable] = Field(
        [], description="what is pinned: nape, top or places"
    )
    ties: list[str] = Field([], description="which ties are closed; none named: all")
    pose: PoseTable | None = Field(None, description="pose to go to; else the outfit's")
    touch: TouchTable = Field(TouchTable.model_construct(), description="how it touches from here on")
    label: str = Field("", max_length=40, description="what the progress says")


class ContactTable(Table):
    clearance: Near
    sample_clearance: Near
    thickness: Near
    speed_limit: Speed
    self_friction: Friction = 0.2
    separation: Share = 0.05
    every: Every = 1
    partly: StrictBool = False


class ProgramTable(Table):
    sag: Share
    fold: Bending
    limit: tuple[Share, Share]
    even: StrictBool = True
    contact: ContactTable
    start: str = "t"
    step: list[StepTable] = Field(min_length=1, max_length=200)


class FlatTable(Table):
    way: Literal["flat"]
    over: Literal["left", "right"] = Field(
        "left", description="the outer front where fronts overlap (右衽: left)"
    )
    lift: Near = Field(0.012, description="[m] by which it is held off the other")
    front: Sheet = Field(0.17, description="[m] of the front sheet before the middle")
    back: Sheet = Field(0.15, description="[m] of the back sheet behind it")


class OverBarTable(Table):
    way: Literal["over_bar"]
    front: Width = Field(1.27, description="[m] of cloth in front of the bar")
    at_bar: Width = Field(0.14, description="[m] gathered width at the bar")
    at_end: Width = Field(0.25, description="[m] gathered width at the ends")
    folds: Folds = Field(5.0, description="waves across the width")


class KnotTable(Table):
    near: list[str] = Field(min_length=1, max_length=4, description="landmarks of the wearer, their mean")
    by: tuple[Offset, Offset, Offset] = Field((0.0, 0.0, 0.0), description="[m] from there")
    room: Room = Field(0.05, description="[m] the cloth's middle keeps from the body")


class AlongPathTable(Table):
    way: Literal["along_path"]
    knot: list[KnotTable] = Field(min_length=3, max_length=50)
    along: tuple[str, str] | None = Field(
        None, description="landmarks whose direction it lies along at the top"
    )
    stations: list[tuple[Distance, Width]] = Field(
        [], max_length=100, description="[m] from the path's highest point, [m] of width"
    )
    begin: Width = Field(0.22, description="[m] width at the strip's middle")
    end: Width = Field(0.24, description="[m] width at its end")
    waves: Folds = Field(5.0, description="folds across the width")

    @field_validator("along")
    @classmethod
    def _two(cls, along: tuple[str, str] | None) -> tuple[str, str] | None:
        if along is not None and along[0] == along[1]:
            raise ValueError("one landmark has no direction – name two")
        return along

    @field_validator("stations")
    @classmethod
    def _in_order(cls, stations: list[tuple[float, float]]) -> list[tuple[float, float]]:
        if any(b[0] <= a[0] for a, b in pairwise(stations)):
            raise ValueError("distances must grow from one station to the next – sort them")
        return stations


class WrappedTable(Table):
    way: Literal["wrapped"]
    mark: str = Field("waist", description="landmark of the wearer at whose height the top lies")
    rise: Rise = Field(0.0, description="[m] of the top above it")
    begin: Angle = Field(
        180.0, description="[deg] about +y where the first edge lies; 0 the front, 90 the left"
    )
    gap: Gap = Field(0.006, description="[m] between layers of the wrap")


class FoldedTable(Table):
    way: Literal["folded"]
    front: Width = Field(description="[m] of cloth in front of the bar")


Place = Annotated[
    FlatTable | OverBarTable | AlongPathTable | WrappedTable | FoldedTable, Field(discriminator="way")
]


class LayerTable(Table):
    name: str | None = Field(None, min_length=1, max_length=80, description="else the pattern's")
    pattern: str = Field(min_length=1, description="pattern file, e.g. patterns/robe.toml")
    weave: str = Field(min_length=1, description="weave file, e.g. weaves/juan.toml")
    weaves: dict[str, str] = Field({}, description="weave files of single panels")
    dye: Dye | None = Field(None, description="colour, else the pattern's")
    dyes: dict[str, Dye] = Field({}, description="colours of single panels")
    measures: dict[str, Measure] = Field({}, description="measures of the pattern to be changed [mm]")
    edge: Edge | None = Field(None, description="mesh step [m], else the pattern's")
    seed: Seed = Field(0, description="of the folds' irregularity")
    place: Place | None = Field(None, description="how it lies before it is dressed; flat when left out")
    step: list[StepTable] = Field(
        [], max_length=200, description="dressing steps; else those of its way of placing"
    )


class StandTable(Table):
    height: Height = Field(1.5, description="of the bar [m]")
    span: Span = Field(0.70, description="between the posts [m]")
    bar_radius: Radius = Field(0.017, description="[m]")


class OutfitTable(Table):
    name: str | None = Field(None, min_length=1, max_length=80)
    title: Words = {}
    wearer: str | None = Field(None, description="figure file, e.g. mannequins/woman.npz")
    stand: StandTable | None = None
    pose: PoseTable | None = Field(None, description="name of a pose, or { name, joints, shift }")
    layer: list[LayerTable] = Field(min_length=1, max_length=20)
