"""The two ways in which something can go wrong, both told in one line for people."""

from __future__ import annotations


class HpsopError(Exception):
    """Base of every error that hpsop raises on purpose; its text is one line for a person."""


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
