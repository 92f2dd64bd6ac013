"""Which camera took a photo, and its intrinsics from the best that the photo says of it."""

from __future__ import annotations

import functools
import math
import re
import tomllib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from typing import NamedTuple

from planning.aircraft.catalogue import profiles
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.photos.record import Dewarp, PhotoMetadata
from reconstruction.base.cameras import STRAIGHT, Intrinsics


class CameraKind(StrEnum):
    """Which of an aircraft's cameras: those for visible light by their lens, and the others."""

    WIDE = "wide"
    ZOOM = "zoom"
    THERMAL = "thermal"
    BAND = "band"


SOURCES = {
    "widecamera": CameraKind.WIDE,
    "visiblecamera": CameraKind.WIDE,
    "zoomcamera": CameraKind.ZOOM,
    "telecamera": CameraKind.ZOOM,
    "mediumtelecamera": CameraKind.ZOOM,
    "infraredcamera": CameraKind.THERMAL,
    "narrowbandcamera": CameraKind.BAND,
}
"""DJI's words for ImageSource, in small letters."""

SUFFIXES = {"W": CameraKind.WIDE, "V": CameraKind.WIDE, "Z": CameraKind.ZOOM, "T": CameraKind.THERMAL}
"""Letters that DJI puts at the end of the names of photos that several cameras took together."""

THERMAL_SIZES = frozenset({(160, 120), (320, 256), (336, 256), (640, 512), (1280, 1024)})
"""Pictures of thermal cores (FLIR Tau and Boson, DJI); no camera for visible light on an aircraft is this small."""

MM35_DIAGONAL = math.hypot(36.0, 24.0)
"""Of the picture that 35 mm equivalents are told for, mm (CIPA DCG-001: equal diagonal angle of view)."""

FOCAL_TOLERANCE = 0.05
"""A focal length in EXIF that is within this of the catalogue's is of the same lens; EXIF rounds to 0.1 or 1 mm."""

SIZE_TOLERANCE = 0.25
"""A calibration that gives another focal length than the 35 mm equivalent by more is of another picture size: the
equivalent itself is rounded to whole millimetres, and cameras that crop for video or zoom differ by 30 % and more."""


class LensSource(StrEnum):
    """Where intrinsics are from, best first."""

    DEWARP = "dewarp data"
    CALIBRATED = "calibrated focal length"
    CATALOGUE = "focal length and catalogue sensor"
    SENSOR = "focal length and sensor size"
    EQUIVALENT = "35 mm equivalent"
    FOCAL_PLANE = "focal length and focal plane resolution"


@dataclass(frozen=True, slots=True)
class Lens:
    """Intrinsics of a photo.

    Parameters
    ----------
    source
        Where they are from.
    is_distortion_known
        Whether the distortion is part of them, or was taken out of the picture.
    passed_over
        Better sources that the photo has, but of another picture size.
    """

    intrinsics: Intrinsics
    source: LensSource
    is_distortion_known: bool = False
    passed_over: tuple[LensSource, ...] = ()


def camera_kind(photo: PhotoMetadata) -> CameraKind | None:
    """Which camera took a photo: by what it says itself, its name, or its size; None where nothing tells."""
    kind = SOURCES.get((photo.image_source or "").lower().replace(" ", ""))
    if kind is not None:
        return kind
    if (photo.width_px, photo.height_px) in THERMAL_SIZES:
        return CameraKind.THERMAL
    letter = re.search(r"_\d{3,8}_([WVZT])$", photo.path.stem)
    return SUFFIXES[letter[1]] if letter else None


def of_camera(
    photos: Sequence[PhotoMetadata], kind_of_camera: CameraKind | None = None
) -> tuple[list[PhotoMetadata], tuple[Finding, ...]]:
    """Photos of one camera; without a wish the first of `CameraKind` that there is.

    Photos of which nothing tells the camera count as wide ones: aircraft with one camera do not name it.
    """
    kinds = [camera_kind(photo) or CameraKind.WIDE for photo in photos]
    counts = Counter(kinds)
    kind_of_camera = kind_of_camera or next((kind for kind in CameraKind if counts[kind]), None)
    kept = [photo for photo, kind in zip(photos, kinds, strict=True) if kind is kind_of_camera]
    left = ", ".join(f"{n} {kind}" for kind, n in sorted(counts.items()) if kind is not kind_of_camera)
    if not left:
        return kept, ()
    text = say("photos of other cameras are left out ({}); choose another camera to use those instead", left)
    return kept, (Finding(Severity.NOTE, "photos-other-camera", text, "", float(len(photos) - len(kept)), None, ""),)


def lens_of(photo: PhotoMetadata) -> Lens | None:
    """Intrinsics of the stored picture by the first source that the photo has; None where it says too little."""
    equivalent_px = _equivalent_px(photo)
    passed_over: list[LensSource] = []
    for lens in (_of_dewarp(photo), _of_calibration(photo), _of_catalogue(photo), _of_sensor(photo)):
        if lens is None:
            continue
        if equivalent_px is None or abs(math.log(lens.intrinsics.fx_px / equivalent_px)) <= math.log1p(SIZE_TOLERANCE):
            return replace(lens, passed_over=tuple(passed_over))
        passed_over.append(lens.source)
    if equivalent_px is not None:
        return Lens(_straight(photo, equivalent_px), LensSource.EQUIVALENT, passed_over=tuple(passed_over))
    if photo.focal_length_mm is not None and photo.focal_plane_px_per_mm is not None:
        f_px = photo.focal_length_mm * photo.focal_plane_px_per_mm
        return Lens(_straight(photo, f_px), LensSource.FOCAL_PLANE)
    return None


def _straight(photo: PhotoMetadata, f_px: float) -> Intrinsics:
    return Intrinsics(photo.width_px, photo.height_px, f_px, f_px, photo.width_px / 2, photo.height_px / 2)


def _of_dewarp(photo: PhotoMetadata) -> Lens | None:
    """DJI's own calibration; a picture that was dewarped keeps its focal lengths and centre, and is straight."""
    if photo.dewarp is None or not _is_camera(photo.dewarp, photo):
        return None
    d = photo.dewarp
    distortion = STRAIGHT if photo.is_dewarped else (d.k1, d.k2, d.p1, d.p2, d.k3)
    centre = photo.width_px / 2 + d.cx_px, photo.height_px / 2 + d.cy_px
    intrinsics = Intrinsics(photo.width_px, photo.height_px, d.fx_px, d.fy_px, *centre, distortion)
    return Lens(intrinsics, LensSource.DEWARP, True)


def _is_camera(d: Dewarp, photo: PhotoMetadata) -> bool:
    """Whether the numbers can be a camera at all: square pixels to a tenth, the centre within the picture."""
    is_centred = abs(d.cx_px) < photo.width_px / 4 and abs(d.cy_px) < photo.height_px / 4
    return is_centred and 0.9 < d.fx_px / d.fy_px < 1.1 and max(map(abs, (d.k1, d.k2, d.p1, d.p2, d.k3))) < 100.0


def _of_calibration(photo: PhotoMetadata) -> Lens | None:
    f = photo.calibrated_focal_length_px
    if f is None:
        return None
    width, height = photo.width_px, photo.height_px
    x, y = photo.optical_center_px or (width / 2, height / 2)
    if not (width / 4 < x < width * 3 / 4 and height / 4 < y < height * 3 / 4):
        return None  # of another picture size
    return Lens(Intrinsics(width, height, f, f, x, y), LensSource.CALIBRATED)


def _of_catalogue(photo: PhotoMetadata) -> Lens | None:
    """By the sensor of a catalogue camera of this name, if the focal length and the picture's shape fit its own."""
    name, f = _letters(photo.model), photo.focal_length_mm
    if not name or f is None:
        return None
    width, height = photo.width_px, photo.height_px
    for profile in profiles().values():
        camera = profile.camera
        is_lens = abs(f / camera.focal_length_mm - 1.0) <= FOCAL_TOLERANCE
        shape = (width / height) / (camera.image_width_px / camera.image_height_px)
        if name in _letters(camera.name) and is_lens and abs(shape - 1.0) <= 0.01:
            fx, fy = f * width / camera.sensor_width_mm, f * height / camera.sensor_height_mm
            return Lens(Intrinsics(width, height, fx, fy, width / 2, height / 2), LensSource.CATALOGUE)
    return None


def _of_sensor(photo: PhotoMetadata) -> Lens | None:
    """By the size of the model's sensor: pictures of another shape are as wide or as high as it."""
    sensor = _sensors().get(_letters(photo.model))
    if sensor is None or sensor.picture_px not in (None, (photo.width_px, photo.height_px)):
        return None
    f_mm = photo.focal_length_mm or sensor.focal_length_mm
    if f_mm is None:
        return None
    long_px, short_px = max(photo.width_px, photo.height_px), min(photo.width_px, photo.height_px)
    px_per_mm = max(long_px / sensor.width_mm, short_px / sensor.height_mm)
    return Lens(_straight(photo, f_mm * px_per_mm), LensSource.SENSOR)


class _Sensor(NamedTuple):
    width_mm: float
    height_mm: float
    focal_length_mm: float | None
    picture_px: tuple[int, ...] | None


@functools.cache
def _sensors() -> dict[str, _Sensor]:
    """Sensors of `data/sensors.toml` by the letters of models."""
    tables = tomllib.loads((Path(__file__).parent / "data" / "sensors.toml").read_text("utf-8"))["sensor"]
    return {
        _letters(model): _Sensor(
            table["width_mm"],
            table["height_mm"],
            table.get("focal_length_mm"),
            tuple(table["picture_px"]) if "picture_px" in table else None,
        )
        for table in tables
        for model in table["models"]
    }


def _letters(name: str | None) -> str:
    return re.sub(r"[^a-z0-9]", "", (name or "").lower())


def _equivalent_px(photo: PhotoMetadata) -> float | None:
    """Focal length by the 35 mm equivalent, in pixels of the picture's own diagonal."""
    if photo.focal_length_35mm_mm is None:
        return None
    return photo.focal_length_35mm_mm / MM35_DIAGONAL * math.hypot(photo.width_px, photo.height_px)
