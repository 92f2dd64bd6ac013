"""What a sortie flies in: solids, airspace, its planned path and photos, and the limits to be kept."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.geo.frames import Vec3
from planning.parameters import FlightRules
from planning.plan import Aircraft, Plan
from planning.site.free_space import FreeSpace, unchecked_space
from planning.site.records import SiteModel

Array = NDArray[np.float64]

COLUMN_M = 3.0
"""Radius around home within which an aircraft climbs and lands below the airspace's floor."""


@dataclass(frozen=True, slots=True)
class ExpectedPhoto:
    """A photo of the sortie, and the mission item (as numbered on the vehicle) that triggers it.

    `gimbal_pitch_deg` is where the camera shall look, 0 level and -90 straight down; None where nobody says.
    """

    viewpoint_id: str
    position_enu_m: Vec3
    trigger_seq: int
    gimbal_pitch_deg: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """Everything that warnings compare a vehicle's state with.

    Parameters
    ----------
    path_enu_m
        Shape (k, 3): the planned path, from take-off to landing; empty where nothing is known of it.
    photos
        In the order of flight.
    """

    space: FreeSpace
    aircraft: Aircraft
    rules: FlightRules
    path_enu_m: Array
    photos: tuple[ExpectedPhoto, ...] = ()

    @classmethod
    def of_sortie(
        cls, site_model: SiteModel, plan: Plan, sortie: int, trigger_seqs: dict[str, int] | None = None
    ) -> Surroundings:
        """Of a plan's sortie, counted from 1.

        Parameters
        ----------
        trigger_seqs
            Mission item that triggers the photo of each viewpoint.
        """
        by_id = {viewpoint.id: viewpoint for viewpoint in plan.viewpoints}
        flown = plan.sorties[sortie - 1]
        photos = tuple(
            ExpectedPhoto(name, by_id[name].position_enu_m, (trigger_seqs or {})[name], by_id[name].gimbal_pitch_deg)
            for name in flown.viewpoint_ids
            if trigger_seqs and name in trigger_seqs
        )
        space = unchecked_space(site_model, plan.constraints.min_distance_m)
        return cls(space, plan.aircraft, plan.rules, np.array(flown.path_enu_m, np.float64).reshape(-1, 3), photos)

    def facade_distance_m(self, start_enu_m: Vec3, end_enu_m: Vec3) -> float:
        """Smallest distance of a straight way to panels, mesh and obstacles, up to three times the minimum."""
        upper_m = 3.0 * self.space.min_distance_m + 10.0
        return float(self.space.solids.segment_distances_m(np.array([start_enu_m]), np.array([end_enu_m]), upper_m)[0])

    def airspace_room_m(self, point_enu_m: Vec3) -> float:
        """Distance of a point to the airspace's faces, negative outside; above home the floor does not count."""
        point, low, high = np.array(point_enu_m), self.space.low_enu_m, self.space.high_enu_m
        room = np.concatenate([point - low, high - point])
        if math.dist(point_enu_m[:2], self.space.home_enu_m[:2]) <= COLUMN_M:
            room[2] = math.inf
        return float(room.min())

    def no_fly_distance_m(self, point_enu_m: Vec3) -> float:
        """Distance of a point to the nearest no-fly volume; negative inside, infinite where there is none."""
        if not len(self.space.no_fly.part):
            return math.inf
        return float(self.space.no_fly.clearance_m(np.array([point_enu_m]), 100.0)[0])

    def off_path_m(self, point_enu_m: Vec3) -> float:
        """Distance of a point to the planned path; 0 where there is none."""
        path = self.path_enu_m
        if len(path) < 2:
            return 0.0
        start, legs = path[:-1], np.diff(path, axis=0)
        away = np.array(point_enu_m) - start
        squared = np.maximum(np.einsum("ij,ij->i", legs, legs), 1e-12)
        share = np.clip(np.einsum("ij,ij->i", away, legs) / squared, 0.0, 1.0)
        return float(np.linalg.norm(away - share[:, None] * legs, axis=1).min())

    def way_home_s(self, point_enu_m: Vec3) -> float:
        """Time from a point over home to the ground, seconds, straight and against the wind that the rules expect."""
        away = np.array(point_enu_m) - self.space.home_enu_m
        speed_m_s = max(self.aircraft.max_speed_m_s - self.rules.wind_m_s, 1.0)
        down_s = max(float(away[2]), 0.0) / self.aircraft.max_descent_m_s
        return float(np.hypot(away[0], away[1])) / speed_m_s + down_s + self.rules.takeoff_landing_s / 2.0
