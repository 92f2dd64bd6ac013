"""Height and speed of a plan's sorties, ready for a chart: heights count from take-off."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.checks.rules import MAX_ALTITUDE_M
from planning.insight.flight_profile import sortie_profile
from planning.plan import Plan
from planning.site.records import SiteModel

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class ProfileCurves:
    """One sortie, as q samples over time and p photos.

    Parameters
    ----------
    sortie
        Number from 1.
    t_s, distance_m, height_m, speed_m_s
        Shape (q,): since the aircraft hangs above home, ready to go, flown, above take-off, along the path.
    photo_t_s, photo_distance_m, photo_height_m
        Shape (p,), at `photo_ids`.
    takeoff_landing_s
        What the sortie's duration has on top of these times: motors, take-off checks, landing.
    """

    sortie: int
    t_s: Floats
    distance_m: Floats
    height_m: Floats
    speed_m_s: Floats
    photo_ids: tuple[str, ...]
    photo_t_s: Floats
    photo_distance_m: Floats
    photo_height_m: Floats
    takeoff_landing_s: float


@dataclass(frozen=True, slots=True)
class HeightLimits:
    """Heights above take-off that a chart marks; `legal_m` is the height above ground that needs no permit."""

    ground_m: float
    floor_m: float
    ceiling_m: float
    legal_m: float


def plan_profiles(plan: Plan) -> tuple[ProfileCurves, ...]:
    """Curves of all sorties that can be flown; none in wind that the aircraft may not fly in."""
    curves = []
    for number, sortie in enumerate(plan.sorties, 1):
        try:
            profile = sortie_profile(plan, sortie)
        except InfeasibleError:
            return ()
        if profile is None:
            continue
        samples, photos = profile.samples(), profile.at(profile.photo_s)
        takeoff_z = float(profile.vertices_enu_m[0, 2])
        curves.append(
            ProfileCurves(
                number,
                samples.t_s,
                samples.distance_m,
                samples.positions_enu_m[:, 2] - takeoff_z,
                samples.speed_m_s,
                profile.photo_ids,
                profile.photo_s,
                photos.distance_m,
                photos.positions_enu_m[:, 2] - takeoff_z,
                plan.rules.takeoff_landing_s,
            )
        )
    return tuple(curves)


def height_limits(site_model: SiteModel) -> HeightLimits:
    """Ground and airspace of a site, counted from home."""
    airspace, home_z = site_model.site.airspace, site_model.site.home_enu_m[2]
    ground_m = airspace.ground_z_m - home_z
    return HeightLimits(
        ground_m, airspace.min_enu_m[2] - home_z, airspace.max_enu_m[2] - home_z, ground_m + MAX_ALTITUDE_M
    )


def nearest_photo(curves: ProfileCurves, t_s: float) -> str | None:
    """Viewpoint whose photo is taken nearest to a time; None in sorties without photos."""
    if not curves.photo_ids:
        return None
    return curves.photo_ids[int(np.argmin(np.abs(curves.photo_t_s - t_s)))]
