"""How long a sortie still takes: the plan's times along its path, stretched to what its autopilot takes in all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from groundstation.services.fly.sortie import LiveSortie
from groundstation.vehicle.commands import LAND_MODE, RETURN_MODE
from groundstation.vehicle.state import Landed, VehicleState
from groundstation.vehicle.surroundings import Surroundings
from missions.mavlink.autopilots import Autopilot
from planning.base.errors import InfeasibleError
from planning.geo.frames import Vec3
from planning.insight.flight_profile import sortie_profile

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class ToGo:
    """What is left of a sortie, seconds; None where it is not known, and `photo_s` where no photo is left."""

    landed_s: float | None = None
    photo_s: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class SortieTimes:
    """The planned times of a sortie along its path.

    Parameters
    ----------
    points_enu_m
        Shape (k, 3), along the path.
    along_m, time_s
        Of each point, shape (k,): length flown and time since the aircraft hung above home, neither ever falling.
    photo_m
        Length flown at each photo, shape (p,), in the order of flight.
    ground_s
        What landing takes besides.
    """

    points_enu_m: Array
    along_m: Array
    time_s: Array
    photo_m: Array
    ground_s: float

    @classmethod
    def of(cls, sortie: LiveSortie) -> SortieTimes | None:
        """Times of a sortie; None where its path cannot be timed."""
        plan, number = sortie.case.plan, sortie.orders.number
        try:
            profile = sortie_profile(plan, plan.sorties[number - 1])
        except InfeasibleError:
            return None
        if profile is None:
            return None
        found, photos = profile.samples(), profile.at(profile.photo_s)
        ground_s = 0.5 * plan.rules.takeoff_landing_s
        return cls(found.positions_enu_m, found.distance_m, found.t_s, photos.distance_m, ground_s)

    def left_s(self, place_enu_m: Vec3, n_done: int) -> tuple[float, float | None]:
        """Time to the landing and to the next photo, by the plan, after `n_done` photos of the sortie.

        The aircraft is taken to be on its way to the next photo, at the point of that way nearest to it: paths cross
        themselves, and the nearest point of all may be another time's.
        """
        photos = self.photo_m
        low_m = photos[n_done - 1] if 0 < n_done <= len(photos) else 0.0
        high_m = photos[n_done] if n_done < len(photos) else self.along_m[-1]
        along_m = self._nearest_m(np.array(place_enu_m), float(low_m), float(high_m))
        time_s = float(np.interp(along_m, self.along_m, self.time_s))
        landed_s = float(self.time_s[-1]) - time_s + self.ground_s
        if n_done >= len(photos):
            return landed_s, None
        return landed_s, max(0.0, float(np.interp(high_m, self.along_m, self.time_s)) - time_s)

    def _nearest_m(self, place_enu_m: Array, low_m: float, high_m: float) -> float:
        """Length flown at the point nearest to a place, between two lengths."""
        starts, ends = self.along_m[:-1], self.along_m[1:]
        on_way = np.flatnonzero((ends >= low_m) & (starts <= high_m) & (ends > starts))
        if len(on_way) == 0:
            return low_m
        start, legs = self.points_enu_m[on_way], np.diff(self.points_enu_m, axis=0)[on_way]
        squared = np.maximum(np.einsum("ij,ij->i", legs, legs), 1e-12)
        part = np.clip(np.einsum("ij,ij->i", place_enu_m - start, legs) / squared, 0.0, 1.0)
        away_m = np.linalg.norm(place_enu_m - start - part[:, None] * legs, axis=1)
        nearest = int(np.argmin(away_m))
        along_m = starts[on_way[nearest]] + part[nearest] * (ends - starts)[on_way[nearest]]
        return float(np.clip(along_m, low_m, high_m))


def to_go(
    times: SortieTimes | None, sortie: LiveSortie, state: VehicleState, around: Surroundings, is_done: Sequence[bool]
) -> ToGo:
    """What is left of a flight as it stands.

    Parameters
    ----------
    is_done
        Whether each view of the sortie was passed, in the order of flight; the last of them counts.
    """
    total_s = sortie.orders.duration_s(state.autopilot)
    is_down = state.landed is not None and state.landed.value is Landed.ON_GROUND
    if not state.is_armed or is_down:
        return ToGo(total_s)
    if state.motion is None:
        return ToGo()
    place, autopilot = state.motion.value.position_enu_m, state.autopilot or Autopilot.ARDUPILOT
    mode = None if state.mode is None else state.mode.value
    if mode == RETURN_MODE[autopilot]:
        return ToGo(around.way_home_s(place))
    if mode == LAND_MODE[autopilot]:
        return ToGo(max(0.0, state.motion.value.height_above_home_m) / around.aircraft.max_descent_m_s)
    if times is None:
        return ToGo()
    n_done = max((number for number, done in enumerate(is_done, 1) if done), default=0)
    landed_s, photo_s = times.left_s(place, n_done)
    # Autopilots take longer for the items than the plan's own aircraft, by the same part everywhere as far as is known.
    slower = total_s / sortie.orders.mission.duration_s if sortie.orders.mission.duration_s > 0.0 else 1.0
    return ToGo(slower * landed_s, None if photo_s is None else slower * photo_s)
