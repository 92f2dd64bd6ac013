"""Exposure from photo to photo: both ways, in thirds of a stop, as far as shutters go."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from planning.base.effects import EffectSetting
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.effects.registry import decide_effects
from reconstruction.scenes.parameters import EXPOSURE, RenderSettings
from reconstruction.scenes.photos.camera_model import SHUTTERS_S, CameraModel, Moment
from reconstruction.scenes.photos.lens_effects import grey_levels
from reconstruction.scenes.photos.renderer import Renderer
from reconstruction.scenes.record import Layer, Scene
from reconstruction.scenes.runs.photo_folder import captures_of, common_exposure
from reconstruction.scenes.runs.photo_job import PhotoJob
from tests.reconstruction.scenes.small_scenes import photo, quad, scene

SMALL = {"width_px": 32, "height_px": 24, "focal_px": 60.0}
METERED = CameraModel(exposure="metered")


def walls(darker: float) -> Scene:
    """Two boards with nothing between: a light one in the east, a darker one in the west."""
    boards = []
    for side, share in ((1.0, 1.0), (-1.0, darker)):
        x = 20.0 * side
        corners = [(x, 90.0 * side, -50.0), (x, -90.0 * side, -50.0), (x, -90.0 * side, 70.0), (x, 90.0 * side, 70.0)]
        body = quad(corners, "board", Layer.NEAR)
        boards.append(replace(body, albedo=(0.6 * share,) * 3))
    return scene(*boards)


def two(first_deg: float = 90.0, second_deg: float = -90.0) -> tuple[PosedPhoto, ...]:
    return tuple(photo(heading_deg=heading, **SMALL) for heading in (first_deg, second_deg))


def job(
    made: Scene, camera_model: CameraModel = METERED, setting: EffectSetting = "on", exposure_s: float = 0.002
) -> PhotoJob:
    settings = RenderSettings(effects={EXPOSURE: setting})
    return PhotoJob(made, two(), settings, {}, camera_model=camera_model, moments=(Moment(exposure_s=exposure_s),) * 2)


def factors(of: PhotoJob) -> list[float]:
    return [capture.exposure for capture in captures_of(of, common_exposure(of))]


@pytest.mark.few(1)
@pytest.mark.parametrize(("darker", "used"), [(0.25, True), (0.97, False)])
def test_the_scene_decides_by_how_much_photos_would_differ(darker: float, used: bool) -> None:
    made = walls(darker)
    decided = decide_effects(made, two(), RenderSettings(), METERED)[EXPOSURE]
    work = job(made)
    common = common_exposure(work)
    squares = []
    for camera, factor in zip(two(), factors(work), strict=True):
        light = common * Renderer(made, RenderSettings(samples=1)).render(camera).linear.astype(float)
        squares.append(((grey_levels(factor * light) - grey_levels(light)) ** 2).mean())
    assert decided.on == used == (np.sqrt(np.mean(squares)) > decided.tolerance)
    # The probe's rays are others, so that a photo may be rounded to the next third of a stop.
    assert decided.size == pytest.approx(np.sqrt(np.mean(squares)), rel=0.4)


def test_a_locked_exposure_is_that_of_all_photos() -> None:
    locked = decide_effects(walls(0.5), two(), RenderSettings(), CameraModel())[EXPOSURE]
    assert (locked.on, locked.size) == (False, 0.0)
    assert factors(job(walls(0.5), CameraModel())) == [1.0, 1.0]
    assert factors(job(walls(0.5), METERED, "off")) == [1.0, 1.0]


def test_darker_photos_are_exposed_longer_by_thirds_of_a_stop() -> None:
    light, dark = factors(job(walls(0.5)))
    assert light < 1.0 < dark
    seen = [Renderer(walls(0.5), RenderSettings(samples=1)).render(camera).linear.mean() for camera in two()]
    thirds = 3.0 * np.log2(dark / light)
    assert thirds == pytest.approx(round(thirds))
    # Each of the two is rounded.
    assert abs(thirds - 3.0 * np.log2(seen[0] / seen[1])) <= 1.0


def test_exposures_end_where_shutters_do_but_not_before_what_was_asked_for() -> None:
    shortest, longest = SHUTTERS_S
    assert factors(job(walls(0.5), exposure_s=shortest))[0] == 1.0
    assert factors(job(walls(0.5), exposure_s=longest))[1] == 1.0
    assert factors(job(walls(0.5), exposure_s=30.0))[1] == 1.0
    light, dark = captures_of(work := job(walls(0.5), exposure_s=0.0), common_exposure(work))
    assert light.exposure < 1.0 < dark.exposure
    assert light.exposure_s == dark.exposure_s == 0.0
