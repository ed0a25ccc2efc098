"""The running hall: content, floor, drawn scene and visitors, kept in step when a curator changes a file."""

from __future__ import annotations

import asyncio
import math
import multiprocessing
import signal
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Literal

from .bake.places import key_now
from .beside import beside
from .content.floor import foot_height
from .content.glb import GlbError, read_glb
from .content.loading import Content, Exhibit
from .content.problems import Problem
from .content.views import yaw_of
from .content.walkable import walking_floor
from .models import ExhibitModels, models_of
from .room.showing import ShownRoom, shown_room, still_right
from .scene.nodes import Figure, HallScene
from .stage import Actor, Stage
from .visitors import Visitor, Visitors
from .walking import Floor, Grid, Pose, WalkSession, cached_grid

__all__ = ["House"]

WalkMode = Literal["predict", "server"]


@dataclass
class House:
    """One hall being served. Lives on the server's event loop; not thread-safe."""

    content: Content
    data: Path
    walk_mode: WalkMode = "predict"
    progress: Callable[[float, str], None] | None = None
    scene: HallScene = field(default_factory=HallScene)
    visitors: Visitors = field(default_factory=Visitors)
    unbaked: tuple[Problem, ...] = ()
    survey_problems: Callable[[], Iterable[Any]] = tuple

    def __post_init__(self) -> None:
        self.stage = Stage(self.scene, self.visitors)
        self.floor: Floor = walking_floor(self.content.plan, self.content.exhibits)
        self.grid: Grid = cached_grid(self.floor, self._grids, progress=self.progress)
        self._models: dict[str, ExhibitModels] = {}
        self._failed: dict[str, Problem] = {}
        self._show_room(shown_room(self.content, self.data))
        self._show()

    @property
    def _grids(self) -> Path:
        return self.data / "grids"

    def attach(self, loop: asyncio.AbstractEventLoop) -> None:
        """Take clicks from viser's threads onto the server's loop."""

        def clicked(client: int, exhibit: str) -> None:
            loop.call_soon_threadsafe(self._clicked, client, exhibit)

        self.scene.when_clicked(clicked)

    def _clicked(self, client: int, exhibit: str) -> None:
        visitor = self.visitors.of_client(client)
        if visitor is not None and visitor.opened is None:
            self.stage.clicked(visitor, exhibit)

    def close(self) -> None:
        self.scene.stop()

    @property
    def problems(self) -> tuple[Problem, ...]:
        """What is wrong with the content now."""
        asked = (Problem(p.file, p.key, p.what, p.fix) for p in self.survey_problems())
        return (*self.content.problems, *self.unbaked, *self.room_problems, *asked)

    @property
    def room_problems(self) -> tuple[Problem, ...]:
        """Why the room is shown without its light or its letters."""
        found = [self._failed[self.room.key]] if self.room.key in self._failed else []
        if self.room.lacking is not None:
            what, _, fix = self.room.lacking.partition(" – ")
            found = [Problem("plan.toml", "", f"the hall's boards are blank: {what}", fix)]
        if self.room.broken is not None:
            file, _, what = self.room.broken.partition(" ")
            what = f"{what}: the room is shown evenly lit"
            found.append(Problem(file, "", what, "run: hall build --room"))
        return tuple(found)

    def baked(self, exhibit: Exhibit, failure: str | None) -> None:
        """A bake of the exhibit's garment ended; `failure` says why it did not succeed."""
        key = key_now(self.content, exhibit)
        if failure is not None and key is not None:
            problem = Problem(
                exhibit.toml, "garment", f"baking failed: {failure}", "correct pattern or weave"
            )
            self._failed[key] = problem

    def given_up(self, exhibit: Exhibit) -> bool:
        """True when baking these very inputs has failed before."""
        return key_now(self.content, exhibit) in self._failed

    @property
    def start(self) -> Pose:
        """Where a visitor comes in."""
        start = self.content.hall.start
        return Pose(start.x, start.z, yaw_of(start.facing), self.content.hall.eye.default)

    def models(self, exhibit: str) -> ExhibitModels | None:
        """What an exhibit is drawn with."""
        return self._models.get(exhibit)

    def bakes(self) -> dict[str, Path]:
        """Exhibit -> folder its baked media lie in."""
        return {name: models.baked for name, models in self._models.items() if models.baked is not None}

    def shown(self) -> tuple[Exhibit, ...]:
        """The exhibits that stand in the hall."""
        return tuple(exhibit for exhibit in self.content.exhibits if exhibit.id in self._models)

    async def replace(self, content: Content) -> None:
        """Show changed content, without a restart; visitors stay where they are if they can."""
        floor = walking_floor(content.plan, content.exhibits)
        moved = (floor.outline, floor.solids) != (self.floor.outline, self.floor.solids)
        grid = await self._bake_grid(floor) if moved else self.grid
        self.content = content
        if moved:
            self.floor, self.grid = floor, grid
            for visitor in self.visitors:
                if visitor.walk.change_floor(floor, self.grid):
                    visitor.say(visitor.walk.moved().message())
        self._show()
        news = {"t": "content", "revision": content.revision, "problems": len(self.problems)}
        for visitor in self.visitors:
            if visitor.opened is not None and visitor.opened not in self._models:
                self.stage.close(visitor)
            visitor.say(news)
        if not still_right(self.room, content, self.data):  # a second or two: the last to change
            self._show_room(await beside(shown_room, content, self.data))

    def _show_room(self, room: ShownRoom) -> None:
        self.room = room
        self.scene.show_room(room.glb)
        self.scene.show_environment(room.environment)

    def room_unlit(self) -> bool:
        """True while the room's light has still to be computed from the content as it is now."""
        return not self.room.baked and self.room.lacking is None and self.room.key not in self._failed

    def room_baked(self, key: str, failure: str | None) -> None:
        """A bake of the room of that key ended; `failure` says why it did not succeed."""
        if failure is not None:
            what, fix = f"its light could not be computed: {failure}", "run hall build --room"
            self._failed[key] = Problem("plan.toml", "", what, fix)

    async def _bake_grid(self, floor: Floor) -> Grid:
        """The clearance grid of a changed floor, baked in a process of its own."""
        loop = asyncio.get_running_loop()
        # Ctrl-C is ours to answer; the worker would print its own account of it.
        ignore = {"initializer": signal.signal, "initargs": (signal.SIGINT, signal.SIG_IGN)}
        pool = ProcessPoolExecutor(1, mp_context=get_context("spawn"), **ignore)
        try:
            return await loop.run_in_executor(pool, cached_grid, floor, self._grids)
        except asyncio.CancelledError:
            for worker in multiprocessing.active_children():
                worker.terminate()
            raise
        finally:
            pool.shutdown(wait=False, cancel_futures=True)

    def _show(self) -> None:
        """Draw the exhibits; one whose garment is not baked yet is left out and named."""
        found = {e.id: models_of(self.content, e, self.data) for e in self.content.exhibits}
        self._models = {name: models for name, models in found.items() if models is not None}
        figures, unreadable = self._figures_now()
        self.unbaked = unreadable + tuple(
            self._failed.get(key_now(self.content, e) or "")
            or Problem(e.toml, "garment", "has not been baked", "run hall build")
            for e in self.content.exhibits
            if e.file.garment is not None and (e.id not in self._models or self.given_up(e))
        )
        shown = self.shown()
        self.scene.show(figures, frozenset(e.id for e in shown if "open_on_click" in e.file.behaviours))
        start = self.start
        self.scene.place_camera(start.x, start.z, start.yaw, start.eye)
        self.stage.play(
            tuple(Actor(e.id, e.file.place.x, e.file.place.z, tuple(e.file.behaviours)) for e in shown)
        )

    def _figures_now(self) -> tuple[tuple[Figure, ...], tuple[Problem, ...]]:
        """The exhibits as drawn; one whose models cannot be read keeps its last good ones, or is left out."""
        figures, problems = [], []
        for exhibit in self.shown():
            try:
                figure = self._figure(exhibit)
            except (GlbError, OSError) as error:
                models = self._models[exhibit.id]
                fix = error.fix if isinstance(error, GlbError) else "check the file"
                problems.append(
                    Problem(exhibit.toml, "models", f"{models.close.name}, {models.hall.name}: {error}", fix)
                )
                figure = self.scene.figure(exhibit.id)
            if figure is None:
                del self._models[exhibit.id]
            else:
                figures.append(figure)
        return tuple(figures), tuple(problems)

    def _figure(self, exhibit: Exhibit) -> Figure:
        models, place = self._models[exhibit.id], exhibit.file.place
        read_glb(models.hall)  # a browser would only show a hole
        low, high = models.bounds()
        return Figure(
            id=exhibit.id,
            hall=models.hall.read_bytes(),
            close=models.close.read_bytes,
            x=place.x,
            y=foot_height(self.content.plan, exhibit.file),
            z=place.z,
            facing=place.facing,
            centre=(low[1] + high[1]) / 2,
            radius=0.5 * math.dist(low, high),
        )

    # Visitors.

    def welcome(self, now: float, mode: WalkMode, display: str, at: Any = None) -> Visitor:
        """A visitor comes in, or comes back to the place `at` after a lost connection."""
        walk = WalkSession(self.floor, self.grid, self.start, now=now, mode=mode)
        if isinstance(at, dict):
            walk.goto(at.get("x"), at.get("z"))
        visitor = Visitor(walk, display=display)
        self.visitors.enter(visitor)
        return visitor

    def farewell(self, visitor: Visitor) -> None:
        self.visitors.leave(visitor)

    def walk_json(self) -> dict[str, Any]:
        """What the page needs for walking."""
        body = self.grid.body
        grid = {"url": f"/grid.bin?v={self.content.revision}", **self.grid.meta()}
        return {"mode": self.walk_mode, **walk_constants(body.radius, body.skin), "grid": grid}


def walk_constants(radius: float, skin: float) -> dict[str, float]:
    """Speed and sizes the page predicts with: the server's own."""
    from .walking import MAX_INPUT_DT, SPEED

    return {"speed": SPEED, "radius": radius, "skin": skin, "max_dt": MAX_INPUT_DT}
