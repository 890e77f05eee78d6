"""The one door by which HTML goes to a browser."""

from __future__ import annotations

import viser

from hpsop_core.markup import Markup

_NOTHING = Markup("")


class Slot:
    """An HTML element of a panel. Nothing else on the page makes one or sets its content.

    It does not flicker: content that stands there already is not sent again.

    Args:
        gui: where the element goes.
        content: to begin with. It is markup by type: text from a file or a person is escaped by then.
    """

    def __init__(self, gui: viser.GuiApi, content: Markup = _NOTHING) -> None:
        # viser's encoder knows plain text only
        self._handle = gui.add_html(str(content))
        self._content = content

    def show(self, content: Markup) -> None:
        """Show this markup from now on."""
        if content != self._content:
            self._content = content
            self._handle.content = str(content)
