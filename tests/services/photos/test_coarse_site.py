"""The site of a coarse model: flights stay where the first one has been, for its cameras did not look behind them."""

from __future__ import annotations

import json

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.photos.coarse import (
    BESIDE_FLOWN_M,
    KEPT,
    NOT_FLOWN_M,
    ROUNDED_M,
    begun_coarse,
    where_flown,
)
from planning.geo.mesh import box_mesh
from planning.site.bundled import ORIGIN
from planning.site.records import Airspace, Site
from reconstruction.coarse.build import SETTINGS

BUILDING = box_mesh(np.array([-7.0, -5.0, 0.0]), np.array([7.0, 5.0, 9.0]))
SITE = Site("pavilion", ORIGIN, (), Airspace((-47.0, -45.0, 2.0), (47.0, 45.0, 39.0), 0.0), (0.0, -21.0, 0.0), "b.ply")


def ring(first_deg, last_deg, radius_m=24.0, height_m=12.0):
    """Places of photos on a part of a ring, shape (20, 3)."""
    angles = np.radians(np.linspace(first_deg, last_deg, 20))
    return np.column_stack([radius_m * np.cos(angles), radius_m * np.sin(angles), np.full(20, height_m)])


@given(st.floats(0.0, 360.0), st.floats(60.0, 360.0), st.floats(14.0, 60.0))
def test_airspace_holds_where_the_photos_were_and_nothing_far_from_there(first_deg, open_deg, radius_m):
    places = ring(first_deg, first_deg + open_deg, radius_m)
    site, (found,) = where_flown(SITE, places, BUILDING)
    assert found.code == "airspace-as-flown"
    air = site.airspace
    box = shapely.box(*air.min_enu_m[:2], *air.max_enu_m[:2])
    zones = shapely.union_all([shapely.Polygon(zone.polygon_enu_m) for zone in air.no_fly])
    inside = shapely.box(-47.0, -45.0, 47.0, 45.0).covers(shapely.points(places[:, :2]))
    flown = shapely.points(places[inside, :2])
    assert box.buffer(0.1).covers(flown).all()
    assert not shapely.intersects(zones, shapely.MultiPoint(flown).buffer(NOT_FLOWN_M - 2.0 * ROUNDED_M))
    hull = shapely.MultiPoint(np.vstack([places[:, :2], BUILDING.vertices_enu_m[:, :2]])).convex_hull
    left = box.difference(zones)
    far = left.difference(hull.buffer(NOT_FLOWN_M + 2.0 * ROUNDED_M))
    assert far.area < 10.0  # pieces too small for a zone
    assert shapely.box(*hull.buffer(BESIDE_FLOWN_M + 0.1).bounds).covers(box)
    assert hull.buffer(0.1).covers(shapely.Point(site.home_enu_m[:2]))
    assert (air.min_enu_m[2], air.max_enu_m[2]) == (2.0, 39.0)


def test_home_moves_to_where_the_flight_was():
    site, _ = where_flown(SITE, ring(20.0, 160.0), BUILDING)
    assert site.home_enu_m[1] > 5.0
    assert np.hypot(*site.home_enu_m[:2]) == pytest.approx(24.0, abs=0.1)
    assert where_flown(SITE, ring(200.0, 340.0), BUILDING)[0].home_enu_m == SITE.home_enu_m


def test_of_photos_from_the_ground_the_airspace_says_nothing_and_the_pilot_is_told():
    site, (found,) = where_flown(SITE, ring(0.0, 180.0, height_m=1.6), BUILDING)
    assert site == SITE
    assert (found.severity, found.code) == ("warning", "airspace-not-seen")
    assert "behind" in str(found.message)


@pytest.mark.parametrize("content", ["[]", "3", "{", '{"photos": 3}'])
def test_what_others_keep_under_the_name_of_our_settings_is_no_model_that_was_begun(tmp_path, content):
    photos, kept = tmp_path / "photos", tmp_path / "other" / KEPT
    for folder in (photos, kept):
        folder.mkdir(parents=True)
    (kept / SETTINGS).write_text(content)
    assert begun_coarse(photos, tmp_path / "coarse") is None
    (kept / SETTINGS).write_text(json.dumps({"photos": str(photos.resolve())}))
    assert begun_coarse(photos, tmp_path / "coarse") == tmp_path / "other"
