"""Which panels a photo covers, and how it sees the nearest of them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.coverage.sections import NOT_SEEN, PanelFrames, SectionGrid, panel_frames, sections_seen
from planning.geo.bvh import OCCLUSION_OFFSET_M, Bvh, build_bvh, segment_is_free
from planning.geo.mesh import join
from planning.plan import Plan, ViewpointArrays
from planning.site.records import SiteModel, panel_corners, panel_triangles

Array = NDArray[np.float64]


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
    seen = sections_seen(view, sight.frames, plan.camera, grid, rules.whole_panel, rules.max_distance_m)[0] != NOT_SEEN
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
