"""Checks of the propeller's geometry and of the lifting line against closed forms, experiment and another code."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from hpsop_core.assets import read_asset_text
from hpsop_core.geometry.propeller.propeller import load_propeller, propeller_family
from hpsop_core.hydro.lifting_line import solver as lifting_line
from hpsop_core.hydro.section_drag import SectionDrag
from hpsop_core.hydro.singularities.vortices import wrench_velocities
from hpsop_core.typing_aliases import Array
from hpsop_core.validation.check import FITTED, HELD_OUT, Check, absolute_check, labelled, relative_check

GROUP = "propeller, level 1"
MODEL_DIAMETER = 0.3048
EXPERIMENT = "P4119 open water, set A (Jessup 1989)"


@lru_cache(maxsize=4)
def reference_rows(name: str) -> tuple[dict[str, str], ...]:
    """Rows of a shipped reference table of comma-separated values by column name."""
    lines = [line for line in read_asset_text("reference", name).splitlines() if line and not line.startswith("#")]
    header = lines[0].split(",")
    return tuple(dict(zip(header, line.split(","), strict=True)) for line in lines[1:])


def elliptic_wing(aspect_ratio: float, strips: int = 40) -> tuple[float, float, Array]:
    """An elliptic wing by the propeller's own kernel: one blade, far from its axis, in a wake of endless pitch.

    Prandtl's lifting line with the section's lift slope 2 pi, so that the closed form is exact.

    Args:
        aspect_ratio: span squared over area.
        strips: horseshoes.

    Returns:
        (lift slope per radian, induced drag over lift squared, downwash angle per lift coefficient at the strips).
    """
    span, far = 1.0, 1.0e4
    angle = np.pi * np.arange(strips + 1) / strips
    edges = far - 0.5 * span * np.cos(angle)
    radii = far - 0.5 * span * np.cos(0.5 * (angle[1:] + angle[:-1]))
    # chord at the strip's middle; the area is pi/4 span root_chord
    root_chord = 4.0 * span / (np.pi * aspect_ratio)
    chord = root_chord * np.sin(0.5 * (angle[1:] + angle[:-1]))
    _, tangential = wrench_velocities(radii[:, None], edges, np.array(1.0e9), 1)
    downwash = tangential[:, :-1] - tangential[:, 1:]
    # circulation = pi c (alpha - downwash) for unit speed and alpha = 1
    circulation = np.linalg.solve(np.eye(strips) + np.pi * chord[:, None] * downwash, np.pi * chord)
    induced = downwash @ circulation
    width = np.diff(edges)
    area = span**2 / aspect_ratio
    lift = 2.0 * float(circulation @ width) / area
    drag = 2.0 * float((circulation * induced) @ width) / area
    return lift, drag / lift**2, np.asarray(induced / lift)


def actuator_disc_efficiency(thrust_coefficient: Array, advance_coefficient: Array) -> Array:
    """Efficiency that no propeller exceeds: 2/(1 + sqrt(1 + CT)) with CT = 8 KT/(pi J^2)."""
    loading = 8.0 * thrust_coefficient / (np.pi * advance_coefficient**2)
    return np.asarray(2.0 / (1.0 + np.sqrt(1.0 + loading)))


def betz_efficiency(thrust_coefficient: float, advance_coefficient: float) -> float:
    """Efficiency of the Betz optimum with endlessly many blades at the same KT and J (Theodorsen).

    kappa = 1 - l^2 ln(1 + 1/l^2), eps = 2 int_0^1 x^5/(x^2 + l^2)^2 dx, l = (J/pi)(1 + w),
    CT = 2 kappa w (1 + w (1/2 + eps/kappa)), CP = 2 kappa w (1 + w)(1 + w eps/kappa).
    """
    target = 8.0 * thrust_coefficient / (np.pi * advance_coefficient**2)
    nodes, weights = np.polynomial.legendre.leggauss(60)
    x = 0.5 * (nodes + 1.0)

    def coefficients(w: float) -> tuple[float, float]:
        pitch = advance_coefficient / np.pi * (1.0 + w)
        kappa = 1.0 - pitch**2 * np.log1p(1.0 / pitch**2)
        eps = float(np.sum(weights * x**5 / (x**2 + pitch**2) ** 2))
        thrust = 2.0 * kappa * w * (1.0 + w * (0.5 + eps / kappa))
        power = 2.0 * kappa * w * (1.0 + w) * (1.0 + w * eps / kappa)
        return float(thrust), float(power)

    low, high = 0.0, 1.0
    while coefficients(high)[0] < target:
        high *= 2.0
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if coefficients(middle)[0] < target else (low, middle)
    thrust, power = coefficients(high)
    return thrust / power


def _kernel_checks() -> Iterator[Check]:
    for aspect, slope, drag in ((4.0, 4.18879, 0.019894), (8.0, 5.02655, 0.009947), (12.0, 5.38559, 0.006631)):
        lift, factor, _ = elliptic_wing(aspect)
        source = "Prandtl: 2 pi/(1 + 2/A), CL^2/(pi A)"
        yield relative_check(GROUP, f"elliptic wing A {aspect:g}: lift slope [1/rad]", lift, slope, source, 0.01)
        yield relative_check(
            GROUP, f"elliptic wing A {aspect:g}: induced drag at CL 0.5", 0.25 * factor, drag, source, 0.01
        )
    radius, vortex = np.array(0.8), np.array(0.6)
    _, straight = wrench_velocities(radius, vortex, np.array(1.0e9), 1)
    yield relative_check(
        GROUP,
        "one helix of endless pitch: tangential velocity",
        float(straight),
        1.0 / (4.0 * np.pi * 0.2),
        "semi-infinite straight vortex, 1/(4 pi h)",
        0.01,
    )
    blades = 400
    _, many = wrench_velocities(radius, vortex, np.array(0.3), blades)
    yield relative_check(
        GROUP,
        "400 helices: tangential velocity outside them",
        float(many),
        blades / (4.0 * np.pi * 0.8),
        "momentum theory, half the jump Z Gamma/(2 pi r)",
        0.01,
    )


def _bound_checks() -> Iterator[Check]:
    parent = load_propeller()
    advance = np.array([0.2, 0.5, 0.7, 0.9])
    disc, betz = -1.0, -1.0
    for blades, pitch, area in ((3, 1.0, None), (3, 1.05, 0.5), (5, 0.95, 0.6), (7, 1.05, 1.0)):
        result = lifting_line.solve(propeller_family(parent, 1.0, blades, pitch, area), advance, SectionDrag.inviscid())
        efficiency = result.open_water_efficiency
        disc = max(disc, float(np.max(efficiency - actuator_disc_efficiency(result.thrust_coefficient, advance))))
        ideal = [betz_efficiency(float(kt), float(j)) for kt, j in zip(result.thrust_coefficient, advance, strict=True)]
        betz = max(betz, float(np.max(efficiency - np.array(ideal))))
    for name, excess in (("actuator disc", disc), ("Betz optimum, endless blades", betz)):
        yield Check(
            GROUP,
            f"greatest efficiency without drag over the family, less that of the {name}",
            excess,
            0.0,
            f"{name}, closed form",
            "never above 0",
            excess <= 0.0,
        )


def _p4119_checks() -> Iterator[Check]:
    model = propeller_family(load_propeller(), MODEL_DIAMETER, 3)
    rows = [row for row in reference_rows("p4119_openwater.csv") if row["set"] == "A"]
    advance = np.array([float(row["J"]) for row in rows])
    result = lifting_line.solve(model, advance, SectionDrag.model_scale(10.0, 1.0e-6))
    for i, row in enumerate(rows):
        kt, kq = float(result.thrust_coefficient[i]), 10.0 * float(result.torque_coefficient[i])
        if advance[i] <= 0.9:
            yield relative_check(GROUP, f"P4119 J {advance[i]:g}: KT", kt, float(row["KT"]), EXPERIMENT, 0.05)
            yield relative_check(GROUP, f"P4119 J {advance[i]:g}: 10KQ", kq, float(row["10KQ"]), EXPERIMENT, 0.05)


def _peer_checks() -> Iterator[Check]:
    model = propeller_family(load_propeller(), MODEL_DIAMETER, 3)
    rows = [row for row in reference_rows("p4119_propan.csv") if float(row["J"]) <= 0.9]
    advance = np.array([float(row["J"]) for row in rows])
    result = lifting_line.solve(model, advance, SectionDrag.inviscid())
    source = "PROPAN panel code, rigid wake"
    for i, row in enumerate(rows):
        kt = float(result.thrust_coefficient[i])
        reference = float(row["KT_blade_inv"])
        yield absolute_check(GROUP, f"P4119 without viscosity J {advance[i]:g}: KT", kt, reference, source, 0.015)


def checks() -> Iterator[Check]:
    """All checks of the propeller's geometry and level 1; about a second."""
    parent = load_propeller()
    area = parent.blade_count * parent.expanded_area_ratio_per_blade
    yield Check(
        GROUP,
        "P4119 expanded area ratio from its table",
        area,
        0.607,
        "integral of the published chords (published 0.6)",
        "0.005 absolute",
        abs(area - 0.607) <= 0.005,
    )
    yield from labelled(HELD_OUT, _kernel_checks())
    yield from _bound_checks()
    yield from labelled(FITTED, _p4119_checks())
    yield from labelled(HELD_OUT, _peer_checks())
