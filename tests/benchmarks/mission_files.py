"""Mission files: time to write and to read them, and what the round trip does to views."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from groundstation.services.mission.export import export_plan
from missions.formats.registry import read_missions
from missions.mission.export_choices import FileFormat
from missions.mission.to_plan import viewpoints_and_sorties
from planning.geo.frames import wrap_heading_rad
from planning.plan import ViewpointArrays, viewpoint_arrays, write_plan
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import write_scene
from planning.site.file import read_site
from tests.benchmarks.harness import Benchmark, Context, Row, timer
from tests.benchmarks.problems import PLANAR_VIEWS

FORMATS = {
    FileFormat.DJI_KMZ: ".kmz",
    FileFormat.MAVLINK_PLAN: ".plan",
    FileFormat.MAVLINK_WPL: ".waypoints",
    FileFormat.KML: ".kml",
    FileFormat.CSV: ".csv",
}
LARGEST_ERROR_M, LARGEST_ERROR_DEG = 0.01, 0.1


def measure(context: Context) -> Iterator[Row]:
    """Export, import, and the largest difference of any view."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        site_path = write_scene("office", folder)
        model = read_site(site_path)
        n_views = 56 if context.is_quick else PLANAR_VIEWS
        plan = plan_flight(model, PlanRequest(n_views=n_views, time_budget_s=6.0)).plan
        plan_path = folder / "plan.json"
        write_plan(plan_path, plan)
        errors = []
        for file_format, suffix in FORMATS.items():
            with timer() as writing:
                paths, _ = export_plan(plan_path, file_format, folder / f"mission{suffix}", site_path)
            with timer() as reading:
                read = [mission for path in paths for mission in read_missions(path)]
                parts = viewpoints_and_sorties(read, model.site.origin, model.site.home_enu_m, plan.rules)
            sent, back = viewpoint_arrays(plan.viewpoints), viewpoint_arrays(parts.viewpoints)
            what = f"{len(back.heading_rad)} views in {len(paths)} files"
            yield Row(file_format, f"{what}: written", writing(), "s")
            yield Row(file_format, "read back", reading(), "s")
            metres, degrees = largest_errors(sent, back)
            yield Row(file_format, "largest error of a position", 1e3 * metres, "mm")
            yield Row(file_format, "largest error of an angle", degrees, "degrees")
            errors.append((metres, degrees))
        worst_m, worst_deg = (max(column) for column in zip(*errors, strict=True))
        target, met = f"at most {1e3 * LARGEST_ERROR_M:g} mm", worst_m <= LARGEST_ERROR_M
        yield Row("all formats", "largest error of a position", 1e3 * worst_m, "mm", target=target, met=met)
        target, met = f"at most {LARGEST_ERROR_DEG:g} degrees", worst_deg <= LARGEST_ERROR_DEG
        yield Row("all formats", "largest error of an angle", worst_deg, "degrees", target=target, met=met)


def largest_errors(sent: ViewpointArrays, back: ViewpointArrays) -> tuple[float, float]:
    """Largest distance (m) and largest angle (degrees) between each view sent and the one like it that came back.

    Sorties may have been shared out anew, so views are paired by what they are, not by their place; infinite where
    their number differs.
    """
    if len(sent.heading_rad) != len(back.heading_rad):
        return np.inf, np.inf
    from scipy.optimize import linear_sum_assignment

    metres = np.linalg.norm(sent.positions_enu_m[:, None] - back.positions_enu_m[None], axis=2)
    heading = np.abs(wrap_heading_rad(sent.heading_rad[:, None] - back.heading_rad[None]))
    pitch = np.abs(sent.pitch_rad[:, None] - back.pitch_rad[None])
    degrees = np.degrees(np.maximum(heading, pitch))
    pairs = linear_sum_assignment(metres / LARGEST_ERROR_M + degrees / LARGEST_ERROR_DEG)
    return float(metres[pairs].max()), float(degrees[pairs].max())


BENCHMARK = Benchmark(
    "missions",
    "Mission files",
    "A plan of 560 views on the office written in every format and read back as a plan. MAVLink files hold at most 650 "
    "items (ArduPilot), so they have more sorties than the plan.",
    measure,
)
