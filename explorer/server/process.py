"""What a process that serves the page asks of Python and of the C library: to answer soon, and not to grow."""

from __future__ import annotations

import gc
import sys

from hpsop_core.kept_memory import give_back_memory, share_freed_memory

# A press goes through four threads before its answer is on its way; each may wait a turn for one that draws news.
_TURN_SECONDS = 0.001
# how many searches of the young for one of all that live, a tenth of a second; Python's own number is 10
_SELDOM = 60


def serve_from_here() -> None:
    """Make this process one that serves pages; before it has threads, and once."""
    sys.setswitchinterval(_TURN_SECONDS)
    share_freed_memory()
    # what has been imported stays: a search for garbage, which stops every thread, need not look through it
    gc.freeze()
    # and next to nothing of what a large run holds is garbage: that is looked through when something has gone (tidy)
    gc.set_threshold(*gc.get_threshold()[:2], _SELDOM)


def tidy() -> None:
    """Give back what pages and runs held: they hang together in circles, and the C library keeps freed memory."""
    gc.collect()
    give_back_memory()
