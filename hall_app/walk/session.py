"""One visitor's walk on the server: a pure state machine, no sockets, no clock of its own.

FCL has the last word; the page only predicts. `now` is any monotonic clock in seconds.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

from hall_app.walk.body import BODY, Body, world_of
from hall_app.walk.grid import Grid, Reach, UnreachableError
from hall_app.walk.mover import SPEED, Keys, Pose, step
from hall_app.walk.solids import Floor

Mode = Literal["predict", "server"]

MAX_INPUT_DT = 0.25  # [s] the page cuts longer frames into several inputs
BUCKET = 1.0  # [s] of walking a page may deliver late at once (a busy network); more would be a speed hack
ARREARS = (
    0.1  # [s] the server makes up for when it walks itself; a visitor whom it left standing longer was still
)
HOLD = 0.45  # [s] that keys count as held where the server walks: a page that says nothing has stood still itself
MOST_TICKS = 2  # at once, 5 cm: what is made up for is walked, not leapt
REFILL = 1.02  # clocks of page and server differ a little; 2 % faster is no advantage
EYE_MIN, EYE_MAX = 0.8, 2.4  # [m]
TICK = 1 / 60  # [s] integration step in server mode
MAX_BATCH = 64  # inputs per message


@dataclass(frozen=True)
class WalkReply:
    """The authoritative pose after input `seq`; refused: inputs not (wholly) walked."""

    seq: int
    x: float
    z: float
    eye: float
    refused: int = 0

    def message(self) -> dict[str, Any]:
        """As the page expects it."""
        return {"t": "pose", "seq": self.seq, "x": self.x, "z": self.z, "eye": self.eye}


@dataclass(frozen=True)
class Moved:
    """A teleport: x, z [m], yaw [rad]."""

    x: float
    z: float
    yaw: float

    def message(self) -> dict[str, Any]:
        """As the page expects it."""
        return {"t": "moved", "x": self.x, "z": self.z, "yaw": self.yaw}


class WalkSession:
    """The authority over one visitor's pose. Not thread-safe: one event loop or one thread per session.

    mode "predict": `inputs` walks what the page has already shown;
    "server": `keys` holds keys, `tick` walks them.
    """

    def __init__(
        self,
        floor: Floor,
        grid: Grid,
        start: Pose,
        *,
        now: float,
        mode: Mode = "predict",
        body: Body = BODY,
        speed: float = SPEED,
    ) -> None:
        self.mode: Mode = mode
        self._body, self._speed = body, speed
        self._held = Keys()
        self._seq = 0
        self._budget, self._seen = BUCKET, now
        self._walked_until = self._held_until = now
        self._start = start
        self.pose = start
        self.change_floor(floor, grid)

    @property
    def seq(self) -> int:
        """Number of the last input taken in."""
        return self._seq

    def reply(self, refused: int = 0) -> WalkReply:
        """The present pose as a reply."""
        return WalkReply(self._seq, self.pose.x, self.pose.z, self.pose.eye, refused)

    def inputs(self, items: Iterable[Any], now: float) -> WalkReply:
        """Walk the page's inputs [seq, dt, forward, right, yaw, eye], in order, as far as real time allows.

        Invalid or repeated inputs are left out and counted in `refused`; in server mode inputs only set
        yaw and eye.
        """
        self._refill(now)
        refused = 0
        for count, item in enumerate(items):
            asked = _parse(item) if count < MAX_BATCH else None
            if asked is None or asked.seq <= self._seq:
                refused += 1
                continue
            self._take(asked)
            if self.mode == "server":
                continue
            allowed = min(asked.dt, self._budget)
            refused += allowed < asked.dt
            self._budget -= allowed
            self._walk(asked.keys, allowed)
        return self.reply(refused)

    def keys(self, forward: Any, right: Any, yaw: Any, eye: Any, now: float) -> WalkReply:
        """Server mode: hold these keys for HOLD (walks the old ones up to now first, or forgets it)."""
        reply = self.tick(now)
        self._walked_until = max(self._walked_until, now - TICK)  # many that come at once make up for it once
        asked = _parse([self._seq + 1, TICK, forward, right, yaw, eye])
        if asked is None:
            return replace(reply, refused=1)
        self._take(asked)
        self._held, self._held_until = asked.keys, now + HOLD
        return self.reply()

    def tick(self, now: float) -> WalkReply:
        """Server mode: walk the held keys towards `now`, 1/60 s at a time, at most MOST_TICKS."""
        self._walked_until = max(self._walked_until, now - ARREARS)
        for _ in range(MOST_TICKS):
            if now - self._walked_until < TICK - 1e-9:
                break
            self._walked_until += TICK
            if self.mode == "server" and self._walked_until <= self._held_until:
                self._walk(self._held, TICK)
        return self.reply()

    def goto(self, x: Any, z: Any) -> Moved:
        """Teleport to the reachable free spot nearest to (x, z) [m]; what is no number changes nothing.

        Server mode: keys held before are forgotten, since nobody walks on out of a jump; the page tells again
        those that still are.
        """
        if _number(x) and _number(z) and self._reach is not None:
            x, z = self._reach.spot(float(x), float(z))
            self.pose = replace(self.pose, x=x, z=z)
            self._held = Keys()
        return self.moved()

    def moved(self) -> Moved:
        """The present pose as a teleport."""
        return Moved(self.pose.x, self.pose.z, self.pose.yaw)

    def change_floor(self, floor: Floor, grid: Grid) -> bool:
        """Take over a changed plan; True if the visitor had to move to the nearest reachable free spot."""
        self._floor = floor
        try:
            self._reach: Reach | None = grid.reach((self._start.x, self._start.z))
        except UnreachableError:  # a plan without a free spot: nobody walks until it is mended
            self._reach = None
            return False
        room = world_of(floor, self._body).clearance(self.pose.x, self.pose.z)
        if room >= self._body.skin / 2 and self._reach.beside(self.pose.x, self.pose.z):
            return False
        x, z = self._reach.spot(self.pose.x, self.pose.z)
        self.pose = replace(self.pose, x=x, z=z)
        return True

    def _take(self, asked: _Input) -> None:
        self._seq = asked.seq
        self.pose = replace(self.pose, yaw=asked.yaw, eye=asked.eye)

    def _refill(self, now: float) -> None:
        self._budget = min(BUCKET, self._budget + max(0.0, now - self._seen) * REFILL)
        self._seen = max(self._seen, now)

    def _walk(self, keys: Keys, dt: float) -> None:
        if dt > 0:
            self.pose = step(self.pose, keys, dt, self._floor, body=self._body, speed=self._speed)


class _Input(NamedTuple):
    """What a page did in one frame: its number, how long [s], keys, heading [rad] and eye height [m]."""

    seq: int
    dt: float
    keys: Keys
    yaw: float
    eye: float


def _parse(item: Any) -> _Input | None:
    """One input, None if it is not valid; the eye is clamped."""
    if not isinstance(item, Sequence) or len(item) != 6 or not all(map(_number, item)):
        return None
    seq, dt, forward, right, yaw, eye = item
    if seq != int(seq) or not 0 < dt <= MAX_INPUT_DT or abs(forward) > 1 or abs(right) > 1:
        return None
    eye = min(max(float(eye), EYE_MIN), EYE_MAX)
    return _Input(int(seq), float(dt), Keys(forward, right), float(yaw), eye)


def _number(value: Any) -> bool:
    return (
        isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e15
    )  # nan fails too
