"""The 3D view in a real browser: its camera does not cut the ship."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import session_of, small_case, wait_until

from explorer.app import Explorer
from explorer.server.security import free_port


@pytest.fixture(scope="module")
def explorer(tmp_path_factory):
    page = Explorer(
        small_case(generations=4, level1_generations=4, population=12),
        port=free_port("127.0.0.1", 8480),
        folder=tmp_path_factory.mktemp("runs"),
        workers=2,
    )
    page.services.runs.start()
    wait_until(lambda: page.state.picture.status == "finished", 90, "the small run")
    yield page
    page.close()


@pytest.fixture(scope="module")
def page(explorer, open_page):
    return open_page(explorer, 1366, 600)


def _seen(camera, points: np.ndarray) -> np.ndarray:
    """The largest distance from the middle of the picture, 1 at its edge."""
    backward = np.array(camera.position) - np.array(camera.look_at)
    backward /= np.linalg.norm(backward)
    right = np.cross(np.array(camera.up_direction), backward)
    right /= np.linalg.norm(right)
    local = points - np.array(camera.position)
    depth, half = -(local @ backward), np.tan(camera.fov / 2.0)
    across = local @ right / depth / half / camera.aspect
    up = local @ np.cross(backward, right) / depth / half
    return max(np.abs(across).max(), np.abs(up).max())


def test_the_whole_ship_is_in_the_picture_when_the_page_opens(explorer, page):
    session = session_of(explorer)
    scene = explorer.server.get_clients()[session.client_id].scene
    wait_until(lambda: scene.get_handle_by_name("/ship/topsides") is not None, 60, "the ship")
    ship = np.concatenate([scene.get_handle_by_name(f"/ship/{part}").vertices for part in ("underwater", "topsides")])
    camera = explorer.server.get_clients()[session.client_id].camera
    # the view between the docks, as the browser says; it may take some frames until the last dock stands
    wait_until(lambda: _seen(camera, ship) < 1.0, 30, "a camera that holds the ship")
    assert _seen(camera, ship) > 0.8  # and fills the view
