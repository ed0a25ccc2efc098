"""Problems of a content folder as values: one line each, naming file, key, what is wrong and the remedy."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass

from hall_app.content.problems.catalogue import in_language


@dataclass(frozen=True, order=True)
class Problem:
    """One thing to put right. `file` is relative to the content folder, `key` may be empty."""

    file: str
    key: str
    what: str
    fix: str

    def __str__(self) -> str:
        return self.text("en")

    def text(self, language: str) -> str:
        """The line in that language, "zh" or "en"; what no catalogue knows of it is English."""
        colon, dash = ("：", " —— ") if language == "zh" else (": ", " – ")
        what, fix = (in_language(one, language) for one in (self.what, self.fix))
        where = f"{self.file}{colon}{self.key}" if self.key else self.file
        return f"{where}{colon}{what}{dash}{fix}".replace("\n", " ")

    def as_json(self) -> dict[str, str]:
        """The problem as `hall check --json` writes it."""
        return asdict(self)


@dataclass(frozen=True)
class Problems:
    """Several in one sentence. most: how many of them it names."""

    found: tuple[Problem, ...]
    most: int

    def text(self, language: str) -> str:
        left = len(self.found) - self.most
        lines = (problem.text(language) for problem in self.found[: self.most])
        return ("；" if language == "zh" else "; ").join(lines) + (f" (+{left})" if left > 0 else "")


class ContentError(ValueError):
    """The hall cannot open: hall.toml or plan.toml is missing or faulty. Carries the problems."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))
