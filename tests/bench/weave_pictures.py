"""A picture of every shipped weave for the hall's pages: on the left its figure, on the right its yarns from near.

python tests/bench/weave_pictures.py [NAME …]      writes assets/weaves/NAME.jpg
python tests/bench/weave_pictures.py --marked NAME …    only writes the mark into pictures that are true to their files

The JPEG's comment is a mark of the files that the picture was drawn from; a test holds it against today's.
"""

import hashlib
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

from PIL import Image
from weave_sheet import FAR, FOLDER, LIGHTS, NEAR, swatch

from sim_core.weave import Weave, solve
from sim_core.weave.maps import FiguredMaps, drawn_maps, surface_maps

SIDE, GAP, QUALITY = 320, 6, 80
LAMP = LIGHTS[1]  # upper left


def picture_of(file: Path) -> Image.Image:
    """Two square pieces of the relaxed, lit cloth beside each other."""
    weave = Weave.load(file)
    geometry = solve(weave, particles=True)
    maps = drawn_maps(weave, geometry, pixels=1024)
    figured = weave.figure is not None or max(weave.draft.lift.shape) > 16
    shown = 1e3 * (min(weave.size) if weave.figure else max(weave.size)) if figured else FAR
    cell = maps.cells[-1] if isinstance(maps, FiguredMaps) else surface_maps(weave, geometry, pixels=1024)
    picture = Image.new("RGB", (2 * SIDE + GAP, SIDE), (246, 241, 230))
    picture.paste(swatch(maps, LAMP, shown, SIDE), (0, 0))
    picture.paste(swatch(cell, LAMP, NEAR, SIDE), (SIDE + GAP, 0))
    return picture


def mark_of(file: Path) -> str:
    """Digest of a weave file and of the motif files and drawings that it names."""
    hashed = hashlib.sha256()
    for path in dict.fromkeys(_named(file)):
        hashed.update(path.read_bytes())
    return f"drawn from {hashed.hexdigest()[:16]}"


def _named(file: Path) -> Iterator[Path]:
    """A weave or motif file, and the motif files and drawings that it names, in their order."""
    yield file
    if file.suffix != ".toml":
        return
    table = tomllib.loads(file.read_text("utf-8"))
    tables = [table.get("draft", {}), *table.get("part", [])]
    for name in [table.get("svg"), *(one.get("motif") for one in tables)]:
        if isinstance(name, str):
            yield from _named((file.parent / name).resolve())


def marked(picture: Path, mark: str) -> None:
    """Write the mark as the comment of a JPEG file, its pixels as they are."""
    given = picture.read_bytes()
    text = mark.encode()
    segment = b"\xff\xfe" + (len(text) + 2).to_bytes(2, "big") + text
    begin = 4 + int.from_bytes(given[4:6], "big")  # after the first segment, JFIF's
    picture.write_bytes(given[:begin] + segment + given[begin:])


def main(names: list[str]) -> int:
    only = names[:1] == ["--marked"]
    files = [FOLDER / f"{name}.toml" for name in names[only:]] or sorted(FOLDER.glob("*.toml"))
    for file in files:
        target = file.with_suffix(".jpg")
        if only:
            marked(target, mark_of(file))
            continue
        picture_of(file).save(target, quality=QUALITY, optimize=True, comment=mark_of(file))
        print(f"{target.name}: {target.stat().st_size / 1000:.0f} kB", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
