"""Pinned designs side by side."""

from __future__ import annotations

import viser

from explorer.server.bridge import PageEvent
from explorer.server.html_slot import Slot
from explorer.services.designs import Designs
from explorer.state.session import Session
from explorer.state.shown import Shown
from explorer.views.chips import GAP, box, chip, chips, soft
from explorer.views.tables import many_table
from hpsop_core.markup import Markup, fill
from hpsop_core.quantities import quantities_of_case


class CompareView:
    """All numbers of the pinned designs with their difference to the initial design."""

    def __init__(self, session: Session, designs: Designs, gui: viser.GuiApi) -> None:
        self._session = session
        self._designs = designs
        self._html = Slot(gui)
        session.hub.on(("pins", "options", "selection"), self.draw, self._html.failed)
        session.gestures.on("act", "unpin", self._unpin)
        session.gestures.on("act", "ghost_pin", self._ghost)
        session.gestures.on("act", "show_pin", self._show)
        self.draw()

    def draw(self) -> None:
        """Draw everything again."""
        session = self._session
        pins, shown, picture = session.pins, session.selected, session.picture
        if not pins:
            self._html.show(
                box(
                    Markup(
                        '<p class="soft">No design is pinned. Select one and press <b>pin</b> in the Design tab: up to '
                        "four stand here side by side with their difference to the initial design, their curves and "
                        "body plans overlay in Charts, and each of them can be the ghost beside the selected hull in "
                        "3D.</p>"
                    )
                )
            )
            return
        rows = []
        for index, item in enumerate(pins):
            ghosted = session.options.ghost and session.options.ghost_of == item.name
            selected = shown is not None and shown.key == item.key
            rows.append(
                chips(
                    fill(
                        '<span class="pinned" style="--pin:var(--hp-pin{})">▲ <b>{}</b></span>', index + 1, item.label
                    ),
                    soft(f"level {item.evaluation.level}", "span"),
                    GAP,
                    chip("show_pin", "show", str(index), on=selected, hint="select this design"),
                    chip("ghost_pin", "ghost", str(index), on=ghosted, hint="this hull as the ghost in 3D"),
                    chip("unpin", "unpin", str(index)),
                )
            )
        levels = {item.evaluation.level for item in pins}
        if len(levels) > 1:
            rows.append(
                soft(
                    "Levels differ: each is compared with the initial design at its own level; the column “initial” "
                    f"is level {pins[-1].evaluation.level}."
                )
            )
        initials = {level: self._designs.initial(level) for level in levels}
        table = many_table(initials, pins, quantities_of_case(picture.case))
        self._html.show(box(*rows, table))

    def _pinned(self, event: PageEvent) -> Shown | None:
        pins = self._session.pins
        index = int(event.arg) if event.arg.isdecimal() and len(event.arg) < 3 else -1
        return pins[index] if 0 <= index < len(pins) else None

    def _ghost(self, event: PageEvent) -> None:
        item = self._pinned(event)
        if item is not None:
            options, name = self._session.options, item.name
            same = options.ghost and options.ghost_of == name
            self._session.set_options(ghost=not same, ghost_of="initial" if same else name)

    def _unpin(self, event: PageEvent) -> None:
        item = self._pinned(event)
        if item is not None:
            self._session.pin(item)

    def _show(self, event: PageEvent) -> None:
        item = self._pinned(event)
        if item is not None:
            self._session.select(item)
