"""The page's help says what the declarations say, of every quantity, and of every panel."""

from __future__ import annotations

import re

from explorer.views.help_words import PURPOSES, TOUR, help_card, tour_card
from hpsop_core.case.case import load_case
from hpsop_core.case.objectives import OBJECTIVES
from hpsop_core.markup import symbol_html
from hpsop_core.quantities import OBJECTIVES as CHOSEN
from hpsop_core.quantities import all_quantities
from tests.two_speeds import TWO_SPEEDS

# their names say all that there is to say
_PLAIN = {"length", "breadth", "hull_draft", "propeller_diameter", "blades"}


def test_every_quantity_stands_in_the_glossary_with_its_formula():
    card = str(help_card(load_case(TWO_SPEEDS)))
    words = set(re.findall(r'data-word="([^"]*)"', card))
    shown = [item for item in all_quantities(("20 kn",)) if item not in CHOSEN]
    assert {item.key.removesuffix("_1") for item in shown} <= words
    assert [item.key for item in shown if not item.formula and item.key not in _PLAIN] == []
    for objective in OBJECTIVES:
        assert objective.words.replace("'", "&#39;") in card
    # no name of a field of a case file, and no subscript that swallowed its formula
    assert not re.search(r">[^<]*[a-z]_[a-z][^<]*<", card)
    for item in shown:
        assert not re.search(r"<sub>[^<]*[/(·+][^<]*</sub>", symbol_html(item.formula)), item.key


def test_every_panel_of_the_layout_has_its_purpose():
    from importlib.resources import files

    layout = (files("explorer") / "layout.py").read_text(encoding="utf-8")
    titles = set(re.findall(r'add_tab\("([^"]+)"\)', layout)) | set(
        re.findall(r'"([^"]+)"', re.search(r"titles = \[(.*?)\]", layout)[1])
    )
    # "hpsop" is never seen
    assert (titles | {"Your ship"}) - {"hpsop"} == set(PURPOSES)


def test_the_tour_goes_on_and_ends():
    cards = [str(tour_card(index)) for index in range(len(TOUR))]
    assert all('data-arg="end"' in card for card in cards)
    assert [re.findall(r'data-arg="(\d)"', card) for card in cards][:2] == [["1"], ["0", "2"]]
