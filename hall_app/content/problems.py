"""Problems of a content folder as values: one line each, naming file, key, what is wrong and the remedy."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass


@dataclass(frozen=True, order=True)
class Problem:
    """One thing to put right. `file` is relative to the content folder, `key` may be empty."""

    file: str
    key: str
    what: str
    fix: str

    def __str__(self) -> str:
        where = f"{self.file}: {self.key}" if self.key else self.file
        return f"{where}: {self.what} – {self.fix}".replace("\n", " ")

    def as_json(self) -> dict[str, str]:
        """The problem as `hall check --json` writes it."""
        return asdict(self)


class ContentError(ValueError):
    """The hall cannot open: hall.toml or plan.toml is missing or faulty. Carries the problems."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))
