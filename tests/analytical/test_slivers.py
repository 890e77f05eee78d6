"""Slivers of a mesh go; its body, its regions and its sharp edges stay."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from hpsop_core.export.slivers import LEAST_ANGLE, least_angles, without_slivers


def box_with_slivers() -> trimesh.Trimesh:
    """A cube of 1 m whose faces are grids with two rows 0.1 mm apart: needles and, next to them, right corners."""
    mesh = trimesh.creation.box()
    mesh = mesh.subdivide().subdivide()
    rng = np.random.default_rng(1)
    vertices, faces = np.array(mesh.vertices), np.array(mesh.faces)
    for face in rng.choice(len(faces), 12, replace=False):
        # a vertex a hair from a corner: three faces for one, two of them slivers
        weights = np.array([1.0 - 2e-4, 1e-4, 1e-4])
        vertices = np.concatenate([vertices, (weights @ vertices[faces[face]])[None]])
        a, b, c = faces[face]
        new = len(vertices) - 1
        faces[face] = [a, b, new]
        faces = np.concatenate([faces, [[b, c, new], [c, a, new]]])
    return trimesh.Trimesh(vertices, faces, process=False)


def test_slivers_go_and_the_body_stays() -> None:
    mesh = box_with_slivers()
    assert np.min(least_angles(mesh.vertices, mesh.faces)) < 0.1 * LEAST_ANGLE
    side = np.argmax(np.abs(mesh.face_normals), axis=1)
    vertices, faces, regions = without_slivers(np.array(mesh.vertices), np.array(mesh.faces), side, np.radians(35.0))
    clean = trimesh.Trimesh(vertices, faces, process=False)
    assert clean.is_watertight and clean.is_winding_consistent and clean.euler_number == 2
    assert np.min(least_angles(vertices, faces)) > np.radians(1.0)
    # flat sides and kept edges: the cube itself, to rounding
    assert clean.volume == pytest.approx(1.0, rel=1e-9)
    assert np.array_equal(regions, np.argmax(np.abs(clean.face_normals), axis=1))


def test_a_triangle_of_no_area_has_no_angle() -> None:
    vertices = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    angles = least_angles(vertices, np.array([[0, 1, 2], [0, 1, 3]]))
    assert angles[0] == 0.0 and angles[1] == pytest.approx(np.pi / 4.0)
