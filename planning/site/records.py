"""The site: panels by facade, building mesh, obstacles, airspace, no-fly volumes, home and rally points, in ENU metres.

The classes mirror `site.json` field by field; `planning.site.file` reads and writes them. Every check that a single
object can make for itself is made in its `__post_init__`, so that a wrong site cannot exist. `SiteModel` adds the
geometry that the file only names.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from planning.geo.frames import Origin, Vec3
from planning.geo.mesh import MAX_COORDINATE_M, TriangleMesh, box_mesh, extrude
from planning.site.terrain import Terrain
from planning.site.zones.records import SiteZones, TimeWindow, ZoneFile

# Whether photos, logs and missions belong to a site: limits that all of them share.

MAX_DISTANCE_M = 5000.0
"""What never comes this close to the site is of another place: no facade is photographed from so far away."""

HEIGHT_DIFFERENCE_M = 2.0
"""Worth a word if both ways to count heights differ by more: receivers and barometers wander by less in a flight."""


SITE_FORMAT = "reflight-site/1"

MIN_PANEL_AREA_M2 = 1e-4
"""Smaller panels are degenerate: no pane is under 1 cm x 1 cm."""

MAX_PANEL_WARP_M = 0.05
"""A corner may lie this far off the mean plane of its panel (cold-bent glass reaches a few centimetres)."""

MAX_TILT_DEG = 10.0
"""A pane that leans further from its corners was not measured but mistaken."""


def check_point(point: Vec3, name: str) -> None:
    """Raise `ValueError` naming `name` unless `point` is finite and local."""
    for axis, value in zip("xyz", point, strict=True):
        if not math.isfinite(value):
            raise ValueError(say("expected finite metres, {} is {}", axis, value, place=name))
        if abs(value) > MAX_COORDINATE_M:
            raise ValueError(
                say(
                    "expected local ENU metres within {:.0f} m of the origin, {} is {:.10gm} (projected coordinates "
                    "such as UTM must be shifted to the site's origin first)",
                    MAX_COORDINATE_M,
                    axis,
                    value,
                    place=name,
                )
            )


@dataclass(frozen=True, slots=True)
class Panel:
    """One glass panel: four corners, counter-clockwise seen from outside, so (c2-c0) x (c3-c1) points outwards.

    `source_id` names the object the panel was imported from (an IFC GlobalId, a gml:id), where it was imported.
    `tilt_deg` is how far its glass leans from the plane of its corners to the right (along the edge from c0 to c1) and
    upwards, where that was measured: its normal is along n + tilt_right right + tilt_up up.
    """

    id: str
    corners_enu_m: tuple[Vec3, Vec3, Vec3, Vec3]
    source_id: str | None = None
    tilt_deg: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if not self.id:
            raise ValueError(say("expected a name, got an empty text", place="id"))
        for i, corner in enumerate(self.corners_enu_m):
            check_point(corner, f"corners_enu_m[{i}]")
        if self.tilt_deg is not None and not all(abs(tilt) <= MAX_TILT_DEG for tilt in self.tilt_deg):
            raise ValueError(
                say(
                    "expected -{:g} to {:g} degrees, got {}",
                    MAX_TILT_DEG,
                    MAX_TILT_DEG,
                    self.tilt_deg,
                    place="tilt_deg",
                )
            )
        # Plain numbers: NumPy takes ten times as long for four points, and large sites have thousands of panels.
        corners = self.corners_enu_m
        area_vector = _scaled(0.5, _cross(_minus(corners[2], corners[0]), _minus(corners[3], corners[1])))
        area = math.hypot(*area_vector)
        if area < MIN_PANEL_AREA_M2:
            raise ValueError(
                say(
                    "panel '{}' has an area of {:.2g} m2, so it has no normal; expected four corners in order around "
                    "the pane",
                    self.id,
                    area,
                    place="corners_enu_m",
                )
            )
        x, y, z = (0.25 * sum(values) for values in zip(*corners, strict=True))
        warp = max(abs(_dot(_minus(corner, (x, y, z)), area_vector)) for corner in corners) / area
        if warp > max(MAX_PANEL_WARP_M, 0.02 * math.sqrt(area)):
            raise ValueError(
                say(
                    "panel '{}' is not flat, a corner lies {:.2f} m off its mean plane; split it",
                    self.id,
                    warp,
                    place="corners_enu_m",
                )
            )
        edges = [_minus(corners[(i + 1) % 4], corners[i]) for i in range(4)]
        turns = (_dot(_cross(edges[i], edges[(i + 1) % 4]), area_vector) for i in range(4))
        if min(turns) < -1e-9 * area**2:
            raise ValueError(
                say(
                    "panel '{}' is not convex or its corners are not in order around the pane",
                    self.id,
                    place="corners_enu_m",
                )
            )


def _minus(a: Vec3, b: Vec3) -> Vec3:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _cross(a: Vec3, b: Vec3) -> Vec3:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _dot(a: Vec3, b: Vec3) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _scaled(factor: float, a: Vec3) -> Vec3:
    return factor * a[0], factor * a[1], factor * a[2]


@dataclass(frozen=True, slots=True)
class Facade:
    """Panels that belong to one plane or one curved surface."""

    id: str
    panels: tuple[Panel, ...]

    def __post_init__(self) -> None:
        if not self.id:
            raise ValueError(say("expected a name, got an empty text", place="id"))


@dataclass(frozen=True, slots=True)
class Obstacle:
    """A solid to keep away from: a mesh file (path relative to the site file) or an axis-aligned box."""

    id: str
    mesh: str | None = None
    box_enu_m: tuple[Vec3, Vec3] | None = None

    def __post_init__(self) -> None:
        if (self.mesh is None) == (self.box_enu_m is None):
            raise ValueError(say("obstacle '{}': expected either mesh or box_enu_m, got both or neither", self.id))
        if self.box_enu_m is not None:
            low, high = self.box_enu_m
            check_point(low, "box_enu_m[0]")
            check_point(high, "box_enu_m[1]")
            if not all(a < b for a, b in zip(low, high, strict=True)):
                raise ValueError(
                    say(
                        "obstacle '{}' needs its minimum corner first, got {:m} and {:m}",
                        self.id,
                        low,
                        high,
                        place="box_enu_m",
                    )
                )


def box_geometry(obstacle: Obstacle) -> TriangleMesh:
    """Closed box of an obstacle that is one.

    Raises
    ------
    ValueError
        The obstacle is a mesh.
    """
    if obstacle.box_enu_m is None:
        raise ValueError(say("obstacle '{}' is a mesh, not a box", obstacle.id))
    return box_mesh(np.array(obstacle.box_enu_m[0]), np.array(obstacle.box_enu_m[1]))


@dataclass(frozen=True, slots=True)
class NoFlyZone:
    """A vertical prism that must not be entered: a simple polygon, from `floor_m` to `ceiling_m` (ENU z)."""

    id: str
    polygon_enu_m: tuple[tuple[float, float], ...]
    floor_m: float
    ceiling_m: float

    def __post_init__(self) -> None:
        if len(self.polygon_enu_m) < 3:
            raise ValueError(
                say(
                    "zone '{}' needs at least 3 corners, got {}",
                    self.id,
                    len(self.polygon_enu_m),
                    place="polygon_enu_m",
                )
            )
        for i, (x, y) in enumerate(self.polygon_enu_m):
            check_point((x, y, 0.0), f"polygon_enu_m[{i}]")
        check_point((0.0, 0.0, self.floor_m), "floor_m")
        check_point((0.0, 0.0, self.ceiling_m), "ceiling_m")
        if not self.floor_m < self.ceiling_m:
            raise ValueError(
                say("zone '{}' needs a ceiling above its floor ({} m)", self.id, self.floor_m, place="ceiling_m")
            )
        import shapely

        polygon = shapely.Polygon(self.polygon_enu_m)
        if not polygon.is_valid or polygon.area < 1e-6:
            raise ValueError(say("zone '{}' crosses itself or has no area", self.id, place="polygon_enu_m"))

    def prism(self) -> TriangleMesh:
        """Closed mesh of the volume."""
        return extrude(np.array(self.polygon_enu_m), self.floor_m, self.ceiling_m)


MIN_HEIGHT_ABOVE_GROUND_M = 5.0
"""Lowest flight where a site says nothing else: people with raised arms and vans end at 3 m, overhead cables on a site
hang at 4 to 5 m, and a barometer that counts from take-off is good to a metre or two."""


def check_min_height(height_m: float | None) -> None:
    """Raise `ValueError` unless a lowest height above the ground is one, or None."""
    if height_m is not None and not (math.isfinite(height_m) and height_m >= 0.0):
        raise ValueError(say("expected 0 m or more, got {}", height_m, place="min_height_above_ground_m"))


@dataclass(frozen=True, slots=True)
class Airspace:
    """The box in which viewpoints and legs must stay; only the column above home may lie below its floor.

    `min_height_above_ground_m` is kept above `ground_z_m`, too; None: `MIN_HEIGHT_ABOVE_GROUND_M`.
    """

    min_enu_m: Vec3
    max_enu_m: Vec3
    ground_z_m: float
    no_fly: tuple[NoFlyZone, ...] = ()
    min_height_above_ground_m: float | None = None

    def __post_init__(self) -> None:
        check_min_height(self.min_height_above_ground_m)
        check_point(self.min_enu_m, "min_enu_m")
        check_point(self.max_enu_m, "max_enu_m")
        check_point((0.0, 0.0, self.ground_z_m), "ground_z_m")
        for axis, low, high in zip("xyz", self.min_enu_m, self.max_enu_m, strict=True):
            if not low < high:
                raise ValueError(
                    say("the airspace is empty, {} runs from {} to {} m", axis, low, high, place="max_enu_m")
                )

    def lowest_height_m(self, wanted_m: float | None = None) -> float:
        """Lowest flight above the ground: as wanted, else the site's, else the usual."""
        own_m = self.min_height_above_ground_m
        return next((value for value in (wanted_m, own_m) if value is not None), MIN_HEIGHT_ABOVE_GROUND_M)


@dataclass(frozen=True, slots=True)
class RallyPoint:
    """A place on the ground where an aircraft that returns by itself may land instead of home."""

    id: str
    position_enu_m: Vec3

    def __post_init__(self) -> None:
        if not self.id:
            raise ValueError(say("expected a name, got an empty text", place="id"))
        check_point(self.position_enu_m, "position_enu_m")


@dataclass(frozen=True, slots=True)
class Site:
    """The content of `site.json`: everything about a place but the meshes, which it names by path.

    A site without panels has a building mesh: the coarse model on which photos of a first flight show them. Or it is
    bare: a place alone, to look at missions that were imported.
    `place_from` is `ifc-site` where the origin is what a BIM file says of its place, and nobody has said it since, and
    `unknown` where photos say no place, or no size.
    `terrain` is the ground where it is known; without it, the ground is level.
    `zones` names files of geo-zones.
    """

    name: str
    origin: Origin
    facades: tuple[Facade, ...]
    airspace: Airspace
    home_enu_m: Vec3
    building_mesh: str | None = None
    obstacles: tuple[Obstacle, ...] = ()
    rally_points: tuple[RallyPoint, ...] = ()
    place_from: str = ""
    format: str = SITE_FORMAT
    is_bare: bool = False
    terrain: Terrain | None = None
    zones: tuple[ZoneFile, ...] = ()

    def __post_init__(self) -> None:
        if self.format != SITE_FORMAT:
            raise ValueError(say("expected '{}', got '{}'", SITE_FORMAT, self.format, place="format"))
        check_point(self.home_enu_m, "home_enu_m")
        if self.building_mesh is None and self.n_panels == 0 and not self.is_bare:
            raise ValueError(
                say(
                    "expected at least one panel, or a building_mesh on which panels can be found, got neither; add "
                    "panels, or name the mesh of the building",
                    place="facades",
                )
            )
        seen: set[str] = set()
        for facade in self.facades:
            for panel in facade.panels:
                if panel.id in seen:
                    raise ValueError(say("expected unique panel ids, '{}' occurs twice", panel.id, place="facades"))
                seen.add(panel.id)
        files = [source.file for source in self.zones]
        for file in files:
            if files.count(file) > 1:
                raise ValueError(say("expected each file once, '{}' occurs twice", file, place="zones"))

    @property
    def panels(self) -> tuple[Panel, ...]:
        """All panels, facade by facade."""
        return tuple(panel for facade in self.facades for panel in facade.panels)

    @property
    def n_panels(self) -> int:
        """Number of panels."""
        return sum(len(facade.panels) for facade in self.facades)


@dataclass(frozen=True, slots=True, eq=False)
class SiteModel:
    """A site with its geometry.

    Parameters
    ----------
    building
        The building's mesh; without triangles when the site has none.
    obstacles
        One mesh per `site.obstacles`, in that order; boxes are closed meshes here.
    sha256
        Of the site file as it was read or written, hexadecimal; empty while the site was never in a file.
    zones
        The files of geo-zones that `site.zones` names, as they were found; one that is not here has not been read.
    zones_at
        The time for which zones are looked at; None where none is planned: all count then that apply at some time.
    """

    site: Site
    building: TriangleMesh
    obstacles: tuple[TriangleMesh, ...] = ()
    sha256: str = ""
    zones: tuple[SiteZones, ...] = ()
    zones_at: TimeWindow | None = None

    def __post_init__(self) -> None:
        if len(self.obstacles) != len(self.site.obstacles):
            raise ValueError(say("expected {} obstacle meshes, got {}", len(self.site.obstacles), len(self.obstacles)))


def panel_corners(site: Site) -> NDArray[np.float64]:
    """Corners of all panels, shape (m, 4, 3), ENU metres, in the order of `site.panels`; m is 0 without panels."""
    return np.array([panel.corners_enu_m for panel in site.panels], dtype=np.float64).reshape(-1, 4, 3)


def require_panels(site: Site) -> None:
    """Refuse a site without panels: for whatever counts what is seen of them.

    Raises
    ------
    InputError
        The site has none; the message says where they come from.
    """
    if site.n_panels == 0:
        raise InputError.say(
            "site '{}' has no panels yet: find them in photos ('panels' or the Photos tab), or draw them on "
            "the building (the Site tab, or 'site import' with --panel-grid)",
            site.name,
        )


def panel_triangles(corners_enu_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Two triangles per panel, shape (2 m, 3, 3), from corners of shape (m, 4, 3)."""
    return corners_enu_m[:, [[0, 1, 2], [0, 2, 3]], :].reshape(-1, 3, 3)
