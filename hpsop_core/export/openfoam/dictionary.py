"""The head of every OpenFOAM file."""

from __future__ import annotations

from collections.abc import Sequence


def foam_file(name: str, body: str, kind: str = "dictionary") -> str:
    """A file of this class with its head."""
    return (
        f"FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       {kind};\n"
        f"    object      {name};\n}}\n\n{body.strip()}\n"
    )


def vector(values: Sequence[float]) -> str:
    """(a b c), to a micrometre of a ship."""
    return "(" + " ".join(f"{value:.9g}" for value in values) + ")"
