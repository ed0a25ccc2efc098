"""What the names on a pattern sheet say a line is: classes, layers and labels in the trade's words, AAMA/ASTM numbers.

AAMA-292 and ASTM D6673 number the layers of a pattern DXF; FreeSewing, Valentina and others name theirs.
"""

import re
from typing import Literal

__all__ = ["MATERIALS", "Role", "material_of", "role_of", "speaks", "spoken"]

Role = Literal["cut", "sew", "hole", "inner", "notch", "grain", "mark", "hidden", ""]

AAMA: dict[str, Role] = {
    "1": "cut", "2": "mark", "3": "mark", "4": "notch", "5": "mark", "6": "inner", "7": "grain", "8": "inner",
    "9": "mark", "10": "mark", "11": "hole", "12": "mark", "13": "mark", "14": "sew", "15": "mark",
    "80": "notch", "81": "notch", "82": "notch", "83": "notch", "84": "mark", "85": "mark", "86": "mark", "87": "mark",
}  # fmt: skip
MATERIALS = ("lining", "interfacing", "canvas", "interlining", "fabric", "various")
SAID: tuple[tuple[Role, str], ...] = (
    ("hidden", "hidden invisible"),
    ("notch", "notch notches bnotch passmark passmarks balance"),
    ("grain", "grain grainline grainlinefrom grainlineto"),
    (
        "mark",
        "note notes mark marks help logo scalebox grid title text label labels annotation annotations dimension",
    ),
    ("mark", "dimensions contrast guide guides hint button snap eyelet paperless gridline measurement arrow"),
    ("hole", "hole holes cutout cutouts buttonhole drill"),
    ("inner", "inner internal dart darts pleat pleats fold placement pocketplacement quilting"),
    ("cut", "cut cutting cutline sa allowance seamallowance boundary"),
    ("sew", "sew sewing sewline seam seamline stitch stitching stitchline"),
)

BESIDES = {"line", "lines", "layer", "ebene", "calque", "and", "the", "of", "pieces", "piece", "all", "main"}


def spoken(*names: str) -> tuple[str, ...]:
    """The words of names, lower case: "cutLine" and "cut-line" are "cut", "line", "cutline"."""
    found: list[str] = []
    for name in names:
        parts = re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|\d+|[^\W\d_]+", name)
        found += [part.lower() for part in parts] + ["".join(parts).lower()]
    return tuple(dict.fromkeys(found))


def role_of(layer: str, words: tuple[str, ...], *, numbered: bool) -> Role:
    """What a line is. layer: of its own.  words: `spoken` of its names.  numbered: layers are AAMA/ASTM numbers.

    Of FreeSewing's classes "fabric" (lining, …) is the sewing line, "fabric sa" the cutting line; a dashed one lies
    inside the piece.
    """
    if numbered and layer.strip() in AAMA:
        return AAMA[layer.strip()]
    for role, known in SAID:
        if any(word in words or f"{word}s" in words for word in known.split()):
            return role
    if any(word in words for word in MATERIALS):
        lined = any(word in words for word in ("dashed", "dotted", "lashed", "help"))
        return "inner" if lined else "sew"
    return ""


def material_of(words: tuple[str, ...]) -> str:
    """The material that names speak of ("fabric", "lining", …), or nothing."""
    return next((material for material in MATERIALS if material in words), "")


def speaks(name: str) -> bool:
    """Whether a name says what kind of line it is and nothing else, so it is no piece's: "Cut lines", "layer 2"."""
    parts = {part for part in spoken(name) if not part.isdigit()}
    known = {word for _, words in SAID for word in words.split()} | set(MATERIALS) | BESIDES
    known |= {f"{word}s" for word in known}
    return all(part in known or part in {a + b for a in known for b in known} for part in parts)
