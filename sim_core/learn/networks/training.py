"""Training of the learned steps: sequences are followed in lanes, a few frames at a time, with what the network itself
said before as its past, so that it learns to live with its own errors.
"""

# pyright: reportMissingImports=false
# (torch is an extra)

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from sim_core.errors import SimCoreError
from sim_core.learn.data import Film, Recipe
from sim_core.learn.inference import Ground, Settings
from sim_core.learn.networks.learned_steps import Glued, LearnedSteps, Moment
from sim_core.learn.networks.operators import EdgeGap

__all__ = ["Schedule", "Told", "train"]

Told = Callable[[float, str], None]
SQUARES = 0.02  # the paper's c, in units of displacements
SOFT = 1e-6  # below which a distance counts squared
MEMORY = 0.995  # of the running mean of weights, which is what is kept
WARM = 100  # updates until the rate is whole
CLIPPED = 1.0  # length of a gradient
LOST = 50.0  # units off, from where on a lane begins elsewhere
FROM_TRUTH, FROM_FIRST = 0.5, 0.1  # of lanes that begin with what was, and at the first frame
STAY = 80  # frames that a lane follows a sequence, on average
BETWEEN = 60.0  # [s] between two records


@dataclass(frozen=True)
class Schedule:
    """updates of the weights in all; lanes followed side by side, window frames at a time; rate of learning; seed."""

    updates: int = 4000
    lanes: int = 4
    window: int = 2
    rate: float = 2e-3
    decay: float = 1e-2
    edges: float = 1.0  # weight of what edges' ends are off against each other
    seed: int = 0


@dataclass
class _Lane:
    """Where a lane is: the sequence, the next frame, what was said of the two before, and the frames of the last."""

    film: int
    frame: int
    said: np.ndarray  # (2, V, 3)
    turn: np.ndarray


class _Course:
    """The sequences, and the lanes over them."""

    def __init__(self, films: Sequence[tuple[Recipe, Film]], schedule: Schedule) -> None:
        self.schedule, self.rng = schedule, np.random.default_rng(schedule.seed)
        self.films = []
        for recipe, film in films:
            if len(film.fine) <= schedule.window + 2:
                raise SimCoreError(
                    f"{recipe.name}: {len(film.fine)} frames – give more than {schedule.window + 2}"
                )
            ground = Ground.of(recipe)
            base = np.stack([ground.pair.base @ place for place in film.coarse.astype(float)])
            self.films.append((ground, film.coarse, ((film.fine - base) / ground.unit).astype(np.float32)))
        self.lanes: list[_Lane | None] = [None] * schedule.lanes
        self.glued: Glued | None = None

    def begin(self) -> Glued:
        """Lanes that are done or lost begin elsewhere; the sheets they are on, glued."""
        rng, window = self.rng, self.schedule.window
        for number, lane in enumerate(self.lanes):
            if (
                lane is not None
                and lane.frame + window < len(self.films[lane.film][1])
                and rng.random() > window / STAY
            ):
                continue
            which = int(rng.integers(len(self.films)))
            ground, coarse, truth = self.films[which]
            frame = 0 if rng.random() < FROM_FIRST else int(rng.integers(0, len(coarse) - window))
            said = np.zeros((2, *truth.shape[1:]), np.float32)
            if frame >= 2 and rng.random() < FROM_TRUTH:
                said[0], said[1] = truth[frame - 1], truth[frame - 2]
            place = coarse[max(frame - 1, 0)].astype(float)
            turn, _ = ground.surroundings.seen(place, place, place)
            self.lanes[number], self.glued = _Lane(which, frame, said, turn), None
        if self.glued is None:
            self.glued = Glued([self.films[lane.film][0] for lane in self.lanes if lane is not None])
        return self.glued

    def moment(self, glued: Glued, ahead: int) -> tuple[Moment, Tensor]:
        """So many frames ahead of the lanes: what is given, and what is wanted."""
        lanes = [lane for lane in self.lanes if lane is not None]
        given = [(self.films[lane.film][1], lane.frame + ahead) for lane in lanes]
        wanted = np.concatenate([self.films[lane.film][2][lane.frame + ahead] for lane in lanes])
        return Moment.of(glued, given), torch.from_numpy(wanted)

    def past(self) -> tuple[Tensor, np.ndarray]:
        """What was said (2, V, 3), and the frames it was said in."""
        lanes = [lane for lane in self.lanes if lane is not None]
        said = np.concatenate([lane.said for lane in lanes], axis=1)
        return torch.from_numpy(said), np.concatenate([lane.turn for lane in lanes])

    def go_on(self, glued: Glued, said: np.ndarray, turn: np.ndarray) -> None:
        """Every lane by a window, with what was said (2, V, 3) of its last frames; who is lost begins elsewhere."""
        for k, lane in enumerate(self.lanes):
            own = said[:, glued.fine[k] : glued.fine[k + 1]]
            if lane is None or not np.abs(own).max() < LOST:
                self.lanes[k] = None
                continue
            lane.frame += self.schedule.window
            lane.said, lane.turn = own.copy(), turn[glued.coarse[k] : glued.coarse[k + 1]]


def train(
    films: Sequence[tuple[Recipe, Film]],
    settings: Settings,
    schedule: Schedule,
    *,
    record: Path | None = None,
    told: Told | None = None,
) -> dict[str, np.ndarray]:
    """Weights by the names of `Settings.shapes`, the running mean of those of the last updates.

    record: a file that is written every minute, and gone on from where it is there: interrupted or not, the same
    weights come out. told(share, words): hears the loss. Raises SimCoreError for a record of other settings, and
    sequences too short for a window.
    """
    torch.manual_seed(schedule.seed)
    course, network = _Course(films, schedule), LearnedSteps(settings)
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
        "films": [one.told() for one, _ in films],
    }
    begin = _recorded(record, same, (network, optimiser, mean, course)) if record else 0
    written, losses = time.monotonic(), []
    for update in range(begin, schedule.updates):
        share = update / schedule.updates
        for group in optimiser.param_groups:
            group["lr"] = (
                schedule.rate * min(1.0, (update + 1) / WARM) * 0.5 * (1.0 + math.cos(math.pi * share))
            )
        losses.append(_update(network, optimiser, course))
        kept = min(MEMORY, update / (update + 1))
        for name, value in network.state_dict().items():
            mean[name].mul_(kept).add_(value, alpha=1.0 - kept)
        if told is not None and update % 20 == 0:
            told(share, f"{np.mean(losses[-200:]):.4f}")
        if record and time.monotonic() - written > BETWEEN:
            _write(record, same, update + 1, (network, optimiser, mean, course))
            written = time.monotonic()
    if record:
        _write(record, same, schedule.updates, (network, optimiser, mean, course))
    return {name: value.numpy().copy() for name, value in mean.items()}


def _update(network: LearnedSteps, optimiser: torch.optim.Optimizer, course: _Course) -> float:
    """One window of all lanes, and one update; the mean distance from what was wanted, in units."""
    glued, schedule = course.begin(), course.schedule
    said, before = course.past()
    total, off = torch.zeros(()), 0.0
    last, first = said[0], said[1]
    for ahead in range(schedule.window):
        moment, wanted = course.moment(glued, ahead)
        last, first = (glued.carried(one, before, moment.turn) for one in (last, first))
        now = network(glued, moment, last, first)
        errors = now - wanted
        squares = errors.square().sum(1)
        distance = (squares + SOFT).sqrt().mean()
        total = (
            total
            + distance
            + SQUARES * squares.mean()
            + schedule.edges * EdgeGap.apply(errors, glued.edges, glued.edge_weight)
        )
        off += float(distance.detach()) / schedule.window
        last, first, before = now, last, moment.turn
    optimiser.zero_grad()
    (total / schedule.window).backward()
    torch.nn.utils.clip_grad_norm_(network.parameters(), CLIPPED)
    optimiser.step()
    course.go_on(glued, torch.stack([last, first]).detach().numpy(), before)
    return off


def _write(record: Path, same: dict[str, Any], update: int, what: tuple[Any, ...]) -> None:
    network, optimiser, mean, course = what
    value = {
        "same": same,
        "update": update,
        "network": network.state_dict(),
        "optimiser": optimiser.state_dict(),
        "mean": mean,
        "lanes": [lane and (lane.film, lane.frame, lane.said, lane.turn) for lane in course.lanes],
        "rng": course.rng.bit_generator.state,
    }
    beside = record.with_name(f".{record.name}.part")
    torch.save(value, beside)
    os.replace(beside, record)


def _recorded(record: Path, same: dict[str, Any], what: tuple[Any, ...]) -> int:
    """The update to go on with; 0 where there is no record."""
    if not record.is_file():
        return 0
    network, optimiser, mean, course = what
    try:
        value = torch.load(record, weights_only=False)
        if value["same"] != same:
            raise SimCoreError(
                f"{record}: was begun with other settings or data – give another file, or delete it"
            )
        network.load_state_dict(value["network"])
        optimiser.load_state_dict(value["optimiser"])
        mean.update(value["mean"])
        course.lanes = [lane and _Lane(*lane) for lane in value["lanes"]]
        course.rng.bit_generator.state = value["rng"]
        return int(value["update"])
    except SimCoreError:
        raise
    except Exception as error:
        raise SimCoreError(f"{record}: damaged ({error}) – delete it and train again") from None
