"""A made pavilion of concrete and glass, a first flight around it in rendered photos, and how far a model is from it.

A model of photos has an origin of its own. Places are compared in the frame of the true site, by way of WGS 84.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.geo.enu import enu_from_geodetic, geodetic_from_enu
from planning.geo.frames import Origin
from planning.geo.mesh import box_mesh, write_mesh
from planning.plan import read_plan, write_plan
from planning.site.bundled import ORIGIN, panel_grid
from planning.site.file import read_site, write_site
from planning.site.records import Airspace, Site, panel_corners
from reconstruction.colmap.folder import read_model

Array = NDArray[np.float64]

HALF_EAST_M, HALF_NORTH_M, HEIGHT_M = 7.0, 4.5, 8.5

N_SOUTH, N_EAST = 21, 12
"""Panes; the other walls are bare concrete."""

LOOK = "street_m = 36.0\nopposite_height_m = [8.0, 16.0]\n"

NEAR_M = 0.5
"""Panes whose middles are nearer than this are the same."""


class Flight(NamedTuple):
    """Of the truth: site file and look of the building, and the folder that `scene render` wrote."""

    site: Path
    look: Path
    rendered: Path

    @property
    def photos(self) -> Path:
        """The only part of it that a pilot has."""
        return self.rendered / "images"


def write_pavilion(folder: Path) -> tuple[Path, Path]:
    """Site file and look."""
    folder.mkdir(parents=True, exist_ok=True)
    x, y, height = HALF_EAST_M, HALF_NORTH_M, HEIGHT_M
    south = panel_grid("A", ((-x + 0.4, -y, 0.8), (x - 0.4, -y, 0.8), (-x + 0.4, -y, height - 0.6)), 3, 7, gap_m=0.06)
    east = panel_grid("B", ((x, -y + 0.4, 0.8), (x, y - 0.4, 0.8), (x, -y + 0.4, height - 0.6)), 3, 4, gap_m=0.06)
    write_mesh(folder / "building.ply", box_mesh(np.array([-x, -y, 0.0]), np.array([x, y, height])))
    airspace = Airspace((-45.0, -45.0, 2.0), (45.0, 45.0, 35.0), 0.0)
    site = Site("pavilion", ORIGIN, (south, east), airspace, (-30.0, -30.0, 0.0), "building.ply")
    write_site(folder / "site.json", site)
    (folder / "look.toml").write_text(LOOK, "utf-8")
    return folder / "site.json", folder / "look.toml"


def fly_around(
    run: Callable[..., object], folder: Path, n_photos: int, width_px: int, n_taken: int | None = None
) -> Flight:
    """Photos in rings around the pavilion, with the errors of receivers and gimbals in their metadata.

    Parameters
    ----------
    run
        Runs a command of `app.py` with its arguments.
    n_taken
        Of the whole rings, those nearest to the corner between the glass walls; all without.
    """
    site, look = write_pavilion(folder / "truth")
    plan = folder / "first.plan.json"
    run("plan", site, "-o", plan, "--method", "orbit", "--views", n_photos)
    whole = read_plan(plan)
    chosen = set(from_the_corner({view.id: view.position_enu_m for view in whole.viewpoints})[:n_taken])
    views = tuple(view for view in whole.viewpoints if view.id in chosen)
    sorties = tuple(
        replace(sortie, viewpoint_ids=tuple(name for name in sortie.viewpoint_ids if name in chosen))
        for sortie in whole.sorties
    )
    write_plan(plan, replace(whole, viewpoints=views, sorties=sorties))
    rendered = folder / "first"
    errors = ("--effects", "position-error=on", "--effects", "gimbal-error=on")
    run("scene", "render", site, "--plan", plan, "--width", width_px, "--look", look, *errors, "-o", rendered)
    return Flight(site, look, rendered)


def from_the_corner(places_enu_m: Mapping[str, Sequence[float]]) -> list[str]:
    """Names of views, those first that are nearest to the direction of the corner between the glass walls."""
    angles = {name: abs(np.angle(complex(*place[:2]) / (1 - 1j))) for name, place in places_enu_m.items()}
    return sorted(angles, key=lambda name: float(angles[name]))


def in_truth(points: Array, origin: Origin, truth: Origin) -> Array:
    """Points of another site, shape (..., 3), in the frame of the true one."""
    flat = np.asarray(points, np.float64).reshape(-1, 3)
    return np.asarray(enu_from_geodetic(truth, *geodetic_from_enu(origin, flat))).reshape(np.shape(points))


def position_errors_m(flight: Flight, coarse: Path) -> Array:
    """Of the photos that found their place, shape (n,)."""
    content = json.loads((flight.rendered / "scene.json").read_text("utf-8"))
    truth = {photo["name"]: photo["position_enu_m"] for photo in content["photos"]}
    images = read_model(coarse / "sparse" / "0").images.values()
    centres = np.array([image.centre_world for image in images])
    origins = (read_site(path).site.origin for path in (coarse / "site.json", flight.site))
    found = in_truth(centres, *origins)
    return np.asarray(np.linalg.norm(found - np.array([truth[image.name] for image in images]), axis=1))


def wall_errors_m(flight: Flight, coarse: Path, with_guessed: bool = False) -> Array:
    """By how much the ends of sides that were seen lie before or behind the true wall next to them, shape (2 n,)."""
    report = json.loads((coarse / "coarse.json").read_text("utf-8"))
    ends = np.array([side["ends_enu_m"] for side in report["sides"] if with_guessed or not side["is_guessed"]]).reshape(
        -1, 2, 2
    )
    origins = (read_site(path).site.origin for path in (coarse / "site.json", flight.site))
    ends = in_truth(np.concatenate([ends, np.zeros((len(ends), 2, 1))], axis=2), *origins)[..., :2]
    along = ends[:, 1] - ends[:, 0]
    runs_east = np.abs(along[:, 0]) > np.abs(along[:, 1])
    across = np.where(runs_east[:, None], ends[..., 1], ends[..., 0])
    half = np.where(runs_east[:, None], HALF_NORTH_M, HALF_EAST_M)
    return np.asarray(np.abs(np.abs(across) - half).ravel())


class FoundPanes(NamedTuple):
    """Panes of a found site: how many there are, those of the truth among them, and the errors of their corners."""

    n_found: int
    n_true: int
    corner_errors_m: Array


def compare_panes(flight: Flight, found: Path) -> FoundPanes:
    """Each true pane with the found one whose middle is nearest."""
    truth, other = read_site(flight.site).site, read_site(found).site
    true_corners = panel_corners(truth)
    corners = in_truth(panel_corners(other), other.origin, truth.origin)
    distances = np.linalg.norm(true_corners.mean(axis=1)[:, None] - corners.mean(axis=1)[None], axis=2)
    nearest = distances.argmin(axis=1)
    is_there = distances[np.arange(len(true_corners)), nearest] < NEAR_M
    errors = np.linalg.norm(true_corners[is_there] - corners[nearest[is_there]], axis=2)
    return FoundPanes(len(corners), int(is_there.sum()), errors.ravel())
