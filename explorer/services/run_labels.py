"""A run's name and note, as people wrote them: in a file beside the runs, which stay as they are."""

from __future__ import annotations

import contextlib
import json
import os
import threading
from dataclasses import dataclass
from pathlib import Path

_FILE = "labels.json"
_LONGEST_NAME, _LONGEST_NOTE = 60, 300


@dataclass(frozen=True)
class RunLabel:
    """What a person calls a run, and what they want to remember of it; "" where nothing was said."""

    name: str = ""
    note: str = ""


def _clean(text: object, longest: int) -> str:
    words = "".join(letter if letter.isprintable() else " " for letter in str(text))
    return " ".join(words.split())[:longest]


class RunLabels:
    """The labels of one folder of runs, by the run file's name.

    Args:
        folder: of the runs.
    """

    def __init__(self, folder: Path) -> None:
        self._path = folder / _FILE
        self._lock = threading.Lock()

    def of(self, run: str) -> RunLabel:
        """The label of a run."""
        return self._read().get(run, RunLabel())

    def all(self) -> dict[str, RunLabel]:
        """The labels of every run that has one."""
        return self._read()

    def write(self, run: str, name: str | None = None, note: str | None = None) -> None:
        """Give a run another name or note; None leaves it as it is. A folder that cannot be written keeps none."""
        with self._lock:
            known = self._read()
            old = known.pop(run, RunLabel())
            new = RunLabel(
                old.name if name is None else _clean(name, _LONGEST_NAME),
                old.note if note is None else _clean(note, _LONGEST_NOTE),
            )
            if new != RunLabel():
                known[run] = new
            text = json.dumps({key: {"name": label.name, "note": label.note} for key, label in known.items()})
            with contextlib.suppress(OSError):
                self._path.parent.mkdir(parents=True, exist_ok=True)
                fresh = self._path.with_name(_FILE + ".new")
                fresh.write_text(text, encoding="utf-8")
                os.replace(fresh, self._path)

    def _read(self) -> dict[str, RunLabel]:
        try:
            stored = json.loads(self._path.read_text(encoding="utf-8"))
            items = dict(stored).items()
        except (OSError, ValueError, TypeError, RecursionError):
            return {}
        return {
            str(run): RunLabel(
                _clean(label.get("name", ""), _LONGEST_NAME), _clean(label.get("note", ""), _LONGEST_NOTE)
            )
            for run, label in items
            if isinstance(label, dict)
        }
