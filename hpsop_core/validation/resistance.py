"""Thin-ship theory, friction and interaction beside published values."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hpsop_core.geometry.hull.hull import load_parent_hull
from hpsop_core.hydro.friction import ittc57_coefficient
from hpsop_core.hydro.interaction import wake_fraction
from hpsop_core.hydro.michell import wave_coefficients
from hpsop_core.validation.check import FITTED, HELD_OUT, Check, labelled, relative_check

GROUP = "thin-ship theory and friction"
WIGLEY = ((0.266, 0.944e-3), (0.313, 1.918e-3), (0.316, 1.832e-3), (0.408, 3.030e-3))


def checks() -> Iterator[Check]:
    """Michell on the Wigley hull and the DTC, ITTC-57, Taylor's wake."""
    yield from labelled(HELD_OUT, _formulas())
    yield from _plain_michell()
    yield from labelled(FITTED, _wake())


def _formulas() -> Iterator[Check]:
    length, breadth, draft = 100.0, 10.0, 6.25
    x, z = np.linspace(0.0, length, 161), np.linspace(0.0, draft, 41)
    along, down = (x - length / 2) / (length / 2), (z - draft) / draft
    y = breadth / 2 * (1 - along[:, None] ** 2) * (1 - down[None, :] ** 2)
    computed = wave_coefficients(x, z, y, length, 0.14879 * length**2, [froude for froude, _ in WIGLEY])
    for (froude, expected), value in zip(WIGLEY, computed, strict=True):
        name = f"Wigley hull, Michell's Cw at Fn {froude}"
        yield relative_check(GROUP, name, float(value), expected, "Michell's integral, closed form in x and z", 0.005)
    yield relative_check(GROUP, "ITTC-57 CF at Re 9.145e6", ittc57_coefficient(9.145e6), 3.04713e-3, "ITTC 1957", 1e-5)


def _plain_michell() -> Iterator[Check]:
    hull = load_parent_hull("dtc")
    table = hull.transform(hull.length, hull.breadth, hull.draft).offset_table()
    value = float(wave_coefficients(table.x, table.z, table.y, hull.length, 22044.0, [0.218])[0])
    source = "fine offsets of the public geometry, Michell on 681 x 195 points (tank: 3.36e-4)"
    yield relative_check(GROUP, "DTC, plain Michell Cw at Fn 0.218 on S = 22,044 m2", value, 25.0e-4, source, 0.08)


def _wake() -> Iterator[Check]:
    for block, expected in ((0.661, 0.2611), (0.728, 0.2989)):
        source = "implied by the paper's Table 4"
        yield relative_check(GROUP, f"wake fraction at CB {block}", wake_fraction(block), expected, source, 0.002)
