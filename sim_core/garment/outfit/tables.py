"""The tables of an outfit file and of the default programs, checked key by key."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from sim_core.garment.outfit.outfit import FILE_NAME
from sim_core.garment.outfit.steps import GRAVITY, Do
from sim_core.garment.pattern.tables import Measure, SpotTable

__all__ = ["LayerTable", "OutfitTable", "ProgramTable", "StandTable", "StepTable"]


def _names_a_file(name: str) -> str:
    if not FILE_NAME.fullmatch(name):
        raise ValueError("names a file, too – use letters, digits, _, - and inner spaces, 80 at most")
    return name


Name = Annotated[str, AfterValidator(_names_a_file)]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Length = Annotated[float, Field(strict=True, gt=0, le=20, allow_inf_nan=False)]
Share = Annotated[float, Field(strict=True, gt=0, le=1, allow_inf_nan=False)]
Way = Annotated[float, Field(strict=True, ge=-20, le=20, allow_inf_nan=False)]  # [m]
Corner = tuple[
    Annotated[float, Field(strict=True, ge=-20_000, le=20_000, allow_inf_nan=False)],
    Annotated[float, Field(strict=True, ge=-20_000, le=20_000, allow_inf_nan=False)],
]  # [mm]
Vector = tuple[Way, Way, Way]
Words = dict[Literal["zh", "en"], str]
Colour = Annotated[str, Field(pattern=r"^#[0-9a-fA-F]{6}$")]
Fall = Annotated[float, Field(strict=True, ge=-100, le=100, allow_inf_nan=False)]  # [m/s2]


class Table(BaseModel):
    model_config = ConfigDict(extra="forbid")


class TouchTable(Table):
    clearance: Number | None = Field(
        None, ge=0, le=0.1, description="[m] vertices keep from what lies beneath"
    )
    sample_clearance: Number | None = Field(None, ge=0, le=0.1, description="[m] the same of midpoints")
    thickness: Number | None = Field(None, ge=0, le=0.1, description="[m] layers keep from each other")
    self_friction: Number | None = Field(None, ge=0, le=5, description="of cloth on cloth")
    separation: Number | None = Field(None, ge=0, le=1, description="share of parting speed near layers lose")
    partly: bool | None = Field(None, description="whether tangles are shortened that do not come free")
    untangle: int | None = Field(
        None, ge=0, le=1000, description="steps a frame in which tangles are taken apart; 0: left alone"
    )


PoseTable = str | dict[str, Any]


class BeltTable(Table):
    length: Length = Field(description="[m] it is drawn to")
    mark: str = Field("waist", description="landmark of the wearer at whose height it goes round")
    rise: Number = Field(0.0, ge=-1, le=1, description="[m] above it")


class StepTable(Table):
    do: Do = Field(description="sew, weld, pin, release, close, pose, settle or rest")
    seconds: Number = Field(0.0, ge=0, le=600, description="how long")
    gravity: tuple[Fall, Fall] = Field((GRAVITY, GRAVITY), description="[m/s2] at its begin and end")
    damping: Number | None = Field(
        None, ge=0, le=1000, description="of the cloth [1/s]; hanging cloth: 2 to 10"
    )
    friction: Number | None = Field(None, ge=0, le=5, description="on what lies beneath; else the weave's")
    speed: Number | None = Field(None, gt=0, le=100, description="[m/s] that no vertex passes")
    still: Number | None = Field(
        None, gt=0, le=1, description="[m] a frame (p99) at which the step ends early"
    )
    at: list[Literal["nape", "top", "middle", "belt"] | SpotTable] = Field(
        [], description="what is pinned: nape, top, its middle, what lies under a belt, or places"
    )
    ties: list[str] = Field([], description="which ties are closed; none named: all")
    belt: BeltTable | None = Field(None, description="a belt that is drawn to its length")
    pose: PoseTable | None = Field(None, description="pose to go to; else the outfit's")
    touch: TouchTable = Field(TouchTable.model_construct(), description="how it touches from here on")
    label: str = Field("", max_length=40, description="what the progress says")


class ContactTable(Table):
    clearance: Length
    sample_clearance: Length
    thickness: Number = Field(ge=0, le=0.1)
    speed_limit: Length
    self_friction: Number = Field(0.2, ge=0, le=5)
    separation: Number = Field(0.05, ge=0, le=1)
    every: int = Field(1, ge=1, le=16)
    partly: bool = False


class ProgramTable(Table):
    sag: Share
    fold: Length
    limit: tuple[Share, Share]
    even: bool = True
    contact: ContactTable
    start: str = "t"
    step: list[StepTable] = Field(min_length=1, max_length=200)


class FlatTable(Table):
    way: Literal["flat"]
    over: Literal["left", "right"] = Field(
        "left", description="the outer front where fronts overlap (右衽: left)"
    )
    lift: Number = Field(0.012, gt=0, le=0.1, description="[m] by which it is held off the other")
    front: Number = Field(0.17, gt=0, le=1, description="[m] of the front sheet before the middle")
    back: Number = Field(0.15, gt=0, le=1, description="[m] of the back sheet behind it")


class OverBarTable(Table):
    way: Literal["over_bar"]
    front: Length = Field(1.27, description="[m] of cloth in front of the bar")
    at_bar: Length = Field(0.14, description="[m] gathered width at the bar")
    at_end: Length = Field(0.25, description="[m] gathered width at the ends")
    folds: Number = Field(5.0, gt=0, le=100, description="waves across the width")


class KnotTable(Table):
    near: list[str] = Field(min_length=1, max_length=4, description="landmarks of the wearer, their mean")
    by: Vector = Field((0.0, 0.0, 0.0), description="[m] from there")
    room: Length = Field(0.05, description="[m] the cloth's middle keeps from the body")


class AlongPathTable(Table):
    way: Literal["along_path"]
    knot: list[KnotTable] = Field(min_length=3, max_length=50)
    along: tuple[str, str] | None = Field(
        None, description="landmarks whose direction it lies along at the top"
    )
    stations: list[tuple[Way, Length]] = Field(
        [], description="[m] from the path's highest point, [m] of width"
    )
    begin: Length = Field(0.22, description="[m] width at the strip's middle")
    end: Length = Field(0.24, description="[m] width at its end")
    waves: Number = Field(5.0, gt=0, le=100, description="folds across the width")


class WrappedTable(Table):
    way: Literal["wrapped"]
    mark: str = Field("waist", description="landmark of the wearer at whose height the top lies")
    rise: Number = Field(0.0, ge=-1, le=1, description="[m] of the top above it")
    begin: Number = Field(
        180.0,
        ge=-360,
        le=360,
        description="[deg] about +y where the first edge lies; 0 the front, 90 the left",
    )
    gap: Number = Field(0.006, gt=0, le=0.2, description="[m] between layers of the wrap")


class UprightTable(Table):
    way: Literal["upright"]
    mark: str = Field("waist", description="landmark of the wearer at whose height the top lies")
    rise: Number = Field(0.0, ge=-1, le=1, description="[m] of the top above it")
    front: Number = Field(0.17, gt=0, le=1, description="[m] of the front sheet before the middle")
    back: Number = Field(0.13, gt=0, le=1, description="[m] of the back sheet behind it")


class FoldedTable(Table):
    way: Literal["folded"]
    front: Length = Field(description="[m] of cloth in front of the bar")
    at: Number = Field(
        0.0, ge=-5, le=5, description="[m] of its middle along the bar, from the bar's to the visitor's right"
    )


Place = Annotated[
    FlatTable | OverBarTable | AlongPathTable | WrappedTable | FoldedTable | UprightTable,
    Field(discriminator="way"),
]


class LayerTable(Table):
    name: Name | None = Field(None, description="else the pattern's; part of a file's name")
    pattern: str = Field(min_length=1, description="pattern file, e.g. patterns/robe.toml")
    weave: str = Field(min_length=1, description="weave file, e.g. weaves/juan.toml")
    weaves: dict[str, str] = Field({}, description="weave files of single panels")
    dye: Colour | None = Field(None, description="colour, else the pattern's; a weave of several keeps them")
    dyes: dict[str, Colour] = Field({}, description="colours of single panels")
    origin: Corner = Field(
        (0.0, 0.0), description="where a corner of the weave's repeat lies in the pattern's axes [mm]"
    )
    origins: dict[str, Corner] = Field({}, description="the same of single panels")
    measures: dict[str, Measure] = Field({}, description="measures of the pattern to be changed [mm]")
    edge: Number | None = Field(None, ge=0.002, le=0.2, description="mesh step [m], else the pattern's")
    fold: Number | None = Field(
        None, gt=0, le=5, description="bending length it has at least, in mesh edges: lined cloth folds wider"
    )
    closing: Number = Field(
        0.0, ge=0, le=0.03, description="[m] gaps beneath are filled that no ball of that radius enters"
    )
    seed: int = Field(0, strict=True, ge=0, le=2**32 - 1, description="of the folds' irregularity")
    accessory: bool | None = Field(
        None,
        strict=True,
        description="whether it goes with the garment beneath, which is what one comes to see; left out: where it is "
        "of less than 0.25 m2 of cloth",
    )
    place: Place | None = Field(None, description="how it lies before it is dressed; flat when left out")
    start: PoseTable | None = Field(
        None,
        description="pose its wearer begins in, of wrapped, upright and along_path; left out: the outfit's",
    )
    step: list[StepTable] = Field(
        [], max_length=200, description="dressing steps; else those of its way of placing"
    )
    then: list[StepTable] = Field([], max_length=200, description="dressing steps that follow on those")


class StandTable(Table):
    kind: Literal["rack", "t_bar"] = Field(
        "rack", description="two posts with a bar, or a bar through sleeves"
    )
    height: Number = Field(1.5, gt=0, le=5, description="of the bar [m]")
    span: Number | None = Field(
        None, gt=0, le=10, description="between the posts, or of a T-bar from end to end [m]"
    )
    bar_radius: Number | None = Field(None, ge=0.002, le=0.08, description="[m]")


class PetticoatTable(Table):
    dye: Colour = Field("#d8cbb2", description="its colour")
    girth: Length = Field(1.5, description="round its hem [m]")
    hem: Length = Field(0.16, description="of it above the floor [m]")


class CoverTable(Table):
    bodice: Colour | None = Field(
        None, description="colour of one (抹胸) from the breast to the hips; left out: none"
    )
    trousers: Colour | None = Field(None, description="colour of trousers (裤) to the ankles; left out: none")
    petticoat: PetticoatTable | None = Field(
        None,
        description="stiff petticoat (衬裙) from the hips down, over which a skirt fans out; left out: none",
    )


class OutfitTable(Table):
    name: Name | None = None
    title: Words = {}
    wearer: str | None = Field(None, description="figure file, e.g. mannequins/woman.npz")
    size: Number = Field(1.0, ge=0.5, le=2.0, description="how many times as tall the figure is")
    cover: CoverTable | None = Field(
        None, description="what the figure wears next to its skin, and what goes with it when it moves"
    )
    stand: StandTable | None = None
    pose: PoseTable | None = Field(None, description="name of a pose, or { name, joints, shift }")
    motion: str | None = Field(
        None, description="motion file, e.g. motions/walk.toml; see `simcore motion --help`"
    )
    study: str | None = Field(
        None, description="what `simcore dress --study` wrote: `hall build` chooses mesh steps by it"
    )
    layer: list[LayerTable] = Field(min_length=1, max_length=20)
