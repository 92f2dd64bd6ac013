"""Flights from photos alone: written from a plan with known errors, read back, and matched again."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest

from missions.flight.matching import match_flight
from missions.flight.outcome import Reason
from missions.flight.photo_folder import photo_flights, read_photo_flights
from missions.flight.report import Limits, report_case
from planning.base.errors import InputError
from planning.checks.case import Case
from planning.geo.frames import Origin, aim
from planning.parameters import Constraints
from planning.photos.folder import read_photos
from planning.plan import Plan, Viewpoint
from planning.site.bundled import ORIGIN
from planning.site.records import SiteModel
from tests.missions.flight.photo_files import Device, write_photos
from tests.missions.plans import make_plan
from tests.planning.photos.photo_writer import exif_part, gps_tags, jpeg, save
from tests.planning.plan_cases import kiosk

PLAIN = Device(has_rtk=False)


@functools.cache
def site_model() -> SiteModel:
    return replace(kiosk(), sha256="0" * 64)


@functools.cache
def plan() -> Plan:
    """Two sorties of ten views each, in front of the southern side."""
    views = []
    for i in range(20):
        position = (-11.0 + 2.2 * (i % 10), -9.0 - 1.3 * (i % 4), 5.0 + 4.0 * (i // 10))
        heading, pitch = aim(np.array([-4.0 + 0.8 * (i % 10), 0.0, 1.5 + 3.0 * (i % 3)]) - np.array(position))
        views.append(Viewpoint(f"v{i:04d}", position, float(np.degrees(heading)), float(np.degrees(pitch))))
    made = make_plan([(views[:10], {}), (views[10:], {})], ORIGIN, home=site_model().site.home_enu_m)
    return replace(made, site="kiosk", site_sha256="0" * 64, constraints=Constraints(min_distance_m=5.0))


SITE = site_model().site
VIEWS = plan().viewpoints


def flights(folder, heights="auto", site=SITE):
    return read_photo_flights(folder, site, heights)


def codes(found):
    return {finding.code for finding in found.findings}


def position_errors(found):
    """How far each photo is from the view it was written for, per axis, shape (n, 3)."""
    points = [photo.position_enu_m for record in found.records for photo in record.photos]
    return np.array(points) - np.array([view.position_enu_m for view in VIEWS[: len(points)]])


@pytest.mark.parametrize("device", [Device(), PLAIN], ids=["rtk", "barometer"])
def test_photos_come_back_where_and_when_they_were_taken(tmp_path, device):
    write_photos(tmp_path, SITE, VIEWS[:10], device)
    found = flights(tmp_path)
    (record,) = found.records
    assert np.abs(position_errors(found)).max() < 0.002  # the file's own rounding
    assert [photo.index for photo in record.photos] == list(range(1, 11))
    assert [photo.time_s for photo in record.photos] == pytest.approx([6.0 * i for i in range(10)])
    for photo, view in zip(record.photos, VIEWS, strict=False):
        assert photo.heading_deg == pytest.approx(view.heading_deg, abs=0.006)
        assert photo.gimbal_pitch_deg == pytest.approx(view.gimbal_pitch_deg, abs=0.006)
        assert (photo.speed_m_s, photo.exposure_s, photo.source) == (0.3, pytest.approx(0.001), "photo-file")
    assert record.vehicle == "photos of DJI M3E"
    assert len(record.track.time_s) == 0
    assert codes(found) == {"height-reference"}


@pytest.mark.parametrize(
    "origin", [Origin(-33.9, 151.2, 30.0), Origin(-16.5, 179.9999, 55.0), Origin(31.5, 35.5, -395.0)]
)
def test_altitudes_above_and_below_sea_level_go_through_the_geoid(tmp_path, origin):
    site = replace(SITE, origin=origin)
    write_photos(tmp_path, site, VIEWS[:10], PLAIN)
    found = flights(tmp_path, "absolute", site)
    assert np.abs(position_errors(found)).max() < 0.002


def test_every_view_finds_its_photo_and_errors_are_what_was_put_in(tmp_path):
    device = Device(position_m=0.15, angle_deg=1.0)
    write_photos(tmp_path, SITE, VIEWS[:10], device)
    write_photos(tmp_path, SITE, VIEWS[10:], device, start_s=600.0, first=11, seed=2)
    found = flights(tmp_path)
    matching = match_flight(plan(), found.records)
    assert matching.sortie_of_record == (1, 2)
    assert [match.photo.photo for match in matching.views] == [*range(10), *range(10)]
    assert matching.extra == ()
    report = report_case(Case.of(plan(), site_model()), found.records)
    assert report.summary.n_taken == 20
    rms_m = np.sqrt(np.mean([view.position_error_m**2 for view in report.views]))
    assert 0.7 * 0.15 < rms_m / np.sqrt(3.0) < 1.3 * 0.15
    rms_deg = np.sqrt(np.mean([view.heading_error_deg**2 for view in report.views]))
    assert 0.6 < rms_deg < 1.5
    assert {outcome.least_distance_m for outcome in report.sorties} == {None}


def test_blur_is_that_of_the_photos_own_speed_and_exposure(tmp_path):
    for name, exposure in (("short", 0.001), ("long", 0.004)):
        write_photos(tmp_path / name, SITE, VIEWS[:10], Device(speed_m_s=2.0, exposure_s=exposure))
    short, long = (
        report_case(Case.of(plan(), site_model()), flights(tmp_path / name).records, Limits(exposure_s=1.0))
        for name in ("short", "long")
    )
    for a, b in zip(short.views[:10], long.views[:10], strict=True):
        assert b.blur_px == pytest.approx(4.0 * a.blur_px)
        assert a.blur_px == pytest.approx(0.001 * 2.0 / plan().camera.gsd_m(10.0), rel=0.6)


def test_a_missing_photo_is_missed_and_the_others_are_not_shifted(tmp_path):
    write_photos(tmp_path, SITE, [view for i, view in enumerate(VIEWS[:10]) if i != 4], Device(position_m=0.1))
    matching = match_flight(plan(), flights(tmp_path).records)
    assert [match.view_id for match in matching.views[:10] if match.photo is None] == ["v0004"]
    assert matching.views[4].reason is Reason.NO_TRACK
    assert all(match.reason is Reason.NOT_FLOWN for match in matching.views[10:])


def test_heights_are_those_that_rtk_measured_where_all_photos_have_it(tmp_path):
    write_photos(tmp_path, SITE, VIEWS[:5], Device(takeoff_error_m=4.0))
    found = flights(tmp_path)
    assert np.abs(position_errors(found)).max() < 0.002
    (wrong,) = (finding for finding in found.findings if finding.code == "height-disagreement")
    assert wrong.value == pytest.approx(4.0, abs=0.002)
    assert "4.0 m higher" in wrong.message
    assert position_errors(flights(tmp_path, "takeoff"))[:, 2] == pytest.approx(np.full(5, 4.0), abs=0.002)


def test_heights_are_those_above_takeoff_where_one_photo_lacks_rtk(tmp_path):
    write_photos(tmp_path, SITE, VIEWS[:5], Device(absolute_error_m=-3.0))
    write_photos(tmp_path, SITE, VIEWS[5:6], replace(PLAIN, absolute_error_m=-3.0), start_s=30.0, first=6)
    found = flights(tmp_path)
    assert np.abs(position_errors(found)).max() < 0.002
    assert {"height-disagreement"} <= codes(found)
    assert "only 5 of 6" in next(finding for finding in found.findings if finding.code == "height-reference").message


def test_small_disagreements_of_heights_are_not_worth_a_word(tmp_path):
    write_photos(tmp_path, SITE, VIEWS[:5], Device(takeoff_error_m=1.5))
    assert "height-disagreement" not in codes(flights(tmp_path))


def test_photos_with_the_other_height_only_are_counted_by_it(tmp_path):
    write_photos(tmp_path, SITE, VIEWS[:5], PLAIN)
    geodetic_only = exif_part({}, {0x9003: "2024:05:01 10:00:30"}, gps_tags(ORIGIN.lat_deg, ORIGIN.lon_deg, 70.0))
    save(tmp_path / "DJI_0006.JPG", jpeg(geodetic_only))
    found = flights(tmp_path)
    assert "height-mixed" in codes(found)
    assert len(found.records[0].photos) == 6
    (tmp_path / "one").mkdir()
    (tmp_path / "DJI_0006.JPG").rename(tmp_path / "one" / "DJI_0006.JPG")
    assert codes(flights(tmp_path / "one")) == {"height-reference"}
    with pytest.raises(InputError, match="choose the other way"):
        flights(tmp_path / "one", "takeoff")


def test_gimbal_angles_that_were_not_recorded_are_not_known(tmp_path):
    write_photos(tmp_path, SITE, VIEWS[:10], Device(has_gimbal=False))
    found = flights(tmp_path)
    assert {photo.heading_deg for photo in found.records[0].photos} == {None}
    report = report_case(Case.of(plan(), site_model()), found.records)
    assert report.summary.n_taken == 10
    assert {"heading-unknown", "gimbal-unknown"} <= {finding.code for finding in report.findings}


def test_a_pause_parts_two_sorties_and_a_shorter_one_does_not(tmp_path):
    write_photos(tmp_path, SITE, VIEWS[:10], replace(Device(), interval_s=55.0))
    assert len(flights(tmp_path).records) == 1
    write_photos(tmp_path, SITE, VIEWS[10:], start_s=9 * 55.0 + 65.0, first=11)
    assert [len(record.photos) for record in flights(tmp_path).records] == [10, 10]


def test_two_aircraft_at_once_are_two_records(tmp_path):
    write_photos(tmp_path, SITE, VIEWS, Device())
    photos = read_photos(tmp_path).photos
    mixed = [replace(photo, drone_serial="B2") if i % 2 else photo for i, photo in enumerate(photos)]
    found = photo_flights(mixed, SITE, "photos")
    assert [len(record.photos) for record in found.records] == [10, 10]


def test_several_photos_in_one_second_keep_the_cameras_order(tmp_path):
    write_photos(tmp_path, SITE, VIEWS[:10], replace(Device(), interval_s=0.0))
    photos = read_photos(tmp_path).photos
    found = photo_flights(photos[::-1], SITE, "photos")
    assert [photo.index for photo in found.records[0].photos] == list(range(1, 11))


def test_thermal_photos_beside_others_are_left_out(tmp_path):
    write_photos(tmp_path / "wide", SITE, VIEWS[:10])
    write_photos(tmp_path / "thermal", SITE, VIEWS[:10], Device(source="InfraredCamera"))
    both = flights(tmp_path)
    assert len(both.records[0].photos) == 10
    assert "photos-thermal" in codes(both)
    assert len(flights(tmp_path / "thermal").records[0].photos) == 10


def test_photos_of_elsewhere_are_left_out_and_a_folder_of_them_is_refused(tmp_path):
    far = replace(SITE, origin=Origin(ORIGIN.lat_deg + 1.0, ORIGIN.lon_deg, 60.0))
    write_photos(tmp_path, far, VIEWS[:3], PLAIN, first=50)
    with pytest.raises(InputError, match=r"11\d\.\d km from the site 'kiosk'"):
        flights(tmp_path)
    write_photos(tmp_path, SITE, VIEWS[:10])
    found = flights(tmp_path)
    assert sum(len(record.photos) for record in found.records) == 10
    assert codes(found) == {"photos-elsewhere", "height-reference"}


def test_photos_without_place_time_or_height_are_told_of(tmp_path):
    write_photos(tmp_path, SITE, VIEWS[:4])
    save(tmp_path / "DJI_0100.JPG", jpeg())
    save(tmp_path / "DJI_0101.JPG", jpeg(exif_part(gps=gps_tags(ORIGIN.lat_deg, ORIGIN.lon_deg, 3.0))))
    write_photos(tmp_path, SITE, VIEWS[4:5], Device(has_heights=False), start_s=30.0, first=5)
    save(tmp_path / "DJI_0102.JPG", b"broken")
    found = flights(tmp_path)
    told = {finding.message.split(" and ")[0]: finding.value for finding in found.findings}
    for what in ("position", "time", "height"):
        assert told[f"1 of 7 photos do not say a {what}"] == 1.0
    assert "photo-unreadable" in codes(found)
    assert len(found.records[0].photos) == 4


def test_a_folder_without_any_usable_photo_is_refused(tmp_path):
    save(tmp_path / "DJI_0100.JPG", jpeg())
    with pytest.raises(InputError, match="1 without a position"):
        flights(tmp_path)


def test_what_the_receiver_says_of_itself_is_passed_on(tmp_path):
    write_photos(tmp_path, SITE, VIEWS[:4])
    photos = read_photos(tmp_path).photos
    loose = [replace(photos[0], rtk_flag=34), replace(photos[1], position_disagreement_m=2.0), *photos[2:]]
    assert {"rtk-not-fixed", "position-disagreement"} <= codes(photo_flights(loose, SITE, "photos"))
    none = [replace(photo, rtk_flag=0) for photo in photos]
    assert "rtk-not-fixed" not in codes(photo_flights(none, SITE, "photos"))  # an aircraft without RTK


def test_real_photos_become_a_flight_over_a_site_there(shared_data):
    photo = next(p for p in read_photos(shared_data / "dji" / "photos").photos if p.path.name == "H30T_IR.JPG")
    site = replace(SITE, origin=Origin(photo.lat_deg, photo.lon_deg, photo.height_ellipsoid_m - 30.0))
    found = photo_flights([photo], site, "photos")
    (taken,) = found.records[0].photos
    assert taken.position_enu_m == pytest.approx((0.0, 0.0, 30.0), abs=1e-3)
    assert (taken.heading_deg, taken.gimbal_pitch_deg) == (31.4, -90.0)
    assert taken.speed_m_s == pytest.approx(np.hypot(0.9, 0.5))
