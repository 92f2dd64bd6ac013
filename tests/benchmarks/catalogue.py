"""All benchmarks, in the order of the page."""

from __future__ import annotations

from tests.benchmarks import (
    baselines,
    certificates,
    fresh_process,
    kernel_speed,
    mission_files,
    mission_transfer,
    occlusion_effect,
    paper_views,
    plan_routing,
    precisions,
    reachable,
    revision,
    site_imports,
    speed_profiles,
    top_ups,
    tradeoffs,
    tsplib_tours,
    view3d,
    view_counts,
    window,
)
from tests.benchmarks.harness import Benchmark

BENCHMARKS: tuple[Benchmark, ...] = (
    tradeoffs.BENCHMARK,
    kernel_speed.BENCHMARK,
    precisions.BENCHMARK,
    paper_views.BENCHMARK,
    view_counts.BENCHMARK,
    baselines.BENCHMARK,
    occlusion_effect.BENCHMARK,
    reachable.BENCHMARK,
    certificates.BENCHMARK,
    fresh_process.BENCHMARK,
    tsplib_tours.BENCHMARK,
    plan_routing.BENCHMARK,
    top_ups.BENCHMARK,
    revision.BENCHMARK,
    speed_profiles.BENCHMARK,
    site_imports.BENCHMARK,
    mission_files.BENCHMARK,
    mission_transfer.BENCHMARK,
    window.BENCHMARK,
    view3d.BENCHMARK,
)
