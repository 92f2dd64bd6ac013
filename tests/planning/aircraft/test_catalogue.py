"""Aircraft-and-camera profiles: plausible, sourced, and the contract's default among them."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from planning.aircraft.catalogue import profile, profiles
from planning.base.errors import InputError
from planning.parameters import DEFAULT_PROFILE


def test_the_default_is_the_contract_s_aircraft_and_camera() -> None:
    default = profile(DEFAULT_PROFILE)
    assert (default.aircraft.name, default.aircraft.endurance_s, default.aircraft.max_speed_m_s) == (
        "DJI M3E",
        2520,
        15,
    )
    camera = default.camera
    assert (camera.sensor_width_mm, camera.sensor_height_mm, camera.focal_length_mm) == (17.3, 13.0, 12.29)
    assert (camera.image_width_px, camera.image_height_px, camera.gimbal_pitch_deg) == (5280, 3956, (-90.0, 35.0))


@pytest.mark.parametrize("identifier", sorted(profiles()))
def test_every_profile_names_its_sources_and_is_plausible(identifier: str) -> None:
    entry = profile(identifier)
    assert len(entry.source) > 80
    aircraft, camera = entry.aircraft, entry.camera
    assert 600 < aircraft.endurance_s < 4500
    assert aircraft.max_ascent_m_s <= 10 <= 2 * aircraft.max_speed_m_s
    assert 20 < math.degrees(2 * math.atan(math.hypot(camera.half_width, camera.half_height))) < 100
    # Square pixels, as all of these cameras have.
    pixel_width = camera.sensor_width_mm / camera.image_width_px
    pixel_height = camera.sensor_height_mm / camera.image_height_px
    assert pixel_width == pytest.approx(pixel_height, rel=0.03)


def test_unknown_profiles_are_refused_with_those_there_are() -> None:
    with pytest.raises(InputError, match=r"no aircraft profile 'm3'; known are: .*m3e, m3t"):
        profile("m3")


OWN = """[my_quad]
aircraft = { name = "My quadrotor", endurance_s = 1300, max_speed_m_s = 8 }
camera = { name = "a6000", sensor_width_mm = 23.5, sensor_height_mm = 15.6, focal_length_mm = 16.0, \
image_width_px = 6000, image_height_px = 4000, gimbal_pitch_deg = [-90, 20] }
"""


def test_a_profile_of_ones_own_comes_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "quad.toml"
    path.write_text(OWN.replace("\\\n", ""))
    own = profile(str(path))
    assert (own.id, own.aircraft.endurance_s, own.camera.gimbal_pitch_deg) == ("my_quad", 1300, (-90.0, 20.0))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected one table with an aircraft and its camera, got 0"),
        ("[a", "not valid TOML"),
        ('[a]\nsource = "x"', "missing required field"),
        ('[a]\ncamera = "x"', "camera: expected object, got text"),
        (OWN.replace("\\\n", "").replace("1300", "-1"), "endurance_s: expected a positive number"),
    ],
)
def test_wrong_profile_files_are_refused_in_words(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "quad.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        profile(str(path))
