"""Hull meshes: closed, outward, of fixed topology, and holding the volume of the hydrostatics."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.hull import Hull, load_parent_hull
from hpsop_core.geometry.hull.input import parent_hull_from_stl
from hpsop_core.geometry.hull.mesh import hull_mesh, hull_view_parts, underwater_mesh


def hulls() -> list[Hull]:
    parent = load_parent_hull()
    return [parent.transform(355.0, 51.0, 14.5), parent.transform(380.0, 47.0, 14.9, 0.73 * 380.0 * 47.0 * 14.9, -2.0)]


@pytest.mark.parametrize("which", [0, 1])
@pytest.mark.parametrize("resolution", ["drag", "view", "export"])
def test_closed_outward_and_of_the_right_volume(which: int, resolution: str) -> None:
    hull = hulls()[which]
    whole = hull_mesh(hull, resolution)  # type: ignore[arg-type]
    assert whole.is_watertight and whole.is_winding_consistent
    assert whole.volume > 0.0  # outward normals
    assert whole.body_count == 1
    under = underwater_mesh(hull, resolution)  # type: ignore[arg-type]
    assert under.is_watertight and under.is_winding_consistent
    # Flat facets cut corners: 0.2 % at every resolution, coarse ones too; 0.05 % where the mesh is fine enough to
    # speak about the hydrostatics.
    tolerance = 5e-4 if resolution == "export" else 2e-3
    hydro = hull.hydrostatics
    assert under.volume == pytest.approx(hydro.displaced_volume, rel=tolerance)
    assert under.center_mass[0] == pytest.approx(hydro.longitudinal_centre_of_buoyancy, abs=0.01)
    assert under.center_mass[1] == pytest.approx(0.0, abs=1e-9)
    assert under.center_mass[2] == pytest.approx(hydro.vertical_centre_of_buoyancy, abs=0.01)
    wet = whole.area_faces[whole.face_attributes["underwater"]].sum()
    assert wet == pytest.approx(hydro.wetted_surface, rel=2e-3)


def test_volume_converges() -> None:
    hull = hulls()[0]
    errors = [abs(underwater_mesh(hull, r).volume / hull.hydrostatics.displaced_volume - 1.0)
              for r in ("drag", "view", "export")]  # type: ignore[arg-type]  # fmt: skip
    assert errors[0] > errors[1] > errors[2]


@pytest.mark.parametrize("resolution", ["drag", "view"])
def test_topology_is_fixed_and_parts_are_complete(resolution: str) -> None:
    first, second = (hull_view_parts(hull, resolution) for hull in hulls())  # type: ignore[arg-type]
    assert set(first) == {"underwater", "topsides"}
    for name in first:
        assert np.array_equal(first[name][1], second[name][1])
        assert first[name][0].shape == second[name][0].shape
        assert np.all(np.isfinite(second[name][0]))
        assert first[name][1].min() == 0 and first[name][1].max() == len(first[name][0]) - 1
    assert float(first["underwater"][0][:, 2].max()) <= 14.5 + 1e-6
    assert float(first["topsides"][0][:, 2].min()) >= 14.5 - 1e-6
    assert float(first["topsides"][0][:, 2].max()) == pytest.approx(34.0, abs=1e-6)


def test_port_and_starboard_are_mirror_images() -> None:
    vertices = hull_mesh(hulls()[1], "drag").vertices
    port = {tuple(np.round(v, 6)) for v in vertices}
    assert all((x, -y if y else 0.0, z) in port for x, y, z in port)


def test_smooth_where_a_ship_is_smooth() -> None:
    """No folds at the seams: away from hard edges the normal turns little from one face to the next."""
    mesh = hull_mesh(hulls()[0], "view")
    middle = mesh.vertices[mesh.face_adjacency_edges].mean(axis=1)
    away = (np.abs(middle[:, 1]) > 0.15) & (middle[:, 2] < 33.8) & (middle[:, 0] > 9.4) & (middle[:, 0] < 365.8)
    # The hollow of the skeg and the stem turn by 48 degrees in one cell of the view mesh; a fold would pass 90.
    assert float(np.degrees(np.max(mesh.face_adjacency_angles[away]))) < 60.0


def test_unknown_resolution() -> None:
    with pytest.raises(InputError, match="resolution"):
        hull_mesh(hulls()[0], "huge")  # type: ignore[arg-type]


def test_a_closed_stl_comes_back_as_the_same_ship(tmp_path: Path) -> None:
    hull = hulls()[0]
    mesh = hull_mesh(hull, "view")
    mesh.apply_scale(1000.0)
    mesh.export(tmp_path / "ship.stl")
    again = parent_hull_from_stl(tmp_path / "ship.stl", "mm", 14.5, 355.0).hydrostatics
    own = hull.hydrostatics
    # Facets lose 0.06 %, slices at 121 stations and 33 heights the rest.
    assert again.displaced_volume == pytest.approx(own.displaced_volume, rel=3e-3)
    assert again.wetted_surface == pytest.approx(own.wetted_surface, rel=7e-3)
    assert again.longitudinal_centre_of_buoyancy == pytest.approx(own.longitudinal_centre_of_buoyancy, abs=0.15)
