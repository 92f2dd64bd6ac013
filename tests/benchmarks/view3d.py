"""How smoothly the 3-D view turns, without a graphics card, and what each level of detail costs."""

from __future__ import annotations

import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from planning.aircraft.catalogue import profiles
from planning.geo.mesh import box_mesh
from planning.parameters import Constraints
from planning.plan import Camera, Coverage, Plan, Sortie, Viewpoint
from planning.site.bundled import ORIGIN, panel_grid
from planning.site.records import Airspace, Site, SiteModel
from tests.benchmarks.harness import Benchmark, Context, Row, Skipped
from tests.gui.screen import start_virtual_screen

SIZE_PX = (1280, 720)
GOAL_FPS = 20.0
"""Below, turning is felt as jumping."""


def large_site(n_columns: int = 50, n_rows: int = 50) -> SiteModel:
    """Tower with four facades of `n_columns` x `n_rows` panels, 50 m wide and 150 m high: 10 000 panels."""
    half, top = 25.0, 150.0
    corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
    facades = tuple(
        panel_grid(name, ((*left, 0.0), (*right, 0.0), (*left, top)), n_rows, n_columns, gap_m=0.1)
        for name, left, right in zip("ABCD", corners, [*corners[1:], corners[0]], strict=True)
    )
    building = box_mesh(np.array([-half, -half, 0.0]), np.array([half, half, top]))
    airspace = Airspace((-75.0, -75.0, 3.0), (75.0, 75.0, 180.0), ground_z_m=0.0)
    site = Site("tall", ORIGIN, facades, airspace, (0.0, -60.0, 0.0), building_mesh="tall.ply")
    return SiteModel(site, building)


def large_plan(n_views: int = 1000) -> Plan:
    """Views on a helix around the tower, in sorties of 100."""
    turn = np.linspace(0.0, 40.0 * np.pi, n_views)
    x, y, z = 60.0 * np.sin(turn), 60.0 * np.cos(turn), np.linspace(5.0, 170.0, n_views)
    heading = np.remainder(np.degrees(turn) + 360.0, 360.0) - 180.0
    views = tuple(
        Viewpoint(f"v{i:04d}", (float(x[i]), float(y[i]), float(z[i])), float(heading[i]), -5.0) for i in range(n_views)
    )
    sorties = tuple(
        Sortie(tuple(v.id for v in part), tuple(v.position_enu_m for v in part), 1.0, 1.0)
        for part in (views[start : start + 100] for start in range(0, n_views, 100))
    )
    camera = Camera("DJI M3E", 17.3, 13.0, 12.29, 5280, 3956, (-90.0, 35.0))
    aircraft = profiles()["m3e"].aircraft
    return Plan("tall", "", "greedy", 0, camera, aircraft, Constraints(), views, sorties, Coverage(0, 0, 0))


@contextmanager
def shown_view() -> Iterator[tuple[Any, Any]]:
    """The Qt application and a 3-D view on a virtual screen."""
    if shutil.which("Xvfb") is None:
        raise Skipped("Xvfb is not installed")
    start_virtual_screen()
    from PySide6.QtWidgets import QApplication

    application = QApplication.instance() or QApplication(["reflight-benchmark"])
    from groundstation.gui.view3d.scene_view import SceneView

    view = SceneView()
    view.resize(*SIZE_PX)
    view.show()
    application.processEvents()
    yield application, view
    view.close_view()


def frame_times_s(application: Any, view: Any, n: int) -> np.ndarray:
    """Time of each of n frames in which the view is turned by 3 degrees."""
    canvas, times = view.canvas(), []
    for i in range(n + 3):
        started, painted = time.perf_counter(), canvas.n_painted
        view.turn_by_hand(3.0, 0.0)
        while canvas.n_painted == painted:
            application.processEvents()
        if i >= 3:
            times.append(time.perf_counter() - started)
    return np.array(times)


def measure(context: Context) -> Iterator[Row]:
    """Frames per second, what details cost, and how long the setters and picking take."""
    n_frames = 30 if context.is_quick else 120
    site, plan = large_site(), large_plan()
    scene = "10 000 panels, 1000 viewpoints"
    with shown_view() as (application, view):
        from groundstation.gui.view3d.drawables import Layer
        from planning.coverage.sections import SectionGrid

        def rows(what: str, is_goal: bool = False) -> Iterator[Row]:
            times = frame_times_s(application, view, n_frames)
            median, high = float(np.median(times)), float(np.quantile(times, 0.95))
            target = f"at least {GOAL_FPS:.0f}" if is_goal else ""
            met = 1.0 / median >= GOAL_FPS if is_goal else None
            yield Row(scene, f"{what}: frames per second", 1.0 / median, "1/s", target=target, met=met)
            yield Row(scene, f"{what}: frame time, median", 1e3 * median, "ms")
            yield Row(scene, f"{what}: frame time, 95 %", 1e3 * high, "ms")

        yield from rows("empty view")
        times = []
        for _ in range(5):
            started = time.perf_counter()
            view.set_site(site)
            times.append(time.perf_counter() - started)
            application.processEvents()
        yield Row(scene, "set_site, first", 1e3 * times[0], "ms")
        yield Row(scene, "set_site, median of 5", 1e3 * float(np.median(times)), "ms")
        started = time.perf_counter()
        view.set_plan(plan)
        yield Row(scene, "set_plan", 1e3 * (time.perf_counter() - started), "ms")
        view.look_at_all()
        yield from rows("turning", is_goal=True)
        states = np.random.default_rng(0).integers(-2, 5, (len(site.site.panels), 36))
        started = time.perf_counter()
        view.paint_hemispheres(SectionGrid(30.0), states)
        yield Row(scene, "paint_hemispheres", 1e3 * (time.perf_counter() - started), "ms")
        yield from rows("turning, with coverage", is_goal=True)
        view.canvas().renderer.SetUseFXAA(True)
        yield from rows("turning, with coverage and smoothed edges")
        view.canvas().renderer.SetUseFXAA(False)
        view.paint_hemispheres(None)
        yield from rows("turning once more")
        view.set_layer_visible(Layer.VIEWPOINTS, False)
        yield from rows("and without viewpoints")
        view.set_layer_visible(Layer.ROUTES, False)
        yield from rows("and without routes")
        view.set_layer_visible(Layer.PANELS, False)
        yield from rows("and without panels")
        for layer in Layer:
            view.set_layer_visible(layer, layer in (Layer.PANELS, Layer.VIEWPOINTS, Layer.ROUTES))
        picks = []
        for x, y in np.random.default_rng(0).uniform(0.2, 0.8, (200, 2)) * SIZE_PX:
            started = time.perf_counter()
            view.pick_at(float(x), float(y))
            picks.append(time.perf_counter() - started)
        yield Row(scene, "first pick, with its index", 1e3 * picks[0], "ms")
        worst = float(np.quantile(picks[1:], 0.95))
        yield Row(scene, "pick, 95 %", 1e3 * worst, "ms", target="below 20", met=1e3 * worst < 20.0)
        view.hide()
        yield from camera_rows(context, application, site, plan, scene)


def camera_rows(context: Context, application: Any, site: SiteModel, plan: Plan, scene: str) -> Iterator[Row]:
    """What a frame of the camera preview's flight takes."""
    from groundstation.gui.camera_preview import CameraPreview

    preview = CameraPreview()
    preview.resize(*SIZE_PX)
    preview.show()
    started = time.perf_counter()
    preview.set_view(site, plan, plan.viewpoints[0].id)
    yield Row(scene, "camera preview, first view", 1e3 * (time.perf_counter() - started), "ms")
    canvas, times = preview.canvas(), []
    for _ in range(20 if context.is_quick else 100):
        started, painted = time.perf_counter(), canvas.n_painted
        preview.advance(0.2)
        while canvas.n_painted == painted:
            application.processEvents()
        times.append(time.perf_counter() - started)
    preview.close_view()
    yield Row(scene, "camera preview, frame of a flight, median", 1e3 * float(np.median(times)), "ms")


BENCHMARK = Benchmark(
    "view3d",
    "The 3-D view without a graphics card",
    "A tower of 10 000 panels with 1000 viewpoints is turned at 1280 x 720 with software OpenGL (Mesa). A frame lasts "
    "from the change of the view until Qt has painted it. Rows take away one detail after another: what accuracy of "
    "the picture costs in time.",
    measure,
)
