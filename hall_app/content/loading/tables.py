"""One file of a content folder, read: a table or a Markdown text, or what is wrong with it."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError

from hall_app.content.files import LEAVES, leaves
from hall_app.content.problems import Problem
from hall_app.content.schema.complaints import schema_problems, toml_problem
from hall_app.content.schema.values import Table

T = TypeVar("T", bound=Table)


def read_table(root: Path, name: str, model: type[T]) -> tuple[T | None, list[Problem]]:
    """Read the TOML (or .json) file `name` under `root` as `model`: the value, or None and its problems."""
    path = root / name
    try:
        if leaves(path, root):
            return None, [Problem(name, "", f"it {LEAVES[0]}", LEAVES[1])]
        data = path.read_bytes()
        if not data.strip():
            return None, [Problem(name, "", "the file is empty", "write it anew (its form: README.md)")]
        if name.endswith(".json"):
            return model.model_validate_json(data), []
        # Notepad writes a byte order mark.
        return model.model_validate(tomllib.loads(data.decode("utf-8-sig"))), []
    except FileNotFoundError:
        return None, [Problem(name, "", "missing file", "add it (its form: README.md)")]
    except OSError as error:
        return None, [Problem(name, "", f"cannot be read ({error.strerror})", "check the file's permissions")]
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        return None, [toml_problem(name, error)]
    except ValidationError as error:
        return None, schema_problems(name, model, error)
    except (ValueError, RecursionError, ArithmeticError) as error:
        # A number of thousands of digits, thousands of brackets: tomllib gives up in its own ways.
        what = f"cannot be read ({type(error).__name__})"
        return None, [Problem(name, "", what, "shorten its numbers and lists")]


def read_text(root: Path, path: str, what: str, problems: list[Problem]) -> str:
    """The Markdown text at `path` under `root`, its faults added to `problems`. what: "every exhibit", whose it is."""
    fix = f"write it: {what} has both languages"
    try:
        if leaves(root / path, root):
            problems.append(Problem(path, "", f"it {LEAVES[0]}", LEAVES[1]))
            return ""
        text = (root / path).read_text("utf-8-sig")
    except FileNotFoundError:
        problems.append(Problem(path, "", "missing text", fix))
    except (OSError, UnicodeDecodeError):
        problems.append(Problem(path, "", "the text cannot be read", "save it with the encoding UTF-8"))
    else:
        if not text.strip():
            problems.append(Problem(path, "", "the text is empty", fix))
        return text
    return ""


def unforeseen(file: str, error: Exception) -> Problem:
    """A fault of `file` that nobody thought of."""
    reason = " ".join(str(error).split())[:200] or type(error).__name__
    fix = "undo the last change there, and report it with the file"
    return Problem(file, "", f"cannot be read ({reason})", fix)


def folders_in(home: Path) -> list[Path]:
    """The folders under `home` that are shown, sorted; those that begin with . or _ are not."""
    if not home.is_dir():
        return []
    return sorted(path for path in home.iterdir() if path.is_dir() and not path.name.startswith((".", "_")))
