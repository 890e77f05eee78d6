"""The fitting script, on a table and a profile sampled from the shipped hull: it must find that hull again.

The reference offsets themselves are not part of the project; their deviations are recorded in assets/hulls/dtc.json.
"""

from __future__ import annotations

import numpy as np
import pytest

from hpsop_core.export.offsets import offsets_csv
from hpsop_core.geometry.hull.fit import FitSettings, Section, StationMap, fit_patch, free_net
from hpsop_core.geometry.hull.hull import Hull, load_parent_hull, parent_hull_from_dict
from tools.dtc_sections import DtcData
from tools.fit_dtc import fitted_hull

EDGES = {  # the profile's parts as edges of patches: (patch, v)
    "run": ("counter", 0.0), "boss_bottom": ("skeg", 0.0), "boss_top": ("skeg", 1.0), "keel": ("main", 0.0),
    "bulb_bottom": ("bulb", 0.0), "bulb_top": ("bulb", 1.0), "stem": ("topsides_bow", 0.0),
}  # fmt: skip


@pytest.fixture(scope="module")
def refitted(tmp_path_factory: pytest.TempPathFactory) -> Hull:
    hull = load_parent_hull().transform(355.0, 51.0, 14.5)
    folder = tmp_path_factory.mktemp("fit")
    stations = np.unique(np.concatenate([
        np.linspace(-6.7, 20.0, 75), np.linspace(20.0, 60.0, 28), np.linspace(60.0, 290.0, 40),
        np.linspace(290.0, 345.0, 30), np.linspace(345.0, 366.0, 50),
    ]))  # fmt: skip
    heights = np.concatenate([
        [0.001], np.arange(0.1, 1.0, 0.1), np.arange(1.0, 17.0, 0.25), np.arange(17.0, 34.0, 0.99)
    ])  # fmt: skip
    (folder / "offsets.csv").write_text(offsets_csv(hull, stations, heights), encoding="utf-8")
    lines = ["x_m,z_m,part"]
    for part, (patch, v) in EDGES.items():
        points = hull.patch_points(patch, 0.5 - 0.5 * np.cos(np.linspace(0, np.pi, 42)), np.array([v]))[:, 0]
        lines += [f"{x:.4f},{z:.4f},{part}" for x, _, z in points]
    stern = hull.patch_points("topsides_stern", np.linspace(0.0, 0.98, 12), np.array([0.0]))[:, 0]
    lines += [f"{x:.4f},{z:.4f},run" for x, _, z in stern]
    (folder / "profile.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    parent = parent_hull_from_dict(fitted_hull(DtcData.read(folder / "offsets.csv", folder / "profile.csv")))
    return parent.transform(355.0, 51.0, 14.5)


@pytest.mark.parametrize("patch", ["main", "counter", "skeg", "bulb"])
def test_the_script_finds_the_hull_that_was_sampled(refitted: Hull, patch: str) -> None:
    shipped = load_parent_hull().transform(355.0, 51.0, 14.5)
    u, v = np.linspace(0.02, 0.98, 41), np.linspace(0.0, 1.0, 21)
    fine = shipped.patch_points(patch, u, np.linspace(0.0, 1.0, 2001))
    again = refitted.patches[[p.name for p in refitted.patches].index(patch)]
    for section, x in zip(fine, fine[:, 0, 0], strict=True):
        points = again.evaluate(again.parameter(np.array([x])), v)[0]
        apart = np.hypot(*(points[:, None, 1:] - section[None, :, 1:]).transpose(2, 0, 1)).min(axis=1)
        # Single points at blunt ends up to 0.25 m, less than the waterlines are apart; 0.1 m in a whole section.
        assert float(apart.max()) < 0.25
        assert float(np.sqrt(np.mean(apart**2))) < 0.1


def test_hydrostatics_survive_the_round_trip(refitted: Hull) -> None:
    # Half of what the fit may be off the published ship: the second fit must not add as much again.
    assert refitted.hydrostatics.displaced_volume == pytest.approx(173_392.0, rel=1e-3)
    assert refitted.hydrostatics.wetted_surface == pytest.approx(22_040.0, rel=3.5e-3)


def test_rounding_of_an_edge_does_not_choose_the_shape() -> None:
    """Noise at the last digit stays noise; ends held or not by rounding moved the nets of skeg and bulb by 80 mm."""
    bulb = load_parent_hull().underwater["bulb"]
    stations = StationMap(bulb.knots_u, bulb.control_points[:, 0, 0])
    u = np.linspace(0.02, 0.98, 25)
    lines = bulb.evaluate(u, 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 25)))
    # Blunter than the surface that was sampled, so that holding the ends or not makes a difference.
    sections = [Section(float(line[0, 0]), line[:, 1:] + [0.0, 0.05] * np.sin(7.0 * line[:, :1])) for line in lines]
    nets = []
    for seed in range(12):
        edge = bulb.control_points[0] * (1.0 + 1e-15 * np.random.default_rng(seed).standard_normal((27, 3)))
        fixed_y, fixed_z = free_net(stations, bulb.knots_v)
        fixed_y[:, 0], fixed_y[:, -1] = 0.0, 0.0
        fit = fit_patch(sections, stations, bulb.knots_v, fixed_y, fixed_z, edge=edge, settings=FitSettings(rounds=1))
        nets.append(fit.surface.control_points)
    # 1e-15 of 360 m times the normal equations' condition, at most 1e7: below the micrometre that the file stores.
    assert max(float(np.max(np.abs(net - nets[0]))) for net in nets) < 1e-6
