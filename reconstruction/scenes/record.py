"""A scene that can be photographed: matt bodies, panes of glass, rooms behind them, and a sky.

Coordinates are ENU metres. Light is linear red, green, blue; 1 is what a white matt surface sends back in full sun.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Decision
from planning.geo.mesh import TriangleMesh
from planning.site.records import SiteModel

Array = NDArray[np.float64]
Rgb = tuple[float, float, float]


class Layer(StrEnum):
    """Where a body belongs; what is near is what glass mirrors from close by."""

    BUILDING = "building"
    NEAR = "near"
    GROUND = "ground"


@dataclass(frozen=True, slots=True, eq=False)
class Texture:
    """A picture that repeats over flat faces.

    Parameters
    ----------
    picture
        Shape (h, w, 3), linear reflectance 0 to 1, the first row uppermost.
    px_per_m
        Its scale.
    """

    picture: NDArray[np.float32]
    px_per_m: float


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """Something matt.

    Parameters
    ----------
    albedo
        Share of light sent back; multiplies the texture.
    texture
        Laid on each face: to the right along the level direction in the face, upwards along the steepest, counted from
        the origin. On level faces these are east and north, also where they look down: seen from below, the picture
        is its mirror image.
    """

    name: str
    layer: Layer
    mesh: TriangleMesh
    albedo: Rgb = (1.0, 1.0, 1.0)
    texture: Texture | None = None


@dataclass(frozen=True, slots=True)
class Glass:
    """What panes are made of.

    Parameters
    ----------
    index
        Of refraction.
    coating
        Reflectance that a coating adds at normal incidence, 0 to 1.
    tint
        Of light that passes the pane once.
    sheets
        1, or 2 with air between them, whose mirror images are displaced.
    gap_m
        Between two sheets.
    dirt
        Share of the pane covered by matt dust, 0 to 1.
    """

    index: float = 1.52
    coating: float = 0.0
    tint: Rgb = (0.85, 0.9, 0.88)
    sheets: int = 2
    gap_m: float = 0.016
    dirt: float = 0.0

    def __post_init__(self) -> None:
        if not 1.0 <= self.index <= 3.0:
            raise ValueError(f"index: expected 1 to 3, got {self.index}")
        if self.sheets not in (1, 2):
            raise ValueError(f"sheets: expected 1 or 2, got {self.sheets}")
        for name in ("coating", "dirt"):
            if not 0.0 <= getattr(self, name) < 1.0:
                raise ValueError(f"{name}: expected 0 to below 1, got {getattr(self, name)}")
        if not self.gap_m > 0.0:
            raise ValueError(f"gap_m: expected more than 0, got {self.gap_m}")


@dataclass(frozen=True, slots=True, eq=False)
class Panes:
    """The panes of a scene, in the order of the site's panels.

    At u metres to the right of a pane's middle and v metres above it, as seen from outside, its glass stands before the
    flat pane by

        z = bow_right (a^2 - u^2) / 2 + bow_up (b^2 - v^2) / 2 - tilt_right u - tilt_up v,

    where corners reach to u = a and v = b at most, and its unit normal is along

        n + (tilt_right + bow_right u) right + (tilt_up + bow_up v) up,

    with n, right and up of the flat pane: a tilt turns the whole pane about its middle, a bow is a curvature (1 / R of
    a cylinder of radius R that the corners lie on; the angle of its normal is atan(u / R) in place of asin(u / R)).
    What is seen through its outline is that of the flat pane.

    Parameters
    ----------
    corners_enu_m
        Shape (m, 4, 3), counter-clockwise from outside, the lower left one first.
    tilts_rad, bows_per_m
        Shape (m, 2): to the right and upwards.
    glass
        Shape (m,): which of the scene's kinds of glass.
    rooms
        Shape (m, 3): mean light that comes from behind each pane, before it passes the glass.
    """

    corners_enu_m: Array
    tilts_rad: Array
    bows_per_m: Array
    glass: NDArray[np.int64]
    rooms: Array

    def __post_init__(self) -> None:
        m = len(self.corners_enu_m)
        expected = {
            "corners_enu_m": (m, 4, 3),
            "tilts_rad": (m, 2),
            "bows_per_m": (m, 2),
            "glass": (m,),
            "rooms": (m, 3),
        }
        for name, shape in expected.items():
            if getattr(self, name).shape != shape:
                raise ValueError(f"{name}: expected shape {shape}, got {getattr(self, name).shape}")


@dataclass(frozen=True, slots=True, eq=False)
class Interiors:
    """What is behind the panes, one room for each; neighbours may show parts of the same one.

    A room is a box behind its pane, in the pane's frame: u to the right and v upwards from its middle, w backwards.

    Parameters
    ----------
    rooms_m
        Shape (m, 5): left and right side, floor, ceiling, and depth.
    furniture_m
        Shape (m, k, 6): blocks that stand on the floor, each from left to right, its height, from w to w, and its
        light as a share of the walls'; those without height are none.
    lamps
        Shape (m,): how many times brighter than its ceiling a room's lamps are.
    lights
        Shape (m, 3): of the back wall at the window; all else in the room is a share of it.
    blinds
        Shape (m,): share of the pane, from above, that a blind covers.
    blind_lights
        Shape (m, 3): of the blinds' slats where they are brightest.
    """

    rooms_m: Array
    furniture_m: Array
    lamps: Array
    lights: Array
    blinds: Array
    blind_lights: Array

    def __post_init__(self) -> None:
        m, k = self.furniture_m.shape[:2]
        expected = {
            "rooms_m": (m, 5),
            "furniture_m": (m, k, 6),
            "lamps": (m,),
            "lights": (m, 3),
            "blinds": (m,),
            "blind_lights": (m, 3),
        }
        for name, shape in expected.items():
            if getattr(self, name).shape != shape:
                raise ValueError(f"{name}: expected shape {shape}, got {getattr(self, name).shape}")


@dataclass(frozen=True, slots=True, eq=False)
class Sky:
    """Everything far away.

    Parameters
    ----------
    sun_heading_deg, sun_elevation_deg
        Where the sun stands, clockwise from north and above the horizon; below it there is none.
    sun
        Light on a surface that faces it.
    zenith, horizon
        Of the clear sky; in between it changes with the sine of the elevation.
    panorama
        Shape (h, 2 h, 3), or None: skyline and clouds in place of the clear sky, by heading (the first column looks
        north, to the right is clockwise) and elevation (the first row is the zenith, the last the nadir).
    """

    sun_heading_deg: float = 200.0
    sun_elevation_deg: float = 35.0
    sun: Rgb = (0.75, 0.7, 0.6)
    zenith: Rgb = (0.22, 0.36, 0.62)
    horizon: Rgb = (0.62, 0.7, 0.8)
    panorama: NDArray[np.float32] | None = None

    @property
    def sun_direction_enu(self) -> Array:
        """Unit vector towards the sun, shape (3,)."""
        heading, elevation = np.radians([self.sun_heading_deg, self.sun_elevation_deg])
        return np.array([np.sin(heading) * np.cos(elevation), np.cos(heading) * np.cos(elevation), np.sin(elevation)])


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """A site that can be photographed.

    Parameters
    ----------
    site
        With the panels; its meshes are those that flights keep away from.
    bodies
        Everything matt: walls and frames of the building, the ground, what stands around.
    glasses
        Kinds of glass that `panes.glass` counts.
    interiors
        Of the panes; without, each shows the mean light of its room alone.
    terrain
        Whether the ground is the site's terrain, and why; None where there is none to decide about.
    """

    name: str
    seed: int
    site: SiteModel
    bodies: tuple[Body, ...]
    panes: Panes
    glasses: tuple[Glass, ...]
    sky: Sky
    interiors: Interiors | None = None
    terrain: Decision | None = None
