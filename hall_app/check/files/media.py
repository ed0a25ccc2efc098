"""Media: do pictures, films and sounds hold what their names say, and can a browser show them?"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from hall_app.content.files import TEXTS, hall_files, is_there, plan_files
from hall_app.content.folder import Content, Exhibit
from hall_app.content.models.pictures import FORMATS, picture_fault
from hall_app.content.problems import Problem
from hall_app.content.views.markdown import pictures_in
from hall_app.content.views.scene import own_file

# Where a container's mark stands, and the mark; an .mp3 has two, see _begins.
MARKS: dict[str, tuple[int, bytes]] = {
    ".webm": (0, b"\x1a\x45\xdf\xa3"),
    ".mp4": (4, b"ftyp"),
    ".m4a": (4, b"ftyp"),
    ".ogg": (0, b"OggS"),
    ".opus": (0, b"OggS"),
    ".wav": (8, b"WAVE"),
}
VIDEO, AUDIO = (".webm", ".mp4"), (".webm", ".mp4", ".m4a", ".ogg", ".opus", ".mp3", ".wav")
ENDINGS = {"picture": tuple(FORMATS), "video": VIDEO, "audio": AUDIO}
LAYER_3 = 0b01  # MPEG audio's name for what .mp3 holds


def media_problems(content: Content) -> list[Problem]:
    """Media whose ending the hall does not serve, or whose content is not what the ending says."""
    house = (
        ("hall.toml", hall_files(content.hall), "audio"),
        ("plan.toml", plan_files(content.plan), "picture"),
    )
    found = [
        problem
        for file, named, kind in house
        for key, path in named
        if (problem := _problem(file, key, path, content.folder / path, kind))
    ]
    for exhibit in content.exhibits:
        for file, key, path, kind in _named(exhibit):
            full = own_file(exhibit, path)
            if full is not None and (problem := _problem(file, key, path, full, kind)):
                found.append(problem)
    return found


def _named(exhibit: Exhibit) -> Iterator[tuple[str, str, str, str]]:
    """(file, key, path, kind) of every medium the exhibit names."""
    if exhibit.file.thumbnail:
        yield exhibit.toml, "thumbnail", exhibit.file.thumbnail, "picture"
    for number, medium in enumerate(exhibit.file.media, 1):
        key = f"media[{number}]"
        if medium.file:
            yield exhibit.toml, f"{key}.file", medium.file, medium.kind
        for index, path in enumerate(medium.files, 1):
            yield exhibit.toml, f"{key}.files[{index}]", path, medium.kind
        if medium.poster:
            yield exhibit.toml, f"{key}.poster", medium.poster, "picture"
    for language, text in (("zh", exhibit.text_zh), ("en", exhibit.text_en)):
        for path in pictures_in(text):
            if Path(path).suffix.lower() in FORMATS:  # others are refused as a text's picture
                yield f"exhibits/{exhibit.id}/{TEXTS[language]}", "", path, "picture"


def _problem(file: str, key: str, path: str, full: Path, kind: str) -> Problem | None:
    ending = full.suffix.lower()
    if ending not in ENDINGS[kind]:
        what = f"{path}: the hall shows no {ending or 'file without an ending'} as {kind}"
        return Problem(file, key, what, f"convert it to one of {', '.join(ENDINGS[kind])}")
    if not is_there(full):
        return None  # another check says so, or hall build has yet to make it
    fault = picture_fault(full) if kind == "picture" else _sound_fault(full, ending)
    return Problem(file, key, f"{path}: {fault[0]}", fault[1]) if fault else None


def _sound_fault(path: Path, ending: str) -> tuple[str, str] | None:
    """(what, fix) of a film or sound that does not begin as its container does."""
    try:
        with path.open("rb") as file:
            head = file.read(16)
    except OSError as error:
        return f"cannot be read ({error.strerror})", "check the file"
    if _begins(head, ending):
        return None
    return f"it is no {ending.removeprefix('.')} file", "export it again in that format, or correct its name"


def _begins(head: bytes, ending: str) -> bool:
    if ending == ".mp3":
        frame = len(head) > 1 and head[0] == 0xFF and head[1] & 0xE0 == 0xE0 and head[1] >> 1 & 3 == LAYER_3
        return head.startswith(b"ID3") or frame
    place, mark = MARKS[ending]
    return head[place:].startswith(mark) and (ending != ".wav" or head.startswith(b"RIFF"))
