"""What errors of poses and panels cost models of reflections: dB lost by centimetres and hundredths of degrees."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
import torch
from numpy.typing import NDArray

from groundstation.services.scenes.photos import render_photos
from reconstruction.light.config import GlassLearned, ReflectionConfig
from reconstruction.light.glass_rays import GlassRays, glass_rays
from reconstruction.light.photo_set import PanelPlanes, PhotoSet, held_out_names, read_photo_set
from reconstruction.light.ray_table import RayTable
from reconstruction.light.reflective_panels import ModelName
from reconstruction.light.training import mean_square_error, train_reflections
from reconstruction.metrics.image_metrics import psnr_db
from reconstruction.scenes.parameters import RenderSettings, SceneRequest
from tests.benchmarks.harness import Benchmark, Context, Row

Array = NDArray[np.float64]
Errors = Callable[[RayTable, np.random.Generator], RayTable]

WIDTH_PX, N_VIEWS = 128, 60


@dataclass(frozen=True, slots=True)
class Case:
    """Errors of what photos and site tell.

    Parameters
    ----------
    told_only
        Whether they move the world as a whole, so that views can be scored only where they are stated to be.
    """

    name: str
    errors: Errors
    told_only: bool = False


def positions_off(sigma_m: float, *, all_alike: bool = False) -> Errors:
    """Each camera elsewhere by a normal error on each axis, or all of them by the same."""

    def moved(table: RayTable, rng: np.random.Generator) -> RayTable:
        shift = np.array([sigma_m] * 3) if all_alike else sigma_m * rng.standard_normal(table.positions_m.shape)
        return replace(table, positions_m=table.positions_m + torch.from_numpy(shift))

    return moved


def angles_off(sigma_deg: float, *, all_alike: bool = False) -> Errors:
    """Each camera turned by a normal error about each of its axes, or all of them by the same."""

    def turned(table: RayTable, rng: np.random.Generator) -> RayTable:
        n = len(table.enu_from_cam)
        sigma = math.radians(sigma_deg)
        vectors = np.full((n, 3), sigma) if all_alike else sigma * rng.standard_normal((n, 3))
        turns = torch.from_numpy(np.array([cv2.Rodrigues(vector)[0] for vector in vectors]))
        return replace(table, enu_from_cam=table.enu_from_cam @ turns)

    return turned


def panels_off(tilt_deg: float = 0.0, offset_m: float = 0.0, *, all_alike: bool = False) -> Errors:
    """Each panel tilted about its edges and moved along its normal by normal errors, or all of them by the same turn.

    All alike, panels turn about the vertical through the middle of them all.
    """

    def turned(table: RayTable, rng: np.random.Generator) -> RayTable:
        corners, normals = table.corners_m.numpy(), table.normals.numpy()
        sigma = math.radians(tilt_deg)
        if all_alike:
            turn = cv2.Rodrigues(np.array([0.0, 0.0, sigma]))[0]
            return _with_panels(table, corners @ turn.T, normals @ turn.T)
        found, new_normals = corners.copy(), normals.copy()
        for number, panel in enumerate(corners):
            edges = np.stack([panel[1] - panel[0], panel[3] - panel[0]])
            vector = sigma * rng.standard_normal(2) @ (edges / np.linalg.norm(edges, axis=1, keepdims=True))
            turn = cv2.Rodrigues(vector)[0]
            middle = panel.mean(axis=0)
            new_normals[number] = turn @ normals[number]
            off = offset_m * rng.standard_normal() * normals[number]
            found[number] = (panel - middle) @ turn.T + middle + off
        return _with_panels(table, found, new_normals)

    return turned


def _with_panels(table: RayTable, corners_m: Array, normals: Array) -> RayTable:
    """With other panels, and the box around those."""
    middle = table.middle_m.numpy()
    planes = PanelPlanes(corners_m + middle)
    shift = planes.middle_enu_m - middle
    return replace(
        table,
        positions_m=table.positions_m - torch.from_numpy(shift),
        corners_m=torch.from_numpy(corners_m - shift),
        normals=torch.from_numpy(normals),
        middle_m=torch.from_numpy(planes.middle_enu_m),
        half_side_m=torch.tensor(planes.half_side_m, dtype=torch.float64),
    )


CASES = (
    Case("positions, 10 cm", positions_off(0.1)),
    Case("positions, 30 cm", positions_off(0.3)),
    Case("angles, 0.2 degrees", angles_off(0.2)),
    Case("angles, 0.5 degrees", angles_off(0.5)),
    Case("all positions alike, 30 cm", positions_off(0.3, all_alike=True), True),
    Case("all angles alike, 0.5 degrees", angles_off(0.5, all_alike=True), True),
    Case("each panel, 0.3 degrees", panels_off(0.3), True),
)
LARGE = ("positions, 30 cm", "angles, 0.5 degrees")
"""Cases for models that errors hardly touch, and for learning corrections of poses."""


@dataclass(frozen=True, slots=True)
class Learner:
    """A model, how it is trained, and with which errors."""

    name: str
    model: ModelName
    config: ReflectionConfig
    cases: tuple[Case, ...]


def learners(is_quick: bool) -> tuple[Learner, ...]:
    """Trained as long as one has patience for so many trainings: a third of the defaults' rays, and coarser cells."""
    config = ReflectionConfig(steps=60 if is_quick else 240, batch=1024 if is_quick else 4096, passes=100.0)
    config = replace(config, grid=replace(config.grid, most_cells=1 << (12 if is_quick else 17)))
    large = tuple(case for case in CASES if case.name in LARGE)
    cases = large if is_quick else CASES
    of_mlp = large if is_quick else (*large, *CASES[4:])
    corrected = replace(config, learned=GlassLearned(tilts=True, poses=True))
    return (
        Learner("radiance-grid", "radiance-grid", config, cases),
        Learner("radiance-grid, poses corrected", "radiance-grid", corrected, large),
        Learner("mlp", "mlp", config, of_mlp),
        Learner("environment-map", "environment-map", config, large),
    )


@dataclass(frozen=True, slots=True)
class Rays:
    """Of views to learn from and of others, with true poses and panels."""

    source: PhotoSet
    learned: GlassRays
    unseen: GlassRays


def measure(context: Context) -> Iterator[Row]:
    """Errors one by one, for each model, against the same model without."""
    width, n_views = (WIDTH_PX // 2, N_VIEWS // 4) if context.is_quick else (WIDTH_PX, N_VIEWS)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "planar"
        request = SceneRequest("planar", n_views=n_views, width_px=width, n_points=0, settings=RenderSettings())
        render_photos(request, folder, 1)
        rays = rays_of(folder)
    right: dict[str, float] = {}
    for learner in learners(context.is_quick):
        if learner.model not in right:
            right[learner.model], _ = psnr_with(rays, learner, None)
            yield Row("planar", f"{learner.name}, no errors", round(right[learner.model], 2), "dB")
        right_db = right[learner.model]
        for case in learner.cases:
            told_db, true_db = psnr_with(rays, learner, case)
            beside = f"{told_db:.2f} dB left"
            if not case.told_only:
                beside += f"; {right_db - true_db:.2f} dB lost where views are scored by their true poses"
            yield Row(
                "planar", f"{learner.name}, lost: {case.name}", round(right_db - told_db, 2) + 0.0, "dB", None, beside
            )


def rays_of(folder: Path) -> Rays:
    """Glass of a folder's photos; the same pixels, whatever is told of poses and panels later."""
    source = read_photo_set(folder)
    held_out = held_out_names([photo.name for photo in source.photos], 0.15, 0)
    learned = tuple(photo for photo in source.photos if photo.name not in held_out)
    return Rays(source, glass_rays(source, learned), glass_rays(source, source.named(held_out)))


def psnr_with(rays: Rays, learner: Learner, case: Case | None) -> tuple[float, float]:
    """PSNR, dB, of all unseen glass pixels together, learned with errors.

    With views scored where they are stated to be, which is as wrong, and where they truly were.
    """
    learned, told, planes = rays.learned, rays.unseen, rays.source.panels
    if case is not None:
        learned, told = (
            replace(each, table=case.errors(each.table, np.random.default_rng(seed)))
            for seed, each in ((0, learned), (0 if case.told_only else 1, told))
        )
        planes = PanelPlanes((learned.table.corners_m + learned.table.middle_m).numpy())
    trained = train_reflections(learned, planes, learner.model, learner.config, rays.source.exposure)
    told_db, true_db = (psnr_db(mean_square_error(trained.panels, each)) for each in (told, rays.unseen))
    return told_db, true_db


BENCHMARK = Benchmark(
    "reflection-errors",
    "Errors of poses and panels",
    f"Models of reflections learned from {N_VIEWS} rendered photos of {WIDTH_PX} x 96 pixels of the bundled planar "
    "scene, where stated camera positions are off by normal errors (this much on each axis, drawn for each photo, or "
    "all alike), or panels are. What is lost is that of unseen glass pixels, which ones being known. Views are scored "
    "where they are stated to be, with errors of their own, as users must; beside it where they truly were. A pixel is "
    "0.63 degrees, and 18 cm on glass that is 16.6 m along the ray, as it is on average. Poses that are corrected are "
    "so for views learned from. Trained shorter than by default, one seed.",
    measure,
)
