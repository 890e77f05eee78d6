"""PFF, the propeller free format: head and cylindrical sections of a blade as propeller designers exchange them.

There is no public standard of it. What is written follows CAESES' introduction to it (in Chinese,
https://fangzhenxiu.com/post/429935): a head (diameter, hub, scale, area ratio, mass, inertia, power, blades, material,
radii, points a section, sense of rotation: 1 is clockwise seen from astern), and for each radius a block that begins
with ``* r/R``: ratio, radius and chord, then stations from 0 at the leading to 1 at the trailing edge with the
ordinates of suction and pressure side. The order of pitch, rake, skew, thickness and camber in a block is there in a
picture only and is stated by a comment here; no other program has read the file yet.
"""

from __future__ import annotations

import numpy as np

from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.geometry.propeller.sections import cosine_chord_fractions
from hpsop_core.geometry.propeller.surface import section_points

_POINTS = 41
_RADII = 21
# Where the chord has no length, there is no section to write.
_LAST = 0.9975


def propeller_pff(propeller: Propeller, title: str) -> str:
    """The blade's own sections, mm and degrees; closed trailing edges, as the solvers have them.

    Rake is positive downstream, without what skew induces; skew is positive against the sense of rotation. Ordinates
    are normal to the nose-tail line, back (suction side) and face.
    """
    table = propeller.table
    radii = np.append(np.linspace(table.hub_ratio, 0.95, _RADII - 2), [0.98, _LAST])
    sections = table.at(radii)
    fraction = cosine_chord_fractions(_POINTS)
    to_mm = 500.0 * propeller.diameter
    _, back = section_points(sections, fraction, True)
    _, face = section_points(sections, fraction, False)
    diameter = 1000.0 * propeller.diameter
    lines = [
        "PFF propeller free format",
        f"* {title}",
        "* lengths in mm, angles in degrees; not given: 0",
        "* propeller diameter, hub diameter, scale, expanded area ratio, blade mass",
        f"{diameter:.4f} {diameter * propeller.hub_ratio:.4f} 1.0 {propeller.expanded_area_ratio:.6f} 0.0",
        "* moment of inertia, shaft power, rate of revolutions",
        "0.0 0.0 0.0",
        "* blades, material, radii, points of a section, rotation (1: clockwise seen from astern)",
        f"{propeller.blade_count} - {len(radii)} {len(fraction)} 1",
    ]
    for row, radius in enumerate(radii):
        lines += [
            "* r/R, radius, chord",
            f"{radius:.6f} {radius * to_mm:.4f} {sections.chord_ratio[row] * diameter:.4f}",
            "* pitch, rake, skew, maximum thickness, maximum camber",
            f"{sections.pitch_ratio[row] * diameter:.4f} {sections.rake_ratio[row] * diameter:.4f} "
            f"{np.degrees(sections.skew[row]):.6f} "
            f"{sections.thickness_ratio[row] * sections.chord_ratio[row] * diameter:.4f} "
            f"{sections.camber_ratio[row] * sections.chord_ratio[row] * diameter:.4f}",
            "* station, back, face",
        ]
        lines += [
            f"{s:.6f} {b:.4f} {f:.4f}" for s, b, f in zip(fraction, back[row] * to_mm, face[row] * to_mm, strict=True)
        ]
    return "\n".join(lines) + "\n"
