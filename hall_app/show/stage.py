"""The stage behaviours act on: who is near what, what is clicked."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

from hall_app.content.behaviours import BEHAVIOURS
from hall_app.visit.visitors import Visitor, Visitors

__all__ = ["Actor", "Figures", "Stage"]

FORGET = 1.15  # leave at this multiple of the near distance: no flicker on the edge
SIGHT = 10.0  # [m] from which a visitor is told what moves
AGAIN = 1.0  # [s] after which a page that turns a model on by itself is told anew
SAME = math.radians(0.5)  # turned by less nobody sees it


@dataclass(frozen=True, slots=True)
class Actor:
    """An exhibit as the stage knows it: where it stands [m], where to it faces [deg], and what it does."""

    id: str
    x: float
    z: float
    facing: float
    behaviours: tuple[str, ...]


class Figures(Protocol):
    """The drawn side: what a behaviour may name or open."""

    def node(self, exhibit: str) -> str: ...
    def show_closeup(self, visitor: Visitor, exhibit: str) -> dict[str, Any]: ...
    def show_comparison(self, visitor: Visitor, exhibit: str) -> dict[str, Any] | None: ...
    def hide_closeup(self, visitor: Visitor) -> None: ...


@dataclass
class Stage:
    """Binds behaviours to exhibits and plays them. Not thread-safe: lives on the server's event loop."""

    figures: Figures
    visitors: Visitors
    actors: dict[str, Actor] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._clock = 0.0
        self._clear()

    def _clear(self) -> None:
        self._clicks: dict[str, list[Callable[[Visitor], None]]] = defaultdict(list)
        self._near: dict[str, list[tuple[float, Callable[[Visitor, bool], None]]]] = defaultdict(list)
        self._opening: dict[str, dict[str, Any]] = defaultdict(dict)
        self._ticks: dict[str, list[Callable[[Visitor, float], None]]] = defaultdict(list)

    def play(self, actors: tuple[Actor, ...]) -> None:
        """Take these exhibits on stage in place of the former ones."""
        for visitor in self.visitors:
            for exhibit, index in tuple(visitor.near):
                self._near[exhibit][index][1](visitor, False)
            visitor.near.clear()
            visitor.turns.clear()
        self._clear()
        self.actors = {actor.id: actor for actor in actors}
        for actor in actors:
            for name in actor.behaviours:
                BEHAVIOURS[name](self, actor.id)
        for visitor in self.visitors:
            self.stood_at(visitor, visitor.walk.pose.x, visitor.walk.pose.z)

    # What a behaviour asks for.

    def on_click(self, exhibit: str, act: Callable[[Visitor], None]) -> None:
        self._clicks[exhibit].append(act)

    def on_near(self, exhibit: str, distance: float, act: Callable[[Visitor, bool], None]) -> None:
        self._near[exhibit].append((distance, act))

    def on_open(self, exhibit: str, extra: dict[str, Any]) -> None:
        self._opening[exhibit].update(extra)

    def on_tick(self, exhibit: str, act: Callable[[Visitor, float], None]) -> None:
        self._ticks[exhibit].append(act)

    def turn(self, visitor: Visitor, exhibit: str, angle: float, rate: float) -> None:
        """Tell a page by how much [rad] the model is turned from where it faces, and how fast it goes on [rad/s].

        A page that shows it so already is not told.
        """
        before, pace, at = visitor.turns.get(exhibit, (math.nan, math.nan, 0.0))
        since = self._clock - at
        shown = abs(math.remainder(angle - before - pace * since, math.tau)) < SAME and pace == rate
        if shown and (rate == 0 or since < AGAIN):
            return
        visitor.turns[exhibit] = (angle, rate, self._clock)
        visitor.say({"t": "turn", "id": exhibit, "angle": round(angle, 4), "rate": rate})

    def bearing(self, visitor: Visitor, exhibit: str) -> float:
        """By how much [rad] the exhibit would have to turn from where it faces to face the visitor."""
        actor, pose = self.actors[exhibit], visitor.walk.pose
        return math.atan2(pose.x - actor.x, pose.z - actor.z) - math.radians(actor.facing)

    def notice(self, visitor: Visitor, exhibit: str, on: bool, *, glow: bool) -> None:
        node = self.figures.node(exhibit)
        visitor.say({"t": "near", "id": exhibit, "on": on, "glow": glow, "caption": True, "node": node})

    def open(self, visitor: Visitor, exhibit: str) -> None:
        """Show `exhibit` from close by; the walking pose stays where it is."""
        if exhibit not in self.actors or visitor.opened == exhibit:  # megabytes are sent once
            return
        studio = self.figures.show_closeup(visitor, exhibit)
        visitor.opened, visitor.compares = exhibit, False
        visitor.say({"t": "open", "id": exhibit, **studio, **self._opening[exhibit]})

    def compare(self, visitor: Visitor, on: bool) -> None:
        """In the close-up: show what the exhibit compares side by side, or the exhibit again."""
        exhibit = visitor.opened
        if exhibit is None or exhibit not in self.actors or visitor.compares == on:
            return
        show = self.figures.show_comparison if on else self.figures.show_closeup
        if (studio := show(visitor, exhibit)) is None:  # it compares nothing
            return
        visitor.compares = on
        visitor.say({"t": "compared", "id": exhibit, "on": on, **studio})

    def close(self, visitor: Visitor) -> None:
        self.figures.hide_closeup(visitor)
        visitor.opened, visitor.compares = None, False
        visitor.say({"t": "closed"})

    # What happens to it.

    def tick(self, clock: float) -> None:
        """The hall's clock says so many seconds; who has entered and stands within SIGHT is told what moves."""
        self._clock = clock
        for exhibit, acts in self._ticks.items():
            actor = self.actors[exhibit]
            for visitor in self.visitors:
                pose = visitor.walk.pose
                if math.hypot(actor.x - pose.x, actor.z - pose.z) < SIGHT:
                    for act in acts:
                        act(visitor, clock)

    def clicked(self, visitor: Visitor, exhibit: str) -> None:
        for act in self._clicks.get(exhibit, ()):
            act(visitor)

    def stood_at(self, visitor: Visitor, x: float, z: float) -> None:
        """A visitor now stands at (x, z) [m]."""
        for exhibit, reactions in self._near.items():
            actor = self.actors[exhibit]
            away = math.hypot(actor.x - x, actor.z - z)
            for index, (distance, act) in enumerate(reactions):
                key = (exhibit, index)
                inside = away <= distance * (FORGET if key in visitor.near else 1.0)
                if inside == (key in visitor.near):
                    continue
                (visitor.near.add if inside else visitor.near.discard)(key)
                act(visitor, inside)
