"""The folder of a reproduction: one HTML page and its tables as CSV files."""

from __future__ import annotations

from pathlib import Path

from hpsop_core.errors import InputError
from hpsop_core.report.html_page import write_whole
from hpsop_core.reproduction.comparison import Reproduction, checked_run, tables
from hpsop_core.reproduction.page import page_html
from hpsop_core.reproduction.paper import CASE_NAME
from hpsop_core.runs.reader import RunReader

PAGE = "reproduction.html"

__all__ = ["PAGE", "checked_run", "run_path", "write_reproduction"]


def run_path(folder: str | Path) -> Path:
    """Where a reproduction keeps its run; the folder is made if it is not there.

    Raises:
        InputError: the folder cannot be made or is none.
    """
    target = Path(folder)
    try:
        target.mkdir(parents=True, exist_ok=True)
    except FileExistsError as error:
        raise InputError(f"{target}: is a file; --to needs a folder") from error
    except OSError as error:
        raise InputError(f"{target}: cannot be made ({error.strerror or error}); choose another folder") from error
    return target / f"{CASE_NAME}.hpsop"


def write_reproduction(run: RunReader, folder: str | Path) -> tuple[Path, ...]:
    """Write the page and its tables; those of an earlier call are replaced, other files stay.

    Args:
        run: of the paper's case, finished or not.
        folder: made if it is not there.

    Returns:
        The files written.

    Raises:
        InputError: a run of another case, or a folder that cannot be used.
        SolverFailure: a design of the paper's cannot be computed.
    """
    data = Reproduction.of(run)
    target = run_path(folder).parent
    made = tables(data)
    texts = {PAGE: page_html(data, made), **{f"{item.name}.csv": item.csv() for item in made}}
    for name, content in texts.items():
        write_whole(target / name, content)
    return tuple(target / name for name in texts)
