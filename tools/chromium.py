"""Which Chromium shows the page without a screen, and how it starts: for pictures, benchmarks and browser tests."""

from __future__ import annotations

import shutil

_ALONE = (
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
ARGUMENTS = (*_ALONE, "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
"""Software graphics, and nothing fetched from outside: the page itself is drawn by SwiftShader's GL too."""

AS_FOUND = (*_ALONE, "--enable-unsafe-swiftshader")
"""Nothing fetched, and the graphics that Chromium finds: on a machine without any it draws pages without GL, as it does
for people there, and SwiftShader draws the 3D view alone."""


def chromium_program() -> str | None:
    """The path of the installed Chromium, or None."""
    names = ("chromium", "chromium-browser", "google-chrome")
    return next((path for name in names if (path := shutil.which(name))), None)
