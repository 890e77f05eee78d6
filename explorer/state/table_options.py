"""How the table of all designs is shown."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

WHICH = ("feasible", "front", "starred", "all")
"""Which designs the table can hold: feasible ones, the newest front's, those with a star, all that did not fail."""


@dataclass(frozen=True)
class TableOptions:
    """How the table of all designs is shown; belongs to a browser.

    Attributes:
        columns: quantity keys in order; empty for the usual ones.
        sort: key of the column that orders the rows, or "id", "level" or "generation".
        descending: the greatest first.
        which: one of ``WHICH``.
        page: from 0.
        choosing: whether the choice of columns stands open.
    """

    columns: tuple[str, ...] = ()
    sort: str = "f1"
    descending: bool = False
    which: str = "feasible"
    page: int = 0
    choosing: bool = False

    def restored(self, saved: object) -> TableOptions:
        """These with what ``saved`` says of columns, order and choice, where it says something sensible."""
        if not isinstance(saved, dict):
            return self
        columns, sort = saved.get("columns"), saved.get("sort")
        named = isinstance(columns, list | tuple) and all(isinstance(key, str) for key in columns)
        return dataclasses.replace(
            self,
            columns=tuple(columns)[:100] if named and columns is not None else self.columns,
            sort=sort if isinstance(sort, str) else self.sort,
            descending=saved.get("descending") is True,
            which=saved["which"] if saved.get("which") in WHICH else self.which,
        )
