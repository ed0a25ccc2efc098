"""All of the hall's own media at once: music, drawings, the ready-made mirror."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hall_app.content.loading import read_table
from hall_app.content.problems import ContentError
from hall_app.content.schema.exhibit import ExhibitFile

if TYPE_CHECKING:
    from hall_app.media.drawings import Interlacing
    from sim_core.weave import Weave

Progress = Callable[[float, str], None]
QUALITY = 88  # of JPEG
DRAWN = ("beizi", "pibo")  # simulated exhibits with drawings and a piece of music


def make_media(folder: Path, progress: Progress = lambda fraction, label: None) -> None:
    """Write the media of hall, pibo and mirror into the content folder; the same bytes from the same sources.

    progress: called with a fraction 0..1 and a label. Raises ImportError without the extra `bake`.
    """
    steps: tuple[tuple[str, Callable[[Path], None]], ...] = (
        ("music of the hall", _hall_music),
        ("music of the scarf", _scarf_music),
        ("drawings of the weaves", _weaves),
        ("drawings of the patterns", _patterns),
        ("the mirror", _mirror),
    )
    for number, (label, step) in enumerate(steps):
        progress(number / len(steps), label)
        step(folder)
    progress(1.0, "media")


def _place(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def _hall_music(folder: Path) -> None:
    from hall_app.media.encode import write_sound
    from hall_app.media.music import hall_music

    sound = hall_music()
    for ending in (".webm", ".mp3"):
        write_sound(_place(folder / f"media/music{ending}"), sound)


def _scarf_music(folder: Path) -> None:
    """One piece for both garments: they hang in one hall."""
    from hall_app.media.encode import write_sound
    from hall_app.media.music import falling_gauze

    sound = falling_gauze()
    for exhibit in DRAWN:
        for ending in (".webm", ".mp3"):
            write_sound(_place(folder / f"exhibits/{exhibit}/media/listening{ending}"), sound)


def _weaves(folder: Path) -> None:
    from hall_app.media.drawings import weave_drawing
    from sim_core.garment import Pattern
    from sim_core.weave import Weave

    for exhibit in DRAWN:
        pattern, weave = (folder / path for path in _recipe(folder, exhibit))
        picture = weave_drawing(interlacing(Weave.load(weave), Pattern.load(pattern).dye))
        picture.save(_place(folder / f"exhibits/{exhibit}/media/weave.jpg"), quality=QUALITY)


def interlacing(weave: Weave, dye: tuple[float, float, float] | None = None) -> Interlacing:
    """What the drawing needs of a weave; `dye`: sRGB 0..1 of the dyed cloth, else the yarns' own colours."""
    from hall_app.media.drawings import Interlacing

    tones = [dye or yarn.colour for yarn in (weave.warp, weave.weft)]
    colours = ["#" + "".join(f"{round(255 * part):02x}" for part in tone) for tone in tones]
    return Interlacing(
        np.asarray(weave.draft.lift, bool),
        (weave.end_spacing, weave.pick_spacing),
        (weave.warp.width, weave.weft.width),
        (colours[0], colours[1]),
    )


def _patterns(folder: Path) -> None:
    from hall_app.media.cutting_plan import cutting_plan
    from hall_app.media.drawings import pattern_drawing
    from sim_core.garment import Pattern

    for exhibit in DRAWN:
        pattern = Pattern.load(folder / _recipe(folder, exhibit)[0])
        picture = cutting_plan(pattern) if pattern.panels else pattern_drawing([pattern.outline])
        picture.save(_place(folder / f"exhibits/{exhibit}/media/pattern.jpg"), quality=QUALITY)


def _recipe(folder: Path, exhibit: str) -> tuple[str, str]:
    """Pattern and weave files of a garment, relative to the content folder."""
    file, problems = read_table(folder, f"exhibits/{exhibit}/exhibit.toml", ExhibitFile)
    if file is None:
        raise ContentError(problems)
    assert file.garment is not None  # both are simulated
    return file.garment.pattern, file.garment.weave


def _mirror(folder: Path) -> None:
    from hall_app.media.drawings import mirror_drawing
    from hall_app.media.foreign import write_mirror

    home = folder / "exhibits/mirror/media"
    home.mkdir(parents=True, exist_ok=True)
    write_mirror(home)
    mirror_drawing().save(home / "drawing.jpg", quality=QUALITY)
