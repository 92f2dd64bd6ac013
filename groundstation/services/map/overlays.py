"""Overlays for the map: shapes and pictures from GeoJSON, KML, KMZ and GeoTIFF files, in world coordinates.

GeoJSON is read as RFC 7946 has it (longitude, latitude, WGS 84; an older "crs" is followed), KML as OGC 12-007r2
(Placemark with Point, LineString, LinearRing, Polygon, MultiGeometry). GeoTIFF pictures are brought to Web Mercator.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from groundstation.services.map.tile_source import plain_text
from groundstation.services.map.web_mercator import MAX_LAT_DEG, world_from_geodetic
from planning.base.errors import InputError, MissionError
from planning.base.files import (
    MIB,
    FileLimit,
    HostileXml,
    check_input_file,
    local_name,
    parse_xml,
    read_input_file,
    real_path,
)
from planning.base.json_file import read_json
from planning.base.messages import say

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

Floats = NDArray[np.float64]

OVERLAY_SUFFIXES = (".geojson", ".json", ".kml", ".kmz", ".tif", ".tiff")

OVERLAY_FILE = FileLimit(say("an overlay of shapes"), 64 * MIB, say("cut out the part that is wanted"))
GEOTIFF_FILE = FileLimit(say("a GeoTIFF"), 2**40)

MAX_POINTS = 500_000
"""Of an overlay: more take longer to draw than a map may stand still."""

MAX_LABELS = 500
MAX_PICTURE_PX = 2048
"""Longer side of a picture as it is shown: 16 MiB."""

MAX_BLOCK_BYTES = 256 * MIB
"""Of one piece of a GeoTIFF, which is unpacked whole."""

WORLD_M = 2.0 * math.pi * 6_378_137.0
"""Width of the world in EPSG:3857."""


@dataclass(frozen=True, slots=True, eq=False)
class OverlayPicture:
    """A picture that lies upright on the map.

    Parameters
    ----------
    rgba
        Shape (height, width, 4).
    low, high
        Upper left and lower right corner, world coordinates.
    """

    rgba: NDArray[np.uint8]
    low: tuple[float, float]
    high: tuple[float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Overlay:
    """What a file puts on the map, in world coordinates.

    Parameters
    ----------
    lines
        Each shape (k, 2), k >= 2.
    areas
        Rings of each area, outer and holes, each shape (k, 2).
    points
        Shape (n, 2).
    labels
        Names and where they stand.
    is_swapped
        Latitudes were read as longitudes and the other way round, for only so they are places.
    """

    path: Path
    lines: tuple[Floats, ...] = ()
    areas: tuple[tuple[Floats, ...], ...] = ()
    points: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    labels: tuple[tuple[str, tuple[float, float]], ...] = ()
    picture: OverlayPicture | None = None
    is_swapped: bool = False

    @property
    def name(self) -> str:
        """As the user knows it."""
        return self.path.name

    def extent(self) -> Floats:
        """Points, shape (n, 2), between which all of it lies."""
        corners = [] if self.picture is None else [np.array([self.picture.low, self.picture.high])]
        rings = [ring for area in self.areas for ring in area]
        return np.concatenate([self.points, *self.lines, *rings, *corners])

    def swapped(self) -> Overlay:
        """The same with latitudes and longitudes exchanged; a picture stays."""
        places = _swapped(np.array([place for _, place in self.labels]).reshape(-1, 2)).tolist()
        labels = tuple((text, (x, y)) for (text, _), (x, y) in zip(self.labels, places, strict=True))
        return replace(
            self,
            lines=tuple(map(_swapped, self.lines)),
            areas=tuple(tuple(map(_swapped, area)) for area in self.areas),
            points=_swapped(self.points),
            labels=labels,
            is_swapped=not self.is_swapped,
        )


FAR_M = 50_000.0
"""An overlay that lies further from the site shows nothing of it: no flight is planned so far away."""


def distance_m(extent: Floats, lat_deg: float, lon_deg: float) -> float:
    """How far a place is from the rectangle around points, shape (n, 2), world coordinates; 0 inside."""
    near = extent - world_from_geodetic(lat_deg, lon_deg)
    near[:, 0] -= np.round(near[:, 0])
    gap = np.maximum(0.0, np.maximum(near.min(axis=0), -near.max(axis=0)))
    return float(np.hypot(*gap)) * WORLD_M * math.cos(math.radians(lat_deg))


def _swapped(world: Floats) -> Floats:
    lat_deg = np.degrees(np.arctan(np.sinh(math.pi * (1.0 - 2.0 * world[:, 1]))))
    found = world_from_geodetic((world[:, 0] % 1.0) * 360.0 - 180.0, lat_deg)
    found[:, 0] = np.unwrap(found[:, 0], period=1.0)
    return found


def read_overlay(path: Path) -> Overlay:
    """What a file puts on the map.

    Raises
    ------
    InputError
        It cannot be read, is none of the formats, is damaged, or holds nothing that has a place.
    """
    suffix = path.suffix.lower()
    if suffix in (".tif", ".tiff"):
        return Overlay(path, picture=_geotiff(path))
    try:
        return _shapes(path, suffix, is_swapped=False)
    except _Swapped:
        return _shapes(path, suffix, is_swapped=True)


def _shapes(path: Path, suffix: str, *, is_swapped: bool) -> Overlay:
    shapes = _Shapes(path, is_swapped)
    if suffix in (".geojson", ".json"):
        _read_geojson(shapes)
    elif suffix == ".kml":
        _read_kml(shapes, read_input_file(path, OVERLAY_FILE))
    elif suffix == ".kmz":
        _read_kml(shapes, _kmz_content(path))
    else:
        raise InputError.say("expected a file of {}; choose another one", " ".join(OVERLAY_SUFFIXES), place=path)
    return shapes.overlay()


class _Shapes:
    """Shapes of a file as they are found, in degrees."""

    def __init__(self, path: Path, is_swapped: bool = False) -> None:
        self.path, self.is_swapped = path, is_swapped
        self.to_wgs84: Callable[[Floats], Floats] = lambda points: points
        self._lines: list[Floats] = []
        self._areas: list[tuple[Floats, ...]] = []
        self._points: list[Floats] = []
        self._labels: list[tuple[str, tuple[float, float]]] = []
        self._n_points = 0

    def add_points(self, points: Floats, name: str) -> None:
        """Points, shape (n, 2), longitude and latitude."""
        world = self._world(points)
        if len(world):
            self._points.append(world)
            self._name(name, world[0])

    def add_line(self, points: Floats, name: str) -> None:
        """A line."""
        world = self._world(points)
        if len(world) > 1:
            self._lines.append(world)
            self._name(name, world[len(world) // 2])

    def add_area(self, rings: Sequence[Floats], name: str) -> None:
        """An area with holes."""
        world = tuple(ring for ring in map(self._world, rings) if len(ring) > 2)
        if world:
            self._areas.append(world)
            self._name(name, world[0].mean(axis=0))

    def overlay(self) -> Overlay:
        """All of it."""
        points = np.concatenate([np.zeros((0, 2)), *self._points])
        if not (self._lines or self._areas or len(points)):
            raise InputError.say(
                "there is nothing in it that has a place: no points, lines or areas; choose another file",
                place=self.path,
            )
        return Overlay(
            self.path,
            tuple(self._lines),
            tuple(self._areas),
            points,
            tuple(self._labels),
            is_swapped=self.is_swapped,
        )

    def _name(self, name: str, place: Floats) -> None:
        text = plain_text(name)[:60]
        if text and len(self._labels) < MAX_LABELS:
            self._labels.append((text, (float(place[0]), float(place[1]))))

    def _world(self, points: Floats) -> Floats:
        self._n_points += len(points)
        if self._n_points > MAX_POINTS:
            raise InputError.say(
                "has more than {} points; cut out the part that is wanted, or simplify it", MAX_POINTS, place=self.path
            )
        if not len(points):
            return np.zeros((0, 2))
        degrees = self.to_wgs84(points)
        if self.is_swapped:
            degrees = degrees[:, ::-1]
        is_place = _are_places(degrees)
        if not is_place.all():
            if not self.is_swapped and _are_places(degrees[:, ::-1]).all():
                raise _Swapped
            wrong = points[int(np.argmin(is_place))]
            raise InputError.say(
                "expected longitudes and latitudes in degrees, found {:g}, {:g}; export it in WGS 84 (EPSG:4326)",
                float(wrong[0]),
                float(wrong[1]),
                place=self.path,
            )
        world = world_from_geodetic(degrees[:, 1], degrees[:, 0])
        # A line that goes over 180 E goes on there, and not around the world.
        world[:, 0] = np.unwrap(world[:, 0], period=1.0)
        return world


def _are_places(degrees: Floats) -> NDArray[np.bool_]:
    """Which rows, shape (n, 2), are a longitude and a latitude."""
    return np.asarray(np.isfinite(degrees).all(axis=1) & (np.abs(degrees) <= (360.0, 90.0)).all(axis=1))


class _Swapped(Exception):  # noqa: N818  (the name says what happened)
    """Latitudes stand where longitudes have to."""


# GeoJSON


def _read_geojson(shapes: _Shapes) -> None:
    content = read_json(shapes.path, OVERLAY_FILE)
    if not isinstance(content, dict) or "type" not in content:
        raise _no_geojson(shapes.path)
    crs = content.get("crs")
    if isinstance(crs, dict) and isinstance(crs.get("properties"), dict):
        shapes.to_wgs84 = _to_wgs84(str(crs["properties"].get("name", "")), shapes.path)
    for geometry, name in _geometries(content, shapes.path, 0):
        _add_geometry(shapes, geometry, name)


def _geometries(content: Any, path: Path, depth: int) -> Iterator[tuple[dict[str, Any], str]]:
    """Geometries without parts, with the names of their features."""
    if not isinstance(content, dict) or depth > 8:
        raise _no_geojson(path)
    kind = content.get("type")
    if kind == "FeatureCollection":
        for feature in _list(content.get("features"), path):
            yield from _geometries(feature, path, depth + 1)
    elif kind == "Feature":
        properties = content.get("properties")
        name = properties.get("name") if isinstance(properties, dict) else None
        if content.get("geometry") is not None:
            for geometry, _ in _geometries(content["geometry"], path, depth + 1):
                yield geometry, name if isinstance(name, str) else ""
    elif kind == "GeometryCollection":
        for geometry in _list(content.get("geometries"), path):
            yield from _geometries(geometry, path, depth + 1)
    else:
        yield content, ""


def _add_geometry(shapes: _Shapes, geometry: dict[str, Any], name: str) -> None:
    path, places = shapes.path, geometry.get("coordinates")
    match geometry.get("type"):
        case "Point":
            shapes.add_points(_positions([places], path), name)
        case "MultiPoint":
            shapes.add_points(_positions(places, path), name)
        case "LineString":
            shapes.add_line(_positions(places, path), name)
        case "MultiLineString":
            for line in _list(places, path):
                shapes.add_line(_positions(line, path), name)
        case "Polygon":
            shapes.add_area([_positions(ring, path) for ring in _list(places, path)], name)
        case "MultiPolygon":
            for area in _list(places, path):
                shapes.add_area([_positions(ring, path) for ring in _list(area, path)], name)
        case _:
            raise _no_geojson(path)


def _positions(places: Any, path: Path) -> Floats:
    """Longitudes and latitudes, shape (n, 2)."""
    try:
        return np.array([(float(place[0]), float(place[1])) for place in _list(places, path)]).reshape(-1, 2)
    except (TypeError, ValueError, IndexError, KeyError, OverflowError) as error:
        raise _no_geojson(path) from error


def _list(value: Any, path: Path) -> list[Any]:
    if not isinstance(value, list):
        raise _no_geojson(path)
    return value


def _no_geojson(path: Path) -> InputError:
    return InputError.say(
        "expected GeoJSON (features with points, lines or polygons), found something else; export it again", place=path
    )


def _to_wgs84(name: str, path: Path) -> Callable[[Floats], Floats]:
    """From the system that an older file names."""
    from pyproj import Transformer

    from planning.geo.crs import horizontal_part, names_wgs84, parse_crs

    if not name or names_wgs84(name):
        return lambda points: points
    try:
        transformer = Transformer.from_crs(horizontal_part(parse_crs(name)), "OGC:CRS84", always_xy=True)
    except InputError as error:
        raise InputError.say("{}; export it again", error, place=path) from error
    return lambda points: np.stack(transformer.transform(points[:, 0], points[:, 1]), axis=1)


# KML


def _kmz_content(path: Path) -> bytes:
    """The main file of a KMZ: the first KML in it."""
    from missions.mission.safe_files import open_archive, read_member

    try:
        archive, members = open_archive(path, path.name)
        with archive:
            for name, member in members.items():
                if name.lower().endswith(".kml"):
                    return read_member(archive, member, path.name)
    except MissionError as error:
        raise InputError.say("{}; export it again", error, place=path) from error
    raise InputError.say("there is no KML in it; choose another file", place=path)


def _read_kml(shapes: _Shapes, content: bytes) -> None:
    try:
        root = parse_xml(content, shapes.path)
    except HostileXml as error:
        raise InputError.say("{}; export it again", error, place=shapes.path) from error
    except ValueError as error:
        raise InputError.say("not KML, or damaged ({}); export it again", error, place=shapes.path) from error
    if local_name(root) != "kml":
        raise InputError.say("expected KML, found '{}'; choose another file", local_name(root)[:40], place=shapes.path)
    for placemark in root.iter():
        if local_name(placemark) == "Placemark":
            name = next((child.text or "" for child in placemark if local_name(child) == "name"), "")
            for child in placemark.iter():
                _add_kml(shapes, child, name)


def _add_kml(shapes: _Shapes, element: Element, name: str) -> None:
    match local_name(element):
        case "Point":
            shapes.add_points(_coordinates(element, shapes.path), name)
        case "LineString":
            shapes.add_line(_coordinates(element, shapes.path), name)
        case "Polygon":
            rings = [ring for ring in element.iter() if local_name(ring) == "LinearRing"]
            shapes.add_area([_coordinates(ring, shapes.path) for ring in rings], name)


def _coordinates(element: Element, path: Path) -> Floats:
    """Longitudes and latitudes, shape (n, 2): "lon,lat[,height]" with spaces between (section 16.2)."""
    text = next((child.text or "" for child in element if local_name(child) == "coordinates"), "")
    words = text.split()
    if len(words) > MAX_POINTS:
        raise InputError.say(
            "has more than {} points; cut out the part that is wanted, or simplify it", MAX_POINTS, place=path
        )
    try:
        pairs = [word.split(",")[:2] for word in words]
        return np.array([(float(lon), float(lat)) for lon, lat in pairs]).reshape(-1, 2)
    except ValueError as error:
        raise InputError.say(
            "expected coordinates as lon,lat in KML, found '{}'", text.strip()[:40], place=path
        ) from error


# GeoTIFF


def _geotiff(path: Path) -> OverlayPicture:
    """A picture brought to Web Mercator, at most `MAX_PICTURE_PX` on its longer side."""
    check_input_file(path, GEOTIFF_FILE)
    import rasterio
    from rasterio.enums import ColorInterp, Resampling
    from rasterio.errors import RasterioError
    from rasterio.vrt import WarpedVRT

    try:
        # Only this driver: others read further files that a name inside may point to.
        with (
            warnings.catch_warnings(action="ignore"),
            rasterio.Env(GDAL_DISABLE_READDIR_ON_OPEN="TRUE", GDAL_CACHEMAX=128, GDAL_NUM_THREADS="1"),
            rasterio.open(real_path(path), driver="GTiff") as source,
        ):
            _check_geotiff(source, path)
            # What lies beyond the turned picture's edge is known by an opacity that is added where there is none.
            has_none = source.nodata is None and ColorInterp.alpha not in source.colorinterp
            with WarpedVRT(source, crs="EPSG:3857", resampling=Resampling.bilinear, add_alpha=has_none) as warped:
                shrink = max(warped.width, warped.height) / MAX_PICTURE_PX
                width, height = (max(1, round(side / max(1.0, shrink))) for side in (warped.width, warped.height))
                rgba = _rgba(warped, source, height, width)
                left, bottom, right, top = warped.bounds
    except (RasterioError, ValueError, MemoryError) as error:
        raise InputError.say(
            "not a GeoTIFF that can be shown: it is cut off, damaged or of a kind that is not known here; copy or "
            "export it again",
            place=path,
        ) from error
    return OverlayPicture(
        rgba, (left / WORLD_M + 0.5, 0.5 - top / WORLD_M), (right / WORLD_M + 0.5, 0.5 - bottom / WORLD_M)
    )


def _check_geotiff(source: Any, path: Path) -> None:
    """Refuse what has no place, or would take more memory than there may be."""
    if source.crs is None or source.transform.is_identity:
        raise InputError.say(
            "the picture does not say where it lies; export it as GeoTIFF with a reference system", place=path
        )
    for (rows, columns), kind in zip(source.block_shapes, source.dtypes, strict=True):
        if rows * columns * np.dtype(kind).itemsize * source.count > MAX_BLOCK_BYTES:
            raise InputError.say("is stored in one piece; export it as a tiled GeoTIFF", place=path)
    bounds = source.bounds
    if source.crs.is_geographic and max(abs(bounds.bottom), abs(bounds.top)) > MAX_LAT_DEG + 0.01:
        raise InputError.say(
            "reaches beyond the end of web maps (85 degrees); cut out the part that is wanted", place=path
        )


def _rgba(warped: Any, source: Any, height: int, width: int) -> NDArray[np.uint8]:
    """Pixels as they are shown: colours as they are, else from the darkest 2 % to the brightest 2 %."""
    n_bands = 3 if source.count >= 3 else 1
    bands = warped.read(list(range(1, n_bands + 1)), out_shape=(n_bands, height, width))
    mask = warped.dataset_mask(out_shape=(height, width))
    rgba = np.zeros((height, width, 4), np.uint8)
    palette = _palette(source)
    if palette is not None:
        rgba[:] = palette[bands[0].astype(np.uint8)]
    else:
        colours = bands if n_bands == 3 else np.repeat(bands, 3, axis=0)
        if colours.dtype != np.uint8:
            seen = colours[:, mask > 0].astype(np.float64)
            seen = seen[np.isfinite(seen)]
            low, high = np.percentile(seen, (2.0, 98.0)) if len(seen) else (0.0, 1.0)
            share = (colours.astype(np.float64) - low) / max(float(high - low), 1e-12)
            colours = (255.0 * np.clip(np.nan_to_num(share), 0.0, 1.0)).astype(np.uint8)
        rgba[..., :3] = np.moveaxis(colours, 0, -1)
        rgba[..., 3] = 255
    rgba[..., 3] = np.minimum(rgba[..., 3], mask)
    return rgba


def _palette(source: Any) -> NDArray[np.uint8] | None:
    """Colours by value, shape (256, 4), where the picture has such."""
    if source.count != 1 or source.dtypes[0] != "uint8":
        return None
    try:
        table = source.colormap(1)
    except ValueError:
        return None
    palette = np.zeros((256, 4), np.uint8)
    for value, colour in table.items():
        if 0 <= value < 256:
            palette[value] = colour
    return palette
