"""matplotlib without a window system, for pictures of the documentation; nothing installed needs it."""

from __future__ import annotations

from typing import Any

import matplotlib


def pyplot() -> Any:
    """matplotlib's plotting state, which writes PNG."""
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    return plt
