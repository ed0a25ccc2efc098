"""Files from outside: TOML, JSON and npz, every way they fail told as one FileProblem that names the file; and files
that are written whole or not at all."""

from __future__ import annotations

import json
import tomllib
import zipfile
import zlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from sim_core.errors import FileProblem

if TYPE_CHECKING:
    import numpy as np

__all__ = [
    "check_target",
    "read_bytes",
    "read_json",
    "read_npz",
    "read_text",
    "read_toml",
    "shown",
    "written_whole",
]

LARGEST_TEXT = 16_000_000  # bytes of a TOML or JSON file; an outline of half a million points
LARGEST_ARRAYS = 2_000_000_000  # bytes of all arrays of an npz once unpacked
NOT_AN_NPZ = (
    OSError,
    ValueError,  # pickled arrays and foreign files among them
    KeyError,
    TypeError,
    EOFError,
    RuntimeError,  # an encrypted archive; NotImplementedError: an unknown compression
    RecursionError,
    MemoryError,
    OverflowError,
    zipfile.BadZipFile,
    zlib.error,
)


def shown(value: object, most: int = 60) -> str:
    """repr of a value from a file, cut where it is longer than a line bears."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):
        return f"a {type(value).__name__} too large to show"
    return text if len(text) <= most else text[:most] + "…"


def read_toml(path: Path, what: str) -> dict[str, Any]:
    """The tables of a TOML file, with or without a byte order mark; `what`: such as "a weave file (TOML)".

    Raises FileProblem where it is missing, empty, too large, not UTF-8 or not TOML.
    """
    text = read_bytes(path, what)
    try:
        return tomllib.loads(text.decode("utf-8-sig"))
    except RecursionError as error:
        raise FileProblem(f"{path}: brackets nested too deep – give {what}") from error
    except ValueError as error:  # a bad statement, bytes that are no UTF-8, a number of thousands of digits
        raise FileProblem(f"{path}: not valid TOML: {error}") from error


def read_json(path: Path, what: str) -> Any:
    """The value of a JSON file; raises FileProblem as `read_toml` does."""
    text = read_bytes(path, what)
    try:
        return json.loads(text.decode("utf-8-sig"))
    except RecursionError as error:
        raise FileProblem(f"{path}: brackets nested too deep – give {what}") from error
    except ValueError as error:
        raise FileProblem(f"{path}: not valid JSON ({error}) – give {what}") from error


def read_text(path: Path, what: str, most: int | None = None) -> str:
    """The text of a UTF-8 file, with or without a byte order mark; raises FileProblem as `read_toml` does.

    most: bytes that are read of it, LARGEST_TEXT if that is not said.
    """
    text = read_bytes(path, what, most)
    try:
        return text.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise FileProblem(f"{path}: not UTF-8 text – give {what}") from error


def read_bytes(path: Path, what: str, most: int | None = None) -> bytes:
    """What a file holds; raises FileProblem where it is missing, empty or larger than `most` (LARGEST_TEXT) bytes."""
    most = LARGEST_TEXT if most is None else most
    try:
        with path.open("rb") as stream:
            text = stream.read(most + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise FileProblem(f"{path}: {reason} – give the path of {what}") from error
    if len(text) > most:
        raise FileProblem(f"{path}: larger than {most // 1_000_000} MB – give {what}")
    if not text.removeprefix(b"\xef\xbb\xbf").strip():
        raise FileProblem(f"{path}: the file is empty – give {what}")
    return text


def read_npz(path: Path, names: Iterable[str], what: str, remedy: str) -> dict[str, np.ndarray]:
    """The named arrays of an npz file; `what`: such as "a garment file", `remedy`: how to get one.

    Raises FileProblem where it is missing, truncated, of another kind, holds pickles, lacks a name, or would unpack
    to more than 2 GB.
    """
    import numpy as np

    try:
        # Opened here, since numpy leaves a damaged file open.
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as data:
            if sum(part.file_size for part in data.zip.infolist()) > LARGEST_ARRAYS:
                raise FileProblem(f"{path}: holds more than {LARGEST_ARRAYS // 1_000_000_000} GB – {remedy}")
            missing = [name for name in names if name not in data.files]
            if missing:
                raise FileProblem(f"{path}: not {what} (no array {missing[0]!r}) – {remedy}")
            return {name: data[name] for name in names}
    except FileProblem:
        raise
    except FileNotFoundError as error:
        raise FileProblem(f"{path}: no such file – {remedy}") from error
    except NOT_AN_NPZ as error:
        reason = getattr(error, "strerror", None) or " ".join(str(error).split())
        raise FileProblem(f"{path}: not {what} ({reason or type(error).__name__}) – {remedy}") from error


@contextmanager
def written_whole(path: Path) -> Iterator[IO[bytes]]:
    """A stream whose bytes are the file once the block ends without an error; else what was there stays.

    Makes the folder. Raises FileProblem where the file cannot be written, and leaves nothing behind.
    """
    beside = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            with beside.open("wb") as stream:
                yield stream
            beside.replace(path)
        finally:
            with suppress(OSError):  # what could not be made cannot be removed; the first error is told
                beside.unlink(missing_ok=True)
    except OSError as error:
        reason = error.strerror or error
        raise FileProblem(
            f"{path}: cannot be written ({reason}) – give a file in a folder that can be"
        ) from error


def check_target(path: Path) -> None:
    """Makes the folder and tries whether a file of this name can be written, before work is done for it.

    Raises FileProblem where it cannot; a file that is there keeps what it holds.
    """
    if path.is_dir():
        raise FileProblem(f"{path}: this is a folder – name a file")
    tried = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        tried.open("ab").close()
        tried.unlink()
    except (OSError, ValueError) as error:  # ValueError: a name with a null byte
        reason = getattr(error, "strerror", None) or error
        raise FileProblem(
            f"{path}: cannot be written ({reason}) – give a file in a folder that can be"
        ) from error
