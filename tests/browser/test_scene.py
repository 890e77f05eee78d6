"""The 3D view in a real browser: its camera does not cut the ship."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import press, session_of, small_case, wait_until
from PIL import Image

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
    return open_page(explorer, 1366, 600, drawn=True)


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
    # without graphics hardware these cost seconds: a light made of a photograph, and pictures larger than they are seen
    assert page.evaluate("() => window.photographs") == 0
    assert page.evaluate("() => document.documentElement.classList.contains('hpsop-stands')")
    assert page.evaluate("() => document.querySelector('canvas[data-engine]').width") > 300


def test_screenshot_downloads_a_picture(explorer, page):
    with page.expect_download() as waiting:
        press(page, "screenshot")
    name = waiting.value.suggested_filename
    assert name.startswith("hpsop-")
    with Image.open(waiting.value.path()) as picture:
        assert picture.format == "PNG"
        assert picture.size == tuple(session_of(explorer).size)
        assert len(picture.convert("RGB").getcolors(maxcolors=2**24)) > 50  # a ship, not one colour


def test_nothing_is_drawn_while_nothing_moves(explorer, page):
    """viser draws a frame a second as a safety net; in software each holds a small machine's cores (frames.js)."""
    count = """() => new Promise((done) => {
        const context = document.querySelector("canvas[data-engine]").getContext("webgl2");
        const draw = context.drawElements;
        const moments = new Set();
        context.drawElements = function (...all) {
            moments.add(Math.round(performance.now() / 500));
            draw.apply(this, all);
        };
        setTimeout(() => { context.drawElements = draw; done(moments.size); }, 2400);
    })"""
    # what the opening still had to draw may come first
    assert min(page.evaluate(count) for _ in range(2)) <= 1


def test_views_make_room_hide_the_hull_and_are_saved_at_any_size(explorer, page):
    session = session_of(explorer)
    client = explorer.server.get_clients()[session.client_id]
    press(page, "camera", "profile")
    # the panels are closed, and the toolbar still answers
    wait_until(lambda: session.options.wide and client.camera.aspect > 2.0, 60, "a wide view")
    press(page, "camera", "backs")
    wait_until(lambda: not session.options.wide and client.camera.aspect < 1.5, 60, "the panels")

    def hull_seen():
        # a ship that is looked at closely is another mesh
        hull = client.scene.get_handle_by_name("/ship/underwater")
        return hull is not None and hull.visible

    wait_until(lambda: not hull_seen() and client.camera.position[0] > 5.0, 30, "a view of the backs")
    press(page, "camera", "perspective")
    wait_until(hull_seen, 30, "the hull")
    press(page, "switch", "picture_open")
    for side, pixels in (("width", 640), ("height", 360)):
        box = page.locator(f'[data-set="picture_side"][data-arg="{side}"]')
        box.fill(str(pixels))
        box.press("Tab")
        wait_until(lambda side=side, pixels=pixels: getattr(session.options, f"picture_{side}") == pixels, 20, side)
    press(page, "switch", "picture_transparent")
    wait_until(lambda: session.options.picture_transparent, 20, "a clear background")
    with page.expect_download() as waiting:
        press(page, "screenshot")
    picture = Image.open(waiting.value.path())
    assert picture.size == (640, 360) and picture.mode == "RGBA"
    alpha = np.asarray(picture)[..., 3]
    # no sky in the upper corners, a ship in the middle
    assert alpha[0, 0] == alpha[0, -1] == 0 and alpha[180, 320] == 255


def test_the_tour_is_offered_once_and_the_help_tells_what_labels_mean(explorer, open_page):
    page = open_page(explorer, 1366, 600, toured=False)
    tour = page.locator(".hpsop-overlay-tour [data-point]")
    tour.wait_for()
    # by the keyboard: the next step's button has the focus
    page.locator(".card.tour [data-next]").focus()
    page.keyboard.press("Enter")
    page.locator('.hpsop-overlay-tour [data-point="svg[data-chart=pareto]"]').wait_for()
    page.wait_for_function("() => 'next' in document.activeElement.dataset")
    press(page, "tour", "end")
    tour.wait_for(state="detached")
    press(page, "help")
    page.locator('.hpsop-overlay-help [data-word="open_water_efficiency"]').wait_for()
    page.keyboard.press("Escape")
    page.locator(".hpsop-overlay-help [data-word]").first.wait_for(state="detached")
    page.wait_for_function("() => document.activeElement.dataset.act === 'help'")
    label = page.locator("label[for]", has_text="L/B").first
    label.dispatch_event("pointerover")
    assert label.get_attribute("title") == "length over breadth, L/B"
    # what the next load of this browser says of itself
    assert page.evaluate("window.hpsop.toured()") is True
