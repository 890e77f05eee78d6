"""The buttons over the 3D view: camera presets and what is drawn; and the card that names the design shown."""

from __future__ import annotations

import viser

from explorer.scene.camera import PRESETS, TITLES
from explorer.server.bridge import PageEvent, link_box, overlay
from explorer.server.html_slot import Slot, failure
from explorer.services.services import Services
from explorer.state.session import Session
from explorer.state.shown import Shown, file_name
from explorer.views.chips import NOTHING, chip, chips, soft
from explorer.views.headline import headline_card
from explorer.views.on_display import ghost_of
from explorer.views.tables import headline
from hpsop_core.errors import HpsopError
from hpsop_core.export.design_files import zip_design
from hpsop_core.markup import Markup, fill, joined
from hpsop_core.quantities import conditions_of, number_text, quantity_of, size_of_case

_SWITCHES = (
    ("ghost", "Ghost", "the initial design beside the selected one; choose another in Compare"),
    ("beside", "Beside", "the ghost abeam, to port, instead of around the selected hull"),
    ("hull", "Hull", "the hull; without it the propeller is seen from all sides"),
    ("topsides", "Topsides", "the hull above the waterline"),
    ("fittings", "Fittings", "deck house, cargo, rudder and draught marks: for looks, no number knows of them"),
    ("water", "Water", "the calm water surface; its ripples are paint"),
    ("waves", "Waves", "wave pattern at the chosen condition"),
    ("pressure", "Pressure", "pressure coefficient on hull and blades, level 2"),
    ("spin", "Turn", "the propeller turns at a quarter of its real rate"),
)


class ToolbarView:
    """Camera, switches, theme, screenshot; and the design's card with legends of what is overlaid."""

    def __init__(self, session: Session, services: Services, gui: viser.GuiApi, client: viser.ClientHandle) -> None:
        self._session = session
        self._designs, self._runs = services.designs, services.runs
        self._client = client
        self._bar = Slot(gui)
        self._card = Slot(gui)
        self._link, self._links = Slot(gui), 0
        session.hub.on(("options", "selection", "run"), self.draw)
        session.hub.on(("selection", "options", "pins", "legend"), self.draw_card, self._card_failed)
        session.gestures.on("act", "switch", self._switch)
        session.gestures.on("act", "condition", self._condition)
        session.gestures.on("act", "take_away", self._take_away)
        session.gestures.on("act", "link", self._show_link)
        session.gestures.on("act", "report", self._report)
        self.draw()
        self.draw_card()

    def _card_failed(self, error: BaseException) -> None:
        self._card.show(overlay("card", fill('<div class="card">{}</div>', failure(error))))

    def draw(self) -> None:
        """The buttons."""
        options = self._session.options
        cameras = joined(chip("camera", TITLES[name], name, on=options.camera == name) for name in PRESETS)
        switches = joined(
            chip("switch", word, name, on=bool(getattr(options, name)), hint=hint)
            for name, word, hint in _SWITCHES
            if name != "beside" or options.ghost
        )
        row = NOTHING
        shown = self._session.selected
        overlaid = options.waves or options.pressure or options.spin
        if overlaid and shown is not None and len(shown.evaluation.conditions) > 1:
            conditions = joined(
                chip(
                    "condition",
                    name,
                    str(index),
                    on=options.condition == index,
                    hint="the condition of waves, pressure and rotation",
                )
                for index, name in enumerate(conditions_of(shown.evaluation))
            )
            row = joined([soft("At", "span"), chips(conditions)])
        other = (
            chip("help", "?", hint="help: what stands where, and every word with its formula")
            + chip("switch", "Wide", "wide", on=options.wide, hint="close the panels: the ship has the whole window")
            + chip("switch", "Dark", "dark", on=options.dark)
            + chip("screenshot", "Screenshot", hint="the 3D view as a PNG, without panels")
            + chip(
                "switch",
                "size …",
                "picture_open",
                on=options.picture_open,
                hint="of the screenshot, and its background",
            )
            + chip("link", "Link", hint="an address that opens this run, generation, design, view and pins")
            + chip("report", "Report", disabled=not self._session.picture.name, hint="the run on one HTML page")
            + chip("take_away", "CAD files", hint="the shown design as Rhino, DXF, STL, GLB, CSV and JSON in one ZIP")
        )
        self._bar.show(
            overlay(
                "toolbar",
                fill(
                    '<div class="card"><div class="tools"><span class="soft">View</span>{}'
                    '<span class="soft">Show</span>{}{}<span class="soft">Page</span>{}{}</div></div>',
                    chips(cameras),
                    chips(switches),
                    row,
                    chips(other),
                    self._picture_row() if options.picture_open else NOTHING,
                ),
            )
        )

    def _picture_row(self) -> Markup:
        """Size and background of a screenshot."""
        options = self._session.options
        sides = options.picture_size(self._session.size)
        now = f"{options.picture_width}x{options.picture_height}"
        sizes = joined(
            chip("picture_size", word, value, on=now == value, hint=hint)
            for word, value, hint in (
                ("window", "window", "as large as this window"),
                ("1920 × 1080", "1920x1080", "full HD"),
                ("3840 × 2160", "3840x2160", "4K"),
            )
        )
        boxes = joined(
            (
                fill(
                    '<input type="number" class="bound" data-set="picture_side" data-arg="{}" value="{}" min="100" '
                    'max="7680" aria-label="{} of the screenshot in pixels">',
                    name,
                    value,
                    name,
                )
                for name, value in zip(("width", "height"), sides, strict=True)
            ),
            " × ",
        )
        clear = chip(
            "switch",
            "transparent",
            "picture_transparent",
            on=options.picture_transparent,
            hint="nothing behind the ship: no sky",
        )
        return joined([soft("Size", "span"), chips(sizes, fill('<span class="pair">{}</span>', boxes), clear)])

    def draw_card(self) -> None:
        """The design's name and headline numbers, and legends."""
        shown = self._session.selected
        if shown is None:
            self._card.show(overlay("card", Markup('<div class="card">Computing the initial design …</div>')))
            return
        evaluation = shown.evaluation
        numbers = facts = NOTHING
        if evaluation.ok:
            case = self._session.picture.case
            size = size_of_case(case)
            numbers = headline_card(case, self._designs.initial(evaluation.level), shown)
            facts = fill(
                "L<sub>PP</sub> {} · B {} · d {} · C<sub>B</sub> {:.3f} · ∇ {}<br>D {} · Z {} · f₁ {} · f₂ {}",
                *(quantity_of(evaluation, key, size) for key in ("length", "breadth", "hull_draft")),
                evaluation.hull.block_coefficient,
                *(quantity_of(evaluation, key, size) for key in ("displaced_volume", "propeller_diameter")),
                evaluation.variables.blade_count,
                number_text(evaluation.objectives.get("f1"), 4),
                number_text(evaluation.objectives.get("f2"), 4),
            )
        ghost = self._ghost_words()
        legends = joined(list(self._session.legends.values()))
        if legends:
            legends = fill('<div class="scales">{}</div>', legends)
        self._card.show(
            overlay(
                "card",
                fill(
                    '<div class="card" data-card="{}">{}<br>{}<span class="soft">{}{}</span>{}</div>',
                    shown.design_id if shown.design_id is not None else shown.kind,
                    headline(shown),
                    numbers,
                    facts,
                    ghost,
                    legends,
                ),
            )
        )

    def _ghost_words(self) -> Markup:
        ghost, _ = ghost_of(self._session, self._designs)
        return fill("<br>ghost: {}", _within_a_line(ghost)) if ghost is not None else NOTHING

    def _switch(self, event: PageEvent) -> None:
        options = self._session.options
        if event.arg in {"dark", "wide", "picture_open", "picture_transparent"} | {name for name, _, _ in _SWITCHES}:
            self._session.set_options(**{event.arg: not getattr(options, event.arg)})

    def _condition(self, event: PageEvent) -> None:
        shown = self._session.selected
        if shown is not None and event.arg.isdecimal() and int(event.arg) < len(shown.evaluation.conditions):
            self._session.set_options(condition=int(event.arg))

    def _show_link(self, _event: PageEvent) -> None:
        self._links += 1
        self._link.show(link_box(self._session.link().query(), self._links))

    def _report(self, _event: PageEvent) -> None:
        self._session.notify("Writing the report", "the download begins in some seconds", "green")
        self._session.slow.latest("report", self._send_report)

    def _send_report(self) -> None:
        try:
            name, page = self._runs.report()
        except HpsopError as error:
            self._session.notify("No report", str(error), "red")
            return
        self._client.send_file_download(name, page, save_immediately=True)

    def _take_away(self, _event: PageEvent) -> None:
        shown = self._session.selected
        if shown is None or not shown.evaluation.ok:
            self._session.notify("No files", "a design that failed has no shape; select another one", "yellow")
            return
        self._session.notify("Writing the files", f"{shown.label}: the download begins in some seconds", "green")
        self._session.heavy.latest("take away", lambda: self._export(shown))

    def _export(self, shown: Shown) -> None:
        case, evaluation = self._session.picture.case, shown.evaluation
        try:
            reference = self._designs.reference(evaluation.level)
            archive = zip_design(case, evaluation, _within_a_line(shown), reference)
        except HpsopError as error:
            self._session.notify("No files", str(error), "red")
            return
        self._client.send_file_download(f"{file_name(shown)}.zip", archive, save_immediately=True)


def _within_a_line(shown: Shown) -> str:
    return shown.label[0].lower() + shown.label[1:]
