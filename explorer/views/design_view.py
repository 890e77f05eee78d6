"""The selected design's numbers beside the initial design's."""

from __future__ import annotations

import viser

from explorer.server.bridge import PageEvent
from explorer.server.html_slot import Slot
from explorer.services.designs import Designs
from explorer.state.session import Session
from explorer.views.chips import GAP, box, chip, chips, soft
from explorer.views.headline import traffic_lights
from explorer.views.on_display import select_design
from explorer.views.tables import comparison_table, headline, warnings_html
from hpsop_core.markup import fill
from hpsop_core.quantities import condition_names, conditions_of


class DesignView:
    """Headline, choices, and the table initial / selected / change."""

    def __init__(self, session: Session, designs: Designs, gui: viser.GuiApi) -> None:
        self._session = session
        self._designs = designs
        self._html = Slot(gui)
        session.hub.on(("selection", "pins", "run"), self.draw)
        session.gestures.on("act", "choose", self._choose)
        session.gestures.on("act", "pin", self._pin)
        self._last: tuple[object, ...] = ()
        self.draw()

    def draw(self) -> None:
        """Draw everything again, unless nothing of it changed."""
        session = self._session
        picture, shown = session.picture, session.selected
        state = (shown, session.pins, picture.compromise, picture.knee, picture.name, picture.current_level)
        if state == self._last:
            return
        self._last = state
        if shown is None:
            self._html.show(box(soft("Computing the initial design …")))
            return
        pinned = any(item.key == shown.key for item in session.pins)
        row = chips(
            chip("choose", "initial", "initial", on=shown.kind == "initial"),
            chip(
                "choose",
                "compromise",
                "compromise",
                disabled=picture.compromise is None,
                on=shown.design_id is not None and shown.design_id == picture.compromise,
                hint="least distance to the utopia point of the front",
            ),
            chip(
                "choose",
                "knee",
                "knee",
                disabled=picture.knee is None,
                on=shown.design_id is not None and shown.design_id == picture.knee,
                hint="where the front bends most",
            ),
            GAP,
            chip("pin", "pinned" if pinned else "pin", on=pinned, hint="keep this design side by side (at most four)"),
        )
        initial = self._designs.initial(shown.evaluation.level)
        table = comparison_table(initial, shown, condition_names(session.picture.case))
        self._html.show(
            box(
                fill(
                    '<div data-selected="{}">{}</div>',
                    shown.design_id if shown.design_id is not None else shown.kind,
                    headline(shown),
                ),
                row,
                warnings_html(shown),
                traffic_lights(picture.case, shown, conditions_of(shown.evaluation)),
                table,
            )
        )

    def _choose(self, event: PageEvent) -> None:
        picture = self._session.picture
        if event.arg == "initial":
            self._session.select(self._designs.first())
        elif event.arg == "compromise" and picture.compromise is not None:
            select_design(self._session, self._designs, picture.compromise)
        elif event.arg == "knee" and picture.knee is not None:
            select_design(self._session, self._designs, picture.knee)

    def _pin(self, _event: PageEvent) -> None:
        selected = self._session.selected
        if selected is not None:
            self._session.pin(selected)
