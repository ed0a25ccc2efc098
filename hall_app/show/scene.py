"""What viser draws: room, exhibits, lights, and one studio for close-ups. With its adapter, all that talks to viser."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from hall_app.room.picture.studio import studio_glb
from hall_app.show.pieces import Pieces
from hall_app.show.viser_adapter import open_viser, queue_environment
from hall_app.visit.visitors import Marks, Visitor

if TYPE_CHECKING:
    import viser

    _Owner = viser.ViserServer | viser.ClientHandle  # whoever draws with it: everybody, or one page

__all__ = ["STUDIO", "Figure", "HallScene", "Model"]

# The studio lies far outside the hall: one WebGL context, no second page, and the walker's pose is untouched.
STUDIO = (500.0, 0.0, 0.0)
ENVIRONMENT = 0.4  # strength of the room's reflection beside the lights
CLOSEUP, COMPARISON = "/closeup", "/comparison"  # what stands there, by the nodes the page knows
FIELD_OF_VIEW = math.radians(58)  # 75 degrees, the client's own, stretches dress at the rim


@dataclass(frozen=True)
class Model:
    """What is shown from close by: a GLB's bytes, the height [m] of its middle, and how far it reaches from there."""

    glb: Callable[[], bytes]
    centre: float
    radius: float


@dataclass(frozen=True)
class Figure:
    """One exhibit as drawn: GLB bytes for the hall, foot at (x, y, z) [m], `facing` [deg] about +y; close: for the
    close-up; compared: what it shows there side by side on request; first: before a visitor can enter, else after."""

    id: str
    hall: bytes
    close: Model
    x: float
    y: float
    z: float
    facing: float
    compared: Model | None = None
    first: bool = True


def _place(figure: Figure) -> tuple[float, ...]:
    return figure.x, figure.y, figure.z, figure.facing


def node_name(exhibit: str) -> str:
    return f"/exhibits/{exhibit}"


def about_y(angle: float) -> tuple[float, float, float, float]:
    """Unit quaternion (w, x, y, z) of a turn about +y [rad]."""
    return (math.cos(angle / 2), 0.0, math.sin(angle / 2), 0.0)


class HallScene:
    """viser's server on a port of its own behind 127.0.0.1, with the hall in it."""

    def __init__(self) -> None:
        self.server: viser.ViserServer = open_viser()
        self.port: int = self.server.get_port()
        self.pieces = Pieces()
        self.marks = Marks()
        self._handles: dict[str, viser.GlbHandle] = {}
        self._figures: dict[str, Figure] = {}
        self._clickable = frozenset[str]()
        # Page -> what was brought to it after its first view. viser's threads forget pages.
        self._brought: dict[int, dict[str, viser.GlbHandle]] = {}
        self._on_click: Callable[[int, str], None] = lambda client, exhibit: None
        self._configure()

    def _configure(self) -> None:
        scene, gui = self.server.scene, self.server.gui
        scene.set_up_direction("+y")
        self.show_environment(None)
        scene.configure_default_lights(False, False)
        # They touch the exhibits alone: the room is drawn unlit and carries its own light.
        # viser's lamps shine from their position towards the origin, the hemisphere's sky lies where it stands.
        scene.add_light_hemisphere(
            "/light/sky",
            sky_color=(255, 246, 230),
            ground_color=(120, 96, 78),
            intensity=0.8,
            position=(0.0, 10.0, 0.0),
        )
        scene.add_light_directional(
            "/light/key", color=(255, 244, 226), intensity=2.3, position=(7.0, 5.0, 3.5)
        )
        gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False)
        self.server.initial_camera.fov = FIELD_OF_VIEW
        self.server.on_client_connect(self._mark)
        self.server.on_client_disconnect(self._forget)

    async def _mark(self, client: viser.ClientHandle) -> None:
        mark = self.marks.make(client.client_id)
        client.scene.add_frame(f"/_visitor/{mark}", show_axes=False, visible=False)
        # The same mark for a page whose hooks are missing: plain HTML in viser's (hidden) panel.
        client.gui.add_html(f'<i data-hall-client="{mark}"></i>')

    async def _forget(self, client: viser.ClientHandle) -> None:
        self.marks.forget(client.client_id)
        self._brought.pop(client.client_id, None)

    # The hall.

    def show_room(self, glb: bytes) -> None:
        """Draw (again) the room, and the studio of close-ups."""
        add, show = self.server.scene.add_glb, self.pieces.show
        add("/room", show("/room", glb), cast_shadow=False, receive_shadow=False)
        studio = show("/studio", studio_glb())
        add("/studio", studio, position=STUDIO, cast_shadow=False, receive_shadow=False)

    def show_environment(self, jpeg: bytes | None) -> None:
        """What silk and metal reflect: a plain equirectangular JPEG of the room; None: nothing."""
        if jpeg is None:
            self.pieces.hide("environment")
        picture = None if jpeg is None else self.pieces.show("environment", jpeg)
        queue_environment(self.server, picture, ENVIRONMENT)

    def place_camera(self, x: float, z: float, yaw: float, eye: float) -> None:
        """Where a page that has not said hello yet looks from."""
        self.server.initial_camera.position = (x, eye, z)
        self.server.initial_camera.look_at = (x - math.sin(yaw), eye, z - math.cos(yaw))

    def show(self, figures: tuple[Figure, ...], clickable: frozenset[str]) -> None:
        """Draw these exhibits; what is unchanged stays as it is, and of the first view while it stands in the hall."""
        self._clickable = clickable
        last = self._figures
        self._figures = {
            one.id: replace(one, first=last[one.id].first) if one.id in last else one for one in figures
        }
        for exhibit in last.keys() - self._figures.keys():
            self.pieces.hide(node_name(exhibit))
        changed = {one.id for one in figures if one.id not in last or last[one.id].hall != one.hall}
        moved = {one.id for one in figures if one.id not in last or _place(last[one.id]) != _place(one)}
        for exhibit, figure in self._figures.items():  # in their order, which names the pack
            if exhibit in changed:
                self.pieces.show(node_name(exhibit), figure.hall, first=figure.first)
        self._draw_again(self.server, self._handles, changed, moved)
        for client_id, client in self.server.get_clients().items():
            if (handles := self._brought.get(client_id)) is not None:
                self._draw_again(client, handles, changed, moved)
        for exhibit, figure in self._figures.items():
            if figure.first and exhibit not in self._handles:
                self._draw(self.server, self._handles, figure)

    def bring(self, client_id: int | None, x: float, z: float) -> None:
        """Draw for this page, whose visitor is at (x, z) [m], the nearest of what it lacks; its first view stands.

        One at a time: what a page is told, it takes in order, a close-up after the exhibits that it was told of before.
        """
        client = None if client_id is None else self.server.get_clients().get(client_id)
        if client is None:
            return
        handles = self._brought.setdefault(client.client_id, {})
        lacking = [one for one in self._figures.values() if not one.first and one.id not in handles]
        if lacking:
            self._draw(client, handles, min(lacking, key=lambda one: math.hypot(one.x - x, one.z - z)))
        if client.client_id not in self.server.get_clients():  # gone meanwhile
            self._brought.pop(client.client_id, None)

    def _draw_again(
        self, owner: _Owner, handles: dict[str, viser.GlbHandle], changed: set[str], moved: set[str]
    ) -> None:
        """What everybody, or one page, has been shown; what the hall holds no longer is taken away."""
        for exhibit in tuple(handles):
            if exhibit not in self._figures:
                handles.pop(exhibit).remove()
            elif exhibit in changed or exhibit in moved:
                self._draw(owner, handles, self._figures[exhibit], anew=exhibit in changed)

    def _draw(
        self, owner: _Owner, handles: dict[str, viser.GlbHandle], figure: Figure, *, anew: bool = True
    ) -> None:
        with owner.atomic():  # it never stands elsewhere before its place is told
            if anew:
                handles[figure.id] = self._add(owner.scene, figure)
            handles[figure.id].position = (figure.x, figure.y, figure.z)
            handles[figure.id].wxyz = about_y(math.radians(figure.facing))

    def _add(self, scene: viser.SceneApi, figure: Figure) -> viser.GlbHandle:
        node = node_name(figure.id)
        handle = scene.add_glb(node, self.pieces.mark(node), cast_shadow=False, receive_shadow=False)
        if figure.id in self._clickable:
            handle.on_click(lambda event, exhibit=figure.id: self._clicked(event, exhibit))
        return handle

    def _clicked(self, event: Any, exhibit: str) -> None:
        if event.client_id is not None:
            self._on_click(event.client_id, exhibit)

    def when_clicked(self, act: Callable[[int, str], None]) -> None:
        """Call `act(viser client id, exhibit id)`, on one of viser's threads."""
        self._on_click = act

    def figures(self) -> dict[str, Figure]:
        """How the exhibits are drawn now, by their ids."""
        return dict(self._figures)

    def nodes(self) -> list[str]:
        """Names of all nodes a page waits for."""
        return ["/room", *(node_name(one.id) for one in self._figures.values() if one.first)]

    # What a behaviour may ask for (show.Figures).

    def node(self, exhibit: str) -> str:
        return node_name(exhibit)

    def show_closeup(self, visitor: Visitor, exhibit: str) -> dict[str, Any]:
        """Put the fine model into the studio, for this visitor alone."""
        return self._in_studio(visitor, CLOSEUP, self._figures[exhibit].close)

    def show_comparison(self, visitor: Visitor, exhibit: str) -> dict[str, Any] | None:
        """In its place, what the exhibit compares; None where that is nothing."""
        compared = self._figures[exhibit].compared
        return None if compared is None else self._in_studio(visitor, COMPARISON, compared)

    def _in_studio(self, visitor: Visitor, node: str, model: Model) -> dict[str, Any]:
        client = self.server.get_clients().get(visitor.client) if visitor.client is not None else None
        if client is not None:
            glb = self.pieces.stand_in(model.glb())
            client.scene.remove_by_name(COMPARISON if node == CLOSEUP else CLOSEUP)
            client.scene.add_glb(node, glb, position=STUDIO, cast_shadow=False, receive_shadow=False)
            client.flush()
        x, y, z = STUDIO
        return {"node": node, "studio": {"x": x, "y": y + model.centre, "z": z, "radius": model.radius}}

    def hide_closeup(self, visitor: Visitor) -> None:
        client = self.server.get_clients().get(visitor.client) if visitor.client is not None else None
        if client is not None:
            for node in (CLOSEUP, COMPARISON):
                client.scene.remove_by_name(node)

    def aim_camera(self, client_id: int, eye: tuple[float, float, float], yaw: float) -> None:
        """Move a page's camera from here, for a page without hooks."""
        client = self.server.get_clients().get(client_id)
        if client is None:
            return
        x, y, z = eye
        with client.atomic():
            client.camera.position = (x, y, z)
            client.camera.look_at = (x - math.sin(yaw), y, z - math.cos(yaw))

    def stop(self) -> None:
        self.server.stop()
