"""Jammed setts: yarns that do not fit beside each other are refused before anything is solved."""

from math import sqrt

from sim_core.errors import WeaveError
from sim_core.weave.model import Weave

__all__ = ["check_jam", "jam_limits", "transition_spacing"]


def transition_spacing(weave: Weave) -> tuple[float, float]:
    """Room [m] that one change of side has, for the tightest pick (between ends) and the tightest end (between picks).

    A yarn that changes side t times in a repeat of n crossings has n spacings, of which n - t lie within floats and
    take one yarn width each; what remains is shared by the changes. The flat part of a flattened section (width -
    height) takes no part in the bend and is taken off too (Kemp's racetrack).
    """
    ends, picks = weave.draft.interlacings()
    between_ends = _room(
        weave.draft.ends, int(picks.max()), weave.end_spacing, weave.warp.width, weave.warp.height
    )
    between_picks = _room(
        weave.draft.picks, int(ends.max()), weave.pick_spacing, weave.weft.width, weave.weft.height
    )
    return between_ends, between_picks


def _room(count: int, changes: int, spacing: float, width: float, height: float) -> float:
    return (count * spacing - (count - changes) * width) / changes - (width - height)


def jam_limits(weave: Weave) -> tuple[float, float]:
    """The most ends and the most picks per metre that fit, each beside the other as the weave has it; 0 where none do.

    Peirce's condition solved for one room, see `check_jam`; no yarn is drawn closer than its own height.
    """
    rooms = transition_spacing(weave)
    thick = weave.warp.height + weave.weft.height
    ends, picks = weave.draft.interlacings()
    limits = []
    for other, count, changes, yarn in (
        (rooms[1], weave.draft.ends, int(picks.max()), weave.warp),
        (rooms[0], weave.draft.picks, int(ends.max()), weave.weft),
    ):
        if other <= 0:
            limits.append(0.0)
            continue
        left = 1 - sqrt(1 - min(other / thick, 1.0) ** 2)
        room = thick * sqrt(1 - left * left)
        closest = ((room + yarn.width - yarn.height) * changes + (count - changes) * yarn.width) / count
        limits.append(1 / max(closest, yarn.height))
    return limits[0], limits[1]


def check_jam(weave: Weave) -> None:
    """Raise WeaveError where the sett is jammed.

    Peirce's jamming condition over D = warp height + weft height: sqrt(1 - (p1/D)^2) + sqrt(1 - (p2/D)^2) <= 1 (for
    a square cloth p >= 0.866 D), with the room per change of side in place of p. And yarns of one system find room
    beside each other: no spacing is less than the height of the section, which then stands upright.
    """
    between_ends, between_picks = transition_spacing(weave)
    thick = weave.warp.height + weave.weft.height
    used = 0.0
    for room in (between_ends, between_picks):
        if room <= 0:
            used = 2.0
        elif room < thick:
            used += sqrt(1 - (room / thick) ** 2)
    upright = weave.end_spacing < weave.warp.height or weave.pick_spacing < weave.weft.height
    if used > 1 or upright:
        ends, picks = jam_limits(weave)
        fits = [
            f"at most {int(most)} {key} beside these {other}"
            for most, key, other in ((ends, "ends_per_m", "picks"), (picks, "picks_per_m", "ends"))
            if most >= 1
        ]
        raise WeaveError(
            f"weave {weave.name}: jammed – a change of side has {between_ends * 1e6:.0f} um between ends and "
            f"{between_picks * 1e6:.0f} um between picks, the yarns are {thick * 1e6:.0f} um thick together, and the "
            f"jam limit of a square sett is {sqrt(0.75) * thick * 1e6:.0f} um (0.866 D); "
            f"{', '.join(fits) or 'lower both setts'}, or take finer or less flattened yarns"
        )
