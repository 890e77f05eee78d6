"""Meshes, surfaces and placement of the propeller."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from hpsop_core.errors import InputError
from hpsop_core.geometry.clearance import (
    baseline_clearance,
    propeller_clearance,
    propeller_placement,
    swept_points,
)
from hpsop_core.geometry.hull.hull import load_parent_hull
from hpsop_core.geometry.hull.mesh import underwater_mesh
from hpsop_core.geometry.nurbs import NurbsSurface
from hpsop_core.geometry.propeller import closed
from hpsop_core.geometry.propeller.hub import hub_of
from hpsop_core.geometry.propeller.mesh import propeller_mesh, propeller_view_parts
from hpsop_core.geometry.propeller.nurbs import blade_nurbs, hub_nurbs, propeller_surfaces
from hpsop_core.geometry.propeller.propeller import Propeller, load_propeller, propeller_family
from hpsop_core.geometry.propeller.sections import cosine_chord_fractions, half_thickness
from hpsop_core.geometry.propeller.surface import blade_points
from hpsop_core.hydro.blade_panels.grid import blade_grid, to_propeller_axes


@pytest.mark.parametrize("blades", [2, 3, 5, 7])
@pytest.mark.parametrize("area", [0.3, 0.607, 1.1])
@pytest.mark.parametrize("resolution", ["drag", "view", "export"])
def test_meshes_are_closed_with_outward_normals(blades: int, area: float, resolution: str) -> None:
    mesh = propeller_mesh(propeller_family(load_propeller(), 9.0, blades, 1.0, area), resolution)  # type: ignore[arg-type]
    assert mesh.is_watertight and mesh.is_winding_consistent
    # one body without handles: blades and hub are joined
    assert mesh.euler_number == 2
    assert mesh.volume > 0.0
    assert mesh.area_faces.min() > 0.0
    assert np.hypot(mesh.vertices[:, 1], mesh.vertices[:, 2]).max() == pytest.approx(4.5, rel=1e-9)


@pytest.mark.parametrize("blades", [3, 7])
def test_volume_converges_with_the_resolution(blades: int) -> None:
    propeller = propeller_family(load_propeller(), 9.0, blades)
    volume = {name: propeller_mesh(propeller, name).volume for name in ("drag", "view", "export")}  # type: ignore[arg-type]
    # chords inside a curved surface: O(h^2), so view is about (24/60)^2 of drag's error away; it is a picture
    assert volume["view"] == pytest.approx(volume["export"], rel=0.01)
    assert volume["drag"] == pytest.approx(volume["export"], rel=0.10)


def test_topology_is_fixed_and_size_scales() -> None:
    parent = load_propeller()
    first = propeller_view_parts(propeller_family(parent, 9.0, 5, 1.0, 0.5))
    second = propeller_view_parts(propeller_family(parent, 7.0, 5, 1.05, 1.0))
    for name in ("blades", "hub"):
        assert np.array_equal(first[name][1], second[name][1])
        assert first[name][0].shape == second[name][0].shape
    small = propeller_mesh(propeller_family(parent, 1.0, 4))
    large = propeller_mesh(propeller_family(parent, 9.0, 4))
    assert np.allclose(large.vertices, 9.0 * small.vertices, rtol=1e-12, atol=1e-12)


def test_blades_are_alike() -> None:
    """A turn by one blade maps the propeller on itself."""
    mesh = propeller_mesh(propeller_family(load_propeller(), 9.0, 5))
    turn = trimesh.transformations.rotation_matrix(2.0 * np.pi / 5.0, [1.0, 0.0, 0.0])
    turned = trimesh.transform_points(mesh.vertices, turn)
    distance = trimesh.proximity.ProximityQuery(mesh).vertex(turned)[0]
    assert distance.max() < 1e-9


def test_right_handed() -> None:
    """Seen from astern it turns clockwise: the top blade goes to starboard, leading edge first."""
    sections = propeller_family(load_propeller(), 2.0, 3).table.at(np.array([0.7]))
    back, face = (blade_points(sections, np.array([0.0, 0.5, 1.0]), side) for side in (True, False))
    leading, trailing = back[0, 0], back[0, 2]
    # x downstream, y to starboard, z up: the top blade's leading edge is upstream and to starboard
    assert leading[0] < trailing[0] and leading[1] > trailing[1] and leading[2] > 0.5
    # the suction side looks upstream
    assert back[0, 1, 0] < face[0, 1, 0]
    # advancing one pitch while turning once: the trailing edge lies on the helix of the leading edge
    turned = np.arctan2(leading[1], leading[2]) - np.arctan2(trailing[1], trailing[2])
    assert (trailing[0] - leading[0]) / turned == pytest.approx(2.0 * 1.0839 / (2.0 * np.pi), rel=1e-6)


def test_normals_of_back_and_face() -> None:
    """At mid-chord of the top blade: against the helix on the back, with it on the face."""
    propeller = propeller_family(load_propeller(), 2.0, 3)
    mesh = propeller_mesh(propeller, "view")
    pitch = np.arctan2(1.0839, np.pi * 0.7)
    # theta is y at the top: n = -cos(phi) x - sin(phi) theta
    suction = np.array([-np.cos(pitch), -np.sin(pitch), 0.0])
    sections = propeller.table.at(np.array([0.7]))
    for back, sign in ((True, 1.0), (False, -1.0)):
        points = blade_points(sections, np.array([0.5]), back)
        nearest = int(np.argmin(np.linalg.norm(mesh.triangles_center - points[0, 0], axis=1)))
        assert sign * float(mesh.face_normals[nearest] @ suction) > 0.97


def test_roots_that_meet_are_refused() -> None:
    thick = propeller_family(load_propeller(), 9.0, 9, 1.0, 0.6)
    table = thick.table
    fat = replace(thick, table=replace(table, thickness_ratio=np.minimum(4.0 * table.thickness_ratio, 0.9)))
    with pytest.raises(InputError, match="roots of neighbouring blades meet"):
        propeller_mesh(fat)


@pytest.mark.parametrize(("blades", "area"), [(3, 0.607), (7, 0.607), (3, 1.0)])
def test_blade_nurbs_keeps_the_sections(blades: int, area: float) -> None:
    propeller = propeller_family(load_propeller(), 9.0, blades, 1.0, area)
    blade = blade_nurbs(propeller)
    # 0.1 mm on each metre of the diameter is finer than ISO 484 class S asks of a blade's sections
    assert blade.largest_deviation < 1e-4 * 9.0
    points = hub_nurbs(propeller).evaluate(np.linspace(0.0, 1.0, 40), np.linspace(0.0, 1.0, 33))
    radius = np.hypot(points[..., 1], points[..., 2])
    # conics: no error but rounding (whose root stands at the pole of the cap)
    outline = 4.5 * hub_of(propeller).radius_at(points[:, 0, 0] / 4.5)
    assert np.allclose(radius, outline[:, None], atol=1e-6)


@pytest.mark.parametrize("skew_degrees", [0.0, 40.0])
def test_panels_stand_on_the_surface_with_its_edges_closed(
    skew_degrees: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    parent = load_propeller()
    table = replace(parent, skew=np.radians(skew_degrees) * np.clip((parent.radius_ratio - 0.35) / 0.65, 0.0, 1.0) ** 2)
    propeller = propeller_family(table, 9.0, 4)
    grid = blade_grid(propeller, 24, 10)
    corners = to_propeller_axes(grid.surface.corners)
    np.testing.assert_array_equal(corners[0], corners[-1])
    # The table's own sections, from which the panels are twice removed. Inside 0.9 R: beyond, the surface's tip has
    # a chord of its own.
    fractions = cosine_chord_fractions(13)
    face, back = (blade_points(propeller.table.at(grid.radius_edges[:-3]), fractions, s) for s in (False, True))
    own = np.concatenate([face[:, ::-1], back[:, 1:]], axis=1).transpose(1, 0, 2)
    # 2 of R are 1 of D: the surface's own bound
    assert np.max(np.linalg.norm(corners[:, :-3] - own, axis=2)) < 2.0 * 1e-4
    # A surface that is moved takes its panels along, so they stand on nothing else.
    true = closed.blade_surface

    def moved(propeller: Propeller) -> NurbsSurface:
        surface = true(propeller)
        return replace(surface, control_points=surface.control_points + np.array([0.01, 0.0, 0.0]))

    monkeypatch.setattr(closed, "blade_surface", moved)
    elsewhere = to_propeller_axes(blade_grid(propeller, 24, 10).surface.corners)
    np.testing.assert_allclose(elsewhere, corners + np.array([0.01, 0.0, 0.0]), atol=1e-12)


@pytest.mark.parametrize(("blades", "area"), [(2, 1.1), (3, 1.1), (3, 1.08), (5, 0.607)])
def test_fine_panels_of_back_and_face_do_not_coincide(blades: int, area: float) -> None:
    """At the nose of wide tips the table's thickness is less than the surface's own exactness."""
    propeller = propeller_family(load_propeller(), 9.0, blades, 1.0, area)
    grid = blade_grid(propeller, 80, 24)
    apart = np.linalg.norm(grid.surface.corners[1:40, :-1] - grid.surface.corners[79:40:-1, :-1], axis=2)
    sections = propeller.table.at(grid.radius_edges[:-1])
    shape = half_thickness(cosine_chord_fractions(41))[39:0:-1, None]
    assert np.min(apart / (4.0 * sections.thickness_ratio * sections.chord_ratio * shape)) > 0.45


def test_surfaces_stand_where_the_mesh_stands() -> None:
    hull = load_parent_hull().transform(355.0, 51.0, 14.5)
    propeller = propeller_family(load_propeller(), 9.0, 4)
    surfaces = propeller_surfaces(propeller, propeller_placement(hull, propeller))
    faces = ("back", "face", "trailing edge", "tip", "root")
    assert set(surfaces) == {f"blade {k} {face}" for k in range(1, 5) for face in faces} | {"hub", "hub forward face"}
    mesh = propeller_mesh(propeller, "export")
    mesh.apply_transform(propeller_placement(hull, propeller))
    for name, surface in surfaces.items():
        points = surface.evaluate(np.linspace(0.3, 1.0, 9), np.linspace(0.0, 1.0, 9)).reshape(-1, 3)
        # vertices of the export mesh are at most some 0.15 m apart, but the hub has none under the roots, 0.6 m
        # thick, nor between rim and axis of its forward face, 0.77 m
        distance = np.min(np.linalg.norm(mesh.vertices[:, None] - points, axis=2), axis=0)
        assert distance.max() < (0.4 if "hub" in name or "root" in name else 0.15), name


def test_hub_stands_on_the_boss() -> None:
    hull = load_parent_hull().transform(355.0, 51.0, 14.5)
    propeller = propeller_family(load_propeller(), 9.0, 5)
    matrix = propeller_placement(hull, propeller)
    assert np.linalg.det(matrix[:3, :3]) == pytest.approx(1.0)
    mesh = propeller_mesh(propeller)
    mesh.apply_transform(matrix)
    assert mesh.volume > 0.0
    # forward face on the end of the boss, axis at the shaft's height (the tip line's middle is not quite at the top)
    assert mesh.bounds[1, 0] == pytest.approx(9.2, abs=1e-9)
    assert mesh.vertices[:, 2].max() == pytest.approx(5.0 + 4.5, abs=1e-5)
    assert hub_of(propeller).face_x < 0.0


def test_tip_clearance() -> None:
    hull = load_parent_hull().transform(355.0, 51.0, 14.5)
    parent = load_propeller()
    clearances = [propeller_clearance(hull, propeller_family(parent, d, 3)) for d in (7.0, 9.0, 14.0, 20.0)]
    assert clearances[0] > 0.0 and clearances[1] > 0.0
    assert clearances[3] < 0.0
    # brute force against a mesh of the hull that knows nothing of the patches' parameters
    propeller = propeller_family(parent, 9.0, 3)
    mesh = underwater_mesh(hull, "export")
    near = mesh.vertices[(mesh.vertices[:, 0] < 25.0) & (mesh.vertices[:, 2] < 14.49)]
    swept = swept_points(hull, propeller)
    nearest = min(float(np.min(np.linalg.norm(near - point, axis=1))) for point in swept)
    # two samplings 0.1 to 0.4 m apart
    assert clearances[1] == pytest.approx(nearest, abs=0.05)
    assert baseline_clearance(hull, propeller) == pytest.approx(0.5)


@pytest.mark.parametrize("diameter", [5.0, 9.0, 11.0])
def test_the_nearest_point_of_the_hull_is_never_passed_over(diameter: float) -> None:
    hull = load_parent_hull().transform(340.0, 52.0, 14.0, 170000.0, 1.5)
    propeller = propeller_family(load_propeller(), diameter, 5)
    parameters = np.linspace(0.0, 1.0, 48)
    patches = [patch.evaluate(parameters, parameters).reshape(-1, 3) for patch in hull.patches if patch.underwater]
    away = swept_points(hull, propeller)[:, None] - np.concatenate(patches)
    assert propeller_clearance(hull, propeller) == pytest.approx(np.sqrt((away**2).sum(axis=-1).min()), rel=1e-12)
