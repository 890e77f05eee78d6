"""`hpsop report` read again by Python's HTML parser; its charts by their data."""

from __future__ import annotations

import csv
import dataclasses
import io
from pathlib import Path

import numpy as np
import pytest
from html_reading import Page, check

from hpsop_core import load_case, optimize
from hpsop_core.case.case import Case
from hpsop_core.charts.hulls import body_plan_chart, sectional_area_chart
from hpsop_core.charts.plot import Plot
from hpsop_core.charts.propulsion import open_water_chart, resistance_chart, thrust_chart
from hpsop_core.charts.search import convergence_chart
from hpsop_core.evaluation.curves import hull_lines, resistance_points, thrust_curves
from hpsop_core.quantities import Quantity, all_quantities, condition_names, number_text
from hpsop_core.report.data import ReportData
from hpsop_core.report.looks import COMPROMISE_LOOK, INITIAL_LOOK, SHEET
from hpsop_core.report.paper_figures import evolution_figure, open_water_figure, resistance_figure, thrust_figure
from hpsop_core.report.report import report_html
from hpsop_core.report.search import archive_clouds, pareto_figure
from hpsop_core.report.tables import failure_table
from hpsop_core.runs.controller import RunController
from hpsop_core.runs.reader import RunReader, open_run
from hpsop_core.runs.records import DesignRecord, Failure
from tests.two_speeds import stated_case

TITLE = "<script>alert('Hull & \"screw\"')</script> $\\frac{1}{2 d·Ω"
SECTIONS = ["result", "pareto", "spread", "propulsion", "form", "drivers", "trust", "assumptions", "front", "run",
            "failures"]  # fmt: skip
FIGURES = ["pareto", "convergence", "evolution", "resistance-wave", "resistance-total", "open-water-spread",
           "open-water", "thrust", "body-plan", "sectional-area"]  # fmt: skip


def quick_case() -> Case:
    case = stated_case()
    return dataclasses.replace(case, title=TITLE, description="x < y & z </p><b>")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> RunReader:
    file = tmp_path_factory.mktemp("run") / "small.hpsop"
    return optimize(quick_case(), file, generations=4, level1_generations=3, population=8, seed=2, workers=1)


@pytest.fixture(scope="module")
def source(run: RunReader) -> str:
    return report_html(run)


@pytest.fixture(scope="module")
def page(source: str) -> Page:
    return Page().read(source)


def rows_of(page: Page, section: str, table: int = 0) -> dict[str, list[str]]:
    return {" ".join(row[0].split()): row[1:] for row in page.tables[section][table]}


def test_it_is_whole_and_fetches_nothing(page: Page, source: str) -> None:
    check(page, source)
    assert page.sections == SECTIONS
    assert page.figures == [f"figure-{name}" for name in FIGURES]


def test_the_cases_words_are_text(page: Page, source: str) -> None:
    assert TITLE in page.words[""]
    assert "x < y & z </p><b>" in page.words[""]
    assert "<script" not in source and "alert('" not in source


UNITS = {"delivered_power": 1e-6, "total_resistance": 1e-3, "open_water_efficiency": 1.0}


def with_error(quantity: Quantity, record: DesignRecord) -> str:
    """The number, and at level 2 its error where one is stated."""
    number = number_text(quantity.value(record.evaluation), quantity.decimals)
    width = record.evaluation.errors.get(quantity.key)
    if width is None:
        assert quantity.key == "length"
        return number
    return f"{number} ± {number_text(UNITS[quantity.key[:-2]] * width, quantity.decimals)}"


def test_the_result_table_holds_the_runs_numbers(page: Page, run: RunReader) -> None:
    data = ReportData.of(run)
    assert data.level == 2 and data.initial is not None and data.compromise is not None
    chosen = [data.initial, *(record for _, record in data.chosen())]
    assert {record.id for record in chosen[1:]} == {
        data.compromise.id, data.knee.id, data.front[0].id, data.front[-1].id
    }  # fmt: skip
    rows = page.tables["result"][0]
    assert [cell.split("design ")[-1] for cell in rows[0][1:]] == [str(record.id) for record in chosen]
    named: dict[str, list[list[str]]] = {}
    for row in rows[1:]:
        named.setdefault(row[0].split("[")[0].strip(), []).append(row[1:])
    quantities = {quantity.key: quantity for quantity in all_quantities(condition_names(run.case))}
    for key in ("delivered_power_1", "delivered_power_2", "total_resistance_1", "open_water_efficiency_2", "length"):
        quantity = quantities[key]
        cells = named[f"{quantity.label} {quantity.symbol.replace('_', '')}"][0]
        initial = quantity.value(chosen[0].evaluation)
        assert cells[0] == with_error(quantity, chosen[0])
        for cell, record in zip(cells[1:], chosen[1:], strict=True):
            value = quantity.value(record.evaluation)
            assert cell.startswith(with_error(quantity, record))
            change = cell.removeprefix(with_error(quantity, record)).replace("−", "-").removesuffix(" %")
            assert float(change) == pytest.approx(100.0 * (value / initial - 1.0), abs=0.0501)
    power = data.compromise.evaluation.conditions[0].delivered_power
    assert f"{power / 1e6:.2f} MW instead of" in page.words["result"]


def test_the_front_is_whole(page: Page, run: RunReader) -> None:
    front = run.front()
    rows = page.tables["front"][0]
    assert [row[0] for row in rows[1:]] == [str(record.id) for record in front]
    numbers = [number_text(record.evaluation.objectives["f1"], 4) for record in front]
    assert [row[2].split(" ±")[0] for row in rows[1:]] == numbers
    assert all("±" in row[2] for row in rows[1:])
    compromise = str(run.generation().compromise)
    assert any(row[0] == compromise and "compromise" in row[1] for row in rows[1:])


def test_the_papers_table_3_shows_the_front(page: Page, run: RunReader) -> None:
    data = ReportData.of(run)
    front = [record.id for record in run.front()]
    named = dict(data.compared())
    ids = [record.id for _, record in data.spread]
    # Both ends and the compromise are among them, in the front's order, five or all there are.
    assert len(ids) == min(5, len(front)) and ids[0] == front[0] and ids[-1] == front[-1]
    assert run.generation().compromise in ids and ids == sorted(ids, key=front.index)
    table = page.tables["spread"][0]
    heads = [" ".join(cell.split()) for cell in table[0]]
    assert [row[0] for row in table[1:]] == list(named)
    assert sum("compromise" in row[0] for row in table) == 1
    for row, record in zip(table[1:], named.values(), strict=True):
        cells = dict(zip(heads, row, strict=True))
        evaluation = record.evaluation
        for head, value, digits in (
            ("number", record.id, 0),
            ("LPP [m]", evaluation.hull.length, 2),
            ("CB [–]", evaluation.hull.block_coefficient, 4),
            ("D [m]", evaluation.variables.diameter, 2),
            ("Z [–]", evaluation.variables.blade_count, 0),
            ("f₁ [–]", evaluation.objectives["f1"], 4),
            ("f₂ [–]", evaluation.objectives["f2"], 4),
        ):
            assert cells[head] == number_text(value, digits), head


def test_the_papers_table_4_shows_the_operating_points(page: Page, run: RunReader) -> None:
    rows = page.tables["spread"][1][1:]
    compared = [("initial", run.initial(2)), ("compromise", run.design("compromise"))]
    expected = [(name, c) for name, record in compared for c in record.evaluation.conditions]
    assert [row[0] for row in rows] == [name for name, _ in expected]
    for row, (_, c) in zip(rows, expected, strict=True):
        told = [(c.froude_number, 4), (c.speed / 0.514444, 2), (1e-3 * c.total_resistance, 0),
                (c.advance_coefficient, 4), (c.rotation_rate_rpm, 2), (c.thrust_coefficient, 4),
                (10.0 * c.torque_coefficient, 4), (c.open_water_efficiency, 4), (1e-3 * c.thrust, 0),
                (1e-6 * c.delivered_power, 2)]  # fmt: skip
        assert row[1:] == [number_text(value, digits) for value, digits in told]


def test_the_papers_figures_show_the_run(run: RunReader) -> None:
    data = ReportData.of(run)
    last = run.generation()
    front = [[record.evaluation.objectives[name] for name in ("f1", "f2")] for record in run.front()]
    plot = evolution_figure(data)
    assert np.transpose(drawn(plot, f"generation {last.number}, level 2")) == pytest.approx(np.array(front))
    names = [name for name, record in data.compared() if record.evaluation.ok]
    for which in ("wave", "total"):
        plot = resistance_figure(data, which)
        for name, (_, record) in zip(names, data.compared(), strict=True):
            place, force = drawn(plot, name)
            for condition in record.evaluation.conditions:
                # Speeds are fixed: the axis is in knots.
                at = int(np.argmin(np.abs(np.array(place) - condition.speed / 0.514444)))
                assert force[at] == pytest.approx(1e-6 * getattr(condition, f"{which}_resistance"), rel=1e-8)
    assert {item.name.partition(", ")[2] for item in open_water_figure(data).series} >= set(names)
    assert {item.name for item in thrust_figure(data).series} >= {"required, initial", "required, compromise"}


def test_assumptions_and_facts_are_the_cases_and_the_runs(page: Page, run: RunReader) -> None:
    words = " ".join(page.words["assumptions"].split())
    for told in ("(shift)", "(fixed)", "has the wave coefficients stated in the case", "at both levels",
                 "1 025.0 kg/m³", "0.094", "within 5.0 %"):  # fmt: skip
        assert told in words, told
    facts = page.words["run"]
    summary = run.summary()
    assert "finished" in facts and "4 of 4 (level 1: 3, level 2: 1)" in facts
    counts = rows_of(page, "run")
    for level in ("1", "2"):
        assert counts[level][1] == str(summary["evaluations"][level]["count"])
    assert "not finished" not in page.words[""]
    assert ("No evaluation failed" in page.words["failures"]) == (not run.failures())


def drawn(plot: Plot, name: str) -> tuple[list[float], list[float]]:
    """A chart's series by its name, as its CSV has it."""
    rows = [row for row in csv.reader(io.StringIO(plot.csv())) if row[0] == name]
    assert rows, name
    return [float(row[1]) for row in rows], [float(next(v for v in row[2:] if v)) for row in rows]


def test_pareto_and_convergence_show_the_run(run: RunReader) -> None:
    data = ReportData.of(run)
    clouds, total = archive_clouds(run)
    computed = [point for point in run.archive() if point.objectives is not None]
    assert total == sum(len(cloud.points) for cloud in clouds) == len(computed)
    generations = data.generations
    plot = convergence_chart(
        [item.number for item in generations],
        [item.level for item in generations],
        [item.hypervolume for item in generations],
        len(generations),
        SHEET,
        [item.feasible_share for item in generations],
    )
    for level in (1, 2):
        own = [item for item in generations if item.level == level]
        numbers = [float(item.number) for item in own]
        assert drawn(plot, f"level {level}") == (numbers, pytest.approx([item.hypervolume for item in own]))
        shares = [100.0 * item.feasible_share for item in own]
        assert drawn(plot, f"feasible, level {level}") == (numbers, pytest.approx(shares))
    plot = pareto_figure(data, clouds)
    for level in (1, 2):
        own = [point.objectives for point in computed if point.feasible and point.level == level]
        if own:
            assert np.transpose(drawn(plot, f"level {level}, feasible")) == pytest.approx(np.array(own))
    front = [[record.evaluation.objectives[name] for name in ("f1", "f2")] for record in run.front()]
    assert np.transpose(drawn(plot, "front")) == pytest.approx(np.array(front))
    marks = {"initial": data.initial, "compromise": data.compromise, "knee": data.knee}
    for name, record in marks.items():
        (x,), (y,) = drawn(plot, name)
        assert [x, y] == pytest.approx([record.evaluation.objectives[key] for key in ("f1", "f2")])
        # what stands out stands within the axes
        assert plot.x.limits[0] < x < plot.x.limits[1] and plot.y.limits[0] < y < plot.y.limits[1]


def test_curves_pass_the_operating_points(run: RunReader) -> None:
    data = ReportData.of(run)
    assert data.compromise is not None
    evaluation = data.compromise.evaluation
    points = resistance_points(data.case, evaluation, data.reference(2))
    for condition in evaluation.conditions:
        at = min(points, key=lambda p: abs(p.froude_number - condition.froude_number))
        assert at.total_resistance == pytest.approx(condition.total_resistance, rel=1e-9)
    curves = thrust_curves(data.case, evaluation, points)
    for number, condition in enumerate(evaluation.conditions):
        place = int(np.argmin(np.abs(curves.froude_number - condition.froude_number)))
        assert curves.required[place] == pytest.approx(condition.thrust, rel=1e-9)
        # A spline through KT every 0.05 of J, against the solver's own polynomial.
        assert curves.available[number][place] == pytest.approx(condition.thrust, rel=2e-4)
    plot = resistance_chart([(COMPROMISE_LOOK, points, evaluation)], "wave", SHEET)
    froude, force = drawn(plot, "compromise")
    assert froude == pytest.approx([point.froude_number for point in points])
    assert force == pytest.approx([1e-6 * point.wave_resistance for point in points])
    plot = open_water_chart([(COMPROMISE_LOOK, evaluation)], SHEET)
    for number, condition in enumerate(evaluation.conditions, start=1):
        for word, value in (("KT", condition.thrust_coefficient), ("η₀", condition.open_water_efficiency)):
            at, height = drawn(plot, f"{word}, operating point, condition {number}, compromise")
            assert at == pytest.approx([condition.advance_coefficient]) and height == pytest.approx([value])


def test_every_axis_has_its_title(run: RunReader) -> None:
    data = ReportData.of(run)
    evaluation = data.initial.evaluation
    points = resistance_points(data.case, evaluation, data.reference(2))
    lines = hull_lines(data.case, evaluation.variables)
    area = sectional_area_chart([(INITIAL_LOOK, lines)], SHEET)
    for plot in (
        open_water_chart([(INITIAL_LOOK, evaluation)], SHEET),
        resistance_chart([(INITIAL_LOOK, points, evaluation)], "total", SHEET),
        thrust_chart([(INITIAL_LOOK, thrust_curves(data.case, evaluation, points), evaluation)], SHEET),
        body_plan_chart([(INITIAL_LOOK, lines)], SHEET),
        area,
    ):
        assert "[" in plot.x.title and "[" in plot.y.title
    # The area under the drawn sectional-area curve is the displacement.
    station, immersed = drawn(area, "initial")
    volume = float(np.trapezoid(immersed, np.array(station) * evaluation.hull.length))
    assert volume == pytest.approx(evaluation.hull.displaced_volume, rel=2e-3)


def test_the_body_plan_has_equal_scales(run: RunReader) -> None:
    data = ReportData.of(run)
    plot = body_plan_chart([(INITIAL_LOOK, hull_lines(data.case, data.initial.evaluation.variables))], SHEET)
    across = float(plot.px(10.0) - plot.px(0.0))
    assert float(plot.py(0.0) - plot.py(10.0)) == pytest.approx(across, rel=1e-9)


def test_without_a_feasible_design_it_says_so(tmp_path: Path) -> None:
    case = quick_case().replaced("constraints", diameter_to_draft_lower=0.74, diameter_to_draft_upper=0.75)
    run = optimize(case, tmp_path / "none.hpsop", generations=2, level1_generations=2, population=4, workers=1)
    source = report_html(run)
    page = Page().read(source)
    check(page, source)
    assert page.sections == SECTIONS
    assert "There is no feasible design on the front" in page.words["result"]
    assert "The front is empty" in page.words["front"]
    assert "level 1" in page.words[""]
    # The initial design breaks g2 as well, and its curves are drawn all the same.
    assert "D/d outside its limits" in page.words["result"] and "figure-open-water" in page.figures


def test_a_booked_displacement_is_told_from_the_real_one(tmp_path: Path) -> None:
    case = load_case("dtc-p4119-paper")
    run = optimize(case, tmp_path / "paper.hpsop", generations=1, level1_generations=1, population=6, workers=1)
    page = Page().read(report_html(run))
    hull = run.design("compromise").evaluation.hull
    assert abs(hull.booked_volume / hull.displaced_volume - 1.0) > 1e-3
    words = " ".join(page.words["result"].split())
    assert f"really displaces {number_text(hull.displaced_volume, 0)} m³" in words
    assert f"only books {number_text(hull.booked_volume, 0)} m³" in words
    assert any(row[0].startswith("booked block coefficient CB booked") for row in page.tables["result"][0])
    assert "(affine)" in page.words["assumptions"] and "only booked" in page.words["trust"]


def test_a_run_that_has_hardly_begun(tmp_path: Path) -> None:
    file = tmp_path / "new.hpsop"
    RunController(file, quick_case(), workers=1).close()
    source = report_html(open_run(file))
    page = Page().read(source)
    check(page, source)
    assert page.sections == SECTIONS and not page.figures
    assert "This run is not finished" in page.words[""] and "Nothing is evaluated yet" in page.words["result"]


def test_failures_are_listed_with_their_reasons(run: RunReader) -> None:
    variables = run.case.initial.variables
    failures = [Failure(n, 2, 4, "rankine", "<b>singular</b> & more", variables, 0.1) for n in range(60)]
    page = Page()
    page.feed(f"<section id=x>{failure_table(failures)}</section>")
    assert page.tables["x"][0][1] == ["rankine", "2", "60"]
    assert page.tables["x"][1][1][4] == "<b>singular</b> & more" and len(page.tables["x"][1]) == 41
    assert "The first 40 of 60" in page.words["x"]
