"""Exported models in browsers, picture by picture against the program's own: of a scene that was really trained."""

import numpy as np
import pytest
import torch

from groundstation.cli.main import main
from reconstruction.modelling.render import render_view
from reconstruction.modelling.saved import read_model
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


def test_the_page_shows_what_the_program_shows(trained, tmp_path):
    page = exported(trained, "web", tmp_path / "page", "--degree", "3") / "index.html"
    model = read_model(trained).model
    with torch.no_grad():
        model.corner_loss.zero_()  # a lens darkens corners, and the page has none
    origin = model.origin_enu_m
    with chromium(tmp_path / "chromium") as browser:
        browser.window(660, 400)
        browser.open(page)
        for place, heading, pitch in PLACES:
            browser.run("reflight.look(...arguments)", (np.array(place) - origin).tolist(), heading, pitch)
            browser.settled()
            camera, shown = browser.run("return reflight.camera()"), browser.pixels() / 255.0
            own, is_off_glass = own_picture(model, camera)
            assert own.shape == shown.shape
            assert psnr(shown[is_off_glass], own[is_off_glass]) > 40.0
            # The sky is not the same all around: turned, this scene's is far from it.
            other, is_off = own_picture(model, {**camera, "heading": heading + 180.0})
            assert pitch > 80.0 or psnr(other[is_off & is_off_glass], own[is_off & is_off_glass]) < 32.0
            if not is_off_glass.all():
                assert psnr(shown, own) > 30.0
        assert browser.errors() == []
