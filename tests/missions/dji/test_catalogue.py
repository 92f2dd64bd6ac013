from __future__ import annotations

import math

import pytest

from missions.dji.wpml import dji_catalogue, dji_profile
from planning.aircraft.catalogue import profiles
from planning.base.errors import MissionError


def test_numbers_are_those_of_djis_documents() -> None:
    """WPML common elements and the mission files of Pilot 2 and FlightHub 2."""
    drones = {name: drone.numbers for name, drone in dji_catalogue().drones.items()}
    assert drones["m3e"] == (77, 0)
    assert drones["m30t"] == (67, 1)
    assert drones["m4td"] == (100, 1)
    assert drones["m350"] == (89, 0)
    payloads = {name: payload.number for name, payload in dji_catalogue().payloads.items()}
    assert (payloads["m3e"], payloads["m30"], payloads["p1"], payloads["m4e"], payloads["h20t"]) == (66, 52, 50, 88, 43)


def test_numbers_are_unique_and_every_payload_named_is_known() -> None:
    catalogue = dji_catalogue()
    assert len({drone.numbers for drone in catalogue.drones.values()}) == len(catalogue.drones)
    assert len({payload.number for payload in catalogue.payloads.values()}) == len(catalogue.payloads)
    assert all(name in catalogue.payloads for drone in catalogue.drones.values() for name in drone.payloads)


def test_profiles_exist_fit_their_aircraft_and_stay_in_its_gimbals_range() -> None:
    catalogue = dji_catalogue()
    for name, profile in catalogue.profiles.items():
        assert profile.payload in catalogue.drones[profile.drone].payloads
        assert set(profile.lens.split(",")) <= set(catalogue.lenses.names)
        assert catalogue.payloads[profile.payload].gimbal_pitch_deg == profiles()[name].camera.gimbal_pitch_deg


def test_every_dji_aircraft_of_the_catalogue_can_be_written() -> None:
    made_by_dji = {name for name, profile in profiles().items() if profile.aircraft.name.startswith("DJI")}
    assert made_by_dji == set(dji_catalogue().profiles)
    assert all(profile.source for profile in profiles().values())
    with pytest.raises(MissionError, match="the plan has no profile"):
        dji_profile("")


def test_default_aircraft_has_the_figures_that_plan_files_promise() -> None:
    m3e = profiles()["m3e"]
    assert (m3e.aircraft.name, m3e.aircraft.endurance_s, m3e.aircraft.max_speed_m_s) == ("DJI M3E", 2520, 15)
    camera = m3e.camera
    assert (camera.name, camera.sensor_width_mm, camera.sensor_height_mm) == ("DJI M3E", 17.3, 13.0)
    assert (camera.focal_length_mm, camera.image_width_px, camera.image_height_px) == (12.29, 5280, 3956)
    assert camera.gimbal_pitch_deg == (-90, 35)


@pytest.mark.parametrize("name", ["m3e", "m3t", "m4e", "m30"])
def test_focal_lengths_give_the_diagonal_field_of_view_that_dji_publishes(name: str) -> None:
    camera = profiles()[name].camera
    diagonal_mm = math.hypot(camera.sensor_width_mm, camera.sensor_height_mm)
    assert math.degrees(2.0 * math.atan(diagonal_mm / (2.0 * camera.focal_length_mm))) == pytest.approx(84.0, abs=1.5)


def test_sorties_of_the_ardupilot_profile_fit_into_its_mission_storage() -> None:
    """Take-off, speed, home and landing, and at most 5 items a waypoint."""
    assert 4 + 5 * profiles()["ardupilot"].aircraft.max_waypoints <= 650
