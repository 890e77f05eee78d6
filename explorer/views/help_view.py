"""The help that a browser asks for, and the tour that it is offered once."""

from __future__ import annotations

import viser

from explorer.server.bridge import PageEvent, overlay
from explorer.server.html_slot import Slot
from explorer.state.session import Session
from explorer.views.help_words import TOUR, help_card, tour_card
from hpsop_core.markup import Markup

_NOTHING = Markup("")


class HelpView:
    """One card over the 3D view: the glossary, or a step of the tour."""

    def __init__(self, session: Session, gui: viser.GuiApi) -> None:
        self._session = session
        self._help = Slot(gui)
        self._tour = Slot(gui)
        self._open = False
        session.gestures.on("act", "help", lambda event: self._show_help(not self._open and event.arg != "close"))
        session.gestures.on("act", "tour", self._step)

    def welcome(self, seen: bool) -> None:
        """Offer the tour to a browser that has not seen it."""
        if not seen:
            self._tour.show(overlay("tour", tour_card(0)))

    def _show_help(self, shown: bool) -> None:
        self._open = shown
        self._help.show(overlay("help", help_card(self._session.picture.case) if shown else _NOTHING))

    def _step(self, event: PageEvent) -> None:
        self._show_help(False)
        index = int(event.arg) if event.arg.isdecimal() else len(TOUR)
        # the browser itself keeps that it has left the tour (assets/page.js)
        self._tour.show(overlay("tour", tour_card(index) if index < len(TOUR) else _NOTHING))
