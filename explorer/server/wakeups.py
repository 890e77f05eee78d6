"""Messages to a browser may be queued by any thread.

viser 1.1.1 sets an ``asyncio.Event`` in the thread that queues a message, and once more in its own loop. An Event is
made for one thread: setting it walks through whoever waits, and where the loop adds or removes a waiter meanwhile the
sender of the message gets "deque mutated during iteration", now and then on a busy page. Here other threads only mark
it, and it wakes in the loop; tests/faults/test_page_guard.py fails when viser's private facts change.
"""

from __future__ import annotations

import asyncio
from functools import cache, wraps
from typing import Any

from viser.infra import _async_message_buffer


class MarkedEvent(asyncio.Event):
    """An Event that other threads than its loop's may set; they wake nobody.

    Args:
        loop: in which it is waited for.
    """

    _value: bool
    _waiters: Any

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        super().__init__()
        self._own_loop = loop

    def set(self) -> None:
        """Mark it, and in its loop wake whoever waits, also where it has been marked before."""
        self._value = True
        # the sender's thread may run a loop of its own
        if asyncio._get_running_loop() is not self._own_loop:
            return
        for waiter in self._waiters:
            if not waiter.done():
                waiter.set_result(True)


@cache
def mend_wakeups() -> None:
    """Let all buffers of messages that are made from now on have such an Event."""
    buffer: Any = _async_message_buffer.AsyncMessageBuffer
    begin = buffer.__init__

    @wraps(begin)
    def begun(self: Any, *arguments: Any, **settings: Any) -> None:
        begin(self, *arguments, **settings)
        self.message_event = MarkedEvent(self.event_loop)

    buffer.__init__ = begun
