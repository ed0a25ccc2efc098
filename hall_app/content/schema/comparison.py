"""Schema of [comparison] in exhibit.toml: meshes that the close-up shows side by side, by one model and one clip."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from hall_app.content.schema.values import Bilingual, ContentPath, Table

Colour = Annotated[str, Field(pattern="^#[0-9a-fA-F]{6}$")]


class Side(Table):
    """One mesh of the comparison, as the table beside it tells it."""

    name: Bilingual = Field(description="what it is, e.g. coarse simulation")
    colour: Colour = Field(description="colour it has in the model, #rrggbb: by it the row is known")
    vertices: int = Field(ge=3, le=1_000_000, description="vertices of its mesh")
    hausdorff_mm: float | None = Field(
        None,
        ge=0,
        le=100_000,
        description="Hausdorff distance from the reference [mm]; none of the reference itself",
    )
    milliseconds: float = Field(ge=0, le=1_000_000, description="what a frame of it costs [ms]")


class Comparison(Table):
    """Two or three meshes side by side, shown in the close-up on request; they turn together."""

    model: ContentPath = Field(
        description=".glb of all of them beside each other: at most 300 000 triangles and 15 MB"
    )
    clip: ContentPath | None = Field(None, description=".clip that moves them by one clock; at most 2 MB")
    text: Bilingual | None = Field(None, description="what is compared, and where the figures were measured")
    side: tuple[Side, ...] = Field(
        min_length=2, max_length=3, description="one [[comparison.side]] each, from left to right"
    )

    @model_validator(mode="after")
    def _one_reference(self) -> Comparison:
        if sum(side.hausdorff_mm is None for side in self.side) > 1:
            raise PydanticCustomError(
                "one_reference", "side: two have no hausdorff_mm – only the reference itself has none"
            )
        return self
