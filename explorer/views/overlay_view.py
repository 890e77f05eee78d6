"""Waves on the water and pressures on hull and blades, at the chosen condition, with their legends."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import trimesh
import viser
from numpy.typing import NDArray

from explorer.scene.colours import PRESSURE, SEA, around_zero, painted, pressure_legend, sea_legend
from explorer.scene.pressure import PressureMap
from explorer.scene.waves import wave_surface
from explorer.services.designs import Designs
from explorer.state.session import Session
from explorer.state.shown import Shown
from explorer.views.chips import soft
from hpsop_core.errors import HpsopError
from hpsop_core.markup import Markup

# the hull's underwater part stays visible, faintly
_WATER_OPACITY = 0.9
# around what evaporates: no colour of the pressure scale
_VAPOUR = (20, 20, 24)


class OverlayView:
    """Draws what is asked for and takes it away again; each map is computed once a design and condition."""

    def __init__(self, session: Session, designs: Designs, client: viser.ClientHandle) -> None:
        self._session = session
        self._designs = designs
        self._client = client
        self._nodes: dict[str, Any] = {}
        self._drawn: dict[str, tuple[object, ...]] = {}
        session.hub.on(("selection", "options"), self._ask)
        self._ask()

    def _ask(self) -> None:
        self._session.slow.latest("overlays", self.draw)

    def draw(self) -> None:
        """Bring the overlays to the session's selection and options."""
        session = self._session
        shown, options = session.selected, session.options
        if shown is None:
            return
        if not shown.evaluation.conditions:
            # a design that failed has none: those of the one before are not its
            for name in list(self._drawn):
                self._remove(name)
            return
        if not (options.waves or options.pressure or self._drawn):
            return
        # the blades' map hangs on the propeller's frame, which turns: the ship has to stand first
        session.heavy.wait_until_idle(30.0)
        index = min(options.condition, len(shown.evaluation.conditions) - 1)
        key = (shown.key, index, session.picture.case)
        self._one("waves", options.waves, key, lambda: self._waves(shown, index))
        self._one("pressure", options.pressure and options.hull, key, lambda: self._pressure(shown, index))
        self._one("blades", options.pressure, key, lambda: self._blades(shown, index))

    def _one(self, name: str, wanted: bool, key: tuple[object, ...], make: Callable[[], None]) -> None:
        session = self._session
        if not wanted:
            if name in self._drawn:
                self._remove(name)
            return
        if self._drawn.get(name) == key:
            return
        before = self._drawn.get(name)
        if before is not None and before[-1] != key[-1]:
            # of another run: not for a moment beside this one's ship
            self._remove(name)
        session.set_legend(name, soft(f"computing the {name} …", "div"))
        try:
            make()
            self._drawn[name] = key
        except HpsopError as error:
            self._remove(name)
            session.notify(f"No {name} for this design", str(error), "yellow")

    def _remove(self, name: str) -> None:
        self._drop(name)
        if name == "blades":
            self._drop("vapour")
        self._drawn.pop(name, None)
        self._session.set_legend(name, None)

    def _waves(self, shown: Shown, index: int) -> None:
        surface = wave_surface(self._designs.waves(shown.evaluation, index))
        # The few highest crests at the bow must not wash out the rest.
        reach = max(float(np.percentile(np.abs(surface.elevation), 97.0)), 0.05)
        opacity = _WATER_OPACITY * surface.opacity
        mesh = painted(surface.vertices, surface.faces, surface.elevation, (-reach, 0.0, reach), SEA, opacity)
        self._show("waves", "/waves", mesh)
        self._session.set_legend("waves", sea_legend(reach, surface.note))

    def _pressure(self, shown: Shown, index: int) -> None:
        found = self._designs.hull_pressure(shown.evaluation, index)
        self._map("pressure", "/ship/pressure", found, Markup("hull pressure C<sub>p</sub> [–]"))

    def _blades(self, shown: Shown, index: int) -> None:
        found = self._designs.blade_pressure(shown.evaluation, index)
        self._map("blades", "/ship/propeller/pressure", found, Markup("blade pressure C<sub>p</sub> [–]"))
        self._outline(found.evaporating())

    def _outline(self, edge: NDArray[np.float64]) -> None:
        """The edge of the area below vapour pressure, drawn on the blades."""
        if not len(edge):
            self._drop("vapour")
            return
        colours = np.full((len(edge), 2, 3), _VAPOUR, dtype=np.uint8)
        self._nodes["vapour"] = self._client.scene.add_line_segments(
            "/ship/propeller/vapour", edge.astype(np.float32), colours, thickness=2.5, thickness_units="screen"
        )

    def _drop(self, name: str) -> None:
        node = self._nodes.pop(name, None)
        if node is not None:
            node.remove()

    def _map(self, name: str, node: str, found: PressureMap, title: Markup) -> None:
        limits = around_zero(found.coefficient, found.areas())
        self._show(name, node, painted(found.vertices, found.faces, found.coefficient, limits, PRESSURE))
        self._session.set_legend(name, pressure_legend(title, limits, found.note))

    def _show(self, name: str, node: str, mesh: trimesh.Trimesh) -> None:
        # Colours travel only with a whole mesh (GLB): replaced on selection, never during a drag.
        self._nodes[name] = self._client.scene.add_mesh_trimesh(node, mesh, cast_shadow=False, receive_shadow=False)
