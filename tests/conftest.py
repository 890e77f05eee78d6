"""Marks the tests that are run with the oldest allowed versions too (`make test-oldest`), a file for each library.

And lets no test call out of the machine.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import no_calls_out
import pytest

# What tests share is `tests.…`. At the end: an installed hpsop stays the one under test with the oldest versions.
sys.path.append(str(Path(__file__).resolve().parents[1]))

OLDEST = {
    "analytical/test_blade_panels_kernels.py": "numba",
    "analytical/test_hull_shapes.py": "numpy, scipy",
    "analytical/test_hull_wigley.py": "numpy, scipy",
    "analytical/test_optimiser_sampling.py": "scipy's Latin hypercube",
    "analytical/test_own_files.py": "scipy's fits",
    "analytical/test_rankine_waves.py": "numba, scipy",
    "experiment/test_blade_panels_p4119.py": "numba, scipy",
    "experiment/test_lifting_line_p4119.py": "scipy",
    "experiment/test_rankine_tank.py": "numba, scipy",
    "faults/test_runs_dask.py": "dask",
    "invariance/test_hull_meshes.py": "trimesh",
    "invariance/test_propeller_meshes.py": "trimesh",
    "invariance/test_same_bits.py": "threadpoolctl",
    "other_code/test_export_design.py": "ezdxf, rhino3dm, trimesh",
    "other_code/test_hull_nurbs_geomdl.py": "geomdl",
    "other_code/test_optimiser_nsga2.py": "pymoo",
    "other_code/test_report_page.py": "markupsafe, the charts",
    "regression/test_contract.py": "every solver",
    "regression/test_demonstration.py": "an old run file",
    "regression/test_interface.py": "every solver",
    "regression/test_packaging.py": "the wheel",
}


no_calls_out.watch()


@pytest.fixture(autouse=True)
def _nothing_calls_out() -> Iterator[None]:
    """Also where the code under test swallowed the refusal."""
    yield
    found = list(no_calls_out.CALLS_OUT)
    no_calls_out.CALLS_OUT.clear()
    assert not found, found


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    # The others need what is not there: a browser's driver, and tools/, which is not in the wheel.
    if config.option.markexpr != "oldest":
        return None
    name = collection_path.relative_to(Path(__file__).parent).as_posix() if collection_path.suffix == ".py" else ""
    return name not in (*OLDEST, "conftest.py") if name else collection_path.name == "browser" or None


# What waits for other processes most first, so that no long file is left alone at the end.
FOLDERS = ("browser", "faults", "other_code", "regression", "invariance", "experiment", "analytical")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Whole files side by side (``--dist loadfile``), all that drive the browser one after another in one process.

    The browser's software graphics need a core, and two of them take each other's time-outs.
    """
    from xdist.scheduler import LoadFileScheduling

    class OneBrowser(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            return "browser" if nodeid.startswith("tests/browser/") else str(super()._split_scope(nodeid))

    return OneBrowser(config, log) if config.getoption("dist") == "loadfile" else None


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    here = Path(__file__).parent
    if hasattr(config, "workerinput"):  # one of the processes side by side
        items.sort(key=lambda item: FOLDERS.index(item.path.relative_to(here).parts[0]))
    for item in items:
        if item.path.relative_to(here).as_posix() in OLDEST:
            item.add_marker(pytest.mark.oldest)
