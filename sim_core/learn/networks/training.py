"""Training of the learned steps: sequences are followed in lanes, a few frames at a time, with what the network itself
said before as its past, so that it learns to live with its own errors.
"""

# pyright: reportMissingImports=false
# (torch is an extra)

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from sim_core.errors import SimCoreError
from sim_core.learn.data import Take
from sim_core.learn.inference import Ground, Settings
from sim_core.learn.inference.settings import PATCH
from sim_core.learn.networks.learned_steps import Glued, LearnedSteps
from sim_core.learn.networks.moment import Moment
from sim_core.learn.networks.pace import HEARD, rate_at, stepped
from sim_core.learn.networks.record import Record
from sim_core.learn.networks.sheets import Sheets
from sim_core.learn.upsampling import weighted_sums

__all__ = ["Schedule", "Told", "train"]

Told = Callable[[float, str], None]
SQUARES = 0.02  # the paper's c, in units of displacements
SOFT = 1e-6  # below which a distance counts squared
MEMORY = 0.995  # of the running mean of weights, which is what is kept
LOST = 50.0  # units off, from where on a lane begins elsewhere
FROM_TRUTH, FROM_FIRST = 0.5, 0.1  # of lanes that begin with what was, and at the first frame
STAY = 80  # frames that a lane follows a sequence, on average


@dataclass(frozen=True)
class Schedule:
    """updates of the weights in all; lanes followed side by side, window frames at a time; rate of learning; weights,
    against mean distance, of what edges' ends are off against each other, and of the vertices that are farthest off
    (the mean of distances to the eighth); seed."""

    updates: int = 4000
    lanes: int = 4
    window: int = 2
    rate: float = 2e-3
    decay: float = 1e-2
    edges: float = 1.0
    worst: float = 0.1
    seed: int = 0


class _Sequence:
    """One that is learned from. On a GPU all its frames are there from the begin on."""

    def __init__(self, take: Take, device: torch.device) -> None:
        film = take.film
        self.ground, self.frames = Ground.of(take.pair), len(film.fine)
        self.sheets = Sheets.of(self.ground, device)
        self._coarse = film.coarse
        places = film.coarse.astype(float)
        base = np.stack([weighted_sums(self.ground.pair.base, place) for place in places])
        self._truth = torch.from_numpy(((film.fine - base) / self.ground.unit).astype(np.float32)).to(device)
        self._ready: Moment | None = None
        if device.type != "cpu":
            moments = [Moment.of(self.ground, film.coarse, k) for k in range(self.frames)]
            self._ready = Moment.stacked(moments, device)

    def moment(self, frame: int) -> Moment:
        if self._ready is None:
            return Moment.of(self.ground, self._coarse, frame)
        return self._ready.row(frame)

    def turn(self, frame: int) -> Tensor:
        """Frames of coarse vertices."""
        return self.moment(frame).turn

    def truth(self, frame: int) -> Tensor:
        """Displacements (V, 3) from the base, in units."""
        return self._truth[frame]

    def was(self, frame: int) -> Tensor:
        """The patches (C, PATCH) of the frame before, as they are told in this one."""
        last, turn = (self.turn(k).cpu().numpy() for k in (frame - 1, frame))
        carried = self.ground.patches.carried(self.truth(frame - 1).cpu().numpy(), last, turn)
        return torch.from_numpy(self.ground.patches.fitted(carried, turn)).flatten(1).to(self._truth.device)


@dataclass
class _Lane:
    """Where a lane is: the sequence, the next frame, what was said of the last and in which frames, and the patches
    that were told then of the one before."""

    film: int
    frame: int
    said: Tensor  # (V, 3)
    turn: Tensor
    was: Tensor  # (C, PATCH)


class _Course:
    """The sequences, and the lanes over them."""

    def __init__(self, takes: Sequence[Take], schedule: Schedule, device: torch.device, told: Told) -> None:
        self.schedule, self.device, self.rng = schedule, device, np.random.default_rng(schedule.seed)
        self.sequences: list[_Sequence] = []
        for number, take in enumerate(takes):
            if (frames := len(take.film.fine)) <= schedule.window + 2:
                raise SimCoreError(f"{take.name}: {frames} frames – give more than {schedule.window + 2}")
            told(0.0, f"reads {take.name}, {number + 1} of {len(takes)}")
            self.sequences.append(_Sequence(take, device))
        self.lanes: list[_Lane | None] = [None] * schedule.lanes
        self.glued: Glued | None = None

    def begin(self) -> Glued:
        """Lanes that are done or lost begin elsewhere; the sheets they are on, glued."""
        rng, window = self.rng, self.schedule.window
        for number, lane in enumerate(self.lanes):
            if (
                lane is not None
                and lane.frame + window < self.sequences[lane.film].frames
                and rng.random() > window / STAY
            ):
                continue
            which = int(rng.integers(len(self.sequences)))
            sequence = self.sequences[which]
            frame = 0 if rng.random() < FROM_FIRST else int(rng.integers(0, sequence.frames - window))
            true = frame >= 2 and rng.random() < FROM_TRUTH
            said = sequence.truth(frame - 1) if true else torch.zeros_like(sequence.truth(0))
            turn = sequence.turn(max(frame - 1, 0))
            was = sequence.was(frame - 1) if true else torch.zeros((len(turn), PATCH), device=said.device)
            self.lanes[number] = _Lane(which, frame, said, turn, was)
            self.glued = None
        if self.glued is None:
            on = [self.sequences[lane.film] for lane in self._running()]
            self.glued = Glued([one.ground for one in on], [one.sheets for one in on])
        return self.glued

    def _running(self) -> list[_Lane]:
        return [lane for lane in self.lanes if lane is not None]

    def moment(self, ahead: int) -> tuple[Moment, Tensor]:
        """So many frames ahead of the lanes: what is given, and what is wanted."""
        places = [(self.sequences[lane.film], lane.frame + ahead) for lane in self._running()]
        given = Moment.glued([one.moment(frame) for one, frame in places])
        return given, torch.cat([one.truth(frame) for one, frame in places])

    def past(self) -> tuple[Tensor, Tensor, Tensor]:
        """What was said (V, 3), the frames it was said in, and the patches (C, PATCH) that were told then."""
        lanes = self._running()
        said, turn, was = (
            torch.cat([getattr(lane, name) for lane in lanes]) for name in ("said", "turn", "was")
        )
        return said, turn, was

    def told(self, mean: dict[str, Tensor]) -> dict[str, Any]:
        """For a record: the lanes, and the running mean."""
        lanes = [lane and (lane.film, lane.frame, lane.said, lane.turn, lane.was) for lane in self.lanes]
        return {"mean": mean, "lanes": lanes}

    def go_on(self, glued: Glued, said: Tensor, turn: Tensor, was: Tensor) -> None:
        """Every lane by a window, with what is `past` then; who is lost begins elsewhere."""
        far = torch.zeros(len(self.lanes), device=said.device)
        far = far.scatter_reduce(0, glued.which, said.abs().amax(1).nan_to_num(nan=LOST), "amax").tolist()
        for k, lane in enumerate(self.lanes):
            if lane is None or far[k] >= LOST:
                self.lanes[k] = None
                continue
            lane.frame += self.schedule.window
            lane.said = said[glued.fine[k] : glued.fine[k + 1]].clone()
            lane.turn, lane.was = (one[glued.coarse[k] : glued.coarse[k + 1]].clone() for one in (turn, was))


def train(
    takes: Sequence[Take],
    settings: Settings,
    schedule: Schedule,
    *,
    device: str = "cpu",
    record: Path | None = None,
    told: Told | None = None,
) -> dict[str, np.ndarray]:
    """Weights by the names of `Settings.shapes`, the running mean of those of the last updates.

    device: as torch names it; on a GPU sums have no fixed order, and the last bits of weights none either. record: a
    file that is written every minute, and gone on from where it is there: interrupted or not, the same weights come
    out. told(share, words): hears the loss. Raises SimCoreError for a record of other settings, and sequences too short
    for a window.
    """
    torch.manual_seed(schedule.seed)
    place, told = torch.device(device), told or (lambda share, words: None)
    course, network = _Course(takes, schedule, place, told), LearnedSteps(settings).to(place)
    flat = [value for value in network.parameters() if value.ndim < 2]
    deep = [value for value in network.parameters() if value.ndim > 1]
    optimiser = torch.optim.AdamW(
        [{"params": deep, "weight_decay": schedule.decay}, {"params": flat, "weight_decay": 0.0}],
        lr=schedule.rate,
        betas=(0.9, 0.98),
    )
    mean = {name: value.clone() for name, value in network.state_dict().items()}
    same = {
        "settings": asdict(settings),
        "schedule": asdict(schedule),
        "films": [take.told() for take in takes],
    }
    kept = Record(record, same) if record else None
    parts = {"network": network, "optimiser": optimiser}
    begin, more = kept.read(parts, course.rng, place) if kept else (0, None)
    if more is not None:
        mean.update(more["mean"])
        course.lanes = [lane and _Lane(*lane) for lane in more["lanes"]]
    losses: deque[Tensor] = deque(maxlen=HEARD)
    for update in range(begin, schedule.updates):
        rate = rate_at(update, schedule.updates, schedule.rate)
        losses.append(_update(network, optimiser, course, rate))
        stays = min(MEMORY, update / (update + 1))
        for name, value in network.state_dict().items():
            mean[name].mul_(stays).add_(value, alpha=1.0 - stays)
        if update % 20 == 0:
            told(update / schedule.updates, f"{torch.stack(list(losses)).mean():.4f}")
        if kept:
            kept.write(update + 1, parts, course.rng, course.told(mean))
    if kept:
        kept.write(schedule.updates, parts, course.rng, course.told(mean), now=True)
    return {name: value.cpu().numpy().copy() for name, value in mean.items()}


def _update(network: LearnedSteps, optimiser: torch.optim.Optimizer, course: _Course, rate: float) -> Tensor:
    """One window of all lanes, and one update; the mean distance from what was wanted, in units."""
    glued, schedule = course.begin(), course.schedule
    now, turn, was = course.past()
    total = off = torch.zeros((), device=now.device)
    for ahead in range(schedule.window):
        moment, wanted = course.moment(ahead)
        last = glued.at.carried(now, turn, moment.turn)
        now, was = network(glued, moment, last, was)
        turn, errors = moment.turn, now - wanted
        squares = errors.square().sum(1)
        distance = (squares + SOFT).sqrt().mean()
        total = total + distance + SQUARES * squares.mean() + schedule.edges * glued.at.edge_gap(errors)
        if schedule.worst:
            total = total + schedule.worst * _worst(squares, glued)
        off = off + distance.detach() / schedule.window
    stepped(network, optimiser, total / schedule.window, rate)
    course.go_on(glued, now.detach(), turn, was.detach())
    return off


def _worst(squares: Tensor, glued: Glued) -> Tensor:
    """The mean over sheets of the mean to the eighth of distances, whose squares are given."""
    count = len(glued.fine) - 1
    sums = torch.zeros(count, device=squares.device).index_add(0, glued.which, squares.square().square())
    size = torch.tensor(np.diff(glued.fine), dtype=torch.float32, device=squares.device)
    return ((sums / size + SOFT) ** 0.125).mean()
