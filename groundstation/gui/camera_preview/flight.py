"""Where the camera is and where it looks at any time of a sortie, and which panels it then covers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.coverage.sections import NOT_SEEN, PanelFrames, SectionGrid, panel_frames, sections_seen
from planning.geo.bvh import OCCLUSION_OFFSET_M, Bvh, build_bvh, segment_is_free
from planning.geo.frames import wrap_heading_rad
from planning.geo.mesh import join
from planning.insight.flight_profile import FlightProfile, sortie_profile
from planning.parameters import FlightRules
from planning.plan import Plan, Sortie, ViewpointArrays, viewpoint_arrays
from planning.site.records import SiteModel, panel_corners, panel_triangles

Array = NDArray[np.float64]


# Which panels a photo covers, and how it sees the nearest of them.


@dataclass(frozen=True, slots=True, eq=False)
class SiteSight:
    """What is seen and what hides it: panels, and a tree over all solids of a site."""

    frames: PanelFrames
    bvh: Bvh


def site_sight(model: SiteModel) -> SiteSight:
    """Sight of a site."""
    frames = panel_frames(panel_corners(model.site))
    solids = join([model.building, *model.obstacles]).corners_enu_m
    return SiteSight(frames, build_bvh(np.concatenate([panel_triangles(frames.corners), solids])))


def covered_by_view(sight: SiteSight, plan: Plan, view: ViewpointArrays) -> NDArray[np.bool_]:
    """Panels of which one view covers a section under a plan's constraints, shape (m,).

    Lines of sight are tested unless the plan says that nothing is in their way.
    """
    rules = plan.constraints
    grid = SectionGrid(rules.section_step_deg)
    sections = sections_seen(view, sight.frames, plan.camera, grid, rules.whole_panel, rules.max_distance_m)[0]
    seen: NDArray[np.bool_] = sections != NOT_SEEN
    if rules.occlusion == "off":
        return seen
    eye = np.ascontiguousarray(view.positions_enu_m[0])
    for panel in np.flatnonzero(seen):
        target = sight.frames.centroids[panel] + OCCLUSION_OFFSET_M * sight.frames.normals[panel]
        seen[panel] = segment_is_free(sight.bvh, eye, target)
    return seen


@dataclass(frozen=True, slots=True)
class NearestPanel:
    """The covered panel that is nearest to the camera: its number, distance, ground sampling and incidence angle."""

    panel: int
    distance_m: float
    sampling_m: float
    incidence_deg: float


def nearest_covered(sight: SiteSight, plan: Plan, eye_enu_m: Array, covered: NDArray[np.bool_]) -> NearestPanel | None:
    """The nearest of the covered panels, by its centroid; None where there is none."""
    panels = np.flatnonzero(covered)
    if len(panels) == 0:
        return None
    rays = eye_enu_m - sight.frames.centroids[panels]
    distances = np.linalg.norm(rays, axis=1)
    i = int(np.argmin(distances))
    cosine = float(rays[i] @ sight.frames.normals[panels[i]]) / float(distances[i])
    angle_deg = math.degrees(math.acos(min(1.0, max(-1.0, cosine))))
    return NearestPanel(int(panels[i]), float(distances[i]), plan.camera.gsd_m(float(distances[i])), angle_deg)


class CameraPose(NamedTuple):
    """Place, shape (3,) ENU metres, heading in (-pi, pi] and pitch, radians; roll 0."""

    position_enu_m: Array
    heading_rad: float
    pitch_rad: float


@dataclass(frozen=True, slots=True, eq=False)
class CameraFlight:
    """A sortie with its camera.

    Parameters
    ----------
    turn_s, heading_rad, pitch_rad
        Shape (k,): between these times the camera turns evenly; headings are unwrapped, so that the camera turns the
        short way.
    """

    profile: FlightProfile
    turn_s: Array
    heading_rad: Array
    pitch_rad: Array

    @property
    def duration_s(self) -> float:
        """Of the sortie, from above home until it is back there."""
        return self.profile.duration_s

    def pose_at(self, t_s: float) -> CameraPose:
        """Pose at a time; before the start and after the end it rests."""
        position = self.profile.at(np.array([t_s])).positions_enu_m[0]
        heading = np.asarray(np.interp(t_s, self.turn_s, self.heading_rad))
        pitch = np.interp(t_s, self.turn_s, self.pitch_rad)
        return CameraPose(position, float(wrap_heading_rad(heading)), float(pitch))

    def photos_between(self, after_s: float, until_s: float) -> tuple[str, ...]:
        """Viewpoints photographed after one time and until another, in order."""
        times = self.profile.photo_s
        first, last = np.searchsorted(times, [after_s, until_s], side="right")
        return self.profile.photo_ids[first:last]

    def latest_photo(self, t_s: float) -> str | None:
        """The viewpoint photographed last at a time."""
        n_taken = int(np.searchsorted(self.profile.photo_s, t_s, side="right"))
        return self.profile.photo_ids[n_taken - 1] if n_taken else None


def camera_flight(plan: Plan, sortie: Sortie) -> CameraFlight | None:
    """A sortie of a plan as its camera flies it; None where its path has no leg or misses one of its viewpoints.

    The camera turns to a viewpoint after arriving there, before it settles, or on the way there where the rules say so
    (`FlightRules.turn_in_flight`). Until the first photo it looks the way of the first.

    Raises
    ------
    InfeasibleError
        The aircraft cannot fly in the expected wind.
    """
    profile = sortie_profile(plan, sortie)
    if profile is None:
        return None
    by_id = {viewpoint.id: viewpoint for viewpoint in plan.viewpoints}
    views = viewpoint_arrays(tuple(by_id[viewpoint_id] for viewpoint_id in profile.photo_ids))
    if len(profile.photo_ids) == 0:
        return CameraFlight(profile, np.zeros(1), np.zeros(1), np.zeros(1))
    heading = np.unwrap(views.heading_rad, period=2.0 * math.pi)
    starts, ends = _turns(profile, plan.rules)
    times = np.stack([starts, ends], axis=1).ravel()
    before = np.maximum(np.arange(len(heading)) - 1, 0)
    return CameraFlight(
        profile,
        np.maximum.accumulate(times),
        np.stack([heading[before], heading], axis=1).ravel(),
        np.stack([views.pitch_rad[before], views.pitch_rad], axis=1).ravel(),
    )


def _turns(profile: FlightProfile, rules: FlightRules) -> tuple[Array, Array]:
    """When the turn to each photo starts and ends, shape (p,) each."""
    stops = np.minimum(np.searchsorted(profile.departure_s, profile.photo_s), len(profile.departure_s) - 1)
    arrival = profile.arrival_s[stops]
    if not rules.turn_in_flight:
        return arrival, np.maximum(arrival, profile.photo_s - rules.settle_s)
    left = np.concatenate([[0.0], profile.departure_s[stops[:-1]]])
    return np.minimum(left, arrival), arrival
