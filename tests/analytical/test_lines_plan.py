"""The lines plan against the surface that it shows and against the planes that cut it."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest

from hpsop_core.case.case import load_case
from hpsop_core.charts.lines_plan import line_name, lines_csv, lines_plan_chart
from hpsop_core.evaluation.shapes import design_hull
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.hull.lines import BUTTOCKS, HullLine, plan_lines
from tests.two_speeds import TWO_SPEEDS


@pytest.fixture(scope="module")
def hull() -> Hull:
    case = load_case(TWO_SPEEDS)
    return design_hull(case, case.initial.variables)


@pytest.fixture(scope="module")
def lines(hull: Hull) -> tuple[HullLine, ...]:
    return tuple(plan_lines(hull, "view"))


def test_every_line_lies_in_its_plane_and_to_port(hull: Hull, lines: tuple[HullLine, ...]):
    axis = {"STATIONS": 0, "WATERLINES": 2, "DESIGN_WATERLINE": 2, "BUTTOCKS": 1, "PROFILE": 1}
    for line in lines:
        # planes are moved by a millionth of the length past the mesh's vertices
        assert np.allclose(line.points[:, axis[line.layer]], line.at, atol=2e-6 * hull.length), line.layer
        assert line.points[:, 1].min() > -1e-3
    assert {line.layer for line in lines} == set(axis)
    assert {round(line.at / hull.breadth, 6) for line in lines if line.layer == "BUTTOCKS"} == set(BUTTOCKS.tolist())


def test_the_design_waterline_is_the_hull_s_own(hull: Hull, lines: tuple[HullLine, ...]):
    exact = hull.waterline()
    own = max((line.points for line in lines if line.layer == "DESIGN_WATERLINE"), key=len)
    inside = (own[:, 0] > 0.05 * hull.length) & (own[:, 0] < 0.95 * hull.length)
    # facets of a mesh of 112 cells a length: their chords lie some centimetres inside a curve of 25 m half-breadth
    difference = own[inside, 1] - np.interp(own[inside, 0], exact[:, 0], exact[:, 1])
    assert np.abs(difference).max() < 0.004 * hull.breadth


def test_the_chart_is_drawn_at_one_scale_with_every_line(hull: Hull, lines: tuple[HullLine, ...]):
    plot = lines_plan_chart(lines, hull.length, hull.breadth, hull.draft, 2000.0)
    across = plot.area.width / (plot.x.limits[1] - plot.x.limits[0])
    upright = plot.area.height / (plot.y.limits[1] - plot.y.limits[0])
    assert across == pytest.approx(upright, rel=1e-9)
    named = [series for series in plot.series if series.name]
    assert len(named) == len(lines)
    for series in named:
        assert series.x.min() >= plot.x.limits[0] and series.x.max() <= plot.x.limits[1]
        assert series.y.min() >= plot.y.limits[0] and series.y.max() <= plot.y.limits[1]
    # the sheer stands on the body plan's baseline, stations run through sheer and half-breadth plan alike
    profile = next(series for series in named if series.name == "profile")
    assert profile.y.min() == pytest.approx(0.0, abs=0.01 * hull.draft)
    half = next(series for series in named if series.name.startswith("design waterline"))
    assert half.y.max() < 0.0 and half.x.max() <= profile.x.max() + 1e-6
    svg = str(plot.svg("plan"))
    assert 'class="axis"' not in svg, "a drawing of its own measure has no axes"
    for word in (">AP 0<", ">10 FP<", ">BL<", ">5<"):
        assert word in svg
    assert all(svg.count(f">{number}<") >= 2 for number in range(1, 10)), "a station's number in body and sheer plan"


def test_the_numbers_are_those_of_the_lines(hull: Hull, lines: tuple[HullLine, ...]):
    rows = list(csv.reader(io.StringIO(lines_csv(lines, hull.length))))[1:]
    assert len(rows) == sum(len(line.points) for line in lines)
    assert rows[0][0] == line_name(lines[0], hull.length) == "station 0"
    assert [float(value) for value in rows[0][2:]] == pytest.approx(lines[0].points[0].tolist(), abs=1e-6)
