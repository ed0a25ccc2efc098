"""Rivals trained: frames drawn at random, and the published loss for all, a L1 + b Ln + c L2."""

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
from sim_core.learn.data import Take, pooled_by_kind
from sim_core.learn.inference import Ground, Rival
from sim_core.learn.networks.pace import HEARD, rate_at, stepped
from sim_core.learn.networks.record import Record
from sim_core.learn.networks.rivals.image_net import ImageNet, Images
from sim_core.learn.networks.rivals.sheet import Frames, RivalSheet
from sim_core.learn.networks.rivals.spiral_net import SpiralNet, Spirals
from sim_core.learn.pooling import Pooled
from sim_core.learn.upsampling import weighted_sums

__all__ = ["RivalSchedule", "made_of", "network_of", "train_rival"]

A, B, C = 1.0, 1.0, 0.02  # the paper's, distances in units
Told = Callable[[float, str], None]
Tables = Spirals | Images


def network_of(rival: Rival) -> SpiralNet | ImageNet:
    """Its network, untrained."""
    return SpiralNet(rival.length, rival.width) if rival.length else ImageNet(rival.width)


@dataclass(frozen=True)
class RivalSchedule:
    """updates of the weights; frames of a batch; seed."""

    updates: int = 4000
    batch: int = 8
    seed: int = 0


class _Sequence:
    def __init__(self, take: Take, device: torch.device) -> None:
        film = take.film
        self.ground = Ground.of(take.pair)
        self.sheet = RivalSheet(self.ground, device)
        base = np.stack([weighted_sums(self.ground.pair.base, place) for place in film.coarse.astype(float)])
        self.base = torch.from_numpy(base.astype(np.float32)).to(device)
        self.truth = torch.from_numpy(np.asarray(film.fine, np.float32)).to(device)

    def frames(self, numbers: np.ndarray) -> Frames:
        """The frames of these numbers, each with the two before."""
        before = np.maximum(numbers[:, None] - np.arange(3), 0)
        before[numbers == 1, 2] = 0
        return self.sheet.frames(self.base[torch.from_numpy(before).to(self.base.device)])


def made_of(rival: Rival, sheet: RivalSheet, pooled: Pooled | None) -> Tables:
    """What a rival's network needs of a sheet."""
    return Spirals.of(sheet, pooled, rival.length) if pooled is not None else Images.of(sheet)


def train_rival(
    takes: Sequence[Take],
    rival: Rival,
    schedule: RivalSchedule,
    *,
    device: str = "cpu",
    record: Path | None = None,
    told: Told | None = None,
) -> tuple[dict[str, np.ndarray], dict[str, Pooled]]:
    """Weights, and what pooling kept of each kind of sheet, by `Pair.kind`.

    record and told as of `train`. Raises SimCoreError for no film, and a record of another training.
    """
    if not takes:
        raise SimCoreError("takes: none – give one sequence at least")
    torch.manual_seed(schedule.seed)
    place, rng, told = (
        torch.device(device),
        np.random.default_rng(schedule.seed),
        told or (lambda share, words: None),
    )
    pooled: dict[str, Pooled] = {}
    if rival.length:
        told(0.0, "pools")
        pooled = pooled_by_kind(takes, rival.pooling, rival.share)
    sequences, tables = [], []
    for take in takes:
        told(0.0, f"reads {take.name}")
        sequences.append(_Sequence(take, place))
        tables.append(made_of(rival, sequences[-1].sheet, pooled.get(take.pair.kind)))
    network = network_of(rival).to(place)
    optimiser = torch.optim.AdamW(network.parameters(), lr=rival.rate, weight_decay=1e-2)
    same = {"rival": asdict(rival), "schedule": asdict(schedule), "films": [take.told() for take in takes]}
    kept = Record(record, same) if record else None
    parts = {"network": network, "optimiser": optimiser}
    begin = kept.read(parts, rng, place)[0] if kept else 0
    losses: deque[Tensor] = deque(maxlen=HEARD)
    chances = np.array([len(one.truth) for one in sequences], float)
    for update in range(begin, schedule.updates):
        which = int(rng.choice(len(sequences), p=chances / chances.sum()))
        sequence = sequences[which]
        numbers = rng.integers(0, len(sequence.truth), schedule.batch)
        loss = _loss(network, sequence, tables[which], numbers)
        stepped(network, optimiser, loss, rate_at(update, schedule.updates, rival.rate))
        losses.append(loss.detach())
        if update % 20 == 0:
            told(update / schedule.updates, f"{torch.stack(list(losses)).mean():.4f}")
        if kept:
            kept.write(update + 1, parts, rng)
    if kept:
        kept.write(schedule.updates, parts, rng, now=True)
    return {name: value.cpu().numpy().copy() for name, value in network.state_dict().items()}, pooled


def _loss(network: SpiralNet | ImageNet, sequence: _Sequence, tables: Any, numbers: np.ndarray) -> Tensor:
    frames, sheet = sequence.frames(numbers), sequence.sheet
    truth = sequence.truth[torch.from_numpy(numbers).to(sheet.device)]
    more = torch.zeros((), device=sheet.device)
    if isinstance(network, ImageNet):
        off, normal, fast = network.every(frames, sheet, tables)
        last = np.maximum(numbers - 1, 0)
        gone = truth - sequence.truth[torch.from_numpy(last).to(sheet.device)]
        before = frames.features[:, :, 3:6] * (10.0 * sheet.unit)
        speed = (frames.turn @ before[..., None])[..., 0]
        more = (fast - (gone - speed)).abs().mean() / sheet.unit
        more = (
            more
            + 0.1
            * (normal - (sheet.frames(truth[:, None].expand(-1, 3, -1, -1)).turn - frames.turn)[..., 2])
            .abs()
            .mean()
        )
    else:
        off = network(frames, sheet, tables)
    errors = (frames.base + off - truth) / sheet.unit
    bent = 1.0 - (sheet.normals(frames.base + off) * sheet.normals(truth)).sum(2)
    return A * errors.abs().sum(2).mean() + B * bent.mean() + C * errors.square().sum(2).mean() + more
