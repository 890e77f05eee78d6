"""Your ship: a hull and a propeller from files, what was understood of them, and the case that they become."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import viser

from explorer.server.bridge import PageEvent
from explorer.server.html_slot import Slot
from explorer.server.uploads import taken
from explorer.server.widgets import set_value
from explorer.services.own_ships import OwnShips
from explorer.services.runs import Runs
from explorer.state.draft import Draft
from explorer.state.own_ship import OwnShip
from explorer.state.session import Session
from explorer.views.chips import NOTHING, box, chip, chips, soft
from explorer.views.ship_picture import ShipPicture
from explorer.views.ship_words import hull_words, propeller_words
from hpsop_core.case.fields import checked_value, rules
from hpsop_core.case.sections import HullSection
from hpsop_core.errors import HpsopError, InputError
from hpsop_core.evaluation.solvable import solvable_case
from hpsop_core.geometry.hull.input import UNITS, Axes
from hpsop_core.geometry.hull.input.mesh import SUFFIXES as MESH_SUFFIXES
from hpsop_core.markup import Markup, fill, joined

BLADES = (2, 3, 4, 5, 6, 7)
_AUTO = "auto"
# What can be said of a file's axes by a press, in the words of people.
_AXES: tuple[tuple[str, str, tuple[tuple[str, str], ...]], ...] = (
    ("bow", "bow at", (("+x", "+x"), ("-x", "−x"))),
    ("origin", "x = 0 at", (("ap", "AP"), ("midship", "midship"), ("fp", "FP"))),
    ("waterline", "z = 0 at", (("draft", "baseline"), ("z0", "still water"))),
    ("up", "up is", (("z", "z"), ("-z", "−z"), ("y", "y"), ("-y", "−y"))),
)
# What is typed: a field of [hull], its label, and what an empty one means.
_NUMBERS = (
    ("length", "Lpp [m]", "length between perpendiculars; empty: as the file tells"),
    ("draft", "Draft [m]", "still water above the baseline; empty: as the file tells"),
    ("breadth", "Breadth [m]", "only for a table in fractions of B/2; empty: as the file tells"),
    (
        "shaft_height",
        "Shaft height [m]",
        "the propeller shaft above the baseline; empty: found from the boss, or assumed",
    ),
    ("boss_x", "Hub from x [m]", "where the propeller's hub begins, from AP; empty: found from boss or stern"),
)
_TYPING_SECONDS = 1.5
_ACCEPTED = ".csv,.txt,.dat,.tsv,.stl,.obj,.ply,.off,.glb,.3dm,.step,.stp,.igs,.iges,text/*"


class ShipView:
    """Upload buttons, the picture, what can be put right, what was understood, and *Make it the case*."""

    def __init__(self, session: Session, ships: OwnShips, runs: Runs, gui: viser.GuiApi) -> None:
        self._session, self._app = session, session.app
        self._ships, self._runs = ships, runs
        self._picture = ShipPicture(session)
        self._typed: dict[str, int] = {}
        self._intro = Slot(gui)
        self._hull = gui.add_upload_button("Open a hull file …", mime_type=_ACCEPTED, icon=viser.Icon.UPLOAD)
        self._propeller = gui.add_upload_button(
            "Open a propeller table …", mime_type=".csv,.txt,.dat,.tsv,text/*", icon=viser.Icon.UPLOAD, color="gray"
        )
        self._state = Slot(gui)
        self._make = gui.add_button("Make it the case", visible=False, hint="set up initial design, bounds and speeds")
        self._plan = Slot(gui)
        with gui.add_folder("How the file is read", visible=False) as self._folder:
            self._choices = Slot(gui)
            self._fields = {name: gui.add_text(label, "", hint=hint) for name, label, hint in _NUMBERS}
        self._words = Slot(gui)
        self._curves = Slot(gui)
        self._hull.on_upload(lambda event: self._arrived(event, ships.bring_hull))
        self._propeller.on_upload(lambda event: self._arrived(event, ships.bring_propeller))
        self._make.on_click(self._on_make)
        for name, field in self._fields.items():
            field.on_update(self._typing(name))
        session.gestures.on("act", "ship_say", self._say)
        session.gestures.on("act", "ship_blades", self._say_blades)
        session.gestures.on("act", "ship_away", lambda event: ships.put_away(event.arg))
        session.hub.on(("ship", "size"), self.draw, self._words.failed)
        # on the hub's own thread: a file may be understood at this moment, and the older picture must not come last
        session.worker.every(self.draw)

    # ---- gestures --------------------------------------------------------------------------------------------------
    def _arrived(self, event: viser.GuiEvent[Any], bring: Callable[[str, bytes], None]) -> None:
        name, content = taken(event.target)
        if content:
            bring(name, content)

    def _say(self, event: PageEvent) -> None:
        name, _, value = event.arg.partition(" ")
        try:
            if name == "unit":
                self._ships.say(unit=None if value == _AUTO else value)
            else:
                self._ships.say(axes=_with_axis(self._app.ship.options.axes, name, value))
        except HpsopError as error:
            self._session.notify("Not done", str(error), "red")

    def _say_blades(self, event: PageEvent) -> None:
        if event.arg in {str(count) for count in BLADES}:
            self._ships.say_blades(int(event.arg))

    def _typing(self, name: str) -> Callable[[viser.GuiEvent[Any]], None]:
        def update(event: viser.GuiEvent[Any]) -> None:
            if event.client_id is None:
                return
            serial = self._typed[name] = self._typed.get(name, 0) + 1
            try:
                value = length_from_text(name, event.target.value)
            except InputError as error:
                # "-" on the way to "-3.2" is no mistake yet
                timer = threading.Timer(_TYPING_SECONDS, self._rested, (name, serial, str(error)))
                timer.daemon = True
                timer.start()
                return
            if value != _said(self._app.ship, name):
                self._ships.say(**{name: value})

        return update

    def _rested(self, name: str, serial: int, why: str) -> None:
        if self._typed.get(name) == serial:
            self._session.notify("Not accepted", why, "red")
            self._show(name, _said(self._app.ship, name))

    def _on_make(self, _event: viser.GuiEvent[Any]) -> None:
        self._app.worker.every(self._adopt)

    def _adopt(self) -> None:
        """Set up the case of this ship, and show it where no run is under way."""
        session = self._session
        try:
            case, left = solvable_case(self._ships.case())
        except HpsopError as error:
            session.notify("Not done", str(error), "red")
            return
        self._app.change_draft(lambda draft: Draft.begin(draft, case), whole=True)
        self._app.did(session, f"made {case.title} the case")
        try:
            self._runs.close_run()
        except InputError:
            session.notify(
                "Set up", "The run under way goes on; stop it to see this ship and to start its run.", "blue"
            )
        else:
            session.notify("Set up", f"{case.title}: press Start, or change its bounds and speeds first.", "green")
        if left:
            session.notify("Set up with less", left, "yellow")

    # ---- drawing ---------------------------------------------------------------------------------------------------
    def draw(self) -> None:
        """Draw everything again."""
        ship = self._app.ship
        self._intro.show(box(_introduction(ship)))
        self._state.show(box(_state(ship)))
        usable = (ship.read is not None or ship.read_propeller is not None) and not ship.reading
        usable = usable and not (ship.trouble or ship.propeller_trouble)
        _set(self._make, "visible", ship.hull is not None or ship.propeller is not None)
        _set(self._make, "disabled", not usable)
        _set(self._folder, "visible", ship.hull is not None)
        plan, curves = self._picture.drawn(ship)
        self._plan.show(plan)
        self._curves.show(curves)
        self._choices.show(box(_choices(ship)) if ship.hull is not None else NOTHING)
        for name in self._fields:
            self._follow(ship, name)
        parts = [hull_words(ship.read) if ship.read else NOTHING]
        parts.append(propeller_words(ship.read_propeller) if ship.read_propeller else NOTHING)
        self._words.show(box(*parts))

    def _follow(self, ship: OwnShip, name: str) -> None:
        """A field shows what was said; what somebody is typing there and means the same stays as it is typed."""
        said = _said(ship, name)
        try:
            shown = length_from_text(name, self._fields[name].value)
        except InputError:
            # taken back when the typing has rested
            return
        if shown != said:
            self._show(name, said)

    def _show(self, name: str, said: float | None) -> None:
        set_value(self._fields[name], "" if said is None else f"{said:.10g}")


def length_from_text(name: str, text: object) -> float | None:
    """What was typed into a field of a length: metres, or None for nothing.

    Raises:
        InputError: no number, or outside the field's limits.
    """
    words = str(text).strip().replace(",", ".")
    if not words:
        return None
    try:
        value = float(words)
    except ValueError:
        raise InputError(f"{name}: '{words[:40]}' is no number of metres; write for example 14.5") from None
    return float(checked_value(value, rules(HullSection)[name], name))


def _said(ship: OwnShip, name: str) -> float | None:
    value: float | None = getattr(ship if name in ("shaft_height", "boss_x") else ship.options, name)
    return value


def _with_axis(axes: Axes, name: str, value: str) -> Axes:
    known = {key for key, _, _ in _AXES}
    if name not in known:
        raise InputError(f"axes: {name[:20]!r} is unknown; press the page's own buttons")
    return Axes(**{key: value if key == name else getattr(axes, key) for key in known})


def _set(widget: Any, name: str, value: bool) -> None:
    """Set an attribute of a widget where it is another one now: each setting is a message to the browser."""
    if getattr(widget, name) != value:
        setattr(widget, name, value)


def _introduction(ship: OwnShip) -> Markup:
    if ship.hull is not None or ship.propeller is not None:
        return NOTHING
    return Markup(
        "<p>Bring a ship of your own: a table of offsets (CSV or text), a mesh (STL, OBJ, PLY, OFF, GLB), 3dm, STEP or "
        "IGES. It is read as it stands, you see what was understood and put right what was not, and it becomes the "
        "case: initial design, bounds, speeds, optimisation and exports.</p>"
        '<p class="soft">The file stays on this machine. docs/bring-your-ship.md says which layouts are read.</p>'
    )


def _state(ship: OwnShip) -> Markup:
    rows = []
    for what, file, trouble, read in (
        ("hull", ship.hull, ship.trouble, ship.read is not None),
        ("propeller", ship.propeller, ship.propeller_trouble, ship.read_propeller is not None),
    ):
        if file is None:
            continue
        mark = "reading" if ship.reading else "bad" if trouble else "good" if read else "reading"
        word = {"reading": "reading …", "bad": "cannot be used", "good": "understood"}[mark]
        size = f"{len(file.content) / 1024:,.0f} kB"
        rows.append(
            fill(
                '<div class="row" data-ship-{what}="{mark}"><div class="chips"><b>{name}</b> '
                '<span class="soft">{what}, {size}</span> <span class="{mark}">{word}</span>'
                '<span class="gap"></span>{away}</div>{trouble}</div>',
                what=what,
                mark=mark,
                name=file.name,
                size=size,
                word=word,
                away=chip("ship_away", "put away", what),
                trouble=fill('<p class="bad">{}</p>', trouble) if trouble else NOTHING,
            )
        )
    blades = NOTHING
    if ship.propeller is not None:
        blades = fill(
            '<div class="tools">{}{}</div>',
            soft("blades of the table", "span"),
            chips(*(chip("ship_blades", str(count), str(count), on=count == ship.blades) for count in BLADES)),
        )
    return fill('<div class="rows">{}</div>{}', joined(rows), blades)


def _choices(ship: OwnShip) -> Markup:
    """A row of buttons for each thing that can be said of the file by a press."""
    options = ship.options
    units = (_AUTO, *UNITS)
    rows = [
        soft("unit", "span")
        + chips(
            *(
                chip(
                    "ship_say",
                    "as the file says" if unit == _AUTO else unit,
                    f"unit {unit}",
                    on=unit == (options.unit or _AUTO),
                )
                for unit in units
            )
        )
    ]
    mesh = ship.hull is not None and ship.hull.name.lower().endswith(MESH_SUFFIXES)
    for name, words, choices in _AXES:
        if name == "up" and not mesh:
            continue
        now = getattr(options.axes, name)
        every = ((_AUTO, "as the file says"), *choices)
        rows.append(
            soft(words, "span")
            + chips(*(chip("ship_say", word, f"{name} {value}", on=value == now) for value, word in every))
        )
    return fill('<div class="tools">{}</div>', joined(rows))
