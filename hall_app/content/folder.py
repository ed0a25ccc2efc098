"""A content folder as values: the hall, its plan, its exhibits, and what is wrong with them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from hall_app.content.files import is_there
from hall_app.content.problems import Problem
from hall_app.content.schema.exhibit import ExhibitFile
from hall_app.content.schema.hall import HallFile
from hall_app.content.schema.plan import PlanFile

__all__ = ["Content", "Exhibit"]


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
class Content:
    """A content folder, read. Faulty exhibits are left out and named in `problems`."""

    folder: Path
    hall: HallFile
    plan: PlanFile
    exhibits: tuple[Exhibit, ...]
    problems: tuple[Problem, ...]
    revision: str

    def exhibit(self, identity: str) -> Exhibit | None:
        """The exhibit of that id, or None."""
        return next((exhibit for exhibit in self.exhibits if exhibit.id == identity), None)
