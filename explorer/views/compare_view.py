"""Pinned designs side by side."""

from __future__ import annotations

import viser

from explorer.bridge import PageEvent
from explorer.charts.plot import escape
from explorer.state import Session
from explorer.views.chips import box, chip, chips
from explorer.views.slot import Slot
from explorer.views.tables import many_table


class CompareView:
    """All numbers of the pinned designs with their difference to the initial design."""

    def __init__(self, session: Session, gui: viser.GuiApi) -> None:
        self._session = session
        self._html = Slot(gui)
        session.hub.on(("pins",), self.draw)
        session.handle("act", "unpin", self._unpin)
        session.handle("act", "show_pin", self._show)
        self.draw()

    def draw(self) -> None:
        """Draw everything again."""
        session = self._session
        if not session.pins:
            self._html.show(
                box(
                    '<p class="soft">No design is pinned. Select one and press <b>pin</b> in the Design tab: up to '
                    "four stand here side by side, their curves and body plans overlay in Charts, and the first pin's "
                    "hull can be the ghost in 3D.</p>"
                )
            )
            return
        rows = []
        for index, item in enumerate(session.pins):
            level = f"level {item.evaluation.level}"
            rows.append(
                chips(
                    f'<span style="color:var(--hp-pin{index + 1})">▲</span> <b>{escape(item.label)}</b> '
                    f'<span class="soft">{level}</span><span class="gap"></span>',
                    chip("show_pin", "show", str(index)),
                    chip("unpin", "unpin", str(index)),
                )
            )
        initial = session.app.initial_shown(session.pins[-1].evaluation.level)
        table = many_table(initial, session.pins, session.picture.case.conditions.froude_numbers)
        self._html.show(box("".join(rows) + table))

    def _index(self, event: PageEvent) -> int | None:
        index = int(event.arg) if event.arg.isdecimal() and len(event.arg) < 3 else -1
        return index if 0 <= index < len(self._session.pins) else None

    def _unpin(self, event: PageEvent) -> None:
        index = self._index(event)
        if index is not None:
            self._session.pin(self._session.pins[index])

    def _show(self, event: PageEvent) -> None:
        index = self._index(event)
        if index is not None:
            self._session.select(self._session.pins[index])
