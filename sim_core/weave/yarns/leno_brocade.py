"""Heights beyond the grid of crossings: leno ends that cross each other, extra wefts laid on a ground."""

from __future__ import annotations

import numpy as np
from scipy.optimize import nnls

from sim_core.errors import WeaveError
from sim_core.weave.model import Weave
from sim_core.weave.yarns.beams import beam_stiffness
from sim_core.weave.yarns.geometry import Strands
from sim_core.weave.yarns.splines import resampled

__all__ = ["brocade_heights", "lay_beams", "leno_paths", "leno_rest"]

SET_OUT, MISSING = 20, 1e-6  # rounds, and overlap in yarn heights that is left
MOST_CROSSINGS = 512  # of the repeat of a leno, whose contacts are solved densely


def leno_paths(weave: Weave, per: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Paths of a leno: warp side, warp height (ends, picks * per) and weft side, weft height (picks, ends * per) [m].

    Heights: beams over the picks and over the places midway where two ends cross, with the doup below; the least
    bending energy under all these contacts at once. Sideways: where two ends cross before and after a pick they lie
    close together, width beside width; where the partners differ, midway.
    """
    warp, weft, _, _ = leno_rest(weave)
    fz = resampled(weft, per)
    return _leno_side(weave, _crossings(weave.draft), per), resampled(warp, per // 2), np.zeros_like(fz), fz


def leno_rest(weave: Weave) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Heights of a leno: warp (ends, 2 picks) [m] at picks and midway, weft (picks, ends) [m]; force (picks, ends) [N]
    that presses at each crossing; largest net force / largest contact force.

    Raises WeaveError for a repeat of more crossings than the dense problem can hold.
    """
    draft = weave.draft
    picks, ends = draft.lift.shape
    if picks * ends > MOST_CROSSINGS:
        raise WeaveError(
            f"weave {weave.name}: a leno of {ends} ends x {picks} picks – give a repeat of at most {MOST_CROSSINGS} "
            "crossings"
        )
    pairs = _crossings(draft)
    p1, p2 = weave.end_spacing, weave.pick_spacing
    warp_k = _circulant(beam_stiffness(2 * picks, p2 / 2, weave.warp.stiffness, weave.warp.tension))
    weft_k = _circulant(beam_stiffness(ends, p1, weave.weft.stiffness, weave.weft.tension))
    size = 2 * picks * ends + picks * ends
    stiff = np.zeros((size, size))
    for j in range(ends):
        rows = np.arange(2 * picks) * ends + j
        stiff[np.ix_(rows, rows)] += warp_k
    for i in range(picks):
        rows = 2 * picks * ends + i * ends + np.arange(ends)
        stiff[np.ix_(rows, rows)] += weft_k
    unit = float(np.abs(stiff).max())
    rows, gaps = [], []
    for i in range(picks):
        for j in range(ends):
            row = np.zeros(size)
            sign = 1.0 if draft.lift[i, j] else -1.0
            row[2 * i * ends + j], row[2 * picks * ends + i * ends + j] = sign, -sign
            rows.append(row)
            gaps.append((weave.warp.height + weave.weft.height) / 2)
        for doup, other, _ in pairs[i]:
            row = np.zeros(size)
            row[(2 * i + 1) * ends + other], row[(2 * i + 1) * ends + doup] = 1.0, -1.0
            rows.append(row)
            gaps.append(weave.warp.height)
    contacts = np.array(rows)
    z, force = _least_energy(stiff / unit, contacts, np.array(gaps))
    net = np.abs(stiff / unit @ z - contacts.T @ force).max() / max(force.max(), 1e-300)
    warp = z[: 2 * picks * ends].reshape(2 * picks, ends).T
    weft = z[2 * picks * ends :].reshape(picks, ends)
    at_picks = np.array([i * ends + sum(map(len, pairs[:i])) for i in range(picks)])
    return warp, weft, force[at_picks[:, None] + np.arange(ends)] * unit, float(net)


def _least_energy(stiff: np.ndarray, rows: np.ndarray, gaps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """z and contact forces of min 1/2 z K z with rows z >= gaps, by non-negative least squares on the forces."""
    inverse = np.linalg.inv(stiff + 1e-7 * np.eye(len(stiff)))
    answer = rows @ inverse @ rows.T
    scale, thick = float(np.abs(answer).max()), float(gaps.max())
    root = np.linalg.cholesky(answer / scale + 1e-10 * np.eye(len(answer))).T
    wanted = gaps.copy()
    for _ in range(SET_OUT):
        force, _ = nnls(root, np.linalg.solve(root.T, wanted / thick), maxiter=10_000)
        force = force * thick / scale
        z = inverse @ rows.T @ force
        missing = np.where(force > 0, gaps - rows @ z, 0.0)
        if np.abs(missing).max() <= MISSING * thick:
            break
        wanted += missing  # what makes the matrix regular lets contacts overlap: they are set out by as much
    return z, force


def _crossings(draft) -> list[list[tuple[int, int, int]]]:
    """For each pick: (doup, other, shift in ends) of the ends that change places before the next pick."""
    order, series = draft.channels.order, draft.channels.end_series
    following = np.roll(order, -1, axis=0)
    found = []
    for i in range(draft.picks):
        here = []
        for doup in np.flatnonzero(series == 1):
            for other in np.flatnonzero(series != 1):
                for shift in (-draft.ends, 0, draft.ends):
                    before = order[i, doup] - order[i, other] - shift
                    if before * (following[i, doup] - following[i, other] - shift) < 0:
                        here.append((int(doup), int(other), shift))
        found.append(here)
    return found


def _leno_side(weave: Weave, pairs, per: int) -> np.ndarray:
    """(ends, picks * per) [m] from each end's own column."""
    draft = weave.draft
    order = draft.channels.order
    assert order is not None
    half = 0.5 * weave.warp.width / weave.end_spacing
    at = np.zeros((draft.picks, draft.ends))
    for i in range(draft.picks):
        for end in range(draft.ends):
            pulled = []
            for partners in (pairs[i - 1], pairs[i]):
                for doup, other, shift in partners:
                    if end == doup:
                        pulled.append((order[i, doup] + order[i, other] + shift) / 2 + half * np.sign(
                            order[i, doup] - order[i, other] - shift))  # fmt: skip
                    elif end == other:
                        pulled.append((order[i, doup] - shift + order[i, other]) / 2 + half * np.sign(
                            order[i, other] + shift - order[i, doup]))  # fmt: skip
            at[i, end] = np.mean(pulled) if pulled else order[i, end]
    side = (at - np.arange(draft.ends)).T * weave.end_spacing
    t = np.arange(per) / per
    ease = t * t * (3 - 2 * t)
    return (side[..., None] * (1 - ease) + np.roll(side, -1, axis=1)[..., None] * ease).reshape(
        draft.ends, -1
    )


def brocade_heights(weave: Weave, warp: Strands, extra: np.ndarray, at: np.ndarray, per: int) -> np.ndarray:
    """Heights (extra picks, ends * per) [m] of extra wefts laid as beams over the ends, under the binding ones.

    warp: the relaxed ends.  at: (extra picks,) [m] where each lies along the warp. The ground does not give way.
    """
    yarn = weave.extra
    assert yarn is not None
    n = warp.side.shape[1]
    sample = np.rint(at / warp.length * n).astype(int) % n
    axis = warp.height[:, sample].T  # (extra picks, ends)
    bound = weave.draft.lift[extra]
    gone = (
        weave.draft.channels.region[extra] < 0
        if weave.draft.channels.region is not None
        else np.zeros_like(bound)
    )
    gap = (weave.warp.height + yarn.height) / 2
    # a binding end is drawn up by the extra weft as far as the weft is pressed down by it: half way each
    limit = np.where(bound, axis - 0.5 * gap, axis + gap)
    sign = np.where(
        gone, 2.0, np.where(bound, -1.0, 1.0)
    )  # where it is not, it may lie anywhere: in the cloth
    limit = np.where(gone, axis, limit)
    z = lay_beams(
        beam_stiffness(weave.draft.ends, weave.end_spacing, yarn.stiffness, yarn.tension), sign, limit
    )
    return resampled(z, per)


def lay_beams(stiffness: np.ndarray, sign: np.ndarray, limit: np.ndarray, steps: int = 400) -> np.ndarray:
    """Periodic beams on rigid obstacles: heights (beams, n) [m] of least energy on or under limits.

    stiffness: (n,) [N/m] per mode.  sign: (beams, n) +1 obstacle below, -1 above, 2 held at the limit.
    limit: (beams, n) [m].
    """
    scale = max(float(np.abs(limit).max()), 1e-12)
    goal, positive = limit / scale, stiffness[stiffness > 0]
    rho = float(np.sqrt(positive.min() * positive.max())) if positive.size else 1.0
    filtered = rho / (rho + stiffness)
    z, dual = goal.copy(), np.zeros_like(goal)
    for _ in range(steps):
        free = np.fft.ifft(filtered * np.fft.fft(z - dual, axis=1), axis=1).real
        wanted = free + dual
        z = np.where(
            sign == 1, np.maximum(wanted, goal), np.where(sign == -1, np.minimum(wanted, goal), goal)
        )
        dual = wanted - z
    return z * scale


def _circulant(stiffness: np.ndarray) -> np.ndarray:
    first = np.fft.ifft(stiffness).real
    return np.array([np.roll(first, k) for k in range(first.size)])
