"""3D Tiles in CesiumJS, in headless Chromium: Gaussians where they are and in their colours, and panels to pick."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from reconstruction.exports.tiles3d import DEFAULT, TilesOptions, write_tiles
from reconstruction.splats.harmonic_colour import display_colours
from tests import foreign
from tests.reconstruction.exports.web_browser import chromium
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

pytestmark = pytest.mark.slow

CESIUM = foreign.HERE / "node_modules" / "cesium" / "Build" / "Cesium"

FOCAL_PX = 320.0 / np.tan(np.radians(30.0))
"""Of CesiumJS's 60 degrees across 640 pixels."""

RED, GREEN, BLUE, WHITE = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 1.0, 1.0)


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    if not CESIUM.is_dir():
        pytest.skip("CesiumJS is not installed: make foreign")
    with chromium(tmp_path_factory.mktemp("chromium")) as found:
        found._call("POST", "/timeouts", {"script": 240_000})
        yield found


@pytest.fixture
def serve(tmp_path, browser):
    """Writes tiles of a scene, and opens the page with layers of them."""
    with foreign.served(tmp_path) as address:

        def shown(scene, *layers, options=DEFAULT):
            write_tiles(scene, tmp_path, options)
            browser.visit(f"{address}/show_cesium.html")
            browser.run("await show(...arguments)", *(f"/files/{layer}" for layer in layers))

        yield shown


def scene_of(places_m, colours, bands=None, size_m=0.4):
    """Balls on no panel, around the scene's origin, and two panels of a facade that looks south."""
    scene = synthetic_scene(((1, 1),), len(places_m))
    values = scene.components[-1].gaussians.values
    values["means"][:] = places_m
    values["quats"][:] = (1.0, 0.0, 0.0, 0.0)
    values["log_scales"][:] = np.log(size_m)
    values["opacity_logits"][:] = 6.0
    values["sh"][:] = 0.0
    values["sh"][:, 0] = (np.array(colours) - 0.5) / 0.28209479
    if bands is not None:
        values["sh"][:, 1:] = bands
    # Discs would be seen from the side as lines.
    balls = {**values, "log_scales": np.full((len(places_m), 3), np.log(size_m), np.float32)}
    rest = replace(scene.components[-1], gaussians=replace(scene.components[-1].gaussians, values=balls))
    facade = scene.components[0]
    facade.gaussians.values["opacity_logits"][:] = -9.0
    return replace(scene, components=(facade, rest))


def look(browser, scene, offset_m):
    """The picture from a place to the scene's origin, shape (480, 640, 3), 0 to 1."""
    site, (east, north, up) = scene.origin, scene.origin_enu_m
    # So few metres are the same on the Earth and in the site's plane, to less than a millimetre.
    lat = site.lat_deg + np.degrees(north / 6_340_000.0)
    lon = site.lon_deg + np.degrees(east / (6_378_000.0 * np.cos(np.radians(site.lat_deg))))
    height = site.ellipsoid_height_m + up
    found = foreign.picture_of(browser.run("return await look(...arguments)", lat, lon, height, list(offset_m)))
    assert found.shape[:2] == (480, 640)
    return found


def middle_of(picture, colour):
    """Of what has a colour, pixels from the picture's middle: right and up."""
    others = picture[..., [channel for channel in range(3) if not colour[channel]]].max(axis=2)
    weight = np.clip(picture[..., int(np.argmax(colour))] - others, 0.0, None)
    assert weight.max() > 0.5
    rows, columns = np.nonzero(weight > 0.25)
    return np.array([columns.mean() - 319.5, 239.5 - rows.mean()])


def test_gaussians_lie_where_they_are_and_have_their_colours(browser, serve):
    scene = scene_of([(0, 0, 0), (4, 0, 0), (0, 0, 3)], [RED, GREEN, BLUE])
    serve(scene, "gaussians.json")
    for offset_m, right in ((0.0, -20.0, 0.0), 4.0), ((0.0, 20.0, 0.0), -4.0):
        picture = look(browser, scene, offset_m)
        np.testing.assert_allclose(middle_of(picture, RED), 0.0, atol=2.0)
        np.testing.assert_allclose(middle_of(picture, GREEN), [right * FOCAL_PX / 20.0, 0.0], atol=3.0)
        np.testing.assert_allclose(middle_of(picture, BLUE), [0.0, 3.0 * FOCAL_PX / 20.0], atol=3.0)
    assert browser.run("return failures") == []


def test_colours_by_direction_turn_with_the_axes(browser, serve):
    scene = scene_of([(0, 0, 0)], [(0.5, 0.5, 0.5)], 0.15 * np.random.default_rng(5).normal(size=(15, 3)))
    serve(scene, "gaussians.json")
    sh = torch.from_numpy(scene.components[-1].gaussians.values["sh"])
    seen = []
    for offset_m in ((0.0, -20.0, 0.0), (-19.0, 3.0, 5.0), (2.0, 12.0, 15.0)):
        place = torch.tensor(offset_m)
        expected = display_colours(torch.zeros(1, 3), sh, place, 3)[0].numpy()
        found = look(browser, scene, offset_m)[238:242, 318:322].mean(axis=(0, 1))
        np.testing.assert_allclose(found, expected, atol=0.04)
        seen.append(expected)
    assert np.ptp(seen, axis=0).max() > 0.2


def test_from_afar_few_gaussians_are_shown_and_from_near_all(browser, serve):
    rng = np.random.default_rng(3)
    places = rng.uniform(-1.0, 1.0, (2000, 3)) * (8.0, 0.1, 4.0)
    scene = scene_of(places, np.where(places[:, :1] < 0.0, RED, GREEN), size_m=0.12)
    serve(scene, "gaussians.json", options=TilesOptions(gaussians_per_tile=700))
    for distance_m, is_coarse in ((300.0, True), (20.0, False), (300.0, True)):
        picture = look(browser, scene, (0.0, -distance_m, 0.0))
        errors = browser.run("return errors()")
        assert (len(errors) == 1 and errors[0] > 0.0) if is_coarse else (len(errors) >= 4 and max(errors) == 0.0)
        for colour, side in ((RED, -1.0), (GREEN, 1.0)):
            expected = np.array([4.0 * side, 0.0]) * FOCAL_PX / distance_m
            np.testing.assert_allclose(middle_of(picture, colour), expected, atol=1.0 + 0.1 * abs(expected[0]))
        assert picture[237:243, 316:324, :2].sum(axis=2).mean() > 0.8
    assert browser.run("return failures") == []


def test_panels_are_picked_through_gaussians(browser, serve):
    scene = scene_of([(0, 0, 0)], [WHITE])
    serve(scene, "gaussians.json", "panels.json")
    look(browser, scene, (0.0, -20.0, 0.0))
    places, expected = [], []
    for _, element in scene.elements:
        x, y, z = np.mean(element.corners_enu_m, axis=0) - scene.origin_enu_m
        scale = FOCAL_PX / (20.0 + y)
        places.append([320.0 + x * scale, 240.0 - z * scale])
        expected.append(element.global_id)
    assert browser.run("return pick(arguments[0])", [*places, [5, 5]]) == [*expected, None]
    assert browser.run("return failures") == []
