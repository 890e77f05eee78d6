"""The newest front's families, as cards with a picture of their hulls."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Sequence

from explorer.charts.family_cards import FamilyCard, family_cards
from explorer.charts.pareto import newest_families
from explorer.services.answers import MOST_LINES
from explorer.services.designs import Designs
from explorer.state.session import Session
from explorer.views.chips import soft
from explorer.views.saving import Figure
from hpsop_core.errors import HpsopError
from hpsop_core.markup import Markup

# all cards are drawn anew after as many lines as are cut within this time: after each of seventy they would be drawn
# seventy times, in the thread that answers gestures
_CUT_SECONDS = 0.4
# cards beyond stand without a picture; other charts' lines have room beside theirs
_MOST_PICTURES = MOST_LINES - 40
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
    if initial is None or any(card.lines is None for card in cards[:_MOST_PICTURES]):
        session.slow.latest("families", lambda: _cut_next(session, designs))
    selected = session.selected.design_id if session.selected is not None else None
    return [family_cards(cards, initial, selected), soft(_WORDS)]


def _cards(session: Session, designs: Designs) -> list[FamilyCard]:
    picture = session.picture
    rows, names, _ = newest_families(picture, session.scrubbed)
    members: dict[int, list[int]] = {}
    for row, name in zip(rows, names, strict=True):
        members.setdefault(name, []).append(int(picture.ids[row]))
    designs.prepare([own[len(own) // 2] for own in members.values()])
    found = []
    for name, own in members.items():
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
    """Some of the lines that are missing; drawing them asks for the next ones."""
    ends, cut = time.monotonic() + _CUT_SECONDS, False
    cards = _cards(session, designs)[:_MOST_PICTURES]
    wanted = [designs.case.initial.variables, *(card.evaluation.variables for card in cards)]
    for variables in wanted:
        if cut and time.monotonic() > ends:
            break
        if designs.known_lines(variables) is None:
            with contextlib.suppress(HpsopError):
                designs.lines(variables)
                cut = True
    if cut:
        session.curves_ready()
