"""What the page says about itself: each panel's purpose, the tour, the gestures, and the glossary.

The glossary's symbols, units and formulas are the declarations' own; nothing is said of a quantity here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from explorer.views.chips import box, soft
from explorer.views.settings_fields import with_labels
from hpsop_core.case.case import Case
from hpsop_core.case.constraints import CONSTRAINTS
from hpsop_core.case.objectives import OBJECTIVES
from hpsop_core.markup import Markup, fill, joined, symbol_html
from hpsop_core.quantities import (
    HULL,
    PROPELLER,
    SHIP,
    Quantity,
    condition_quantities,
    size_of_case,
    variable_quantities,
)

PURPOSES = {
    "Design space": "What the search may change, and how far: two bounds for each variable.",
    "Case": "The question that is asked: speeds, objectives, limits, and the physics behind the numbers.",
    "Runs": "Earlier searches: open one, or go on with it.",
    "Pareto front": "Every point is a design; left and down is better. Click one to see it.",
    "Design": "The selected design's numbers beside the initial design's.",
    "Charts": "Curves and lines of the selected design, and how the search went.",
    "Table": "Every design of the run: sort, filter, star, and take away.",
    "Compare": "Designs that you pinned, side by side.",
    "What-if": "Change the selected design by hand and see at once what it would do.",
    "Your ship": "Bring in your own hull and propeller, and make them the case.",
}

GESTURES = (
    ("drag, wheel on the ship", "turn it, come closer; right button moves it"),
    ("rest on a point of a chart", "all its numbers"),
    ("click a point", "select that design; everything else follows"),
    ("← → Home End", "walk along the front"),
    ("wheel, drag, double click on the front", "zoom, move, show all"),
    ("Shift + drag on the front", "keep a box of designs; Esc drops it"),
    ("drag along an axis of the parallel coordinates", "keep a range; its name, dragged or by ← →, moves the axis"),
    ("Ctrl+Z, Ctrl+Shift+Z", "undo and redo a change of the settings, or of the what-if where one was at work there"),
    ("rest on a label or a row's name", "what it means"),
)


@dataclass(frozen=True)
class Step:
    """One step of the tour: what it points at (``point`` in assets/page.js), a title, a sentence or two."""

    target: str
    title: str
    words: str


TOUR = (
    Step(
        ".hpsop-overlay-card",
        "The design shown",
        "Hull and propeller as they were computed, and what they save against the initial design, before → after. "
        "Drag to turn the ship, use the wheel to come closer.",
    ),
    Step(
        "svg[data-chart=pareto]",
        "All designs of the search",
        "Left and down is better. Nothing beats the designs on the front in both objectives. Click any point: ship, "
        "numbers and charts follow.",
    ),
    Step(
        "tab:Design",
        "Its numbers, and its curves",
        "Design compares with the initial design and says which limits are reached; Charts hold resistance, propeller, "
        "power and lines; Table lists every design.",
    ),
    Step(
        "[data-act=run_start], [data-act=run_continue]",
        "Your own search",
        "Choose a case and the bounds below, then press Start. The front grows while you watch, and every run is kept.",
    ),
    Step(
        "tab:What-if",
        "By hand, and your own ship",
        "What-if answers while you drag. Your ship reads a hull file. The ? above has every word with its formula, and "
        "this tour.",
    ),
)


def purpose(panel: str) -> Markup:
    """A panel's first line."""
    return box(fill('<p class="soft purpose">{}</p>', PURPOSES[panel]))


def tour_card(index: int) -> Markup:
    """A step of the tour with its buttons."""
    step, last = TOUR[index], index == len(TOUR) - 1
    before = _button("tour", str(index - 1), "Back") if index else Markup("")
    after = _button("tour", "end" if last else str(index + 1), "Done" if last else "Next", " data-next")
    leave = Markup("") if last else _button("tour", "end", "Leave the tour")
    return fill(
        '<div class="card tour" data-point="{}"><b>{}</b> <span class="soft">{} of {}</span><p>{}</p>'
        '<div class="chips">{}{}<span class="gap"></span>{}</div></div>',
        step.target,
        step.title,
        index + 1,
        len(TOUR),
        step.words,
        before,
        after,
        leave,
    )


def _button(action: str, arg: str, word: str, mark: str = "") -> Markup:
    # who goes through the tour by the keyboard goes on with what is marked as next (assets/page.js)
    button = '<button type="button" class="chip" data-act="{}" data-arg="{}"{}>{}</button>'
    return fill(button, action, arg, Markup(mark), word)


def help_card(case: Case) -> Markup:
    """Panels, gestures and glossary, in a card that scrolls."""
    panels = joined(fill("<tr><td><b>{}</b></td><td>{}</td></tr>", name, words) for name, words in PURPOSES.items())
    gestures = joined(fill("<tr><td>{}</td><td>{}</td></tr>", *row) for row in GESTURES)
    objectives = joined(
        fill("<tr><td>{}</td><td>{}</td><td>{}</td></tr>", item.label, item.formula, item.words) for item in OBJECTIVES
    )
    constraints = joined(
        fill(
            '<tr data-word="g_{}"><td>{}</td><td>{}</td><td>{}</td></tr>',
            item.name,
            symbol_html(item.symbol),
            item.label,
            with_labels(f"{item.meaning} ({item.applies})"),
        )
        for item in CONSTRAINTS
    )
    size = size_of_case(case)
    condition = condition_quantities(("",), size)
    groups = (
        ("Design variables", _rows(variable_quantities(case))),
        ("Objectives (a case chooses two; less is better)", objectives),
        ("Constraints (g ≤ 0 is kept; “…” are fields of the case)", constraints),
        ("Hull", _rows([item.sized(size) for item in HULL])),
        ("Ship", _rows([item.sized(size) for item in SHIP])),
        ("Propeller", _rows([item.sized(size) for item in PROPELLER])),
        ("At each operating condition", _rows(condition)),
    )
    glossary = joined(
        fill('<details open><summary>{}</summary><table class="glossary">{}</table></details>', title, rows)
        for title, rows in groups
    )
    looks = soft(
        "Deck house, cargo, rudder, draught marks, shadow and the ripples on calm water are drawn for looks: they "
        "follow the hull's dimensions, and neither a number nor an exported file knows of them."
    )
    return fill(
        '<div class="card help hp" tabindex="0"><div class="chips"><b>Help</b><span class="gap"></span>{}{}</div>'
        '<h4>What stands where</h4><table class="glossary">{}</table>'
        '<h4>Gestures</h4><table class="glossary">{}</table>{}<h4>Words and formulas</h4>{}</div>',
        _button("tour", "0", "Take the tour"),
        _button("help", "close", "Close"),
        panels,
        gestures,
        looks,
        glossary,
    )


def _rows(quantities: Sequence[Quantity]) -> Markup:
    """Symbol, name and formula of each; the number of the condition is left out."""
    rows = []
    for item in quantities:
        symbol = item.symbol
        if item.key.endswith("_1") and item.group.startswith("Condition"):
            symbol = symbol.removesuffix("1").removesuffix("_")
        unit = f" [{item.unit}]" if item.unit else ""
        rows.append(
            fill(
                '<tr data-word="{}"><td>{}{}</td><td>{}</td><td>{}</td></tr>',
                item.key.removesuffix("_1"),
                symbol_html(symbol),
                unit,
                item.label,
                symbol_html(item.formula),
            )
        )
    return joined(rows)
