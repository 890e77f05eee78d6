"""The process that reads files of unknown origin: bounded in memory, unable to write a file, ended from outside.

Started by explorer/services/reading.py as ``python -P -m explorer.services.reading_process SOCKET BYTES``; SOCKET is an
inherited connection that brings pickled jobs and takes pickled answers, BYTES the most memory that it may map.
"""

from __future__ import annotations

import contextlib
import importlib
import os
import pickle
import signal
import sys
from multiprocessing.connection import Connection

from explorer.services.reading_job import Refused, answer

READY = b"ready"


def _bound(memory: int) -> None:
    """What the process may use; a system without such limits is left as it is."""
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def serve(connection: Connection, memory: int) -> None:
    """Answer jobs until the other end is closed."""
    # Ctrl-C is for the page, which then closes the connection
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # readers of other people's formats write to standard output
    os.dup2(2, 1)
    # most meshes ask for it: before the file is there
    with contextlib.suppress(ImportError):
        importlib.import_module("trimesh")
    connection.send_bytes(READY)
    _bound(memory)
    while True:
        try:
            job = pickle.loads(connection.recv_bytes())  # noqa: S301 - from the page that started us
        except EOFError:
            return
        try:
            found = pickle.dumps(answer(job))
        except MemoryError:
            found = pickle.dumps(Refused(f"{job.name}: needs more than {memory >> 20} MB to be read; thin it"))
        # A reader that stumbles over a file is a refusal of that file; the page stays.
        except Exception as error:  # noqa: BLE001
            found = pickle.dumps(Refused(f"{job.name}: cannot be read ({type(error).__name__}: {str(error)[:200]})"))
        connection.send_bytes(found)


if __name__ == "__main__":
    serve(Connection(int(sys.argv[1])), int(sys.argv[2]))
