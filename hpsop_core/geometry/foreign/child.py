"""The process that reads one file, started by ``apart`` as ``python -P -m ... PATH SECONDS``; answers on its output.

It may die: a library that a damaged file leads astray then takes nothing else with it.
"""

from __future__ import annotations

import contextlib
import importlib
import math
import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

from hpsop_core.errors import InputError
from hpsop_core.geometry.foreign.loose import LooseTriangles, packed

MOST_MEMORY = 4 << 30
"""Bytes that it may map: a hull of some million faces takes a quarter of that."""


def _bound(seconds: float) -> None:
    """What it may use from now on; a system without such limits is left as it is."""
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        _, already = resource.getrlimit(resource.RLIMIT_AS)
        most = MOST_MEMORY if already == resource.RLIM_INFINITY else min(MOST_MEMORY, already)
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
        # work, not waiting: a busy machine must not make a good file a bad one
        signal.setitimer(signal.ITIMER_PROF, seconds)
        # whole seconds, for a library that takes the timer away
        whole = math.ceil(time.process_time() + seconds) + 1
        resource.setrlimit(resource.RLIMIT_CPU, (whole, whole))
        resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _reader(suffix: str) -> Callable[[Path], LooseTriangles]:
    """The reader with its libraries loaded, which is no work of the file's."""
    with contextlib.suppress(ImportError):
        importlib.import_module("rhino3dm" if suffix == ".3dm" else "OCP.STEPControl")
    if suffix == ".3dm":
        from hpsop_core.geometry.foreign.rhino import read_3dm

        return read_3dm
    from hpsop_core.geometry.foreign.open_cascade import read_step_or_iges

    return read_step_or_iges


def main(path: Path, seconds: float) -> None:
    """Read the file and write the answer, packed, to where standard output led at the start."""
    # readers of other people's formats write to standard output
    answer_to = os.dup(1)
    os.dup2(2, 1)
    answer: LooseTriangles | InputError
    try:
        read = _reader(path.suffix.lower())
        _bound(seconds)
        answer = read(path)
    except InputError as refusal:
        answer = refusal
    except MemoryError:
        answer = InputError(f"{path.name}: needs more than {MOST_MEMORY >> 20} MB to be read; save it coarser")
    # whatever a library throws over a damaged file
    except Exception as error:  # noqa: BLE001
        kind = path.suffix[1:].upper()
        answer = InputError(f"{path.name}: cannot be read as {kind} ({type(error).__name__}: {error}); save it again")
    with os.fdopen(answer_to, "wb") as output:
        output.write(packed(answer))
    # a library that was led astray may not find its way out
    os._exit(0)


if __name__ == "__main__":
    main(Path(sys.argv[1]), float(sys.argv[2]))
