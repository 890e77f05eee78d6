"""No traces of other people's programs in the terminal.

A frame that viser 1.1.1 cannot read ends its connection with a traceback, one a frame; a message to a browser that has
just left is a warning, and a message it handles badly another traceback. None of them can be mended by who reads the
terminal: each kind is told in one line, with a count (explorer/server/notices.py), and its trace at the level DEBUG.
"""

from __future__ import annotations

import logging
import warnings
from asyncio import AbstractEventLoop
from typing import Any

from explorer.server.notices import Notices

_LOG = logging.getLogger("hpsop.explorer")
# where websockets tells of a connection that viser's handler gave up
_LOGGER = "websockets.server"


class _Retold(logging.Filter):
    """Of what websockets logs, the troubles are told our way."""

    def __init__(self, notices: Notices) -> None:
        super().__init__()
        self._notices = notices

    def filter(self, record: logging.LogRecord) -> bool:
        if record.levelno < logging.WARNING:
            return True
        error = record.exc_info[1] if record.exc_info else None
        _retell(self._notices, error, "its connection was closed")
        return False


def _retell(notices: Notices, error: BaseException | None, end: str) -> None:
    kind = type(error).__name__ if error is not None else "no reason given"
    notices.tell(f"frame {kind}", f"a browser sent what no page of ours sends ({kind}); {end}")
    _LOG.debug("what a browser sent", exc_info=error)


def quiet(loop: AbstractEventLoop, notices: Notices) -> logging.Filter:
    """Tell troubles with connections in one line a kind; returns the filter, for ``loud_again``.

    Args:
        loop: viser's.
        notices: where they are told.
    """

    def handle(_loop: AbstractEventLoop, context: dict[str, Any]) -> None:
        _retell(notices, context.get("exception"), "it was not heeded")

    loop.call_soon_threadsafe(loop.set_exception_handler, handle)
    for text in (r"Queued a \w+ on a closed connection", r"\[viser\] .* does not match annotation"):
        warnings.filterwarnings("ignore", message=f"(?s){text}")
    told = _Retold(notices)
    logging.getLogger(_LOGGER).addFilter(told)
    return told


def loud_again(told: logging.Filter) -> None:
    """Undo ``quiet``, when its server has ended."""
    logging.getLogger(_LOGGER).removeFilter(told)
