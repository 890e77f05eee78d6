"""The shipped patches are what the script of the project makes of the shipped offsets."""

from __future__ import annotations

import json
from importlib.resources import as_file

import numpy as np

from hpsop_core.assets import asset_path, read_asset_text
from hpsop_core.geometry.hull_fit_dtc import DtcData, fitted_hull


def test_the_fit_reproduces_the_shipped_hull() -> None:
    offsets, profile = (asset_path("reference", name) for name in ("dtc_offsets_fine.csv", "dtc_profile.csv"))
    with as_file(offsets) as table, as_file(profile) as lines:
        made = fitted_hull(DtcData.read(table, lines))
    shipped = json.loads(read_asset_text("hulls", "dtc.json"))
    assert [patch["name"] for patch in made["patches"]] == [patch["name"] for patch in shipped["patches"]]
    for one, other in zip(made["patches"], shipped["patches"], strict=True):
        # Least squares on another machine's BLAS: rounding times the condition of the normal equations.
        difference = np.abs(np.array(one["control_points"]) - np.array(other["control_points"]))
        assert float(np.max(difference)) < 1e-3
    assert made["girth"].keys() == shipped["girth"].keys()
