"""The one door by which HTML goes to a browser."""

from __future__ import annotations

import viser


class Slot:
    """An HTML element of a panel. Nothing else on the page makes one or sets its content.

    It does not flicker: content that stands there already is not sent again.

    Args:
        gui: where the element goes.
        content: markup to begin with.
    """

    def __init__(self, gui: viser.GuiApi, content: str = "") -> None:
        self._handle = gui.add_html(content)
        self._content = content

    def show(self, content: str) -> None:
        """Show this markup from now on."""
        if content != self._content:
            self._content = content
            self._handle.content = content
