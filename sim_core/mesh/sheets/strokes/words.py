"""What the names on a pattern sheet say a line is: classes, layers and labels in the trade's words, AAMA/ASTM numbers.

AAMA-292 and ASTM D6673 number the layers of a pattern DXF; FreeSewing, Valentina and others name theirs.
"""

import re
from functools import cache
from itertools import pairwise
from typing import Literal

__all__ = [
    "MATERIALS", "NEVER_CLOSED", "Role", "furnishes", "layer_name", "material_of", "names_piece", "role_of", "speaks",
    "spoken",
]  # fmt: skip

Role = Literal["cut", "sew", "hole", "inner", "notch", "grain", "fold", "mark", "hidden", ""]

AAMA: dict[str, Role] = {
    "1": "cut", "2": "mark", "3": "mark", "4": "notch", "5": "mark", "6": "fold", "7": "grain", "8": "inner",
    "9": "mark", "10": "mark", "11": "hole", "12": "mark", "13": "mark", "14": "sew", "15": "mark",
    "80": "notch", "81": "notch", "82": "notch", "83": "notch", "84": "mark", "85": "mark", "86": "mark", "87": "mark",
}  # fmt: skip
AAMA_MARKS = {
    "2": "turn points", "3": "curve points", "5": "grade references", "9": "stripes", "10": "plaids",
    "13": "drill holes", "15": "annotation", "84": "quality curves",
    "85": "quality curves", "86": "quality curves", "87": "quality curves",
}  # fmt: skip
NEVER_CLOSED = {"2", "3", "4", "7"}  # of those, layers that hold points and open lines
MATERIALS = ("lining", "interfacing", "canvas", "interlining", "fabric", "various")
SAID: tuple[tuple[Role, str], ...] = (
    ("hidden", "hidden invisible"),
    ("notch", "notch notches bnotch passmark passmarks balance"),
    ("grain", "grain grainline grainlinefrom grainlineto"),
    ("fold", "cutonfold onfold mirror mirrorline"),
    (
        "mark",
        "note notes mark marks help logo scalebox grid title text label labels annotation annotations dimension",
    ),
    (
        "mark",
        "dimensions contrast guide guides hint button snap eyelet paperless gridline measurement arrow",
    ),
    ("hole", "hole holes cutout cutouts buttonhole drill"),
    ("inner", "inner internal dart darts pleat pleats fold placement pocketplacement quilting"),
    ("cut", "cut cutting cutline sa allowance seamallowance boundary"),
    ("sew", "sew sewing sewline seam seamline stitch stitching stitchline"),
)
CHINESE: tuple[tuple[Role, str], ...] = (  # parts of words, since nothing stands between those
    ("notch", "刀口 剪口 对位"),
    ("grain", "纱向 布纹 经向 丝缕"),
    ("fold", "对折 连折 对称线"),
    ("mark", "标注 文字 说明 钻孔"),
    ("hole", "挖空 镂空 扣眼"),
    ("inner", "内线 内部 省道 褶 折线"),
    ("cut", "毛样 毛缝 毛边 裁剪 裁切 裁线 外轮廓"),
    ("sew", "净样 净缝 净边 缝线 缝合 缝纫"),
)

BESIDES = set(
    "line lines layer ebene calque and the of pieces piece all main dashed dotted lashed solid thin thick stroke fill "
    "black white red blue green grey gray mm cm".split()
)
# What belongs to the sheet and to no piece, two words or run together.
FURNITURE = frozenset(
    first + second
    for firsts, seconds in (
        (
            "scale test gauge calibration control check print printing",
            "box boxes square squares rectangle rect bar ruler",
        ),
        (
            "page sheet paper drawing print",
            "border borders frame frames edge edges margin margins area outline",
        ),
        ("title", "block box"),
        ("crop registration", "mark marks"),
        ("water", "mark marks"),
        ("copy", "right"),
        ("art", "board"),
    )
    for first in firsts.split()
    for second in seconds.split()
) | {"legend"}
SHEETS = ("图框", "边框", "水印", "图例", "比例", "测试方", "标题栏")
SHORTEST = 3  # letters of a word that may be a piece's


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
    if furnishes(words):
        return "mark"
    if numbered and layer.strip() in AAMA:
        return AAMA[layer.strip()]
    for role, known in SAID:
        if any(word in words or f"{word}s" in words for word in known.split()):
            return role
    for role, known in CHINESE:
        if any(part in word for part in known.split() for word in words):
            return role
    if any(word in words for word in MATERIALS):
        lined = any(word in words for word in ("dashed", "dotted", "lashed", "help"))
        return "inner" if lined else "sew"
    return ""


def material_of(words: tuple[str, ...]) -> str:
    """The material that names speak of ("fabric", "lining", …), or nothing."""
    return next((material for material in MATERIALS if material in words), "")


def layer_name(layer: str, *, numbered: bool) -> str:
    """A layer as it is told to people: AAMA/ASTM numbers with what they stand for."""
    stands = AAMA_MARKS.get(layer.strip()) if numbered else None
    return f"on layer {layer.strip()} ({stands})" if stands else layer


@cache
def _kinds() -> frozenset[str]:
    """Words for kinds of lines, and any two of them run together."""
    known = {word for _, words in SAID for word in words.split()} | set(MATERIALS) | BESIDES
    known |= {f"{word}s" for word in known}
    return frozenset(known | {a + b for a in known for b in known})


def speaks(name: str) -> bool:
    """Whether a name says what kind of line it is and nothing else, so it is no piece's: "Cut lines", "layer 2"."""
    words = spoken(name)
    if furnishes(words):
        return True
    parts = {part for part in words if not part.isdigit()}
    return all(part in _kinds() or _chinese_kind(part) for part in parts)


def furnishes(words: tuple[str, ...]) -> bool:
    """Whether `spoken` words name what belongs to the sheet: a test square, a page's border, a watermark."""
    if any(word in FURNITURE for word in words) or any(a + b in FURNITURE for a, b in pairwise(words)):
        return True
    return any(part in word for part in SHEETS for word in words)


def names_piece(layer: str) -> bool:
    """Whether the word that a layer ends with is none for a kind of line: "BUTTON PLACKET" is a placket, no button."""
    parts = [part.lower() for part in re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])", layer)]
    return bool(parts) and len(parts[-1]) >= SHORTEST and parts[-1] not in _kinds()


def _chinese_kind(part: str) -> bool:
    return any(word in part for _, words in CHINESE for word in words.split())
