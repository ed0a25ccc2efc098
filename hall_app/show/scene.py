"""What viser draws: room, exhibits, lights, and one studio for close-ups. With its adapter, all that talks to viser."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from hall_app.room.picture.studio import studio_glb
from hall_app.show.pieces import Pieces
from hall_app.show.viser_adapter import open_viser, queue_environment
from hall_app.visit.visitors import Marks, Visitor

if TYPE_CHECKING:
    import viser

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
        """Draw these exhibits; what is unchanged stays as it is."""
        self._clickable = clickable
        last, self._figures = self._figures, {figure.id: figure for figure in figures}
        for exhibit in last:
            if exhibit not in self._figures:
                self.pieces.hide(node_name(exhibit))
        changed = {
            exhibit
            for exhibit, figure in self._figures.items()
            if exhibit not in last or (last[exhibit].hall, last[exhibit].first) != (figure.hall, figure.first)
        }
        for exhibit in changed:
            figure = self._figures[exhibit]
            self.pieces.show(node_name(exhibit), figure.hall, first=figure.first)
        self._draw(self.server.scene, self._handles, changed, first=True)
        for client_id, client in self.server.get_clients().items():
            if (handles := self._brought.get(client_id)) is not None:
                self._draw(client.scene, handles, changed, first=False)

    def bring(self, client_id: int | None) -> None:
        """Draw for this page, which stands in the hall, what was not in its first view."""
        client = None if client_id is None else self.server.get_clients().get(client_id)
        if client is not None:
            handles = self._brought.setdefault(client.client_id, {})
            self._draw(client.scene, handles, set(), first=False)

    def _draw(
        self, scene: viser.SceneApi, handles: dict[str, viser.GlbHandle], changed: set[str], *, first: bool
    ) -> None:
        """Of all figures those that are, or are not, of the first view."""
        wanted = {exhibit: figure for exhibit, figure in self._figures.items() if figure.first == first}
        for gone in handles.keys() - wanted.keys():
            handles.pop(gone).remove()
        for exhibit, figure in wanted.items():
            if exhibit in changed or exhibit not in handles:
                handles[exhibit] = self._add(scene, figure)
            handles[exhibit].position = (figure.x, figure.y, figure.z)
            handles[exhibit].wxyz = about_y(math.radians(figure.facing))

    def _add(self, scene: viser.SceneApi, figure: Figure) -> viser.GlbHandle:
        model = self.pieces.stand_in(figure.hall)
        handle = scene.add_glb(node_name(figure.id), model, cast_shadow=False, receive_shadow=False)
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
