"""The paper beside hpsop as one HTML file: its tables, its figures with its points, what agrees and what cannot."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Sequence

from hpsop_core.case.variables import VARIABLE_TABLE
from hpsop_core.evaluation.curves import resistance_points, thrust_curves
from hpsop_core.evaluation.hull_answer import ResistancePoint
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.quantities import change_text, number_text, objective_title
from hpsop_core.report import charts
from hpsop_core.report.charts import COMPROMISE_LOOK, INITIAL_LOOK, Look, PaperPoints, Point
from hpsop_core.report.figures import FRONT, LEVEL_COLOURS, SERIES, SOFT, figure_html
from hpsop_core.report.html_page import Section, bullets, page, pair, symbol, table, text
from hpsop_core.report.tables import run_facts
from hpsop_core.reproduction import paper
from hpsop_core.reproduction.comparison import (
    TABLE4_QUANTITIES,
    Cell,
    Reproduction,
    Table,
    thrust_with_absolute_pitch,
    wave_part,
)
from hpsop_core.version import __version__

_ABOVE = 0.03
_GENERATIONS_SHOWN = 4
_DIGITS = {
    "L": 2, "B": 2, "d": 2, "CB": 3, "Z": 0, "D": 2, "P/D": 2, "f1": 3, "f2": 3, "J": 3, "KT": 4, "10KQ": 4, "eta": 4,
    "Fn": 2, "weight": 2, "lower": 2, "upper": 2, "off": 1, "Rt": 0, "T": 0, "PD": 1, "PE": 1, "PD1": 1, "PD2": 1,
    "V": 2, "w": 3, "t": 3, "T/Rt": 3, "10^4": 1, "ours": 3,
}  # fmt: skip
_SYMBOLS = {"f1": "f_1", "f2": "f_2", "KT": "K_T", "10KQ": "10K_Q", "CB": "C_B", "eta": "η", "Rt": "R_T", "PD": "P_D",
            "PD1": "P_D1", "PD2": "P_D2", "PE": "P_E", "T/Rt": "T/R_T"}  # fmt: skip


def page_html(data: Reproduction, made: Sequence[Table]) -> str:
    """The page's text.

    Args:
        data: what is compared.
        made: ``reproduction.tables`` of it.

    Raises:
        SolverFailure: a curve cannot be computed.
    """
    by_name = {item.name: item for item in made}
    sections = [
        Section("verdict", "What agrees, and what cannot", _verdict(data, by_name)),
        Section("setup", "Tables 1 and 2: conditions, bounds", _html(by_name["table1"]) + _table2(by_name["table2"])),
        Section("table3", "Table 3: initial and optimal designs", _table3(data, by_name)),
        Section("table4", "Table 4: operating points", _table4(by_name["table4"])),
        Section("figure5", "Figure 5: evolution of the fronts", _figure5(data)),
        Section("figures67", "Figures 6 and 7: resistance", _figures67(data) + _html(by_name["resistance_audit"])),
        Section("figure8", "Figure 8: open water", _figure8(data) + _html(by_name["propeller_at_paper_j"])),
        Section("figure9", "Figure 9: thrust", _figure9(data) + _html(by_name["table4_audit"], wide=True)),
        Section("run", "The run", run_facts(data.run.summary(), len(data.run.failures()))),
    ]
    footer = f"hpsop {__version__}, made {time.strftime('%Y-%m-%d %H:%M')}"
    return page("The HPSOP paper beside hpsop", _head(data), sections, footer)


def _head(data: Reproduction) -> str:
    summary = data.run.summary()
    own = data.run.case.optimization
    parts = [
        f"<p>H. Zakerdoost, H. Ghassemi: <em>{text(paper.TITLE)}</em>. Its tables and figures beside those of hpsop's "
        f"case <code>{paper.CASE_NAME}</code>. In every figure the paper's printed numbers are drawn in red; its "
        "curves are not available as numbers.</p>"
    ]
    if summary["state"] != "finished":
        parts.append(
            f'<p class="banner"><strong>The run is not finished</strong>: {text(summary["state"])}, generation '
            f"{summary['generation']} of {summary['generations']}. Ours is what it has found so far.</p>"
        )
    if (own.population, summary["generations"]) != (50, 150):
        parts.append(
            f'<p class="banner">The paper ran 150 generations of 50; this run has {summary["generations"]} of '
            f"{own.population}, so its front is only a first impression.</p>"
        )
    if data.level == 1:
        parts.append(
            '<p class="banner">Our designs are of <strong>level 1</strong> (Michell, lifting line): the run has not '
            "reached level 2.</p>"
        )
    if data.compromise is None:
        parts.append(
            '<p class="banner"><strong>Our front is empty</strong> at this moment: no design keeps all constraints. '
            "With g<sub>3</sub> at level 2 only and no re-seeding, as published, level 1 hands over a population of "
            "which hardly a design keeps Keller's criterion.</p>"
        )
    return "".join(parts)


# -- words ---------------------------------------------------------------------------------------------------------


def _verdict(data: Reproduction, by_name: dict[str, Table]) -> str:
    audit = by_name["table4_audit"]
    ratio = _column(audit, "T/Rt [-]")
    deduction = _column(audit, "t implied [-]")
    wake = sorted({round(value, 4) for value in _column(audit, "w implied [-]")})
    taylor = sorted({round(value, 4) for value in _column(audit, "w of Taylor's table [-]")})
    efficiency = max(
        abs(a - b) for a, b in zip(_column(audit, "eta recomputed [-]"), _column(audit, "eta printed [-]"), strict=True)
    )
    first = paper.table4()[0]
    absolute = thrust_with_absolute_pitch(data, first)
    f1, f2 = paper.objectives_from_table4()
    printed = next(design for design in paper.table3() if design.name == paper.COMPROMISE)
    initial = next(design for design in paper.table3() if design.name == paper.INITIAL)
    volumes = [
        100.0 * (1.0 - design.displaced_volume / initial.displaced_volume)
        for design in paper.table3()
        if design.name != paper.INITIAL
    ]
    resistance = by_name["resistance_audit"].rows[0]
    off = by_name["propeller_at_paper_j"]
    rows = by_name["resistance_audit"].rows
    bracketed = all(float(row[6] or 0.0) < float(row[2] or 0.0) < float(row[4] or 0.0) for row in rows)
    between = " All four printed resistances lie between those of our levels 2 and 1." if bracketed else ""
    keller = {(row[0], row[1]): float(row[-1] or 0.0) for row in audit.rows}
    agree = [
        f"<strong>The initial propeller.</strong> At the paper's J, our K<sub>T</sub> is {_off(off, 'IS', 'KT')}, "
        f"10K<sub>Q</sub> {_off(off, 'IS', '10KQ')} and η {_off(off, 'IS', 'eta')} off the printed values (both "
        "levels), if the paper's P/D is a multiplier on P4119's pitch. With an absolute P/D of 1.00, K<sub>T</sub> "
        f"would be {absolute:.3f} instead of the printed {first.thrust_coefficient:.3f} at J "
        f"{first.advance_coefficient:.3f}.",
        f"<strong>The compromise propeller's efficiency</strong> (Z = 5): η {_off(off, 'OP3', 'eta')} off.",
        f"<strong>J, N, D and V</strong> of Table 4 belong to one wake fraction a hull, {wake[0]:.3f} and "
        f"{wake[1]:.3f}: those of Taylor's single-screw table at the printed C<sub>B</sub> ({taylor[0]:.3f} and "
        f"{taylor[1]:.3f} by the quadratic fit that hpsop uses), not 0.5 C<sub>B</sub> − 0.05.",
        "<strong>η</strong> follows from the printed J, K<sub>T</sub> and K<sub>Q</sub>, to within "
        f"{1e6 * efficiency:.0f} · 10<sup>−6</sup>.",
        f"<strong>f<sub>1</sub></strong> is the weighted sum: Table 4 gives {f1:.3f} for the compromise, Table 3 "
        f"prints {printed.f1:.2f}.",
        *_direction(data, printed, initial),
    ]
    cannot = [
        f"<strong>Thrust less than resistance.</strong> The printed K<sub>T</sub>, N and D give T = {min(ratio):.2f} "
        f"to {max(ratio):.2f} R<sub>T</sub>, a thrust deduction of {number_text(min(deduction), 2)} to "
        f"{number_text(max(deduction), 2)}, and less delivered than effective power: physically impossible. We use T "
        "= R<sub>T</sub>/(1 − t), so our J, N, T and P<sub>D</sub> must differ.",
        f"<strong>Resistance.</strong> The printed R<sub>T</sub> leaves a wave coefficient of {resistance[3]:.1f} · "
        f"10<sup>−4</sup> at Fn 0.22 (initial design). The towing tank found 3.4 at Fn 0.218, our level 2 gives "
        f"{resistance[7]:.1f}, plain Michell {resistance[5]:.1f}: about seven times too high on this flat stern, and "
        f"the paper's numbers look like it.{between}",
        f"<strong>Block coefficient.</strong> C<sub>B</sub> rises from {initial.block_coefficient:.3f} to 0.73 to "
        "0.75 while resistance falls. With sections really made fuller that does not come out; it does if the hull "
        "is scaled and C<sub>B</sub> only booked, as in this case. Such a hull does not exist.",
        f"<strong>f<sub>2</sub></strong> of the compromise is {f2:.3f} by Table 4 and {printed.f2:.3f} in Table 3: "
        "the two do not belong together.",
        f"<strong>“Displacement unchanged”.</strong> L B d C<sub>B</sub> of the optima is {min(volumes):.1f} to "
        f"{max(volumes):.1f} % below the initial design's: they lean on the lower side of g<sub>1</sub>.",
        "<strong>Cavitation at Fn 0.27.</strong> With the printed thrust, K = 0 and the shaft's immersion, Keller's "
        f"criterion asks for an area ratio of {keller['IS', 0.22]:.2f} (initial) and {keller['OP3', 0.22]:.2f} "
        f"(compromise) at Fn 0.22, but {keller['IS', 0.27]:.2f} and {keller['OP3', 0.27]:.2f} at Fn 0.27, far above "
        "P4119's 0.6: g<sub>3</sub> can only have acted at Fn 0.22, and so it does here.",
        f"<strong>The compromise propeller's loading.</strong> At Z = 5 our K<sub>T</sub> is {_off(off, 'OP3', 'KT')} "
        f"off and 10K<sub>Q</sub> {_off(off, 'OP3', '10KQ')}. The paper does not say how its family treats chord and "
        "thickness when blades are added; we keep the area ratio.",
        "<strong>Not stated</strong>: seed, distribution indices, level-1 generations, viscosity, roughness, "
        "P<sub>0</sub> and K of Keller's criterion. hpsop's choices stand in the case file.",
    ]
    return f"<h3>Agrees</h3>{bullets(agree)}<h3>Cannot be reproduced, and why</h3>{bullets(cannot)}"


def _direction(data: Reproduction, printed: paper.PaperDesign, initial: paper.PaperDesign) -> list[str]:
    """How the compromise differs from the initial design, there and here."""
    if data.compromise is None:
        return []
    now, before = data.compromise.evaluation.variables, data.initial.evaluation.variables
    words = [
        f"{name} {change_text(a, b, 2)} there, {change_text(c, d, 2)} here"
        for name, a, b, c, d in (
            ("L", initial.length, printed.length, before.length, now.length),
            ("B", initial.breadth, printed.breadth, before.breadth, now.breadth),
            ("D", initial.diameter, printed.diameter, before.diameter, now.diameter),
            (
                "displacement", initial.displaced_volume, printed.displaced_volume, before.displacement_ratio,
                now.displacement_ratio,
            ),
        )
    ]  # fmt: skip
    blades = f"Z {initial.blade_count} to {printed.blade_count} there, {before.blade_count} to {now.blade_count} here"
    return [f"<strong>The direction</strong>, compromise against initial design: {'; '.join(words)}; {blades}."]


def _column(made: Table, name: str) -> list[float]:
    index = made.header.index(name)
    return [value for row in made.rows if isinstance(value := row[index], float)]


def _off(made: Table, design: str, quantity: str) -> str:
    """−3.5 to −2.3 %: the range of a deviation over both levels and conditions."""
    index = made.header.index(f"{quantity} off [%]")
    values = [value for row in made.rows if row[0] == design and isinstance(value := row[index], float)]
    low, high = (number_text(value, 1) for value in (min(values), max(values)))
    return f"{low} to {high}\xa0%"


# -- tables --------------------------------------------------------------------------------------------------------


def _digits(column: str) -> int:
    return 1 if " off " in column else _DIGITS.get(column.split(" ")[0], 3)


def _cell(value: Cell, digits: int) -> str:
    if value is None:
        return "–"
    return text(value) if isinstance(value, str) else number_text(float(value), digits)


def _heading(column: str) -> str:
    words, _, unit = column.partition(" [")
    first, _, rest = words.partition(" ")
    name = f"{symbol(_SYMBOLS.get(first, first))} {text(rest)}".replace("10^4 Cw", "10<sup>4</sup> C<sub>W</sub>")
    shown = unit.rstrip("]").replace("-", "–")
    return name + (f"<br><span class=unit>[{text(shown)}]</span>" if unit else "")


def _html(made: Table, wide: bool = False, marked: Sequence[int] = ()) -> str:
    digits = [_digits(column) for column in made.header]
    rows = [[_cell(value, places) for value, places in zip(row, digits, strict=True)] for row in made.rows]
    caption = f"{text(made.comment)} <span class=unit>({text(made.name)}.csv)</span>"
    return table([_heading(column) for column in made.header], rows, caption=caption, wide=wide, marked=marked)


def _table2(made: Table) -> str:
    rows: list[tuple[Cell, ...]] = []
    for name, *limits in made.rows:
        # Blades are counted.
        shown = [f"{value:.0f}" for value in limits] if name == "blade_count" else limits
        variable = VARIABLE_TABLE[str(name)]
        rows.append((f"{variable.label} [{variable.unit or '–'}]", *shown))
    return _html(dataclasses.replace(made, rows=tuple(rows)))


def _table3(data: Reproduction, by_name: dict[str, Table]) -> str:
    made = by_name["table3"]
    ours = [index for index, row in enumerate(made.rows) if str(row[0]).startswith("ours")]
    words = (
        "<p>R1 to R5 lie evenly over our front. The paper's f are normalised by its own initial design, ours by ours "
        "at the same level.</p>"
    )
    again = (
        "<h3>The paper's designs with our physics</h3><p>If only the search differed, the paper's designs would have "
        "the paper's objectives here.</p>"
    )
    return words + _html(made, marked=ours) + again + _html(by_name["paper_designs"], wide=True)


_TABLE4_DIGITS = dict(zip(TABLE4_QUANTITIES, (0, 3, 2, 4, 4, 4, 0, 1), strict=True))


def _table4(made: Table) -> str:
    rows: list[list[str]] = []
    group = ("", 0.0)
    for design, froude, quantity, theirs, mine, ratio in made.rows:
        if (design, froude) != group:
            group = (str(design), float(froude or 0.0))
            rows.append([f"{text(design)} design, Fn {number_text(group[1], 2)}"])
        digits = _TABLE4_DIGITS[str(quantity)]
        name = _heading(str(quantity)).replace("<br>", " ")
        rows.append([name, _cell(theirs, digits), _cell(mine, digits), _cell(ratio, 2)])
    caption = f"{text(made.comment)} <span class=unit>({text(made.name)}.csv)</span>"
    return table(["", "paper", "ours", "ours / paper"], rows, caption=caption)


# -- figures -------------------------------------------------------------------------------------------------------


def _looks(data: Reproduction) -> list[tuple[Look, Evaluation]]:
    found = []
    for number, (name, evaluation) in enumerate(data.designs()):
        if name == "initial":
            found.append((INITIAL_LOOK, evaluation))
            continue
        mark = data.compromise is not None and evaluation is data.compromise.evaluation
        found.append((Look(f"{name}, compromise" if mark else name, SERIES[number - 1]), evaluation))
    return [(look, evaluation) for look, evaluation in found if evaluation.ok]


def _figure5(data: Reproduction) -> str:
    fronts: list[tuple[str, str, Sequence[Point]]] = []
    generations = [item for item in data.run.generations() if item.front]
    for level in (1, 2):
        own = [item for item in generations if item.level == level]
        if not own:
            continue
        places = sorted({round((len(own) - 1) * part / (_GENERATIONS_SHOWN - 1)) for part in range(_GENERATIONS_SHOWN)})
        for place in places:
            item = own[place]
            points = [
                (float(record.evaluation.objectives["f1"] or 0.0), float(record.evaluation.objectives["f2"] or 0.0))
                for record in data.run.designs(item.front)
            ]
            last = item is generations[-1]
            colour = FRONT if last else LEVEL_COLOURS[level] if place == places[-1] else _pale(level, place, len(own))
            fronts.append((f"generation {item.number}, level {level}", colour, points))
    published = PaperPoints(
        "paper, Table 3",
        [design.f1 for design in paper.table3()],
        [design.f2 for design in paper.table3()],
        notes=[design.name for design in paper.table3()],
    )
    titles = (objective_title("resistance", "$f_1$"), objective_title("efficiency", "$f_2$"))
    return figure_html(
        charts.evolution_chart(fronts, titles, [published]),
        "figure-5",
        "Our fronts of several generations (blue: level 1, orange: level 2, green: the last) and the designs of the "
        "paper's Table 3. Each level is normalised by the initial design at that level.",
    )


def _pale(level: int, place: int, count: int) -> str:
    """A level's colour, paler for earlier generations."""
    share = 0.5 + 0.4 * place / max(1, count - 1)
    parts = [int(LEVEL_COLOURS[level][at : at + 2], 16) for at in (1, 3, 5)]
    return "#" + "".join(f"{round(255 - share * (255 - part)):02x}" for part in parts)


def _resistance(data: Reproduction) -> list[tuple[Look, tuple[ResistancePoint, ...], Evaluation]]:
    reference = data.references[data.level]
    lines = [
        (look, resistance_points(data.case, evaluation, reference, _ABOVE), evaluation)
        for look, evaluation in _looks(data)
    ]
    if data.level == 2:
        evaluation = data.run.initial(1).evaluation
        if evaluation.level == 1 and evaluation.ok:
            points = resistance_points(data.case, evaluation, data.references[1], _ABOVE)
            lines.append((Look("initial, plain Michell (level 1)", SOFT, ":"), points, evaluation))
    return lines


def _figures67(data: Reproduction) -> str:
    lines = _resistance(data)

    def published(which: str) -> list[PaperPoints]:
        made = []
        for name, marker in ((paper.INITIAL, "s"), (paper.COMPROMISE, "x")):
            points = paper.points_of(name)
            force = [wave_part(data, p)[0] if which == "wave" else p.total_resistance for p in points]
            label = f"paper {name}, Table 4" + (" less ITTC-57 friction" if which == "wave" else "")
            made.append(PaperPoints(label, [p.froude_number for p in points], [1e-6 * f for f in force], marker))
        return made

    return pair(
        figure_html(
            charts.resistance_chart(lines, "wave", published("wave")),
            "figure-6",
            f"Wave resistance, level {data.level}. The paper prints no wave resistance: red is what its total leaves.",
        ),
        figure_html(
            charts.resistance_chart(lines, "total", published("total")),
            "figure-7",
            f"Total resistance, level {data.level}, and the paper's Table 4.",
        ),
    )


def _figure8(data: Reproduction) -> str:
    published = [
        PaperPoints(
            f"paper {name}, Table 4",
            [p.advance_coefficient for p in paper.points_of(name)] * 3,
            [
                value
                for key in ("thrust_coefficient", "ten_torque_coefficient", "open_water_efficiency")
                for value in (getattr(p, key) for p in paper.points_of(name))
            ],
            marker,
        )
        for name, marker in ((paper.INITIAL, "s"), (paper.COMPROMISE, "x"))
    ]
    designs = [(look, evaluation) for look, evaluation in _looks(data) if evaluation.open_water is not None]
    return figure_html(
        charts.open_water_chart(designs, published, required=False),
        "figure-8",
        f"Open water of our initial and chosen designs, level {data.level}, full scale; the paper's KT, 10KQ and "
        "efficiency at its operating points.",
    )


def _figure9(data: Reproduction) -> str:
    drawn = [(INITIAL_LOOK, data.initial.evaluation)]
    if data.compromise is not None:
        drawn.append((COMPROMISE_LOOK, data.compromise.evaluation))
    reference = data.references[data.level]
    curves = []
    for look, evaluation in drawn:
        points = resistance_points(data.case, evaluation, reference, _ABOVE)
        curves.append((look, thrust_curves(data.case, evaluation, points), evaluation))
    density = data.case.constants.density
    published = []
    for name, markers in ((paper.INITIAL, ("s", "D")), (paper.COMPROMISE, ("x", "+"))):
        points_of = paper.points_of(name)
        froude = [p.froude_number for p in points_of]
        resistance = [1e-6 * p.total_resistance for p in points_of]
        thrust = [1e-6 * p.thrust(density) for p in points_of]
        published.append(PaperPoints(f"paper {name}: $R_T$", froude, resistance, markers[0]))
        published.append(PaperPoints(f"paper {name}: $T$", froude, thrust, markers[1]))
    return figure_html(
        charts.thrust_chart(curves, published),
        "figure-9",
        f"Thrust required and available, level {data.level}. The paper's thrust lies below its resistance.",
    )
