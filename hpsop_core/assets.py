"""Access to the files that hpsop ships, in a checkout and in an installed wheel alike."""

from __future__ import annotations

from importlib.resources import files
from importlib.resources.abc import Traversable

ASSET_PACKAGE = "hpsop_assets"
SHIPPED_HULLS = ("dtc",)
# With the number of blades that each table was drawn for.
SHIPPED_PROPELLERS = {"p4119": 3}


def asset_path(*parts: str) -> Traversable:
    """The shipped file or folder at ``parts`` below assets/, for example ``asset_path("cases", "dtc-p4119.toml")``."""
    path: Traversable = files(ASSET_PACKAGE)
    for part in parts:
        path = path / part
    return path


def read_asset_text(*parts: str) -> str:
    """The text of a shipped file.

    Raises:
        FileNotFoundError: there is no such shipped file.
    """
    return asset_path(*parts).read_text(encoding="utf-8")
