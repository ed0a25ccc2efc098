"""The two folders of a hall: its content, which is looked for, and its data, which is made.

The content folder is --content, else ./assets, else the copy that came with the program. The data folder holds
answers, bakes and caches; whoever makes it closes it, before anything lies in it.
"""

from __future__ import annotations

from pathlib import Path

from hall_app.content.problems import ContentError, Problem

PACKAGE = Path(__file__).resolve().parent.parent


def content_folder(given: Path | None = None, *, here: Path | None = None) -> Path:
    """The content folder. Raises ContentError where the given one is no folder or none is found.

    given: the --content option; here: the working directory (default: the current one).
    """
    if given is not None:
        if not given.is_dir():
            raise ContentError(
                [Problem(str(given), "", "no such folder", "give --content a folder with hall.toml")]
            )
        return given.resolve()
    candidates = ((here or Path.cwd()) / "assets", PACKAGE / "assets", PACKAGE.parent / "assets")
    for candidate in candidates:
        # One of the two files is enough: where the other is missing, loading says so.
        if (candidate / "hall.toml").is_file() or (candidate / "plan.toml").is_file():
            return candidate.resolve()
    places = ", ".join(str(candidate) for candidate in candidates)
    fix = "start in a folder that holds assets/, or give --content FOLDER"
    raise ContentError([Problem("hall.toml", "", f"not found in {places}", fix)])


def make_data_folder(folder: Path) -> None:
    """Make it for its owner alone; one that was there keeps its rights. Raises OSError naming the option."""
    from survey.store.database import make_private

    try:
        make_private(folder)
    except OSError as error:
        raise OSError(f"--data {folder}: {error.strerror} – choose a folder that can be written") from error
