"""Reading a file in a process of its own: one that crashes or hangs its reader is refused like any other bad file."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import zipfile
from importlib.util import find_spec
from pathlib import Path

from hpsop_core.errors import InputError
from hpsop_core.geometry.foreign.loose import LooseTriangles, unpacked

# Seconds of work that a reader may spend when it has been loaded, and for each megabyte of the file: honest ones of 1.3
# MB (3dm) and 6.2 MB (STEP) take 0.7 and 3 s on a slow, busy machine, small ones a tenth. Then what it may wait.
_SECONDS, _SECONDS_PER_MEGABYTE = 1.2, 6.0
_STARTING, _WAITING = 60.0, 8.0
_ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def own_python(module: str) -> tuple[list[str], dict[str, str]]:
    """The beginning of a command that runs a module of this very tree, wherever it was started from, and its
    environment.
    """
    root = str(Path(__file__).resolve().parents[3])
    paths = [root, *filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))]
    return [sys.executable, "-P", "-m", module], {**os.environ, **_ONE_THREAD, "PYTHONPATH": os.pathsep.join(paths)}


def read_apart(path: Path) -> LooseTriangles:
    """The triangles of a 3dm, STEP or IGES file.

    Args:
        path: of a regular file; its ending tells the reader.

    Raises:
        InputError: the reader is not installed, the file cannot be read, or the reader died or did not end over it.
    """
    kind = path.suffix[1:].upper()
    if kind != "3DM" and find_spec("OCP") is None:
        raise InputError(
            f"{path.name}: reading STEP and IGES needs Open CASCADE; install it by: python -m pip install 'hpsop[cad]' "
            "(or save the hull as STL, OBJ or 3dm)"
        )
    seconds = round(_SECONDS + _SECONDS_PER_MEGABYTE * path.stat().st_size / 1e6, 1)
    command, environment = own_python("hpsop_core.geometry.foreign.child")
    try:
        done = subprocess.run(
            [*command, str(path.absolute()), str(seconds)],
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            timeout=_STARTING + _WAITING * seconds,
            check=False,
        )
    except subprocess.TimeoutExpired:
        ended = signal.SIGXCPU
    except OSError as error:
        raise InputError(f"{path.name}: no process can be started to read it ({error.strerror}); try again") from error
    else:
        ended = signal.Signals(-done.returncode) if done.returncode < 0 else signal.SIGABRT
        if done.returncode == 0:
            try:
                return unpacked(done.stdout)
            except (ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile):
                pass
    if ended in (signal.SIGPROF, signal.SIGXCPU, signal.SIGKILL):
        raise InputError(
            f"{path.name}: its {kind} reader did not end within {seconds:g} s of work; is it damaged? save it again"
        )
    raise InputError(f"{path.name}: its {kind} reader broke down over it; is it damaged? save it again, or as a mesh")
