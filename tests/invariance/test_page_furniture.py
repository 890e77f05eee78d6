"""What is drawn for looks: it stays on the ship, follows it, and keeps its topology while a design is dragged."""

from __future__ import annotations

import numpy as np
import pytest

from explorer.scene.camera import preset
from explorer.scene.geometry import SceneGeometry, scene_geometry
from explorer.scene.pressure import zero_line
from hpsop_core.case.case import Case, load_case
from hpsop_core.evaluation.shapes import design_hull
from tests.two_speeds import TWO_SPEEDS

BROADER = {"length_to_breadth": 6.4, "breadth_to_draft": 3.7, "draft": 14.1, "diameter": 9.3}


@pytest.fixture(scope="module")
def case() -> Case:
    return load_case(TWO_SPEEDS)


@pytest.fixture(scope="module")
def ships(case: Case) -> tuple[SceneGeometry, SceneGeometry]:
    """The initial design and a broader one."""
    variables = case.initial.variables
    return scene_geometry(case, variables), scene_geometry(case, variables.replaced(BROADER))


def test_the_boxes_stand_on_the_deck_of_every_design(ships):
    for ship in ships:
        low, high = (ship.boxes.centres + half * ship.boxes.sides for half in (-0.5, 0.5))
        assert (ship.boxes.sides > 0.0).all()
        assert np.abs(high[:, 1] + low[:, 1]).max() <= ship.breadth
        assert high[:, 1].max() <= 0.505 * ship.breadth and low[:, 1].min() >= -0.505 * ship.breadth
        assert low[:, 0].min() > 0.0 and high[:, 0].max() < ship.length
        # nothing sinks into the deck, whose lowest edge is this
        assert low[:, 2].min() >= ship.deck[0][:, 2].min() - 1e-6


def test_a_model_of_the_form_is_furnished_by_its_own_size(case: Case, ships):
    model = case.replaced("initial", length=6.0, breadth=6.0 * 51.0 / 355.0, draft=6.0 * 14.5 / 355.0, diameter=0.152)
    small, ship = scene_geometry(model, model.initial.variables), ships[0]
    scale = 355.0 / 6.0
    high = [(item.boxes.centres + 0.5 * item.boxes.sides)[:, 2].max() for item in (small, ship)]
    # as high over the keel as the large ship's, in parts of the length, within what two models' scales differ
    assert 0.5 < scale * high[0] / high[1] < 2.0
    # and the waterline lies as near to the hull
    assert scale * small.waterline[:, 1].max() == pytest.approx(ship.waterline[:, 1].max(), rel=1e-6)


def test_paint_moves_with_the_hull_and_keeps_its_faces(ships):
    for part in ("underwater", "topsides", "deck", "boot_top", "rudder"):
        first, second = (getattr(ship, part) for ship in ships)
        assert np.array_equal(first[1], second[1]) and first[0].shape == second[0].shape
        assert np.abs(first[0] - second[0]).max() > 0.1


def test_a_ship_seen_as_a_whole_has_a_third_of_the_triangles_in_the_same_place(case: Case, ships):
    far = scene_geometry(case, case.initial.variables, near=False)
    parts = ("underwater", "topsides", "blades", "hub")
    assert sum(len(getattr(far, part)[1]) for part in parts) < 0.4 * sum(
        len(getattr(ships[0], part)[1]) for part in parts
    )
    for part in (*parts, "deck"):
        (first, _), (second, _) = getattr(far, part), getattr(ships[0], part)
        assert np.abs(first.min(axis=0) - second.min(axis=0)).max() < 0.002 * far.length
        assert np.abs(first.max(axis=0) - second.max(axis=0)).max() < 0.002 * far.length


@pytest.mark.parametrize("near", [True, False])
def test_walls_and_deck_are_the_topsides_and_nothing_twice(case: Case, ships, near: bool):
    for ship in ships if near else (scene_geometry(case, case.initial.variables, near),):
        assert len(ship.deck[1]) > 100
        assert ship.deck[0][:, 2].min() > 0.5 * (ship.draft + ship.deck[0][:, 2].max())
        assert ship.topsides[0][:, 2].min() == pytest.approx(ship.draft)


def test_the_boot_top_and_the_marks_lie_on_the_hull(case: Case, ships):
    hull = design_hull(case, case.initial.variables)
    ship = ships[0]
    stations = np.array([0.3, 0.5, 0.7]) * hull.length
    sections = hull.sections(stations)
    band = ship.boot_top[0]
    for x, parts in zip(stations, sections, strict=True):
        line = np.concatenate(parts)
        near = band[(np.abs(band[:, 0] - x) < 0.02 * hull.length) & (band[:, 1] > 0.0)]
        assert len(near)
        wanted = np.interp(near[:, 2], line[:, 2], line[:, 1])
        # a fifth of a per cent of the breadth off the surface, plus what the sides taper over the search's reach
        assert np.abs(near[:, 1] - wanted).max() < 0.01 * hull.breadth
    marks = ship.marks[0]
    amidships = marks[np.abs(marks[:, 0] - 0.5 * hull.length) < 0.01 * hull.length]
    wanted = np.interp(amidships[:, 2], np.concatenate(sections[1])[:, 2], np.concatenate(sections[1])[:, 1])
    off = np.abs(amidships[:, 1]) - wanted
    assert off.min() > 0.0 and off.max() < 0.01 * hull.breadth
    # read from port and from starboard: mirror images would swap 6 and 9
    assert len(amidships[amidships[:, 1] > 0.0]) == len(amidships[amidships[:, 1] < 0.0])


def test_the_rudder_is_clear_of_the_propeller_and_below_the_hull(ships):
    for ship in ships:
        vertices = ship.rudder[0]
        assert vertices[:, 0].max() < ship.propeller_position[0] - 0.2 * ship.diameter
        assert vertices[:, 2].min() >= 0.0 and vertices[:, 2].max() < ship.draft
        assert np.abs(vertices[:, 1]).max() < 0.1 * ship.diameter


def test_a_zero_line_is_where_a_linear_field_passes_through_zero():
    place = np.linspace(0.0, 1.0, 5)
    x, y = (grid.ravel() for grid in np.meshgrid(place, place, indexing="ij"))
    vertices = np.column_stack([x, y, np.zeros_like(x)])
    index = np.arange(25).reshape(5, 5)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]))
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    line = zero_line(vertices, faces, x + 0.5 * y - 0.6)
    assert np.abs(line[..., 0] + 0.5 * line[..., 1] - 0.6).max() < 1e-12
    # from edge to edge in one piece: x from 0.1 to 0.6 while y goes from 1 to 0
    assert np.linalg.norm(line[:, 1] - line[:, 0], axis=1).sum() == pytest.approx(np.hypot(0.5, 1.0))
    # lifted towards the side that the faces look to, a thousandth of the size
    assert line[..., 2] == pytest.approx(1e-3)
    assert len(zero_line(vertices, faces, x + 1.0)) == 0


@pytest.mark.parametrize("view", ["perspective", "below", "profile", "plan", "body", "propeller", "backs"])
def test_a_presets_orientation_looks_where_the_preset_looks(view: str):
    pose = preset(view, 350.0, 50.0, 14.0, (7.0, 5.0), 9.0, 1.5)
    w, x, y, z = pose.orientation()
    # the camera's own z axis, turned by the quaternion
    axis = np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
    wanted = np.array(pose.look_at) - np.array(pose.position)
    assert axis == pytest.approx(wanted / np.linalg.norm(wanted), abs=1e-9)
    if view == "backs":
        assert wanted[0] < 0.0  # from ahead
    if view == "propeller":
        assert wanted[0] > 0.0  # from astern
