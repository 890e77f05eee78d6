"""Driving a run from a terminal: progress while it goes on, Ctrl-C that keeps all that is finished."""

from __future__ import annotations

import contextlib
import shutil
import signal
import threading
from typing import TextIO

from hpsop_core.runs.controller import RunController
from hpsop_core.runs.events import RunEvent, RunSnapshot

INTERRUPTED = 130


def driven(controller: RunController, progress: Progress) -> bool:
    """Drive to the end; False if a person (or the system, by SIGTERM or SIGHUP) interrupted it."""
    if threading.current_thread() is threading.main_thread():
        # Also where a shell started us in the background, with the interrupt ignored.
        signal.signal(signal.SIGINT, _interrupt)
        signal.signal(signal.SIGTERM, _interrupt)
        # The terminal was closed; with nohup it is ignored, and stays so.
        if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:
            signal.signal(signal.SIGHUP, _interrupt)
    try:
        controller.start()
        while not controller.wait(0.2):
            pass
        return True
    except KeyboardInterrupt:
        progress.line("stopping after the evaluations under way ...")
        controller.stop()
        # A second Ctrl-C ends the waiting; what is finished is in the file already.
        controller.wait()
        snapshot = controller.snapshot()
        return snapshot.state == "finished"


def _interrupt(number: int, frame: object) -> None:
    raise KeyboardInterrupt


class Progress:
    """A progress bar on a terminal, a plain line a generation elsewhere."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._terminal = stream.isatty()
        self._guard = threading.Lock()
        self._width = 0

    def __call__(self, event: RunEvent) -> None:
        """Show an event of the run."""
        snapshot = event.snapshot
        if event.kind == "state" and snapshot.reason and snapshot.state == "paused":
            self.line(f"paused: {snapshot.reason}")
        elif event.kind == "handover":
            self.line(f"generation {snapshot.generation}: {event.text}; level 2 begins")
        elif event.kind == "failure":
            self.line(f"design {event.evaluation_id} failed: {event.text}")
        elif event.kind == "generation" and not self._terminal:
            self.line(_progress_text(snapshot))
        elif self._terminal and event.kind in ("generation", "evaluation"):
            self._bar(snapshot)

    def line(self, text: str) -> None:
        """Print a line above the bar."""
        with self._guard:
            self._clear()
            self._print(text + "\n")

    def end(self) -> None:
        """Remove the bar."""
        with self._guard:
            self._clear()

    def _clear(self) -> None:
        if self._width:
            self._print("\r" + " " * self._width + "\r")
            self._width = 0

    def _print(self, text: str) -> None:
        # A terminal that was closed, or a full disk under a log, must not end the run.
        with contextlib.suppress(OSError, ValueError):
            self._stream.write(text)
            self._stream.flush()

    def _bar(self, snapshot: RunSnapshot) -> None:
        text = _progress_text(snapshot)
        columns = shutil.get_terminal_size().columns - 1
        room = columns - len(text) - 3
        if room >= 10:
            part = snapshot.done / snapshot.population if snapshot.population else 0.0
            under_way = part if snapshot.generation < snapshot.generations and part < 1.0 else 0.0
            filled = int(min(1.0, (snapshot.generation + under_way) / max(1, snapshot.generations)) * min(room, 40))
            text = "[" + "#" * filled + "." * (min(room, 40) - filled) + "] " + text
        text = text[:columns]
        with self._guard:
            self._print("\r" + text.ljust(self._width))
            self._width = len(text)


def _progress_text(snapshot: RunSnapshot) -> str:
    text = (
        f"generation {snapshot.generation}/{snapshot.generations}, level {snapshot.level}, "
        f"hypervolume {snapshot.hypervolume:.5f}, feasible {100 * snapshot.feasible_share:.0f} %"
    )
    if snapshot.failures:
        text += f", {snapshot.failures} failed"
    if snapshot.seconds_left is not None:
        text += f", {duration(snapshot.seconds_left)} left"
    return text


def duration(seconds: float) -> str:
    """h:mm:ss, or m:ss below an hour."""
    whole = int(seconds + 0.5)
    hours, rest = divmod(whole, 3600)
    return f"{hours}:{rest // 60:02d}:{rest % 60:02d}" if hours else f"{rest // 60}:{rest % 60:02d}"
