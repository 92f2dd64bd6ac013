"""Sun over a site on a day: which facades have even light, which views look into it or its mirror image, and the pilot.

A pane mirrors the sun in direction s to whoever looks along d = s - 2 (s . n) n. So the picture of a view shows it
where d lies within the picture and within the pane, s before the pane, and nothing stands on the way. A mirror turns
regions of the sky into regions: the planes that bound picture and pane, mirrored, bound where the sun has to stand,
and `planning.geo.sun` finds when it does. What hides the sun is looked for along rays, every `SHADOW_S`.

The sun's disc counts from its edge on for pictures, and by its middle for shadows; it passes in 2 minutes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment, Decision, EffectSetting, decide
from planning.base.jit import chunks, kernel, run_chunks
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.coverage.sections import PanelFrames, panel_frames
from planning.geo.bvh import LineOfSight, line_of_sight
from planning.geo.frames import camera_axes
from planning.geo.mesh import join
from planning.geo.sun import (
    LEAST_S,
    NO_SPANS,
    RADIUS_RAD,
    Spans,
    SunTrack,
    joined_spans,
    spans_within,
    total_s,
    trace_region,
    without_spans,
)
from planning.plan import Camera, Viewpoint, ViewpointArrays, viewpoint_arrays
from planning.site.records import SiteModel, panel_corners, panel_triangles
from planning.site.terrain import surfaces

Array = NDArray[np.float64]
Index = NDArray[np.int64]

TOLERANCE_S = 120.0
"""Times are meant to be good to so much; effects that shift none by more are off."""

SHADOW_S, SHADOW_END_S = 30.0, 4.0
"""Between rays that look for what hides the sun, and how well the ends of shadows are found. Sun that comes through a
gap for a shorter time may be missed: at 50 m a gap of 11 cm."""

BEFORE_PANE_M = 0.15
"""Rays begin so far before panes, as lines of sight end (contract): frames and coarse walls hide nothing."""

TERRAIN_NODES = 100_000
"""Of the terrain that hides the sun: 300 m x 300 m in steps of a metre, and more in larger ones."""

MOST_POINTS = 500
"""Of a facade at which its light is looked at."""

SPREAD = 0.8
"""Of the way from a pane's middle to its corners, where its light is looked at."""

PANES_WITH_CORNERS = 100
"""Up to so many panes of a facade are looked at near their corners, too."""

VIEWS_AT_ONCE = 64

EYE_M = 1.7
"""Height of the pilot's eyes above home."""

BLINDING_RAD = math.radians(10.0)
"""Between the sun and the aircraft. At that angle the veil over what the pilot sees is as bright as blue sky: 10 E /
100 cd/m2 by the Stiles-Holladay formula (CIE 146:2002), 8000 for a sun of E = 80 000 lx."""


@dataclass(frozen=True, slots=True, eq=False)
class FacadeDay:
    """One facade during a day.

    Parameters
    ----------
    mirrors
        Whether glare in its panes is looked for.
    facing
        While the sun stands before any of its panes.
    lit, partly
        While all of it is in the sun, and while part of it is; it is in shade else.
    """

    id: str
    heading_deg: float
    tilt_deg: float
    mirrors: Decision
    facing: Spans
    lit: Spans
    partly: Spans

    def even(self, up: Spans) -> Spans:
        """While the sun is up and the light is even: all in the sun, or all in shade."""
        return without_spans(up, self.partly)


@dataclass(frozen=True, slots=True, eq=False)
class ViewDay:
    """One view during a day.

    Parameters
    ----------
    direct, mirrored
        While the sun's disc, or its mirror image in a pane, stands in its picture.
    uneven
        While a facade of which it shows a pane is in the sun in part.
    panes
        Panes in which it shows the sun, by their numbers among the site's.
    """

    direct: Spans
    mirrored: Spans
    uneven: Spans
    panes: tuple[int, ...] = ()

    @property
    def dazzled(self) -> Spans:
        """While it shows the sun in either way."""
        return joined_spans([self.direct, self.mirrored])


@dataclass(frozen=True, slots=True, eq=False)
class SunDay:
    """What the sun does at a site during a day.

    Parameters
    ----------
    views
        By the identifiers of viewpoints.
    shadows
        Whether what stands around shades facades.
    tilts
        Whether measured tilts of panes count; None where the site has none.
    """

    track: SunTrack
    facades: tuple[FacadeDay, ...]
    views: Mapping[str, ViewDay]
    shadows: Decision
    tilts: Decision | None

    @property
    def decisions(self) -> tuple[Decision, ...]:
        """Of all effects."""
        tilts = () if self.tilts is None else (self.tilts,)
        return (*(facade.mirrors for facade in self.facades), self.shadows, *tilts)


MIRRORS, SHADOWS, TILTS = say("sun in panes"), say("cast shadows"), say("measured tilts of panes")
"""Names of effects, as settings have them."""


@dataclass(frozen=True, slots=True)
class _Scene:
    """What effects look at: panes that look towards `normals`, shape (m, 3), with points, shape (k, 3), on them."""

    track: SunTrack
    normals: Array
    points: Array
    panes: Index
    tilts_rad: Array
    sees_sun: Callable[[Array, Array], NDArray[np.bool_]]


@dataclass(frozen=True, slots=True)
class SunInPanes:
    """The sun's mirror image in the panes of one facade."""

    facade_id: str
    n_views: int = 0
    tolerance: float = TOLERANCE_S / 60.0
    unit = say("min")

    @property
    def name(self) -> str:
        """Of the effect on this facade."""
        return say("{} of facade {}", MIRRORS, self.facade_id)

    def assess(self, scene: _Scene) -> Assessment:
        """Minutes of the day while the sun stands before a pane."""
        minutes = total_s(_facing(scene.track, scene.normals)) / 60.0
        cost_s = PAIR_S * self.n_views * len(scene.normals)
        if not len(scene.track.up):
            return Assessment(minutes, say("the sun does not rise on this day"), cost_s)
        if minutes <= 0.0:
            return Assessment(minutes, say("the sun is never before its panes on this day"), cost_s)
        return Assessment(minutes, say("the sun is before its panes on this day"), cost_s)


@dataclass(frozen=True, slots=True)
class CastShadows:
    """What stands between facades and the sun."""

    tolerance: float = TOLERANCE_S / 60.0
    name = SHADOWS
    unit = say("min")

    def assess(self, scene: _Scene) -> Assessment:
        """Minutes of sun that bodies take from the panes, the mean of those probed, every `PROBE_S`."""
        times = np.concatenate([np.zeros(0), *(np.arange(a, b, PROBE_S) for a, b in scene.track.up)])
        some = _some(len(scene.points), PROBES)
        cost_s = RAY_S * len(scene.points) * len(times)
        if not len(times) or not len(some):
            return Assessment(0.0, say("no sun falls on panes"), cost_s)
        suns = scene.track.directions_enu(times)
        is_facing = scene.normals[scene.panes[some]] @ suns.T > 0.0
        at, when = np.nonzero(is_facing)
        n_hidden = np.count_nonzero(~scene.sees_sun(scene.points[some][at], suns[when]))
        minutes = float(n_hidden) * PROBE_S / 60.0 / len(some)
        return Assessment(
            minutes, say("shade of the building and obstacles on a pane on this day, in the mean"), cost_s
        )


@dataclass(frozen=True, slots=True)
class PaneTilts:
    """How far panes lean from the planes of their corners, as it was measured."""

    tolerance: float = TOLERANCE_S / 120.0
    name = TILTS
    unit = say("min")

    def assess(self, scene: _Scene) -> Assessment:
        """Minutes by which the most tilted pane shifts its glare: twice its tilt, at the sun's 15 degrees an hour."""
        most = float(np.linalg.norm(scene.tilts_rad, axis=1).max(initial=0.0))
        reason = say("panes are tilted by up to {:.2f} degrees", math.degrees(most))
        return Assessment(shift_minutes(most), reason, 0.0)


def shift_minutes(tilt_rad: float) -> float:
    """How much a tilt shifts a pane's glare in time: a mirror turns by twice that, the sun by 15 degrees an hour."""
    return math.degrees(2.0 * tilt_rad) * 4.0


PROBE_S, PROBES = 600.0, 64
"""Between looks for shadows, and panes looked at, before it is decided whether there are any."""

PAIR_S, RAY_S = 1e-6, 2e-7
"""Of one core, for a view and a pane, and for a ray (measured on 2 cores)."""


def _facing(track: SunTrack, normals: Array) -> Spans:
    """While the sun is before a pane of normals, shape (m, 3)."""
    planes = np.unique(np.round(normals, 9), axis=0)[:, None]
    return joined_spans(spans_within(track, planes, -RADIUS_RAD, track.up))


def tilted_normals(frames: PanelFrames, tilts_rad: Array) -> Array:
    """Unit normals, shape (m, 3), of panes that lean by small angles to the right and upwards, shape (m, 2).

    Right is along the lower edge, from corner 0 to corner 1, and up is n x right, as in `reconstruction.scenes`.
    """
    across = frames.corners[:, 1] - frames.corners[:, 0]
    across -= np.einsum("mk,mk->m", across, frames.normals)[:, None] * frames.normals
    rights = across / np.linalg.norm(across, axis=1, keepdims=True)
    leaning = frames.normals + tilts_rad[:, :1] * rights + tilts_rad[:, 1:] * np.cross(frames.normals, rights)
    return np.asarray(leaning / np.linalg.norm(leaning, axis=1, keepdims=True))


class SunSite:
    """A site as the sun meets it: its panes, and the bodies that hide the sun."""

    def __init__(self, site_model: SiteModel) -> None:
        site = site_model.site
        self.site_model = site_model
        self.frames = panel_frames(panel_corners(site))
        tilts = [panel.tilt_deg or (0.0, 0.0) for panel in site.panels]
        self.tilts_rad = np.radians(np.array(tilts, np.float64).reshape(-1, 2))
        self.has_tilts = any(panel.tilt_deg is not None for panel in site.panels)
        others = join([site_model.building, *site_model.obstacles]).corners_enu_m
        ground = np.zeros((0, 3, 3))
        if site.terrain is not None and site.terrain.use != "off":
            # What the ground hides for certain: its lower bound.
            ground = surfaces(site.terrain).lower.triangles(TERRAIN_NODES)
        self._triangles = np.concatenate([panel_triangles(self.frames.corners), others, ground])
        corners = self._triangles.reshape(-1, 3)
        self._middle = np.asarray(corners.mean(axis=0)) if len(corners) else np.zeros(3)
        # Nothing of the site is further from any other part of it, and hides the sun from beyond.
        self._reach_m = 1.0 + 2.0 * (float(np.linalg.norm(np.ptp(corners, axis=0))) if len(corners) else 0.0)
        counts = [len(facade.panels) for facade in site.facades]
        self.facade_of = np.repeat(np.arange(len(counts)), counts)

    @cached_property
    def is_free(self) -> LineOfSight:
        """Line of sight past panels, building, obstacles and terrain."""
        return line_of_sight(self._triangles)

    def sees_sun(self, points_enu_m: Array, suns_enu: Array) -> NDArray[np.bool_]:
        """Whether nothing stands between points and the sun, both shape (n, 3)."""
        # Aircraft and pilots may be far from the site.
        far = self._reach_m + np.linalg.norm(points_enu_m - self._middle, axis=1)
        return np.asarray(self.is_free(points_enu_m + far[:, None] * suns_enu, points_enu_m))

    def points(self, facade: int) -> tuple[Array, Index]:
        """Points of a facade, just before it, and the pane of each, shape (k, 3) and (k,)."""
        panes = np.flatnonzero(self.facade_of == facade)
        middles, corners = self.frames.centroids[panes, None], self.frames.corners[panes]
        points = np.concatenate([middles, middles + SPREAD * (corners - middles)], axis=1)
        if len(panes) > PANES_WITH_CORNERS:
            points = points[:, :1]
        of = np.repeat(panes, points.shape[1])
        points = points.reshape(-1, 3) + BEFORE_PANE_M * self.frames.normals[of]
        some = _some(len(of), MOST_POINTS)
        return points[some], of[some]


def sun_day(
    site: SunSite,
    track: SunTrack,
    viewpoints: Sequence[Viewpoint] = (),
    camera: Camera | None = None,
    settings: Mapping[str, EffectSetting] | None = None,
    least_s: float = LEAST_S,
    monitor: Monitor = QUIET,
) -> SunDay:
    """Facades and views of a site during a day.

    Parameters
    ----------
    camera
        Of the viewpoints; needed where there are any.
    settings
        By `MIRRORS`, `SHADOWS` and `TILTS`: what the user set, for all facades.
    least_s
        Shortest glare that is found for certain, seconds.
    """
    asked = settings or {}
    frames, n_panes = site.frames, len(site.frames)

    def scene(normals: Array, points: Array, of: Index) -> _Scene:
        return _Scene(track, normals, points, of, site.tilts_rad, site.sees_sun)

    nothing = np.zeros((0, 3))
    tilts = None
    normals = frames.normals
    if site.has_tilts:
        tilts = decide(PaneTilts(), scene(nothing, nothing, np.zeros(0, np.int64)), asked.get(TILTS, "auto"))
        normals = tilted_normals(frames, site.tilts_rad) if tilts.on else normals
    sampled = [site.points(number) for number in range(len(site.site_model.site.facades))]
    every = (np.concatenate([nothing, *(points for points, _ in sampled)]), _joined([of for _, of in sampled]))
    shadows = decide(CastShadows(), scene(frames.normals, *every), asked.get(SHADOWS, "auto"))
    facades = []
    for number, facade in enumerate(site.site_model.site.facades):
        monitor.report(say("light on facades"), number, len(site.site_model.site.facades))
        own = site.facade_of == number
        of_facade = scene(normals[own], nothing, np.zeros(0, np.int64))
        mirrors = decide(SunInPanes(facade.id, len(viewpoints)), of_facade, asked.get(MIRRORS, "auto"))
        facing = _facing(track, frames.normals[own])
        lit, partly = _lit(site, track, *sampled[number], facing, shadows.on)
        mean = frames.normals[own].mean(axis=0) if own.any() else np.zeros(3)
        heading, tilt = math.atan2(mean[0], mean[1]), math.atan2(mean[2], math.hypot(mean[0], mean[1]))
        facades.append(FacadeDay(facade.id, math.degrees(heading), math.degrees(tilt), mirrors, facing, lit, partly))
    views: dict[str, ViewDay] = {}
    if viewpoints and camera is not None:
        on = np.array([facade.mirrors.on for facade in facades], np.bool_)
        mirrors_of_pane = on[site.facade_of] if n_panes else np.zeros(0, np.bool_)
        partly_of = [facade.partly for facade in facades]
        finder = _Finder(site, track, normals, np.flatnonzero(mirrors_of_pane), least_s)
        arrays = viewpoint_arrays(tuple(viewpoints))
        for start, stop in chunks(len(viewpoints), VIEWS_AT_ONCE):
            monitor.report(say("sun in pictures"), start, len(viewpoints))
            some = ViewpointArrays(*(each[start:stop] for each in arrays))
            found = finder.views(some, camera, partly_of)
            views.update(zip((view.id for view in viewpoints[start:stop]), found, strict=True))
    return SunDay(track, tuple(facades), views, shadows, tilts)


def _some(n: int, most: int) -> Index:
    """Numbers below n, evenly chosen, at most so many."""
    return np.asarray(np.unique(np.linspace(0, n - 1, most).astype(np.int64)) if n else np.zeros(0, np.int64))


def _joined(parts: list[Index]) -> Index:
    return np.concatenate([np.zeros(0, np.int64), *parts])


def _lit(
    site: SunSite, track: SunTrack, points: Array, of: Index, facing: Spans, has_shadows: bool
) -> tuple[Spans, Spans]:
    """While all points of a facade are in the sun, and while some are and some are not."""
    normals = site.frames.normals[of]

    def share(times: Array) -> Array:
        suns = track.directions_enu(times)
        is_lit = suns @ normals.T > 0.0
        if has_shadows:
            when, at = np.nonzero(is_lit)
            free = np.ones(len(at), np.bool_)
            for start, stop in chunks(len(at), RAYS_AT_ONCE):
                some = at[start:stop]
                free[start:stop] = site.sees_sun(points[some], suns[when[start:stop]])
            is_lit[when, at] = free
        return np.asarray(is_lit.mean(axis=1))

    if not len(of):
        return NO_SPANS, NO_SPANS
    whole = joined_spans([spans for _, spans in spans_that_hold(facing, lambda _, t: share(t) >= 1.0, TOLERANCE_S)])
    some = joined_spans([spans for _, spans in spans_that_hold(facing, lambda _, t: share(t) > 0.0, TOLERANCE_S)])
    partly = without_spans(some, whole)
    # A plane facade goes from shade to sun at once; what is left of that is the error of its ends.
    return whole, partly[partly[:, 1] - partly[:, 0] > 2.0 * SHADOW_END_S]


RAYS_AT_ONCE = 1_000_000


def spans_that_hold(
    spans: Spans, holds: Callable[[Index, Array], NDArray[np.bool_]], step_s: float = SHADOW_S
) -> list[tuple[int, Spans]]:
    """Parts of spans, each with its number, in which something holds at times; looked at every `step_s` or closer.

    `holds` takes numbers of spans and times, both of shape (k,).
    """
    if not len(spans):
        return []
    counts = np.maximum(1, np.ceil((spans[:, 1] - spans[:, 0]) / step_s)).astype(np.int64) + 1
    of = np.repeat(np.arange(len(spans)), counts)
    place = np.arange(len(of)) - np.repeat(np.cumsum(counts) - counts, counts)
    times = spans[of, 0] + place / (counts[of] - 1) * (spans[of, 1] - spans[of, 0])
    state = holds(of, times)
    changes = np.flatnonzero((state[1:] != state[:-1]) & (of[1:] == of[:-1]))
    low, high = times[changes], times[changes + 1]
    while len(changes) and (high - low).max() > SHADOW_END_S:
        middle = 0.5 * (low + high)
        is_low = holds(of[changes], middle) == state[changes]
        low, high = np.where(is_low, middle, low), np.where(is_low, high, middle)
    crossings = 0.5 * (low + high)
    found: list[tuple[int, Spans]] = []
    bounds = np.cumsum(counts)
    for number in range(len(spans)):
        first, last = bounds[number] - counts[number], bounds[number] - 1
        own = (changes >= first) & (changes < last)
        edges = [*([spans[number, 0]] if state[first] else []), *crossings[own]]
        edges += [spans[number, 1]] if state[last] else []
        if edges:
            found.append((number, np.array(edges).reshape(-1, 2)))
    return found


class _Finder:
    """Finds when views show the sun."""

    def __init__(self, site: SunSite, track: SunTrack, normals: Array, panes: Index, least_s: float) -> None:
        self._site, self._track, self._normals, self._panes, self._least_s = site, track, normals, panes, least_s

    def views(self, views: ViewpointArrays, camera: Camera, partly: Sequence[Spans]) -> list[ViewDay]:
        """What each shows, shape (n,); `partly` is of the facades."""
        track, site = self._track, self._site
        positions, planes = views.positions_enu_m, picture_planes(views, camera)
        direct: list[list[Spans]] = [[] for _ in range(len(planes))]
        mirrored: list[list[Spans]] = [[] for _ in range(len(planes))]
        panes: list[set[int]] = [set() for _ in range(len(planes))]
        which, spans = _numbered(spans_within(track, planes, -RADIUS_RAD, track.up, self._least_s))

        def sees(of: Index, times: Array) -> NDArray[np.bool_]:
            return site.sees_sun(positions[which[of]], track.directions_enu(times))

        for number, parts in spans_that_hold(spans, sees):
            direct[which[number]].append(parts)
        view_of, pane_of, spans = self._mirrored(positions, planes)

        def mirrors(of: Index, times: Array) -> NDArray[np.bool_]:
            return self._is_mirrored(positions[view_of[of]], pane_of[of], track.directions_enu(times))

        for number, parts in spans_that_hold(spans, mirrors):
            mirrored[view_of[number]].append(parts)
            panes[view_of[number]].add(int(pane_of[number]))
        shown = _shown_facades(site, positions, planes, len(partly))
        return [
            ViewDay(
                joined_spans(direct[n], 1.0),
                joined_spans(mirrored[n], 1.0),
                joined_spans([partly[facade] for facade in np.flatnonzero(shown[n]).tolist()]),
                tuple(sorted(panes[n])),
            )
            for n in range(len(planes))
        ]

    def _mirrored(self, positions: Array, planes: Array) -> tuple[Index, Index, Spans]:
        """Views, panes and spans in which a pane shows the sun to a view, whatever stands between."""
        frames, panes = self._site.frames, self._panes
        parts = (frames.corners[panes], frames.normals[panes], self._normals[panes])

        def work(start: int, stop: int) -> tuple[Index, Index, Spans]:
            room = 256
            while True:
                found = np.empty(room, np.int64), np.empty(room, np.int64), np.empty((room, 2))
                arguments = (positions[start:stop], planes[start:stop], *parts, self._track.table_enu, self._track.up)
                n = _mirrored_spans(*arguments, self._least_s, *found)
                if n <= room:
                    return found[0][:n] + start, panes[found[1][:n]], found[2][:n]
                room = n

        results = run_chunks(work, chunks(len(positions), 8)) if len(panes) and len(self._track.up) else []
        empty = np.zeros(0, np.int64)
        return (
            np.concatenate([empty, *(result[0] for result in results)]),
            np.concatenate([empty, *(result[1] for result in results)]),
            np.concatenate([NO_SPANS, *(result[2] for result in results)]),
        )

    def _is_mirrored(self, positions: Array, panes: Index, suns: Array) -> NDArray[np.bool_]:
        """Whether the way from views to panes and on to the sun is free, all shape (k, 3) or (k,)."""
        frames, site = self._site.frames, self._site
        flat, normals = frames.normals[panes], self._normals[panes]
        looking = suns - 2.0 * np.einsum("nk,nk->n", suns, normals)[:, None] * normals
        sinks = -np.einsum("nk,nk->n", looking, flat)
        height = np.einsum("nk,nk->n", positions - frames.centroids[panes], flat)
        # The disc's edge may be mirrored by a pane in whose plane its middle lies: that ray never meets it.
        meets = sinks > GRAZING
        ahead = np.where(meets, height / np.where(meets, sinks, 1.0), 0.0)
        points = positions + ahead[:, None] * looking + BEFORE_PANE_M * flat
        free = meets.copy()
        rows = np.flatnonzero(free)
        free[rows] = site.is_free(positions[rows], points[rows])
        rows = np.flatnonzero(free)
        free[rows] = site.sees_sun(points[rows], suns[rows])
        return np.asarray(free)


GRAZING = 1e-3
"""Sine of the least angle between a ray and the pane that mirrors it: 0.06 degrees, a fourth of the sun's radius."""


def _numbered(parts: list[Spans]) -> tuple[Index, Spans]:
    which = np.repeat(np.arange(len(parts)), [len(spans) for spans in parts])
    return which, np.concatenate([NO_SPANS, *parts])


def picture_planes(views: ViewpointArrays, camera: Camera) -> Array:
    """Planes that bound the pictures of views, shape (n, 4, 3): unit vectors that point into the picture."""
    forward, right, up = camera_axes(views.heading_rad, views.pitch_rad)
    across, along = camera.half_width, camera.half_height
    planes = np.stack([across * forward + right, across * forward - right, along * forward + up, along * forward - up])
    planes /= np.linalg.norm(planes, axis=2, keepdims=True)
    return np.ascontiguousarray(planes.transpose(1, 0, 2))


def _shown_facades(site: SunSite, positions: Array, planes: Array, n_facades: int) -> NDArray[np.bool_]:
    """Whether views, shape (n,), show the middle of a pane of facades from before it, shape (n, n_facades)."""
    frames = site.frames
    shown = np.zeros((len(positions), n_facades), np.bool_)
    for n, (position, bounds) in enumerate(zip(positions, planes, strict=True)):
        rays = frames.centroids - position
        is_shown = (rays @ bounds.T >= 0.0).all(axis=1) & (np.einsum("mk,mk->m", rays, frames.normals) < 0.0)
        shown[n, site.facade_of[is_shown]] = True
    return shown


@kernel
def _mirrored_spans(
    positions: Array,
    pictures: Array,
    corners: Array,
    flat: Array,
    normals: Array,
    table: Array,
    during: Spans,
    least_s: float,
    view_of: Index,
    pane_of: Index,
    found: Spans,
) -> int:
    """Fill in views, panes and spans; returns how many there are, of which those with room were written.

    The pane's own plane is that of its corners, `flat`; it mirrors by `normals`.
    """
    n = 0
    margin = math.sin(RADIUS_RAD)
    planes, rays = np.empty((9, 3)), np.empty((4, 3))
    for view in range(len(positions)):
        for pane in range(len(corners)):
            height = 0.0
            for axis in range(3):
                height += (positions[view, axis] - corners[pane, 0, axis]) * flat[pane, axis]
            if height <= 0.0:
                continue
            for k in range(4):
                length2 = 0.0
                for axis in range(3):
                    rays[k, axis] = corners[pane, k, axis] - positions[view, axis]
                    length2 += rays[k, axis] ** 2
                for axis in range(3):
                    rays[k, axis] /= math.sqrt(length2)
            is_out = False
            for side in range(4):
                n_out = 0
                for k in range(4):
                    inside = 0.0
                    for axis in range(3):
                        inside += pictures[view, side, axis] * rays[k, axis]
                    if inside < -margin:
                        n_out += 1
                if n_out == 4:
                    is_out = True
                    break
            if is_out:
                continue
            for side in range(4):
                # From before a pane its corners go round against the clock, so this points into it.
                after, length2 = (side + 1) % 4, 0.0
                for axis in range(3):
                    planes[side, axis] = pictures[view, side, axis]
                    y, z = (axis + 1) % 3, (axis + 2) % 3
                    planes[4 + side, axis] = rays[after, y] * rays[side, z] - rays[after, z] * rays[side, y]
                    length2 += planes[4 + side, axis] ** 2
                for axis in range(3):
                    planes[4 + side, axis] /= math.sqrt(length2) if length2 > 0.0 else 1.0
            for side in range(8):
                along = 0.0
                for axis in range(3):
                    along += planes[side, axis] * normals[pane, axis]
                for axis in range(3):
                    planes[side, axis] -= 2.0 * along * normals[pane, axis]
            for axis in range(3):
                planes[8, axis] = normals[pane, axis]
            for span in range(len(during)):
                first = n
                n = trace_region(table, planes, -RADIUS_RAD, during[span, 0], during[span, 1], least_s, found, n)
                for k in range(first, min(n, len(view_of))):
                    view_of[k], pane_of[k] = view, pane
    return n
