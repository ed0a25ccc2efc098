"""Sizes of one piece in one drawing: layers named after them, and outlines that lie in each other as copies."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable

from sim_core.mesh.sheets.pieces.contours import Contour, seam_inside

__all__ = ["graded_apart", "size_layers", "size_of"]

LETTERS = r"(?:\d{1,2}x|x{0,5})[sl]|m"
SIZE = re.compile(
    rf"(?:sizes?|gr(?:ö|oe)(?:ß|ss)e|taille|talla|taglia|us|uk|号型|尺码)[\s_.-]*(\d{{1,3}}|{LETTERS})|({LETTERS})"
    r"|(?:gr|t|eu)[\s_.-]*(\d{2,3})|(\d{3}[/ -]\d{2,3}[abcy]?)|([345][02468]|[小中大](?:号|码))",
    re.IGNORECASE,
)
PARTS = re.compile(r"[\s_.-]+")
COPY = 0.6  # least of the area around it that a smaller size has
SHOWN = 8  # layers in a remark
FEWEST = 3  # outlines in each other that no cutting and sewing line explain


def size_of(name: str) -> str:
    """The size that a name is and nothing else ("M", "size 38", "165/88A"), upper case, or nothing."""
    found = SIZE.fullmatch(name.strip())
    return next(filter(None, found.groups()), "").upper() if found else ""


def size_layers(layers: Iterable[str]) -> dict[str, str]:
    """Of layers that differ in nothing but a size at their beginning or end, the size of each: "Cut M", "Cut L"."""
    found: dict[str, tuple[str, str]] = {}
    for layer in set(layers):
        parts = PARTS.split(layer.strip())
        for count in (2, 1):  # "size 38", "38"
            for rest, named in ((parts[:-count], parts[-count:]), (parts[count:], parts[:count])):
                if layer not in found and len(parts) >= count and (size := size_of(" ".join(named))):
                    found[layer] = (" ".join(rest).lower(), size)
    sizes: dict[str, set[str]] = {}
    for stem, size in found.values():
        sizes.setdefault(stem, set()).add(size)
    many = set().union(*(some for some in sizes.values() if len(some) > 1))
    return {layer: size for layer, (_, size) in found.items() if size in many}


def graded_apart(outermost: list[Contour], remarks: list[str]) -> list[Contour]:
    """Outlines that lie in each other, each a little smaller, as pieces of their own: no cutting and sewing line
    explain three of them, or two on two layers that do not run along each other. Holes, inner lines and what says it
    is a seam stay with the innermost around them."""
    kept: list[Contour] = []
    for contour in outermost:
        chain = [contour]
        while (inner := _copy_in(chain[-1])) is not None:
            chain.append(inner)
        layers = Counter(each.stroke.layer for each in chain)
        two = len(chain) == len(layers) == FEWEST - 1 and seam_inside(contour) is None
        if len(chain) < FEWEST and not two:
            kept.append(contour)
            continue
        for outer, inner in zip(chain, chain[1:], strict=False):
            outer.inside = [other for other in outer.inside if other is not inner]
        if len(layers) == len(chain):
            for each in chain:
                each.size = each.size or each.stroke.layer
        kept += chain
        where = f"on layers {listed(layers)} " if len(layers) > 1 else ""
        remarks.append(f"{len(chain)} outlines {where}lie in each other – taken for sizes of one piece")
    return kept


def listed(layers: Iterable[str]) -> str:
    """The first few of many layers."""
    names = [layer or "none" for layer in layers]
    return ", ".join(names[:SHOWN]) + (", …" if len(names) > SHOWN else "")


def _copy_in(contour: Contour) -> Contour | None:
    """The outline right inside another that may be its next size."""
    for inner in contour.inside:
        same = inner.role == contour.role and inner.role in ("", "cut", "sew") and not inner.stroke.dashed
        if same and inner.area > COPY * contour.area:
            return inner
    return None
