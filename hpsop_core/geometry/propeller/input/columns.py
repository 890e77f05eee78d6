"""What the columns of a propeller's radial table are called."""

from __future__ import annotations

import re

COLUMNS = ("r_R", "c_D", "P_D", "skew_deg", "rake_D", "t_c", "f_c")
# Beside the seven: thickness over the diameter stands for t/c, skew in radians for degrees, full names for all.
THICKNESS_TO_DIAMETER = "t_D"
SKEW_RADIANS = "skew_rad"
_NAMES = {
    "r_R": ("r_r", "rr", "r", "x", "radius", "radius_ratio", "r_over_r", "r_rt", "xr"),
    "c_D": ("c_d", "cd", "chord", "chord_d", "chord_ratio", "c_over_d", "xchd", "chord_diameter", "l_d"),
    "P_D": ("p_d", "pd", "pitch", "pitch_d", "pitch_ratio", "p_over_d", "pitch_diameter", "xpitch"),
    "skew_deg": (
        "skew_deg",
        "skew",
        "theta_s",
        "skew_degrees",
        "skew_angle",
        "skew_angle_deg",
        "thetas",
        "skew_theta_s",
    ),
    SKEW_RADIANS: ("skew_rad", "skew_radians"),
    "rake_D": ("rake_d", "rake", "rake_ratio", "xs_d", "x_s_d", "xr_d", "zr_d", "ig_d", "il_d", "rake_over_d", "im_d"),
    "t_c": (
        "t_c",
        "tc",
        "t0_c",
        "thickness",
        "thickness_ratio",
        "tmax_c",
        "t_max_c",
        "t_over_c",
        "thickness_chord",
        "to_c",
    ),
    THICKNESS_TO_DIAMETER: ("t_d", "t0_d", "td", "tmax_d", "t_max_d", "t_over_d", "thickness_d", "to_d", "e_d"),
    "f_c": (
        "f_c",
        "fc",
        "f0_c",
        "camber",
        "camber_ratio",
        "fmax_c",
        "f_max_c",
        "f_over_c",
        "m_c",
        "fo_c",
        "camber_chord",
    ),
}
_NO_RATIOS = ("m", "mm", "cm", "in", "inch", "ft", "%", "percent", "deg", "degree", "degrees", "°", "rad")
# What the line of names is known by.
MARKS = ("r_R", "c_D")


def column_of(title: str) -> str | None:
    """The column that a title stands for: one of ``COLUMNS``, ``THICKNESS_TO_DIAMETER``, ``SKEW_RADIANS`` or None."""
    bare = re.sub(r"[\[(].*?[\])]", lambda unit: " rad" if "rad" in unit.group(0).lower() else "", title)
    name = re.sub(r"[^a-z0-9]+", "_", bare.strip().lower()).strip("_")
    if title.strip() in COLUMNS:
        return title.strip()
    return next((column for column, names in _NAMES.items() if name in names), None)


def wrong_unit(title: str) -> str | None:
    """The unit in brackets that a ratio cannot have, such as the mm of "chord [mm]", or None.

    A pitch in metres lies within the limits of P/D: the title alone tells it.
    """
    column = column_of(title)
    bracket = re.search(r"[\[(]\s*([^\])]*?)\s*[\])]", title)
    if column is None or column in ("skew_deg", SKEW_RADIANS) or bracket is None:
        return None
    return bracket.group(1) if bracket.group(1).lower() in _NO_RATIOS else None
