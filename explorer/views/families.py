"""The newest front's families, as cards with a picture of their hulls."""

from __future__ import annotations

from collections.abc import Sequence

from explorer.charts.family_cards import FamilyCard, family_cards
from explorer.charts.pareto import newest_families
from explorer.services.designs import Designs
from explorer.state.session import Session
from explorer.views.chips import soft
from explorer.views.saving import Figure
from hpsop_core.errors import HpsopError
from hpsop_core.markup import Markup

_WORDS = (
    "A family is what the error of the numbers cannot tell apart; its member in the middle stands for it, before the "
    "initial design in grey, all at one scale. Press a card to select its design."
)


def families(session: Session, designs: Designs) -> Sequence[Figure | Markup]:
    """The cards; lines that are not cut yet come one after another."""
    cards = _cards(session, designs)
    if not cards:
        return [soft("No front yet: its families stand here once a finished generation has a feasible design.")]
    initial = designs.known_lines(designs.case.initial.variables)
    if initial is None or any(card.lines is None for card in cards):
        session.slow.latest("families", lambda: _cut_next(session, designs))
    selected = session.selected.design_id if session.selected is not None else None
    return [family_cards(cards, initial, selected), soft(_WORDS)]


def _cards(session: Session, designs: Designs) -> list[FamilyCard]:
    picture = session.picture
    rows, names, _ = newest_families(picture, session.scrubbed)
    found = []
    for name in dict.fromkeys(names):
        own = [int(picture.ids[row]) for row, family in zip(rows, names, strict=True) if family == name]
        design_id = own[len(own) // 2]
        shown = designs.shown(design_id)
        if shown is None or not shown.evaluation.ok:
            continue
        marks = ((picture.compromise, "compromise"), (picture.knee, "knee"))
        words = ", ".join(word for number, word in marks if number in own) if session.scrubbed is None else ""
        lines = designs.known_lines(shown.evaluation.variables)
        found.append(FamilyCard(name, len(own), design_id, shown.evaluation, lines, words))
    return found


def _cut_next(session: Session, designs: Designs) -> None:
    """The first lines that are missing; drawing them asks for the next ones."""
    wanted = [designs.case.initial.variables, *(card.evaluation.variables for card in _cards(session, designs))]
    for variables in wanted:
        if designs.known_lines(variables) is None:
            try:
                designs.lines(variables)
            except HpsopError:
                continue
            session.curves_ready()
            return
