"""The paper beside hpsop as one HTML file: its tables, its figures with its points, what agrees and what cannot."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Mapping, Sequence

from hpsop_core.case.variables import VARIABLE_TABLE
from hpsop_core.evaluation.levels import FAST, level_of
from hpsop_core.markup import Markup, fill, joined, one_line
from hpsop_core.quantities import change_text, number_text
from hpsop_core.report.csv_table import Cell, Table, caption_html, cell_text, heading_html, table_html
from hpsop_core.report.html_page import Section, Words, bullets, page, pair, paragraph, table
from hpsop_core.report.tables import run_facts
from hpsop_core.reproduction import paper
from hpsop_core.reproduction.comparison import (
    TABLE4_DIGITS,
    TABLE4_QUANTITIES,
    Reproduction,
    thrust_with_absolute_pitch,
)
from hpsop_core.reproduction.figures import figures
from hpsop_core.version import __version__


def page_html(data: Reproduction, made: Sequence[Table]) -> str:
    """The page's text.

    Args:
        data: what is compared.
        made: ``reproduction.tables`` of it.

    Raises:
        SolverFailure: a curve cannot be computed.
    """
    by_name = {item.name: item for item in made}
    drawn = {number: figure.html() for number, figure in figures(data).items()}
    setup = table_html(by_name["table1"]) + _table2(by_name["table2"])
    resistance = pair(drawn[6], drawn[7]) + table_html(by_name["resistance_audit"])
    sections = [
        Section("verdict", "What agrees, and what cannot", verdict_html(data, by_name)),
        Section("setup", "Tables 1 and 2: conditions, bounds", setup),
        Section("table3", "Table 3: initial and optimal designs", _table3(data, by_name)),
        Section("table4", "Table 4: operating points", _table4(by_name["table4"])),
        Section("figure5", "Figure 5: evolution of the fronts", drawn[5]),
        Section("figures67", "Figures 6 and 7: resistance", resistance),
        Section("figure8", "Figure 8: open water", drawn[8] + table_html(by_name["propeller_at_paper_j"])),
        Section("figure9", "Figure 9: thrust", drawn[9] + table_html(by_name["table4_audit"], wide=True)),
        Section("run", "The run", run_facts(data.run.summary(), len(data.run.failures()))),
    ]
    footer = f"hpsop {__version__}, made {time.strftime('%Y-%m-%d %H:%M')}"
    return page("The HPSOP paper beside hpsop", _head(data), sections, footer)


def _head(data: Reproduction) -> Markup:
    summary = data.run.summary()
    own = data.run.case.optimization
    intro = fill(
        "H. Zakerdoost, H. Ghassemi: <em>{}</em>. Its tables and figures beside those of hpsop's case "
        "<code>{}</code>. In every figure the paper's printed numbers are drawn in red; its curves are not available "
        "as numbers.",
        one_line(paper.TITLE),
        paper.CASE_NAME,
    )
    parts = [paragraph(intro)]
    banners: list[Words] = []
    if summary["state"] != "finished":
        words = "<strong>The run is not finished</strong>: {}, generation {} of {}. Ours is what it has found so far."
        banners.append(fill(words, one_line(summary["state"]), summary["generation"], summary["generations"]))
    if (own.population, summary["generations"]) != (50, 150):
        banners.append(
            f"The paper ran 150 generations of 50; this run has {summary['generations']} of {own.population}, so its "
            "front is only a first impression."
        )
    if level_of(data.level) is FAST:
        banners.append(
            Markup(
                "Our designs are of <strong>level 1</strong> (Michell, lifting line): the run has not reached level 2."
            )
        )
    if data.compromise is None:
        banners.append(
            Markup(
                "<strong>Our front is empty</strong> at this moment: no design keeps all constraints. With "
                "g<sub>3</sub> at level 2 only and no re-seeding, as published, level 1 hands over a population of "
                "which hardly a design keeps Keller's criterion."
            )
        )
    return joined([*parts, *(paragraph(words, "banner") for words in banners)])


# -- words ---------------------------------------------------------------------------------------------------------


def verdict_html(data: Reproduction, by_name: Mapping[str, Table]) -> Markup:
    """What agrees, and what cannot be reproduced, with the numbers.

    Args:
        data: what is compared.
        by_name: ``comparison.tables`` of it, by their names.
    """
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
    agree: list[Words] = [
        fill(
            "<strong>The initial propeller.</strong> At the paper's J, our K<sub>T</sub> is {}, 10K<sub>Q</sub> {} "
            "and η {} off the printed values (both levels), if the paper's P/D is a multiplier on P4119's pitch. With "
            "an absolute P/D of 1.00, K<sub>T</sub> would be {:.3f} instead of the printed {:.3f} at J {:.3f}.",
            _off(off, "IS", "KT"),
            _off(off, "IS", "10KQ"),
            _off(off, "IS", "eta"),
            absolute,
            first.thrust_coefficient,
            first.advance_coefficient,
        ),
        fill(
            "<strong>The compromise propeller's efficiency</strong> (Z = 5): η {} off.",
            _off(off, "OP3", "eta"),
        ),
        fill(
            "<strong>J, N, D and V</strong> of Table 4 belong to one wake fraction a hull, {:.3f} and {:.3f}: those "
            "of Taylor's single-screw table at the printed C<sub>B</sub> ({:.3f} and {:.3f} by the quadratic fit that "
            "hpsop uses), not 0.5 C<sub>B</sub> − 0.05.",
            wake[0],
            wake[1],
            taylor[0],
            taylor[1],
        ),
        fill(
            "<strong>η</strong> follows from the printed J, K<sub>T</sub> and K<sub>Q</sub>, to within {:.0f} · "
            "10<sup>−6</sup>.",
            1e6 * efficiency,
        ),
        fill(
            "<strong>f<sub>1</sub></strong> is the weighted sum: Table 4 gives {:.3f} for the compromise, Table 3 "
            "prints {:.2f}.",
            f1,
            printed.f1,
        ),
        *_direction(data, printed, initial),
    ]
    cannot: list[Words] = [
        fill(
            "<strong>Thrust less than resistance.</strong> The printed K<sub>T</sub>, N and D give T = {:.2f} to "
            "{:.2f} R<sub>T</sub>, a thrust deduction of {} to {}, and less delivered than effective power: "
            "physically impossible. We use T = R<sub>T</sub>/(1 − t), so our J, N, T and P<sub>D</sub> must differ.",
            min(ratio),
            max(ratio),
            number_text(min(deduction), 2),
            number_text(max(deduction), 2),
        ),
        fill(
            "<strong>Resistance.</strong> The printed R<sub>T</sub> leaves a wave coefficient of {:.1f} · "
            "10<sup>−4</sup> at Fn 0.22 (initial design). The towing tank found 3.4 at Fn 0.218, our level 2 gives "
            "{:.1f}, plain Michell {:.1f}: about seven times too high on this flat stern, and the paper's numbers "
            "look like it.{}",
            resistance[3],
            resistance[7],
            resistance[5],
            between,
        ),
        fill(
            "<strong>Block coefficient.</strong> C<sub>B</sub> rises from {:.3f} to 0.73 to 0.75 while resistance "
            "falls. With sections really made fuller that does not come out; it does if the hull is scaled and "
            "C<sub>B</sub> only booked, as in this case. Such a hull does not exist.",
            initial.block_coefficient,
        ),
        fill(
            "<strong>f<sub>2</sub></strong> of the compromise is {:.3f} by Table 4 and {:.3f} in Table 3: the two do "
            "not belong together.",
            f2,
            printed.f2,
        ),
        fill(
            "<strong>“Displacement unchanged”.</strong> L B d C<sub>B</sub> of the optima is {:.1f} to {:.1f} % below "
            "the initial design's: they lean on the lower side of g<sub>1</sub>.",
            min(volumes),
            max(volumes),
        ),
        fill(
            "<strong>Cavitation at Fn 0.27.</strong> With the printed thrust, K = 0 and the shaft's immersion, "
            "Keller's criterion asks for an area ratio of {:.2f} (initial) and {:.2f} (compromise) at Fn 0.22, but "
            "{:.2f} and {:.2f} at Fn 0.27, far above P4119's 0.6: g<sub>3</sub> can only have acted at Fn 0.22, and "
            "so it does here.",
            keller["IS", 0.22],
            keller["OP3", 0.22],
            keller["IS", 0.27],
            keller["OP3", 0.27],
        ),
        fill(
            "<strong>The compromise propeller's loading.</strong> At Z = 5 our K<sub>T</sub> is {} off and "
            "10K<sub>Q</sub> {}. The paper does not say how its family treats chord and thickness when blades are "
            "added; we keep the area ratio.",
            _off(off, "OP3", "KT"),
            _off(off, "OP3", "10KQ"),
        ),
        Markup(
            "<strong>Not stated</strong>: seed, distribution indices, level-1 generations, viscosity, roughness, "
            "P<sub>0</sub> and K of Keller's criterion. hpsop's choices stand in the case file."
        ),
    ]
    return fill("<h3>Agrees</h3>{}<h3>Cannot be reproduced, and why</h3>{}", bullets(agree), bullets(cannot))


def _direction(data: Reproduction, printed: paper.PaperDesign, initial: paper.PaperDesign) -> list[Markup]:
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
    line = "<strong>The direction</strong>, compromise against initial design: {}; {}."
    return [fill(line, "; ".join(words), blades)]


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


def _table2(made: Table) -> Markup:
    rows: list[tuple[Cell, ...]] = []
    for name, *limits in made.rows:
        # Blades are counted.
        shown = [f"{value:.0f}" for value in limits] if name == "blade_count" else limits
        variable = VARIABLE_TABLE[str(name)]
        rows.append((f"{variable.label} [{variable.unit or '–'}]", *shown))
    return table_html(dataclasses.replace(made, rows=tuple(rows)))


def _table3(data: Reproduction, by_name: dict[str, Table]) -> Markup:
    made = by_name["table3"]
    ours = [index for index, row in enumerate(made.rows) if str(row[0]).startswith("ours")]
    words = paragraph(
        "R1 to R5 lie evenly over our front. The paper's f are normalised by its own initial design, ours by ours at "
        "the same level."
    )
    again = Markup(
        "<h3>The paper's designs with our physics</h3><p>If only the search differed, the paper's designs would have "
        "the paper's objectives here.</p>"
    )
    return words + table_html(made, marked=ours) + again + table_html(by_name["paper_designs"], wide=True)


def _table4(made: Table) -> Markup:
    rows: list[list[Words]] = []
    digits_of = dict(zip(TABLE4_QUANTITIES, TABLE4_DIGITS, strict=True))
    group = ("", 0.0)
    for design, froude, quantity, theirs, mine, ratio in made.rows:
        if (design, froude) != group:
            group = (str(design), float(froude or 0.0))
            rows.append([f"{design} design, Fn {number_text(group[1], 2)}"])
        digits = digits_of[str(quantity)]
        name = heading_html(str(quantity), " ")
        rows.append([name, cell_text(theirs, digits), cell_text(mine, digits), cell_text(ratio, 2)])
    return table(["", "paper", "ours", "ours / paper"], rows, caption=caption_html(made))
