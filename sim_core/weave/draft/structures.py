"""Weaves beyond a 0/1 matrix: leno, warp- and weft-faced compound, tapestry and brocade, each a Draft with channels."""

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.draft.draft import Channels, Draft, plain

__all__ = ["brocade", "four_end_gauze", "gauze", "tapestry", "warp_compound", "weft_compound"]

MAIN, INNER, EXTRA = 0, 1, 2
DOUP = 1


def gauze(pairs: int = 1) -> Draft:
    """纱, simple leno: a doup end crosses beneath its ground end after every pick."""
    if not 1 <= pairs <= 64:
        raise WeaveError(f"gauze: {pairs} pairs – give 1 to 64")
    lift = np.tile(np.array([[False, True], [False, True]]), (1, pairs))
    order = np.stack([np.arange(2 * pairs), np.arange(2 * pairs) ^ 1])
    series = np.tile([0, DOUP], pairs)
    return Draft("gauze", lift, Channels(end_series=series, order=order))


def four_end_gauze() -> Draft:
    """四经绞罗 without figure: doups cross their right and left neighbour by turns, so that no pair stands alone.

    Columns ground, doup, ground, doup. Picks 0 and 2: every doup stands right of the ground end of its own number;
    pick 1: left of it; pick 3: right of the next ground end. So each doup binds two ground ends, and each ground end
    is bound by two doups: a net, not strings.
    """
    lift = np.tile(np.array([[False, True]]), (4, 2))
    home = np.arange(4)
    order = np.stack([home, np.array([1, 0, 3, 2]), home, np.array([-1, 2, 1, 4])])
    return Draft("four-end gauze", lift, Channels(end_series=np.array([0, DOUP, 0, DOUP]), order=order))


def warp_compound(motif: np.ndarray, series: int, *, name: str = "warp compound") -> Draft:
    """经锦: every motif column is a unit of `series` ends, every motif row a binding pick and an inner pick.

    motif: (rows, units) int, the series that shows. On the inner pick the chosen end lies over, the others under the
    weft; on the binding pick all ends of a unit weave plain. Rows and units must be even for the plain weave to close.
    """
    chosen = _numbers(motif, series, name)
    rows, units = chosen.shape
    if rows % 2 or units % 2:
        raise WeaveError(f"{name}: a motif of {units} x {rows} – even numbers, so that the binding closes")
    which = np.tile(np.arange(series), units)
    unit = np.repeat(np.arange(units), series)
    lift = np.zeros((2 * rows, units * series), bool)
    lift[0::2] = (np.arange(rows)[:, None] + unit) % 2 == 0
    lift[1::2] = chosen[:, unit] == which
    shown = np.repeat(chosen[:, unit] == which, 2, axis=0)
    kinds = np.tile([MAIN, INNER], rows)
    order = np.tile(unit * series, (2 * rows, 1))  # ends of a unit lie over one another, in one place
    return Draft(
        name, lift, Channels(end_series=which, pick_kind=kinds, layer=np.where(shown, 0, 1), order=order)
    )


def weft_compound(motif: np.ndarray, series: int, *, name: str = "weft compound") -> Draft:
    """纬锦: the warp-faced compound turned by a right angle, inner ends between face and back wefts.

    motif: (units of picks, ends) int, the weft series that shows.
    """
    turned = warp_compound(np.asarray(motif).T, series, name=name)
    channels = turned.channels
    assert channels.end_series is not None
    assert channels.layer is not None
    return Draft(name, ~turned.lift.T, Channels(pick_series=channels.end_series, layer=channels.layer.T))


def tapestry(regions: np.ndarray, *, name: str = "tapestry") -> Draft:
    """缂丝: plain weave, each pick woven only as far as its colour goes; slits where two colours meet along an end.

    regions: (picks, ends) int >= 0, the number of the colour; picks and ends even.
    """
    colours = _numbers(regions, 1 << 12, name)
    if colours.shape[0] % 2 or colours.shape[1] % 2:
        raise WeaveError(
            f"{name}: {colours.shape[1]} x {colours.shape[0]} crossings – even numbers, for plain weave"
        )
    lift = np.indices(colours.shape).sum(axis=0) % 2 == 0
    return Draft(name, lift, Channels(region=colours))


def brocade(
    motif: np.ndarray,
    *,
    ground: Draft | None = None,
    every: int = 4,
    always: bool = False,
    name: str = "brocade",
) -> Draft:
    """妆花: after each pick of the ground an extra pick in colour, from the first to the last crossing of its figure.

    motif: (picks of the ground, ends) int, colour number, -1 where the ground shows.  every: within a figure each
    `every`-th end binds the extra weft, moved on by half of that from pick to pick.  Ground picks without figure get
    no extra pick, or `always` one that is nowhere; stretches of one or two crossings are left out. Where an extra pick
    is absent its lift is 1.
    """
    colours = np.array(motif)
    if colours.ndim != 2 or colours.size == 0 or colours.dtype.kind not in "iu" or colours.min() < -1:
        raise WeaveError(
            f"{name}: the motif has shape {colours.shape} – rows of whole numbers, -1 for the ground"
        )
    if not 2 <= every <= 32:
        raise WeaveError(f"{name}: bound every {every} ends – give 2 to 32")
    base = ground or plain()
    rows, columns = np.indices(colours.shape)
    under = base.lift[rows % base.picks, columns % base.ends]
    lines, regions, kinds = [], [], []
    for row, drawn in enumerate(colours):
        colour = _long_enough(drawn)
        lines.append(under[row])
        regions.append(np.zeros(colour.size, int))
        kinds.append(MAIN)
        if always or (colour >= 0).any():
            binding = (np.arange(colour.size) + (row % 2) * (every // 2)) % every == 0
            binding = _bound(colour, binding)
            lines.append((colour < 0) | binding)
            regions.append(np.where(colour < 0, -1, colour + 1))
            kinds.append(EXTRA)
    return Draft(name, np.array(lines), Channels(pick_kind=np.array(kinds), region=np.array(regions)))


def _runs(colour: np.ndarray) -> list[np.ndarray]:
    """Places of each stretch of one colour along a pick, round the border."""
    begins = np.flatnonzero(colour != np.roll(colour, 1))
    if not begins.size:
        return [np.arange(colour.size)]
    lengths = np.diff(np.append(begins, begins[0] + colour.size))
    return [(b + np.arange(n)) % colour.size for b, n in zip(begins, lengths, strict=True)]


def _long_enough(colour: np.ndarray) -> np.ndarray:
    """Stretches of one or two crossings left to the ground: no end could bind them and leave them to be seen."""
    colour = colour.copy()
    for run in _runs(colour.copy()):
        if len(run) < 3:
            colour[run] = -1
    return colour


def _bound(colour: np.ndarray, binding: np.ndarray) -> np.ndarray:
    """Binding points so that every stretch of colour is held by at least one end and shows at its own ends."""
    binding = binding.copy()
    for run in _runs(colour):
        if colour[run[0]] >= 0 and len(run) < colour.size:
            binding[run[[0, -1]]] = False
            if not binding[run].any():
                binding[run[len(run) // 2]] = True
    return binding


def _numbers(values: np.ndarray, most: int, name: str) -> np.ndarray:
    numbers = np.array(values)
    if numbers.ndim != 2 or numbers.size == 0 or numbers.dtype.kind not in "iub":
        raise WeaveError(f"{name}: the motif has shape {numbers.shape} – give rows of whole numbers")
    numbers = numbers.astype(int)
    if numbers.min() < 0 or numbers.max() >= most:
        raise WeaveError(f"{name}: the motif holds {numbers.max()} – numbers from 0 to {most - 1}")
    return numbers
