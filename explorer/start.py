"""`hpsop-explore`: loads the page without what its libraries load for others, runs it, and ends the process.

The page is loaded when the command is called and not before: the workers of a run import the program that started them
(multiprocessing does so that they know its functions), and a second of imports would be most of their start.
"""

from __future__ import annotations

import atexit
import os
import signal
import sys
import threading
from typing import NoReturn

from hpsop_core.lean_imports import lean_imports
from hpsop_core.standard_streams import mend_standard_streams

_ENDING_SECONDS = 10.0
_INTERRUPTED = 130


def main() -> NoReturn:
    """As ``explorer.app.main``, which may end by an exception; does not return."""
    mend_standard_streams()
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupted)
    with lean_imports():
        from explorer.app import main as page
        from explorer.server.process import serve_from_here
    serve_from_here()
    status = page()
    # What is worth keeping has been closed. Python's own end would wait for every thread of every pool, look through a
    # million objects for a second, and for a lock that a daemon thread held when it was stopped it would wait for ever.
    late = threading.Timer(_ENDING_SECONDS, os._exit, (status,))
    late.daemon = True
    late.start()
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


def _interrupted(*_: object) -> NoReturn:
    """Ctrl-C until the page listens to it itself, for a second or two, and for another where a run is large.

    Nothing has been begun that must be ended; an exception would come out of whatever is being loaded, as another one
    where that tidies up behind itself.
    """
    sys.stderr.write("hpsop-explore: interrupted\n")
    sys.stderr.flush()
    os._exit(_INTERRUPTED)
