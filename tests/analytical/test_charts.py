"""Charts against the numbers they are drawn from: places in px, files read again by Python's XML and CSV parsers."""

from __future__ import annotations

import csv
import dataclasses
import io
import itertools
import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import spearmanr

from hpsop_core.charts.axis import Axis, padded, tick_texts, ticks
from hpsop_core.charts.correlations import correlation_cell, rank_correlation
from hpsop_core.charts.looks import Look, Published, Sheet
from hpsop_core.charts.marks import smooth, text_width
from hpsop_core.charts.plot import Plot
from hpsop_core.charts.propulsion import open_water_chart
from hpsop_core.charts.search import (
    Cloud,
    Front,
    Mark,
    convergence_chart,
    count_coincident,
    evolution_chart,
    pareto_chart,
    window,
)
from hpsop_core.charts.style import PRINT, ROLES, SCREEN, style_sheet
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.reference import reference_for
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.markup import Markup
from tests.two_speeds import stated_case

Array = NDArray[np.float64]
SVG = "{http://www.w3.org/2000/svg}"
HOSTILE = "a_b <script>alert('x & \"y\"')</script>\x1b"


def unit_plot(**more) -> Plot:
    """A hundred px a unit, both ways."""
    return Plot(172.0, 146.0, Axis("x [–]", (0.0, 1.0)), Axis("y [–]", (0.0, 1.0)), margins=(60, 12, 10, 36), **more)


@pytest.fixture(scope="module")
def initial() -> Evaluation:
    """The recommended case's initial design; stated wave coefficients, so that level 1 needs no level 2."""
    case = stated_case()
    return evaluate(case, case.initial.variables, 1, reference_for(case, 1))


def path_of(svg: str, title: str) -> tuple[Array, Array]:
    found = re.search(r'<path d="([^"]*)"[^>]*><title>' + re.escape(title) + "</title>", svg)
    assert found, title
    points = np.array([[float(b) for b in a.split()] for a in re.split("[ML]", found.group(1)) if a])
    return points[:, 0], points[:, 1]


# ---- axes ------------------------------------------------------------------------------------------------------------
def test_ticks_have_no_more_decimals_than_their_distance():
    assert tick_texts(ticks((0.16, 0.30), 6)) == ["0.175", "0.200", "0.225", "0.250", "0.275", "0.300"]
    assert tick_texts(ticks((-3.0, 3.0), 3)) == ["−2", "0", "2"]
    # the last label ends within the picture
    svg = Plot(470.0, 200.0, Axis("x", (0.0, 3e5), 3), Axis("y", (0.0, 1.0))).svg("c")
    assert '<text x="469.0"' in svg


def test_a_logarithmic_axis_makes_equal_factors_equal_distances():
    axis = Axis("rate [1/s]", (1e-3, 10.0), logarithmic=True)
    assert axis.share([1e-3, 1e-1, 10.0]) == pytest.approx([0.0, 0.5, 1.0])
    assert np.isnan(axis.share([0.0, -1.0])).all()
    assert [text for _, text in axis.ticks()] == ["0.001", "0.01", "0.1", "1", "10"]
    # three orders of magnitude below what decimals can show
    assert Axis("x", (1e-6, 1e-3), logarithmic=True).ticks()[0][1] == "10⁻⁶"
    assert [text for _, text in Axis("x", (1.0, 10.0), logarithmic=True).ticks()] == ["1", "2", "5", "10"]
    with pytest.raises(ValueError, match="greater than zero"):
        Axis("x", (0.0, 1.0), logarithmic=True)
    with pytest.raises(ValueError, match="no length"):
        Axis("x", (1.0, 1.0))


def test_long_numbers_push_the_title_aside():
    short = Plot(300.0, 200.0, Axis("x", (0.0, 1.0)), Axis("y", (0.0, 1.0)))
    long = Plot(300.0, 200.0, Axis("x", (0.0, 1.0)), Axis("y", (0.0, 9e8)))
    assert long.area.left > short.area.left + 10
    assert long.area.right == short.area.right


def test_limits_have_air_and_a_single_value_has_some_too():
    assert padded([0.0, 1.0], 0.1) == pytest.approx((-0.1, 1.1))
    low, high = padded([3.0, 3.0])
    assert low < 3.0 < high
    assert padded([np.nan]) == (0.0, 1.0)


# ---- series ----------------------------------------------------------------------------------------------------------
def test_smooth_keeps_the_points_and_never_overshoots():
    x = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
    y = np.array([0.0, 0.0, 1.0, 1.0, 3.0])
    fine, values = smooth(x, y)
    assert np.abs(np.interp(x, fine, values) - y).max() < 1e-12
    assert values.min() >= 0.0
    assert np.diff(values).min() >= -1e-12


def test_error_bars_reach_as_far_as_the_errors():
    plot = unit_plot()
    plot.points([0.5], [0.4], "circle", 3.0, "level1", "measured", "tank", x_error=[0.1], y_error=[[0.2], [0.3]])
    svg = plot.svg("c")
    across, up = re.findall(r'<path d="([^"]*)" class="error level1"/>', svg)
    # x 0.5 +- 0.1 is 110 +- 10 px; y 0.4 - 0.2 + 0.3 is 70 px from the top, 20 px down and 30 px up
    assert across.startswith("M100.0 70.0H120.0")
    assert up.startswith("M110.0 90.0V40.0")
    assert 'class="mark level1"' in svg and ">tank</text>" in svg


def test_a_band_lies_between_its_curves_and_behind_the_lines():
    plot = unit_plot()
    plot.line([0.0, 1.0], [0.5, 0.5], "level2")
    plot.band([0.0, 0.5, 1.0], [0.2, np.nan, 0.2], [0.6, 0.6, 0.6], "level2", "90 %", "interval")
    svg = plot.svg("c")
    assert svg.index('class="band level2"') < svg.index('class="line level2"')
    # the point without a lower value is left out
    assert 'd="M60.0 90.0L160.0 90.0L160.0 50.0L60.0 50.0z" class="band level2"' in svg


def test_the_second_axis_has_its_own_scale():
    plot = unit_plot(second=Axis("feasible [%]", (0.0, 200.0)))
    plot.line([0.0, 1.0], [0.5, 0.5], "level1", name="left")
    plot.line([0.0, 1.0], [50.0, 50.0], "level1", name="right", second=True)
    svg = plot.svg("c")
    assert path_of(svg, "left")[1] == pytest.approx([60.0, 60.0])
    assert path_of(svg, "right")[1] == pytest.approx([85.0, 85.0])
    assert "feasible [%]</text>" in svg and ">200</text>" in svg
    # its numbers have room at the right
    assert plot.area.right < 172.0 - 30.0


def test_a_mark_outside_the_axes_is_not_drawn_over_them():
    plot = unit_plot()
    plot.mark(1.2, 0.5, "circle", 4.0, "level1", name="outside")
    plot.mark(0.5, 0.5, "circle", 4.0, "level2")
    svg = plot.svg("c")
    assert "mark level1" not in svg and "mark level2" in svg
    assert "outside,1.2,0.5" in plot.csv()  # its numbers are not lost


def test_notes_and_annotations_stand_where_their_data_is():
    plot = unit_plot()
    plot.annotate(0.5, 0.5, "peak η_0", 12.0, -8.0)
    svg = plot.svg("c")
    assert 'd="M110.0 60.0l12.0 -8.0" class="leader"' in svg
    assert '<text x="124.0" y="56.0" text-anchor="start"' in svg and 'η<tspan class="sub"' in svg


def test_counts_of_coincident_marks_do_not_cover_one_another():
    plot = Plot(470.0, 300.0, Axis("x", (0.0, 1.0)), Axis("y", (0.0, 1.0)))
    crowd = [(0.2 + 0.015 * k, 0.5) for k in range(10) for _ in range(2)]
    count_coincident(plot, np.array([*crowd, (0.9, 0.9), (0.9, 0.9), (0.9, 0.9)]))
    texts = re.findall(r'<text x="([^"]+)"[^>]*>×(\d)', plot.svg("c"))
    places = [float(x) for x, _ in texts]
    assert [count for _, count in texts][-1] == "3" and 3 <= len(texts) < 8
    # 26 pixels hold "×10" with air
    assert min(np.diff(places)) >= 26.0


def test_a_legend_wraps_and_stays_within_the_picture():
    plot = Plot(300.0, 200.0, Axis("x", (0.0, 1.0)), Axis("y", (0.0, 1.0)))
    for number in range(7):
        plot.line([0.0, 1.0], [0.0, 1.0], f"chosen{number % 5 + 1}", key=f"design of generation {number}")
    tree = ElementTree.fromstring(plot.file_svg("c"))
    words = [item for item in tree.iter(f"{SVG}text") if item.get("class") == "legend"]
    height = float(tree.get("viewBox").split()[3])
    assert len(words) == 7 and len({item.get("y") for item in words}) > 2
    assert height > 200.0 + 3 * 11.0
    for item in words:
        # letters are at least half as wide as high
        assert float(item.get("x")) + 0.5 * 11.0 * len(item.text) < 300.0
        assert 200.0 < float(item.get("y")) < height


# ---- files -----------------------------------------------------------------------------------------------------------
def full_plot() -> Plot:
    plot = Plot(
        400.0, 300.0, Axis(f"x {HOSTILE}", (0.0, 2.0)), Axis("R_T [MN]", (0.0, 9.0)), Axis("s [%]", (0.0, 90.0))
    )
    plot.line([0.0, 1.0, 2.0], [1.0, np.nan, 3.0], "level1 dash", name=HOSTILE, key=HOSTILE)
    plot.line([0.0, 2.0], [10.0, 20.0], "level2", name="share", second=True)
    plot.points([1.0], [2.0], "cross", 3.0, "published", "tank", "tank", y_error=[0.25])
    plot.mark(1.0, 1.0, "star", 5.0, "compromise", title=HOSTILE, key="compromise")
    plot.text(1.0, 1.0, HOSTILE)
    plot.message(HOSTILE)
    return plot


def test_a_message_stays_within_the_axes() -> None:
    words = "No designs yet.\nPress Start: each generation's front appears here."
    rows = []
    for width in (700.0, 350.0):
        plot = Plot(width, 300.0, Axis("x", (0.0, 1.0)), Axis("y", (0.0, 1.0)))
        plot.message(words, numbers=True)
        found = ElementTree.fromstring(plot.file_svg("c")).iter(f"{SVG}text")
        texts = ["".join(node.itertext()) for node in found if node.get("class") == "empty"]
        assert " ".join(texts) == words.replace("\n", " ")
        assert all(text_width(text, SCREEN.letters + 2) <= plot.area.width for text in texts)
        rows.append(len(texts))
    assert rows[0] == 2 < rows[1]


def test_a_file_is_xml_that_stands_alone():
    source = full_plot().file_svg("c")
    tree = ElementTree.fromstring(source)  # raises where it is not well formed
    assert tree.tag == f"{SVG}svg" and tree.get("width") == "400"
    style = tree.find(f"{SVG}style").text
    assert "var(" not in style and "url(" not in style and "import" not in style
    # whatever a class names has a rule within the file
    used = {name for item in tree.iter() for name in (item.get("class") or "").split()}
    assert used & set(ROLES) and all(f".{name}" in style or name in ("chart", "keys") for name in used)
    # what came from outside is words
    assert not [item for item in tree.iter() if "script" in item.tag]
    shown = HOSTILE.replace("\x1b", "\ufffd")
    assert shown in [item.text for item in tree.iter(f"{SVG}title")]
    assert "href" not in source and source.count("http") == 1  # the namespace


def test_the_csv_holds_what_was_drawn():
    text = full_plot().csv()
    header, *rows = csv.reader(io.StringIO(text))
    assert header[0] == "series" and header[2:] == ["RT [MN]", "s [%]", "x below", "x above", "y below", "y above"]
    assert rows[0] == [HOSTILE, "0", "1", "", "", "", "", ""]
    assert rows[1][1:3] == ["1", ""]  # no value is an empty cell
    assert rows[3] == ["share", "0", "", "10", "", "", "", ""]
    assert rows[5] == ["tank", "1", "2", "", "", "", "0.25", "0.25"]


def test_every_role_has_a_colour_in_both_styles():
    for style in (SCREEN, PRINT):
        assert set(ROLES) <= set(style.colours)
        assert all(f".line.{role}" in style_sheet(style) for role in ROLES)
    # on paper every curve's colour is dark enough against white: 3 to 1, as WCAG asks of graphics
    for role in ("initial", "selected", "front", "published", "chosen2", "chosen3", "chosen4", "ink", "soft"):
        parts = [int(PRINT.colours[role][at : at + 2], 16) / 255.0 for at in (1, 3, 5)]
        linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
        assert 1.05 / (0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2] + 0.05) > 3.0, role


# ---- charts ----------------------------------------------------------------------------------------------------------
def test_operating_points_lie_on_the_curves_and_on_the_required_thrust(initial: Evaluation):
    svg = open_water_chart([(Look("initial", "initial", "dash"), initial)], Sheet(480.0, 300.0)).svg("open_water")
    curves = {word: path_of(svg, f"{word}, initial") for word in ("KT", "10KQ", "η₀")}
    marks = re.findall(
        r'<path d="M([\d.]+) ([\d.]+)a([\d.]+) [^"]*"[^>]*><title>initial, [\d.]+ kn: J(.) [^<]*, (KT|η₀)', svg
    )
    assert len(marks) == 2 * len(initial.conditions)
    for left, y, radius, which, word in marks:
        x, y = float(left) + float(radius), float(y)
        # a pixel is the width of a line
        assert abs(np.interp(x, *curves[word]) - y) < 1.0
        if word == "KT":
            needed = path_of(svg, f"required KT, condition {'₁₂'.index(which) + 1}, initial")
            assert abs(np.interp(x, *needed) - y) < 1.0


def test_the_names_of_conditions_never_lie_on_each_other(initial: Evaluation):
    sheet = Sheet(480.0, 300.0)
    first = initial.conditions[0]
    for apart in (0.0, 0.004, 0.02, 0.1):
        places = (0.6 + apart * number for number in (0, 2, 1, 3))
        shown = dataclasses.replace(
            initial, conditions=tuple(dataclasses.replace(first, advance_coefficient=place) for place in places)
        )
        svg = open_water_chart([(Look("initial", "initial", "dash"), shown)], sheet).svg("open_water")
        names = re.findall(
            r'<text x="([\d.]+)" y="[\d.]+" text-anchor="(start|end)" class="note soft">(J.*?)</text>', svg
        )
        # about 6 px a letter; the subscript's marks are no letters
        spans = sorted(
            (x, x + wide) if anchor == "start" else (x - wide, x)
            for x, anchor, wide in ((float(a), b, 6.0 * len(re.sub("<[^>]*>", "", text))) for a, b, text in names)
        )
        assert all(left[1] <= right[0] for left, right in itertools.pairwise(spans)), (apart, names)
        assert re.sub("<[^>]*>", "", "".join(text for _, _, text in names)).count("J") == 4


def test_the_pareto_chart_holds_clouds_front_and_marks():
    cloud = np.array([[0.8, 0.9], [0.9, 0.85], [5.0, 5.0]])
    front = np.array([[0.7, 0.95], [0.8, 0.8]])
    limits = window(np.concatenate([front, [[1.0, 1.0]]]), cloud)
    plot = pareto_chart(
        [Cloud(cloud, "archive", key="archive")],
        [Front(front, "front", key="front")],
        [Mark(1.0, 1.0, "square", 4.0, "initial", "initial design", "initial")],
        limits,
        ("f_1 [–]", "f_2 [–]"),
        Sheet(400.0, 300.0, PRINT),
    )
    rows = list(csv.reader(io.StringIO(plot.csv())))[1:]
    assert [row[0] for row in rows] == ["archive"] * 3 + ["front"] * 2 + ["initial"]
    assert [[float(v) for v in row[1:3]] for row in rows] == [*cloud.tolist(), *front.tolist(), [1.0, 1.0]]
    svg = plot.svg("p")
    # the far one is left out of the picture
    assert re.search(r'<path d="([^"]*)" class="dots archive"', svg).group(1).count("h0") == 2
    assert svg.count('class="mark front"') == 2 and svg.count('class="key-mark front"') == 1
    (x0, x1), (y0, y1) = limits
    assert x0 < 0.7 and x1 > 1.0 and y0 < 0.8 and y1 > 1.0


def test_published_points_and_their_notes_are_drawn():
    published = Published("paper", [1.0, 0.77], [1.0, 0.91], notes=["IS", "OP1"])
    plot = evolution_chart([Front(np.array([[0.8, 0.9]]), "front", key="g")], ("a", "b"), Sheet(400, 300), [published])
    svg = plot.svg("e")
    assert svg.count('class="mark published open"') == 2 and ">OP1</text>" in svg
    assert "paper,0.77,0.91" in plot.csv()


def test_rank_correlation_is_spearmans():
    rng = np.random.default_rng(3)
    first = rng.integers(0, 6, 200).astype(float)  # with many ties, as the number of blades has
    second = first + rng.normal(0.0, 2.0, 200)
    second[:5] = np.nan
    wanted = spearmanr(first[5:], second[5:]).statistic
    found = rank_correlation(first, second)
    assert found is not None
    assert abs(found - wanted) < 1e-12

    # by the definition: Pearson's of the ranks, ties sharing their mean
    def ranks(v: Array) -> Array:
        return np.array([(v < x).sum() + 0.5 * ((v == x).sum() + 1) for x in v])

    assert found == pytest.approx(np.corrcoef(ranks(first[5:]), ranks(second[5:]))[0, 1], abs=1e-12)
    assert rank_correlation(np.ones(50), second[:50]) is None  # a fixed variable drives nothing
    assert rank_correlation(first[:9], first[:9]) is None  # too few
    assert rank_correlation(first, -first) == pytest.approx(-1.0)


def test_a_correlations_cell_tells_its_sign():
    assert isinstance(correlation_cell(0.5), Markup)
    assert ">+0.50<" in correlation_cell(0.5) and ">−0.50<" in correlation_cell(-0.5)
    assert ">0.00<" in correlation_cell(-0.001) and correlation_cell(None) == "–"


@pytest.mark.parametrize("found", [[0.0, 0.0, 0.0], [0.0, 0.001, 0.002], [0.1, 0.11, 0.111]])
def test_a_hypervolume_has_no_negative_ticks(found: list[float]):
    low, high = convergence_chart([1, 2, 3], [1, 1, 1], found, 3, Sheet(400.0, 200.0)).y.limits
    assert 0.0 <= low <= found[0] and high > max(found)
