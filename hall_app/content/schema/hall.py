"""Schema of hall.toml: what holds for the whole hall."""

from __future__ import annotations

import re
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from hall_app.content.schema.values import Bilingual, ContentPath, Table


def _web_address(text: str) -> str:
    if not re.fullmatch(r"https?://[^\s/?#@]+(/[^\s?#]*)?", text):
        raise PydanticCustomError("own_address", "this is no address on the web")
    return text.rstrip("/")


def _email(text: str) -> str:
    if not re.fullmatch(r"[^\s@]+@[^\s@.]+(\.[^\s@.]+)+", text):
        raise PydanticCustomError("email", "this is no e-mail address")
    return text


WebAddress = Annotated[str, AfterValidator(_web_address)]
Email = Annotated[str, AfterValidator(_email)]


class Start(Table):
    """Where a visitor comes in."""

    x: float = Field(description="metres to the right of the hall's middle")
    z: float = Field(description="metres towards the entrance")
    facing: float = Field(180.0, description="degrees about the vertical; 0 looks to +z, 180 into the hall")


class Eye(Table):
    """Eye height of a visitor, changed by dragging with the middle button."""

    default: float = Field(1.6, ge=0.8, le=2.4, description="eye height at the start [m]")
    min: float = Field(0.9, ge=0.8, le=2.4, description="lowest eye height [m]")
    max: float = Field(2.2, ge=0.8, le=2.4, description="highest eye height [m]")

    @model_validator(mode="after")
    def _ordered(self) -> Eye:
        if not self.min <= self.default <= self.max:
            raise PydanticCustomError("eye_order", "min, default and max are not in rising order")
        return self


class HallFile(Table):
    """hall.toml."""

    title: Bilingual = Field(description="name of the hall")
    subtitle: Bilingual = Field(description="line below the name")
    about: Bilingual | None = Field(None, description="two or three sentences on the Enter screen")
    language: Literal["zh", "en"] = Field("zh", description="language of a first visit")
    music: tuple[ContentPath, ...] = Field(
        (),
        description="the hall's music, one piece in several formats; the browser takes the first it plays",
    )
    questionnaire: str | None = Field(None, description="questionnaire about the whole hall (its id)")
    retention_days: Annotated[int, Field(ge=1, le=3650)] = Field(
        365, description="days after which visit data is deleted"
    )
    licence: str = Field(min_length=2, description="licence of the hall's own texts and media")
    address: WebAddress | None = Field(
        None,
        description="where the hall is found on the web, e.g. https://hall.example.org: exported records name it",
    )
    contact: Email | None = Field(None, description="e-mail for questions about the exported records")
    start: Start = Field(description="where a visitor comes in")
    eye: Eye = Field(Eye.model_construct(), description="eye height of a visitor")
