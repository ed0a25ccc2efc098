"""Small shared shapes of the content files: two languages, safe paths, points, strict tables."""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field
from pydantic_core import PydanticCustomError


class Table(BaseModel):
    """A table of a content file: frozen, no unknown keys, no nan and no inf (TOML can write both)."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


def _not_blank(text: str) -> str:
    if not text.strip():
        raise PydanticCustomError("blank_text", "the text is empty")
    return text


def _inside_only(text: str) -> str:
    path = PurePosixPath(text)
    wrong = not text or "\\" in text or "\0" in text or ":" in text
    if wrong or path.is_absolute() or ".." in path.parts or path == PurePosixPath("."):
        raise PydanticCustomError("unsafe_path", "the path leaves the content folder or is not a plain one")
    return str(path)


Text = Annotated[str, AfterValidator(_not_blank)]
ContentPath = Annotated[str, AfterValidator(_inside_only)]
Point = tuple[float, float]
Ring = Annotated[tuple[Point, ...], Field(min_length=3)]
Metres = Annotated[float, Field(gt=0, le=100)]


class Bilingual(Table):
    """One text in Chinese and English; neither may be empty."""

    zh: Text = Field(description="Chinese text")
    en: Text = Field(description="English text")

    def as_json(self) -> dict[str, str]:
        """The pair as the page reads it."""
        return {"zh": self.zh, "en": self.en}
