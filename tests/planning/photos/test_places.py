"""Heights of photos: those of a receiver, and above take-off."""

from __future__ import annotations

import math

import numpy as np
import pytest

from planning.geo.frames import Origin
from planning.geo.geoid import ellipsoid_from_amsl_m
from planning.photos.folder import read_photos
from planning.photos.places import photo_places, receiver_heights_m, takeoff_height_m
from tests.planning.photos.photo_writer import exif_part, gps_tags, jpeg, packet, save

LAT_DEG, LON_DEG = 45.0, 7.5


def photos(folder, *heights):
    """Photos by their altitudes above sea level and above take-off; None for what one does not say."""
    for number, (amsl_m, above_m) in enumerate(heights):
        gps = gps_tags(LAT_DEG, LON_DEG, amsl_m or 0.0)
        if amsl_m is None:
            del gps[5], gps[6]
        xmp = None if above_m is None else packet({"RelativeAltitude": f"{above_m:+.2f}"})
        save(folder / f"{number}.jpg", jpeg(exif_part({0x010F: "DJI"}, {}, gps), xmp))
    return read_photos(folder).photos


def above_ellipsoid_m(amsl_m):
    return float(ellipsoid_from_amsl_m(LAT_DEG, LON_DEG, amsl_m))


def test_heights_of_receivers_count_from_the_ellipsoid(tmp_path):
    found = receiver_heights_m(photos(tmp_path, (300.0, None), (None, 40.0)))
    assert found[0] == pytest.approx(above_ellipsoid_m(300.0))
    assert math.isnan(found[1])


def test_the_height_of_take_off_is_that_of_photos_that_say_both(tmp_path):
    taken = photos(tmp_path, (340.0, 40.0), (None, 90.0), (352.0, 52.0), (900.0, None), (351.0, 50.0))
    assert takeoff_height_m(taken) == pytest.approx(above_ellipsoid_m(300.0))


@pytest.mark.parametrize("heights", [((340.0, None), (350.0, None)), ((None, 40.0), (None, 50.0))])
def test_one_kind_of_height_alone_says_no_take_off(tmp_path, heights):
    assert takeoff_height_m(photos(tmp_path, *heights)) is None


@pytest.mark.parametrize("kind", ["takeoff", "absolute"])
def test_both_kinds_of_height_give_one_place_in_a_frame_at_take_off(tmp_path, kind):
    class Frame:
        name = "frame"
        home_enu_m = (0.0, 0.0, 0.0)

    taken = photos(tmp_path, (340.0, 40.0), (352.0, 52.0), (345.0, None))
    Frame.origin = Origin(LAT_DEG, LON_DEG, takeoff_height_m(taken))
    places = photo_places(taken, Frame, kind, "photos")
    assert np.allclose(places.points_enu_m, [(0.0, 0.0, up) for up in (40.0, 52.0, 45.0)], atol=1e-3)
