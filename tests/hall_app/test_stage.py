"""What exhibits do: who is near what, what is clicked, and what the hall's clock moves."""

import math
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import pytest

from hall_app.content import BEHAVIOURS
from hall_app.show import Actor, Stage
from hall_app.visit import Visitors


class Shown:
    """The drawn side, as a behaviour sees it."""

    def node(self, exhibit: str) -> str:
        return f"/exhibits/{exhibit}"

    def show_closeup(self, visitor: Any, exhibit: str) -> dict[str, Any]:
        return {"node": "/closeup"}

    def show_comparison(self, visitor: Any, exhibit: str) -> dict[str, Any] | None:
        return {"node": "/comparison"} if exhibit == "mirror" else None

    def hide_closeup(self, visitor: Any) -> None: ...


@dataclass(eq=False)
class Guest:
    """Who stands at (x, z) [m] and notes what is said to his page."""

    x: float
    z: float
    heard: list[dict[str, Any]] = field(default_factory=list)
    near: set[tuple[str, int]] = field(default_factory=set)
    turns: dict[str, Any] = field(default_factory=dict)
    opened: str | None = None
    compares: bool = False

    @property
    def walk(self) -> SimpleNamespace:
        return SimpleNamespace(pose=self)

    def say(self, message: dict[str, Any]) -> None:
        self.heard.append(message)

    def told(self, kind: str) -> list[dict[str, Any]]:
        return [message for message in self.heard if message["t"] == kind]


@pytest.fixture
def stage() -> Stage:
    made = Stage(Shown(), Visitors())
    shared = tuple(name for name in BEHAVIOURS if name != "turn_to_visitor")
    coat = Actor("coat", 4.0, 0.0, 0.0, ("glow_when_near",))
    made.play((Actor("mirror", 0.0, 0.0, 90.0, shared), coat))
    return made


def come(stage: Stage, x: float, z: float) -> Guest:
    guest = Guest(x, z)
    stage.visitors.enter(guest)  # type: ignore[arg-type]
    return guest


def test_the_clock_turns_what_moves_for_those_who_see_it_and_alike(stage: Stage) -> None:
    one, other, away = come(stage, 0, 2), come(stage, 3, 3), come(stage, 0, 40)
    stage.tick(100.0)
    stage.tick(101.0)
    first, second = one.told("turn")
    assert one.told("turn") == other.told("turn")
    assert away.heard == []
    assert {message["id"] for message in one.told("turn")} == {"mirror"}
    turned = (second["angle"] - first["angle"]) % math.tau
    assert turned == pytest.approx(first["rate"] * 1.0, abs=1e-3)
    assert 0 <= first["angle"] <= math.tau


def test_what_a_page_goes_on_with_by_itself_is_not_told_at_every_tick(stage: Stage) -> None:
    guest = come(stage, 0, 2)
    for tick in range(9):
        stage.tick(100 + tick / 4)
    assert len(guest.told("turn")) == 3


def test_a_live_exhibit_faces_each_visitor_and_speaks_when_he_moves(stage: Stage) -> None:
    stage.play((Actor("mirror", 1.0, 1.0, 90.0, ("turn_to_visitor",)),))
    ahead, behind = come(stage, 1 + 2, 1), come(stage, 1, 1 - 3)
    for tick in range(8):
        stage.tick(tick / 4)
    assert [(m["id"], m["angle"], m["rate"]) for m in ahead.told("turn")] == [("mirror", 0.0, 0.0)]
    (first,) = behind.told("turn")
    assert first["angle"] == pytest.approx(math.pi / 2, abs=1e-3)  # from +x round to -z
    behind.x, behind.z = 1 - 2.0, 1.0
    stage.tick(3.0)
    assert behind.told("turn")[-1]["angle"] == pytest.approx(-math.pi, abs=1e-3)
    assert len(ahead.told("turn")) == 1


def test_nothing_that_stands_still_hears_the_clock(stage: Stage) -> None:
    guest = come(stage, 4, 1)
    stage.play((Actor("coat", 4.0, 0.0, 0.0, ("glow_when_near", "open_on_click", "play_clip")),))
    stage.tick(5.0)
    assert guest.told("turn") == []


def test_coming_near_and_going_is_told_once_each_without_flicker(stage: Stage) -> None:
    guest = come(stage, 0, 5)
    for z in (2.9, 2.95, 3.1, 2.9, 3.3, 3.6, 5.0):
        guest.z = z
        stage.stood_at(guest, guest.x, guest.z)  # type: ignore[arg-type]
    assert [(m["id"], m["on"]) for m in guest.told("near")] == [("mirror", True), ("mirror", False)]


def test_a_click_opens_once_and_films_play(stage: Stage) -> None:
    guest = come(stage, 0, 2)
    for _ in range(2):
        stage.clicked(guest, "mirror")  # type: ignore[arg-type]
    (opened,) = guest.told("open")
    assert (opened["id"], opened["play"], guest.opened) == ("mirror", True, "mirror")
    stage.clicked(guest, "coat")  # type: ignore[arg-type]
    assert guest.opened == "mirror"
    stage.close(guest)  # type: ignore[arg-type]
    assert guest.opened is None


def test_what_is_compared_is_shown_in_the_closeup_on_request_and_leaves_with_it(stage: Stage) -> None:
    guest = come(stage, 0, 2)
    stage.compare(guest, True)  # type: ignore[arg-type]
    assert guest.told("compared") == []  # nothing is open
    stage.open(guest, "mirror")  # type: ignore[arg-type]
    for on in (True, True, False, True):
        stage.compare(guest, on)  # type: ignore[arg-type]
    told = [(m["id"], m["on"], m["node"]) for m in guest.told("compared")]
    assert told == [
        ("mirror", True, "/comparison"),
        ("mirror", False, "/closeup"),
        ("mirror", True, "/comparison"),
    ]
    stage.close(guest)  # type: ignore[arg-type]
    assert guest.compares is False
    stage.open(guest, "coat")  # type: ignore[arg-type]
    stage.compare(guest, True)  # type: ignore[arg-type]
    assert len(guest.told("compared")) == 3  # it compares nothing
