"""A run as one HTML file to print or pass on; called, it is ``report`` of the Python interface.

* report: the file from a run, chapter by chapter; search: its chapters of the search and of its front
* data: what it draws from; csv_table: a table as values; paper_tables, paper_figures: the paper's, for any run
* words: what the case assumes and how far its numbers can be trusted; tables: the tables
* looks: how designs look in its charts, and how large these are
* html_page: the file's frame and how it is put in its place

``hpsop_core.report(run, target, force=False)`` writes it.

Args:
    run: finished or not (``open_run``).
    target: the file.
    force: replace it if it is there.

Returns:
    The file.

Raises:
    InputError: a file that may not or cannot be written.
"""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hpsop_core.runs.reader import RunReader


class _Report(ModuleType):
    def __call__(self, run: RunReader, target: str | Path, force: bool = False) -> Path:
        """See the module."""
        from hpsop_core.report.report import write_report

        return write_report(run, target, force)


sys.modules[__name__].__class__ = _Report
