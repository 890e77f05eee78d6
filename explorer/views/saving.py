"""Charts as files: what is drawn can be saved as SVG, PNG and CSV."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import viser

from explorer.server.bridge import PageEvent, picture_file, scrolling
from explorer.server.html_slot import Slot
from explorer.state.session import Session
from explorer.views.chips import GAP, chip, chips, soft
from hpsop_core.charts.plot import Plot
from hpsop_core.markup import Markup, fill, joined

Download = Callable[[str, bytes], None]
_KINDS = (
    ("svg", "SVG", "the chart as a drawing, on white, for paper"),
    ("png", "PNG", "the chart as a picture of three pixels for one"),
    ("csv", "CSV", "the numbers that the chart is drawn from"),
)
_SCALE = 3.0


@dataclass(frozen=True, eq=False)
class Figure:
    """A chart that can be saved.

    Attributes:
        name: one word.
        plot: what is drawn.
        numbers: its CSV where the plot's own series are not it.
        gestures: what its element says of the gestures that Python answers; "": values at the pointer alone.
        wide: whether it stands at its own width in a box that scrolls, instead of at the panel's.
    """

    name: str
    plot: Plot
    numbers: Callable[[], str] | None = None
    wide: bool = False
    gestures: str = ""

    def svg(self) -> Markup:
        """As it stands on the page."""
        if not self.wide:
            return self.plot.svg(self.name, self.gestures, readable=not self.gestures)
        drawn = self.plot.svg(self.name, readable=True)
        sheet = fill('<div style="width:{:g}px">{}</div>', self.plot.area.picture_width, drawn)
        return scrolling(self.name, sheet)


class Saving:
    """Gives out what charts show, as they were drawn last.

    Args:
        session: whose charts.
        gui: a container that is always mounted: a PNG is made by the browser from what comes through it.
        download: gives the browser a file by name.
    """

    def __init__(self, session: Session, gui: viser.GuiApi, download: Download) -> None:
        self._session = session
        self._download = download
        self._figures: dict[str, Figure] = {}
        self._slot = Slot(gui)
        self._serial = 0
        session.gestures.on("act", "chart_save", self._save)

    def keep(self, figures: Sequence[Figure]) -> None:
        """From now on a press on these charts' buttons saves them as they are here."""
        self._figures.update({item.name: item for item in figures})

    def offer(self, figures: Sequence[Figure]) -> Markup:
        """Keep these charts; a row of buttons that save them, none for one that holds nothing yet."""
        self.keep(figures)
        drawn = [item for item in figures if item.plot.series or item.numbers is not None]
        named = len(drawn) > 1
        rows = [chips(GAP, *buttons(item.name, f"save {_words(item.name)}" if named else "save")) for item in drawn]
        return joined(rows)

    def _save(self, event: PageEvent) -> None:
        name, _, kind = event.arg.partition(" ")
        figure = self._figures.get(name)
        if figure is None:
            return
        plot = figure.plot
        run, selected = self._session.picture.name.removesuffix(".hpsop"), self._session.selected
        design = "" if selected is None or selected.design_id is None else str(selected.design_id)
        file = "-".join(part for part in (run or "hpsop", design, name.replace("_", "-")) if part)
        if kind == "svg":
            self._download(f"{file}.svg", plot.file_svg(name).encode("utf-8"))
        elif kind == "csv":
            text = plot.csv() if figure.numbers is None else figure.numbers()
            self._download(f"{file}.csv", text.encode("utf-8"))
        elif kind == "png":
            self._serial += 1
            _, drawing = plot.file_svg(name).split("\n", 1)
            self._slot.show(picture_file(f"{file}.png", Markup(drawing), _SCALE, self._serial))


def buttons(name: str, word: str = "save") -> list[Markup]:
    """A word, and the buttons that save the chart of that name."""
    return [
        soft(word, "span"),
        *(chip("chart_save", title, f"{name} {kind}", hint=hint) for kind, title, hint in _KINDS),
    ]


def _words(name: str) -> str:
    return name.replace("_", " ")


def shown(parts: Sequence[Figure | Markup]) -> Markup:
    """Charts and words in their order, as they stand on the page."""
    return joined(part.svg() if isinstance(part, Figure) else part for part in parts)
