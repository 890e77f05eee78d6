"""What a restart of the server brings back, in a file beside the runs."""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

_NAME = "page.json"


@dataclass(frozen=True)
class PageMemory:
    """What the page looked like when its server last stopped; empty where nothing is known.

    Attributes:
        browsers: what each browser gets back, by its own name (explorer/state/session.py).
        run: the name of the run on display, or "".
        draft: the settings (explorer/state/draft.py), or None.
    """

    browsers: dict[str, dict[str, Any]] = field(default_factory=dict)
    run: str = ""
    draft: Mapping[str, Any] | None = None

    def save(self, folder: Path) -> None:
        """Write it; a folder that cannot be written costs the memory and nothing else."""
        text = json.dumps({"browsers": self.browsers, "run": self.run, "draft": self.draft})
        with contextlib.suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            fresh = folder / (_NAME + ".new")
            try:
                fresh.write_text(text, encoding="utf-8")
                os.replace(fresh, folder / _NAME)
            finally:
                # what a full disk took half of
                fresh.unlink(missing_ok=True)


def remembered(folder: Path) -> PageMemory:
    """What was saved in a folder, as far as it can be read."""
    try:
        stored = json.loads((folder / _NAME).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        stored = None
    found = stored if isinstance(stored, dict) else {}
    browsers, draft = found.get("browsers"), found.get("draft")
    return PageMemory(
        browsers={str(key): value for key, value in browsers.items() if isinstance(value, dict)}
        if isinstance(browsers, dict)
        else {},
        run=str(found.get("run", "")),
        draft=draft if isinstance(draft, dict) else None,
    )
