"""The table of all designs: sorted, filtered, paged, with stars; a row selects its design."""

from __future__ import annotations

from typing import Any

import viser

from explorer.charts.designs_table import (
    ROWS,
    chosen_columns,
    designs_csv,
    designs_table,
    known_columns,
    page_of,
    parse_filter,
    range_words,
    table_rows,
)
from explorer.server.bridge import PageEvent, scrolling
from explorer.server.html_slot import Slot
from explorer.server.widgets import set_value
from explorer.services.designs import Designs
from explorer.state.run_picture import ACTIVE, RunPicture
from explorer.state.session import Session
from explorer.state.table_options import WHICH
from explorer.views.chips import GAP, NOTHING, box, chip, chips, soft
from explorer.views.on_display import select_design
from explorer.views.saving import Download
from hpsop_core.errors import InputError
from hpsop_core.markup import Markup, fill, joined, symbol_html
from hpsop_core.quantities import number_text

_HINTS = {
    "feasible": "designs that keep every constraint",
    "front": "the newest generation's front",
    "starred": "designs that bear a star of yours",
    "all": "infeasible designs too; what failed stands in Charts, Failures",
}


class TableView:
    """Choice of rows and columns, the page of the table, and its CSV.

    Args:
        session: whose table.
        designs: of the run.
        gui: where it stands.
        download: gives the browser a file by name.
    """

    def __init__(self, session: Session, designs: Designs, gui: viser.GuiApi, download: Download) -> None:
        self._session = session
        self._designs = designs
        self._download = download
        self._typed: frozenset[str] = frozenset()
        self._refused = ""
        self._only = gui.add_text(
            "Only",
            "",
            hint="conditions between commas, for example f1 < 0.95, L_PP > 340; they fade the charts too",
        )
        self._only.on_update(self._filter)
        self._html = Slot(gui)
        session.hub.on(("run", "selection", "table", "stars"), self.draw, self._html.failed)
        session.hub.on(("filter",), self._filtered, self._html.failed)
        for name, action in (
            ("table_sort", self._sort),
            ("table_which", self._which),
            ("table_page", self._turn),
            ("table_columns", self._open_choice),
            ("table_column", self._column),
            ("table_select", self._select),
            ("table_unfilter", self._unfilter),
            ("table_csv", self._csv),
            ("star", self._star),
        ):
            session.gestures.on("act", name, action)
        self.draw()

    # ---- drawing ---------------------------------------------------------------------------------------------------
    def draw(self) -> None:
        """Draw everything again."""
        session = self._session
        picture, options = session.picture, session.table
        if not len(picture.ids):
            begun = picture.status in ACTIVE
            words = "The first designs are being evaluated." if begun else "No designs yet. Press Start."
            self._html.show(box(soft(f"{words} Every design that is evaluated gets a row here.")))
            return
        rows = self._rows(picture)
        page, pages = page_of(rows, options), max(-(-len(rows) // ROWS), 1)
        which = chips(
            *(chip("table_which", word, word, on=options.which == word, hint=_HINTS[word]) for word in WHICH),
            GAP,
            chip("table_columns", "Columns", on=options.choosing, hint="choose the columns"),
            chip("table_csv", "CSV", hint="these rows, all pages, with the columns shown"),
        )
        turning = chips(
            *(
                chip("table_page", word, arg, disabled=page == 0 if back else page == pages - 1, hint=hint)
                for word, arg, back, hint in (
                    ("«", "first", True, "first page"),
                    ("‹", "back", True, "page before"),
                    ("›", "on", False, "next page"),
                    ("»", "last", False, "last page"),
                )
            ),
            soft(
                f"page {page + 1} of {pages}: {_count(len(rows))} of {_count(len(picture.ids))} designs",
                "span",
            ),
            GAP,
            chip("table_page", "to the selected", "selected", hint="the page on which the selected design stands"),
        )
        shown = session.selected
        selected = shown.design_id if shown else None
        refused = fill('<p class="bad" role="alert">{}</p>', self._refused) if self._refused else NOTHING
        self._html.show(
            box(
                refused,
                self._filters(picture),
                which,
                self._choice(picture) if options.choosing else NOTHING,
                turning,
                scrolling("designs", designs_table(picture, options, rows, selected, session.stars))
                if len(rows)
                else soft(_empty_words(options.which, bool(session.filters))),
            )
        )

    def _filters(self, picture: RunPicture) -> Markup:
        session = self._session
        if not session.filters:
            return NOTHING
        return chips(
            soft("only", "span"),
            *(
                chip(
                    "table_unfilter",
                    fill("{} ✕", range_words(key, limits, picture)),
                    key,
                    on=True,
                    hint="drop this condition",
                )
                for key, limits in session.filters.items()
            ),
        )

    def _choice(self, picture: RunPicture) -> Markup:
        shown = {item.key for item in chosen_columns(picture, self._session.table)}
        groups: dict[str, list[Markup]] = {}
        for item in known_columns(picture).values():
            button = chip(
                "table_column",
                symbol_html(item.symbol),
                item.key,
                on=item.key in shown,
                hint=f"{item.label} ({item.key})",
            )
            groups.setdefault(item.group, []).append(button)
        parts = [joined([soft(group, "span"), chips(*buttons)]) for group, buttons in groups.items()]
        usual = chips(chip("table_column", "usual columns", "", hint="the columns that stand here at first"))
        return fill('<div class="tools choice">{}{}{}</div>', joined(parts), soft("", "span"), usual)

    def _rows(self, picture: RunPicture) -> Any:
        """Rows of this very picture: the run may grow, or another one come on display, at any moment."""
        session = self._session
        return table_rows(picture, session.table, session.filters, session.stars)

    # ---- filters ---------------------------------------------------------------------------------------------------
    def _filter(self, event: viser.GuiEvent[Any]) -> None:
        if event.client is not None:
            self._session.worker.latest("table filter", self._type, first=True)

    def _type(self) -> None:
        try:
            found = parse_filter(self._only.value, self._session.picture)
        except InputError as error:
            self._refused = str(error)
            self.draw()
            return
        self._refused = ""
        before, self._typed = self._typed, frozenset(found)
        self._session.set_table(page=0)
        self._session.filter({**dict.fromkeys(before - self._typed), **found})

    def _filtered(self) -> None:
        # dropped elsewhere (Esc on a chart, another run): the words would claim what no longer holds
        if self._typed and not self._typed <= set(self._session.filters):
            self._typed = frozenset()
            set_value(self._only, "")
        self.draw()

    def _unfilter(self, event: PageEvent) -> None:
        self._session.filter({event.arg: None})

    # ---- gestures --------------------------------------------------------------------------------------------------
    def _sort(self, event: PageEvent) -> None:
        options, known = self._session.table, known_columns(self._session.picture)
        if event.arg not in known and event.arg not in ("id", "level", "generation"):
            return
        best_high = event.arg in known and known[event.arg].better > 0
        descending = not options.descending if options.sort == event.arg else best_high
        self._session.set_table(sort=event.arg, descending=descending, page=0)

    def _which(self, event: PageEvent) -> None:
        if event.arg in WHICH:
            self._session.set_table(which=event.arg, page=0)

    def _turn(self, event: PageEvent) -> None:
        session, picture = self._session, self._session.picture
        rows = self._rows(picture)
        page = page_of(rows, session.table)
        last = max(-(-len(rows) // ROWS) - 1, 0)
        if event.arg == "selected":
            shown = session.selected
            selected = shown.design_id if shown else None
            place = [index for index, row in enumerate(rows) if int(picture.ids[row]) == selected]
            if not place:
                session.notify("Not in the table", "the selected design is not among the rows chosen", "yellow")
                return
            page = place[0] // ROWS
        else:
            page = {"first": 0, "back": page - 1, "on": page + 1, "last": last}.get(event.arg, page)
        session.set_table(page=min(max(page, 0), last))

    def _open_choice(self, _event: PageEvent) -> None:
        self._session.set_table(choosing=not self._session.table.choosing)

    def _column(self, event: PageEvent) -> None:
        session, picture = self._session, self._session.picture
        shown = [item.key for item in chosen_columns(picture, session.table)]
        if not event.arg:
            session.set_table(columns=())
        elif event.arg in shown:
            if len(shown) > 1:
                session.set_table(columns=tuple(key for key in shown if key != event.arg))
        elif event.arg in known_columns(picture):
            session.set_table(columns=(*shown, event.arg))

    def _select(self, event: PageEvent) -> None:
        if event.arg.isdecimal() and len(event.arg) < 12:
            select_design(self._session, self._designs, int(event.arg))

    def _star(self, event: PageEvent) -> None:
        if event.arg.isdecimal() and len(event.arg) < 12 and self._session.picture.row(int(event.arg)) is not None:
            self._session.star(int(event.arg))

    def _csv(self, _event: PageEvent) -> None:
        session, picture = self._session, self._session.picture
        text = designs_csv(picture, session.table, self._rows(picture), session.stars)
        name = picture.name.removesuffix(".hpsop") or "hpsop"
        self._download(f"{name}-designs.csv", text.encode("utf-8"))


def _count(number: int) -> str:
    return number_text(number, 0)


def _empty_words(which: str, filtered: bool) -> str:
    if filtered:
        return "No design keeps every condition above: drop one of them (✕)."
    if which == "starred":
        return "No design bears a star yet: press ☆ beside its number."
    return "No such design in this run; choose 'all'."
