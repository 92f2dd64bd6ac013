"""Sun and sky: how true the sun's place is, and what finding short glare costs."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta

import numpy as np

from planning.aircraft.catalogue import profile
from planning.geo.sun import is_within, sun_directions_enu, sun_track, total_s
from planning.insight.sunlight import SunDay, SunSite, sun_day
from planning.plan import Viewpoint
from planning.site.bundled import SCENES
from tests.benchmarks.harness import Benchmark, Context, Row
from tests.planning.geo import make_sun_reference

DAY = datetime(2026, 12, 21, tzinfo=UTC) - timedelta(hours=8)
"""In Hong Kong the sun is low then, and before the glass from rise to set."""

EXACT_S, LEAPS_S = 1.0, (600.0, 120.0, 60.0, 30.0, 10.0, 2.0)


def measure(context: Context) -> Iterator[Row]:
    """Places against pvlib's, then glare by shortest leaps."""
    yield from _places()
    for scene, n_views in (
        (("office", 60),) if context.is_quick else (("office", 560), ("library", 560), ("tower", 560))
    ):
        site, views = SunSite(SCENES[scene]()), _views(scene, n_views)
        _day(site, views, EXACT_S)  # what is compiled or loaded once is not measured
        started = time.perf_counter()
        exact = _day(site, views, EXACT_S)
        yield Row(scene, f"{n_views} views, leaps from {EXACT_S:g} s", time.perf_counter() - started, "s")
        spans = np.concatenate([exact.views[view.id].mirrored for view in views])
        whole_s = total_s(spans)
        yield Row(scene, "glare in all of them, by these leaps", whole_s / 60.0, "min")
        for leap_s in LEAPS_S:
            started = time.perf_counter()
            found = _day(site, views, leap_s)
            seconds = time.perf_counter() - started
            missed_s = sum(_missed_s(exact, found, view.id) for view in views)
            what = f"leaps from {leap_s:g} s, {seconds:.2f} s: glare missed"
            looks = np.ceil(spans[:, 0] / leap_s) * leap_s > spans[:, 1]
            even_s = total_s(spans[looks])
            against = f"looking every {leap_s:g} s" if even_s > 0.0 else ""
            ratio = missed_s / even_s if even_s > 0.0 else None
            yield Row(scene, what, missed_s, "s", ratio, against)


def _places() -> Iterator[Row]:
    reference = json.loads(make_sun_reference.REFERENCE.read_text())
    apart_deg = []
    for lat_deg, lon_deg, second, azimuth_deg, elevation_deg, _ in reference["places"]:
        place = sun_directions_enu(lat_deg, lon_deg, datetime.fromtimestamp(second, UTC), 0.0, is_refracted=False)
        heading, elevation = np.radians([azimuth_deg, elevation_deg])
        flat = np.cos(elevation)
        expected = np.array([flat * np.sin(heading), flat * np.cos(heading), np.sin(elevation)])
        apart_deg.append(float(np.degrees(np.linalg.norm(place - expected))))
    n, name = len(apart_deg), f"pvlib {reference['pvlib']}"
    yield Row("earth, 1990 to 2070", f"sun of {n} times and places, from {name}: median", np.median(apart_deg), "deg")
    worst = max(apart_deg)
    yield Row("earth, 1990 to 2070", "the furthest", worst, "deg", target="0.015 deg", met=worst <= 0.015)


def _views(scene: str, n: int) -> tuple[Viewpoint, ...]:
    """Views of a scene's panes, at random."""
    rng, frames = np.random.default_rng(0), SunSite(SCENES[scene]()).frames
    panes = rng.integers(0, len(frames), n)
    away = frames.normals[panes] + 0.7 * rng.standard_normal((n, 3))
    away /= np.linalg.norm(away, axis=1)[:, None]
    places = frames.centroids[panes] + rng.uniform(8.0, 25.0, (n, 1)) * away
    ahead = frames.centroids[panes] - places
    headings = np.degrees(np.arctan2(ahead[:, 0], ahead[:, 1]))
    pitches = np.degrees(np.arctan2(ahead[:, 2], np.hypot(ahead[:, 0], ahead[:, 1])))
    return tuple(
        Viewpoint(f"v{k}", (float(x), float(y), float(z)), float(headings[k]), float(pitches[k]))
        for k, (x, y, z) in enumerate(places)
    )


def _day(site: SunSite, views: tuple[Viewpoint, ...], least_s: float) -> SunDay:
    origin = site.site_model.site.origin
    track = sun_track(origin.lat_deg, origin.lon_deg, DAY, DAY + timedelta(days=1), least_s)
    return sun_day(site, track, views, profile("m3e").camera, least_s=least_s)


def _missed_s(exact: SunDay, found: SunDay, name: str) -> float:
    """Seconds of glare, a second each, that the one has and the other has not."""
    seconds = np.concatenate([np.arange(a, b, 1.0) for a, b in exact.views[name].mirrored] or [np.zeros(0)])
    return float(np.count_nonzero(~is_within(found.views[name].mirrored, seconds)))


BENCHMARK = Benchmark(
    "sun",
    "Sun and sky: what finding short glare costs",
    "When the sun's mirror image stands in the pictures of views at random places on a winter day. A search leaps as "
    "far as the sun is away from where it would be mirrored, but no less than a shortest leap. What it misses is "
    "compared with leaps of a second, and with looking evenly, which misses each glare that falls between two looks.",
    measure,
)
