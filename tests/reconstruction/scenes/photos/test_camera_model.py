"""How photos are taken: what a file says of it, lenses that fold, exposures, and how a camera moves past its views."""

from __future__ import annotations

import math
from dataclasses import replace
from datetime import timedelta
from pathlib import Path

import numpy as np
import pytest

from planning.base.errors import InputError
from planning.plan import Viewpoint
from reconstruction.base.cameras import Intrinsics
from reconstruction.scenes.photos.camera_model import (
    SHUTTER_S,
    CameraModel,
    GimbalErrors,
    PositionErrors,
    bent_lens,
    in_stops,
    read_camera_model,
)
from reconstruction.scenes.photos.flight_views import Shot, flown_shots, moments
from reconstruction.scenes.photos.lens_effects import Sensor

M3E = Intrinsics(5280, 3956, 3713.29, 3713.29, 2640.0, 1978.0)
USUAL = (-0.1125, 0.0149, -0.0001, 0.0003, -0.0257)
"""Of the size that wide lenses of 84 degrees have."""


def written(folder: Path, text: str) -> Path:
    """A TOML file."""
    path = folder / "camera.toml"
    path.write_text(text)
    return path


def test_a_file_says_how_photos_are_taken(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        'shutter_s = 0.001\nspeed_m_s = 5\nexposure = "metered"\ndistortion = [-0.1, 0.02, 0, 0, 0]\n'
        '[sensor]\ngain = 4.0\n[position]\nfix = "single"\nvertical_m = 0.2\n[gimbal]\nheading_bias_deg = 2.0\n',
    )
    camera_model = read_camera_model(path)
    assert camera_model == CameraModel(
        0.001,
        5.0,
        "metered",
        (-0.1, 0.02, 0.0, 0.0, 0.0),
        Sensor(gain=4.0),
        PositionErrors("single", vertical_m=0.2),
        GimbalErrors(heading_bias_deg=2.0),
    )
    assert camera_model.position.deviation_m == (0.14, 0.2)
    assert camera_model.position.bias_m == (1.06, 3.0)
    assert read_camera_model(written(tmp_path, "")) == CameraModel()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("shuter_s = 1", "shuter_s: no such setting; known are: shutter_s"),
        ("[sensor]\niso = 100", r"sensor\.iso: no such setting; known are: corner_loss"),
        ("[position]\nhorizontal = 1", r"position\.horizontal: no such setting"),
        ("[gimbal]\nyaw_deg = 1", r"gimbal\.yaw_deg: no such setting"),
        ("shutter_s = nan", "shutter_s: expected 0 to 30, got nan"),
        ("shutter_s = -0.001", "shutter_s: expected 0 to 30, got -0.001"),
        ("speed_m_s = inf", "speed_m_s: expected 0 to 100, got inf"),
        ("distortion = [0, nan, 0, 0, 0]", "distortion: expected -100 to 100, got nan"),
        ("distortion = [0.1, 0.2]", "distortion: expected"),
        ('exposure = "auto"', "exposure: "),
        ("[position]\nhorizontal_m = nan", "horizontal_m: expected 0 to 100, got nan"),
        ("[gimbal]\npitch_deg = -1", "pitch_deg: expected 0 to 45, got -1"),
        ("[sensor]\nfull_well_e = inf", "full_well_e: expected at least 0.01, got inf"),
        ("[sensor]\ngain = nan", "gain: expected at least 0.01, got nan"),
        ("sensor = 3", "sensor: expected object"),
        ("shutter_s = ", "not valid TOML"),
    ],
)
def test_what_makes_no_sense_is_named(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as raised:
        read_camera_model(written(tmp_path, text))
    assert "camera.toml" in str(raised.value)


@pytest.mark.parametrize("distortion", [USUAL, (0.3, 0.1, 0.01, -0.01, 0.05), (0.0, 0.0, 0.0, 0.0, 0.0)])
def test_lenses_that_can_be_undone_are_taken(distortion: tuple[float, float, float, float, float]) -> None:
    assert bent_lens(M3E, distortion) == replace(M3E, distortion=distortion)


@pytest.mark.parametrize(
    "distortion",
    [
        (-0.6, 0.0, 0.0, 0.0, 0.0),
        (-0.45, 0.0, 0.0, 0.0, 0.0),
        (-5.0, 0.0, 0.0, 0.0, 0.0),
        (50.0, -90.0, 0.0, 0.0, 0.0),
        (0.0, 0.0, 2.0, 0.0, 0.0),
        (0.0, 0.0, 0.0, 0.0, -3.0),
        (-100.0, 100.0, 100.0, -100.0, 100.0),
    ],
)
def test_lenses_that_fold_the_picture_are_refused(distortion: tuple[float, float, float, float, float]) -> None:
    with pytest.raises(InputError, match="folds the picture"):
        bent_lens(M3E, distortion)


def test_exposures_go_by_thirds_of_a_stop() -> None:
    assert in_stops(np.array([1.0, 1.1, 1.13, 2.0, 0.5, 0.89])) == pytest.approx(
        [1.0, 1.0, 2 ** (1 / 3), 2.0, 0.5, 2 ** (-1 / 3)]
    )


def row(n: int = 4, step_m: float = 3.0) -> list[Shot]:
    """Shots to the north, side by side towards the east; each sortie of two."""
    views = [Viewpoint(f"v{k}", (step_m * k, 0.0, 10.0), 0.0, 0.0) for k in range(n)]
    return [Shot(view, timedelta(seconds=k), k // 2) for k, view in enumerate(views)]


def test_planned_aircraft_stop_unless_a_speed_is_given() -> None:
    for moment, sortie in zip(moments(row(), CameraModel()), (0, 0, 1, 1), strict=True):
        assert (moment.sortie, moment.velocity_enu_m_s, moment.exposure_s) == (sortie, (0.0, 0.0, 0.0), SHUTTER_S)
        assert moment.moved_m == 0.0
    for moment in moments(row(), CameraModel(speed_m_s=5.0, shutter_s=0.01)):
        assert moment.velocity_enu_m_s == pytest.approx((5.0, 0.0, 0.0))
        assert moment.moved_m == pytest.approx(0.05)


def test_a_view_with_no_neighbour_is_passed_to_its_right() -> None:
    alone = [Shot(Viewpoint("v", (0.0, 0.0, 5.0), 90.0, -20.0), timedelta(0))]
    (moment,) = moments(alone, CameraModel(speed_m_s=3.0))
    assert moment.velocity_enu_m_s == pytest.approx((0.0, -3.0, 0.0), abs=1e-12)
    for moment in moments(row(3, 0.0), CameraModel(speed_m_s=3.0)):
        assert math.hypot(*moment.velocity_enu_m_s) == pytest.approx(3.0)


def test_a_flight_knows_its_own_speeds_and_exposures_and_a_file_overrules_them() -> None:
    view = row()[0].view
    shots = flown_shots([[(view, 1.0)], [(view, 2.0)]], [[((1.0, 2.0, 0.5), 0.004)], [((0.0, 0.0, 0.0), None)]])
    first, second = moments(shots, CameraModel())
    assert (first.sortie, first.velocity_enu_m_s, first.exposure_s) == (0, (1.0, 2.0, 0.5), 0.004)
    assert (second.sortie, second.velocity_enu_m_s, second.exposure_s) == (1, (0.0, 0.0, 0.0), SHUTTER_S)
    assert [moment.exposure_s for moment in moments(shots, CameraModel(shutter_s=0.0))] == [0.0, 0.0]
