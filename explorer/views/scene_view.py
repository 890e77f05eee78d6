"""The selected design in 3D: hull, propeller in its aperture, water, waterline, ghost."""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from explorer.scene.camera import CLOSE_UPS, LONG_VIEWS, PRESETS, CameraPose, nearest_seen, preset
from explorer.scene.geometry import SceneGeometry
from explorer.scene.nodes import Nodes
from explorer.scene.surroundings import calm_water, sky
from explorer.server.bridge import PageEvent
from explorer.services.designs import Designs
from explorer.state.session import PHONE_SHEET, Session
from explorer.views.on_display import ghost_of
from hpsop_core.errors import HpsopError

UNDERWATER = (182, 62, 46)
TOPSIDES = (54, 74, 102)
DECK = (126, 128, 122)
BOOT_TOP = (240, 238, 230)
MARKS = (236, 236, 228)
RUDDER = (158, 58, 46)
SHADOW = (12, 34, 58)
BRONZE = (196, 150, 72)
HUB = (150, 118, 66)
# the initial design's grey and the pins' colours on the charts (assets/page.css)
GHOST = (107, 119, 133)
PINS = ((11, 114, 133), (166, 30, 77), (92, 148, 13), (134, 46, 156))
# the sea reaches this many ship lengths from midships
_SEA_LENGTHS = 1.15
_SKY_LENGTHS = 100.0
_GHOST_OPACITY = 0.17
_SHADOW_OPACITY = 0.3
# a ghost beside the selected ship lies this many breadths to port, and is nearly solid
_ABEAM, _ABEAM_OPACITY = 1.5, 0.85
# the propeller turns at a quarter of its real rate: a screen cannot show 100 rpm of five blades
_SPIN_SCALE = 0.25
# viser's own camera for pictures sees so far, m: a long lens from far away would show nothing
_PHOTOGRAPHED = 1000.0
# software graphics take some time for 4K
_PICTURE_SECONDS = 90.0
_FRAME_SECONDS = 1.0 / 25.0


def prepare_scene(designs: Designs) -> None:
    """Make what a browser will see first, so that it need not wait for it.

    Raises:
        HpsopError: the run's compromise or its initial design has no shape.
    """
    first = designs.best().evaluation
    for variables in (first.variables, designs.initial(first.level).evaluation.variables):
        designs.geometry(variables, near=False)
        designs.ghost(variables, near=False)
    sky(dark=False)
    calm_water(dark=False)


class SceneView:
    """One browser's own 3D nodes, moved in place where the topology allows."""

    def __init__(self, session: Session, designs: Designs, client: viser.ClientHandle) -> None:
        self._session = session
        self._designs = designs
        self._client = client
        self._nodes = Nodes(client)
        self._sea: viser.GlbHandle | None = None
        self._sky: viser.GlbHandle | None = None
        self._sky_radius = 1.0
        self._drawn: tuple[object, ...] = ()
        self._geometry: SceneGeometry | None = None
        self._framed: tuple[float, float, float] | None = None
        # where the camera was last put, and for a view of which shape
        self._placed: deque[np.ndarray] = deque(maxlen=4)
        self._framed_for = 0.0
        self._told, self._docked = 0.0, False
        self._abeam = 0.0
        self._hidden_for_backs: bool | None = None
        self._made_room, self._keeps_panels = False, False
        self._spinning = threading.Event()
        self._dark: bool | None = None
        self._begun = False
        # a surroundings' map as light doubles what a frame costs without graphics hardware; lamps do
        client.scene.configure_environment_map(None)
        client.scene.configure_default_lights(cast_shadow=False)
        # light from below as well: half of what a naval architect looks at is under water
        client.scene.add_light_hemisphere(
            "/lights/sky", sky_color=(255, 255, 255), ground_color=(190, 200, 215), intensity=3.2
        )
        session.hub.on(("selection", "options", "pins"), self._ask)
        session.hub.on(("size",), lambda: self.place_camera())
        session.gestures.on("act", "camera", self._camera)
        session.on_close(self._spinning.clear)
        client.camera.on_update(self._looked)

    def begin(self) -> None:
        """The browser's panels stand: now the ship, which keeps one without graphics hardware busy for a second."""
        self._begun = True
        self._ask()

    def _ask(self) -> None:
        if self._begun:
            self._session.heavy.latest("geometry", self.draw)

    def draw(self) -> None:
        """Bring the scene to the session's selection and options."""
        session = self._session
        shown, options = session.selected, session.options
        if options.dark != self._dark:
            self._dark = options.dark
            if self._sky is not None:
                self._sky.remove()
            self._sky = self._client.scene.add_glb(
                "/sky", sky(options.dark), scale=self._sky_radius, cast_shadow=False, receive_shadow=False
            )
            if self._sea is not None:
                self._sea.remove()
                self._sea = None
        if shown is None:
            return
        ghost, pin = ghost_of(session, self._designs)
        ghost_colour = GHOST if pin is None else PINS[pin]
        state = (
            shown.key,
            options.dark,
            options.ghost,
            ghost.key if ghost else None,
            ghost_colour,
            options.beside,
            options.hull,
            options.topsides,
            options.fittings,
            options.water,
            options.waves,
            options.pressure,
            options.camera in CLOSE_UPS,
            session.picture.case,
        )
        if state != self._drawn:
            try:
                near = options.camera in CLOSE_UPS
                geometry = self._designs.geometry(shown.evaluation.variables, near)
                variables = ghost.evaluation.variables if ghost else None
                behind = (
                    (self._designs.geometry(variables, near), self._designs.ghost(variables, near))
                    if variables
                    else None
                )
            except HpsopError as error:
                session.notify("No geometry for this design", str(error), "yellow")
                return
            before, self._framed = self._framed, _bounds(geometry, behind[0] if behind else None)
            was_abeam, self._abeam = self._abeam, _ABEAM * self._framed[1] if behind and options.beside else 0.0
            self._geometry = geometry
            # A ship of another size is framed anew, unless the user has moved the camera; before the ship stands there,
            # so that nobody sees it cut.
            other = before is None or abs(before[0] - self._framed[0]) > 0.02 * before[0] or was_abeam != self._abeam
            if before is None or (other and self._unmoved()):
                self.place_camera()
            with self._client.atomic():
                self._draw_ship(geometry, behind, ghost_colour)
            self._client.flush()
            self._drawn = state
        self._spin()

    def _draw_ship(
        self,
        geometry: SceneGeometry,
        ghost: tuple[SceneGeometry, np.ndarray] | None,
        ghost_colour: tuple[int, int, int],
    ) -> None:
        options, nodes = self._session.options, self._nodes
        close_up = options.camera in CLOSE_UPS
        above, fitted = options.hull and options.topsides, options.hull and options.fittings
        below = options.hull and not options.pressure
        nodes.mesh("/ship/underwater", *geometry.underwater, color=UNDERWATER, visible=below)
        nodes.mesh("/ship/topsides", *geometry.topsides, color=TOPSIDES, visible=above)
        nodes.mesh("/ship/deck", *geometry.deck, color=DECK, visible=above)
        nodes.mesh("/ship/boot_top", *geometry.boot_top, color=BOOT_TOP, visible=above)
        nodes.mesh("/ship/marks", *geometry.marks, color=MARKS, visible=above and fitted and below)
        nodes.mesh("/ship/rudder", *geometry.rudder, color=RUDDER, visible=fitted and below)
        nodes.boxes("/ship/fittings", geometry.boxes, visible=above and fitted)
        nodes.frame("/ship/propeller", geometry.propeller_position)
        nodes.mesh("/ship/propeller/blades", *geometry.blades, color=BRONZE, visible=not options.pressure)
        nodes.mesh("/ship/propeller/hub", *geometry.hub, color=HUB)
        # a sheet of water would tint the colours of pressures under it
        calm = options.water and not (close_up or options.waves or options.pressure)
        self._water(geometry, calm)
        nodes.mesh("/shadow", *geometry.shadow, color=SHADOW, opacity=_SHADOW_OPACITY, visible=calm and above)
        if ghost is not None:
            shell, lines = ghost
            nodes.frame("/ghost", (0.0, self._abeam, 0.0))
            opacity = _ABEAM_OPACITY if options.beside else _GHOST_OPACITY
            nodes.mesh("/ghost/below", *shell.underwater, color=ghost_colour, opacity=opacity)
            nodes.mesh("/ghost/above", *shell.topsides, color=ghost_colour, opacity=opacity, visible=options.topsides)
            # two decks at nearly one height would only flicker through each other
            deck = options.topsides and options.beside
            nodes.mesh("/ghost/deck", *shell.deck, color=ghost_colour, opacity=opacity, visible=deck)
            nodes.lines("/ghost/lines", lines, ghost_colour, 1.0)
        for name in ("/ghost/below", "/ghost/above", "/ghost/deck", "/ghost/lines"):
            if ghost is None:
                nodes.show(name, False)
            elif name in ("/ghost/below", "/ghost/lines"):
                nodes.show(name, options.hull)
            elif not options.hull:
                nodes.show(name, False)

    def _water(self, geometry: SceneGeometry, visible: bool) -> None:
        if self._sea is None:
            self._sea = self._client.scene.add_glb(
                "/water", calm_water(bool(self._dark)), cast_shadow=False, receive_shadow=False
            )
        if self._sky is not None:
            self._sky_radius = _SKY_LENGTHS * geometry.length
            self._sky.scale = self._sky_radius
            self._sky.position = (0.5 * geometry.length, 0.0, geometry.draft)
        self._sea.position = (0.5 * geometry.length, 0.0, geometry.draft)
        self._sea.scale = _SEA_LENGTHS * geometry.length
        if self._sea.visible != visible:
            self._sea.visible = visible

    # ---- camera ----------------------------------------------------------------------------------------------------
    def _camera(self, event: PageEvent) -> None:
        if event.arg in PRESETS:
            options = self._session.options
            if self._hidden_for_backs is None:
                # the first press after a reload: what stands there was our doing before it
                self._hidden_for_backs = options.camera == "backs" and not options.hull
                self._made_room = options.camera in LONG_VIEWS and options.wide
            hull = options.hull
            if event.arg == "backs":
                # they look forward, at the hull
                hull, self._hidden_for_backs = False, hull or self._hidden_for_backs
            elif self._hidden_for_backs:
                hull, self._hidden_for_backs = True, False
            self._session.set_options(camera=event.arg, hull=hull, wide=self._wide(event.arg))
            self.place_camera()

    def _wide(self, camera: str) -> bool:
        """Whether the panels make room for a view: a ship's profile is seven times as long as it is high.

        They come back with the next other view; who has opened them in such a view meanwhile keeps them.
        """
        wide = self._session.options.wide
        if self._made_room and not wide:
            self._made_room, self._keeps_panels = False, True
        if camera in LONG_VIEWS:
            if not wide and not self._keeps_panels:
                self._made_room = wide = True
        elif self._made_room:
            self._made_room = wide = False
        return wide

    def _unmoved(self) -> bool:
        now = np.asarray(self._client.camera.position)
        # a browser's word about its shape may be older than the last of these
        return not self._placed or any(
            float(np.linalg.norm(now - placed)) < 1e-3 * float(np.linalg.norm(placed)) for placed in self._placed
        )

    def _aspect(self) -> float:
        """Width over height of the 3D view: the browser's own word once the docks stand, till then what they leave."""
        return self._told if self._docked else self._between_docks()

    def _between_docks(self) -> float:
        session = self._session
        width, height = session.size
        if session.phone:
            return width / ((1.0 - PHONE_SHEET) * height)
        right = 0 if session.options.wide else session.dock_width
        return max(width - session.left_dock - right, 200.0) / max(height, 200.0)

    def _looked(self, camera: viser.CameraHandle) -> None:
        """The browser says where its camera is: a view of another shape is framed anew, unless the user has moved."""
        first, self._told = self._told == 0.0, float(camera.aspect)
        # one dock appears after the other, and a browser does not say so while its camera rests
        self._docked = self._docked or 0.0 < self._told < 1.1 * self._between_docks()
        # a browser's first word is where its camera stood before it heard of ours
        self._refocus(camera)
        other = self._docked and abs(self._told - self._framed_for) > 0.02 * self._told and self._unmoved()
        if first or other:
            self._session.worker.latest("camera", self.place_camera)

    def _refocus(self, camera: viser.CameraHandle) -> None:
        """What is cut off before the camera follows its distance from the ship."""
        if self._framed is None:
            return
        x, y, z = (float(value) for value in camera.position)
        near = nearest_seen((x, y, z), self._framed, self._abeam)
        if not 0.5 < near / camera.near < 2.0:
            camera.near = near

    def place_camera(self) -> None:
        """Put the camera where its preset stands."""
        geometry, framed = self._geometry, self._framed
        if geometry is None or framed is None:
            return
        self._framed_for = self._aspect()
        pose = self._pose(geometry, framed, self._framed_for)
        camera = self._client.camera
        with self._client.atomic():
            camera.near, camera.far = nearest_seen(pose.position, framed, self._abeam), 2.5 * _SKY_LENGTHS * framed[0]
            camera.up_direction = pose.up
            camera.position = pose.position
            camera.look_at = pose.look_at
            camera.fov = pose.field_of_view
        self._placed.append(np.asarray(pose.position, dtype=float))

    def _pose(
        self, geometry: SceneGeometry, framed: tuple[float, float, float], aspect: float, lens: float | None = None
    ) -> CameraPose:
        return preset(
            self._session.options.camera,
            *framed,
            (float(geometry.propeller_position[0]), float(geometry.propeller_position[2])),
            geometry.diameter,
            aspect,
            self._abeam,
            lens,
        )

    def picture(self, width: int, height: int, transparent: bool) -> NDArray[np.uint8]:
        """The view as an image of any size, (height, width, 4), with nothing behind the ship where asked for.

        From a preset the ship fills the picture whatever its shape; a camera that was moved keeps what it shows from
        the upper to the lower edge.

        Raises:
            TimeoutError: the browser gives no picture in time.
            RuntimeError: it has left.
        """
        stand: dict[str, Any] = {}
        if self._geometry is not None and self._framed is not None and self._unmoved():
            for lens in (None, 0.3, 0.5, 0.75, 1.0):
                pose = self._pose(self._geometry, self._framed, width / height, lens)
                if math.dist(pose.position, pose.look_at) + 0.2 * self._framed[0] < _PHOTOGRAPHED:
                    break
            stand = {"wxyz": pose.orientation(), "position": pose.position, "fov": pose.field_of_view}
        sky = self._sky if transparent else None
        if sky is not None:
            sky.visible = False
            self._client.flush()
        try:
            image = self._client.get_render(height, width, transport_format="png", timeout=_PICTURE_SECONDS, **stand)
        finally:
            if sky is not None:
                sky.visible = True
        return np.asarray(image, dtype=np.uint8)

    # ---- spin ------------------------------------------------------------------------------------------------------
    def _spin(self) -> None:
        wanted = self._session.options.spin
        if wanted and not self._spinning.is_set():
            self._spinning.set()
            threading.Thread(target=self._turn, name="spin", daemon=True).start()
        elif not wanted:
            self._spinning.clear()

    def _turn(self) -> None:
        angle, last = 0.0, time.monotonic()
        while self._spinning.is_set():
            now = time.monotonic()
            shown = self._session.selected
            conditions = shown.evaluation.conditions if shown is not None else ()
            index = min(self._session.options.condition, len(conditions) - 1)
            rate = conditions[index].rotation_rate_rpm / 60.0 if conditions else 0.0
            # right-handed: clockwise seen from astern, looking forward along +x, is a positive turn about +x
            angle = (angle + 2.0 * math.pi * rate * _SPIN_SCALE * (now - last)) % (2.0 * math.pi)
            last = now
            frame = self._nodes.get("/ship/propeller")
            if frame is not None:
                frame.wxyz = (math.cos(angle / 2.0), math.sin(angle / 2.0), 0.0, 0.0)
            time.sleep(_FRAME_SECONDS)


def _bounds(ship: SceneGeometry, ghost: SceneGeometry | None) -> tuple[float, float, float]:
    """Length, breadth and draft (m) that hold the ship and its ghost."""
    both = [ship] if ghost is None else [ship, ghost]
    return max(item.length for item in both), max(item.breadth for item in both), max(item.draft for item in both)
