"""What a scene says of how its Gaussians are to be drawn."""

import math
from dataclasses import replace

import pytest

from reconstruction.exports.gaussian_blocks import is_antialiased, raster_of
from reconstruction.splats.rasterising.raster_types import RasterSettings
from tests.reconstruction.exports.hard_scenes import antialiased
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

USUAL = RasterSettings()


@pytest.mark.parametrize("blur_px", [0.05, 0.3, 2.0])
def test_gaussians_are_drawn_with_the_blur_that_they_were_learned_with(blur_px):
    found = raster_of(antialiased(synthetic_scene(), blur_px=blur_px))
    assert found == replace(USUAL, antialiased=True, blur_px=blur_px)


def test_those_that_are_not_antialiased_are_drawn_as_usual():
    scene = antialiased(synthetic_scene(), is_on=False, blur_px=0.05)
    assert raster_of(scene) == USUAL
    assert not is_antialiased(scene)


@pytest.mark.parametrize("blur_px", [0.0, -0.3, math.nan, math.inf, 1e9, "wide", None])
def test_nonsense_is_not_drawn_with(blur_px):
    assert raster_of(antialiased(synthetic_scene(), blur_px=blur_px)) == replace(USUAL, antialiased=True)


@pytest.mark.parametrize("training", [{}, {"config": None}, {"config": {"raster": 7}}, {"config": {"raster": {}}}])
def test_a_scene_that_says_nothing_is_drawn_as_usual(training):
    assert raster_of(replace(synthetic_scene(), training=training)) == USUAL
