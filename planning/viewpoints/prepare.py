"""From a site to a problem that optimisers can work on: free space, occlusion, reachability, what can be flown to."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment, Decision, EffectSetting, decide
from planning.base.errors import InfeasibleError
from planning.base.findings import Finding, Severity
from planning.base.jit import chunks
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, never
from planning.coverage.model import CoverageModel
from planning.coverage.positions import spread_positions
from planning.coverage.reach_kernel import UNREACHABLE
from planning.coverage.reachability import MAX_CELLS, MAX_POSITIONS, find_reachable
from planning.coverage.sections import PanelFrames, SectionGrid, panel_frames
from planning.geo.bvh import OCCLUSION_OFFSET_M, line_of_sight
from planning.parameters import Constraints, Precision
from planning.plan import Camera, sharp_distance_m, usual_gsd_m
from planning.routing.roadmap import build_roadmap
from planning.site.free_space import FreeSpace, free_space
from planning.site.ground import decide_terrain
from planning.site.records import SiteModel, panel_corners, require_panels
from planning.viewpoints.problem import ViewProblem, nothing_to_see

# Occlusion: whether something stands between a camera and a panel, and whether a scene calls for asking.
#
# Lines of sight run to a point 0.15 m in front of the panel's centroid.

Array = NDArray[np.float64]


N_PROBES = 3000
PROBE_PANELS = 400
"""Sample of places and panels from which the share of blocked lines is estimated (at most 1.2 million lines)."""

RAYS_PER_SECOND = 5e6
"""Rate assumed for the stated cost; 1 to 2 cores reach 10 to 30 million."""


@dataclass(frozen=True, slots=True, eq=False)
class OcclusionScene:
    """What the effect looks at: panels, everything that could hide them, and places where a camera may be."""

    frames: PanelFrames
    corners_enu_m: Array
    places_enu_m: Array


def rises_above_a_panel(frames: PanelFrames, corners_enu_m: Array) -> bool:
    """Whether any triangle reaches in front of any panel's plane (through the point lines of sight run to).

    Where none does, no line of sight from in front of a panel can be blocked: an exact answer for planar and convex
    buildings that stand alone.
    """
    vertices = np.unique(corners_enu_m.reshape(-1, 3), axis=0)
    targets = frames.centroids + OCCLUSION_OFFSET_M * frames.normals
    offsets = np.einsum("mk,mk->m", targets, frames.normals)
    for start, stop in chunks(len(vertices), max(1, 4_000_000 // len(frames))):
        if (vertices[start:stop] @ frames.normals.T > offsets).any():
            return True
    return False


class Occlusion:
    """The effect: the share of lines of sight, in per cent, that something blocks."""

    name = "occlusion"
    unit = say("% of the lines of sight")
    tolerance = 0.5

    def assess(self, scene: OcclusionScene) -> Assessment:
        """Exactly zero where nothing rises in front of a panel; else estimated on a sample of lines."""
        if not rises_above_a_panel(scene.frames, scene.corners_enu_m):
            return Assessment(0.0, say("nothing stands in front of any panel"), 0.0)
        if len(scene.places_enu_m) == 0:
            return Assessment(0.0, say("there is no place to look from"), 0.0)
        started = time.perf_counter()
        rng = np.random.default_rng(0)
        places = scene.places_enu_m[_sample(rng, len(scene.places_enu_m), N_PROBES)]
        chosen = _sample(rng, len(scene.frames), PROBE_PANELS)
        centroids, normals = scene.frames.centroids[chosen], scene.frames.normals[chosen]
        in_front = np.einsum("nmk,mk->nm", places[:, None, :] - centroids[None, :, :], normals) > 0.0
        place, panel = np.nonzero(in_front)
        if len(place) == 0:
            return Assessment(0.0, say("no allowed place lies in front of a panel"), 0.0)
        targets = centroids + OCCLUSION_OFFSET_M * normals
        free = line_of_sight(scene.corners_enu_m)(places[place], targets[panel])
        share = 100.0 * float(np.mean(~free))
        n_hit = len(np.unique(panel[~free]))
        reason = say("something stands in front of {:.0f} % of the panels", 100 * n_hit / len(chosen))
        cost = time.perf_counter() - started + len(scene.frames) * 40_000 / RAYS_PER_SECOND
        return Assessment(share, reason, cost)


def _sample(rng: np.random.Generator, n: int, size: int) -> NDArray[np.int64]:
    """At most `size` different indices below n, in order."""
    return np.sort(rng.choice(n, min(n, size), replace=False))


N_PLACES = 3000
"""Allowed places on which effects look at the scene."""


@dataclass(frozen=True, slots=True, eq=False)
class Prepared:
    """A problem with the decisions that shaped it.

    Parameters
    ----------
    site_model
        The site that was prepared.
    constraints
        As asked for, with occlusion as it was decided, and the lowest height and largest pixel that hold.
    effects
        Decisions of all effects.
    findings
        What the pilot should know about the site: panels that nobody can see, distances that had to be lowered.
    seed
        Of everything random in it.
    is_cut_short
        Whether it was stopped before everything was decided that could be.
    """

    site_model: SiteModel
    problem: ViewProblem
    constraints: Constraints
    effects: tuple[Decision, ...]
    findings: tuple[Finding, ...]
    seed: int = 0
    is_cut_short: bool = False

    def serves(
        self, site_model: SiteModel, camera: Camera, constraints: Constraints, precision: Precision, seed: int
    ) -> bool:
        """Whether preparing with these arguments would come to the same.

        The site's checksum does not matter: it changes when the site is saved.
        """
        is_by_user = any(effect.effect == Occlusion.name and effect.decided_by == "user" for effect in self.effects)
        requested = replace(self.constraints, occlusion=self.constraints.occlusion if is_by_user else "auto")
        constraints = with_site_limits(constraints, site_model, camera)
        return (
            is_same_place(site_model, self.site_model)
            and (camera, precision) == (self.problem.model.camera, self.problem.model.precision)
            and (constraints, seed) == (requested, self.seed)
        )


def with_site_limits(constraints: Constraints, site_model: SiteModel, camera: Camera) -> Constraints:
    """The constraints with the lowest height and the largest pixel of sharp views that hold on a site for a camera."""
    lowest_m = site_model.site.airspace.lowest_height_m(constraints.min_height_above_ground_m)
    wanted_mm = constraints.wanted_gsd_mm
    if wanted_mm is None:
        wanted_mm = round(1000.0 * usual_gsd_m(camera, constraints.min_distance_m), 6)
    return replace(constraints, min_height_above_ground_m=lowest_m, wanted_gsd_mm=wanted_mm)


def is_same_place(first: SiteModel, second: SiteModel) -> bool:
    """Whether two sites have the same content and geometry; checksums, which change with saving, do not matter."""
    if first is second:
        return True
    meshes = zip((first.building, *first.obstacles), (second.building, *second.obstacles), strict=True)
    return first.site == second.site and all(
        a is b or (np.array_equal(a.vertices_enu_m, b.vertices_enu_m) and np.array_equal(a.triangles, b.triangles))
        for a, b in meshes
    )


def coverage_model(
    site_model: SiteModel, space: FreeSpace, camera: Camera, constraints: Constraints, precision: Precision = "f32"
) -> CoverageModel:
    """Coverage model for constraints whose occlusion is decided (`on` or `off`).

    Raises
    ------
    InputError
        The site has no panels.
    """
    require_panels(site_model.site)
    if constraints.occlusion == "auto":
        raise ValueError("occlusion is not decided yet")
    return CoverageModel(
        panel_frames(panel_corners(site_model.site)),
        camera,
        SectionGrid(constraints.section_step_deg),
        whole_panel=constraints.whole_panel,
        max_distance_m=constraints.max_distance_m,
        sharp_m=sharp_distance_m(camera, constraints),
        sight=line_of_sight(space.solids.bvh.corners) if constraints.occlusion == "on" else None,
        precision=precision,
    )


def decide_occlusion(site_model: SiteModel, space: FreeSpace, setting: EffectSetting, seed: int = 0) -> Decision:
    """Whether occlusion is taken into account on this site, and why.

    Raises
    ------
    InputError
        The site has no panels.
    """
    require_panels(site_model.site)
    frames = panel_frames(panel_corners(site_model.site))
    places = spread_positions(space, frames, N_PLACES, np.random.default_rng(seed))
    return decide(Occlusion(), OcclusionScene(frames, space.solids.bvh.corners, places), setting)


def prepare(
    site_model: SiteModel,
    camera: Camera,
    constraints: Constraints,
    *,
    precision: Precision = "f32",
    max_positions: int = MAX_POSITIONS,
    max_cells: int = MAX_CELLS,
    seed: int = 0,
    stop: Stop = never,
    monitor: Monitor = QUIET,
) -> Prepared:
    """Prepare a site.

    Raises
    ------
    InputError
        The site has no panels.
    InfeasibleError
        Home cannot be used, the airspace is empty, or no allowed viewpoint sees any panel.
    """
    require_panels(site_model.site)
    monitor.report(say("reading the site"), 0, 1)
    constraints = with_site_limits(constraints, site_model, camera)
    space = free_space(site_model, constraints.min_distance_m, constraints.min_height_above_ground_m)
    decision = decide_occlusion(site_model, space, constraints.occlusion, seed)
    decided = replace(constraints, occlusion="on" if decision.on else "off")
    model = coverage_model(site_model, space, camera, decided, precision)
    if len(spread_positions(space, model.frames, N_PLACES, np.random.default_rng(seed))) == 0:
        raise InfeasibleError.say(
            "airspace: no place in it keeps {:g} m from the building and all obstacles; widen the airspace "
            "or lower the minimum distance",
            constraints.min_distance_m,
        )
    reachability = find_reachable(model, space, seed, max_positions, max_cells, stop, monitor)
    is_cut_short = stop()
    if reachability.upper_bound == 0:
        raise nothing_to_see()
    monitor.report(say("finding ways around"), 0, 1)
    problem = ViewProblem(model, space, reachability, build_roadmap(space, seed))
    decisions = (decision,) if site_model.site.terrain is None else (decision, decide_terrain(site_model.site))
    return Prepared(site_model, problem, decided, decisions, _findings(site_model, problem), seed, is_cut_short)


def _findings(site_model: SiteModel, problem: ViewProblem) -> tuple[Finding, ...]:
    found = []
    space, model = problem.space, problem.model
    inside = space.solids.clearance_m(model.targets_enu_m, 1.0) < 0
    n_possible = (problem.reachability.verdicts != UNREACHABLE).sum(axis=1)
    for index, panel in enumerate(site_model.site.panels):
        if inside[index]:
            found.append(
                Finding(
                    Severity.WARNING,
                    "panel-faces-inwards",
                    say("panel '{}' looks into a solid: its corners may be clockwise, or the mesh covers it", panel.id),
                    panel.id,
                )
            )
        elif n_possible[index] == 0:
            found.append(
                Finding(
                    Severity.WARNING,
                    "panel-unseen",
                    say("no allowed viewpoint sees panel '{}'", panel.id),
                    panel.id,
                    0.0,
                    float(model.grid.n_sections),
                    "sections",
                )
            )
    if space.no_fly_distance_m < space.min_distance_m:
        found.append(
            Finding(
                Severity.WARNING,
                "home-near-no-fly",
                say(
                    "home stands {:.1f} m from a no-fly volume; no more than that is kept from it",
                    space.no_fly_distance_m,
                ),
                "home",
                space.no_fly_distance_m,
                space.min_distance_m,
                "m",
            )
        )
    return tuple(found)
