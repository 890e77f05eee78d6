"""The table of all designs: rows, order, words of a filter, pages and CSV against the arrays it is made from."""

from __future__ import annotations

import csv
import io
import math
import re

import numpy as np
import pytest

from explorer.charts.designs_table import (
    ROWS,
    chosen_columns,
    designs_csv,
    designs_table,
    known_columns,
    page_of,
    parse_filter,
    table_rows,
)
from explorer.state.run_picture import GenerationPicture, RunPicture
from explorer.state.table_options import TableOptions
from hpsop_core.case.case import load_case
from hpsop_core.errors import InputError
from tests.two_speeds import TWO_SPEEDS

CASE = load_case(TWO_SPEEDS)
COLUMNS = ("length", "breadth", "delivered_power_1", "thrust_1", "thrust_deduction_1", "propulsive_efficiency_1")
NONE: frozenset[int] = frozenset()


def run_of(count: int) -> RunPicture:
    """A run of designs 10, 20, ...; every seventh failed, every third is infeasible, equal f1 in fours."""
    index = np.arange(count)
    failed = index % 7 == 3
    table = np.column_stack([300.0 + (37.0 * index) % 101 + column for column in range(len(COLUMNS))])
    objectives = np.column_stack([0.8 + index // 4 % 50 / 250.0, 1.0 - index / (2.0 * count)])
    table[failed], objectives[failed] = np.nan, np.nan
    # a number that some designs lack
    table[index % 5 == 0, 2] = np.nan
    ids = 10 * (index + 1)
    return RunPicture(
        "a.hpsop",
        CASE,
        ids=ids,
        level=1 + index % 2,
        generation=1 + index // 50,
        objectives=objectives,
        feasible=(index % 3 != 0) & ~failed,
        failed=failed,
        by_hand=np.zeros(count, dtype=bool),
        table=table,
        columns=COLUMNS,
        generations=(GenerationPicture(1, 2, tuple(ids[:50].tolist()), (20, 30, 50), 0.1),),
    )


RUN = run_of(200)


@pytest.mark.parametrize("sort", ["id", "level", "f1", "length", "delivered_power_1"])
@pytest.mark.parametrize("descending", [False, True])
def test_rows_stand_in_the_order_asked_for_and_what_is_missing_comes_last(sort: str, descending: bool):
    rows = table_rows(RUN, TableOptions(sort=sort, descending=descending, which="all"), {}, NONE)
    assert sorted(rows) == np.flatnonzero(~RUN.failed).tolist()
    plain = {"id": RUN.ids, "level": RUN.level}.get(sort)
    values = (plain if plain is not None else RUN.column(sort))[rows].astype(float)
    missing = np.isnan(values)
    assert not np.any(np.diff(missing.astype(int)) < 0)
    steps = np.diff(values[~missing])
    assert np.all(steps <= 0.0 if descending else steps >= 0.0)
    assert np.all(np.diff(RUN.ids[rows][~missing])[steps == 0.0] > 0)


def test_which_rows_there_are():
    def ids(which: str, stars: frozenset[int] = NONE) -> set[int]:
        return set(RUN.ids[table_rows(RUN, TableOptions(which=which), {}, stars)].tolist())

    assert ids("feasible") == set(RUN.ids[RUN.feasible].tolist())
    # 40 failed: a front never names it, a star may
    assert ids("front") == {20, 30, 50}
    assert ids("starred", frozenset({10, 40, 60})) == {10, 60}
    low = float(np.nanmedian(RUN.column("length")))
    rows = table_rows(RUN, TableOptions(which="all"), {"length": (low, math.inf)}, NONE)
    assert set(rows.tolist()) == set(np.flatnonzero(RUN.column("length") >= low).tolist())


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("f1 < 0.95", {"f1": (-math.inf, 0.95)}),
        ("f₁ ≤ 0.95, L_PP > 340", {"f1": (-math.inf, 0.95), "length": (340.0, math.inf)}),
        ("length>300;length<310", {"length": (300.0, 310.0)}),
        ("lpp = 320", {"length": (320.0, 320.0)}),
        # the symbols of thrust and thrust deduction differ in the size of the letter alone
        ("T1 > 1e3, t1 < .2", {"thrust_1": (1e3, math.inf), "thrust_deduction_1": (-math.inf, 0.2)}),
        ("f1 > −1", {"f1": (-1.0, math.inf)}),
        (" , ", {}),
    ],
)
def test_words_of_a_filter(words: str, found: dict[str, tuple[float, float]]):
    assert parse_filter(words, RUN) == found


@pytest.mark.parametrize("words", ["f1", "f1 < ", "knots < 3", "f1 < 1.2.3", "f1 < <b>", "0.9 < f1 < 1"])
def test_a_filter_that_cannot_be_understood_is_said_in_a_line(words: str):
    with pytest.raises(InputError) as told:
        parse_filter(words, RUN)
    assert "\n" not in str(told.value)


def test_a_page_is_bounded_however_many_designs_there_are():
    large = run_of(7500)
    options = TableOptions(which="all", columns=COLUMNS, page=10**6)
    rows = table_rows(large, options, {}, NONE)
    page = page_of(rows, options)
    assert page == math.ceil(len(rows) / ROWS) - 1
    html = designs_table(large, options, rows, None, NONE)
    shown = [int(text) for text in re.findall(r'<tr data-design="(\d+)"', html)]
    assert shown == large.ids[rows[page * ROWS :]].tolist()
    full = designs_table(large, TableOptions(which="all", columns=COLUMNS), rows, None, NONE)
    assert full.count("<tr data-design") == ROWS
    # some kilobytes: it is sent with every generation of a run
    assert len(full) < 40_000
    assert page_of(rows[:0], options) == 0
    # a heading says of which speed its number is
    usual = designs_table(large, TableOptions(which="all"), rows, None, NONE)
    assert re.search(r">P<sub>D1</sub>.*?<br><span class=\"unit\">MW<br>[\d.]+ kn</span></th>", usual)


def test_the_csv_holds_every_row_and_the_columns_shown():
    options = TableOptions(which="all", sort="length", columns=("length", "delivered_power_1", "gone"))
    rows = table_rows(RUN, options, {}, NONE)
    read = list(csv.reader(io.StringIO(designs_csv(RUN, options, rows, frozenset({20})))))
    assert read[0] == ["design", "level", "generation", "feasible", "star", "LPP [m]", "PD1 [MW]"]
    assert [int(line[0]) for line in read[1:]] == RUN.ids[rows].tolist()
    for line, row in zip(read[1:], rows, strict=True):
        assert float(line[5]) == pytest.approx(RUN.column("length")[row], rel=1e-8)
        power = RUN.column("delivered_power_1")[row]
        assert line[6] == "" if math.isnan(power) else float(line[6]) == pytest.approx(power, rel=1e-8)
        assert line[4] == ("1" if line[0] == "20" else "0")


def test_a_row_says_what_it_is():
    options = TableOptions(which="all", sort="id")
    rows = table_rows(RUN, options, {}, NONE)
    html = designs_table(RUN, options, rows, 20, frozenset({30}))
    row = {int(number): body for number, body in re.findall(r'<tr data-design="(\d+)"(.*?)</tr>', html)}
    assert 'class="on front"' in row[20] and 'title="on the front"' in row[20]
    assert 'class="broken"' in row[10]
    assert 'aria-pressed="true"' in row[30] and 'aria-pressed="false"' in row[20]
    assert html.count('aria-sort="ascending"') == 1


def test_what_a_reload_brings_back():
    before = TableOptions(("length", "f1"), "length", True, "starred", 3, True)
    saved = {"columns": ["length", "f1"], "sort": "length", "descending": True, "which": "starred", "page": 3}
    assert TableOptions().restored(saved) == TableOptions(before.columns, "length", True, "starred")
    for nonsense in (None, 3, {"columns": 3, "sort": [], "which": "none", "descending": "yes"}):
        assert TableOptions().restored(nonsense) == TableOptions()


def test_the_usual_columns_are_known_to_every_shipped_kind_of_run():
    assert [item.key for item in chosen_columns(RUN, TableOptions())] == [
        "f1",
        "f2",
        "delivered_power_1",
        "length",
        "breadth",
    ]
    assert set(known_columns(RUN)) == {"f1", "f2", *COLUMNS}
