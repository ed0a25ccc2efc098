"""A content folder as values: the hall, its plan, its exhibits, what is written of them, and what is wrong with it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from hall_app.content.files import is_there
from hall_app.content.problems import Problem
from hall_app.content.schema.article import ArticleFile
from hall_app.content.schema.exhibit import ExhibitFile
from hall_app.content.schema.glossary import Word
from hall_app.content.schema.hall import HallFile
from hall_app.content.schema.plan import PlanFile
from hall_app.content.schema.research import Measured, Paper

__all__ = ["Article", "Cloth", "Content", "Exhibit", "Writing"]


@dataclass(frozen=True)
class Exhibit:
    """An exhibit as its folder describes it. `text` is Markdown; `folder` an absolute path."""

    id: str
    folder: Path
    file: ExhibitFile
    text_zh: str
    text_en: str

    @property
    def toml(self) -> str:
        """Name of its file inside the content folder."""
        return f"exhibits/{self.id}/exhibit.toml"

    def model_path(self, precision: str) -> Path | None:
        """The GLB to draw in the "hall" or "close" up, or None where it is not baked yet."""
        if self.file.models is None:
            path = self.folder / "baked" / f"{precision}.glb"
        else:
            fine = self.file.models.close if precision == "close" else None
            path = self.folder / (fine or self.file.models.hall)
        return path if is_there(path) else None

    def compared_path(self) -> Path | None:
        """The GLB of what it compares, or None where it names none or the file is not there."""
        told = self.file.comparison
        return self.folder / told.model if told and is_there(self.folder / told.model) else None

    def own_models(self) -> dict[str, tuple[str, Path]]:
        """Precision -> (key in its file, path) of the models that are there; a close-up without a file of its own
        is left out."""
        found: dict[str, tuple[str, Path]] = {}
        for precision in ("hall", "close"):
            path = self.model_path(precision)
            if path is not None and path not in {other for _, other in found.values()}:
                key = f"models.{precision}" if self.file.models else f"baked/{path.name}"
                found[precision] = (key, path)
        return found


@dataclass(frozen=True)
class Article:
    """An article as its folder describes it. The texts are Markdown; `folder` an absolute path."""

    id: str
    folder: Path
    file: ArticleFile
    text_zh: str
    text_en: str

    @property
    def toml(self) -> str:
        """Name of its file inside the content folder."""
        return f"articles/{self.id}/article.toml"

    def text(self, language: str) -> str:
        """Its Markdown in "zh" or "en"."""
        return self.text_zh if language == "zh" else self.text_en


@dataclass(frozen=True)
class Cloth:
    """What a weave's file says of itself to readers; the engine reads the rest.

    kind: its draft's; ends, picks: a metre; motif: the name of its motif's file, if it has one.
    """

    id: str
    title_zh: str
    title_en: str
    source: str
    kind: str
    ends: float
    picks: float
    motif: str | None

    def title(self, language: str) -> str:
        """Its name in "zh" or "en"."""
        return self.title_zh if language == "zh" else self.title_en


@dataclass(frozen=True)
class Writing:
    """What is there to read beside the exhibits: articles in their order, words, weaves, figures, publications."""

    articles: tuple[Article, ...] = ()
    words: tuple[Word, ...] = ()
    cloths: tuple[Cloth, ...] = ()
    numbers: tuple[Measured, ...] = ()
    papers: tuple[Paper, ...] = ()

    def article(self, identity: str) -> Article | None:
        """The article of that id, or None."""
        return next((article for article in self.articles if article.id == identity), None)

    def word(self, identity: str) -> Word | None:
        """The word of that id, or None."""
        return next((word for word in self.words if word.id == identity), None)

    def cloth(self, identity: str) -> Cloth | None:
        """The weave of that id, or None."""
        return next((cloth for cloth in self.cloths if cloth.id == identity), None)


@dataclass(frozen=True)
class Content:
    """A content folder, read. Faulty exhibits and articles are left out and named in `problems`."""

    folder: Path
    hall: HallFile
    plan: PlanFile
    exhibits: tuple[Exhibit, ...]
    writing: Writing
    problems: tuple[Problem, ...]
    revision: str

    def exhibit(self, identity: str) -> Exhibit | None:
        """The exhibit of that id, or None."""
        return next((exhibit for exhibit in self.exhibits if exhibit.id == identity), None)
