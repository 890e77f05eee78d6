"""What a browser may say to the page's widgets, and nothing else.

viser 1.1.1 trusts its clients: a message may set any attribute of a widget's state (its limits, its callbacks), a value
out of range or NaN reaches callbacks, 3.5 becomes 3 on a whole-number widget, a dropdown takes words that are no
option. Here one handler stands before viser's own: it lets through a new value that the widget itself could have
produced, and refuses the rest in words. The page has no forms, and the shared widgets take no files: their messages are
not listened to at all. Files that a browser's own widgets take are explorer/server/uploads.py's matter.

This leans on private facts of viser 1.1.1; the version is pinned and tests/faults/test_page_guard.py fails when they
change.
"""

from __future__ import annotations

import math
from collections.abc import Awaitable, Callable
from typing import Any

import viser
from viser import _messages

from hpsop_core.errors import InputError

MOST_CHARACTERS = 10_000
_FORMS = (_messages.GuiFormSubmitMessage, _messages.GuiFormDirtyMessage)
_FILES = (_messages.FileTransferStartUpload, _messages.FileTransferPart)


def guard(gui: viser.GuiApi, refuse: Callable[[int, str], None], files: bool = False) -> None:
    """Check every message to the widgets of ``gui`` (the server's or one client's) before viser acts on it.

    Args:
        gui: whose widgets.
        refuse: told (client id, why) of what was refused; must not block.
        files: whether these widgets take files, which ``Uploads`` then bounds.
    """
    interface = gui._websock_interface
    pass_on: Callable[[Any, Any], Awaitable[None]] = gui._handle_gui_updates

    async def handle(client_id: Any, message: _messages.GuiUpdateMessage) -> None:
        widget = gui._gui_input_handle_from_uuid.get(message.uuid)
        if widget is None:
            return
        try:
            check_update(widget, message.updates)
        except InputError as error:
            refuse(int(client_id), str(error))
            # what was refused must not stay on that browser's screen
            if not isinstance(widget, viser.GuiUploadButtonHandle):
                interface.queue_message(_messages.GuiUpdateMessage(message.uuid, {"value": widget.value}))
            return
        await pass_on(client_id, message)

    interface.unregister_handler(_messages.GuiUpdateMessage, gui._handle_gui_updates)
    interface.register_handler(_messages.GuiUpdateMessage, handle)
    for kind in _FORMS if files else (*_FORMS, *_FILES):
        interface.unregister_handler(kind)


def check_update(widget: Any, updates: Any) -> None:
    """Whether a browser may change a widget like this.

    Args:
        widget: viser's handle.
        updates: attribute -> new value, as it came.

    Raises:
        InputError: anything but one new value that the widget itself could have produced.
    """
    label = str(getattr(widget, "label", "") or "widget")
    if isinstance(widget, viser.GuiUploadButtonHandle):
        raise InputError(f"{label}: choose a file with the page's own button")
    if not isinstance(updates, dict) or set(updates) != {"value"}:
        raise InputError(f"{label}: only its value can be changed from a browser")
    value, now = updates["value"], widget.value
    if isinstance(now, tuple):
        if not isinstance(value, list | tuple) or len(value) != len(now):
            raise InputError(f"{label}: needs {len(now)} numbers; drag the slider's thumbs")
        for item, like in zip(value, now, strict=True):
            _check_one(widget, label, item, like)
    else:
        _check_one(widget, label, value, now)


def _check_one(widget: Any, label: str, value: Any, now: Any) -> None:
    if isinstance(now, bool):
        if not isinstance(value, bool):
            raise InputError(f"{label}: {_short(value)} is neither on nor off")
        return
    if isinstance(now, str):
        if not isinstance(value, str) or len(value) > MOST_CHARACTERS:
            raise InputError(f"{label}: {_short(value)} is no text of at most {MOST_CHARACTERS} characters")
        options = getattr(widget, "options", None)
        if options is not None and value not in options:
            raise InputError(f"{label}: {_short(value)} is no option; use one of {', '.join(options)}")
        return
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(f"{label}: {_short(value)} is not a finite number")
    if isinstance(now, int) and value != round(value):
        raise InputError(f"{label}: {value:g} is not a whole number")
    # A field of numbers is typed digit by digit: its limits are judged when the typing rests (settings_view.py).
    if isinstance(widget, viser.GuiSliderHandle | viser.GuiMultiSliderHandle):
        slack = 1e-6 * max(abs(widget.step), 1e-12)
        if not widget.min - slack <= value <= widget.max + slack:
            raise InputError(f"{label}: {value:g} is outside its limits {widget.min:g} to {widget.max:g}")


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."
