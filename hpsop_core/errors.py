"""The two ways in which something can go wrong, both told in one line for people."""

from __future__ import annotations

# Of a message: what stands first names the place, what stands last the remedy; an echo in the middle may be cut.
_HEAD, _TAIL = 500, 250
_SHOWN = 60


def message_line(text: str) -> str:
    """A message of one printable line and bounded length, whatever it echoes: line breaks, controls, whole books."""
    if len(text) > _HEAD + _TAIL + 5:
        text = f"{text[:_HEAD]} ... {text[-_TAIL:]}"
    text = " ".join(text.split())
    return "".join(letter if letter.isprintable() else ascii(letter)[1:-1] for letter in text)


def shown(value: object) -> str:
    """A stranger's value as it may be echoed: short, and also where it is a number that Python refuses to print."""
    if isinstance(value, str | bytes):
        value = value[: _SHOWN + 1]
    try:
        text = repr(value)
    except (ValueError, RecursionError):
        return f"this {type(value).__name__}"
    return text if len(text) <= _SHOWN else text[: _SHOWN - 3] + "..."


class HpsopError(Exception):
    """Base of every error that hpsop raises on purpose; its text is one line for a person (``message_line``)."""

    def __init__(self, text: str) -> None:
        super().__init__(message_line(text))


class InputError(HpsopError):
    """What the user stated cannot be used: the text names the file or field, what is wrong and what to do."""


class SolverFailure(HpsopError):
    """A computation that cannot give a number; it becomes a failed evaluation, never a NaN.

    Args:
        stage: which part of the evaluation failed, for example "rankine" or "lifting_line".
        reason: one line with the numbers that explain it.
    """

    def __init__(self, stage: str, reason: str) -> None:
        super().__init__(f"{stage}: {reason}")
        self.stage = stage
        self.reason = reason

    def __reduce__(self) -> tuple[type[SolverFailure], tuple[str, str]]:
        # The default reduction would call the constructor with one argument; failures cross process borders.
        return (SolverFailure, (self.stage, self.reason))
