"""What exhibits do. A new behaviour is one small function here; a curator names it in exhibit.toml."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any, Literal, Protocol, TypeVar

__all__ = ["BEHAVIOURS", "LIVE", "MOVING", "Behaviour", "Kind", "Stage", "behaviour", "kind_of"]


V = TypeVar("V")  # a visitor, whom a behaviour only hands on


class Stage(Protocol[V]):
    """What a behaviour may ask for (`show.Stage` gives it)."""

    def on_click(self, exhibit: str, act: Callable[[V], None]) -> None: ...
    def on_near(self, exhibit: str, distance: float, act: Callable[[V, bool], None]) -> None: ...
    def on_open(self, exhibit: str, extra: dict[str, Any]) -> None: ...
    def on_tick(self, exhibit: str, act: Callable[[V, float], None]) -> None: ...
    def notice(self, visitor: V, exhibit: str, on: bool, *, glow: bool) -> None: ...
    def turn(self, visitor: V, exhibit: str, angle: float, rate: float) -> None: ...
    def bearing(self, visitor: V, exhibit: str) -> float: ...
    def open(self, visitor: V, exhibit: str) -> None: ...


Behaviour = Callable[[Stage[Any], str], None]

BEHAVIOURS: dict[str, Behaviour] = {}

NEAR = 3.0  # [m] from which an exhibit notices its visitor
TURN = 0.25  # [rad/s] of what turns on its stand
MOVING = frozenset({"turn_slowly"})  # behaviours that go by the hall's clock, alike for all
LIVE = frozenset({"turn_to_visitor"})  # behaviours that answer, tick by tick, what a visitor does

Kind = Literal["still", "moving", "live"]


def kind_of(behaviours: Iterable[str]) -> Kind:
    """What an exhibit is by what it does: where nothing answers a visitor or goes by the clock, it stands still."""
    names = frozenset(behaviours)
    return "live" if names & LIVE else "moving" if names & MOVING else "still"


def behaviour(act: Behaviour) -> Behaviour:
    """Register `act(stage, exhibit_id)` under its own name."""
    BEHAVIOURS[act.__name__] = act
    return act


@behaviour
def open_on_click(stage: Stage[Any], exhibit: str) -> None:
    """A click on the model opens its close-up."""
    stage.on_click(exhibit, lambda visitor: stage.open(visitor, exhibit))


@behaviour
def glow_when_near(stage: Stage[Any], exhibit: str) -> None:
    """The model lights up and its caption appears while a visitor stands before it."""
    stage.on_near(exhibit, NEAR, lambda visitor, on: stage.notice(visitor, exhibit, on, glow=True))


@behaviour
def turn_slowly(stage: Stage[Any], exhibit: str) -> None:
    """The model turns on its stand, by the hall's clock, so that all who stand before it see the same side.

    A page turns it on by itself between two ticks (page/look/turning.js).
    """

    def turned(visitor: Any, clock: float) -> None:
        stage.turn(visitor, exhibit, TURN * clock % math.tau, TURN)

    stage.on_tick(exhibit, turned)


@behaviour
def turn_to_visitor(stage: Stage[Any], exhibit: str) -> None:
    """The model turns its front to whoever stands before it, to each visitor on his own page."""

    def turned(visitor: Any, clock: float) -> None:
        stage.turn(visitor, exhibit, stage.bearing(visitor, exhibit), 0.0)

    stage.on_tick(exhibit, turned)


@behaviour
def play_clip(stage: Stage[Any], exhibit: str) -> None:
    """The exhibit's first film starts, muted, above its text when its close-up opens (page/ui/panel/media.js).

    Whoever asked the system for less motion finds it there standing still, to be started by hand.
    """
    stage.on_open(exhibit, {"play": True})
