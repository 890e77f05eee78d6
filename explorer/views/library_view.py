"""The start page: earlier runs to open, continue or delete."""

from __future__ import annotations

import time

import viser

from explorer.server.html_slot import Slot
from explorer.services.library import LibraryEntry
from explorer.services.runs import Runs
from explorer.state.app_state import AppState
from explorer.state.run_picture import ACTIVE
from explorer.views.chips import GAP, NOTHING, box, chip, chips, soft
from hpsop_core.markup import Markup, fill, joined


class LibraryView:
    """One row for each run in the user's folder, newest first."""

    def __init__(self, app: AppState, runs: Runs, gui: viser.GuiApi) -> None:
        self._app = app
        self._runs = runs
        self._html = Slot(gui)
        self._under_way = ""
        app.hub.on(("library",), self.draw, self._html.failed)
        app.hub.on(("run",), self._begun_or_ended, self._html.failed)
        self.draw()

    def _running(self) -> str:
        """The run on display while it is under way, or ""."""
        return self._app.picture.name if self._app.picture.status in ACTIVE else ""

    def _begun_or_ended(self) -> None:
        if self._running() != self._under_way:
            self.draw()

    def draw(self) -> None:
        """Draw everything again."""
        self._under_way = self._running()
        rows = []
        for entry in self._runs.library():
            current = entry.name == self._app.picture.name
            age = time.strftime("%Y-%m-%d %H:%M", time.localtime(entry.modified))
            if self._app.asked_to_delete == entry.name:
                buttons = chips(
                    Markup('<span class="bad">Delete this run for good?</span>'),
                    GAP,
                    chip("delete_yes", "delete", entry.name, css="danger"),
                    chip("delete_no", "keep"),
                )
            else:
                buttons = chips(
                    chip(
                        "open_run",
                        "opening …" if self._app.coming == entry.name else "shown" if current else "open",
                        entry.name,
                        on=current,
                    ),
                    chip("continue_run", "continue", entry.name, hint="open it and go on with it")
                    if entry.continuable and not current
                    else NOTHING,
                    chip("adopt", "use its settings", hint="set up the next run like this one") if current else NOTHING,
                    chip(
                        "rename_run",
                        "done" if self._app.renamed == entry.name else "name, note …",
                        "" if self._app.renamed == entry.name else entry.name,
                        hint="what you call this run, and what you want to remember of it",
                    ),
                    NOTHING
                    if entry.shipped
                    else chip("delete_run", "delete …", entry.name, disabled=not entry.deletable),
                )
            label = entry.label
            boxes = NOTHING
            if self._app.renamed == entry.name:
                boxes = _label_box("name", entry, label.name, 60) + _label_box("note", entry, label.note, 300)
            rows.append(
                fill(
                    '<div class="row" data-run="{}"><b>{}</b><br>{}<span class="soft">{}{}<br>{} · {}</span>{}{}</div>',
                    entry.name,
                    label.name or entry.title,
                    fill("{}<br>", label.note) if label.note else NOTHING,
                    fill("{}<br>", entry.title) if label.name else NOTHING,
                    # what its file said when this was drawn is soon no longer true
                    "under way, as is told above" if entry.name == self._under_way else entry.summary,
                    "comes with hpsop, only read" if entry.shipped else age,
                    entry.name,
                    boxes,
                    buttons,
                )
            )
        empty = soft("No runs yet. Each run is saved by itself and stands here.")
        where = soft(f"Folder: {self._runs.folder_text()}")
        self._html.show(box(fill('<div class="rows">{}</div>', joined(rows)) if rows else empty, where))


def _label_box(what: str, entry: LibraryEntry, text: str, longest: int) -> Markup:
    return fill(
        '<label class="label">{} <input type="text" data-set="run_{}" data-arg="{}" value="{}" maxlength="{}" '
        'aria-label="{} of the run {}"></label>',
        what,
        what,
        entry.name,
        text,
        longest,
        what,
        entry.name,
    )
