"""The running hall: content, floor, drawn scene and visitors, kept in step when a curator changes a file."""

from __future__ import annotations

import asyncio
import functools
import zlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from hall_app.content.bakes.models import ExhibitModels
from hall_app.content.floor.walkable import walking_floor
from hall_app.content.folder import Content, Exhibit
from hall_app.content.problems import Problem
from hall_app.content.views.scene import yaw_of
from hall_app.house.background import Latest, in_thread
from hall_app.house.baking.preparation import ROOM
from hall_app.house.baking.queue import Bake, BakingQueue
from hall_app.house.drafts import QUOTA
from hall_app.house.floor_grid import grid_beside, ready_grid
from hall_app.house.safekeeping import Holdings
from hall_app.room.bake.display import ShownRoom, shown_room, still_right
from hall_app.room.bake.key import room_key
from hall_app.room.bake.store import data_room
from hall_app.show.exhibits import Drawn, drawn_exhibits
from hall_app.show.scene import HallScene
from hall_app.show.stage import Actor, Stage
from hall_app.visit.places import Places
from hall_app.visit.visitors import Visitor, Visitors
from hall_app.walk import Floor, Grid, Pose, WalkSession

if TYPE_CHECKING:
    from survey import Mounted

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
    places: Places = field(default_factory=Places)
    survey_problems: Callable[[], Iterable[Any]] = tuple
    survey_results: Callable[[], Iterable[dict[str, Any]]] = tuple  # what everybody may see of the answers
    survey_suggestions: Callable[[], Iterable[dict[str, Any]]] = tuple  # what visitors wrote, for the office
    survey_tokens: Callable[[], Any] = tuple  # of programs that read answers: survey's Tokens
    queue: BakingQueue | None = None  # of bakes, for the office
    holdings: Holdings | None = None  # where all that the house has lies, for backups from the office
    quota: int = QUOTA  # [bytes] that the office's drafts and history may have
    survey_standing: Callable[[], list[dict[str, Any]]] = list  # every questionnaire with its answers counted
    survey_made: Callable[..., tuple[str, bytes]] | None = (
        None  # an export or the analysis: survey's Mounted.made
    )
    survey_answers: Mounted | None = None  # what withdrawal codes lead to; None: nothing is asked here
    survey_asks: Callable[[str], bool] = bool  # whether the questionnaire of that id has anything to ask here

    def __post_init__(self) -> None:
        self.stage = Stage(self.scene, self.visitors)
        self.floor: Floor = walking_floor(self.content.plan, self.content.exhibits)
        self._take_grid(ready_grid(self.floor, self._grids, self.start, progress=self.progress))
        self._grid_to_come: Latest[Grid] = Latest()
        self._room_to_come: Latest[ShownRoom] = Latest()
        self._failed: dict[str, Problem] = {}  # key of a bake -> why it failed
        self._pending: frozenset[str] = frozenset()  # names of the bakes that are to come
        self._drawings = 0  # how often what is shown has changed
        self.room: ShownRoom = shown_room(self.content, self.data)
        self._draw_room()
        self._show(drawn_exhibits(self.content, self.data), room_key(self.content, self.data))

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
        self._grid_to_come.drop()
        self._room_to_come.drop()
        self.scene.stop()

    @property
    def problems(self) -> tuple[Problem, ...]:
        """What is wrong with the content now. Asks the survey, which looks at its files and its store."""
        asked = (Problem(p.file, p.key, p.what, p.fix) for p in self.survey_problems())
        return (*self.own_problems, *asked)

    @property
    def own_problems(self) -> tuple[Problem, ...]:
        """What is wrong with the content, the survey's aside."""
        return (*self.content.problems, *self.unbaked, *self.room_problems, *self._given_up)

    @property
    def state(self) -> tuple[object, ...]:
        """What answers about the hall depend on, the survey's part aside: equal states, equal answers."""
        return (self._drawings, self.content.revision, self._pending, self._grid_name, self.own_problems)

    @property
    def _given_up(self) -> tuple[Problem, ...]:
        """What of the content's last change could not be finished beside, though it was begun twice."""
        slow = (("the ways through the changed hall", self._grid_to_come), ("the room", self._room_to_come))
        return tuple(
            Problem(
                "plan.toml",
                "",
                f"{what} could not be computed: {work.failure}",
                "change any file to try again",
            )
            for what, work in slow
            if work.failure is not None
        )

    @property
    def unbaked(self) -> tuple[Problem, ...]:
        """Garments that are not shown as they should be, and will not be without a curator's doing."""
        return self._drawn.unreadable + tuple(
            self._failed.get(self._drawn.keys[e.id] or "")
            or Problem(e.toml, e.file.baked_key or "", "has not been baked", "run hall build")
            for e in self.content.exhibits
            if e.file.baked_key is not None and (self.given_up(e) or self._lacking(e))
        )

    def _lacking(self, exhibit: Exhibit) -> bool:
        return exhibit.id not in self._drawn.models and exhibit.id not in self._pending

    @property
    def preparing(self) -> tuple[str, ...]:
        """The exhibits whose garments are being baked, or wait for it."""
        return tuple(exhibit.id for exhibit in self.content.exhibits if exhibit.id in self._pending)

    @property
    def room_problems(self) -> tuple[Problem, ...]:
        """Why the room is shown without its light or its letters."""
        found = [self._failed[self._room_key]] if self._room_key in self._failed else []
        if self.room.lacking is not None:
            what, _, fix = self.room.lacking.partition(" – ")
            found = [Problem("plan.toml", "", f"the hall's boards are blank: {what}", fix)]
        if self.room.broken is not None:
            file, _, what = self.room.broken.partition(" ")
            how = "as it was before" if self.room.former else "evenly lit"
            found.append(Problem(file, "", f"{what}: the room is shown {how}", "run: hall build --room"))
        return tuple(found)

    def expect(self, bakes: Iterable[Bake]) -> None:
        """What is being baked, or waits for it: no problem, however long it takes and however it went before."""
        bakes = tuple(bakes)
        self._pending = frozenset(bake.name for bake in bakes)
        for bake in bakes:
            self._failed.pop(bake.key, None)

    def baked(self, bake: Bake, failure: str | None) -> None:
        """A bake ended; `failure` says why it did not succeed."""
        exhibit = self.content.exhibit(bake.name)
        if failure is None:
            return
        if bake.name == ROOM:
            what, fix = f"its light could not be computed: {failure}", "run hall build --room"
            self._failed[bake.key] = Problem("plan.toml", "", what, fix)
        elif exhibit is not None:
            what = f"baking failed: {failure}"
            source = exhibit.file.baked_key or "outfit"
            self._failed[bake.key] = Problem(
                exhibit.toml, source, what, f"correct the {source} or what it names"
            )

    def given_up(self, exhibit: Exhibit) -> bool:
        """True when baking these very inputs has failed before."""
        return self._drawn.keys.get(exhibit.id) in self._failed

    @property
    def start(self) -> Pose:
        """Where a visitor comes in."""
        start = self.content.hall.start
        return Pose(start.x, start.z, yaw_of(start.facing), self.content.hall.eye.default)

    def models(self, exhibit: str) -> ExhibitModels | None:
        """What an exhibit is drawn with."""
        return self._drawn.models.get(exhibit)

    def bakes(self) -> dict[str, Path]:
        """Exhibit -> folder its baked media lie in."""
        return {name: models.baked for name, models in self._drawn.models.items() if models.baked is not None}

    @property
    def folders(self) -> tuple[Path, ...]:
        """Folders of the bakes on show, also where the data folder does not hold them."""
        return (*self.bakes().values(), data_room(self.data, self.room.key))

    def shown(self) -> tuple[Exhibit, ...]:
        """The exhibits that stand in the hall."""
        return tuple(exhibit for exhibit in self.content.exhibits if exhibit.id in self._drawn.models)

    async def replace(self, content: Content) -> None:
        """Show changed content, without a restart; visitors stay where they are if they can.

        What takes seconds, the clearance grid of a changed floor and a room that is raised anew, follows by itself.
        """
        floor, drawn, key, right = await in_thread(self._read, content)
        self.content = content
        changed = (floor.outline, floor.solids) != (self.floor.outline, self.floor.solids)
        if changed or self._grid_to_come.failure is not None:
            self.floor = floor
            self._grid_to_come.begin(functools.partial(grid_beside, floor, self._grids, self.start))
            self._change_floor()  # exact obstacles at once; way-finding as soon as it is known
        self._show(drawn, key)
        for visitor in self.visitors:
            if visitor.opened is not None and self.models(visitor.opened) is None:
                self.stage.close(visitor)
        self._tell_news()
        self._room_to_come.drop()
        if not right:
            self._room_to_come.begin(functools.partial(in_thread, shown_room, content, self.data, self.room))

    def _read(self, content: Content) -> tuple[Floor, Drawn, str, bool]:
        """What replace needs of the files, in a thread beside the loop: floor, exhibits, the room's key, and whether
        the room that is shown is the right one."""
        floor = walking_floor(content.plan, content.exhibits)
        drawn = drawn_exhibits(content, self.data, self._drawn.models, self.scene.figures())
        right = still_right(self.room, content, self.data)
        return floor, drawn, room_key(content, self.data), right

    def catch_up(self) -> None:
        """Show what has been finished since the content was replaced. Raises what kept it from being finished."""
        # One after the other: what the one raises must not cost what the other has finished.
        if (grid := self._grid_to_come.take()) is not None:
            self._take_grid(grid)
            self._change_floor()
            self._tell_news()  # the page's grid has another address now
        if (room := self._room_to_come.take()) is not None:
            self._show_room(room)

    def _take_grid(self, grid: Grid) -> None:
        self.grid = grid
        self._grid_name = f"{zlib.crc32(grid.to_bytes()):08x}"

    def _tell_news(self) -> None:
        news = {"t": "content", "revision": self.content.revision, "problems": len(self.problems)}
        for visitor in self.visitors:
            visitor.say(news)

    def _change_floor(self) -> None:
        for visitor in self.visitors:
            if visitor.walk.change_floor(self.floor, self.grid):
                visitor.say(visitor.walk.moved().message())

    def _show_room(self, room: ShownRoom) -> None:
        same = room.glb == self.room.glb
        self.room = room
        self._drawings += 1
        if not same:
            self._draw_room()

    def _draw_room(self) -> None:
        self.scene.show_room(self.room.glb)
        self.scene.show_environment(self.room.environment)

    def room_unlit(self) -> bool:
        """True while the room's light has still to be computed from the content as it is now."""
        right = self.room.baked and not self.room.former
        return not right and self.room.lacking is None and self._room_key not in self._failed

    def _show(self, drawn: Drawn, room: str) -> None:
        """Draw the exhibits. room: key of the room of the content as it is now."""
        self._drawn, self._room_key = drawn, room
        self._drawings += 1
        shown = self.shown()
        self.scene.show(drawn.figures, frozenset(e.id for e in shown if "open_on_click" in e.file.behaviours))
        start = self.start
        self.scene.place_camera(start.x, start.z, start.yaw, start.eye)
        self.stage.play(tuple(_actor(exhibit) for exhibit in shown))

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
        grid = {"url": f"/grid.bin?v={self._grid_name}", **self.grid.meta()}
        return {"mode": self.walk_mode, **walk_constants(body.radius, body.skin), "grid": grid}


def _actor(exhibit: Exhibit) -> Actor:
    place = exhibit.file.place
    return Actor(exhibit.id, place.x, place.z, place.facing, tuple(exhibit.file.behaviours))


def walk_constants(radius: float, skin: float) -> dict[str, float]:
    """Speed and sizes the page predicts with: the server's own."""
    from hall_app.walk import MAX_INPUT_DT, SPEED

    return {"speed": SPEED, "radius": radius, "skin": skin, "max_dt": MAX_INPUT_DT}
