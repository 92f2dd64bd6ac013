"""The streets before a site's facades: in which directions they look, and what ground is free there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from planning.coverage.sections import panel_frames
from planning.geo.mesh import TriangleMesh
from planning.site.records import SiteModel

Array = NDArray[np.float64]

UPRIGHT = 0.5
"""Horizontal length of a panel's unit normal from which it looks at the surroundings and not at the sky."""

HOME_CLEAR_M = 13.0
"""Around where the aircraft starts and may land: the usual distance from everything, and 3 m."""

WALL_CLEAR_M = 0.8
"""Around the building and its obstacles: room for a person."""

FRONT_M = 5.0
"""Trees and cars keep this far from facades."""

Keeps = Literal["streets", "fronts", "walls"]
"""What something leaves free: all streets, as a building does; the last metres before facades; or walls alone."""


@dataclass(frozen=True, slots=True, eq=False)
class Street:
    """What panels that look one way have before them.

    Places are given along the street (m to the right as seen from outside), across (m outwards) and above ground, from
    its foot.

    Parameters
    ----------
    foot_enu_m
        On the ground, shape (3,): along the street in the middle of the panels, across at the foremost of them.
    outward
        Unit vector, shape (2,).
    half_m
        Half the panels' extent along the street.
    """

    foot_enu_m: Array
    outward: Array
    half_m: float

    @property
    def right(self) -> Array:
        """Unit vector along the street, shape (2,)."""
        return np.array([-self.outward[1], self.outward[0]])

    def points_enu_m(self, along_across_up_m: Array) -> Array:
        """Places in ENU, shape (..., 3)."""
        axes = np.zeros((3, 3))
        axes[0, :2], axes[1, :2], axes[2, 2] = self.right, self.outward, 1.0
        return np.asarray(self.foot_enu_m + along_across_up_m @ axes)

    def rectangle(self, along_m: tuple[float, float], across_m: tuple[float, float]) -> Array:
        """Corners of a rectangle on the ground, shape (4, 2), counter-clockwise seen from above."""
        (a, b), (c, d) = along_m, across_m
        return self.points_enu_m(np.array([[b, c, 0.0], [b, d, 0.0], [a, d, 0.0], [a, c, 0.0]]))[:, :2][::-1]


def streets(model: SiteModel) -> tuple[Street, ...]:
    """One street for each facade, or for each quarter of the compass into which a strongly curved one looks.

    Panels that look upwards or downwards have none.
    """
    return tuple(_streets(model))


def _streets(model: SiteModel) -> Iterator[Street]:
    for facade in model.site.facades:
        if not facade.panels:
            continue
        panels = panel_frames(np.array([panel.corners_enu_m for panel in facade.panels], np.float64))
        upright = np.hypot(panels.normals[:, 0], panels.normals[:, 1]) >= UPRIGHT
        if not upright.any():
            continue
        corners, level = panels.corners[upright], panels.normals[upright, :2]
        mean = level.sum(axis=0)
        turn = np.arctan2(level[:, 1], level[:, 0]) - np.arctan2(mean[1], mean[0])
        quarter = np.round(turn / (0.5 * np.pi)).astype(int) % 4
        for number in np.unique(quarter):
            yield _street(corners[quarter == number], level[quarter == number], model.site.airspace.ground_z_m)


def _street(corners: Array, level: Array, ground_z_m: float) -> Street:
    outward = level.sum(axis=0)
    outward = outward / np.linalg.norm(outward)
    right = np.array([-outward[1], outward[0]])
    points = corners.reshape(-1, 3)[:, :2]
    along, across = points @ right, points @ outward
    foot = 0.5 * (along.min() + along.max()) * right + across.max() * outward
    return Street(np.array([*foot, ground_z_m]), outward, float(np.ptp(along)) / 2.0)


class FreeGround:
    """What ground is still free; every place taken is taken for those that ask later."""

    def __init__(self, model: SiteModel, sides: tuple[Street, ...], street_m: float) -> None:
        import shapely

        site = model.site
        homes = [site.home_enu_m, *(point.position_enu_m for point in site.rally_points)]
        built = shapely.union_all(
            [
                _footprint(model.building).buffer(WALL_CLEAR_M),
                *(_footprint(mesh).buffer(WALL_CLEAR_M) for mesh in model.obstacles),
                *(shapely.Point(home[:2]).buffer(HOME_CLEAR_M) for home in homes),
            ]
        )
        self._taken: list[Any] = []
        streets_and_walls, fronts_and_walls = (
            shapely.union_all([built, *(shapely.Polygon(_before(side, depth)) for side in sides)])
            for depth in (street_m - 0.01, FRONT_M)
        )
        self._kept: dict[Keeps, Any] = {
            "streets": streets_and_walls,
            "fronts": fronts_and_walls,
            "walls": built,
        }

    def take(self, outline_enu_m: Array, keeps: Keeps) -> bool:
        """Take ground with a convex outline, shape (k, 2); whether it was free."""
        import shapely

        outline = shapely.Polygon(outline_enu_m)
        if outline.intersects(self._kept[keeps]) or any(outline.intersects(other) for other in self._taken):
            return False
        self._taken.append(outline)
        return True


def _before(side: Street, depth_m: float) -> Array:
    return side.rectangle((-side.half_m - 1.0, side.half_m + 1.0), (-1.0, depth_m))


def _footprint(mesh: TriangleMesh) -> Any:
    import shapely

    triangles = shapely.polygons(mesh.corners_enu_m[:, :, :2]) if len(mesh.triangles) else np.zeros(0, object)
    return shapely.union_all(triangles[shapely.area(triangles) > 1e-6]) if len(triangles) else shapely.Polygon()
