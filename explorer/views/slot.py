"""A piece of HTML in a panel that is sent only when it differs from what stands there."""

from __future__ import annotations

import viser


class Slot:
    """An HTML element that does not flicker: equal content is not sent again."""

    def __init__(self, gui: viser.GuiApi, content: str = "") -> None:
        self._handle = gui.add_html(content)
        self._content = content

    def show(self, content: str) -> None:
        """Show this from now on."""
        if content != self._content:
            self._content = content
            self._handle.content = content
