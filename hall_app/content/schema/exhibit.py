"""Schema of exhibits/<id>/exhibit.toml."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from hall_app.content.behaviours import BEHAVIOURS
from hall_app.content.schema.comparison import Comparison
from hall_app.content.schema.values import Bilingual, ContentPath, Metres, Table, Text


def _known_behaviour(name: str) -> str:
    if name not in BEHAVIOURS:
        known = ", ".join(sorted(BEHAVIOURS))
        raise PydanticCustomError("behaviour", "no such behaviour; known are {known}", {"known": known})
    return name


Behaviour = Annotated[str, AfterValidator(_known_behaviour)]


class Place(Table):
    """Where the exhibit stands."""

    x: float = Field(description="metres to the right of the hall's middle")
    z: float = Field(description="metres towards the entrance")
    facing: float = Field(0.0, description="degrees its front is turned; 0 looks to +z, the entrance")
    on: str | None = Field(None, description="id of the booth or stand of plan.toml it stands on")
    y: float | None = Field(
        None, ge=0, le=3, description="height of its foot [m]; without it the top of place.on, else the floor"
    )
    lamp: float = Field(1.0, ge=0.2, le=4, description="how bright its lamp is, of what others have")


class Models(Table):
    """Ready-made models of an exhibit that is not simulated (a scan, a drawn model)."""

    hall: ContentPath = Field(description="light .glb for the hall: at most 15 000 triangles and 1.5 MB")
    close: ContentPath | None = Field(
        None,
        description="fine .glb for the close-up: at most 300 000 triangles; without it the light one is used",
    )


class Show(Table):
    """From how near an outfit or a scan is seen, which decides how coarse its model in the hall may be."""

    nearest: Metres = Field(1.3, description="nearest distance from which a visitor sees it [m]")
    hall_error_px: float = Field(
        1.0, gt=0, le=20, description="greatest deviation of the hall's model, in pixels at the nearest view"
    )
    hall_beneath_px: float | None = Field(
        None,
        gt=0,
        le=20,
        description="the same of layers worn beneath others; without it 4 mm, for what openings show of them",
    )


class Scanned(Table):
    """How a scan was saved, where that is not in metres and y up, and what of it is shown."""

    units: Literal["m", "cm", "mm", "in"] = Field("m", description="length of its unit")
    scale: float = Field(1.0, gt=0, le=1e6, description="times its units, where they are none of these")
    up: Literal["x", "y", "z", "-x", "-y", "-z"] | None = Field(
        None, description="its axis that points upwards; without it y, as long as that can be"
    )
    keep: Literal["all", "largest"] | None = Field(
        None, description="of several loose parts: all, or the largest alone; without it all"
    )

    @property
    def metres(self) -> float:
        """How many one of its units is."""
        return {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}[self.units] * self.scale


class Body(Table):
    """The exhibit's rigid body: a simple shape a visitor cannot walk through."""

    shape: Literal["round", "box"] = Field(description="round or box")
    radius: Metres | None = Field(None, description="radius of a round body [m]")
    size: tuple[Metres, Metres] | None = Field(None, description="width and depth of a box body [m]")
    height: Metres = Field(2.0, description="height of the body [m]")

    @model_validator(mode="after")
    def _fits_shape(self) -> Body:
        wanted, other = (self.radius, self.size) if self.shape == "round" else (self.size, self.radius)
        if wanted is None or other is not None:
            raise PydanticCustomError("body_shape", "a round body has a radius, a box body a size")
        return self


class Media(Table):
    """One picture, film or sound of the exhibit."""

    kind: Literal["picture", "video", "audio"] = Field(description="picture, video or audio")
    file: ContentPath | None = Field(None, description="the file, inside the exhibit's folder")
    files: tuple[ContentPath, ...] = Field(
        (), description="or the same thing in several formats; the browser takes the first it plays"
    )
    poster: ContentPath | None = Field(None, description="still picture shown before a video starts")
    alt: Bilingual | None = Field(None, description="what it shows, for visitors who cannot see or hear it")
    caption: Bilingual | None = Field(None, description="line below it")
    transcript: Bilingual | None = Field(None, description="words or description of an audio or video")

    @model_validator(mode="after")
    def _one_source(self) -> Media:
        if (self.file is None) == (not self.files):
            raise PydanticCustomError("one_source", "needs either file or files")
        return self

    @property
    def sources(self) -> tuple[str, ...]:
        """Its files in the order of preference, relative to the exhibit's folder."""
        return self.files or ((self.file,) if self.file else ())


class RecordLine(Table):
    """One line of the catalogue record that the fixed keys do not cover."""

    label: Bilingual = Field(description="name of the line")
    value: Bilingual = Field(description="its content")


class Record(Table):
    """Catalogue record, after Costume Core and Dublin Core; every line may be left out."""

    object: Bilingual | None = Field(None, description="what it is")
    date: Bilingual | None = Field(None, description="period")
    culture: Bilingual | None = Field(None, description="where and by whom it was worn or used")
    material: Bilingual | None = Field(None, description="material")
    technique: Bilingual | None = Field(None, description="how it was made")
    colour: Bilingual | None = Field(None, description="main colour")
    measurements: Bilingual | None = Field(None, description="measures")
    wear: Bilingual | None = Field(None, description="how it was worn")
    maker: Bilingual | None = Field(None, description="who made the object or this model")
    source: Bilingual | None = Field(None, description="what the reconstruction rests on")
    rights: Bilingual | None = Field(None, description="rights statement in words")
    line: tuple[RecordLine, ...] = Field((), description="further lines, one [[record.line]] each")


class ExhibitFile(Table):
    """exhibit.toml."""

    title: Bilingual = Field(description="name of the exhibit")
    caption: Bilingual | None = Field(None, description="one sentence shown when a visitor comes near")
    place: Place = Field(description="where it stands")
    models: Models | None = Field(None, description="ready-made models; either this or outfit or scan")
    outfit: ContentPath | None = Field(
        None,
        description="outfit that hall build dresses, e.g. outfits/beizi.toml; either this or models or scan",
    )
    scan: ContentPath | None = Field(
        None,
        description="dense scan that hall build makes models of: .glb, .ply or .obj; either this or outfit",
    )
    scanned: Scanned = Field(Scanned.model_construct(), description="how the scan was saved")
    motion: ContentPath | None = Field(
        None, description="clip its model in the hall moves by, e.g. motion.clip; at most 2 MB"
    )
    show: Show = Field(Show.model_construct(), description="from how near the outfit or scan is seen")
    body: Body = Field(description="rigid body")
    behaviours: tuple[Behaviour, ...] = Field(
        ("open_on_click", "glow_when_near"),
        description="what it does: open_on_click, glow_when_near, turn_slowly or turn_to_visitor, play_clip",
    )
    media: tuple[Media, ...] = Field((), description="pictures, films, sounds, one [[media]] each")
    record: Record = Field(Record.model_construct(), description="catalogue record")
    comparison: Comparison | None = Field(None, description="meshes shown side by side in the close-up")
    thumbnail: ContentPath | None = Field(None, description="small picture for lists; else the first picture")
    size_range: tuple[Metres, Metres] = Field(
        (0.3, 3.0), description="lowest and greatest height of the model that is right [m]"
    )
    questionnaire: Text | None = Field(None, description="id of the questionnaire asked at this exhibit")
    licence: Text = Field(description="licence of texts, model and media, e.g. CC0-1.0")

    @model_validator(mode="after")
    def _one_model(self) -> ExhibitFile:
        if sum(source is not None for source in (self.models, self.outfit, self.scan)) != 1:
            raise PydanticCustomError("one_model", "needs one of outfit, scan and [models]")
        if self.models is not None and "show" in self.model_fields_set:
            raise PydanticCustomError(
                "show_alone", "[show] is for an outfit or a scan; ready-made models stay as they are"
            )
        if self.scan is None and "scanned" in self.model_fields_set:
            raise PydanticCustomError("scanned_alone", "[scanned] is for a scan, and none is named")
        return self

    @property
    def baked_key(self) -> Literal["outfit", "scan"] | None:
        """The key that names what `hall build` makes its models of, None for ready-made ones."""
        return "outfit" if self.outfit is not None else "scan" if self.scan is not None else None

    @model_validator(mode="after")
    def _one_turning(self) -> ExhibitFile:
        if {"turn_slowly", "turn_to_visitor"} <= set(self.behaviours):
            raise PydanticCustomError(
                "one_turning", "behaviours: turn_slowly and turn_to_visitor exclude each other – keep one"
            )
        return self
