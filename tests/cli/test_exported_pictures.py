"""Exported models in browsers, picture by picture against the program's own: of a scene that was really trained."""

import numpy as np
import pytest
import torch

from groundstation.cli.main import main
from reconstruction.exports.component_parts import ellipsoids_of_all
from reconstruction.exports.mesh import baked
from reconstruction.objects.organise import organised
from reconstruction.splats.harmonic_colour import display_colours
from reconstruction.splats.ply import ODD
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.training.model.render import render_view
from reconstruction.training.model.saved import read_model
from tests import foreign
from tests.reconstruction.exports.test_foreign_cesium import FOCAL_PX as CESIUM_FOCAL_PX
from tests.reconstruction.exports.test_foreign_cesium import look
from tests.reconstruction.exports.test_web_picture import view_of
from tests.reconstruction.exports.web_browser import chromium

pytestmark = pytest.mark.slow

PLACES = [
    *(((0.0, 25.0, 12.0), heading, 5.0) for heading in (0.0, 90.0, 180.0, -90.0)),
    ((0.0, 25.0, 12.0), 0.0, 85.0),
    ((5.0, 30.0, 8.0), 30.0, 40.0),
    ((-15.0, 20.0, 15.0), 135.0, -10.0),
    ((20.0, 14.0, 12.0), -150.0, -20.0),
]
"""ENU, heading and pitch in degrees: before the facade, which looks north; in all four directions, and up."""


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    """Folder of a model of a street with a glass facade under a sky of clouds."""
    folder = tmp_path_factory.mktemp("trained")
    reflight("scene", "render", "planar", "-o", folder / "photos", "--views", 12, "--width", 160)
    reflight("train", folder / "photos", "-o", folder / "model", "--preset", "smoke")
    return folder / "model"


def reflight(*arguments):
    assert main([str(argument) for argument in arguments], pytest.fail) == 0


def exported(trained, kind, out, *options):
    reflight("export", trained, "--format", kind, "-o", out, *options)
    return out


def psnr(one, other):
    return -10.0 * np.log10(np.mean((one - other) ** 2))


def own_picture(model, camera):
    """The program's own picture from a page's camera, and where no pane mirrors."""
    rendered = render_view(model, view_of(camera), ("panels",))
    return rendered.display, rendered.layers["panels"] < 0


WITHOUT_WEBGPU = "delete Navigator.prototype.gpu"


@pytest.mark.parametrize("has_webgpu", [True, False])
def test_the_page_shows_what_the_program_shows(trained, tmp_path, has_webgpu):
    page = exported(trained, "web", tmp_path / "page", "--degree", "3") / "index.html"
    model = read_model(trained).model
    with torch.no_grad():
        model.corner_loss.zero_()  # a lens darkens corners, and the page has none
    origin = model.origin_enu_m
    with chromium(tmp_path / "chromium") as browser:
        browser.window(660, 400)
        if not has_webgpu:
            browser.cdp("Page.addScriptToEvaluateOnNewDocument", source=WITHOUT_WEBGPU)
        browser.open(page)
        for place, heading, pitch in PLACES:
            browser.run("reflight.look(...arguments)", (np.array(place) - origin).tolist(), heading, pitch)
            browser.settled()
            camera, shown = browser.run("return reflight.camera()"), browser.pixels() / 255.0
            own, is_off_glass = own_picture(model, camera)
            assert own.shape == shown.shape
            assert psnr(shown[is_off_glass], own[is_off_glass]) > (40.0 if has_webgpu else 38.0)
            # The sky is not the same all around: turned, this scene's is far from it.
            other, is_off = own_picture(model, {**camera, "heading": heading + 180.0})
            assert pitch > 80.0 or psnr(other[is_off & is_off_glass], own[is_off & is_off_glass]) < 32.0
            if not is_off_glass.all():
                assert psnr(shown, own) > (45.0 if has_webgpu else 27.0)
        assert browser.run("return reflight.state().isMirroring") == has_webgpu
        assert browser.errors() == []


BEFORE = [((0.0, 25.0, 12.0), (0.0, 0.0, 12.0)), ((-20.0, 20.0, 15.0), (0.0, 0.0, 10.0)), ((0, 30, 10), (40, 20, 12))]
"""ENU, of eyes and what they look at: the facade, the facade from a side, and along the street."""


@pytest.fixture(scope="module")
def viewers(tmp_path_factory):
    """A browser for pages of other programs."""
    if not (foreign.HERE / "node_modules").is_dir():
        pytest.skip("programs of others are not installed: make foreign")
    with chromium(tmp_path_factory.mktemp("viewers")) as found:
        found._call("POST", "/timeouts", {"script": 240_000})
        yield found


@pytest.fixture(scope="module")
def truth(trained):
    """Pictures as a viewer of others should show them: what is baked, drawn by the program's own rasteriser."""
    found = read_model(trained)
    scene = baked(organised(found), found.model)
    gaussians = ellipsoids_of_all(scene.components)
    means, quats, scales, opacities = map(
        torch.from_numpy, (gaussians.means_m, gaussians.quats, gaussians.scales_m, gaussians.opacities)
    )
    sh = torch.from_numpy(gaussians.sh * ODD[:, None])

    def picture(eye, target, focal_px):
        eye, target = np.asarray(eye, float) - scene.origin_enu_m, np.asarray(target, float) - scene.origin_enu_m
        east, north, up = target - eye
        heading, pitch = np.degrees([np.arctan2(east, north), np.arctan2(up, np.hypot(east, north))])
        camera = {"eye": eye, "heading": heading, "pitch": pitch, "width": 640, "height": 480, "focal": focal_px}
        view = view_of(camera)
        colours = display_colours(means, sh, torch.from_numpy(eye).float(), 3).clamp(0.0, 1.0)
        settings = RasterSettings(blur_px=np.sqrt(0.3), antialiased=True)
        return rasterise(means, quats, scales, opacities, colours, view, settings=settings).features.numpy().clip(0, 1)

    return scene, picture


def assert_like(found, expected, least_db):
    """As like as that, and much liker than what is mirrored or turned over."""
    assert found.shape == expected.shape
    others = [psnr(each, expected) for each in (found[:, ::-1], found[::-1], found[::-1, ::-1])]
    assert psnr(found, expected) > max(least_db, max(others) + 4.0), others


def y_up(place):
    """Right, up, back: of glTF, and of SPZ."""
    return [place[0], place[2], -place[1]]


SHOWN = {
    "ply": ("ply", "showPlayCanvas('/files/a.ply', 'gsplat', true)", lambda p: [-p[0], p[2], p[1]]),
    "sog": ("sog", "showPlayCanvas('/files/a.sog', 'gsplat', true)", lambda p: [-p[0], p[2], p[1]]),
    "gltf": ("glb", "showBabylon('/files/a.glb', '.glb', true)", y_up),
    # Left-handed, it mirrors what it reads, and takes both for files whose y is down.
    "ply in Babylon.js": ("ply", "showBabylon('/files/a.ply', '.ply', false)", lambda p: [p[0], p[2], p[1]]),
    "spz": ("spz", "showBabylon('/files/a.spz', '.spz', false)", lambda p: [p[0], -p[2], -p[1]]),
    "spz-4": ("spz", "showBabylon('/files/a.spz', '.spz', false)", lambda p: [p[0], -p[2], -p[1]]),
}
"""By format: the file's ending, how it is shown, and where a place of the site is there."""


@pytest.mark.parametrize("name", SHOWN)
def test_splats_look_the_same_in_viewers_of_others(trained, truth, viewers, tmp_path, name):
    ending, call, axes = SHOWN[name]
    scene, picture = truth
    exported(trained, name.split()[0], tmp_path / f"a.{ending}")
    # A glTF file has its place in the site; what knows no nodes counts from the model's origin.
    start = (0.0, 0.0, 0.0) if ending == "glb" else scene.origin_enu_m
    up = axes((0.0, 0.0, 1.0))
    with foreign.served(tmp_path) as address:
        viewers.visit(f"{address}/show_splats.html")
        viewers.run(f"await {call}")
        for places in BEFORE:
            eye, target = (axes((np.array(place, float) - start).tolist()) for place in places)
            found = foreign.picture_of(viewers.run("return await look(...arguments)", eye, target, up))
            assert_like(found, picture(*places, 240.0 / np.tan(np.radians(30.0))), 26.0)
        assert viewers.run("return failures") == []


def test_tiles_look_the_same_in_cesium(trained, truth, viewers, tmp_path):
    scene, picture = truth
    exported(trained, "3d-tiles", tmp_path / "tiles")
    with foreign.served(tmp_path / "tiles") as address:
        viewers.visit(f"{address}/show_cesium.html")
        viewers.run("await show('/files/gaussians.json')")
        for offset_m in ((0.0, 25.0, 4.0), (-20.0, 18.0, 6.0)):
            expected = picture(scene.origin_enu_m + np.array(offset_m), scene.origin_enu_m, CESIUM_FOCAL_PX)
            assert_like(look(viewers, scene, offset_m), expected, 26.0)
        assert viewers.run("return failures") == []
