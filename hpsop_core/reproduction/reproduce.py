"""The folder of a reproduction: one HTML page and its tables as CSV files, of the paper's case or of any other."""

from __future__ import annotations

from pathlib import Path

from hpsop_core.errors import InputError
from hpsop_core.evaluation.levels import FAST
from hpsop_core.report.data import ReportData
from hpsop_core.reproduction.comparison import Reproduction, checked_run, is_of_the_paper, tables
from hpsop_core.reproduction.own_run import own_page_html, own_tables
from hpsop_core.reproduction.page import page_html
from hpsop_core.reproduction.paper import CASE_NAME
from hpsop_core.runs.reader import RunReader
from hpsop_core.writing import write_whole

PAGE = "reproduction.html"

__all__ = ["PAGE", "checked_run", "made_folder", "run_path", "write_reproduction"]


def run_path(folder: str | Path) -> Path:
    """Where a reproduction keeps its run; the folder is made if it is not there.

    Raises:
        InputError: the folder cannot be made or is none.
    """
    return made_folder(folder) / f"{CASE_NAME}.hpsop"


def made_folder(folder: str | Path) -> Path:
    """The folder, made if it is not there.

    Raises:
        InputError: it cannot be made or is none.
    """
    target = Path(folder)
    try:
        target.mkdir(parents=True, exist_ok=True)
    except FileExistsError as error:
        raise InputError(f"{target}: is a file; --to needs a folder") from error
    except OSError as error:
        raise InputError(f"{target}: cannot be made ({error.strerror or error}); choose another folder") from error
    return target


def write_reproduction(run: RunReader, folder: str | Path) -> tuple[Path, ...]:
    """Write the page and its tables; those of an earlier call are replaced, other files stay.

    Args:
        run: finished or not; of the paper's case it is set beside the paper, of another one it stands alone.
        folder: made if it is not there.

    Returns:
        The files written.

    Raises:
        InputError: a run that has evaluated nothing, or whose hull or propeller file is gone or changed, or a folder
            that cannot be used.
        SolverFailure: a design of the paper's cannot be computed.
    """
    if is_of_the_paper(run):
        data = Reproduction.of(run)
        made = tables(data)
        text = page_html(data, made)
    else:
        run.check_ship()
        run.initial(FAST.number)  # there is nothing to show without it
        report = ReportData.of(run)
        made = own_tables(report)
        text = own_page_html(report, made)
    target = made_folder(folder)
    texts = {PAGE: text, **{f"{item.name}.csv": item.csv() for item in made}}
    for name, content in texts.items():
        write_whole(target / name, content)
    return tuple(target / name for name in texts)
