"""What the user gives beside photos: ground control points, and the numbers of a camera.

Control points are those of OpenDroneMap (`gcp_list.txt`: the coordinate system, then X Y Z, pixels, photo, name) or of
OpenSfM (`ground_control_points.json`). A camera is a COLMAP `cameras.txt`, a matrix of 3 x 3 numbers, or
JSON or TOML: focal length in pixels (fx_px, or focal_length_mm and sensor_width_mm) and the picture's size.
"""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, check_lines, read_input_file
from planning.base.json_file import parse_json, parse_toml, to_record
from planning.base.messages import say
from planning.geo.crs import crs_conversion
from reconstruction.base.cameras import Intrinsics
from reconstruction.coarse.inputs import ControlPoint
from reconstruction.colmap.folder import read_cameras_text
from reconstruction.colmap.record import intrinsics_of

INPUT_FILE, MAX_LINES = FileLimit(say("a file of control points or of a camera"), 16 * MIB), 100_000


def read_control_points(path: Path, sizes_wh: dict[str, tuple[int, int]]) -> tuple[ControlPoint, ...]:
    """Control points with a known place.

    Parameters
    ----------
    sizes_wh
        Of the photos, by name: OpenSfM counts pixels in parts of the longer side.

    Raises
    ------
    InputError
        The file is none of control points, or its coordinate system is not known.
    """
    content = read_input_file(path, INPUT_FILE)
    if path.suffix.lower() == ".json":
        return _of_opensfm(parse_json(content, path), path, sizes_wh)
    check_lines(content, MAX_LINES, path)
    return _of_list(content.decode("utf-8-sig", "replace"), path, sizes_wh)


@dataclass(frozen=True, slots=True)
class _Place:
    latitude: float
    longitude: float
    altitude: float = math.nan


@dataclass(frozen=True, slots=True)
class _Observation:
    projection: tuple[float, float]
    shot_id: str


@dataclass(frozen=True, slots=True)
class _Point:
    id: str
    position: _Place | None = None
    observations: tuple[_Observation, ...] = ()


@dataclass(frozen=True, slots=True)
class _Points:
    points: tuple[_Point, ...]


def _of_opensfm(content: Any, path: Path, sizes_wh: dict[str, tuple[int, int]]) -> tuple[ControlPoint, ...]:
    """Pixels are told from the picture's middle, in parts of its longer side; heights are above the ellipsoid."""
    found = []
    for point in to_record(content, _Points, path).points:
        place = point.position
        if place is None or not math.isfinite(place.altitude):
            continue
        seen = []
        for each in point.observations:
            name = _photo(each.shot_id, sizes_wh)
            if name is not None:
                width, height = sizes_wh[name]
                longer = max(width, height)
                x, y = each.projection
                seen.append((name, x * longer + 0.5 * width, y * longer + 0.5 * height))
        found.append(ControlPoint(point.id, place.latitude, place.longitude, place.altitude, tuple(seen)))
    return tuple(found)


def _of_list(text: str, path: Path, sizes_wh: dict[str, tuple[int, int]]) -> tuple[ControlPoint, ...]:
    lines = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith("#")]
    if len(lines) < 2:
        raise InputError(
            say("expected a line with the coordinate system, then lines 'X Y Z column row photo name'", place=path)
        )
    places: dict[str, np.ndarray] = {}
    seen: dict[str, list[tuple[str, float, float]]] = defaultdict(list)
    for number, line in enumerate(lines[1:], 2):
        parts = line.split()
        try:
            place, x, y = np.array(parts[:3], float), float(parts[3]), float(parts[4])
            photo = parts[5]
        except (ValueError, IndexError) as error:
            raise InputError(
                say("line {}: expected 'X Y Z column row photo name', found '{}'", number, line[:80], place=path)
            ) from error
        key = parts[6] if len(parts) > 6 else ", ".join(parts[:3])
        name = _photo(photo, sizes_wh)
        places[key] = place
        if name is not None:
            seen[key].append((name, x, y))
    coordinates = np.array(list(places.values()))
    try:
        conversion = crs_conversion(_crs_name(lines[0]), coordinates)
    except InputError as error:
        raise InputError(say("line 1: {}", error, place=path)) from error
    lat, lon, height = conversion.geodetic(coordinates)
    return tuple(
        ControlPoint(name, float(lat[i]), float(lon[i]), float(height[i]), tuple(seen[name]))
        for i, name in enumerate(places)
    )


def _crs_name(line: str) -> str:
    """OpenDroneMap also writes `WGS84 UTM 32N`."""
    words = line.upper().replace("_", " ").split()
    if len(words) == 3 and words[:2] == ["WGS84", "UTM"] and words[2][:-1].isdecimal() and words[2][-1] in "NS":
        return f"EPSG:{32600 + int(words[2][:-1]) + (100 if words[2][-1] == 'S' else 0)}"
    return line


def _photo(name: str, sizes_wh: dict[str, tuple[int, int]]) -> str | None:
    """The photo of this name, or the only one of this file name."""
    if name in sizes_wh:
        return name
    same = [each for each in sizes_wh if Path(each).name == Path(name).name]
    return same[0] if len(same) == 1 else None


@dataclass(frozen=True, slots=True)
class _Camera:
    """As a plan's camera has it, or in pixels."""

    image_width_px: int
    image_height_px: int
    fx_px: float | None = None
    fy_px: float | None = None
    cx_px: float | None = None
    cy_px: float | None = None
    distortion: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    sensor_width_mm: float | None = None
    sensor_height_mm: float | None = None
    focal_length_mm: float | None = None
    name: str = ""
    gimbal_pitch_deg: tuple[float, float] | None = None


def read_lens(path: Path, sizes_wh: dict[str, tuple[int, int]]) -> Intrinsics:
    """The camera of a file.

    Parameters
    ----------
    sizes_wh
        Of the photos, by name: a matrix alone does not say how large its picture is.

    Raises
    ------
    InputError
        The file is none of a camera.
    """
    content = read_input_file(path, INPUT_FILE)
    if path.suffix.lower() in (".json", ".toml"):
        parsed = parse_json(content, path) if path.suffix.lower() == ".json" else parse_toml(content, path)
        return _of_record(to_record(parsed.get("camera", parsed), _Camera, path), path)
    check_lines(content, MAX_LINES, path)
    text = content.decode("utf-8-sig", "replace")
    matrix = _matrix(text)
    if matrix is None:
        cameras = read_cameras_text(text, str(path))
        if len(cameras) != 1:
            raise InputError(say("expected the numbers of one camera, found {}", len(cameras), place=path))
        return intrinsics_of(cameras[0])
    # The size that most photos have.
    sizes = list(sizes_wh.values())
    width, height = max(set(sizes), key=sizes.count)
    return Intrinsics(width, height, matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2])


def _matrix(text: str) -> np.ndarray | None:
    """Nine numbers that are a camera matrix, shape (3, 3); None where the text is something else."""
    try:
        numbers = np.array(text.replace(",", " ").replace(";", " ").split(), float)
    except ValueError:
        return None
    if numbers.shape != (9,) or not np.isfinite(numbers).all():
        return None
    matrix = numbers.reshape(3, 3)
    is_camera = matrix[0, 0] > 0.0 and matrix[1, 1] > 0.0 and (matrix[2] == (0.0, 0.0, 1.0)).all()
    return matrix if is_camera else None


def _of_record(camera: _Camera, path: Path) -> Intrinsics:
    width, height = camera.image_width_px, camera.image_height_px
    fx, fy = camera.fx_px, camera.fy_px
    if fx is None and camera.focal_length_mm is not None and camera.sensor_width_mm:
        fx = camera.focal_length_mm * width / camera.sensor_width_mm
        if camera.sensor_height_mm:
            fy = camera.focal_length_mm * height / camera.sensor_height_mm
    if fx is None:
        raise InputError(
            say(
                "expected fx_px, or focal_length_mm and sensor_width_mm, beside image_width_px and image_height_px",
                place=path,
            )
        )
    cx = 0.5 * width if camera.cx_px is None else camera.cx_px
    cy = 0.5 * height if camera.cy_px is None else camera.cy_px
    try:
        return Intrinsics(width, height, fx, fx if fy is None else fy, cx, cy, camera.distortion)
    except ValueError as error:
        raise InputError(say("is no camera: {}", error, place=path)) from error
