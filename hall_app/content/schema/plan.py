"""Schema of plan.toml: floor outline, walls, openings, solids and bays; polygons are [x, z] in metres."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from hall_app.content.schema.values import Bilingual, ContentPath, Metres, Point, Ring, Table, Text

Hung = Annotated[float, Field(ge=0.1, le=20)]  # [m] a side of what hangs on a wall
BESIDE = 0.05  # [m] an opening may lie beside the faces of the wall that it is in
TO_CEILING = 0.05  # [m] a wall lower than the rooms by less is drawn up to whatever ceiling is over it
PAINTED = (".jpg", ".jpeg", ".png", ".webp")  # what the room's letters can lie beside on one sheet


class Wall(Table):
    """A straight wall."""

    start: Point = Field(alias="from", description="one end of the wall's middle line, [x, z]")
    end: Point = Field(alias="to", description="the other end, [x, z]")
    thickness: Metres = Field(0.2, description="thickness [m]")
    height: Metres = Field(4.3, description="height [m]")
    kind: Literal["wall", "lattice"] = Field(
        "wall", description="plastered wall or wooden lattice; both stop a visitor"
    )

    @model_validator(mode="after")
    def _has_length(self) -> Wall:
        if self.start == self.end:
            raise PydanticCustomError("zero_length", "the wall begins and ends at the same point")
        return self


class Opening(Table):
    """A door or window drawn in a wall; it does not change where one can walk."""

    kind: Literal["door", "window"] = Field(description="door or window")
    start: Point = Field(alias="from", description="one end on the wall's middle line, [x, z]")
    end: Point = Field(alias="to", description="the other end, [x, z]")
    sill: float = Field(0.0, ge=0, le=5, description="height of its lower edge [m]")
    height: Metres = Field(2.4, description="height of the opening itself [m]")

    def beside(self, start: ArrayLike, end: ArrayLike, away: float) -> bool:
        """Whether both its ends lie within `away` [m] of the line start to end."""
        line = np.array([start, end], float)
        along = line[1] - line[0]
        for point in np.array([self.start, self.end], float):
            share = np.clip((point - line[0]) @ along / (along @ along), 0.0, 1.0)
            if np.linalg.norm(point - line[0] - share * along) >= away:
                return False
        return True


class Round(Table):
    """A round footprint."""

    x: float = Field(description="centre [m]")
    z: float = Field(description="centre [m]")
    radius: Metres = Field(description="radius [m]")


class Solid(Table):
    """Something that stands on the floor and stops a visitor. Exactly one footprint is given."""

    id: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]*$")] = Field(
        description="short name, a-z, 0-9 and -; an exhibit's place.on refers to it"
    )
    kind: Literal["booth", "dais", "step", "bench", "stand", "column", "rope"] = Field(
        description="booth, dais, step, bench, stand, column, or a rope between two posts"
    )
    height: Metres = Field(description="height [m]")
    polygon: Ring | None = Field(None, description="footprint as corner points [[x, z], …]")
    size: tuple[Metres, Metres] | None = Field(
        None, description="footprint as a rectangle [width, depth]; needs at"
    )
    at: Point | None = Field(None, description="middle of the rectangle, [x, z]")
    facing: float = Field(0.0, description="degrees its front is turned; 0 looks to +z")
    round: Round | None = Field(None, description="round footprint {x, z, radius}")
    backdrop: Literal["none", "pale", "dark"] = Field(
        "none",
        description="cloth at the back of a booth or dais: pale behind dark dress, dark behind pale dress",
    )
    label: Bilingual | None = Field(None, description="name of the thing, both languages")

    @model_validator(mode="after")
    def _one_footprint(self) -> Solid:
        given = [self.polygon is not None, self.size is not None, self.round is not None]
        if sum(given) != 1 or (self.size is not None) != (self.at is not None):
            raise PydanticCustomError("one_footprint", "needs exactly one of: polygon, size with at, round")
        return self


class Bay(Table):
    """A named part of the hall."""

    id: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]*$")] = Field(
        description="short name, a-z, 0-9 and -"
    )
    name: Bilingual = Field(description="name shown on the minimap")
    polygon: Ring = Field(description="its floor, [[x, z], …]")
    height: Metres | None = Field(
        None, description="height of its ceiling [m]; without it nave_height over the bay nave, else height"
    )


class Laylight(Table):
    """A paper ceiling with light above it."""

    at: Point = Field(description="its middle, [x, z]")
    size: tuple[Metres, Metres] = Field(description="width along x and depth along z [m]")


class Lantern(Table):
    """A paper lantern that hangs from the ceiling."""

    at: Point = Field(description="below which it hangs, [x, z]")
    height: Annotated[float, Field(ge=2.5, le=20)] = Field(3.1, description="height of its middle [m]")


class Curtain(Table):
    """A pair of curtains tied back to both ends of an opening."""

    start: Point = Field(alias="from", description="one end, the middle of a column, [x, z]")
    end: Point = Field(alias="to", description="the other end, [x, z]")


class Sign(Table):
    """What hangs on a wall: the plaque with the hall's title, a banner of calligraphy, or a picture on a scroll."""

    kind: Literal["plaque", "banner", "picture"] = Field(description="plaque, banner, or picture on a scroll")
    at: Point = Field(description="the wall's face it hangs on, [x, z]")
    facing: float = Field(0.0, description="degrees its front is turned; 0 looks to +z")
    height: Annotated[float, Field(ge=0.5, le=20)] = Field(description="height of its middle [m]")
    size: tuple[Hung, Hung] = Field(description="width and height [m]")
    text: Text | None = Field(None, description="what a plaque or banner says; without it the hall's title")
    picture: ContentPath | None = Field(
        None, description="of a picture: the file, from the content folder on; .jpg, .png or .webp"
    )

    @model_validator(mode="after")
    def _says_or_shows(self) -> Sign:
        if (self.kind == "picture") != (self.picture is not None):
            raise PydanticCustomError(
                "sign_shows", "a sign of kind picture has a picture, any other has none"
            )
        if self.picture and self.text:
            raise PydanticCustomError("sign_silent", "a picture that hangs in the hall has no text")
        if self.picture and not self.picture.lower().endswith(PAINTED):
            raise PydanticCustomError("sign_painted", "a picture that hangs in the hall is of pixels")
        return self


class PlanFile(Table):
    """plan.toml."""

    outline: Ring = Field(description="the floor a visitor may stand on, [[x, z], …], not crossing itself")
    height: Metres = Field(4.3, description="height of the side rooms [m]")
    nave_height: Metres = Field(5.4, description="height of the middle aisle [m]")
    wall: tuple[Wall, ...] = Field((), description="walls, one [[wall]] each")
    opening: tuple[Opening, ...] = Field((), description="doors and windows, one [[opening]] each")
    solid: tuple[Solid, ...] = Field((), description="booths, benches, stands, columns, one [[solid]] each")
    bay: tuple[Bay, ...] = Field((), description="named parts of the hall, one [[bay]] each")
    laylight: tuple[Laylight, ...] = Field((), description="paper ceilings, one [[laylight]] each")
    lantern: tuple[Lantern, ...] = Field((), description="lanterns, one [[lantern]] each")
    curtain: tuple[Curtain, ...] = Field((), description="curtains, one [[curtain]] each")
    sign: tuple[Sign, ...] = Field((), description="plaque, banners and pictures, one [[sign]] each")

    def to_ceiling(self, wall: Wall) -> bool:
        """Whether a wall is drawn up to the ceilings beside it, whatever their height."""
        return wall.height > self.height - TO_CEILING

    def openings_in(self, wall: Wall) -> list[Opening]:
        """The doors and windows that are drawn in a wall: both ends of each lie in it, or close beside its faces."""
        away = wall.thickness / 2 + BESIDE
        return [opening for opening in self.opening if opening.beside(wall.start, wall.end, away)]

    def height_over(self, bay: Bay) -> float:
        """Height [m] of the ceiling over a bay: its own, else the nave's over the bay named nave, else the rooms'."""
        if bay.height is not None:
            return bay.height
        return self.nave_height if bay.id == "nave" else self.height
