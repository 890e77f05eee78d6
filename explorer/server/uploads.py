"""Files from a browser, bounded in size, number and time before viser keeps a byte of them.

viser 1.1.1 keeps as many parts of as many files as a browser sends, of any size and for as long as it stays. Here two
handlers stand before viser's own: they let one file of a browser through at a time, to a button that takes files, no
larger than it said and than ``LARGEST_FILE``; what is not there after ``LONGEST_SECONDS`` is dropped.
The name that a browser gives a file is for people only (``shown_name``): nothing is ever written under it.

This leans on private facts of viser 1.1.1; the version is pinned and tests/faults/test_uploads.py fails when they
change.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from typing import Any

import viser
from viser import _messages

from hpsop_core.errors import InputError

LARGEST_FILE = 64 * 1024 * 1024
LONGEST_SECONDS = 180.0
# viser's own page cuts a file into parts of this size
_PART = 512 * 1024
_LONGEST_NAME = 80


class Uploads:
    """What may come through one browser's upload buttons.

    Args:
        gui: the browser's.
        refuse: told (client id, why) of what was refused; must not block.
        begun: called when a file that is let through begins to arrive; must not block.
        seconds: for a whole file.
    """

    def __init__(
        self,
        gui: viser.GuiApi,
        refuse: Callable[[int, str], None],
        begun: Callable[[], None] = lambda: None,
        seconds: float = LONGEST_SECONDS,
    ) -> None:
        self._gui = gui
        self._refuse = refuse
        self._begun = begun
        self._seconds = seconds
        interface = gui._websock_interface
        interface.unregister_handler(_messages.FileTransferStartUpload, gui._handle_file_transfer_start)
        interface.unregister_handler(_messages.FileTransferPart, gui._handle_file_transfer_part)
        interface.register_handler(_messages.FileTransferStartUpload, self._start)
        interface.register_handler(_messages.FileTransferPart, self._part)

    def _start(self, client_id: Any, message: _messages.FileTransferStartUpload) -> None:
        button = self._gui._gui_input_handle_from_uuid.get(message.source_component_uuid)
        if not isinstance(button, viser.GuiUploadButtonHandle):
            return
        try:
            check_start(button, message.size_bytes, message.part_count)
        except InputError as error:
            self._end(int(client_id), message, str(error))
            return
        # a browser has one file under way at a time: what it had begun before is forgotten
        self._gui._current_file_upload_states.clear()
        self._begun()
        self._gui._handle_file_transfer_start(client_id, message)
        timer = threading.Timer(self._seconds, self._late, (int(client_id), message))
        timer.daemon = True
        timer.start()

    def _part(self, client_id: Any, message: _messages.FileTransferPart) -> None:
        state = self._gui._current_file_upload_states.get(message.transfer_uuid)
        if state is None:
            return
        content: object = message.content
        if not isinstance(content, bytes) or state["transferred_bytes"] + len(content) > state["total_bytes"]:
            self._gui._current_file_upload_states.pop(message.transfer_uuid, None)
            self._refuse(int(client_id), "upload: more arrived than the file was said to hold; try again")
            return
        self._gui._handle_file_transfer_part(client_id, message)

    def _late(self, client_id: int, message: _messages.FileTransferStartUpload) -> None:
        if self._gui._current_file_upload_states.pop(message.transfer_uuid, None) is not None:
            why = f"upload: not there after {self._seconds:g} s and dropped; try again on a faster line"
            self._end(client_id, message, why)

    def _end(self, client_id: int, message: _messages.FileTransferStartUpload, why: str) -> None:
        self._refuse(client_id, why)
        # viser's page greys its button until a file is said to have arrived
        self._gui._websock_interface.queue_message(
            _messages.FileTransferPartAck(
                source_component_uuid=message.source_component_uuid,
                transfer_uuid=message.transfer_uuid,
                transferred_bytes=max(int(message.size_bytes), 0),
                total_bytes=max(int(message.size_bytes), 0),
            )
        )


def check_start(button: Any, size: object, parts: object) -> None:
    """Whether a file of this size in so many parts may come through a button.

    Raises:
        InputError: it may not; the text says why.
    """
    if button.disabled or not button.visible:
        raise InputError("upload: that button takes no files now")
    numbers = [value for value in (size, parts) if isinstance(value, int) and not isinstance(value, bool)]
    if len(numbers) != 2 or min(numbers) < 0:
        raise InputError("upload: size and parts of a file are whole numbers; use the page's own button")
    size_bytes, part_count = numbers
    if size_bytes == 0:
        raise InputError("upload: the file is empty; choose another")
    if size_bytes > LARGEST_FILE:
        raise InputError(
            f"upload: the file has {min(size_bytes, 2**60) / 2**20:.0f} MB, more than {LARGEST_FILE // 2**20} MB; thin "
            "the mesh, or read it with 'hpsop hull' and open the case"
        )
    if part_count != math.ceil(size_bytes / _PART):
        raise InputError("upload: a file comes in parts of 512 kB; use the page's own button")


def taken(button: viser.GuiUploadButtonHandle) -> tuple[str, bytes]:
    """Name for people and bytes of the file that has arrived; viser keeps it no longer."""
    file = button.value
    button._impl.value = viser.UploadedFile("", b"")
    return shown_name(file.name), file.content


def shown_name(name: object) -> str:
    """A file's name as people may see it: its last part, printable and of bounded length."""
    last = str(name).replace("\\", "/").rsplit("/", 1)[-1][:400]
    words = "".join(letter for letter in last if letter.isprintable()).strip()
    if len(words) > _LONGEST_NAME:
        words = words[: _LONGEST_NAME - 21] + "…" + words[-20:]
    return words or "file"
