"""All of the hall's own media at once: music, drawings, the ready-made mirror."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hall_app.content.files import SHEET, exhibit_files
from hall_app.content.loading import read_table
from hall_app.content.problems import ContentError
from hall_app.content.schema.exhibit import ExhibitFile

if TYPE_CHECKING:
    from PIL.Image import Image

    from hall_app.media.cutting_plan import Plan
    from hall_app.media.drawings import View
    from sim_core.weave import Weave

Progress = Callable[[float, str], None]
QUALITY = 88  # of JPEG
NEAR = 0.0024  # [m] of a cloth whose yarns are seen
# What is made for each exhibit with an outfit that names it, inside its folder.
LISTENING = ("media/listening.webm", "media/listening.mp3")
WEAVE, PATTERN = "media/weave.jpg", "media/pattern.jpg"


def make_media(folder: Path, progress: Progress = lambda fraction, label: None) -> None:
    """Write the media of hall, garments and mirror into the content folder; the same bytes from the same sources.

    progress: called with a fraction 0..1 and a label. Raises ImportError without PyAV.
    """
    steps: tuple[tuple[str, Callable[[Path], None]], ...] = (
        ("music of the hall", _hall_music),
        ("music of the garments", _exhibits_music),
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


def _exhibits_music(folder: Path) -> None:
    """One piece for all garments: they hang in one hall."""
    from hall_app.media.encode import write_sound
    from hall_app.media.music import falling_gauze

    sound = falling_gauze()
    for home, _ in _dressed(folder):
        for path in _named(home, LISTENING):
            write_sound(_place(path), sound)


def _weaves(folder: Path) -> None:
    from hall_app.media.drawings import weave_drawing
    from sim_core.garment import load_outfit

    for home, outfit in _dressed(folder):
        for path in _named(home, (WEAVE,)):
            layer = load_outfit(folder / outfit, folder).layers[-1]
            picture = weave_drawing(*weave_views(layer.weave, layer.pattern.dye))
            picture.save(_place(path), quality=QUALITY)


def weave_views(
    weave: Weave, dye: tuple[float, float, float] | None = None
) -> tuple[np.ndarray, tuple[View, ...]]:
    """Lift of a weave, of a figured one its ground's, and how it looks: its yarns, and the whole of a figure.

    dye: sRGB 0..1 of the dyed cloth, else the yarns' own colours, which a cloth woven of several keeps.
    """
    from PIL import Image

    from hall_app.media.drawings import View
    from sim_core.weave import lit_cloth, solve
    from sim_core.weave.maps import FiguredMaps, drawn_maps, surface_maps
    from sim_core.weave.yarns import ground_of

    if dye is not None and not weave.several:
        weave = dyed(weave, dye)
    geometry = solve(weave)
    maps = drawn_maps(weave, geometry, pixels=1024)
    figured = isinstance(maps, FiguredMaps)
    near = maps.cells[0] if figured else surface_maps(weave, geometry, pixels=1024)
    views = [View(_piece(Image.fromarray(lit_cloth(near)), near.size, NEAR), NEAR)]
    if figured:
        across = max(maps.size)
        views.append(View(_piece(Image.fromarray(lit_cloth(maps)), maps.size, across), across))
    return np.asarray(ground_of(weave.cells[0]).draft.lift, bool), tuple(views)


def dyed(weave: Weave, dye: tuple[float, float, float]) -> Weave:
    """The weave in a colour of which its yarns are lighter and darker as they were."""
    from dataclasses import replace

    own = np.array([weave.warp.colour, weave.weft.colour])
    shades = np.clip(np.asarray(dye) * own / np.maximum(own.mean(axis=0), 1e-3), 0, 1).tolist()
    warp, weft = (
        replace(yarn, colour=tuple(shade))
        for yarn, shade in zip((weave.warp, weave.weft), shades, strict=True)
    )
    return replace(weave, warp=warp, weft=weft, warp_colours=(), weft_colours=())


def _piece(tile: Image, size: tuple[float, float], across: float) -> Image:
    """A square so wide of a cloth whose tile has a size [m], in true proportion, the first pick lowest."""
    from PIL import Image as Pillow

    pixels = 1440
    kept = [min(1.0, across / side) for side in size]  # the lower left corner
    tile = tile.crop((0, round(tile.height * (1 - kept[1])), round(tile.width * kept[0]), tile.height))
    size = (size[0] * kept[0], size[1] * kept[1])
    wide, high = (max(1, round(pixels * side / across)) for side in size)
    small = tile.resize((wide, high), Pillow.Resampling.LANCZOS)
    made = Pillow.new("RGB", (pixels, pixels))
    for x in range(0, pixels, wide):
        for y in range(pixels - high, -high, -high):
            made.paste(small, (x, y))
    return made


def _patterns(folder: Path) -> None:
    from hall_app.media.cutting_sheet import plan_picture

    for home, outfit in _dressed(folder):
        for path in _named(home, (PATTERN,)):
            plan_picture(outfit_plan(folder, outfit)).save(_place(path), quality=QUALITY)


def outfit_plan(folder: Path, outfit: str) -> Plan:
    """The flat pattern of an outfit, all its layers; raises what reading it raises, naming file, key and remedy."""
    from hall_app.media.cutting_plan import cutting_plan
    from sim_core.garment import load_outfit

    worn = load_outfit(folder / outfit, folder)
    zh, en = (worn.title.get(language, worn.name) for language in ("zh", "en"))
    return cutting_plan([layer.pattern for layer in worn.layers], (zh, en))


def write_pattern_sheet(folder: Path, identity: str, outfit: str) -> Path:
    """Write the outfit's flat pattern as SVG into the exhibit's media folder; returns where it lies."""
    from hall_app.media.cutting_sheet import plan_svg

    path = _place(folder / "exhibits" / identity / SHEET)
    path.write_text(plan_svg(outfit_plan(folder, outfit)), "utf-8")
    return path


def _dressed(folder: Path) -> Iterator[tuple[Path, str]]:
    """(folder, outfit file) of every exhibit that is dressed. Raises ContentError for one that cannot be read."""
    for home in sorted(path.parent for path in folder.glob("exhibits/*/exhibit.toml")):
        file = _file(folder, home.name)
        if file.outfit is not None:
            yield home, file.outfit


def _named(home: Path, wanted: Sequence[str]) -> Iterator[Path]:
    """Those of the `wanted` files that the exhibit in `home` names."""
    named = {path for _, path in exhibit_files(_file(home.parents[1], home.name))}
    return (home / path for path in wanted if path in named)


def _file(folder: Path, identity: str) -> ExhibitFile:
    file, problems = read_table(folder, f"exhibits/{identity}/exhibit.toml", ExhibitFile)
    if file is None:
        raise ContentError(problems)
    return file


def _mirror(folder: Path) -> None:
    from hall_app.media.drawings import mirror_drawing
    from hall_app.media.foreign import write_mirror

    home = folder / "exhibits/mirror/media"
    home.mkdir(parents=True, exist_ok=True)
    write_mirror(home)
    mirror_drawing().save(home / "drawing.jpg", quality=QUALITY)
