"""What makes a site useless, or partly so, for a flight: told while it is drawn, never refused."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.findings import Finding, Severity
from planning.base.messages import say, without_place
from planning.base.progress import QUIET, Monitor
from planning.checks.zones import open_zone, source_ages, source_text
from planning.coverage.sections import PanelFrames, panel_frames
from planning.geo.bvh import OCCLUSION_OFFSET_M
from planning.parameters import Constraints
from planning.routing.rally import rally_findings
from planning.site.free_space import FreeSpace, free_space, unchecked_space
from planning.site.ground import height_at
from planning.site.records import NoFlyZone, SiteModel, panel_corners
from planning.site.zones.keep_out import known_files, near_zones

AWAY_M = (0.01, 0.5, 2.0, 5.0)
"""Beyond the distance to be kept; the farther ones because frames and ledges stand out in front of panels."""

ASIDE_DEG = (0.0, 30.0, 60.0)
"""From straight ahead: windows near the ground are seen from above, for the airspace begins over it."""

N_AROUND = 8

ON_TERRAIN_M = 0.01
"""Home is put on terrain to a millimetre, and terrain is stored to one."""

MAX_LOOKED_AT = 64
"""Panels of one facade that are looked at, spread evenly."""


def site_findings(
    model: SiteModel, min_distance_m: float = Constraints().min_distance_m, monitor: Monitor = QUIET
) -> tuple[Finding, ...]:
    """Findings on a site for flights that keep `min_distance_m`; none where all is well.

    Takes up to a second on large meshes.
    """
    monitor.report(say("checking the site"), 0, 2)
    found: list[Finding] = []
    try:
        space = free_space(model, min_distance_m)
    except InfeasibleError as error:
        found.append(Finding(Severity.ERROR, "home-unusable", without_place(str(error), "home_enu_m"), "home"))
        space = unchecked_space(model, min_distance_m)
    monitor.report(say("checking the site"), 1, 2)
    found += [finding for finding in rally_findings(model, space) if finding.severity is not Severity.OK]
    found += _zones(model)
    return (*found, *_no_panels(model), *_heights(model), *_without_effect(model), *_facades_in_reach(model, space))


def _zones(model: SiteModel) -> Iterator[Finding]:
    """Files of geo-zones that cannot be used, or are too old, and zones of which nobody knows where they lie."""
    for known in known_files(model):
        if known.content is None:
            text = say("no zone of {} counts as clear: {}", source_text(known), known.problem)
            yield Finding(Severity.ERROR, "zones-file", text, f"zone-file/{known.source.file}")
    for near in near_zones(model):
        if near.open_places:
            place = f"geo-zone/{near.key}"
            yield Finding(Severity.ERROR, "zone-question", open_zone(near, near.open_places), place)
    if model.site.zones:
        for finding in source_ages(model, datetime.now(UTC)):
            yield replace(finding, place=f"zone-file/{finding.place}")


def _no_panels(model: SiteModel) -> Iterator[Finding]:
    if model.site.n_panels == 0:
        text = say("there are no panels yet: find them in photos (Photos tab), or lay a facade grid on the building")
        yield Finding(Severity.WARNING, "no-panels", text, "building")


def _heights(model: SiteModel) -> Iterator[Finding]:
    airspace, home_z = model.site.airspace, model.site.home_enu_m[2]
    if airspace.min_enu_m[2] < airspace.ground_z_m:
        yield Finding(
            Severity.WARNING,
            "airspace-below-ground",
            say(
                "the airspace begins at {:g} m, below the ground at {:g} m; raise its floor",
                airspace.min_enu_m[2],
                airspace.ground_z_m,
            ),
            "airspace",
            airspace.min_enu_m[2],
            airspace.ground_z_m,
            "m",
        )
    ground_z_m = height_at(model.site, *model.site.home_enu_m[:2])
    if home_z < ground_z_m - (ON_TERRAIN_M if model.site.terrain is not None else 0.0):
        yield Finding(
            Severity.WARNING,
            "home-below-ground",
            say("home lies at {:g} m, below the ground at {:g} m; put it on the ground", home_z, ground_z_m),
            "home",
            home_z,
            ground_z_m,
            "m",
        )


def _without_effect(model: SiteModel) -> Iterator[Finding]:
    for zone in model.site.airspace.no_fly:
        if _is_outside(zone, model):
            yield Finding(
                Severity.NOTE,
                "no-fly-outside",
                say("no-fly zone '{}' lies outside the airspace, so it changes nothing", zone.id),
                f"no-fly/{zone.id}",
            )


def _is_outside(zone: NoFlyZone, model: SiteModel) -> bool:
    low, high = model.site.airspace.min_enu_m, model.site.airspace.max_enu_m
    corners = np.array(zone.polygon_enu_m)
    zone_low, zone_high = (*corners.min(axis=0), zone.floor_m), (*corners.max(axis=0), zone.ceiling_m)
    return any(a >= d or c <= b for a, b, c, d in zip(zone_low, low, zone_high, high, strict=True))


def _facades_in_reach(model: SiteModel, space: FreeSpace) -> Iterator[Finding]:
    """Whether there is a viewpoint that may stand in front of at least one panel of each facade, and sees it."""
    frames, first = panel_frames(panel_corners(model.site)), 0
    for facade in model.site.facades:
        n_panels = len(facade.panels)
        looked_at = first + np.arange(0, n_panels, max(1, -(-n_panels // MAX_LOOKED_AT)))
        first += n_panels
        if n_panels and not _is_seen(frames, looked_at, space):
            low_m, high_m = (space.min_distance_m + AWAY_M[k] for k in (0, -1))
            yield Finding(
                Severity.WARNING,
                "facade-out-of-reach",
                say(
                    "facade '{}': there is no free airspace {:.0f} to {:.0f} m in front of its panels ({}) from "
                    "which they are seen; turn it to the other side, widen the airspace, or remove it",
                    facade.id,
                    low_m,
                    high_m,
                    n_panels,
                ),
                f"facade/{facade.id}",
            )


def _is_seen(frames: PanelFrames, panels: NDArray[np.int64], space: FreeSpace) -> bool:
    """Whether an allowed place in front of one of some panels has a free line of sight to it."""
    theta, phi, away_m = (
        grid.ravel()[:, None, None]
        for grid in np.meshgrid(
            np.radians(ASIDE_DEG),
            np.linspace(0.0, 2.0 * np.pi, N_AROUND, endpoint=False),
            space.min_distance_m + np.array(AWAY_M),
        )
    )
    sideways = np.cos(phi) * frames.tangents[panels] + np.sin(phi) * frames.bitangents[panels]
    directions = np.cos(theta) * frames.normals[panels] + np.sin(theta) * sideways
    # Off the panel's plane by the distance to be kept, however far aside.
    places = frames.centroids[panels] + away_m / np.cos(theta) * directions
    targets = np.broadcast_to(frames.centroids[panels] + OCCLUSION_OFFSET_M * frames.normals[panels], places.shape)
    places, targets = places.reshape(-1, 3), targets.reshape(-1, 3)
    allowed = space.is_allowed(places)
    return bool(space.solids.lines_free(places[allowed], targets[allowed]).any())
