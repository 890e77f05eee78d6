"""The families of a front side by side: a small body plan each, all at one scale."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hpsop_core.charts.marks import polyline
from hpsop_core.evaluation.curves import HullLines
from hpsop_core.evaluation.result import Ok
from hpsop_core.markup import Markup, fill, joined
from hpsop_core.quantities import number_text

_WIDTH, _HEIGHT = 130.0, 74.0
# a thumbnail shows every other section by every third point
_SECTIONS, _POINTS = 2, 3


@dataclass(frozen=True)
class FamilyCard:
    """One family.

    Attributes:
        number: from 1 along the first objective.
        members: how many designs it has.
        design_id: of the member in the middle, which stands for it.
        evaluation: of that one.
        lines: of its hull, or None while they are being cut.
        words: what it is beside: "compromise", "knee" or "".
    """

    number: int
    members: int
    design_id: int
    evaluation: Ok
    lines: HullLines | None
    words: str = ""


def family_cards(cards: Sequence[FamilyCard], initial: HullLines | None, selected: int | None) -> Markup:
    """Cards that select their design when pressed.

    Args:
        cards: in the order shown.
        initial: lines of the initial design, grey behind each.
        selected: the selected design's id.
    """
    known = [card.lines for card in cards if card.lines is not None] + ([initial] if initial is not None else [])
    parts = [line for lines in known for _, own in lines.sections for line in own if len(line)]
    half = max((float(np.abs(line[:, 0]).max()) for line in parts), default=1.0)
    top = max((float(line[:, 1].max()) for line in parts), default=1.0)
    scale = min(0.48 * _WIDTH / half, 0.96 * _HEIGHT / top)
    return fill(
        '<div class="families">{}</div>',
        joined(_card(card, initial, scale, card.design_id == selected) for card in cards),
    )


def _card(card: FamilyCard, initial: HullLines | None, scale: float, on: bool) -> Markup:
    evaluation = card.evaluation
    hull, values = evaluation.hull, evaluation.variables
    behind = _sections(initial, scale, "initial") if initial is not None else Markup("")
    own = _sections(card.lines, scale, "selected" if on else f"level{evaluation.level}") if card.lines else Markup("")
    count = "1 design" if card.members == 1 else f"{card.members} designs"
    return fill(
        '<button type="button" class="family{on}" data-act="table_select" data-arg="{id}" aria-pressed="{pressed}" '
        'title="select design {id}"><svg class="chart" viewBox="0 0 {wide:g} {high:g}" role="img" '
        'aria-label="body plan of design {id}">{behind}{own}</svg>'
        "<b>f₁ {f1} · f₂ {f2}</b><br>{words}{count}<br>L {length} · B {breadth} · d {draft} m<br>D {diameter} m · Z {z}"
        "</button>",
        on=" on" if on else "",
        pressed="true" if on else "false",
        id=card.design_id,
        wide=_WIDTH,
        high=_HEIGHT,
        behind=behind,
        own=own,
        f1=number_text(evaluation.objectives.get("f1"), 3),
        f2=number_text(evaluation.objectives.get("f2"), 3),
        words=f"{card.words}, " if card.words else "",
        count=count,
        length=number_text(hull.length, 1),
        breadth=number_text(hull.breadth, 1),
        draft=number_text(hull.draft, 2),
        diameter=number_text(values.diameter, 2),
        z=values.blade_count,
    )


def _sections(lines: HullLines, scale: float, css: str) -> Markup:
    drawn = []
    for station, parts in lines.sections[::_SECTIONS]:
        side = -1.0 if station < 10 else 1.0
        for line in parts:
            some = np.concatenate([line[:-1:_POINTS], line[-1:]]) if len(line) else line
            drawn.append(polyline(0.5 * _WIDTH + side * scale * some[:, 0], _HEIGHT - 1.0 - scale * some[:, 1]))
    return fill('<path d="{}" class="line hair {}" style="opacity:.9"/>', "".join(drawn), css)
