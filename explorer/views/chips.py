"""Small HTML buttons inside charts' panels; a press reaches Python through the bridge."""

from __future__ import annotations

from hpsop_core.markup import Markup, fill, joined

GAP = Markup('<span class="gap"></span>')
NOTHING = Markup("")


def chip(
    action: str,
    word: str | Markup,
    arg: str = "",
    on: bool = False,
    disabled: bool = False,
    css: str = "",
    hint: str = "",
) -> Markup:
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
    return fill(
        '<button type="button" class="chip {css}{pressed}" data-act="{action}" data-arg="{arg}" '
        'aria-pressed="{on}" aria-disabled="{disabled}" title="{hint}">{word}</button>',
        css=css,
        pressed=" on" if on else "",
        action=action,
        arg=arg,
        on="true" if on else "false",
        disabled="true" if disabled else "false",
        hint=hint,
        word=word,
    )


def chips(*parts: Markup) -> Markup:
    """A row of buttons."""
    return fill('<div class="chips">{}</div>', joined(parts))


def box(*parts: Markup) -> Markup:
    """The padded frame of every piece of HTML in a panel."""
    return fill('<div class="hp">{}</div>', joined(parts))


def soft(words: object, tag: str = "p") -> Markup:
    """Words that step back."""
    return fill('<{tag} class="soft">{words}</{tag}>', tag=tag, words=words)
