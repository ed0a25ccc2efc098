"""Backdrops: does dress stand out against the cloth behind it?"""

from __future__ import annotations

from hall_app.content.folder import Content, Exhibit
from hall_app.content.models.colours import difference, hex_of, main_colour
from hall_app.content.problems import Problem
from hall_app.content.schema.plan import Solid
from hall_app.room.surface.palette import BACKDROPS, linear

LEAST = 40.0  # ΔE76: what is nearer sinks into the backdrop


def backdrop_problems(content: Content) -> list[Problem]:
    """Exhibits whose main colour is too near that of their booth's backdrop."""
    solids = {solid.id: solid for solid in content.plan.solid if solid.backdrop != "none"}
    found = []
    for exhibit in content.exhibits:
        solid = solids.get(exhibit.file.place.on or "")
        if solid is not None:
            found += _against(exhibit, solid)
    return found


def _against(exhibit: Exhibit, solid: Solid) -> list[Problem]:
    path = exhibit.model_path("hall")
    try:
        colour = main_colour(path) if path is not None else None
    except Exception:  # a foreign file may fail in any way; another check names the fault
        return []
    if colour is None:
        return []
    away = {name: difference(colour, linear(value)) for name, value in BACKDROPS.items()}
    if away[solid.backdrop] >= LEAST:
        return []
    other = max(away, key=lambda name: away[name])
    what = (
        f"its main colour {hex_of(colour)} is too near the {solid.backdrop} backdrop of {solid.id!r}"
        f" (ΔE {away[solid.backdrop]:.0f}, at least {LEAST:.0f})"
    )
    if away[other] >= LEAST:
        fix = (
            f'write backdrop = "{other}" (ΔE {away[other]:.0f}) for {solid.id!r}, or move it to such a booth'
        )
    else:
        fix = f"change its dye or its booth: the {other} backdrop would not do either (ΔE {away[other]:.0f})"
    return [Problem(exhibit.toml, "place.on", what, fix)]
