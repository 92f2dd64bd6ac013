"""One photo file as a record: what the camera and the aircraft wrote into it, in our units and frames.

Names of XMP properties are those of DJI (lists in the manuals of the Zenmuse P1, Mavic 3 and Matrice 4 series), Parrot
(developer.parrot.com, "Embedded Photo Metadata") and Skydio (support.skydio.com, "camera and metadata overview"). Autel
writes DJI's names in a namespace of its own, or, as Parrot does beside its own names, the camera tags of Pix4D
(support.pix4d.com, "Specifications of XMP camera tags").

XMP properties go by namespace and name, whether they stand as attributes or as elements (ISO 16684-1). Cameras write
packets that are not well-formed: the XT S declares a namespace twice and does not close its last instruction. Such
packets are searched for properties piece by piece. Document types are refused in both ways, so that no entity is ever
expanded.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element
from xml.sax.saxutils import unescape

from planning.base.errors import InputError
from planning.base.files import HostileXml, parse_xml
from planning.geo.frames import wrap_heading_deg
from planning.photos.exif import Tag, Value, read_exif
from planning.photos.jpeg import PhotoHeader, read_header
from planning.photos.record import RTK_FIXED, Dewarp, PhotoMetadata

RDF = "http://www.w3.org/1999/02/22-rdf-syntax-ns#"
XMLNS = "xmlns"

Properties = dict[tuple[str, str], str]
"""Text by namespace and name; a field of a structure is `Structure/Field`."""

MAX_DEPTH = 6
MAX_PROPERTIES = 5000

MAX_SCANNED_CHARACTERS = 2**18
"""Of a packet that is not well-formed; the main packet of a photo fits into a segment of 64 KiB."""

_NAME = r"(?<![\w.-])([A-Za-z_][\w.-]{0,63}):([A-Za-z_][\w.-]{0,63})"
_ATTRIBUTE = re.compile(_NAME + r"""\s{0,8}=\s{0,8}(?:"([^"<]{0,4096})"|'([^'<]{0,4096})')""")
_ELEMENT = re.compile(rf"<{_NAME}>([^<]{{0,4096}})</")


def read_xmp(packet: bytes) -> Properties:
    """Properties of a packet; none where it is no XMP."""
    content = packet.strip(b"\0 \t\r\n")
    try:
        root = parse_xml(content, "XMP")
    except (HostileXml, InputError):
        return {}
    except ValueError:
        return _scanned(content)
    found: Properties = {}
    for description in root.iter(f"{{{RDF}}}Description"):
        for key, text in _of_node(description, "", 0):
            if len(found) >= MAX_PROPERTIES:
                return found
            found.setdefault(key, text)
    return found


def _of_node(node: Element, path: str, depth: int) -> Iterator[tuple[tuple[str, str], str]]:
    """Properties in attributes and child elements of a node."""
    for name, text in node.attrib.items():
        namespace, local = _split(name)
        if namespace not in ("", RDF):
            yield (namespace, path + local), text.strip()
    if depth >= MAX_DEPTH:
        return
    for child in node:
        namespace, local = _split(child.tag)
        if namespace == RDF:  # Description, Seq, li: they hold, but are no part of a name
            if local != "Description" or depth > 0:
                yield from _of_node(child, path, depth + 1)
            continue
        text = (child.text or "").strip()
        if text:
            yield (namespace, path + local), text
        yield from _of_node(child, f"{path}{local}/", depth + 1)


def _split(name: str) -> tuple[str, str]:
    if name.startswith("{"):
        namespace, _, local = name[1:].partition("}")
        return namespace, local
    return "", name


def _scanned(content: bytes) -> Properties:
    """Properties of a packet that is not well-formed, without structures."""
    text = content.decode("utf-8", "replace")[:MAX_SCANNED_CHARACTERS]
    if "<!" in text:
        return {}
    pairs = [(m[1], m[2], m[3] if m[3] is not None else m[4]) for m in _ATTRIBUTE.finditer(text)]
    namespaces = {name: value for prefix, name, value in pairs if prefix == XMLNS}
    pairs += [(m[1], m[2], m[3]) for m in _ELEMENT.finditer(text)]
    found: Properties = {}
    for prefix, name, value in pairs[:MAX_PROPERTIES]:
        namespace = namespaces.get(prefix)
        if namespace not in (None, RDF) and value.strip():
            found.setdefault((str(namespace), name), unescape(value.strip()))
    return found


# XMP properties by their name: makers' namespaces vary between their own models, names hardly do.

MAKERS = ("dji", "parrot", "skydio", "autel")
"""Parts of drone makers' namespaces; where several namespaces have a property, theirs goes first."""

PIX4D_CAMERA = "pix4d.com/camera"
"""Part of the namespace of Pix4D's camera tags, which Parrot and Autel write, too."""

MAX_TEXT = 1000
"""Characters; the longest text of use is DewarpData with 150."""


class MakerXmp:
    """Properties of one photo, by name."""

    def __init__(self, properties: Properties) -> None:
        self._texts: dict[str, str] = {}
        self._pix4d = {key[1]: text for key, text in properties.items() if PIX4D_CAMERA in key[0].lower()}
        is_maker = {key: any(maker in key[0].lower() for maker in MAKERS) for key in properties}
        for key in sorted(properties, key=lambda key: not is_maker[key]):
            self._texts.setdefault(key[1], properties[key])
        self.is_skydio = any("skydio" in namespace for namespace, _ in properties)

    def text(self, *names: str) -> str | None:
        """The first of these properties that says something, without control characters and not without end."""
        found = next((text for name in names if (text := self._texts.get(name))), None)
        return None if found is None else "".join(c for c in found[:MAX_TEXT] if c.isprintable())

    def number(self, *names: str, low: float = -1e6, high: float = 1e6) -> float | None:
        """The first of these properties that is a number, with or without a sign or as a fraction, within a range."""
        return next((n for name in names if (n := number(self._texts.get(name), low, high)) is not None), None)

    def angle_deg(self, *names: str) -> float | None:
        """The first of these properties that is an angle."""
        return self.number(*names, low=-360.0, high=360.0)

    def pix4d(self, name: str, low: float = -360.0, high: float = 360.0) -> float | None:
        """A number among Pix4D's camera tags, whose names are too plain to be looked for in all namespaces."""
        return number(self._pix4d.get(name), low, high)


def number(text: str | None, low: float, high: float) -> float | None:
    """A number or a fraction of two, within a range; None for anything else."""
    try:
        above, _, below = (text or "").partition("/")
        value = float(above) / float(below) if below else float(above)
    except (ValueError, ZeroDivisionError):
        return None
    return value if low <= value <= high else None


# Angles of camera and aircraft in one convention, whichever the maker used.

Angles = tuple[float | None, float | None, float | None]
"""Heading, pitch, roll in degrees; None where a photo does not say."""

NORTH_DEG = 5.0
"""An aircraft whose nose is this close to north may have a gimbal at exactly 0, 0, 0."""

NEAR_NADIR_DEG = 45.0
"""From straight down: where gimbals can swing through, and angles be told as rolled by 180."""

LOCKED = 1e-9
"""Cosine of a pitch that is straight up or down, where heading and roll turn the same way."""


def angles(xmp: MakerXmp, make: str | None) -> dict[str, Any]:
    """Fields of `PhotoMetadata` that are angles."""
    flight = xmp.angle_deg("FlightYawDegree"), xmp.angle_deg("FlightPitchDegree"), xmp.angle_deg("FlightRollDegree")
    gimbal = upright(
        xmp.angle_deg("GimbalYawDegree", "CameraYawDegree", "CameraOrientationNED/Yaw"),
        xmp.angle_deg("GimbalPitchDegree", "CameraPitchDegree", "CameraOrientationNED/Pitch"),
        xmp.angle_deg("GimbalRollDegree", "CameraRollDegree", "CameraOrientationNED/Roll"),
    )
    if gimbal == (None, None, None):
        gimbal = _pix4d_tags(xmp, make)
    heading = flight[0]
    if gimbal == (0.0, 0.0, 0.0) and (heading is None or flight == (0.0, 0.0, 0.0) or abs(heading) > NORTH_DEG):
        gimbal = (None, None, None)  # all zero is what stands there when nothing was recorded
    return {
        "gimbal_heading_deg": gimbal[0],
        "gimbal_pitch_deg": gimbal[1],
        "gimbal_roll_deg": gimbal[2],
        "flight_heading_deg": None if heading is None else wrap_heading_deg(heading),
        "flight_pitch_deg": flight[1],
        "flight_roll_deg": flight[2],
    }


def upright(yaw_deg: float | None, pitch_deg: float | None, roll_deg: float | None) -> Angles:
    """The same orientation with a roll within 90 degrees, where a gimbal swung through the vertical.

    Turning by yaw, pitch and roll is turning by yaw + 180, 180 - pitch and roll + 180. A camera that looks elsewhere
    than down is mounted upside down if it is rolled so: its heading and pitch stand as they are.
    """
    if yaw_deg is None or pitch_deg is None or roll_deg is None:
        return (None if yaw_deg is None else wrap_heading_deg(yaw_deg)), pitch_deg, roll_deg
    roll_deg = wrap_heading_deg(roll_deg)
    if abs(roll_deg) > 90.0 and abs(pitch_deg + 90.0) <= NEAR_NADIR_DEG:
        return wrap_heading_deg(yaw_deg + 180.0), -180.0 - pitch_deg, wrap_heading_deg(roll_deg + 180.0)
    return wrap_heading_deg(yaw_deg), pitch_deg, roll_deg


def _pix4d_tags(xmp: MakerXmp, make: str | None) -> Angles:
    """Angles of Pix4D's camera tags.

    Autel's XL715 writes pitches of its own there, 0 level and negative down. By Pix4D's convention these would look
    backwards below the aircraft, where its gimbal cannot.
    """
    yaw_deg, pitch_deg, roll_deg = xmp.pix4d("Yaw"), xmp.pix4d("Pitch"), xmp.pix4d("Roll")
    if yaw_deg is None or pitch_deg is None:
        return None, None, None
    if pitch_deg < 0.0 and "autel" in (make or "").lower():
        return upright(yaw_deg, pitch_deg, roll_deg)
    return upright(*from_pix4d(yaw_deg, pitch_deg, roll_deg or 0.0))


def from_pix4d(yaw_deg: float, pitch_deg: float, roll_deg: float) -> tuple[float, float, float]:
    """Heading, pitch, roll of a camera given by Pix4D's yaw, pitch and roll ("Yaw, Pitch, Roll angles", Pix4D support).

    Theirs turn a camera that looks straight down, the top of its picture to the north: x of the turned axes is the
    picture's top, y its right, z the line of sight. So their roll tilts the camera sideways, while a gimbal's turns it
    about its line of sight; only with a roll of 0 do the two differ by 90 degrees of pitch alone.
    """
    y, p, r = map(math.radians, (yaw_deg, pitch_deg, roll_deg))
    # Line of sight, and the picture's right and bottom, in north, east, down: R = Rz(yaw) Ry(pitch) Rx(roll).
    forward = (
        math.cos(y) * math.sin(p) * math.cos(r) + math.sin(y) * math.sin(r),
        math.sin(y) * math.sin(p) * math.cos(r) - math.cos(y) * math.sin(r),
    )
    right = (
        math.cos(y) * math.sin(p) * math.sin(r) - math.sin(y) * math.cos(r),
        math.sin(y) * math.sin(p) * math.sin(r) + math.cos(y) * math.cos(r),
    )
    forward_down, right_down, bottom_down = math.cos(p) * math.cos(r), math.cos(p) * math.sin(r), math.sin(p)
    pitch = -math.atan2(forward_down, math.hypot(right_down, bottom_down))
    if math.hypot(*forward) < LOCKED:
        return math.degrees(math.atan2(-right[0], right[1])), math.degrees(pitch), 0.0
    heading, roll = math.atan2(forward[1], forward[0]), math.atan2(right_down, bottom_down)
    return math.degrees(heading), math.degrees(pitch), math.degrees(roll)


METRES_PER_DEG = 111_320.0
"""Of latitude, to 0.5 %."""


def read_photo(path: Path) -> PhotoMetadata:
    """What a photo file says of itself; its picture is not decoded.

    Raises
    ------
    InputError
        The file cannot be read, is neither JPEG nor PNG, or its header is damaged. A photo without any metadata is none
        of that.
    """
    return _metadata(path, read_header(path))


def _metadata(path: Path, header: PhotoHeader) -> PhotoMetadata:
    tags = read_exif(header.exif or b"")
    properties: Properties = {}
    for packet in header.xmp:
        properties.update({key: text for key, text in read_xmp(packet).items() if key not in properties})
    xmp = MakerXmp(properties)
    values = {
        **_camera(tags, xmp, header.width_px),
        **_times(tags, xmp),
        **_place(tags, xmp),
        **angles(xmp, _text(tags, Tag.MAKE) or xmp.text("Make")),
        **_receiver(xmp),
        **_accuracies(tags, xmp),
    }
    return PhotoMetadata(
        path, header.width_px, header.height_px, header.is_complete, image_index=_index(path), **values
    )


def _first(tags: dict[Tag, Value], tag: Tag, low: float, high: float) -> float | None:
    """A tag's first number, within a range."""
    value = tags.get(tag)
    return None if value is None or isinstance(value, str) or not low <= value[0] <= high else value[0]


def _text(tags: dict[Tag, Value], tag: Tag) -> str | None:
    value = tags.get(tag)
    return value if isinstance(value, str) and value else None


def _index(path: Path) -> int | None:
    """The count in names such as DJI_0007.JPG and DJI_20230707093934_0007_T.JPG."""
    count = re.search(r"(?<!\d)(\d{3,8})(?:_[A-Za-z]{1,8})?$", path.stem, re.ASCII)
    return int(count[1]) if count else None


def _camera(tags: dict[Tag, Value], xmp: MakerXmp, width_px: int) -> dict[str, Any]:
    iso = _first(tags, Tag.ISO, 1, 1e7)
    orientation = _first(tags, Tag.ORIENTATION, 1, 8)
    center = xmp.number("CalibratedOpticalCenterX"), xmp.number("CalibratedOpticalCenterY")
    flag = xmp.text("DewarpFlag")
    px_per_mm = _px_per_mm(tags, width_px)
    calibrated_px = xmp.number("CalibratedFocalLength", "CalibratedFocalLength/X", low=1.0)
    perspective_mm = xmp.pix4d("PerspectiveFocalLength", 0.1, 10_000.0)
    if calibrated_px is None and perspective_mm is not None and px_per_mm is not None:
        calibrated_px = perspective_mm * px_per_mm
    return {
        "orientation": None if orientation is None else int(orientation),
        "make": _text(tags, Tag.MAKE) or xmp.text("Make"),
        "model": _text(tags, Tag.MODEL) or xmp.text("Model"),
        "drone_model": xmp.text("DroneModel"),
        "camera_serial": xmp.text("CameraSerialNumber") or _text(tags, Tag.BODY_SERIAL_NUMBER),
        "drone_serial": xmp.text("DroneSerialNumber", "SerialNumber"),
        "image_source": xmp.text("ImageSource"),
        "exposure_s": _first(tags, Tag.EXPOSURE_TIME, 1e-7, 3600.0),
        "f_number": _first(tags, Tag.F_NUMBER, 0.01, 1000.0),
        "iso": None if iso is None else int(iso),
        "focal_length_mm": _first(tags, Tag.FOCAL_LENGTH, 0.1, 10_000.0),
        "focal_length_35mm_mm": _first(tags, Tag.FOCAL_LENGTH_35MM, 0.1, 100_000.0),
        "focal_plane_px_per_mm": px_per_mm,
        "calibrated_focal_length_px": calibrated_px,
        "optical_center_px": None if center[0] is None or center[1] is None else center,
        "dewarp": _dewarp(xmp.text("DewarpData")),
        "is_dewarped": None if flag not in ("0", "1") else flag == "1",
    }


LEAST_SENSOR_MM, MOST_SENSOR_MM = 1.0, 100.0
"""Widths of sensors: other resolutions are not of a sensor."""

MM_OF_UNITS = {2: 25.4, 3: 10.0, 4: 1.0, 5: 0.001}
"""EXIF's FocalPlaneResolutionUnit: inch, centimetre; cameras also write millimetre and micrometre."""


def _px_per_mm(tags: dict[Tag, Value], width_px: int) -> float | None:
    """Pixels of the stored picture on a millimetre of the sensor; less, where EXIF names a larger picture."""
    resolution = _first(tags, Tag.FOCAL_PLANE_X_RESOLUTION, 1e-6, 1e7)
    if resolution is None:
        return None
    unit = _first(tags, Tag.FOCAL_PLANE_RESOLUTION_UNIT, 2, 5) or 2.0
    taken_px = _first(tags, Tag.PIXEL_X_DIMENSION, 1, 1e6) or width_px
    px_per_mm = resolution / MM_OF_UNITS[int(unit)] * width_px / taken_px
    return px_per_mm if LEAST_SENSOR_MM < width_px / px_per_mm < MOST_SENSOR_MM else None


def _dewarp(text: str | None) -> Dewarp | None:
    """DJI's `date;fx,fy,cx,cy,k1,k2,p1,p2,k3`; zeros stand in cameras that were not calibrated."""
    values = [number(part, -1e9, 1e9) for part in (text or "").rpartition(";")[2].split(",")]
    known = [value for value in values if value is not None]
    return Dewarp(*known) if len(values) == len(known) == 9 and known[0] > 0.0 and known[1] > 0.0 else None


def _times(tags: dict[Tag, Value], xmp: MakerXmp) -> dict[str, Any]:
    taken_at = _clock(_text(tags, Tag.DATE_TIME_ORIGINAL))
    fraction = _text(tags, Tag.SUB_SEC_TIME_ORIGINAL) or ""
    if taken_at is not None and fraction.isascii() and fraction.isdigit():
        taken_at = taken_at.replace(microsecond=int(f"{fraction:0<6.6}"))
    created = _clock(xmp.text("DateTimeOriginal", "CreateDate"))
    offset = _clock(f"2000-01-01T00:00:00{_text(tags, Tag.OFFSET_TIME_ORIGINAL) or ''}")
    zone = next((time.utcoffset() for time in (offset, created) if time is not None and time.tzinfo is not None), None)
    taken_at = taken_at or created
    exposed_at = _clock(xmp.text("UTCAtExposure"))
    return {
        "taken_at": None if taken_at is None else taken_at.replace(tzinfo=None),
        "utc_offset_s": None if zone is None else zone.total_seconds(),
        "exposed_at": None if exposed_at is None else exposed_at.replace(tzinfo=UTC),
    }


def _clock(text: str | None) -> datetime | None:
    """A time in EXIF's or ISO's way of writing; None where it is none, as in clocks never set, or a date alone."""
    if text is None or len(text) <= len("2024-05-01"):
        return None
    try:
        return datetime.fromisoformat(re.sub(r"^(\d{4}):(\d\d):(\d\d)", r"\1-\2-\3", text))
    except ValueError:
        return None


def _place(tags: dict[Tag, Value], xmp: MakerXmp) -> dict[str, Any]:
    exif, drone = exif_position_deg(tags), _drone_position_deg(xmp)
    position = exif or drone
    apart_m = None
    if exif is not None and drone is not None:
        east = math.remainder(exif[1] - drone[1], 360.0) * math.cos(math.radians(exif[0]))
        apart_m = math.hypot(exif[0] - drone[0], east) * METRES_PER_DEG
    altitude_m, is_ellipsoidal = _altitude_m(tags, xmp)
    return {
        "lat_deg": None if position is None else position[0],
        "lon_deg": None if position is None else position[1],
        "position_disagreement_m": apart_m,
        "gps_status": xmp.text("GpsStatus"),
        "height_ellipsoid_m": altitude_m if is_ellipsoidal else None,
        "altitude_amsl_m": None if is_ellipsoidal else altitude_m,
        "height_above_takeoff_m": xmp.number("RelativeAltitude", low=-1e4, high=1e5),
    }


def exif_position_deg(tags: dict[Tag, Value]) -> tuple[float, float] | None:
    """Latitude and longitude of EXIF, degrees; None where they are missing, impossible, or 0, 0 for want of a fix."""
    found = []
    for tag, reference, negative in (
        (Tag.GPS_LATITUDE, Tag.GPS_LATITUDE_REF, "S"),
        (Tag.GPS_LONGITUDE, Tag.GPS_LONGITUDE_REF, "W"),
    ):
        value, side = tags.get(tag), _text(tags, reference) or ""
        if value is None or isinstance(value, str):
            return None
        degrees, minutes, seconds = (*value, 0.0, 0.0)[:3]
        size = degrees + (minutes + seconds / 60.0) / 60.0
        found.append(-size if side.upper().startswith(negative) else size)
    return _on_globe(found[0], found[1])


def exif_altitude_m(tags: dict[Tag, Value]) -> float | None:
    """EXIF's altitude, negative where its reference says below."""
    size = _first(tags, Tag.GPS_ALTITUDE, -1e5, 1e5)
    below = _first(tags, Tag.GPS_ALTITUDE_REF, 0, 3) in (1.0, 3.0)
    return None if size is None else -abs(size) if below else size


def _drone_position_deg(xmp: MakerXmp) -> tuple[float, float] | None:
    """XMP's position; `GpsLongtitude` is how some of DJI's cameras spell it."""
    lat = xmp.number("GpsLatitude", "Latitude")
    lon = xmp.number("GpsLongitude", "GpsLongtitude", "Longitude")
    return None if lat is None or lon is None else _on_globe(lat, lon)


def _on_globe(lat_deg: float, lon_deg: float) -> tuple[float, float] | None:
    is_place = abs(lat_deg) <= 90.0 and abs(lon_deg) <= 180.0 and (abs(lat_deg) > 1e-6 or abs(lon_deg) > 1e-6)
    return (lat_deg, lon_deg) if is_place else None


def _altitude_m(tags: dict[Tag, Value], xmp: MakerXmp) -> tuple[float | None, bool]:
    """The absolute altitude, and whether it counts from the ellipsoid.

    DJI's manuals call AbsoluteAltitude a geodetic height wherever they list AltitudeType beside it; in the samples with
    either type, and known terrain, it is one. Without that property it is one if RTK was fixed, else EXIF's reference
    counts. Skydio's altitudes are ellipsoidal although EXIF's reference there says sea level.
    """
    altitude_m = xmp.number("AbsoluteAltitude", low=-1e4, high=1e5)
    if altitude_m is None:
        altitude_m = exif_altitude_m(tags)
    is_ellipsoidal = (
        xmp.text("AltitudeType") is not None
        or xmp.number("RtkFlag") == RTK_FIXED
        or xmp.is_skydio
        or _first(tags, Tag.GPS_ALTITUDE_REF, 2, 3) is not None
    )
    return altitude_m, is_ellipsoidal


def _receiver(xmp: MakerXmp) -> dict[str, Any]:
    """Speeds, RTK and the range finder."""
    flag = xmp.number("RtkFlag", low=0, high=1000)
    range_m = xmp.number("LRFTargetDistance", low=1e-3)
    spot = None
    if range_m is not None:
        lat, lon = xmp.number("LRFTargetLat"), xmp.number("LRFTargetLon")
        spot = None if lat is None or lon is None else _on_globe(lat, lon)
    return {
        "speed_north_m_s": xmp.number("FlightXSpeed", low=-200.0, high=200.0),
        "speed_east_m_s": xmp.number("FlightYSpeed", low=-200.0, high=200.0),
        "speed_vertical_m_s": xmp.number("FlightZSpeed", low=-200.0, high=200.0),
        "rtk_flag": None if flag is None else int(flag),
        "rtk_std_lon_m": xmp.number("RtkStdLon", low=0.0),
        "rtk_std_lat_m": xmp.number("RtkStdLat", low=0.0),
        "rtk_std_height_m": xmp.number("RtkStdHgt", low=0.0),
        "rtk_age_s": xmp.number("RtkDiffAge", low=0.0),
        "range_m": range_m,
        "range_lat_deg": None if spot is None else spot[0],
        "range_lon_deg": None if spot is None else spot[1],
        "range_height_m": None if range_m is None else xmp.number("LRFTargetAbsAlt"),
    }


def _accuracies(tags: dict[Tag, Value], xmp: MakerXmp) -> dict[str, Any]:
    """Standard deviations that other makers than DJI give, as Pix4D's tags have them."""
    tilts = [xmp.pix4d(name, low=1e-6) for name in ("IMUPitchAccuracy", "IMURollAccuracy")]
    horizontal_m = xmp.pix4d("GPSXYAccuracy", low=1e-6, high=1e4)
    return {
        "accuracy_horizontal_m": horizontal_m or _first(tags, Tag.GPS_H_POSITIONING_ERROR, 1e-6, 1e4),
        "accuracy_vertical_m": xmp.pix4d("GPSZAccuracy", low=1e-6, high=1e4),
        "accuracy_heading_deg": xmp.pix4d("IMUYawAccuracy", low=1e-6),
        "accuracy_tilt_deg": max((tilt for tilt in tilts if tilt is not None), default=None),
    }
