"""A radial table as it was understood, written in the contract's own columns."""

from __future__ import annotations

import numpy as np

from hpsop_core.geometry.propeller.input.columns import COLUMNS
from hpsop_core.geometry.propeller.radial_table import RadialTable


def normalised_text(table: RadialTable) -> str:
    """The table as text with every column, numbers with as many digits as they have."""
    columns = (
        table.radius_ratio,
        table.chord_ratio,
        table.pitch_ratio,
        np.degrees(table.skew),
        table.rake_ratio,
        table.thickness_ratio,
        table.camber_ratio,
    )
    rows = (",".join(f"{value!r}" for value in row) for row in np.column_stack(columns).tolist())
    return "\n".join([",".join(COLUMNS), *rows]) + "\n"
