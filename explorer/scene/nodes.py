"""3D nodes of one browser by name, moved in place where their topology allows, so that little travels."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from explorer.scene.furniture import Boxes, unit_box

Array = NDArray[np.float64]
Colour = tuple[int, int, int]
_UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


class Nodes:
    """Draws meshes, lines and boxes under names in the scene's tree, and remembers what stands there.

    Args:
        client: whose scene.
    """

    def __init__(self, client: viser.ClientHandle) -> None:
        self._scene = client.scene
        self._handles: dict[str, Any] = {}
        self._faces: dict[str, int] = {}

    def get(self, name: str) -> Any:
        """viser's handle of a node, or None while there is none."""
        return self._handles.get(name)

    def show(self, name: str, visible: bool) -> None:
        """Show or hide a node that may not be there yet."""
        handle = self._handles.get(name)
        if handle is not None and handle.visible != visible:
            handle.visible = visible

    def frame(self, name: str, position: tuple[float, float, float]) -> Any:
        """A frame that other nodes hang on."""
        handle = self._handles.get(name)
        if handle is None:
            handle = self._handles[name] = self._scene.add_frame(name, show_axes=False)
        handle.position = position
        return handle

    def mesh(
        self,
        name: str,
        vertices: Array,
        faces: NDArray[np.int64],
        color: Colour,
        opacity: float | None = None,
        visible: bool = True,
    ) -> None:
        """A surface of one colour; where its faces are the ones that stand there, only the vertices travel."""
        handle = self._handles.get(name)
        topology = hash((len(vertices), faces.tobytes()))
        if handle is None or self._faces.get(name) != topology:
            if handle is not None:
                handle.remove()
            handle = self._scene.add_mesh_simple(
                name,
                vertices.astype(np.float32),
                faces.astype(np.uint32),
                color=color,
                opacity=opacity,
                side="double",
                cast_shadow=False,
                receive_shadow=False,
            )
            self._handles[name], self._faces[name] = handle, topology
        else:
            handle.vertices = vertices.astype(np.float32)
            if tuple(handle.color) != color:
                handle.color = color
            if handle.opacity != opacity:
                handle.opacity = opacity
        self.show(name, visible)

    def lines(self, name: str, points: Array, color: Colour, thickness: float = 1.5) -> None:
        """Segments (n, 2, 3), or a line (n, 3), as thick on every screen."""
        handle = self._handles.get(name)
        segments = (points if points.ndim == 3 else np.stack([points[:-1], points[1:]], axis=1)).astype(np.float32)
        colors = np.full((len(segments), 2, 3), color, dtype=np.uint8)
        if handle is not None and handle.points.shape == segments.shape:
            handle.points = segments
            handle.colors = colors
            return
        if handle is not None:
            handle.remove()
        self._handles[name] = self._scene.add_line_segments(
            name, segments, colors, thickness=thickness, thickness_units="screen"
        )

    def boxes(self, name: str, boxes: Boxes, visible: bool) -> None:
        """Boxes, drawn as one node; where there are as many as before, only their places and sides travel."""
        handle = self._handles.get(name)
        centres, sides = boxes.centres.astype(np.float32), boxes.sides.astype(np.float32)
        if handle is not None and handle.batched_positions.shape == centres.shape:
            handle.batched_positions, handle.batched_scales = centres, sides
            if not np.array_equal(handle.batched_colors, boxes.colours):
                handle.batched_colors = boxes.colours
        else:
            if handle is not None:
                handle.remove()
            vertices, faces = unit_box()
            self._handles[name] = self._scene.add_batched_meshes_simple(
                name,
                vertices.astype(np.float32),
                faces.astype(np.uint32),
                np.tile(_UPRIGHT, (len(centres), 1)),
                centres,
                batched_scales=sides,
                batched_colors=boxes.colours,
                lod="off",
                flat_shading=True,
                cast_shadow=False,
                receive_shadow=False,
            )
        self.show(name, visible)
