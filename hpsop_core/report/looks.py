"""How designs look in the charts on paper, and how large these are."""

from __future__ import annotations

from hpsop_core.charts.looks import Look, Sheet
from hpsop_core.charts.style import PRINT

INITIAL_LOOK = Look("initial", "initial", "dash")
COMPROMISE_LOOK = Look("compromise", "selected")
SPREAD_ROLES = ("chosen2", "chosen3", "chosen4", "chosen5", "chosen1")
"""Of the other designs along a front: the compromise's colour comes last."""

SHEET = Sheet(390.0, 285.0, PRINT)
"""Two stand side by side on A4, where letters are then 7 pt; on a phone one fills the width."""

SMALL_SHEET = Sheet(390.0, 245.0, PRINT)
"""The same, for charts of one family of curves."""
