"""How long a test waits for what ought to happen: longer where the machine is busy with other things."""

from __future__ import annotations

import os

_MOST = 10.0


def patience(seconds: float) -> float:
    """Seconds to wait for what takes ``seconds`` at most on a machine that does nothing else."""
    return seconds * min(max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1)), _MOST)
