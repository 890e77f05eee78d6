"""The pressure on the blades at an advance coefficient, by level 2's panels."""

from __future__ import annotations

import math

import numpy as np

from explorer.scene.pressure import PressureMap
from explorer.scene.transfer import transferred
from hpsop_core.geometry.propeller.mesh import propeller_view_parts
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.geometry.propeller.surface import rotate_blade, to_cartesian
from hpsop_core.hydro.blade_panels.solver import BladePanelSettings, blade_panel_model

# A little finer than the optimiser's grid: here the pressures are looked at, not the circulation.
_SETTINGS = BladePanelSettings(chordwise_panels=40, radial_panels=16)
_TO_SHIP = np.array([-1.0, -1.0, 1.0])


def blade_pressure(propeller: Propeller, advance_coefficient: float) -> PressureMap:
    """(p - p0)/(1/2 rho (V_A^2 + (0.7 pi n D)^2)) on all blades, in ship axes about the hub's centre.

    Raises:
        SolverFailure: the panels cannot represent the blade, or the condition does not converge.
    """
    model = blade_panel_model(propeller, _SETTINGS, viscous=True)
    pressure = model.blade_pressure(model.condition(advance_coefficient))
    # n = R = 1, so V_A = 2 J and the speed of the section at 0.7 R is 1.4 pi
    coefficient = pressure / (0.5 * ((2.0 * advance_coefficient) ** 2 + (1.4 * math.pi) ** 2))
    grid = model.grid
    nodes = to_cartesian(grid.x, grid.radius_edges[None, :], grid.theta) * (0.5 * propeller.diameter)
    total = np.zeros(nodes.shape[:2])
    weight = np.zeros(nodes.shape[:2])
    rows, columns = coefficient.shape
    for i in (0, 1):
        for j in (0, 1):
            total[i : i + rows, j : j + columns] += coefficient
            weight[i : i + rows, j : j + columns] += 1.0
    value = (total / weight).ravel()
    index = np.arange(nodes.shape[0] * nodes.shape[1]).reshape(nodes.shape[:2])
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    # one sense of rotation for the whole outline: outwards, whichever way the grid runs
    corners = nodes.reshape(-1, 3)[faces]
    if float(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum()) < 0.0:
        faces = faces[:, ::-1]
    blades = [
        rotate_blade(nodes, blade, propeller.blade_count).reshape(-1, 3) for blade in range(propeller.blade_count)
    ]
    shown, shown_faces = propeller_view_parts(propeller, "view")["blades"]
    carried = transferred(
        np.concatenate(blades),
        np.concatenate([faces + k * index.size for k in range(propeller.blade_count)]),
        np.tile(value, propeller.blade_count),
        shown,
        shown_faces,
    )
    note = f"level 2, J {advance_coefficient:.3f}, on ½ρ(V<sub>A</sub>² + (0.7πnD)²)"
    return PressureMap(shown * _TO_SHIP, shown_faces, carried, note)
