"""Buildings of a city model, whatever its format: the choice of one, its windows, mesh and neighbours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.progress import Monitor
from planning.geo.crs import crs_conversion
from planning.geo.mesh import from_corners, join
from planning.geo.solids import Solids
from planning.site.importing.ground import DECK_M, END_QUANTILES, EVEN_M, StatedGround, place_on_ground, stated_ground
from planning.site.importing.options import ImportOptions
from planning.site.importing.placement import Placement, place
from planning.site.importing.polygons import area_vector, triangulate
from planning.site.importing.source import (
    HOW_TO_GET_PANELS,
    MAX_NAMED,
    BuildingChoice,
    SourceModel,
    SourceWindow,
    left_out_notes,
)
from planning.site.importing.window_faces import pane_of_polygons

Array = NDArray[np.float64]
Rings = tuple[Array, ...]
"""Outer ring, then holes, each of shape (k, 3), file coordinates, not repeating the first point."""

NEIGHBOUR_REACH_M = 20.0
"""Other buildings up to this far outside the airspace's sides are kept as obstacles; they may hide panels."""

JOINED_GAP_M = 10.0
"""Buildings with windows that stand no further apart are one site; the distance kept from them is no smaller."""

MIN_RING_POINTS = 3
"""A ring of fewer encloses nothing."""


@dataclass(slots=True, eq=False)
class CityBuilding:
    """One building with its parts, of one level of detail.

    Parameters
    ----------
    id
        As the file has it, else a number.
    name
        May be empty.
    part_ids
        Identifiers of its parts.
    windows
        Faces by identifier of the window.
    faces
        All other faces of the building that exist in the world (no interior, no closure surfaces).
    ground
        The faces among them that stand on the ground, as the file says.
    n_unread_windows
        Windows whose geometry is of a kind that is not read.
    left_out
        Identifiers of what was broken, or of what holds it.
    """

    id: str
    name: str = ""
    part_ids: tuple[str, ...] = ()
    windows: dict[str, list[Rings]] = field(default_factory=dict)
    faces: list[Rings] = field(default_factory=list)
    ground: list[Rings] = field(default_factory=list)
    n_unread_windows: int = 0
    left_out: list[str] = field(default_factory=list)

    def polygons(self) -> list[Rings]:
        """All faces, windows last."""
        return self.faces + [rings for faces in self.windows.values() for rings in faces]

    def points(self) -> Array:
        """Points of all rings, shape (n, 3)."""
        rings = [ring for polygon in self.polygons() for ring in polygon]
        return np.concatenate(rings) if rings else np.zeros((0, 3))

    def triangles(self) -> Array:
        """All faces in triangles, shape (t, 3, 3); a window given twice is there once, or nothing would be closed."""
        glass = {
            np.sort(rings[0].round(3), axis=0).tobytes(): rings for faces in self.windows.values() for rings in faces
        }
        return np.concatenate([triangulate(rings) for rings in (*self.faces, *glass.values())])

    def at(self, placement: Placement) -> CityBuilding:
        """Same building in local ENU metres."""
        sizes = [len(ring) for polygon in self.polygons() for ring in polygon]
        rings = iter(np.split(placement.enu(self.points()), np.cumsum(sizes)[:-1]))

        def moved(polygons: list[Rings]) -> list[Rings]:
            return [tuple(next(rings) for _ in polygon) for polygon in polygons]

        faces = moved(self.faces)
        windows = {window_id: moved(polygons) for window_id, polygons in self.windows.items()}
        return replace(self, windows=windows, faces=faces)


def merged(buildings: Sequence[CityBuilding]) -> CityBuilding:
    """Several buildings as one, called after the first; windows of the same identifier keep apart."""
    windows: dict[str, list[Rings]] = {}
    for building in buildings:
        for window_id, faces in building.windows.items():
            windows[window_id if window_id not in windows else f"{building.id}/{window_id}"] = faces
    return replace(
        buildings[0],
        windows=windows,
        faces=[rings for building in buildings for rings in building.faces],
        ground=[rings for building in buildings for rings in building.ground],
        n_unread_windows=sum(building.n_unread_windows for building in buildings),
        left_out=[name for building in buildings for name in building.left_out],
    )


def city_source(
    path: Path, buildings: Sequence[CityBuilding], crs: str | None, options: ImportOptions, monitor: Monitor
) -> SourceModel:
    """Model of one building of a city model, or of a few that stand together.

    Parameters
    ----------
    crs
        Name of the coordinate reference system as the file gives it.

    Raises
    ------
    InputError
        There is no building, no such building, none with windows, or no place on earth.
    """
    solid = [building for building in buildings if len(building.points())]
    if not solid:
        raise InputError.say("there is no building with surfaces in this file", place=path)
    if options.panels_required and not options.panel_grids and not any(building.windows for building in solid):
        raise InputError.say("no building in this file has windows; {}", HOW_TO_GET_PANELS, place=path)
    chosen, choice = _choose(path, solid, crs, options)
    wanted = merged(chosen)
    corners = wanted.triangles()
    if not len(corners):
        raise InputError.say("building '{}' has no surface with an area", wanted.id, place=path)
    stands = place_on_ground(
        corners.reshape(-1, 3),
        np.arange(3 * len(corners)).reshape(-1, 3),
        stated_ground(options) or _ground_surface(wanted),
        lambda points, z: _placement(crs, points, z, options),
    )
    placement = stands.placement
    local = wanted.at(placement)
    moved = [building.at(placement) for building in solid]
    others = [building for building, original in zip(moved, solid, strict=True) if original not in chosen]
    building = from_corners(stands.vertices_enu_m.reshape(-1, 3, 3)[stands.is_kept])
    near = _near(building.vertices_enu_m, others, options.airspace_margin_m + NEIGHBOUR_REACH_M)
    meshes = []
    for done, other in enumerate(near):
        monitor.report(say("surfaces"), done, len(near))
        meshes.append(from_corners(other.triangles()))
    notes = [*placement.georeference.notes, *choice, *stands.notes]
    if others:
        notes.append(
            say(
                "other buildings in the file: {} within reach of the airspace, kept as obstacles; {} further "
                "away, left out",
                len(near),
                len(others) - len(near),
            )
        )
    notes += left_out_notes(wanted.left_out)
    if local.n_unread_windows:
        notes.append(
            say("windows given as a shared prototype (implicit geometry), not read: {}", local.n_unread_windows)
        )
    return SourceModel(
        name=local.name,
        windows=tuple(_windows(local)),
        building=building,
        neighbours=join(meshes),
        placement=placement,
        notes=tuple(notes),
        choices=tuple(_choice(building) for building in moved),
        terrain=stands.terrain,
        question=stands.question,
    )


def _ground_surface(building: CityBuilding) -> StatedGround | None:
    """The ground by the surfaces that the file says stand on it; None without any, or where they differ by a storey.

    Where there are windows alone, as in a model of panes, it is at the lowest of them.
    """
    if not building.faces:
        lowest = float(building.points()[:, 2].min())
        note = say(
            "ground: the file holds windows alone, the lowest at z = {:.2f}, which is taken; check it (--ground)",
            lowest,
        )
        return StatedGround(lowest, note)
    rings = [surface[0] for surface in building.ground]
    if not rings:
        return None
    heights = np.array([np.median(ring[:, 2]) for ring in rings])
    areas = np.array([np.linalg.norm(area_vector(ring)) for ring in rings])
    order = np.argsort(heights)
    share = np.cumsum(areas[order]) / max(float(areas.sum()), 1e-12)
    low, high = (float(heights[order][np.searchsorted(share, part)]) for part in END_QUANTILES)
    if high - low > DECK_M[1]:
        return None
    if high - low <= EVEN_M:
        middle = float(heights[order][np.searchsorted(share, 0.5)])
        return StatedGround(
            middle, say("ground: z = {:.2f} of the file, its GroundSurface (--ground names another)", middle)
        )
    return StatedGround(
        high,
        say(
            "ground: the file's GroundSurface lies between z = {:.2f} and {:.2f}; the highest is taken, so "
            "that heights above ground are safe on every side (--ground names another)",
            low,
            high,
        ),
    )


def _choice(building: CityBuilding) -> BuildingChoice:
    """A building in local metres as one to choose."""
    east, north, up = np.ptp(building.points(), axis=0).tolist()
    return BuildingChoice(building.id, building.name, len(building.windows), (east, north, up))


def _windows(building: CityBuilding) -> Iterator[SourceWindow]:
    for window_id, polygons in building.windows.items():
        pane = pane_of_polygons(polygons)
        if pane is not None:
            yield SourceWindow(window_id, pane.outline, pane.thickness_m, pane.is_oriented)


def _placement(crs: str | None, points: Array, ground_z: float, options: ImportOptions) -> Placement:
    found = None
    if crs is not None and options.crs is None and options.origin is None:
        try:
            found = crs_conversion(crs, points, options.axis_order, options.height_reference)
        except InputError as error:
            raise InputError.say(
                "{}; where the coordinates are local ones, give --origin LAT,LON,HEIGHT (of their zero point)", error
            ) from error
    return place(found, points, ground_z, options)


def _choose(
    path: Path, buildings: list[CityBuilding], crs: str | None, options: ImportOptions
) -> tuple[list[CityBuilding], tuple[str, ...]]:
    """The building named, the one that the panel grid is on, or the one with most windows and those beside it.

    Where none has windows and that is allowed, the one with the most surfaces.
    """
    if options.building is not None:
        for building in buildings:
            if options.building in (building.id, *building.part_ids):
                return [building], ()
        raise InputError.say(
            "there is no building '{}'; there are {}", options.building, _listed(buildings), place=path
        )
    if len(buildings) == 1:
        return buildings, ()
    if options.panel_grids:
        nearest = _nearest(buildings, np.array(options.panel_grids[0].corners), crs, options)
        return [nearest], (say("the facade grid is on building '{}'", nearest.id),)
    with_windows = sorted((b for b in buildings if b.windows), key=lambda b: -len(b.windows))
    if not with_windows:
        largest = max(buildings, key=lambda building: len(building.faces))
        return [largest], (say("no building in the file has windows; '{}' has the most surfaces", largest.id),)
    points = with_windows[0].points()
    placement = _placement(crs, points, float(points[:, 2].min()), options)
    local = [building.at(placement) for building in with_windows]
    beside = _near(local[0].points(), local[1:], JOINED_GAP_M)
    chosen = [with_windows[0], *(b for b, moved in zip(with_windows[1:], local[1:], strict=True) if moved in beside)]
    left = [building for building in with_windows if building not in chosen]
    note = say("the site is {}", _listed(chosen))
    if left:
        note += say("; {} further away, to be imported with --building ID", _listed(left))
    return chosen, (note,)


def _nearest(buildings: list[CityBuilding], grid: Array, crs: str | None, options: ImportOptions) -> CityBuilding:
    """Building whose surfaces are nearest to the middle of a panel grid, given by three corners, file coordinates."""
    placement = _placement(crs, grid, float(grid[:, 2].min()), options)
    corners = placement.enu(grid)
    middle = 0.5 * (corners[1] + corners[2])[None]
    local = [building.at(placement) for building in buildings]
    gaps = [_box_gap(building.points(), middle) for building in local]
    # Boxes overlap in a dense block; the surfaces themselves decide among the nearest.
    distances = [
        float(np.abs(Solids.of(building.triangles()).clearance_m(middle))[0]) if gap <= min(gaps) + 1.0 else np.inf
        for building, gap in zip(local, gaps, strict=True)
    ]
    return buildings[int(np.argmin(distances))]


def _listed(buildings: list[CityBuilding]) -> str:
    """The first few identifiers, those with most windows first."""
    order = sorted(buildings, key=lambda building: -len(building.windows))
    named = [
        f"'{building.id}'" + (say(" (windows: {})", len(building.windows)) if building.windows else "")
        for building in order[:MAX_NAMED]
    ]
    rest = say(" and {} more", len(order) - MAX_NAMED) if len(order) > MAX_NAMED else ""
    return f"{', '.join(named)}{rest}"


def _box_gap(points: Array, others: Array) -> float:
    """Distance between the bounding boxes of two sets of points, shape (n, k) and (m, k)."""
    apart = np.maximum(points.min(axis=0) - others.max(axis=0), others.min(axis=0) - points.max(axis=0))
    return float(np.linalg.norm(np.maximum(apart, 0.0)))


def _near(points: Array, others: Sequence[CityBuilding], reach_m: float) -> list[CityBuilding]:
    """Buildings whose bounding box lies within reach of that of points, shape (n, 3), seen from above."""
    return [building for building in others if _box_gap(points[:, :2], building.points()[:, :2]) <= reach_m]
