"""The one door by which HTML goes to a browser."""

from __future__ import annotations

import viser

from hpsop_core.errors import HpsopError
from hpsop_core.markup import Markup, fill

_NOTHING = Markup("")
# viser orders a panel's elements by a number, which it counts up itself
_LAST = 1e9


def reason_of(error: BaseException) -> str:
    """What people are told of an error: our own are sentences, others need their kind."""
    return str(error) if isinstance(error, HpsopError) else f"{type(error).__name__}: {error}"


def failure(error: BaseException) -> Markup:
    """What stands where something could not be drawn."""
    return fill(
        '<div class="hp"><p class="bad" role="alert" data-failed="1">This could not be drawn ({}). What changes next '
        "draws it again; the rest of the page goes on.</p></div>",
        reason_of(error),
    )


class Slot:
    """An HTML element of a panel. Nothing else on the page makes one or sets its content.

    It does not flicker: content that stands there already is not sent again.

    Args:
        gui: where the element goes.
        content: to begin with. It is markup by type: text from a file or a person is escaped by then.
        last: below whatever is added to the panel afterwards.
    """

    def __init__(self, gui: viser.GuiApi, content: Markup = _NOTHING, last: bool = False) -> None:
        # viser's encoder knows plain text only
        self._handle = gui.add_html(str(content), order=_LAST if last else None)
        self._content = content

    def failed(self, error: BaseException) -> None:
        """Say that what belongs here could not be drawn, in place of what is no longer true."""
        self.show(failure(error))

    def show(self, content: Markup) -> None:
        """Show this markup from now on."""
        if content != self._content:
            self._content = content
            self._handle.content = str(content)
