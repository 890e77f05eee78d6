"""What a browser looks at: the selection, the design beside it, and what charts overlay."""

from __future__ import annotations

import dataclasses

from explorer.services.designs import Designs
from explorer.state.session import Session
from explorer.state.shown import Shown
from hpsop_core.case.case import Case
from hpsop_core.charts.looks import Look
from hpsop_core.errors import HpsopError


def select_design(session: Session, designs: Designs, design_id: int) -> None:
    """Select a design of the run; one that it does not have, or that failed, is left alone."""
    shown = designs.shown(design_id)
    if shown is not None and shown.evaluation.ok:
        session.select(shown)


def follow_best(session: Session, designs: Designs) -> None:
    """Go on to the newest compromise where a browser has asked for it, until it selects another design itself."""
    best, selected = session.picture.compromise, session.selected
    if not session.follow:
        return
    if session.followed is not None and selected is not None and selected.design_id != session.followed:
        session.set_follow(False)
        return
    if best is not None and (selected is None or selected.design_id != best):
        shown = designs.shown(best)
        if shown is not None and shown.evaluation.ok:
            session.go_on(shown)
    elif best is not None and selected is not None:
        session.go_on(selected)


def select_first(session: Session, designs: Designs) -> None:
    """Where nothing is selected yet: a run's compromise, the initial design its ghost, else the initial design."""
    if session.selected is not None:
        return
    first = designs.best()
    if first.kind != "initial":
        session.set_options(ghost=True)
    session.select(first)


class Renewal:
    """Before the first run the page shows the case as it is set up: its designs are evaluated anew when that changes.

    Of a run on display the designs stay as its own case has them.
    """

    def __init__(self, session: Session, designs: Designs) -> None:
        self._session = session
        self._designs = designs
        self._case = session.picture.case
        session.hub.on(("run",), self._renew)

    def _renew(self) -> None:
        session, before = self._session, self._case
        picture = session.picture
        case = self._case = picture.case
        searched_alike = dataclasses.replace(case, optimization=before.optimization)
        if picture.name or searched_alike == before:
            return
        if dataclasses.replace(searched_alike, bounds=before.bounds) == before:
            # bounds move no number of a design: only what it stands on
            session.renew(lambda shown: _on_bounds(shown, case))
            return
        try:
            session.renew(lambda shown: self._designs.again(shown.saved()))
            if session.selected is None:
                session.select(self._designs.first())
        except HpsopError as error:
            # better nothing than numbers of another case
            session.leave_run(None)
            session.notify("The initial design has no numbers", str(error), "red")


def _on_bounds(shown: Shown, case: Case) -> Shown:
    evaluation = shown.evaluation
    if not evaluation.ok:
        return shown
    active = case.bounds.active(evaluation.variables)
    return dataclasses.replace(shown, evaluation=dataclasses.replace(evaluation, active_bounds=active))


def ghost_of(session: Session, designs: Designs) -> tuple[Shown | None, int | None]:
    """The design that stands beside the selected one in 3D, and which pin it is; a ship is not its own ghost."""
    selected = session.selected
    if not session.options.ghost or selected is None:
        return None, None
    place = next((index for index, item in enumerate(session.pins) if item.name == session.options.ghost_of), None)
    found = designs.initial(selected.evaluation.level) if place is None else session.pins[place]
    same = found.evaluation.variables == selected.evaluation.variables
    return (None if same else found), place


def overlaid(session: Session, designs: Designs) -> list[tuple[Look, Shown]]:
    """What charts overlay: the initial design dashed, pins, and the selection last."""
    selected = session.selected
    level = selected.evaluation.level if selected else 1
    shown = [(Look("initial", "initial", "dash"), designs.initial(level))]
    for index, item in enumerate(session.pins):
        if selected is None or item.key != selected.key:
            other = f" (level {item.evaluation.level})" if item.evaluation.level != level else ""
            shown.append((Look(f"pinned {item.label.lower()}{other}", f"pin{index + 1}"), item))
    if selected is not None and selected.kind != "initial":
        shown.append((Look(selected.label, "selected"), selected))
    return shown
