"""What photo files say: real ones against ExifTool's values, and made ones for the ways in which cameras differ."""

import csv
import math
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InputError
from planning.geo.frames import camera_axes
from planning.photos.exif import Tag, read_exif
from planning.photos.jpeg import read_header
from planning.photos.metadata import exif_altitude_m, from_pix4d, read_photo, upright
from planning.photos.record import Dewarp
from tests.planning.photos.photo_writer import exif_part, extended_segments, gps_tags, jpeg, packet, save

ANGLES = {"GimbalYawDegree": "+30.00", "GimbalPitchDegree": "-20.00", "GimbalRollDegree": "+0.00"}


@pytest.fixture
def photo(tmp_path):
    """Metadata of a photo with these parts."""

    def read(exif=b"", xmp=None, further=(), name="DJI_0001.JPG"):
        return read_photo(save(tmp_path / name, jpeg(exif, xmp, further)))

    return read


def with_xmp(**properties):
    return packet(ANGLES | properties)


COLUMNS = {
    "Model": "model",
    "Make": "make",
    "ImageWidth": "width_px",
    "ImageHeight": "height_px",
    "GPSLatitude": "lat_deg",
    "GPSLongitude": "lon_deg",
    "GpsStatus": "gps_status",
    "RelativeAltitude": "height_above_takeoff_m",
    "GimbalRollDegree": "gimbal_roll_deg",
    "GimbalYawDegree": "gimbal_heading_deg",
    "GimbalPitchDegree": "gimbal_pitch_deg",
    "FlightRollDegree": "flight_roll_deg",
    "FlightYawDegree": "flight_heading_deg",
    "FlightPitchDegree": "flight_pitch_deg",
    "RtkFlag": "rtk_flag",
    "RtkStdLon": "rtk_std_lon_m",
    "RtkStdLat": "rtk_std_lat_m",
    "RtkStdHgt": "rtk_std_height_m",
    "RtkDiffAge": "rtk_age_s",
    "LRFTargetDistance": "range_m",
    "LRFTargetLat": "range_lat_deg",
    "LRFTargetLon": "range_lon_deg",
    "LRFTargetAbsAlt": "range_height_m",
    "DroneModel": "drone_model",
}
ELSEWHERE = {"SourceFile", "GPSAltitude", "AltitudeType", "AbsoluteAltitude", "UTCAtExposure"}


def test_real_photos_say_exactly_what_exiftool_reads(shared_data):
    with (shared_data / "dji" / "expected_exiftool.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 12
    assert set(rows[0]) == set(COLUMNS) | ELSEWHERE
    for row in rows:
        path = shared_data / "dji" / "photos" / row["SourceFile"]
        found = read_photo(path)
        for column, name in COLUMNS.items():
            expected, value = row[column], getattr(found, name)
            if expected == "" or (column.startswith("LRF") and float(row["LRFTargetDistance"]) == 0.0):
                assert value is None, (path.name, column)
            elif isinstance(value, str):
                assert value == expected, (path.name, column)
            else:  # ExifTool prints 15 digits
                assert float(f"{value:.15g}") == float(expected), (path.name, column)
        heights = [found.height_ellipsoid_m, found.altitude_amsl_m]
        absolute = [height for height in heights if height is not None]
        assert absolute == ([float(row["AbsoluteAltitude"])] if row["AbsoluteAltitude"] else [])
        if row["AltitudeType"]:
            assert found.height_ellipsoid_m is not None
        exif_m = exif_altitude_m(read_exif(read_header(path).exif))
        assert exif_m == (float(row["GPSAltitude"]) if row["GPSAltitude"] else None)
        exposed = found.exposed_at
        assert ("" if exposed is None else f"{exposed:%Y:%m:%d %H:%M:%S.%f}") == row["UTCAtExposure"]


def test_times_of_real_photos_keep_fractions_and_zones(shared_data):
    photos = shared_data / "dji" / "photos"
    assert read_photo(photos / "XTR.jpg").taken_at == datetime(2018, 5, 16, 10, 22, 57, 47_000)
    assert read_photo(photos / "H20N_M300_DJI_0006_R.JPG").utc_offset_s == 8 * 3600
    late = read_photo(photos / "M3T_IR.JPG")
    assert late.exposed_at == datetime(2023, 7, 7, 7, 39, 52, 944_920, UTC)
    assert late.exposed_at - late.taken_at.replace(tzinfo=UTC) + timedelta(hours=2) > timedelta(seconds=18)


def test_a_photo_that_was_cut_off_in_its_picture_is_read_and_said_so(shared_data):
    photos = shared_data / "dji" / "photos"
    whole = {path.name: read_photo(path).is_complete for path in photos.iterdir()}
    assert [name for name, is_whole in whole.items() if not is_whole] == ["XTS.jpg"]  # its last bytes are no marker


def test_a_photo_without_any_metadata_is_a_photo(photo):
    bare = photo()
    assert (bare.width_px, bare.height_px, bare.is_complete) == (64, 48, True)
    assert bare.lat_deg is bare.gimbal_heading_deg is bare.taken_at is bare.make is None


@pytest.mark.parametrize("byte_order", ["<", ">"])
@pytest.mark.parametrize(("lat", "lon", "altitude"), [(-33.9, 151.2, 12.5), (22.3372, -0.25, -395.25)])
def test_exif_is_read_in_both_byte_orders_on_all_sides_of_the_globe(photo, byte_order, lat, lon, altitude):
    exif = exif_part(
        {0x010F: "Autel Robotics", 0x0110: "XT705", 0x0112: 6},
        {0x829A: 0.002, 0x8827: 200, 0x920A: 10.57, 0xA405: 26, 0x9003: "2024:02:29 23:59:59", 0x9291: "05"},
        gps_tags(lat, lon, altitude),
        byte_order,
    )
    assert exif[6:8] == (b"II" if byte_order == "<" else b"MM")
    found = photo(exif)
    assert found.lat_deg == pytest.approx(lat, abs=1e-9)
    assert found.lon_deg == pytest.approx(lon, abs=1e-9)
    assert (found.altitude_amsl_m, found.height_ellipsoid_m) == (altitude, None)
    assert (found.make, found.model, found.orientation, found.iso) == ("Autel Robotics", "XT705", 6, 200)
    assert found.exposure_s == pytest.approx(0.002)
    assert (found.focal_length_mm, found.focal_length_35mm_mm) == (pytest.approx(10.57), 26.0)
    assert found.taken_at == datetime(2024, 2, 29, 23, 59, 59, 50_000)


def test_exif_agrees_with_pillow_on_real_photos(shared_data):
    from PIL import Image

    for path in (shared_data / "dji" / "photos").iterdir():
        ours = read_exif(read_header(path).exif)
        with Image.open(path) as image:
            exif = image.getexif()
            theirs = {**exif, **exif.get_ifd(0x8769)} | {n + 0x10000: v for n, v in exif.get_ifd(0x8825).items()}
        assert {int(tag) for tag in ours} == set(theirs) & {int(tag) for tag in Tag}
        for tag, value in ours.items():
            other = theirs[int(tag)]
            if isinstance(value, str):
                assert value == other.strip("\0 ")
            else:
                values = tuple(other) if isinstance(other, (tuple, bytes)) else (other,)
                assert value == pytest.approx(tuple(map(float, values)), abs=1e-12)


def test_a_place_of_zero_zero_is_none(photo):
    exif = exif_part(gps=gps_tags(0.0, 0.0, 0.0))
    assert photo(exif, packet({"GpsLatitude": "0.0", "GpsLongitude": "0.0"})).lat_deg is None


def test_xmp_gives_the_place_where_exif_has_none_and_is_compared_where_both_have(photo):
    place = {"GpsLatitude": "+22.3372000", "GpsLongtitude": "+114.2636000"}
    found = photo(xmp=with_xmp(**place))
    assert (found.lat_deg, found.lon_deg, found.position_disagreement_m) == (22.3372, 114.2636, None)
    both = photo(exif_part(gps=gps_tags(22.33722, 114.2636, 9.0)), with_xmp(**place))
    assert both.lat_deg == pytest.approx(22.33722, abs=1e-9)
    assert both.position_disagreement_m == pytest.approx(2.22, abs=0.02)


@pytest.mark.parametrize("as_elements", [False, True])
@pytest.mark.parametrize("namespace", ["http://www.dji.com/drone-dji/1.0/", "http://www.autelrobotics.com/drone/", "x"])
def test_properties_are_found_in_any_namespace_and_form(photo, as_elements, namespace):
    found = photo(xmp=packet(ANGLES | {"RelativeAltitude": "12.5"}, namespace, "drone", as_elements))
    assert (found.gimbal_heading_deg, found.gimbal_pitch_deg, found.gimbal_roll_deg) == (30.0, -20.0, 0.0)
    assert found.height_above_takeoff_m == 12.5


def test_of_two_namespaces_the_makers_counts(photo):
    text = packet({"Make": "DJI"} | ANGLES, extra=' xmlns:a="http://example.org/" a:GimbalYawDegree="+99"')
    assert photo(xmp=text).gimbal_heading_deg == 30.0


def test_xmp_that_is_not_well_formed_is_searched(photo):
    broken = with_xmp(RtkFlag="50").replace("</rdf:RDF>", "")
    found = photo(xmp=broken)
    assert (found.gimbal_pitch_deg, found.rtk_flag) == (-20.0, 50)
    as_elements = packet(ANGLES, as_elements=True).replace("</rdf:RDF>", "")
    assert photo(xmp=as_elements).gimbal_pitch_deg == -20.0


def test_extended_xmp_is_put_together_and_left_out_where_a_piece_is_missing(photo):
    padding = "<!-- " + "x" * 5000 + " -->"
    pieces, identifier = extended_segments(packet({"RelativeAltitude": "+7.25"}) + padding)
    assert len(pieces) > 2
    main = packet(ANGLES, extra=f' xmlns:n="http://ns.adobe.com/xmp/note/" n:HasExtendedXMP="{identifier}"')
    assert photo(xmp=main, further=pieces).height_above_takeoff_m == 7.25
    assert photo(xmp=main, further=pieces[::-1]).height_above_takeoff_m == 7.25
    without = photo(xmp=main, further=pieces[:1] + pieces[2:])
    assert (without.height_above_takeoff_m, without.gimbal_heading_deg) == (None, 30.0)
    assert photo(xmp=packet(ANGLES), further=pieces).height_above_takeoff_m is None  # nobody names it


def test_the_kind_of_altitude_is_what_the_maker_means(photo):
    exif = exif_part(gps=gps_tags(50.0, 5.0, 80.0))
    rtk = photo(exif, with_xmp(AbsoluteAltitude="+80.123", AltitudeType="RtkAlt"))
    assert (rtk.height_ellipsoid_m, rtk.altitude_amsl_m) == (80.123, None)
    older = photo(exif, with_xmp(AbsoluteAltitude="+80.123", RtkFlag="50"))
    assert older.height_ellipsoid_m == 80.123
    single = photo(exif, with_xmp(AbsoluteAltitude="+80.123", RtkFlag="16"))
    assert (single.height_ellipsoid_m, single.altitude_amsl_m) == (None, 80.123)
    exif_three = photo(exif_part(gps=gps_tags(50.0, 5.0, 80.0, below=3)))
    assert exif_three.height_ellipsoid_m == -80.0


def test_skydio_and_parrot_photos_are_understood(photo):
    skydio = (
        "<s:Latitude>37.5</s:Latitude><s:Longitude>-122.25</s:Longitude><s:AbsoluteAltitude>35.5</s:AbsoluteAltitude>"
        '<s:CameraOrientationNED rdf:parseType="Resource"><s:Roll>0.5</s:Roll><s:Pitch>-45.5</s:Pitch>'
        "<s:Yaw>190</s:Yaw></s:CameraOrientationNED>"
        '<s:CameraOrientationFLU s:Roll="1" s:Pitch="2" s:Yaw="3"/>'
    )
    text = packet({}, "https://www.skydio.com/drone-skydio/1.0/", "s").replace(
        "</rdf:Description>", f"{skydio}</rdf:Description>"
    )
    found = photo(exif_part(gps=gps_tags(37.5, -122.25, 35.5)), text)
    assert (found.gimbal_heading_deg, found.gimbal_pitch_deg, found.gimbal_roll_deg) == (-170.0, -45.5, 0.5)
    assert (found.height_ellipsoid_m, found.altitude_amsl_m) == (35.5, None)
    parrot = {"CameraYawDegree": "146.848038", "CameraPitchDegree": "-51.988888", "CameraRollDegree": "-0.052789"}
    found = photo(xmp=packet(parrot, "http://www.parrot.com/drone-parrot/1.0/", "drone-parrot"))
    assert (found.gimbal_heading_deg, found.gimbal_pitch_deg) == (146.848038, -51.988888)


def test_calibration_is_read_with_and_without_a_date(photo):
    numbers = "3666.666504,3666.666504,-27.0,11.5,-0.26,0.12,0.0001,-0.0002,-0.04"
    dewarp = Dewarp(3666.666504, 3666.666504, -27.0, 11.5, -0.26, 0.12, 0.0001, -0.0002, -0.04)
    for text in (f"2018-09-04;{numbers}", numbers):
        found = photo(xmp=with_xmp(DewarpData=text, DewarpFlag="1", CalibratedFocalLength="3666.6"))
        assert (found.dewarp, found.is_dewarped, found.calibrated_focal_length_px) == (dewarp, True, 3666.6)
    assert photo(xmp=with_xmp(DewarpData="2018-09-04;0,0,0,0,0,0,0,0,0")).dewarp is None
    assert photo(xmp=with_xmp(DewarpData="1,2,3")).dewarp is None


@pytest.mark.parametrize(("unit", "units_in_mm"), [(2, 25.4), (3, 10.0), (4, 1.0), (None, 25.4)])
def test_resolution_on_the_sensor_counts_for_the_stored_picture(photo, unit, units_in_mm):
    tags = {0xA20E: 10.0 * units_in_mm} | ({} if unit is None else {0xA210: unit})
    assert photo(exif_part(photo=tags)).focal_plane_px_per_mm == pytest.approx(10.0)
    assert photo(exif_part(photo=tags | {0xA002: 640})).focal_plane_px_per_mm == pytest.approx(1.0)  # now 64 px
    focal = pix4d({"Camera:PerspectiveFocalLength": "3.98"})
    assert photo(exif_part(photo=tags), focal).calibrated_focal_length_px == pytest.approx(39.8)
    assert photo(xmp=focal).calibrated_focal_length_px is None
    assert photo(exif_part(photo={0xA20E: 72.0 / 1000.0})).focal_plane_px_per_mm is None  # a sensor of 20 m


def test_gimbal_angles_of_exactly_zero_are_none_unless_the_nose_points_north(photo):
    zero = dict.fromkeys(ANGLES, "+0.00")
    flight = {"FlightPitchDegree": "+1.0", "FlightRollDegree": "+0.3"}
    assert photo(xmp=packet(zero)).gimbal_pitch_deg is None
    assert photo(xmp=packet(zero | flight | {"FlightYawDegree": "+120.0"})).gimbal_pitch_deg is None
    assert photo(xmp=packet(zero | flight | {"FlightYawDegree": "-1.5"})).gimbal_pitch_deg == 0.0
    assert photo(xmp=packet(zero | dict.fromkeys((*flight, "FlightYawDegree"), "0.00"))).gimbal_pitch_deg is None


def test_a_gimbal_that_swung_through_the_vertical_is_told_without_a_roll():
    assert upright(94.7, -89.5, 180.0) == pytest.approx((-85.3, -90.5, 0.0))
    assert upright(-85.3, -88.0, -180.0) == pytest.approx((94.7, -92.0, 0.0))
    assert upright(10.0, -20.0, 180.0) == (10.0, -20.0, 180.0)  # hangs upside down and looks where it says
    assert upright(10.0, None, 180.0) == (10.0, None, 180.0)


@given(st.floats(-180, 180), st.floats(-134, -46), st.sampled_from((-180.0, 180.0)))
def test_telling_it_without_a_roll_leaves_the_camera_as_it_was(yaw, pitch, roll):
    heading, steep, level = upright(yaw, pitch, roll)
    assert level == pytest.approx(0.0, abs=1e-9)
    before = camera_axes(math.radians(yaw), math.radians(pitch))
    after = camera_axes(math.radians(heading), math.radians(steep))
    for axis, sign in zip(range(3), (1.0, -1.0, -1.0), strict=True):  # a roll of 180 turns right and up over
        assert after[axis] == pytest.approx(sign * before[axis], abs=1e-9)


def test_speeds_and_range_finder(photo):
    found = photo(xmp=with_xmp(FlightXSpeed="3.0", FlightYSpeed="-4.0", FlightZSpeed="12.0", LRFTargetDistance="0.000"))
    assert found.speed_m_s == pytest.approx(13.0)
    assert found.range_m is found.range_lat_deg is None
    assert photo(xmp=with_xmp(FlightXSpeed="3.0")).speed_m_s is None


@pytest.mark.parametrize("value", ["nan", "inf", "1e999", "-", "", "1/0", "north", "+-3", "1_0e400"])
def test_values_that_are_no_numbers_are_none(photo, value):
    found = photo(xmp=packet(ANGLES | {"GimbalPitchDegree": value, "RelativeAltitude": value, "RtkFlag": value}))
    assert found.gimbal_pitch_deg is found.height_above_takeoff_m is found.rtk_flag is None
    assert found.gimbal_heading_deg == 30.0


@pytest.mark.parametrize("clock", ["0000:00:00 00:00:00", "2024:13:45 99:00:00", "", "yesterday"])
def test_clocks_that_were_never_set_give_no_time(photo, clock):
    assert photo(exif_part(photo={0x9003: clock or " "})).taken_at is None


def test_the_time_of_xmp_counts_where_exif_has_none(photo):
    xmp = with_xmp(CreateDate="2021-10-22T11:30:09.205000+02:00")
    found = photo(xmp=xmp)
    assert (found.taken_at, found.utc_offset_s) == (datetime(2021, 10, 22, 11, 30, 9, 205_000), 7200.0)
    both = photo(exif_part(photo={0x9003: "2021:10:22 11:30:08", 0x9011: "-03:30"}), xmp)
    assert (both.taken_at, both.utc_offset_s) == (datetime(2021, 10, 22, 11, 30, 8), -3.5 * 3600)
    assert photo(xmp=with_xmp(CreateDate="2021-10-22")).taken_at is None  # a date says nothing of the order


def test_names_hold_no_control_characters(photo):
    found = photo(exif_part({0x010F: "D\x1b[2JJI\n"}), with_xmp(DroneModel="M3E&#133;"))
    assert (found.make, found.drone_model) == ("D[2JJI", "M3E")


@pytest.mark.parametrize(
    ("name", "index"),
    [("DJI_0007.JPG", 7), ("DJI_20230707093934_0412_T.JPG", 412), ("P0010023.JPG", 10023), ("facade.jpg", None)],
)
def test_the_cameras_count_stands_in_the_name(photo, name, index):
    assert photo(name=name).image_index == index


def test_large_dimensions_cost_nothing(tmp_path):
    content = bytearray(jpeg())
    frame = content.index(b"\xff\xc0")
    content[frame + 5 : frame + 9] = b"\xff\xff\xff\xff"
    found = read_photo(save(tmp_path / "huge.jpg", bytes(content)))
    assert (found.width_px, found.height_px) == (65535, 65535)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "no JPEG"),
        (b"\x89PNG\r\n", "no JPEG"),
        (jpeg()[:30], "ends in its header"),
        (b"\xff\xd8\xff\xd9", "no picture"),
        (b"\xff\xd8\xff\xe1\x00\x01", "damaged"),
        (b"\xff\xd8" + b"hello", "damaged"),
        (b"\xff\xd8" + b"\xff\xe3\x00\x02" * 5000, "hostile"),
        (b"\xff\xd8" + b"\xff" * 3_000_000, "damaged"),
    ],
)
def test_what_is_no_photo_is_refused_with_its_name(tmp_path, content, words):
    path = save(tmp_path / "x.jpg", content)
    with pytest.raises(InputError, match=words) as refused:
        read_photo(path)
    assert str(path) in str(refused.value)


def test_missing_files_and_folders_are_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_photo(tmp_path / "none.jpg")
    with pytest.raises(InputError, match="found a folder"):
        read_photo(tmp_path)


PARROT_TAGS = {"Camera:Yaw": "146.781036", "Camera:Pitch": "38.011101", "Camera:Roll": "-0.041258"}
PARROT_NED = (146.848038, -51.988888, -0.052789)
"""Of one photo in both conventions (developer.parrot.com, "Embedded Photo Metadata", examples)."""


def pix4d(properties):
    return packet(
        {name.partition(":")[2]: value for name, value in properties.items()}, "http://pix4d.com/camera/1.0/", "Camera"
    )


def test_pix4ds_angles_are_those_that_parrot_gives_beside_them(photo):
    found = photo(xmp=pix4d(PARROT_TAGS | {"Camera:GPSXYAccuracy": "845389/2097152", "Camera:GPSZAccuracy": "61/100"}))
    angles = (found.gimbal_heading_deg, found.gimbal_pitch_deg, found.gimbal_roll_deg)
    assert angles == pytest.approx(PARROT_NED, abs=2e-4)
    assert found.accuracy_horizontal_m == pytest.approx(845389 / 2097152)
    assert found.accuracy_vertical_m == 0.61
    assert (found.accuracy_heading_deg, found.accuracy_tilt_deg) == (None, None)


def test_pitches_below_zero_in_pix4ds_tags_are_autels_own(photo):
    tags = {"Camera:Yaw": "30", "Camera:Pitch": "-20", "Camera:Roll": "0"}
    autel = photo(exif_part({0x010F: "Autel Robotics"}), pix4d(tags))
    assert (autel.gimbal_heading_deg, autel.gimbal_pitch_deg) == (30.0, -20.0)
    other = photo(exif_part({0x010F: "Parrot"}), pix4d(tags))
    assert (other.gimbal_heading_deg, other.gimbal_pitch_deg) == pytest.approx((30.0, -110.0))


@given(st.floats(-180, 180), st.floats(-20, 120), st.floats(-30, 30))
def test_pix4ds_angles_leave_the_camera_as_it_was(yaw, pitch, roll):
    def turn(axis, degrees):
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        i, j = (axis + 1) % 3, (axis + 2) % 3
        matrix = np.eye(3)
        matrix[i, i] = matrix[j, j] = c
        matrix[i, j], matrix[j, i] = -s, s
        return matrix

    theirs = turn(2, yaw) @ turn(1, pitch) @ turn(0, roll)  # columns: top of the picture, right, line of sight
    heading, up, about = from_pix4d(yaw, pitch, roll)
    ours = turn(2, heading) @ turn(1, up) @ turn(0, about)  # columns: line of sight, right, bottom
    np.testing.assert_allclose(ours, np.stack([theirs[:, 2], theirs[:, 1], -theirs[:, 0]], axis=1), atol=1e-6)
