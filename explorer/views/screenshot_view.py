"""The 3D view as a picture file: of any size, with the sky or with nothing behind the ship."""

from __future__ import annotations

import io

import viser
from PIL import Image

from explorer.scene.surroundings import backdrop
from explorer.server.bridge import PageEvent
from explorer.state.session import Session
from explorer.state.shown import file_name
from explorer.views.scene_view import SceneView

LEAST_SIDE, MOST_SIDE = 100, 7680


class ScreenshotView:
    """Takes the picture that was asked for and gives it to the browser.

    Args:
        session: whose.
        scene: what is photographed.
        client: who gets it.
    """

    def __init__(self, session: Session, scene: SceneView, client: viser.ClientHandle) -> None:
        self._session = session
        self._scene = scene
        self._client = client
        session.gestures.on("act", "screenshot", lambda _event: session.heavy.latest("screenshot", self._take))
        session.gestures.on("act", "picture_size", self._size)
        session.gestures.on("act", "picture_side", self._side)

    def _size(self, event: PageEvent) -> None:
        """A size by its button, "3840x2160"; "window" is the window's own."""
        width, _, height = event.arg.partition("x")
        if width == "window":
            self._session.set_options(picture_width=0, picture_height=0)
        elif width.isdecimal() and height.isdecimal():
            self._sides(int(width), int(height))

    def _side(self, event: PageEvent) -> None:
        """One side by its number box, "width=1200"."""
        side, _, text = event.arg.partition("=")
        if not text.isdecimal():
            return
        width, height = self.size()
        self._sides(*((int(text), height) if side == "width" else (width, int(text))))

    def _sides(self, width: int, height: int) -> None:
        if LEAST_SIDE <= width <= MOST_SIDE and LEAST_SIDE <= height <= MOST_SIDE:
            self._session.set_options(picture_width=width, picture_height=height)
        else:
            self._session.notify(
                "No such picture", f"a side has {LEAST_SIDE} to {MOST_SIDE} pixels, not {width} x {height}", "yellow"
            )

    def size(self) -> tuple[int, int]:
        """Width and height of the next picture, px."""
        return self._session.options.picture_size(self._session.size)

    def _take(self) -> None:
        options = self._session.options
        width, height = self.size()
        try:
            image = self._scene.picture(width, height, options.picture_transparent)
        except (TimeoutError, RuntimeError) as error:
            self._session.notify("No screenshot", str(error), "yellow")
            return
        file = io.BytesIO()
        picture = Image.fromarray(image)
        if not options.picture_transparent:
            # viser photographs without what lies as far away as the sky
            behind = Image.fromarray(backdrop(options.dark, picture.height)).resize(picture.size).convert("RGBA")
            picture = Image.alpha_composite(behind, picture.convert("RGBA")).convert("RGB")
        picture.save(file, format="PNG")
        name = f"{file_name(self._session.selected)}.png"
        self._client.send_file_download(name, file.getvalue(), save_immediately=True)
