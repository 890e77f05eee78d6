"""Small HTML buttons inside charts' panels; a press reaches Python through the bridge."""

from __future__ import annotations

from hpsop_core.markup import escape


def chip(
    action: str, word: str, arg: str = "", on: bool = False, disabled: bool = False, css: str = "", hint: str = ""
) -> str:
    """One button.

    Args:
        action: name of the event.
        word: its text.
        arg: what the event carries.
        on: shown as pressed.
        disabled: shown grey and without effect.
        css: an extra class.
        hint: on hover.
    """
    return (
        f'<button type="button" class="chip {css}{" on" if on else ""}" data-act="{escape(action)}" '
        f'data-arg="{escape(arg)}" aria-pressed="{"true" if on else "false"}" '
        f'aria-disabled="{"true" if disabled else "false"}" title="{escape(hint)}">{escape(word)}</button>'
    )


def chips(*parts: str) -> str:
    """A row of buttons."""
    return f'<div class="chips">{"".join(parts)}</div>'


def box(content: str) -> str:
    """The padded frame of every piece of HTML in a panel."""
    return f'<div class="hp">{content}</div>'
