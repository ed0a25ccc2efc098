"""controller.toml in the content folder: who answers for the survey, and whom visitors may turn to."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, StringConstraints, ValidationError

from survey.errors import Problem
from survey.questionnaire import Text, problem_of

__all__ = ["CONTROLLER_FILE", "Controller", "Statement", "read_controller"]

CONTROLLER_FILE = "controller.toml"

Mail = Annotated[str, StringConstraints(strip_whitespace=True, pattern=r"^[^@\s<>]{1,64}@[^@\s<>]{1,255}$")]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Contact(_Part):
    """Somebody with a name and ways to be reached."""

    name: Text | None = None
    address: Text | None = None
    email: Mail | None = None


class Others(_Part):
    """What no setting can know. recipients: who else gets the answers, such as whoever runs the machine; transfers: to
    which countries beyond the law they go, and on what footing."""

    recipients: Text | None = None
    transfers: Text | None = None


class Controller(_Part):
    """controller: who decides about the survey; officer: of data protection, where there is one; authority: to which a
    visitor may complain. Every key may be missing, and is then said to be."""

    controller: Contact = Field(default_factory=Contact)
    officer: Contact | None = None
    authority: Contact = Field(default_factory=Contact)
    others: Others = Field(default_factory=Others)

    @property
    def missing(self) -> tuple[str, ...]:
        """The keys without which the law's list is not complete. An officer is not everybody's duty."""
        wanted = {
            "controller.name": self.controller.name,
            "controller.address": self.controller.address,
            "controller.email": self.controller.email,
            "authority.name": self.authority.name,
            "others.recipients": self.others.recipients,
            "others.transfers": self.others.transfers,
        }
        return tuple(key for key, value in wanted.items() if value is None)


@dataclass(frozen=True)
class Statement:
    """What the file says. faults: what is wrong with it, and then nothing of it is said. gaps: what it does not state
    yet; a hall that is tried out has nobody yet who answers for it, so that they are no faults of the folder."""

    controller: Controller
    faults: tuple[Problem, ...] = ()
    gaps: tuple[Problem, ...] = ()

    @property
    def problems(self) -> tuple[Problem, ...]:
        return self.faults + self.gaps


def read_controller(content: Path) -> Statement:
    """What the content folder says; what was left blank in it is not stated."""
    path = content / CONTROLLER_FILE
    if not path.is_file():
        what, fix = (
            "missing: the privacy page cannot say who answers for the survey",
            "write it (its form: README.md)",
        )
        return Statement(Controller(), gaps=(Problem(CONTROLLER_FILE, "", what, fix),))
    try:
        found = Controller.model_validate(_filled(tomllib.loads(path.read_text("utf-8-sig"))))
    except ValidationError as error:
        return Statement(Controller(), tuple(problem_of(CONTROLLER_FILE, entry) for entry in error.errors()))
    except (OSError, ValueError, RecursionError) as error:  # unreadable, no UTF-8, no TOML
        what = f"cannot be read ({' '.join(str(error).split())[:120]})"
        return Statement(
            Controller(), (Problem(CONTROLLER_FILE, "", what, "mend that line, and save it as UTF-8"),)
        )
    if not found.missing:
        return Statement(found)
    fix = "fill them in, in zh and en, before visitors answer; the privacy page says that they are missing"
    return Statement(found, gaps=(Problem(CONTROLLER_FILE, ", ".join(found.missing), "not stated yet", fix),))


def _filled(document: dict[str, Any]) -> dict[str, Any]:
    """The document without what stands empty in it: a blank between quotes is a gap, and no name."""
    kept = {}
    for key, value in document.items():
        left = _filled(value) if isinstance(value, dict) else value
        if left != {} and not (isinstance(left, str) and not left.strip()):
            kept[key] = left
    return kept
