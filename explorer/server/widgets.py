"""Values of viser's widgets, set from Python."""

from __future__ import annotations

from typing import Any


def set_value(widget: Any, value: Any) -> None:
    """Let a widget show this value, in every browser that has it.

    viser 1.1.1 sets a value in ``__setattr__`` while its types call ``value`` read-only; here alone that is known.
    """
    if widget.value != value:
        widget.value = value
