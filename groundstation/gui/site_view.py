"""The 3-D view: building, panels, obstacles, no-fly volumes, airspace, home, and a plan's viewpoints and routes."""

from __future__ import annotations

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from PySide6.QtWidgets import QVBoxLayout, QWidget
from pyvistaqt import QtInteractor

from planning.coverage.sections import panel_frames
from planning.mesh import TriangleMesh
from planning.plan import Plan, viewpoint_arrays
from planning.positions import picture_corners
from planning.site import SiteModel, panel_corners

BACKGROUND = "#f4f6f8"
BUILDING, OBSTACLE, NO_FLY, AIRSPACE = "#b8bec6", "#c98f5a", "#d64545", "#7a8794"
FACADES = ("#3f8fd0", "#4aa880", "#8f6fc8", "#c86f9a", "#c8a23f", "#5fa8b8")
SORTIES = ("#e4572e", "#2e86ab", "#5b8c2a", "#8e44ad", "#b8860b", "#16807a")
HOME = "#1d7a3c"

FRUSTUM_LENGTH_M = 1.5

PANEL_OFFSET_M = 0.05
"""Less, and the depth buffer cannot tell panel and wall apart from 100 m away."""


class SiteView(QWidget):
    """Shows a site, and a plan on it. It draws what it gets and decides nothing."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._plotter = QtInteractor(self)
        self._plotter.set_background(BACKGROUND)
        self._plan_actors: list[object] = []
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._plotter)

    def show_site(self, model: SiteModel) -> None:
        """Draw a site afresh; a plan that was shown goes away."""
        self._plotter.clear()
        self._plan_actors = []
        if len(model.building.triangles):
            self._plotter.add_mesh(_poly(model.building), color=BUILDING, smooth_shading=False)
        for obstacle in model.obstacles:
            self._plotter.add_mesh(_poly(obstacle), color=OBSTACLE, opacity=0.9)
        for zone in model.site.airspace.no_fly:
            self._plotter.add_mesh(_poly(zone.prism()), color=NO_FLY, opacity=0.25)
        first = 0
        corners = panel_corners(model.site)
        for number, facade in enumerate(model.site.facades):
            own = corners[first : first + len(facade.panels)]
            first += len(facade.panels)
            if len(own):
                colour = FACADES[number % len(FACADES)]
                self._plotter.add_mesh(_quads(own), color=colour, show_edges=True, edge_color="#23415a", line_width=1)
        airspace = model.site.airspace
        (x0, y0, z0), (x1, y1, z1) = airspace.min_enu_m, airspace.max_enu_m
        self._plotter.add_mesh(pv.Box((x0, x1, y0, y1, z0, z1)), style="wireframe", color=AIRSPACE, opacity=0.6)
        middle = ((x0 + x1) / 2, (y0 + y1) / 2, airspace.ground_z_m)
        ground = pv.Plane(center=middle, direction=(0, 0, 1), i_size=x1 - x0, j_size=y1 - y0)
        self._plotter.add_mesh(ground, color="#e3e8dd", opacity=0.6)
        self._plotter.add_mesh(pv.Sphere(radius=1.0, center=model.site.home_enu_m), color=HOME)
        self._look_at(corners)

    def show_plan(self, plan: Plan | None) -> None:
        """Draw viewpoints and routes over the site, or take them away."""
        for actor in self._plan_actors:
            self._plotter.remove_actor(actor, render=False)
        self._plan_actors = []
        if plan is not None:
            for number, sortie in enumerate(plan.sorties):
                line = pv.lines_from_points(np.array(sortie.path_enu_m))
                colour = SORTIES[number % len(SORTIES)]
                self._plan_actors.append(self._plotter.add_mesh(line, color=colour, line_width=2))
            if plan.viewpoints:
                frusta = _frusta(plan)
                self._plan_actors.append(self._plotter.add_mesh(frusta, color="#1b2733", line_width=1))
                self._plotter.reset_camera(bounds=frusta.bounds, render=False)
        self._plotter.render()

    def screenshot(self) -> NDArray[np.uint8]:
        """What is on screen, shape (height, width, 3)."""
        return np.asarray(self._plotter.screenshot(return_img=True))

    def close_view(self) -> None:
        """Free the OpenGL context; call before the widget goes away."""
        self._plotter.close()

    def _look_at(self, corners: NDArray[np.float64]) -> None:
        """Camera in front of the panels, to the right and above, so that most of them face it."""
        normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]).sum(axis=0)
        length = float(np.linalg.norm(normals[:2]))
        front = normals[:2] / length if length > 1e-6 else np.array([0.0, -1.0])
        focus = corners.reshape(-1, 3).mean(axis=0)
        extent = float(np.ptp(corners.reshape(-1, 3), axis=0).max()) + 20.0
        right = np.array([-front[1], front[0]])
        away = 2.2 * extent * np.array([*(front + 0.6 * right), 0.55])
        self._plotter.camera_position = [tuple(focus + away), tuple(focus), (0.0, 0.0, 1.0)]
        self._plotter.reset_camera_clipping_range()
        self._plotter.render()


def _poly(mesh: TriangleMesh) -> pv.PolyData:
    return pv.PolyData.from_regular_faces(mesh.vertices_enu_m, mesh.triangles)


def _quads(corners: NDArray[np.float64]) -> pv.PolyData:
    """Panels, drawn a little in front of the walls that they lie on."""
    corners = corners + PANEL_OFFSET_M * panel_frames(corners).normals[:, None]
    return pv.PolyData.from_regular_faces(corners.reshape(-1, 3), np.arange(4 * len(corners)).reshape(-1, 4))


def _frusta(plan: Plan) -> pv.PolyData:
    """A small pyramid per viewpoint, drawn as lines."""
    views = viewpoint_arrays(plan.viewpoints)
    corners = picture_corners(views, plan.camera, FRUSTUM_LENGTH_M)
    points = np.concatenate([views.positions_enu_m[:, None], corners], axis=1)
    pattern = np.array([[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [2, 3], [3, 4], [4, 1]])
    lines = (pattern[None] + 5 * np.arange(len(points))[:, None, None]).reshape(-1, 2)
    return pv.PolyData(points.reshape(-1, 3), lines=np.c_[np.full(len(lines), 2), lines].ravel())
