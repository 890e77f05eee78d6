"""The selected design's numbers beside the initial design's."""

from __future__ import annotations

import viser

from explorer.server.bridge import PageEvent
from explorer.server.html_slot import Slot
from explorer.services.designs import Designs
from explorer.services.refining import TOPIC, Refining, can_be_refined
from explorer.state.session import Session
from explorer.state.shown import Shown
from explorer.views.chips import GAP, NOTHING, box, chip, chips, soft
from explorer.views.headline import traffic_lights
from explorer.views.on_display import select_design
from explorer.views.tables import comparison_table, headline, warnings_html
from hpsop_core.evaluation.levels import TRUTH
from hpsop_core.markup import Markup, fill
from hpsop_core.quantities import conditions_of, number_text, quantities_of_case, size_of_case
from hpsop_core.units import Size


class DesignView:
    """Headline, choices, and the table initial / selected / change."""

    def __init__(self, session: Session, designs: Designs, refining: Refining, gui: viser.GuiApi) -> None:
        self._session = session
        self._designs = designs
        self._refining = refining
        self._html = Slot(gui)
        session.hub.on(("selection", "pins", "run"), self.draw, self._html.failed)
        session.hub.on((TOPIC,), self._errors_changed)
        session.gestures.on("act", "refine", self._refine)
        session.gestures.on("act", "choose", self._choose)
        session.gestures.on("act", "pin", self._pin)
        self._last: tuple[object, ...] = ()
        self.draw()

    def draw(self) -> None:
        """Draw everything again, unless nothing of it changed."""
        session = self._session
        picture, shown = session.picture, session.selected
        doing = self._refining.words()
        state = (shown, session.pins, picture.compromise, picture.knee, picture.name, picture.current_level, doing)
        if state == self._last:
            return
        # what fails below is tried again when it is asked for again
        self._last = ()
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
        table = comparison_table(initial, shown, quantities_of_case(picture.case))
        self._html.show(
            box(
                fill(
                    '<div data-selected="{}">{}</div>',
                    shown.design_id if shown.design_id is not None else shown.kind,
                    headline(shown),
                ),
                row,
                _errors_row(shown, doing, self._refining.busy, picture.current_level, size_of_case(picture.case)),
                warnings_html(shown),
                traffic_lights(picture.case, shown, conditions_of(shown.evaluation)),
                table,
            )
        )
        self._last = state

    def _choose(self, event: PageEvent) -> None:
        picture = self._session.picture
        if event.arg == "initial":
            self._session.select(self._designs.first())
        elif event.arg == "compromise" and picture.compromise is not None:
            select_design(self._session, self._designs, picture.compromise)
        elif event.arg == "knee" and picture.knee is not None:
            select_design(self._session, self._designs, picture.knee)

    def _errors_changed(self) -> None:
        selected = self._session.selected
        if selected is not None and (known := self._designs.with_errors(selected)) != selected:
            # The same design with more known of it: every view that shows its numbers draws them again.
            self._session.select(known)
        self.draw()

    def _refine(self, event: PageEvent) -> None:
        selected = self._session.selected
        if event.arg == "front":
            self._refining.front()
        elif selected is not None:
            self._refining.design(selected)

    def _pin(self, _event: PageEvent) -> None:
        selected = self._session.selected
        if selected is not None:
            self._session.pin(selected)


def _errors_row(shown: Shown, doing: str, busy: bool, level: int, size: Size) -> Markup:
    """What stands behind the errors, and the buttons that solve them; nothing at level 1, which has none."""
    evaluation = shown.evaluation
    if not evaluation.ok or evaluation.level != TRUTH.number:
        return NOTHING
    own = bool(evaluation.comparison_errors)
    if evaluation.predicted:
        words = "± of a predicted design: solve the front to know it"
    else:
        words = "± solved for this design" if own else "± typical of level 2"
    unit = size.unit("MW", 2)
    terms = "\n".join(
        f"{term.replace('_', ' ')}: "
        f"{number_text(1e-6 * unit.factor * widths['delivered_power_1'], unit.decimals)} {unit.symbol}"
        for term, widths in evaluation.error_terms.items()
        if "delivered_power_1" in widths
    )
    hint = f"half widths of 90 % intervals; of the delivered power at the first condition:\n{terms}" if terms else (
        "half widths of 90 % intervals: mesh, domain, momentum plane against pressure, propeller's mesh, k, wake"
    )  # fmt: skip
    return chips(
        fill(
            '<span class="soft" data-errors="{}" title="{}">{}</span>', evaluation.errors_source, hint, doing or words
        ),
        GAP,
        chip(
            "refine",
            "solve errors",
            "design",
            disabled=busy or not can_be_refined(shown),
            hint="solve this design again finer, some two seconds, for its own errors",
        ),
        chip(
            "refine",
            "of the front",
            "front",
            disabled=busy or level != TRUTH.number,
            hint="solve the newest front and the initial design finer, some two seconds each",
        ),
    )
